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
        Edit::Layers { .. } | Edit::Plane { .. } | Edit::Split { .. } => Ok(drawn.clone()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::edit_tests::any_edit;
    use crate::ruffle::uniform_stack;
    use proptest::prelude::*;

    fn design(edits: Vec<Edit>) -> Design {
        let text = "schema = 1\nmachine = \"m\"\nmaterial = \"p\"\n[[part]]\nname = \"A\"\nstack = { layers = 2, inner_mm = 60, outer_mm = 47 }\nwidth_mm = 30\n";
        Design { edits, ..Design::parse("d.toml", text).unwrap() }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]
        #[test]
        fn any_edits_leave_a_sound_ruffle_or_are_refused_by_number(edits in prop::collection::vec(any_edit(14), 1..6)) {
            let design = design(edits);
            let own = PartEdits::of(&design, "A", Limits::default());
            let clean = uniform_stack(2, 30.0, 60.0, 3.0);
            match own.done(&clean) {
                Ok(drawn) => {
                    prop_assert_eq!(drawn.ruffle.check(), Ok(()));
                    prop_assert_eq!(&own.done(&clean).unwrap(), &drawn, "the same again");
                }
                Err(EditError::Flaw(flaw)) => prop_assert!(false, "{}", flaw),
                Err(error) => {
                    let Error::Edit { number, what, .. } = own.refusal(error) else { unreachable!() };
                    prop_assert_eq!(&design.edits[number - 1].to_string(), &what);
                }
            }
        }
    }

    #[test]
    fn sections_are_numbered_as_the_edit_before_left_them() {
        let densify = |sections| Edit::Densify { part: "A".into(), sections, levels: 1, on: None };
        let clean = uniform_stack(2, 30.0, 60.0, 3.0);
        // Densifying loop 1 puts six sections more before loop 3.
        let design = design(vec![densify(vec![1]), densify(vec![9])]);
        let one_by_one = PartEdits::of(&design, "A", Limits::default()).done(&clean).unwrap();
        let settings = EditSettings { segment_mm: 3.2, limits: Limits::default() };
        let loops = ruffle::loops(&ruffle::densify(&clean, &[1], 1, &settings).unwrap()).unwrap();
        assert!(loops.contains(&9), "{loops:?}");
        assert_eq!(one_by_one.ruffle.densified.made.len(), 2);
    }
}
