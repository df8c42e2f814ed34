//! Changing a ruffle by hand: lengths, density, layers, how finely it is divided.
//!
//! Every edit takes a drawing (or an equilibrium) and gives a new one. Its positions start a solve as they are: the strip does not meet itself. Sections are named
//! by their index as it is before the edit.

mod density;
mod draft;
mod error;
mod fold;
mod layers;
mod limits;
mod mesh;
mod move_joint;
mod split;
mod tangle;
mod teardrop;
#[cfg(test)]
mod tests;
mod undensify;

pub use density::{densify, loops, undensify};
pub use error::EditError;
pub use layers::{insert_layer, layer_count, remove_layer};
pub use limits::Limits;
pub use move_joint::move_joint;
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

/// Refuses sections that a drawing does not have.
fn check_sections(drawn: &Drawn, sections: &[usize]) -> Result<(), EditError> {
    let count = drawn.ruffle.sections.len();
    let missing = sections.iter().copied().find(|s| *s >= count);
    missing.map_or(Ok(()), |section| Err(EditError::NoSuchSection { section, count }))
}

fn open_at(drawn: &Drawn, section: usize, settings: &EditSettings) -> Result<(Draft, Option<Room>), EditError> {
    check_sections(drawn, &[section])?;
    open(drawn, settings)
}

/// A draft that keeps clear of itself and of the limits.
fn close(draft: Draft, section: usize, before: Option<Room>, settings: &EditSettings) -> Result<Draft, EditError> {
    if tangle::tangle(&draft).is_some() {
        return Err(undensify::no_room(&draft, section.min(draft.parts.len() - 1)));
    }
    settings.limits.judge(before, &draft)?;
    Ok(draft)
}

/// Gives a section another rest length, mm, and keeps it there: filling leaves it alone ([`Section::pinned`](super::Section::pinned)). Its nodes stay where they are,
/// or are spread anew along it. But a part of the foot's rung, whose ends may be held where they are drawn, is drawn as long as it is at rest: everything to its right
/// moves with it.
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
    draft.parts[section].pinned = true;
    if foot_rung(&draft).contains(&section) {
        stretch_drawing(&mut draft, section, scale);
    }
    mesh::refine(&mut draft, section, settings.segment_mm);
    close(draft, section, before, settings)?.drawn()
}

/// Parts of the bottom rung, when it is not densified: those from the strip's start to the foot's other end.
fn foot_rung(draft: &Draft) -> std::ops::Range<usize> {
    let [left, right] = draft.foot;
    let end = draft.parts.iter().position(|p| p.to == right).map_or(0, |p| p + 1);
    let plain = draft.made.iter().all(|m| m.first_section >= end);
    if plain && draft.parts.first().is_some_and(|p| p.from == left) { 0..end } else { 0..0 }
}

/// Stretches the drawing between the ends of a part along u, and moves what lies beyond. Nothing that was apart comes to meet.
fn stretch_drawing(draft: &mut Draft, part: usize, scale: f64) {
    let (from, to) = (draft.knots[draft.parts[part].from].x, draft.knots[draft.parts[part].to].x);
    let (low, high) = (from.min(to), from.max(to));
    let stretched = |p: &mut crate::geom::P2| p.x += (scale - 1.0) * (p.x.min(high) - low).max(0.0);
    draft.knots.iter_mut().for_each(stretched);
    draft.parts.iter_mut().flat_map(|p| p.inner.iter_mut()).for_each(stretched);
}

/// Divides every segment of a section in two.
pub fn split_segments(drawn: &Drawn, section: usize, settings: &EditSettings) -> Result<Drawn, EditError> {
    let (mut draft, before) = open_at(drawn, section, settings)?;
    let segments = draft.parts[section].rest_mm.len();
    mesh::divide(&mut draft, section, &vec![2; segments]);
    close(draft, section, before, settings)?.drawn()
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
    close(draft, section, before, settings)?.drawn()
}
