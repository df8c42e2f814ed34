//! Text to [`Program`], as GRBL 1.1 reads it.

use super::lines::lines;
use super::{Line, Program, Word};

/// A place in a text that is not G-code.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {problem} (GRBL error:{grbl_error}), found {found:?}")]
pub struct ParseError {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The number in GRBL's `error:N`: 1 or 2.
    pub grbl_error: u8,
    /// What is wrong.
    pub problem: &'static str,
    /// What stands there.
    pub found: String,
}

/// Numbers beyond this are refused: GRBL computes with 32-bit floats, in which nothing is left of their places behind the point.
const MAX_VALUE: f64 = 1e9;

const NO_LETTER: &str = "a word must begin with a letter";
const NO_NUMBER: &str = "a letter must be followed by a number such as 10, -2.5 or .75";

/// Reads G-code. Like GRBL: spaces count nowhere, small letters are capitals, `/` is passed over, comments stand in parentheses or after a
/// semicolon. Lines end at a line feed, a carriage return or both. Every line of the text becomes a line of the program. Which words exist is [`super::trace`]'s business.
///
/// # Errors
/// Anything that is not letter, number, letter, number: `$` commands and `%` too, which are no G-code.
pub fn parse(text: &str) -> Result<Program, ParseError> {
    let lines = lines(text).enumerate().map(|(i, line)| parse_line(line, i + 1));
    Ok(Program { lines: lines.collect::<Result<_, _>>()? })
}

/// Reads one line, without its line feed, as [`parse`] does; `number` is its place in the file, from 1.
///
/// # Errors
/// As for [`parse`].
pub fn parse_line(text: &str, number: usize) -> Result<Line, ParseError> {
    let mut line = Line::default();
    let mut digits = String::new();
    let mut tokens = Tokens { text, at: 0 };
    let fail = |at: usize, problem, found: &str| ParseError {
        line: number,
        column: column(text, at),
        grbl_error: if problem == NO_LETTER { 1 } else { 2 },
        problem,
        found: found.to_owned(),
    };
    while let Some((at, token)) = tokens.next() {
        match token {
            Token::Comment(words) => add_comment(&mut line, words),
            Token::Letter(letter) => {
                let value = tokens.number(&mut digits, &mut line);
                let value = value.ok_or_else(|| fail(at, NO_NUMBER, &format!("{letter}{digits}")))?;
                line.words.push(Word { letter, value: value + 0.0 });
            }
            Token::Other(found) => return Err(fail(at, NO_LETTER, &found.to_string())),
        }
    }
    // A carriage return or blanks at the end are no part of what is said.
    if let Some(comment) = &mut line.comment {
        comment.truncate(comment.trim_end().len());
    }
    Ok(line)
}

/// Column, from 1 and in characters, at which a line's word number `word` (from 0) begins; 1 when there is none.
pub(super) fn column_of_word(text: &str, word: usize) -> usize {
    let mut tokens = Tokens { text, at: 0 };
    let letters = std::iter::from_fn(|| tokens.next()).filter(|(_, token)| matches!(token, Token::Letter(_)));
    letters.map(|(at, _)| at).nth(word).map_or(1, |at| column(text, at))
}

/// Column, from 1 and in characters, of a byte of a line.
fn column(text: &str, at: usize) -> usize {
    text[..at].chars().count() + 1
}

enum Token<'a> {
    Letter(char),
    Comment(&'a str),
    Other(char),
}

/// Walks through a line; `at` is a byte between characters.
struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Tokens<'a> {
    /// The next thing that is no blank, and where it begins.
    fn next(&mut self) -> Option<(usize, Token<'a>)> {
        while let Some(c) = self.text[self.at..].chars().next() {
            let at = self.at;
            self.at += c.len_utf8();
            let token = match c {
                ';' => {
                    let rest = &self.text[self.at..];
                    self.at = self.text.len();
                    Token::Comment(rest.strip_prefix(' ').unwrap_or(rest))
                }
                '(' => {
                    let rest = &self.text[self.at..];
                    let inside = rest.split(')').next().unwrap_or(rest);
                    self.at = (self.at + inside.len() + 1).min(self.text.len());
                    Token::Comment(inside.trim())
                }
                c if is_blank(c) => continue,
                c if c.is_ascii_alphabetic() => Token::Letter(c.to_ascii_uppercase()),
                c => Token::Other(c),
            };
            return Some((at, token));
        }
        None
    }

    /// The number that follows a letter; on failure `digits` holds what stands there. Blanks and comments may interrupt it; comments go
    /// to `line`.
    fn number(&mut self, digits: &mut String, line: &mut Line) -> Option<f64> {
        let bytes = self.text.as_bytes();
        let digit = |at: usize| bytes.get(at).is_some_and(|b| matches!(b, b'0'..=b'9' | b'.' | b'-' | b'+'));
        digits.clear();
        let begin = self.at;
        loop {
            let end = (self.at..).find(|at| !digit(*at)).unwrap_or(self.at);
            digits.push_str(&self.text[self.at..end]);
            self.at = end;
            let mut ahead = Tokens { text: self.text, at: end };
            while bytes.get(ahead.at).is_some_and(|b| is_blank(char::from(*b))) {
                ahead.at += 1;
            }
            if bytes.get(ahead.at) == Some(&b'(')
                && let Some((_, Token::Comment(words))) = ahead.next()
            {
                add_comment(line, words);
                self.at = ahead.at;
            } else if ahead.at > end && digit(ahead.at) {
                self.at = ahead.at;
            } else {
                break;
            }
        }
        let unsigned = digits.strip_prefix(['-', '+']).unwrap_or(digits);
        let plain = !unsigned.contains(['-', '+']) && unsigned.contains(|c: char| c.is_ascii_digit());
        if digits.is_empty() {
            digits.extend(self.text[begin..].chars().find(|c| !is_blank(*c)));
        }
        digits.parse().ok().filter(|value: &f64| plain && value.abs() <= MAX_VALUE)
    }
}

