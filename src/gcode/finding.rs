//! Objections to a program, and how they are collected in bounded memory.

use std::collections::BTreeMap;

/// How many objections of one kind are told in full; the rest are counted.
const TOLD_IN_FULL: usize = 50;

/// One objection: where, a stable word for scripts, and the sentence people read.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize)]
#[error("line {line}, column {column}: {message}")]
pub struct Finding {
    /// Line of the file, from 1.
    pub line: usize,
    /// Column in characters, from 1; 1 when the whole line is meant.
    pub column: usize,
    /// Stable word for scripts: "outside-work-area"; what GRBL would refuse has its number, "error:20".
    pub code: String,
    /// What is wrong, the limit, and the way out.
    pub message: String,
}

/// Collects findings, of each code the first few in full.
#[derive(Debug, Default)]
pub(super) struct Findings {
    told: Vec<Finding>,
    /// By code: how many, and the last line.
    counts: BTreeMap<String, (usize, usize)>,
}

impl Findings {
    /// Takes an objection; its message is only made when it is told.
    pub(super) fn add(&mut self, line: usize, column: usize, code: &str, message: impl FnOnce() -> String) {
        let (count, last) = match self.counts.get_mut(code) {
            Some(entry) => entry,
            None => self.counts.entry(code.to_owned()).or_default(),
        };
        *count += 1;
        *last = line;
        if *count <= TOLD_IN_FULL {
            self.told.push(Finding { line, column, code: code.to_owned(), message: message() });
        }
    }

    /// All, by line; where some were only counted, one more says so.
    pub(super) fn finish(mut self) -> Vec<Finding> {
        for (code, (count, line)) in self.counts {
            if count > TOLD_IN_FULL {
                let message = format!("{} more like this, the last one here", count - TOLD_IN_FULL);
                self.told.push(Finding { line, column: 1, code, message });
            }
        }
        self.told.sort_by_key(|finding| (finding.line, finding.column));
        self.told
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_objections_are_told_in_a_few() {
        let mut findings = Findings::default();
        for line in (1..=1_000_000).rev() {
            findings.add(line, 1, "far", || "too far".into());
        }
        findings.add(7, 2, "fast", || "too fast".into());
        let told = findings.finish();
        assert_eq!(told.len(), TOLD_IN_FULL + 2);
        assert_eq!((told[0].line, told[1].line), (1, 7));
        assert!(told[0].message.starts_with("999950 more"));
    }
}
