//! What densifying left behind in a ruffle: enough to take it back.

use super::{Node, Role};

/// Sections that took the place of one (paper section 3.1, figure 7).
#[derive(Debug, Clone, PartialEq)]
pub struct Densification {
    /// First of them, an index into [`Ruffle::sections`](super::Ruffle::sections).
    pub first_section: usize,
    /// One past the last.
    pub end_section: usize,
    /// Role of the section they replaced.
    pub role: Role,
    /// Rest length of the section they replaced, mm.
    pub length_mm: f64,
}

impl Densification {
    /// The sections it made.
    pub fn sections(&self) -> std::ops::Range<usize> {
        self.first_section..self.end_section
    }
}

/// Every densification of a ruffle.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Densified {
    /// By first section, an outer one before those inside it: their sections nest and never overlap otherwise.
    pub made: Vec<Densification>,
    /// Nodes at which a section was divided in two so that little loops hold on to its middle.
    pub midpoints: Vec<Node>,
}

impl Densified {
    /// How often a section was densified: how many densifications it lies in.
    pub fn level(&self, section: usize) -> usize {
        self.made.iter().filter(|m| m.sections().contains(&section)).count()
    }
}
