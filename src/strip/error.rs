//! Why a part cannot be laid flat.

/// Why a part cannot be laid flat.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Flaps slip out of their slits.
    #[error(
        "the joint holds by only {retention_mm:.2} mm on each side when the kerf ({kerf_mm:.2} mm) is 0.05 mm off, {least_mm:.2} mm are needed; make slit_extra_mm smaller or barb_mm larger in the material's joint"
    )]
    FallsOpen {
        /// Least hold over all tolerances.
        retention_mm: f64,
        /// What is needed.
        least_mm: f64,
        /// Kerf.
        kerf_mm: f64,
    },
    /// The neck is shorter than the sheets it goes round are thick.
    #[error(
        "the flap's neck is {short_mm:.2} mm too short for two sheets 10 % thicker than {thickness_mm:.2} mm; make neck_length_mm larger in the material's joint"
    )]
    NeckShort {
        /// How much is missing.
        short_mm: f64,
        /// Thickness of a sheet.
        thickness_mm: f64,
    },
    /// No place for a splice.
    #[error(
        "part {part}: the strip cannot be divided for pieces of {max_piece_mm:.0} mm: between {from_mm:.0} and {to_mm:.0} mm there is no place for a splice, clear of joints and of the crowns of loops; use longer stock (--stock), another splice, or fewer layers"
    )]
    NoRoomForSplice {
        /// The part.
        part: String,
        /// Where the search began.
        from_mm: f64,
        /// And ended.
        to_mm: f64,
        /// Longest piece.
        max_piece_mm: f64,
    },
    /// A connector names a joint that is not there.
    #[error(
        "a connector names joint {part}{joint}, but part {part} has joints {part}1 to {part}{last}; parts/{part}.svg shows them"
    )]
    NoSuchJoint {
        /// The part.
        part: String,
        /// Number asked for.
        joint: u32,
        /// Highest number there is.
        last: usize,
    },
    /// A connector has nothing to hold on to.
    #[error("a connector from {from} to {to} finds no flap at one of them: tie another joint")]
    NoFlap {
        /// Joint at one end.
        from: String,
        /// Joint at the other.
        to: String,
    },
}
