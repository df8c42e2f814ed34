//! Why a sheet cannot be made.

/// Why [`super::plan`] refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Something to engrave where the tool cannot mark the material.
    #[error("piece {piece} has a {role} to engrave, but this tool cannot mark this material; leave it out")]
    NoProcess {
        /// Name of the piece.
        piece: String,
        /// Role of the path.
        role: &'static str,
    },
    /// A setting out of range.
    #[error("{name} is {value}; it must be {needed}")]
    Setting {
        /// Which setting.
        name: String,
        /// What was given.
        value: f64,
        /// What is allowed.
        needed: &'static str,
    },
    /// A path without length or with a coordinate that is not a number.
    #[error("the {role} of piece {piece} cannot be made: {flaw}")]
    Path {
        /// Name of the piece.
        piece: String,
        /// Role of the path.
        role: &'static str,
        /// What is wrong.
        flaw: &'static str,
    },
    /// The kerf eats the path, or breaks it into several.
    #[error(
        "the {role} of piece {piece} comes to {parts} paths instead of one when it is moved by half the kerf of {kerf_mm} mm; \
         widen its narrow places or use a tool with a smaller kerf"
    )]
    Split {
        /// Name of the piece.
        piece: String,
        /// Role of the path.
        role: &'static str,
        /// Paths left; 0 when nothing is left.
        parts: usize,
        /// Full kerf, mm.
        kerf_mm: f64,
    },
    /// The tool would not reach part of the nominal curve: a notch narrower than the kerf, or a lost end.
    #[error(
        "the kerf of {kerf_mm} mm hides part of the {role} of piece {piece} near x {x_mm:.3}, y {y_mm:.3} mm: the tool comes no \
         nearer than {distance_mm:.3} mm; widen the place or use a tool with a smaller kerf"
    )]
    Hidden {
        /// Name of the piece.
        piece: String,
        /// Role of the path.
        role: &'static str,
        /// Full kerf, mm.
        kerf_mm: f64,
        /// Where, mm in the work frame.
        x_mm: f64,
        /// Where, mm in the work frame.
        y_mm: f64,
        /// Distance from there to the compensated path, mm.
        distance_mm: f64,
    },
    /// The compensated path does not keep half the kerf from the nominal curve.
    #[error(
        "the compensated {role} of piece {piece} is off by {deviation_mm:.4} mm, the limit is {limit_mm} mm; simplify the contour \
         (crossing or repeated stretches) and try again"
    )]
    Deviation {
        /// Name of the piece.
        piece: String,
        /// Role of the path.
        role: &'static str,
        /// What was found, mm.
        deviation_mm: f64,
        /// What is allowed, mm.
        limit_mm: f64,
    },
    /// A run leaves the sheet or what the head can reach.
    #[error(
        "the {role} of piece {piece} leaves the {limit} by {by_mm:.3} mm on its {side} side; move the piece or raise the margin"
    )]
    Outside {
        /// Name of the piece.
        piece: String,
        /// Role of the path.
        role: &'static str,
        /// "sheet" or "work area".
        limit: &'static str,
        /// "left", "right", "lower" or "upper".
        side: &'static str,
        /// How far, mm.
        by_mm: f64,
    },
    /// A run lies where something stands on the bed, or is shut in by it.
    #[error(
        "the {role} of piece {piece} runs into {keep_out:?}, or no way leads to it; put that elsewhere, or take away what stands there and its \
         entry in the machine's keep_outs"
    )]
    KeepOut {
        /// Name of the piece.
        piece: String,
        /// Role of the path.
        role: &'static str,
        /// What stands there.
        keep_out: String,
    },
    /// What stands on the bed shuts the park point in.
    #[error("no way leads back to where the tool parks, past {keep_out:?}; put that elsewhere")]
    NoWayHome {
        /// What stands there.
        keep_out: String,
    },
}
