//! How a long stage speaks to its caller: one trait for progress, stopping and keeping the best; and warnings as values.

use std::ops::ControlFlow;

/// Where a stage stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// What is being done, in the reader's words: "folding", "nesting".
    pub stage: &'static str,
    /// Steps done so far.
    pub done: u64,
    /// Steps there are, 0 when not known.
    pub total: u64,
    /// The figure people watch: "82 % filled", "3 sheets". May be empty.
    pub note: String,
}

/// Listens to a stage. `Break` asks it to stop soon and to return the best it has.
pub trait Observer {
    /// Called between steps; must return quickly.
    fn step(&mut self, progress: Progress) -> ControlFlow<()>;
}

/// An observer that never stops anything: for tests and for callers without a screen.
pub struct Quiet;

impl Observer for Quiet {
    fn step(&mut self, _: Progress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Something the user should know that does not keep the job from being made.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Warning {
    /// Stable word for scripts: "mesh-open", "layer-thin".
    pub code: &'static str,
    /// The sentence people read: what, where, and the way out.
    pub message: String,
    /// Name of the part it is about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// Where: "section 3", "face 17", "x 12.0, y 3.5".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
}

impl Warning {
    /// A warning about the job as a whole.
    pub fn new(code: &'static str, message: impl Into<String>) -> Warning {
        Warning { code, message: message.into(), part: None, place: None }
    }

    /// The same warning, naming where.
    pub fn at(self, place: impl Into<String>) -> Warning {
        Warning { place: Some(place.into()), ..self }
    }

    /// The same warning, naming the part.
    pub fn in_part(self, part: impl Into<String>) -> Warning {
        Warning { part: Some(part.into()), ..self }
    }
}
