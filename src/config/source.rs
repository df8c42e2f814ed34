//! Where a value was written: file texts, positions in them, and problems that quote the line they are about.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// One file's text and the name people know it by.
#[derive(Debug)]
pub(super) struct Source {
    /// A path as the user gave it, or "built-in machine k40".
    pub name: String,
    /// The whole text.
    pub text: String,
}

/// A stretch of one source.
#[derive(Debug, Clone)]
pub(super) struct Origin {
    pub source: Arc<Source>,
    /// Byte range in `source.text`.
    pub span: Range<usize>,
}

/// One thing wrong in a machine or profile file: where it stands, what it is, and the way out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The file, as the user named it.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The line as it stands in the file.
    pub text: String,
    /// How many characters from `column` on are meant; at least 1.
    pub width: usize,
    /// What is wrong, and the limit it breaks.
    pub message: String,
    /// The way out: "did you mean `kerf_mm`?".
    pub help: Option<String>,
}

impl Origin {
    /// A problem at this place.
    pub fn problem(&self, message: impl Into<String>, help: Option<String>) -> Problem {
        let text = &self.source.text;
        let start = floor_char_boundary(text, self.span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
        let end = floor_char_boundary(text, self.span.end).clamp(start, line_end);
        Problem {
            file: self.source.name.clone(),
            line: text[..start].matches('\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            text: text[line_start..line_end].trim_end().to_owned(),
            width: text[start..end].trim_end().chars().count().max(1),
            message: message.into(),
            help,
        }
    }
}

/// The nearest character boundary at or before `index`; parsers may report a byte inside a character.
fn floor_char_boundary(text: &str, index: usize) -> usize {
    let index = index.min(text.len());
    (0..=index).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0)
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}: {}", self.file, self.line, self.column, self.message)?;
        if let Some(help) = &self.help {
            write!(f, "; {help}")?;
        }
        let number = self.line.to_string();
        let gutter = " ".repeat(number.len());
        // Tabs are kept in the padding, so that the marks stand under the text at any tab width.
        let padding: String =
            self.text.chars().take(self.column - 1).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
        write!(f, "\n {gutter} |\n {number} | {}\n {gutter} | {padding}{}", self.text, "^".repeat(self.width))
    }
}

/// The candidate that `word` most likely meant: one that only adds a unit, or the most similar spelling.
pub(super) fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Below this similarity a suggestion confuses more than it helps: "feed" is not "grain".
    const SIMILAR: f64 = 0.55;
    let with_unit = |c: &str| c.strip_prefix(word).is_some_and(|rest| rest.starts_with('_'));
    let score = |c: &str| if with_unit(c) { 1.0 } else { strsim::normalized_damerau_levenshtein(word, c) };
    candidates
        .into_iter()
        .map(|c| (score(c), c))
        .filter(|(s, _)| *s >= SIMILAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, c)| c)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn origin(text: &str, span: Range<usize>) -> Origin {
        Origin { source: Arc::new(Source { name: "a.toml".into(), text: text.into() }), span }
    }

    #[test]
    fn a_problem_quotes_its_line_and_marks_the_value() {
        let text = "schema = 1\n\tµm = 12 # wide\n";
        let start = text.find("12").expect("in the text");
        let problem = origin(text, start..start + 2).problem("too wide", Some("use 3".into()));
        assert_eq!((problem.line, problem.column, problem.width), (2, 7, 2));
        assert_eq!(problem.to_string(), "a.toml:2:7: too wide; use 3\n   |\n 2 | \tµm = 12 # wide\n   | \t     ^^");
    }

    #[test]
    fn a_place_past_the_end_or_inside_a_character_is_still_a_place() {
        let text = "x = µ";
        assert_eq!(origin(text, 5..6).problem("", None).column, 5);
        assert_eq!(origin(text, 90..95).problem("", None).column, 6);
        assert_eq!(origin("", 0..0).problem("", None).line, 1);
    }

    #[test]
    fn a_suggestion_adds_the_unit_or_mends_the_spelling_or_stays_silent() {
        let keys = ["feed_mm_per_min", "kerf_mm", "power"];
        assert_eq!(nearest("feed", keys), Some("feed_mm_per_min"));
        assert_eq!(nearest("kref_mm", keys), Some("kerf_mm"));
        assert_eq!(nearest("speed", keys), None);
    }
}
