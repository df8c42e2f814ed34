//! More strip in a place, and less again.

use super::draft::Draft;
use super::limits::{Limits, tightest_room};
use super::undensify::{no_room, take_back};
use super::{EditError, EditSettings, check_sections, close, fold, open, teardrop};
use crate::ruffle::Drawn;

/// Makes sections stiffer: five take the place of each, with new connection points (paper section 3.1). `levels` says how often: from the second time on, the loops
/// that the time before made are densified.
///
/// A loop has the room behind it divided by three little loops, which hold on to the middles of the room's other two sides. Any other section is folded back
/// on itself. The first and the last of the five keep the section's role, the others are [`Role::Densified`](crate::ruffle::Role::Densified). All can be densified
/// again. Loops go first, from the last to the first, then the others; a section that a loop has divided in two on the way is folded in both halves, or in one where
/// the other has no room.
///
/// # Errors
/// No room for the loops where a section lies, or loops tighter than the limits: then nothing is changed.
pub fn densify(plain: &Drawn, sections: &[usize], levels: usize, settings: &EditSettings) -> Result<Drawn, EditError> {
    check_sections(plain, sections)?;
    let (mut draft, _) = open(plain, settings)?;
    // The name of what is densified, and the section that was asked for.
    let mut wanted: Vec<(usize, usize)> = sections.iter().map(|s| (*s, *s)).collect();
    wanted.sort_unstable_by(|a, b| b.cmp(a));
    wanted.dedup();
    for level in 0..levels {
        let (loops, others): (Vec<_>, Vec<_>) = wanted
            .into_iter()
            .partition(|(name, _)| draft.named(*name).first().is_some_and(|p| teardrop::closes_room(&draft, *p)));
        wanted = Vec::new();
        for (name, asked) in loops.into_iter().chain(others) {
            let made = densify_named(&mut draft, name, settings).map_err(|e| e.about(asked))?;
            if level + 1 < levels {
                wanted.extend(made.into_iter().map(|name| (name, asked)));
            }
        }
    }
    draft.drawn()
}

/// Densifies the parts of one name; returns the names of the loops that made.
fn densify_named(draft: &mut Draft, name: usize, settings: &EditSettings) -> Result<Vec<usize>, EditError> {
    let mut made = Vec::new();
    let mut refused = None;
    for part in draft.named(name).into_iter().rev() {
        match densified(draft, part, settings) {
            Ok(dense) => {
                // Midpoints may have been put in before it.
                let count = |draft: &Draft| draft.parts.len();
                let new = (0..count(&dense)).filter(|p| draft.parts.iter().all(|old| old.name != dense.parts[*p].name));
                made.extend(new.filter(|p| teardrop::closes_room(&dense, *p)).map(|p| dense.parts[p].name));
                *draft = dense;
            }
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    made.sort_unstable_by(|a, b| b.cmp(a));
    match refused {
        Some(error) if made.is_empty() => Err(error),
        _ => Ok(made),
    }
}

/// The draft with five parts in place of one.
fn densified(draft: &Draft, part: usize, settings: &EditSettings) -> Result<Draft, EditError> {
    let before = tightest_room(draft);
    let mut divided = draft.clone();
    if teardrop::divide_room(&mut divided, part, settings.segment_mm).is_some() {
        return close(divided, part, before, settings);
    }
    let mut refused = None;
    for share in fold::SHARES {
        let mut folded = draft.clone();
        if fold::fold(&mut folded, part, share, settings.segment_mm).is_none() {
            break;
        }
        match close(folded, part, before, settings) {
            Ok(folded) => return Ok(folded),
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    Err(refused.unwrap_or_else(|| no_room(draft, part)))
}

/// Takes back the innermost densification that made each of the sections, with everything densified inside it. The old section has its role and length again.
///
/// # Errors
/// A section that densifying did not make, or no room to draw the old one: then nothing is changed.
pub fn undensify(dense: &Drawn, sections: &[usize], settings: &EditSettings) -> Result<Drawn, EditError> {
    check_sections(dense, sections)?;
    let (mut draft, _) = open(dense, settings)?;
    if let Some(section) = sections.iter().copied().find(|s| innermost(&draft, *s).is_none()) {
        return Err(EditError::NotDensified { section });
    }
    for section in sections {
        // Sections that were made together are taken back together: the first of them takes the others along.
        let Some(part) = draft.named(*section).first().copied() else { continue };
        let Some(index) = innermost(&draft, part) else { continue };
        take_back(&mut draft, index, settings.segment_mm).map_err(|e| e.about(*section))?;
    }
    // What was there before may be as tight as it was.
    let settings = EditSettings { limits: Limits::default(), ..*settings };
    close(draft, 0, None, &settings)?.drawn()
}

/// The smallest densification round a part.
fn innermost(draft: &Draft, part: usize) -> Option<usize> {
    let around = (0..draft.made.len()).filter(|m| draft.made[*m].sections().contains(&part));
    around.min_by_key(|m| draft.made[*m].sections().len())
}

/// Sections that close a room, so that densifying divides that room: loops, of the stack or little ones. Any other is a rung, a diagonal or a side of a room.
///
/// # Errors
/// A ruffle that is broken.
pub fn loops(of: &Drawn) -> Result<Vec<usize>, EditError> {
    let draft = Draft::of(of)?;
    Ok((0..draft.parts.len()).filter(|p| teardrop::closes_room(&draft, *p)).collect())
}
