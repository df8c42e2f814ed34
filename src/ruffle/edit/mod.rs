//! Changing a ruffle by hand: lengths, density, layers, how finely it is divided.
//!
//! Every edit takes a drawing (or an equilibrium) and gives a new one. Its positions start a solve as they are: the strip does not meet itself. Sections are named
//! by their index as it is before the edit.

mod draft;
mod error;
mod fold;
mod layers;
mod limits;
mod mesh;
mod split;
mod tangle;
mod teardrop;
#[cfg(test)]
mod tests;
mod undensify;

pub use error::EditError;
pub use layers::{insert_layer, layer_count, remove_layer};
pub use limits::Limits;
pub use split::split_layer;

use super::Drawn;
use super::curve::MIN_SEGMENTS;
use draft::Draft;
use limits::{Room, tightest_room};

/// How edits draw, and what they refuse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EditSettings {
    /// Length of a segment, mm, about: sections that an edit touches have segments between this over 1.5 and 1.5 times this, shorter ones only where a section
    /// would have fewer than eight.
    pub segment_mm: f64,
    /// What the sheet and the hands allow.
    pub limits: Limits,
}

impl EditSettings {
    fn check(&self) -> Result<(), EditError> {
        positive("the segment length", self.segment_mm)
    }
}

/// Longest section or layer, mm: no strip is a hundred metres long, and its segments would not fit into memory.
const LONGEST_MM: f64 = 1e5;

fn positive(what: &'static str, value_mm: f64) -> Result<(), EditError> {
    let good = value_mm > 0.0 && value_mm <= LONGEST_MM;
    if good { Ok(()) } else { Err(EditError::Size { what, value_mm }) }
}

/// Takes a drawing apart, and what its tightest room was.
fn open(drawn: &Drawn, settings: &EditSettings) -> Result<(Draft, Option<Room>), EditError> {
    settings.check()?;
    let draft = Draft::of(drawn)?;
    let room = tightest_room(&draft);
    Ok((draft, room))
}

fn open_at(drawn: &Drawn, section: usize, settings: &EditSettings) -> Result<(Draft, Option<Room>), EditError> {
    let count = drawn.ruffle.sections.len();
    if section >= count {
        return Err(EditError::NoSuchSection { section, count });
    }
    open(drawn, settings)
}

/// The drawing of a draft that keeps clear of itself and of the limits.
fn close(draft: &Draft, section: usize, before: Option<Room>, settings: &EditSettings) -> Result<Drawn, EditError> {
    if tangle::tangle(draft).is_some() {
        return Err(undensify::no_room(draft, section));
    }
    settings.limits.judge(before, draft)?;
    draft.drawn()
}

/// Gives a section another rest length, mm. Its nodes stay where they are, or are spread anew along it.
///
/// # Errors
/// A length that is not positive, or that would make a loop crease or a void too small to reach into.
pub fn set_length(drawn: &Drawn, section: usize, length_mm: f64, settings: &EditSettings) -> Result<Drawn, EditError> {
    let (mut draft, before) = open_at(drawn, section, settings)?;
    if !(length_mm > 0.0 && length_mm <= LONGEST_MM) {
        return Err(EditError::Length { section, length_mm });
    }
    let scale = length_mm / draft.parts[section].length_mm();
    draft.parts[section].rest_mm.iter_mut().for_each(|l| *l *= scale);
    mesh::refine(&mut draft, section, settings.segment_mm);
    close(&draft, section, before, settings)
}

/// Makes a section stiffer: five take its place, with new connection points (paper section 3.1).
///
/// A loop has the room behind it divided by three little loops, which hold on to the middles of the room's other two sides. Any other section is folded back
/// on itself. The first and the last of the five keep the section's role, the others are [`Role::Densified`](super::Role::Densified). All can be densified again.
///
/// # Errors
/// No room for the loops where the section lies, or loops tighter than the limits.
pub fn densify(drawn: &Drawn, section: usize, settings: &EditSettings) -> Result<Drawn, EditError> {
    let (draft, before) = open_at(drawn, section, settings)?;
    let mut divided = draft.clone();
    if teardrop::divide_room(&mut divided, section, settings.segment_mm).is_some() {
        return close(&divided, section, before, settings);
    }
    let mut refused = None;
    for share in fold::SHARES {
        let mut folded = draft.clone();
        if fold::fold(&mut folded, section, share, settings.segment_mm).is_none() {
            break;
        }
        match close(&folded, section, before, settings) {
            Ok(drawn) => return Ok(drawn),
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    Err(refused.unwrap_or_else(|| undensify::no_room(&draft, section)))
}

/// Takes back the innermost densification that made `section`, with everything densified inside it. The old section has its role and length again.
///
/// # Errors
/// A section that densifying did not make, or no room to draw the old one.
pub fn undensify(drawn: &Drawn, section: usize, settings: &EditSettings) -> Result<Drawn, EditError> {
    let (mut draft, _) = open_at(drawn, section, settings)?;
    let around = (0..draft.made.len()).filter(|m| draft.made[*m].sections().contains(&section));
    let Some(index) = around.min_by_key(|m| draft.made[*m].sections().len()) else {
        return Err(EditError::NotDensified { section });
    };
    let first = draft.made[index].first_section;
    undensify::take_back(&mut draft, index, settings.segment_mm)?;
    // What was there before may be as tight as it was.
    let settings = EditSettings { limits: Limits::default(), ..*settings };
    close(&draft, first.min(draft.parts.len() - 1), None, &settings)
}

/// Divides every segment of a section in two.
pub fn split_segments(drawn: &Drawn, section: usize, settings: &EditSettings) -> Result<Drawn, EditError> {
    let (mut draft, before) = open_at(drawn, section, settings)?;
    let segments = draft.parts[section].rest_mm.len();
    mesh::divide(&mut draft, section, &vec![2; segments]);
    close(&draft, section, before, settings)
}

/// Divides a section into half as many segments.
///
/// # Errors
/// A section that would have fewer than eight, or a bend so near to another sheet that longer segments would cut through it.
pub fn merge_segments(drawn: &Drawn, section: usize, settings: &EditSettings) -> Result<Drawn, EditError> {
    let (mut draft, before) = open_at(drawn, section, settings)?;
    let segments = draft.parts[section].rest_mm.len();
    if segments / 2 < MIN_SEGMENTS {
        return Err(EditError::TooCoarse { section, segments, least: MIN_SEGMENTS });
    }
    if !mesh::divide_evenly(&mut draft, section, segments / 2) {
        return Err(undensify::no_room(&draft, section));
    }
    close(&draft, section, before, settings)
}
