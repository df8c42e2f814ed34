//! A part's edits, done to a drawing in their order.

use super::Error;
use crate::design::{Design, Edit};
use crate::fit;
use crate::geom::P2;
use crate::ruffle::{self, Drawn, EditError, EditSettings, Limits};
use std::cell::Cell;

/// The edits of one part.
pub(super) struct PartEdits<'a> {
    edits: Vec<(usize, &'a Edit)>,
    limits: Limits,
    /// Number in the design's list of the first that was refused.
    refused: Cell<Option<usize>>,
}

impl<'a> PartEdits<'a> {
    /// Those of part `part` that change its strip.
    pub fn of(design: &'a Design, part: &'a str, limits: Limits) -> PartEdits<'a> {
        PartEdits { edits: design.strip_edits(part).collect(), limits, refused: Cell::new(None) }
    }

    /// Whether there are any.
    pub fn any(&self) -> bool {
        !self.edits.is_empty()
    }

    /// The clean drawing with everything done to it.
    pub fn done(&self, clean: &Drawn) -> Result<Drawn, EditError> {
        // Edited sections are divided as finely as the others.
        let segment_mm = clean.ruffle.rest_lengths.iter().copied().fold(0.0, f64::max);
        let settings = EditSettings { segment_mm, limits: self.limits };
        let mut drawn = clean.clone();
        for (number, edit) in &self.edits {
            drawn = done(edit, &drawn, &settings).inspect_err(|_| {
                self.refused.set(self.refused.get().or(Some(*number)));
            })?;
        }
        Ok(drawn)
    }

    /// A failure to fill that names the edit, where an edit is to blame.
    pub fn named(&self, error: fit::Error) -> Error {
        match error {
            fit::Error::Edit { source, .. } => self.refusal(source),
            other => other.into(),
        }
    }

    /// The refusal of the edit that was refused.
    pub fn refusal(&self, source: EditError) -> Error {
        let refused = self.edits.iter().find(|(n, _)| Some(*n) == self.refused.get());
        let (number, what) = refused.map_or((0, String::new()), |(number, edit)| (*number, edit.to_string()));
        Error::Edit { place: String::new(), number, what, source }
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
