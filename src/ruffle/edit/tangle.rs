//! Whether a drawing may start a solve: the strip does not meet itself except where it is connected.

use super::draft::Draft;
use crate::geom::{MotionTree, P2, Rect, distance_to_segment, segments_cross};

/// Sheets nearer than this, mm, lie on each other: the order in which they lie is lost to rounding.
const TOUCH_MM: f64 = 1e-6;

/// A place where the drawing meets itself.
pub(super) fn tangle(draft: &Draft) -> Option<P2> {
    let mut x: Vec<P2> = draft.knots.clone();
    let mut segments: Vec<[usize; 2]> = Vec::new();
    for part in &draft.parts {
        let first = x.len();
        x.extend_from_slice(&part.inner);
        let nodes = std::iter::once(part.from).chain(first..x.len()).chain([part.to]);
        let nodes: Vec<usize> = nodes.collect();
        segments.extend(nodes.windows(2).map(|w| [w[0], w[1]]));
    }
    let mut boxes = MotionTree::default();
    boxes.fill(segments.iter().map(|s| [Rect::around([&x[s[0]], &x[s[1]]]).grown(TOUCH_MM); 2]));
    let mut found = None;
    boxes.near(&boxes, &mut |k, other| {
        if other > k && found.is_none() && meet(&x, segments[k], segments[other]) {
            found = Some(nalgebra::center(&x[segments[k][0]], &x[segments[k][1]]));
        }
    });
    found
}

/// True when two segments cross or touch, elsewhere than in a node they share.
fn meet(x: &[P2], s: [usize; 2], t: [usize; 2]) -> bool {
    let shared = s.iter().any(|i| t.contains(i));
    if !shared && segments_cross(x[s[0]], x[s[1]], x[t[0]], x[t[1]]) {
        return true;
    }
    let touches =
        |node: usize, [a, b]: [usize; 2]| node != a && node != b && distance_to_segment(x[node], x[a], x[b]) < TOUCH_MM;
    s.iter().any(|i| touches(*i, t)) || t.iter().any(|i| touches(*i, s))
}
