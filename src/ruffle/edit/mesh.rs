//! How finely sections are divided into segments.

use super::draft::Draft;
use super::tangle::tangle;
use crate::ruffle::curve::{MIN_SEGMENTS, segments_for};

/// A segment is at most this many times the wished length and at least the wished length over this.
pub(super) const BOUND: f64 = 1.5;

/// Brings the segments of a part within bounds around `segment_mm`, except that it keeps [`MIN_SEGMENTS`] however short it is.
///
/// Long segments are divided where they lie, so the polyline stays the same. Short ones are replaced by an even division of the old polyline, unless that would cut
/// through a neighbour: then they stay as they are.
pub(super) fn refine(draft: &mut Draft, part: usize, segment_mm: f64) {
    let rest = &draft.parts[part].rest_mm;
    let most = BOUND * segment_mm;
    let least_pieces = MIN_SEGMENTS.div_ceil(rest.len());
    let pieces: Vec<usize> = rest.iter().map(|l| ((l / most).ceil() as usize).max(least_pieces)).collect();
    if pieces.iter().any(|n| *n > 1) {
        divide(draft, part, &pieces);
    }
    even_out(draft, part, segment_mm);
}

/// Divides segment k of a part into `pieces[k]`.
pub(super) fn divide(draft: &mut Draft, part: usize, pieces: &[usize]) {
    let points = draft.points(part);
    let p = &mut draft.parts[part];
    let mut inner = Vec::new();
    let mut rest_mm = Vec::new();
    for ((ends, rest), n) in points.windows(2).zip(&p.rest_mm).zip(pieces) {
        inner.extend((1..=*n).map(|i| ends[0] + (ends[1] - ends[0]) * (i as f64 / *n as f64)));
        rest_mm.extend(std::iter::repeat_n(rest / *n as f64, *n));
    }
    inner.pop();
    (p.inner, p.rest_mm) = (inner, rest_mm);
}

/// Divides a part anew when its segments are uneven or too short.
fn even_out(draft: &mut Draft, part: usize, segment_mm: f64) {
    let p = &draft.parts[part];
    let (shortest, longest) = p.rest_mm.iter().fold((f64::INFINITY, 0.0_f64), |(s, l), r| (s.min(*r), l.max(*r)));
    let wanted = segments_for(p.length_mm(), segment_mm);
    let too_short = shortest < segment_mm / BOUND && p.rest_mm.len() > wanted;
    let uneven = longest > BOUND * shortest;
    if too_short || uneven {
        divide_evenly(draft, part, wanted);
    }
}

/// Divides a part into `n` equal segments along its old polyline; false, and nothing changed, where that would cut through a neighbour.
pub(super) fn divide_evenly(draft: &mut Draft, part: usize, n: usize) -> bool {
    let points = draft.curve(part).divide(n);
    let length_mm = draft.parts[part].length_mm();
    let old = draft.parts[part].clone();
    draft.parts[part].inner = points[1..n].to_vec();
    draft.parts[part].rest_mm = vec![length_mm / n as f64; n];
    if tangle(draft).is_some() {
        draft.parts[part] = old;
        return false;
    }
    true
}
