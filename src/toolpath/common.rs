//! Straight edges that two outlines share, cut once.
//!
//! Pieces laid a kerf apart have tool paths that lie on each other. The first outline keeps the edge, every later one leaves the shared stretch out.

use super::cuts::Cut;
use crate::drawing::Operation;
use crate::geom::{Segment, V2, cross};
use std::ops::Range;

/// Two lines are one when they lie within this of each other, mm: less than a motor step.
const SAME_LINE_MM: f64 = 0.01;

/// Shared stretches shorter than this, mm, are cut twice: leaving them out would cost more in travel than it saves.
const LEAST_MM: f64 = 2.0;

/// Leaves out of every outline what an earlier one cuts already.
pub(super) fn share(cuts: &mut [Cut]) {
    for later in 1..cuts.len() {
        let (before, rest) = cuts.split_at_mut(later);
        let cut = &mut rest[0];
        if cut.operation != Operation::CutOutline {
            continue;
        }
        let mut along = 0.0;
        let mut shared: Vec<Range<f64>> = Vec::new();
        for segment in cut.path.segments() {
            let others = before.iter().filter(|c| c.operation == Operation::CutOutline && c.piece != cut.piece);
            for other in others.flat_map(|c| c.path.segments()) {
                shared.extend(overlap(&segment, &other).map(|r| along + r.start..along + r.end));
            }
            along += segment.length();
        }
        for stretch in shared {
            cut.leave_out(stretch);
        }
    }
}

/// The stretch of a line, mm from its start, that another line covers.
fn overlap(segment: &Segment, other: &Segment) -> Option<Range<f64>> {
    let (Segment::Line { from, to }, Segment::Line { from: c, to: d }) = (*segment, *other) else { return None };
    let length = (to - from).norm();
    let along: V2 = (to - from) / length;
    if [c, d].iter().any(|p| cross(along, p - from).abs() > SAME_LINE_MM) {
        return None;
    }
    let (s, t) = (along.dot(&(c - from)), along.dot(&(d - from)));
    let range = s.min(t).max(0.0)..s.max(t).min(length);
    (range.end - range.start > LEAST_MM).then_some(range)
}

#[cfg(test)]
mod tests {
    use super::super::cuts::tests::cut;
    use super::*;
    use crate::drawing::Role;
    use crate::geom::{P2, Path};

    fn square(x: f64, y: f64, piece: &str) -> Cut {
        let corners = [(x, y), (x + 10.0, y), (x + 10.0, y + 10.0), (x, y + 10.0)];
        Cut { piece: piece.into(), ..cut(Path::closed(corners.map(|(x, y)| P2::new(x, y))), Role::Outline) }
    }

    #[test]
    fn a_shared_edge_is_left_out_of_the_second_piece_and_no_other() {
        let mut cuts = [square(0.0, 0.0, "A1"), square(10.0, 4.0, "A2"), square(30.0, 0.0, "A3")];
        share(&mut cuts);
        let made = |c: &Cut| c.made().iter().map(|s| s.end - s.start).sum::<f64>();
        assert!((made(&cuts[0]) - 40.0).abs() < 1e-9);
        assert!((made(&cuts[1]) - 34.0).abs() < 1e-9, "{:?}", cuts[1].gaps);
        assert!((made(&cuts[2]) - 40.0).abs() < 1e-9);
    }

    #[test]
    fn edges_a_kerf_apart_are_two() {
        let mut cuts = [square(0.0, 0.0, "A1"), square(10.15, 0.0, "A2")];
        share(&mut cuts);
        assert!(cuts.iter().all(|c| c.gaps.is_empty()));
    }
}
