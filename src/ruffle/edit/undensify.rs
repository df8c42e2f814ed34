//! Taking a densification back.

use super::EditError;
use super::draft::{Draft, Part};
use super::mesh::refine;
use super::tangle::tangle;
use crate::ruffle::curve::Curve;

/// How much of the two halves of a loop beside their common knot is cut off, as shares: the old loop went straight across there.
const CUTS: [f64; 8] = [0.5, 0.4, 0.3, 0.2, 0.15, 0.1, 0.05, 0.02];

/// Puts back the section that densification `index` replaced, after everything that was densified inside it.
pub(super) fn take_back(draft: &mut Draft, index: usize, segment_mm: f64) -> Result<(), EditError> {
    restore(draft, index, segment_mm)?;
    drop_midpoints(draft, segment_mm)
}

/// The same, with the midpoints that nothing holds on to left where they are.
fn restore(draft: &mut Draft, index: usize, segment_mm: f64) -> Result<(), EditError> {
    // Those inside come after, so `index` stays.
    while let Some(inner) = draft.made.get(index + 1).filter(|m| m.first_section < draft.made[index].end_section) {
        debug_assert!(inner.end_section <= draft.made[index].end_section);
        restore(draft, index + 1, segment_mm)?;
    }
    let run = draft.made[index].sections();
    let made = draft.made.remove(index);
    let (first, last) = (draft.parts[run.start].clone(), draft.parts[run.end - 1].clone());
    let curves = if first.to == last.from {
        let (out, home) = (draft.curve(run.start), draft.curve(run.end - 1));
        let cut = |share: &f64| end_to_end(&[out.part(0.0, 1.0 - share), home.part(*share, 1.0)]);
        let mut curves: Vec<Curve> = CUTS.iter().map(cut).collect();
        curves.sort_by(|a, b| (a.length() - made.length_mm).abs().total_cmp(&(b.length() - made.length_mm).abs()));
        curves
    } else {
        // Folded back on itself: straight through, the middle run the other way.
        let back = draft.curve(run.start + run.len() / 2).part(1.0, 0.0);
        vec![end_to_end(&[draft.curve(run.start), back, draft.curve(run.end - 1)])]
    };
    let ends = [first.from, last.to];
    let mut drafts = curves.iter().map(|curve| {
        let mut draft = draft.clone();
        let restored = draft.part(made.role, ends, curve, made.length_mm, segment_mm);
        draft.replace(run.clone(), vec![restored]);
        draft
    });
    let clear = drafts.find(|d| tangle(d).is_none());
    *draft = clear.ok_or_else(|| no_room(draft, run.start))?;
    Ok(())
}

/// Joins sections again where nothing holds on to the midpoint between them any more.
pub(super) fn drop_midpoints(draft: &mut Draft, segment_mm: f64) -> Result<(), EditError> {
    loop {
        let idle = |k: &usize| draft.midpoint[*k] && draft.passes(*k) == 1;
        let Some(knot) = (0..draft.knots.len()).find(idle) else { return Ok(()) };
        let Some(low) = draft.parts.iter().position(|p: &Part| p.to == knot) else { return Ok(()) };
        // A half that was densified must be a half again first.
        let parted = |made: &crate::ruffle::Densification| {
            made.sections().contains(&low) != made.sections().contains(&(low + 1))
        };
        if let Some(index) = draft.made.iter().position(parted) {
            restore(draft, index, segment_mm)?;
            continue;
        }
        draft.join_parts(low);
        refine(draft, low, segment_mm);
    }
}

fn end_to_end(curves: &[Curve]) -> Curve {
    let mut points: Vec<_> = curves.iter().flat_map(|c| c.points().iter().copied()).collect();
    points.dedup();
    Curve::through(points)
}

/// The error for a section that cannot be redrawn.
pub(super) fn no_room(draft: &Draft, section: usize) -> EditError {
    let at = tangle(draft).unwrap_or_else(|| draft.curve(section).at(0.5));
    EditError::NoRoom { section, u_mm: at.x, v_mm: at.y }
}
