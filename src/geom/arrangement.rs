//! The exact region that segments enclose, and how well it fills a target.

use super::{P2, cross, signed_area, snap_round};
use spade::handles::{FixedFaceHandle, PossiblyOuterTag};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// The region a set of segments encloses: everything that cannot be reached from far away without crossing one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Enclosed {
    /// Rooms of the region, parted by segments, each as counter-clockwise triangles that tile it.
    pub rooms: Vec<Vec<[P2; 3]>>,
    /// Border loops of the region: outer borders counter-clockwise, the borders of holes clockwise.
    pub loops: Vec<Vec<P2>>,
}

/// How well a region fills a target; all areas in the square of the input's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coverage {
    /// Area of the target.
    pub target: f64,
    /// Area of the region.
    pub enclosed: f64,
    /// Area they share.
    pub covered: f64,
}

impl Coverage {
    /// Target area left empty over target area.
    pub fn uncovered_fraction(&self) -> f64 {
        (self.target - self.covered) / self.target
    }

    /// Region area outside the target over target area.
    pub fn protruding_fraction(&self) -> f64 {
        (self.enclosed - self.covered) / self.target
    }
}

impl Enclosed {
    /// Compares the region with the target bounded by `target` loops (outer counter-clockwise, holes clockwise).
    pub fn coverage<'a>(&self, target: impl Iterator<Item = &'a Vec<P2>> + Clone) -> Coverage {
        let area = |triangle: &[P2; 3]| target.clone().map(|l| signed_area(&clip(l, triangle))).sum::<f64>();
        let triangles = || self.rooms.iter().flatten();
        Coverage {
            target: target.clone().map(|l| signed_area(l)).sum(),
            enclosed: triangles().map(|t| signed_area(t)).sum(),
            covered: triangles().map(area).sum(),
        }
    }
}

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// The exact region `segments` enclose, by a constrained Delaunay triangulation flooded from outside. Segments may cross, touch, repeat or have no
/// length; segments with a coordinate that is not finite are passed over.
pub fn enclosed(segments: &[(P2, P2)]) -> Enclosed {
    let finite = |p: &P2| p.x.is_finite() && p.y.is_finite();
    let segments: Vec<(P2, P2)> = segments.iter().copied().filter(|(a, b)| finite(a) && finite(b)).collect();
    let mut cdt = Cdt::new();
    // Snap rounding leaves no crossings, so every constraint goes in as it is; spade's own splitting breaks down where crossings coincide.
    for run in snap_round(&segments) {
        for ends in run.windows(2) {
            let [a, b] = [ends[0], ends[1]].map(|p| cdt.insert(Point2::new(p.x, p.y)));
            if let (Ok(a), Ok(b)) = (a, b)
                && a != b
            {
                cdt.try_add_constraint(a, b);
            }
        }
    }

    let mut room_of: Vec<Option<usize>> = vec![None; cdt.num_all_faces()];
    flood(&cdt, cdt.outer_face().fix(), OUTSIDE, &mut room_of);
    let mut rooms: Vec<Vec<[P2; 3]>> = Vec::new();
    for face in cdt.inner_faces() {
        if room_of[face.fix().index()].is_none() {
            flood(&cdt, face.adjacent_edge().face().fix(), rooms.len(), &mut room_of);
            rooms.push(Vec::new());
        }
        if let Some(room) = room_of[face.fix().index()].filter(|room| *room != OUTSIDE) {
            rooms[room].push(face.positions().map(|p| P2::new(p.x, p.y)));
        }
    }
    Enclosed { rooms, loops: border_loops(&cdt, &room_of) }
}

/// Room number of everything that is not enclosed.
const OUTSIDE: usize = usize::MAX;

/// Gives `room` to every face that can be reached from `start` without crossing a segment.
fn flood(cdt: &Cdt, start: FixedFaceHandle<PossiblyOuterTag>, room: usize, room_of: &mut [Option<usize>]) {
    room_of[start.index()] = Some(room);
    let mut frontier = vec![start];
    while let Some(face) = frontier.pop() {
        let border: Vec<_> = match cdt.face(face).as_inner() {
            Some(inner) => inner.adjacent_edges().to_vec(),
            None => cdt.convex_hull().collect(),
        };
        for edge in border {
            let across = edge.rev().face().fix();
            if !edge.is_constraint_edge() && room_of[across.index()].is_none() {
                room_of[across.index()] = Some(room);
                frontier.push(across);
            }
        }
    }
}

