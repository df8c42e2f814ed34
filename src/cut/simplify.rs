//! Fewer points, the same shape.

use super::Outline;
use crate::geom::{P2, Rect, cross, distance_to_segment, signed_area};

/// The tolerance is halved this often before the outline is kept as it is.
const HALVINGS: u32 = 6;

/// The outline with as few of its points as keep every dropped one within `tolerance_mm` of the new border (Douglas and Peucker 1973,
/// doi:10.3138/FM57-6770-U75U-7727). Where that would make loops cross, touch or collapse, the tolerance is halved until it does not.
pub(super) fn simplify(outline: &Outline, tolerance_mm: f64) -> Outline {
    (0..HALVINGS)
        .map(|halvings| {
            let tolerance = tolerance_mm / f64::from(1 << halvings);
            Outline {
                outer: thin_out(&outline.outer, tolerance),
                holes: outline.holes.iter().map(|hole| thin_out(hole, tolerance)).collect(),
            }
        })
        .find(|thinner| keeps_sides(outline, thinner) && is_simple(thinner))
        .unwrap_or_else(|| outline.clone())
}

/// True when every loop still runs round an area, the same way.
fn keeps_sides(before: &Outline, after: &Outline) -> bool {
    before.loops().zip(after.loops()).all(|(b, a)| a.len() > 2 && signed_area(a) * signed_area(b) > 0.0)
}

/// Douglas and Peucker on a closed loop, from its lowest point and the point furthest from it: both are kept.
fn thin_out(points: &[P2], tolerance: f64) -> Vec<P2> {
    let n = points.len();
    let by_height =
        |a: &usize, b: &usize| points[*a].y.total_cmp(&points[*b].y).then(points[*a].x.total_cmp(&points[*b].x));
    let Some(start) = (0..n).min_by(by_height) else { return Vec::new() };
    let at = |i: usize| points[(start + i) % n];
    let far = (1..n).max_by(|a, b| (at(*a) - at(0)).norm().total_cmp(&(at(*b) - at(0)).norm())).unwrap_or(0);
    let mut keep = vec![false; n + 1];
    (keep[0], keep[far], keep[n]) = (true, true, true);
    let mut runs = vec![(0, far), (far, n)];
    while let Some((from, to)) = runs.pop() {
        let off = |i: usize| distance_to_segment(at(i), at(from), at(to));
        if let Some(worst) = (from + 1..to).max_by(|a, b| off(*a).total_cmp(&off(*b)))
            && off(worst) > tolerance
        {
            keep[worst] = true;
            runs.extend([(from, worst), (worst, to)]);
        }
    }
    (0..n).filter(|i| keep[*i]).map(at).collect()
}

/// True when no two edges, of one loop or of different ones, cross or touch other than in a corner they share.
fn is_simple(outline: &Outline) -> bool {
    let mut edges: Vec<(P2, P2, Rect)> = outline
        .loops()
        .flat_map(|l| (0..l.len()).map(|i| (l[i], l[(i + 1) % l.len()])))
        .map(|(a, b)| (a, b, Rect::around([&a, &b])))
        .collect();
    edges.sort_by(|a, b| a.2.min.x.total_cmp(&b.2.min.x));
    edges.iter().enumerate().all(|(i, (a, b, bounds))| {
        let near = edges[i + 1..].iter().take_while(|(_, _, other)| other.min.x <= bounds.max.x);
        near.filter(|(_, _, other)| other.min.y <= bounds.max.y && bounds.min.y <= other.max.y)
            .all(|(c, d, _)| !clash(*a, *b, *c, *d))
    })
}

/// True when two edges share a point that is not a common corner.
fn clash(a: P2, b: P2, c: P2, d: P2) -> bool {
    let side = |p: P2, q: P2, r: P2| {
        let s = cross(q - p, r - p);
        i32::from(s > 0.0) - i32::from(s < 0.0)
    };
    let within = |p: P2, q: P2, r: P2| r != p && r != q && side(p, q, r) == 0 && (r - p).dot(&(r - q)) <= 0.0;
    let crosses = side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
    crosses || within(a, b, c) || within(a, b, d) || within(c, d, a) || within(c, d, b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::distance_to_loop;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn outline(outer: Vec<P2>) -> Outline {
        Outline { outer, holes: Vec::new() }
    }

    #[test]
    fn points_on_straight_lines_go_and_corners_stay() {
        let outer = [(0.0, 0.0), (1.0, 0.0), (4.0, 0.05), (9.0, 0.0), (9.0, 5.0), (9.0, 9.0), (0.0, 9.0), (0.0, 2.0)];
        let thin = simplify(&outline(outer.map(|(x, y)| P2::new(x, y)).to_vec()), 0.1);
        assert_eq!(thin.outer, [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)].map(|(x, y)| P2::new(x, y)));
    }

    #[test]
    fn a_hole_does_not_come_to_stick_out() {
        // A bump of 0.9 on the border, and a hole whose tip of 1.2 reaches up into it: dropping the bump alone would let the tip out.
        let border = [(0.0, 0.0), (20.0, 0.0), (20.0, 9.0), (15.0, 9.0), (10.0, 9.9), (5.0, 9.0), (0.0, 9.0)];
        let hole = [(6.0, 8.5), (10.0, 9.7), (14.0, 8.5), (14.0, 4.0), (6.0, 4.0)];
        let mut hole: Vec<P2> = hole.map(|(x, y)| P2::new(x, y)).to_vec();
        if signed_area(&hole) > 0.0 {
            hole.reverse();
        }
        let before = Outline { outer: border.map(|(x, y)| P2::new(x, y)).to_vec(), holes: vec![hole] };
        assert!(is_simple(&before));
        assert!(is_simple(&simplify(&before, 0.95)));
        assert!(!is_simple(&Outline { outer: thin_out(&before.outer, 0.95), holes: before.holes.clone() }));
    }

    proptest! {
        #[test]
        fn what_is_left_is_simple_and_close(
            radii in prop::collection::vec(5.0..10.0f64, 8..200), tolerance in 0.01..3.0f64,
        ) {
            let turn = |i: usize| TAU * i as f64 / radii.len() as f64;
            let outer: Vec<P2> = radii.iter().enumerate().map(|(i, r)| P2::new(r * turn(i).cos(), r * turn(i).sin())).collect();
            let before = outline(outer);
            let thin = simplify(&before, tolerance);
            prop_assert!(is_simple(&thin));
            prop_assert!(signed_area(&thin.outer) > 0.0);
            for p in &before.outer {
                prop_assert!(distance_to_loop(&thin.outer, *p) <= tolerance + 1e-9);
            }
        }
    }
}
