//! What the user changed about a strip before it settles.

use crate::ruffle::{Drawn, EditError};

/// Changes to every drawing before it settles. Sections that they pin ([`Section::pinned`](crate::ruffle::Section::pinned)) keep their lengths.
///
/// With edits every start has the same number of layers, the one asked for or that of the first start, so that sections keep their numbers.
#[derive(Clone, Copy)]
pub struct Edits<'a> {
    /// Makes the edited drawing from a plain one.
    pub apply: &'a dyn Fn(&Drawn) -> Result<Drawn, EditError>,
}

impl Edits<'_> {
    /// The edited drawing.
    pub(super) fn edited(&self, plain: &Drawn) -> Result<Drawn, EditError> {
        (self.apply)(plain)
    }
}
