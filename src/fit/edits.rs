//! What the user decided about a strip: edits of its drawing, and lengths that filling must leave alone.

use crate::ruffle::{Drawn, EditError};

/// Changes to every drawing before it settles.
///
/// With edits every start has the same number of layers, the one asked for or that of the first start, so that sections keep their numbers.
#[derive(Clone, Copy)]
pub struct Edits<'a> {
    /// Makes the edited drawing from a plain one.
    pub apply: &'a dyn Fn(&Drawn) -> Result<Drawn, EditError>,
    /// Sections, numbered as they are after the edits, with the rest lengths (mm) they are to have.
    pub lengths_mm: &'a [(usize, f64)],
}

impl Edits<'_> {
    /// The edited drawing.
    pub(super) fn edited(&self, plain: &Drawn) -> Result<Drawn, EditError> {
        let mut drawn = (self.apply)(plain)?;
        let count = drawn.ruffle.sections.len();
        for (section, length_mm) in self.lengths_mm.iter().copied() {
            if section >= count {
                return Err(EditError::NoSuchSection { section, count });
            }
            if !(length_mm > 0.0 && length_mm.is_finite()) {
                return Err(EditError::Length { section, length_mm });
            }
            drawn.ruffle.set_section_length(section, length_mm);
        }
        Ok(drawn)
    }

    /// Whether the user set the length of `section`.
    pub(super) fn pins(&self, section: usize) -> bool {
        self.lengths_mm.iter().any(|(pinned, _)| *pinned == section)
    }
}
