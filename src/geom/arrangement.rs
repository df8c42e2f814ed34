//! Exact areas of what a strip encloses, by a constrained triangulation flooded from outside.

use super::{P2, cross, signed_area};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// How well a set of segments fills a target region; all areas in the square of the input's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coverage {
    /// Area of the target.
    pub target: f64,
    /// Area the segments enclose: everything that cannot be reached from far away without crossing one.
    pub enclosed: f64,
    /// Enclosed area inside the target.
    pub covered: f64,
}

impl Coverage {
    /// Target area left empty over target area.
    pub fn uncovered_fraction(&self) -> f64 {
        (self.target - self.covered) / self.target
    }

    /// Enclosed area outside the target over target area.
    pub fn protruding_fraction(&self) -> f64 {
        (self.enclosed - self.covered) / self.target
    }
}

/// Points are snapped to multiples of this before triangulating (2^-20, about 1e-6): touching strips then share vertices instead of
/// making slivers below the round-off of an intersection, and spade's smallest allowed coordinate is far away.
const GRID: f64 = 1.0 / 1_048_576.0;

/// Areas enclosed by `segments`, and how much of them lies in the region bounded by `loops` (outer loop counter-clockwise, holes
/// clockwise). Segments may cross, touch, repeat or have no length; segments with a coordinate that is not finite are passed over.
pub fn coverage(segments: &[(P2, P2)], loops: &[&[P2]]) -> Coverage {
    let target = loops.iter().map(|l| signed_area(l)).sum();
    let mut result = Coverage { target, enclosed: 0.0, covered: 0.0 };
    for triangle in enclosed_triangles(segments) {
        result.enclosed += signed_area(&triangle);
        result.covered += loops.iter().map(|l| signed_area(&clip(l, &triangle))).sum::<f64>();
    }
    result
}

/// Counter-clockwise triangles that tile the region `segments` enclose.
fn enclosed_triangles(segments: &[(P2, P2)]) -> Vec<[P2; 3]> {
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let snap = |p: P2| Point2::new((p.x / GRID).round() * GRID, (p.y / GRID).round() * GRID);
    for (a, b) in segments {
        let ends = (cdt.insert(snap(*a)), cdt.insert(snap(*b)));
        if let (Ok(a), Ok(b)) = ends
            && a != b
        {
            cdt.add_constraint_and_split(a, b, |p| p);
        }
    }

    let mut outside = vec![false; cdt.num_all_faces()];
    let mut frontier = vec![cdt.outer_face().fix()];
    outside[frontier[0].index()] = true;
    while let Some(face) = frontier.pop() {
        let border: Vec<_> = match cdt.face(face).as_inner() {
            Some(inner) => inner.adjacent_edges().to_vec(),
            None => cdt.convex_hull().collect(),
        };
        for edge in border {
            // The hull's edges already lie on the outer face; an inner face's edges have it on their left.
            let across = edge.rev().face().fix();
            if !edge.is_constraint_edge() && !outside[across.index()] {
                outside[across.index()] = true;
                frontier.push(across);
            }
        }
    }
    cdt.inner_faces()
        .filter(|face| !outside[face.fix().index()])
        .map(|face| face.positions().map(|p| P2::new(p.x, p.y)))
        .collect()
}

/// The part of `polygon` inside a counter-clockwise convex `clipper` (Sutherland and Hodgman 1974, doi:10.1145/360767.360802). A concave
/// polygon may come back with edges that run there and back; its signed area is right all the same.
fn clip(polygon: &[P2], clipper: &[P2; 3]) -> Vec<P2> {
    let mut points = polygon.to_vec();
    for i in 0..3 {
        let (a, b) = (clipper[i], clipper[(i + 1) % 3]);
        let side = |p: P2| cross(b - a, p - a);
        let n = points.len();
        let mut kept = Vec::with_capacity(n + 4);
        for k in 0..n {
            let (p, q) = (points[k], points[(k + 1) % n]);
            let (sp, sq) = (side(p), side(q));
            if sp >= 0.0 {
                kept.push(p);
            }
            if (sp > 0.0 && sq < 0.0) || (sp < 0.0 && sq > 0.0) {
                kept.push(p + (q - p) * (sp / (sp - sq)));
            }
        }
        points = kept;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn square(x: f64, y: f64, side: f64) -> Vec<P2> {
        [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(dx, dy)| P2::new(x + dx, y + dy)).to_vec()
    }

    fn edges(points: &[P2]) -> Vec<(P2, P2)> {
        (0..points.len()).map(|i| (points[i], points[(i + 1) % points.len()])).collect()
    }

    #[test]
    fn a_shifted_square_covers_the_overlap_and_protrudes_by_the_rest() {
        let target = square(0.0, 0.0, 10.0);
        let c = coverage(&edges(&square(5.0, 0.0, 10.0)), &[&target]);
        assert!((c.uncovered_fraction() - 0.5).abs() < 1e-6);
        assert!((c.protruding_fraction() - 0.5).abs() < 1e-6);
    }

    #[test]
    fn an_open_strip_encloses_nothing_and_a_crossing_closes_it() {
        let target = square(0.0, 0.0, 10.0);
        let p = |x, y| P2::new(x, y);
        let open = [(p(0.0, 0.0), p(10.0, 0.0)), (p(10.0, 0.0), p(10.0, 10.0))];
        assert_eq!(coverage(&open, &[&target]).enclosed, 0.0);
        let crossed = [(p(-1.0, 0.0), p(11.0, 0.0)), (p(10.0, -1.0), p(10.0, 11.0)), (p(11.0, 11.0), p(-1.0, -1.0))];
        assert!((coverage(&crossed, &[&target]).enclosed - 50.0).abs() < 1e-5);
    }

    #[test]
    fn a_loop_within_a_loop_is_enclosed_once_and_a_hole_is_not_target() {
        let (outer, mut hole) = (square(0.0, 0.0, 10.0), square(4.0, 4.0, 2.0));
        let mut strip = edges(&outer);
        strip.extend(edges(&hole));
        hole.reverse();
        let c = coverage(&strip, &[&outer, &hole]);
        assert!((c.enclosed - 100.0).abs() < 1e-5);
        assert!((c.target - 96.0).abs() < 1e-9);
        assert!((c.protruding_fraction() - 4.0 / 96.0).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn covered_never_exceeds_target_or_enclosed(
            walk in prop::collection::vec((-20.0..20.0f64, -20.0..20.0f64), 0..40),
        ) {
            let points: Vec<P2> = walk.iter().map(|(x, y)| P2::new(*x, *y)).collect();
            let strip: Vec<(P2, P2)> = points.windows(2).map(|w| (w[0], w[1])).collect();
            let c = coverage(&strip, &[&square(-10.0, -10.0, 20.0)]);
            prop_assert!(c.covered >= -1e-6 && c.covered <= c.target + 1e-4 && c.covered <= c.enclosed + 1e-4);
        }
    }
}
