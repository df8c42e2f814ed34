//! Why a card cannot be made or an answer not used.

/// A card or an answer that makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The tool has nothing to find out there.
    #[error(
        "{machine} is no laser: there is no {what} to measure; `calibrate joint` and `calibrate stiffness` work with every tool"
    )]
    NoLaser {
        /// The machine.
        machine: String,
        /// What was to be measured.
        what: &'static str,
    },
    /// A test's drawing is larger than the card.
    #[error(
        "the {what} needs {needed_mm:.0} mm of the card, which has {room_mm:.0} mm inside its margins; use a material with a narrower joint or margin"
    )]
    NoRoom {
        /// The sample.
        what: &'static str,
        /// What it needs, mm.
        needed_mm: f64,
        /// What there is, mm.
        room_mm: f64,
    },
    /// An answer to a question that was not asked.
    #[error("`{key}` is no question of this card; it asks for {known}")]
    UnknownKey {
        /// What was given.
        key: String,
        /// What could be given.
        known: String,
    },
    /// An answer that is none.
    #[error("{key}: `{answer}` is no answer; it takes {needed}")]
    Answer {
        /// The question's key.
        key: &'static str,
        /// What was given.
        answer: String,
        /// What is allowed.
        needed: String,
    },
    /// A strip that no stiffness explains.
    #[error(
        "{key}: a strip that reaches {overhang_mm} mm over the edge cannot hang {drop_mm} mm below it so that a stiffness follows; the drop is between 1 % and 90 % of the reach: let more of it reach out when it hangs too little, less when it hangs straight down"
    )]
    Hanging {
        /// The question's key.
        key: &'static str,
        /// Length over the edge, mm.
        overhang_mm: f64,
        /// How far the tip hangs, mm.
        drop_mm: f64,
    },
}

impl Error {
    /// True when what was answered is at fault, and not the card.
    pub fn is_answer(&self) -> bool {
        match self {
            Error::UnknownKey { .. } | Error::Answer { .. } | Error::Hanging { .. } => true,
            Error::NoLaser { .. } | Error::NoRoom { .. } => false,
        }
    }
}
