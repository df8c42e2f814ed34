//! Why GRBL would refuse a line: its own error numbers, with the way out.

use super::Word;

/// A line that GRBL would refuse.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}, column {column}: {problem}")]
pub struct TraceError {
    /// Line of the program, from 1.
    pub line: usize,
    /// Column of the word at fault, in characters from 1.
    pub column: usize,
    /// What is wrong.
    pub problem: TraceProblem,
}

/// What is wrong with a line, with the error number GRBL 1.1 answers.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TraceProblem {
    /// A feed, power, time or number below zero.
    #[error("{0} is below 0 (GRBL error:4); give 0 or more")]
    Negative(Word),
    /// A word outside the dialect.
    #[error("{0} is not understood (GRBL error:20); take it out, or have the file written for GRBL")]
    Unsupported(Word),
    /// Two words of one modal group.
    #[error("{0} contradicts another word of the line (GRBL error:21); give one")]
    Clash(Word),
    /// G1, G2, G3 or G38 without feed.
    #[error("a feed move without a feed (GRBL error:22); give F above 0 before or in this line")]
    NoFeed,
    /// A code with a fraction.
    #[error("{0} must be a whole number (GRBL error:23)")]
    NotWhole(Word),
    /// Two words that both want the axes.
    #[error("{0} and another word of the line both use X, Y and Z (GRBL error:24); give them on two lines")]
    AxisConflict(Word),
    /// A letter given twice.
    #[error("{0} is given twice (GRBL error:25); give one")]
    Repeated(Word),
    /// An arc, a probe or an offset that does not say where.
    #[error("{0} without an axis (GRBL error:26); give X, Y or Z")]
    NoAxes(Word),
    /// A line number beyond ten million.
    #[error("{0} is more than 10000000 (GRBL error:27); number the lines anew or not at all")]
    LineNumber(Word),
    /// A word without the value it needs.
    #[error("{0} without its {1} (GRBL error:28); give it")]
    MissingValue(Word, &'static str),
    /// A work offset beyond G59.
    #[error("{0} names a work offset there is not (GRBL error:29); P1 to P6 are G54 to G59")]
    NoSuchOffset(Word),
    /// G53 with an arc.
    #[error("G53 with another motion than G0 or G1 (GRBL error:30)")]
    MachineArc,
    /// Axis words after G80.
    #[error("a position without a motion mode after G80 (GRBL error:31); give G0 or G1")]
    NoMotion,
    /// An arc without an end in its plane.
    #[error("an arc without an end in its plane (GRBL error:32); give X or Y")]
    NoArcEnd,
    /// An arc whose end is not on its circle.
    #[error(
        "an arc that begins at radius {start_mm:.4} mm and ends at {end_mm:.4} mm (GRBL error:33); correct I and J"
    )]
    ArcRadius {
        /// Distance from start to centre, mm.
        start_mm: f64,
        /// Distance from end to centre, mm.
        end_mm: f64,
    },
    /// A probe, or an arc by radius, that ends where it begins.
    #[error("a move that ends where it begins (GRBL error:33); a full circle needs I and J")]
    SamePlace,
    /// A radius too small to reach the end.
    #[error("{0} is too small a radius to reach the arc's end (GRBL error:34)")]
    RadiusTooSmall(Word),
    /// An arc that does not say around what.
    #[error("an arc without I, J or R (GRBL error:35); give its centre from its start, or its radius")]
    NoArcCentre,
    /// Words nothing on the line uses.
    #[error("{0} is used by nothing on the line (GRBL error:36); take it out")]
    Unused(Word),
    /// G43.1 along another axis than Z.
    #[error("G43.1 takes Z and nothing else (GRBL error:37)")]
    ToolLengthAxis,
    /// A tool number that is too large.
    #[error("{0} is beyond tool 255 (GRBL error:38)")]
    ToolNumber(Word),
}

impl TraceProblem {
    /// The number in GRBL's `error:N`.
    pub fn grbl_error(&self) -> u8 {
        match self {
            TraceProblem::Negative(_) => 4,
            TraceProblem::Unsupported(_) => 20,
            TraceProblem::Clash(_) => 21,
            TraceProblem::NoFeed => 22,
            TraceProblem::NotWhole(_) => 23,
            TraceProblem::AxisConflict(_) => 24,
            TraceProblem::Repeated(_) => 25,
            TraceProblem::NoAxes(_) => 26,
            TraceProblem::LineNumber(_) => 27,
            TraceProblem::MissingValue(..) => 28,
            TraceProblem::NoSuchOffset(_) => 29,
            TraceProblem::MachineArc => 30,
            TraceProblem::NoMotion => 31,
            TraceProblem::NoArcEnd => 32,
            TraceProblem::ArcRadius { .. } | TraceProblem::SamePlace => 33,
            TraceProblem::RadiusTooSmall(_) => 34,
            TraceProblem::NoArcCentre => 35,
            TraceProblem::Unused(_) => 36,
            TraceProblem::ToolLengthAxis => 37,
            TraceProblem::ToolNumber(_) => 38,
        }
    }
}

/// A problem and the word of the line, counted from 0, that causes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Refusal {
    pub(super) problem: TraceProblem,
    pub(super) word: usize,
}
