//! Text to [`Program`], as GRBL 1.1 reads it.

use super::{Line, Program, Word};

/// A place in a text that is not G-code.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {problem}, found {found}")]
pub struct ParseError {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What is wrong, with GRBL's error number.
    pub problem: &'static str,
    /// What stands there.
    pub found: String,
}

const NO_LETTER: &str = "a word must begin with a letter (GRBL error:1)";
const NO_NUMBER: &str = "a letter must be followed by a number such as 10, -2.5 or .75 (GRBL error:2)";

/// Reads G-code. Like GRBL: spaces count nowhere, small letters are capitals, `/` is passed over, comments stand in parentheses or after a
/// semicolon. Every line of the text becomes a line of the program. Which words exist is [`super::trace`]'s business.
///
/// # Errors
/// Anything that is not letter, number, letter, number: `$` commands and `%` too, which are no G-code.
pub fn parse(text: &str) -> Result<Program, ParseError> {
    let lines = text.lines().enumerate().map(|(i, line)| parse_line(line, i + 1));
    Ok(Program { lines: lines.collect::<Result<_, _>>()? })
}

fn parse_line(text: &str, number: usize) -> Result<Line, ParseError> {
    let mut line = Line::default();
    let mut chars = text.chars().enumerate().peekable();
    // Start column and text of the number being read, after its letter.
    let mut open: Option<(usize, char, String)> = None;
    let fail = |column: usize, problem, found: String| ParseError { line: number, column: column + 1, problem, found };
    while let Some((column, c)) = chars.next() {
        match c {
            ';' => {
                let rest: String = chars.by_ref().map(|(_, c)| c).collect();
                add_comment(&mut line, rest.strip_prefix(' ').unwrap_or(&rest));
            }
            '(' => {
                let inside: String = chars.by_ref().map(|(_, c)| c).take_while(|c| *c != ')').collect();
                add_comment(&mut line, inside.trim());
            }
            '/' => {}
            c if c.is_ascii_whitespace() || c.is_ascii_control() => {}
            c if c.is_ascii_alphabetic() => {
                close(&mut line, open.take()).map_err(|(at, found)| fail(at, NO_NUMBER, found))?;
                open = Some((column, c.to_ascii_uppercase(), String::new()));
            }
            '0'..='9' | '.' | '-' | '+' => match &mut open {
                Some((_, _, digits)) => digits.push(c),
                None => return Err(fail(column, NO_LETTER, format!("{c:?}"))),
            },
            other => {
                let problem = if open.as_ref().is_some_and(|(_, _, d)| d.is_empty()) { NO_NUMBER } else { NO_LETTER };
                return Err(fail(column, problem, format!("{other:?}")));
            }
        }
    }
    close(&mut line, open).map_err(|(at, found)| fail(at, NO_NUMBER, found))?;
    Ok(line)
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

/// Finishes a word; on failure says where it began and what it was.
fn close(line: &mut Line, open: Option<(usize, char, String)>) -> Result<(), (usize, String)> {
    let Some((column, letter, digits)) = open else { return Ok(()) };
    let unsigned = digits.strip_prefix(['-', '+']).unwrap_or(&digits);
    let plain = !unsigned.contains(['-', '+']) && unsigned.contains(|c: char| c.is_ascii_digit());
    match digits.parse::<f64>() {
        Ok(value) if plain && value.is_finite() => {
            line.words.push(Word { letter, value: value + 0.0 });
            Ok(())
        }
        _ => Err((column, format!("\"{letter}{digits}\""))),
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
        for text in
            ["G1X10Y-.5F1200", "g01 x10. y-0.50 f1200", "/G1 X1 0 (half\tway) Y-.5F1200 ; end", "G1X+10Y-.5F1200\r"]
        {
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
    fn what_is_not_g_code_is_refused_with_line_and_column() {
        let cases = [
            ("G21\n$H", 2, 1, "error:1"),
            ("10", 1, 1, "error:1"),
            ("%", 1, 1, "error:1"),
            ("G1XY2", 1, 3, "error:2"),
            ("G1X1-2", 1, 3, "error:2"),
            ("G1X1.2.3", 1, 3, "error:2"),
            ("G1X", 1, 3, "error:2"),
            ("G1X#1", 1, 4, "error:2"),
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