/// Walks the borders between enclosed faces (on the left) and the outside.
fn border_loops(cdt: &Cdt, room_of: &[Option<usize>]) -> Vec<Vec<P2>> {
    let outside = |face: FixedFaceHandle<PossiblyOuterTag>| room_of[face.index()] == Some(OUTSIDE);
    let mut walked = vec![false; cdt.num_directed_edges()];
    let mut loops = Vec::new();
    for start in cdt.directed_edges() {
        let mut edge = start;
        let mut points = Vec::new();
        let on_border = !outside(edge.face().fix()) && outside(edge.rev().face().fix());
        while on_border && !walked[edge.fix().index()] {
            walked[edge.fix().index()] = true;
            points.push(P2::new(edge.from().position().x, edge.from().position().y));
            edge = edge.next();
            // Turn about the corner through enclosed faces until the outside shows again.
            while !outside(edge.rev().face().fix()) {
                edge = edge.rev().next();
            }
        }
        if !points.is_empty() {
            loops.push(points);
        }
    }
    loops
}

/// The part of `polygon` inside a counter-clockwise convex `clipper` (Sutherland and Hodgman 1974, doi:10.1145/360767.360802). A concave
/// polygon may come back with edges that run there and back; its signed area is right all the same.
pub fn clip(polygon: &[P2], clipper: &[P2; 3]) -> Vec<P2> {
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
        let c = enclosed(&edges(&square(5.0, 0.0, 10.0))).coverage([target].iter());
        assert!((c.uncovered_fraction() - 0.5).abs() < 1e-6);
        assert!((c.protruding_fraction() - 0.5).abs() < 1e-6);
    }

    #[test]
    fn an_open_strip_encloses_nothing_and_a_crossing_closes_it() {
        let p = |x, y| P2::new(x, y);
        let open = [(p(0.0, 0.0), p(10.0, 0.0)), (p(10.0, 0.0), p(10.0, 10.0))];
        assert_eq!(enclosed(&open), Enclosed::default());
        let crossed = [(p(-1.0, 0.0), p(11.0, 0.0)), (p(10.0, -1.0), p(10.0, 11.0)), (p(11.0, 11.0), p(-1.0, -1.0))];
        let region = enclosed(&crossed);
        assert_eq!((region.rooms.len(), region.loops.len()), (1, 1));
        assert!((signed_area(&region.loops[0]) - 50.0).abs() < 1e-5);
    }

    #[test]
    fn a_loop_within_a_loop_is_enclosed_once_and_a_hole_is_not_target() {
        let (outer, mut hole) = (square(0.0, 0.0, 10.0), square(4.0, 4.0, 2.0));
        let mut strip = edges(&outer);
        strip.extend(edges(&hole));
        hole.reverse();
        let region = enclosed(&strip);
        assert_eq!((region.rooms.len(), region.loops.len()), (2, 1));
        let c = region.coverage([outer, hole].iter());
        assert!((c.enclosed - 100.0).abs() < 1e-5);
        assert!((c.target - 96.0).abs() < 1e-9);
        assert!((c.protruding_fraction() - 4.0 / 96.0).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn exact_coincidences_never_panic(walk in prop::collection::vec((-6i32..6, -6i32..6), 0..40)) {
            let points: Vec<P2> = walk.iter().map(|(x, y)| P2::new(*x as f64, *y as f64)).collect();
            let strip: Vec<(P2, P2)> = points.windows(2).map(|w| (w[0], w[1])).collect();
            let area: f64 = enclosed(&strip).loops.iter().map(|l| signed_area(l)).sum();
            prop_assert!((0.0..=144.0 + 1e-6).contains(&area));
        }

        #[test]
        fn covered_never_exceeds_target_or_enclosed(
            walk in prop::collection::vec((-20.0..20.0f64, -20.0..20.0f64), 0..40),
        ) {
            let points: Vec<P2> = walk.iter().map(|(x, y)| P2::new(*x, *y)).collect();
            let strip: Vec<(P2, P2)> = points.windows(2).map(|w| (w[0], w[1])).collect();
            let region = enclosed(&strip);
            let c = region.coverage([square(-10.0, -10.0, 20.0)].iter());
            let bordered: f64 = region.loops.iter().map(|l| signed_area(l)).sum();
            prop_assert!((bordered - c.enclosed).abs() < 1e-6, "{bordered} {}", c.enclosed);
            prop_assert!(c.covered >= -1e-6 && c.covered <= c.target + 1e-4 && c.covered <= c.enclosed + 1e-4);
        }
    }
}
