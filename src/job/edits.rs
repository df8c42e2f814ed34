//! A part's edits, done to a drawing in their order.

use super::Error;
use crate::design::{Design, Edit};
use crate::fit;
use crate::geom::P2;
use crate::ruffle::{self, Drawn, EditError, EditSettings};
use std::cell::Cell;

/// The edits of one part.
pub(super) struct PartEdits<'a> {
    edits: Vec<(usize, &'a Edit)>,
    settings: EditSettings,
    /// Number in the design's list of the first that was refused.
    refused: Cell<Option<usize>>,
}

impl<'a> PartEdits<'a> {
    /// Those of part `part` that change its strip; `None` when there are none.
    pub fn of(design: &'a Design, part: &'a str, settings: EditSettings) -> Option<PartEdits<'a>> {
        let edits: Vec<(usize, &Edit)> = design.strip_edits(part).collect();
        (!edits.is_empty()).then_some(PartEdits { edits, settings, refused: Cell::new(None) })
    }

    /// The clean drawing with everything done to it.
    pub fn done(&self, clean: &Drawn) -> Result<Drawn, EditError> {
        let mut drawn = clean.clone();
        for (number, edit) in &self.edits {
            drawn = done(edit, &drawn, &self.settings).inspect_err(|_| {
                self.refused.set(self.refused.get().or(Some(*number)));
            })?;
        }
        Ok(drawn)
    }

    /// A failure to fill that names the edit, where an edit is to blame.
    pub fn named(&self, error: fit::Error) -> Error {
        match (error, self.refused.get()) {
            (fit::Error::Edit { source, .. }, Some(number)) => {
                let edit = self.edits.iter().find(|(n, _)| *n == number);
                let what = edit.map_or_else(String::new, |(_, edit)| edit.to_string());
                Error::Edit { place: String::new(), number, what, source }
            }
            (other, _) => other.into(),
        }
    }
}

fn done(edit: &Edit, drawn: &Drawn, settings: &EditSettings) -> Result<Drawn, EditError> {
    match edit {
        Edit::Densify { sections, levels, .. } => ruffle::densify(drawn, sections, *levels, settings),
        Edit::Undensify { sections, .. } => ruffle::undensify(drawn, sections, settings),
        Edit::Length { sections, length_mm, factor, .. } => {
            let mut changed = drawn.clone();
            for section in sections {
                let count = changed.ruffle.sections.len();
                if *section >= count {
                    return Err(EditError::NoSuchSection { section: *section, count });
                }
                let times = factor.unwrap_or(1.0) * changed.ruffle.section_length(*section);
                changed = ruffle::set_length(&changed, *section, length_mm.unwrap_or(times), settings)?;
            }
            Ok(changed)
        }
        Edit::MovePoint { joint, to_mm: [u, v], .. } => ruffle::move_joint(drawn, *joint, P2::new(*u, *v), settings),
        // How a strip is drawn to begin with is decided before it is drawn.
        Edit::Layers { .. } | Edit::Plane { .. } => Ok(drawn.clone()),
    }
}