/// What GRBL drops from a line before it reads it: blanks, control characters and the block delete sign. Not the soft reset, 0x18: GRBL never
/// reads it as part of a line but resets at once. `!`, `~`, `?` and what is beyond ASCII it takes out too and acts on: here they are no word.
fn is_blank(c: char) -> bool {
    c == '/' || c.is_ascii_whitespace() || c.is_ascii_control() && c != '\x18'
}

fn add_comment(line: &mut Line, text: &str) {
    match &mut line.comment {
        Some(comment) => {
            comment.push(' ');
            comment.push_str(text);
        }
        None => line.comment = Some(text.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn words(text: &str) -> Vec<(char, f64)> {
        parse(text).unwrap().lines[0].words.iter().map(|w| (w.letter, w.value)).collect()
    }

    #[test]
    fn foreign_spelling_is_read_as_grbl_reads_it() {
        let expected = vec![('G', 1.0), ('X', 10.0), ('Y', -0.5), ('F', 1200.0)];
        for text in [
            "G1X10Y-.5F1200",
            "g01 x10. y-0.50 f1200",
            "/G1 X1 0 (half\tway) Y-.5F1200 ; end",
            "G1X1(a)(b)0Y-.5F1200",
            "G1X+10Y-.5F1200\r",
        ] {
            assert_eq!(words(text), expected, "{text}");
        }
    }

    #[test]
    fn comments_are_kept_and_hide_everything_in_them() {
        let program = parse("; furbelow 0.1.0\nG0 (a $ b) X1 (c) ; d ; e\n\n(open G1").unwrap();
        let comments: Vec<Option<&str>> = program.lines.iter().map(|l| l.comment.as_deref()).collect();
        assert_eq!(comments, [Some("furbelow 0.1.0"), Some("a $ b c d ; e"), None, Some("open G1")]);
        assert_eq!(program.lines[1].words.len(), 2);
        assert!(program.lines[3].words.is_empty());
    }

    #[test]
    fn a_comment_that_ends_in_blanks_reads_back_as_it_is_written() {
        for text in [";\r", "; a \t\r", "( ) ; ", "G1 (x ) ;"] {
            let program = parse(text).unwrap();
            assert_eq!(parse(&program.to_string()).unwrap(), program, "{text:?}");
        }
    }

    #[test]
    fn what_is_not_g_code_is_refused_with_line_and_column() {
        let cases = [
            ("G21\n$H", 2, 1, "error:1"),
            ("10", 1, 1, "error:1"),
            ("%", 1, 1, "error:1"),
            ("G1XY2", 1, 3, "error:2"),
            ("G1X1-2", 1, 3, "error:2"),
            ("G1X1.2.3", 1, 3, "error:2"),
            ("G1X", 1, 3, "error:2"),
            ("G1X#1", 1, 3, "error:2"),
            ("G1X1ä", 1, 5, "error:1"),
            ("X.", 1, 1, "error:2"),
            ("X--1", 1, 1, "error:2"),
        ];
        for (text, line, column, code) in cases {
            let error = parse(text).unwrap_err();
            assert_eq!((error.line, error.column), (line, column), "{text}");
            assert!(error.to_string().contains(code), "{text}: {error}");
        }
    }

    prop_compose! {
        fn word()(letter in "[A-Z]", value in prop_oneof![-1e4..1e4f64, Just(0.0), Just(-0.0), -1.0..1.0f64]) -> Word {
            Word::new(letter.chars().next().unwrap(), value)
        }
    }

    proptest! {
        #[test]
        fn a_written_program_reads_back_as_itself(
            lines in prop::collection::vec((prop::collection::vec(word(), 0..8), prop::option::of("\\PC{0,90}")), 0..20),
        ) {
            let lines = lines.into_iter().map(|(words, text)| {
                let comment = text.and_then(|t| Line::comment(&t).comment);
                Line { words, comment }
            });
            let program = Program { lines: lines.collect() };
            prop_assert_eq!(parse(&program.to_string()).unwrap(), program);
        }

        #[test]
        fn no_text_makes_the_parser_panic(text in "([GMXYFS0-9.;() /$%-]|\\PC){0,60}(\r?\n)?[A-Z0-9.-]{0,20}") {
            if let Ok(program) = parse(&text) {
                prop_assert_eq!(program.lines.len(), text.lines().count());
            }
        }
    }
}
