//! Moving a connection point by hand.

use super::draft::Draft;
use super::mesh::refine;
use super::{EditError, EditSettings, open, tangle};
use crate::geom::{P2, V2};
use crate::ruffle::curve::smooth;
use crate::ruffle::{Drawn, Role};

/// Moves joint `joint` (as numbered, from 1) to `to`, plane frame, mm. The sections that end there are redrawn and get the lengths they are drawn with; those of
/// them that are inner ones keep these lengths from now on ([`Section::pinned`](crate::ruffle::Section::pinned)), since they are what holds the joint in its place.
/// Loops are left to fill what is left (paper section 3.2, figure 9).
///
/// # Errors
/// No such joint, or a place to which it cannot go without the strip meeting itself.
pub fn move_joint(plain: &Drawn, joint: u32, to: P2, settings: &EditSettings) -> Result<Drawn, EditError> {
    let points = plain.ruffle.connection_points();
    let no_such = EditError::NoSuchJoint { joint, count: points.len() };
    let point = points.into_iter().find(|c| c.joint == joint).ok_or(no_such)?;
    if !(to.x.is_finite() && to.y.is_finite()) {
        return Err(EditError::JointBlocked { joint, u_mm: to.x, v_mm: to.y });
    }
    let (mut draft, before) = open(plain, settings)?;
    // The strip meets itself at ends of sections only.
    let knot = draft.knot_at(&plain.ruffle, point.passes[0]).ok_or(EditError::Foot)?;
    let by = to - draft.knots[knot];
    for part in 0..draft.parts.len() {
        shift(&mut draft, part, knot, by);
    }
    draft.knots[knot] = to;
    for part in 0..draft.parts.len() {
        if [draft.parts[part].from, draft.parts[part].to].contains(&knot) {
            refine(&mut draft, part, settings.segment_mm);
        }
    }
    if tangle::tangle(&draft).is_some() {
        return Err(EditError::JointBlocked { joint, u_mm: to.x, v_mm: to.y });
    }
    settings.limits.judge(before, &draft)?;
    draft.drawn()
}

/// Moves a part with a knot it ends on, its far end not at all, and gives it the length it is then drawn with.
fn shift(draft: &mut Draft, part: usize, knot: usize, by: V2) {
    let (at_start, at_end) = (draft.parts[part].from == knot, draft.parts[part].to == knot);
    if !at_start && !at_end {
        return;
    }
    let way = |points: &[P2]| points.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>();
    let mut points = draft.points(part);
    let drawn_mm = way(&points);
    let p = &mut draft.parts[part];
    let length_mm = p.length_mm();
    let mut along_mm = 0.0;
    let last = points.len() - 1;
    for (k, point) in points.iter_mut().enumerate() {
        let share = along_mm / length_mm;
        let near = |end: bool, away: f64| if end { smooth(1.0 - away) } else { 0.0 };
        *point += by * (near(at_start, share) + near(at_end, 1.0 - share)).min(1.0);
        along_mm += p.rest_mm.get(k).copied().unwrap_or(0.0);
    }
    let scale = way(&points) / drawn_mm;
    p.inner = points[1..last].to_vec();
    p.rest_mm.iter_mut().for_each(|l| *l *= scale);
    p.pinned |= p.role == Role::Inner;
}
