//! G-code as values: lines of words.

use std::fmt;

/// GRBL takes lines of fewer than 80 characters.
const MAX_LINE: usize = 79;

/// A letter and its number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Word {
    /// A capital letter.
    pub letter: char,
    /// Its number, in the unit of the program.
    pub value: f64,
}

/// One line: words, a comment, both or neither.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Line {
    /// Words in the order written.
    pub words: Vec<Word>,
    /// The comment without its semicolon.
    pub comment: Option<String>,
}

/// A G-code program. Written with [`fmt::Display`]: no spaces between words, comments after a semicolon, a line feed after every line.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// All lines, empty ones included, so that a line's number is its index + 1.
    pub lines: Vec<Line>,
}

impl Word {
    /// A word with its number rounded to the three decimals that are written; minus zero becomes zero.
    pub fn new(letter: char, value: f64) -> Word {
        Word { letter, value: round3(value) }
    }
}

/// The number as three decimals write it.
pub(super) fn round3(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0 + 0.0
}

impl Line {
    /// A line of words.
    pub fn of(words: impl IntoIterator<Item = Word>) -> Line {
        Line { words: words.into_iter().collect(), comment: None }
    }

    /// A line that is a comment, made harmless: GRBL acts on `?`, `!`, `~` and bytes above 127 wherever they stand, so these and control
    /// characters become `_`; what makes the line longer than GRBL takes is cut off.
    pub fn comment(text: &str) -> Line {
        let harmless = |c: char| if matches!(c, ' '..='}') && !matches!(c, '?' | '!') { c } else { '_' };
        let room = MAX_LINE - 1 - "; ".len();
        let text: String = text.chars().map(harmless).take(room).collect();
        Line { words: Vec::new(), comment: Some(text.trim_end().to_string()) }
    }

    /// The word of a line that leads to a place stored on the machine (G28, G30), lays work zero elsewhere for good or by a stored offset (G10, G55 to
    /// G59, G43.1), or probes (G38): where the program goes from there only the machine knows.
    pub fn leads_elsewhere(&self) -> Option<Word> {
        let stored = |word: &&Word| word.letter == 'G' && matches!(word.value as u32, 10 | 28 | 30 | 38 | 43 | 55..=59);
        self.words.iter().find(stored).copied()
    }

    /// True when it takes back what lies on work zero beside the offset: G92 (G92.1) or the tool's length (G49).
    pub fn clears_shift(&self) -> bool {
        let clears = |word: &Word| word.letter == 'G' && [92.1, 49.0].contains(&word.value);
        self.words.iter().any(clears)
    }

    /// The number of the first word with this letter.
    pub fn value(&self, letter: char) -> Option<f64> {
        self.words.iter().find(|w| w.letter == letter).map(|w| w.value)
    }
}

impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The shortest text that reads back as the same number: three decimals at most for a rounded word.
        write!(f, "{}{}", self.letter, self.value)
    }
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for word in &self.words {
            word.fmt(f)?;
        }
        match &self.comment {
            Some(text) if text.is_empty() => f.write_str(";"),
            Some(text) => write!(f, "; {text}"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.lines.iter().try_for_each(|line| writeln!(f, "{line}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_with_three_decimals_and_no_trailing_zeros() {
        let cases = [
            (10.0, "X10"),
            (1.5, "X1.5"),
            (-0.25, "X-0.25"),
            (0.1 + 0.2, "X0.3"),
            (-0.0004, "X0"),
            (12.34567, "X12.346"),
        ];
        for (value, text) in cases {
            assert_eq!(Word::new('X', value).to_string(), text);
        }
    }

    #[test]
    fn a_comment_cannot_command_the_machine_or_overflow_its_line() {
        let line = Line::comment("stop! ~3 min? 20 °C\n$H");
        assert_eq!(line.to_string(), "; stop_ _3 min_ 20 _C_$H");
        assert_eq!(Line::comment(&"x".repeat(200)).to_string().len(), 78);
    }

    #[test]
    fn lines_are_written_without_spaces() {
        let line = Line { comment: Some("cut".into()), ..Line::of([Word::new('G', 1.0), Word::new('X', 2.5)]) };
        assert_eq!(Program { lines: vec![line, Line::default()] }.to_string(), "G1X2.5; cut\n\n");
    }
}
