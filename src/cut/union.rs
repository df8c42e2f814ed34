//! Loops that overlap, cross or repeat become the borders of the region they wind round.
//!
//! All loops, snapped so that none cross, go into one constrained triangulation; the constraints divide it into areas, each either inside
//! (some loop winds round it) or outside; the borders between the two kinds are walked. (spade could split crossing constraints itself,
//! but panics on some of them.)

use crate::geom::{P2, cross, signed_area, snap_round};
use spade::handles::{DirectedEdgeHandle, FixedFaceHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

type Mesh2 = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// A connected region: a counter-clockwise outer loop and the clockwise loops of its holes, all simple; loops may touch in single points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Region {
    pub(super) outer: Vec<P2>,
    pub(super) holes: Vec<Vec<P2>>,
}

impl Region {
    /// Area, holes taken off, mm^2.
    pub(super) fn area(&self) -> f64 {
        signed_area(&self.outer) + self.holes.iter().map(|hole| signed_area(hole)).sum::<f64>()
    }
}

/// The regions with a winding number other than 0, largest first. A clockwise loop inside a counter-clockwise one is a hole; a loop on its
/// own is filled whichever way it runs.
pub(super) fn regions(loops: &[Vec<P2>]) -> Vec<Region> {
    let loops = snapped(loops);
    let mut cdt = Mesh2::new();
    for points in &loops {
        // Every point is a finite multiple of the grid, which spade takes.
        let handles: Vec<_> = points.iter().filter_map(|p| cdt.insert(Point2::new(p.x, p.y)).ok()).collect();
        for i in 0..handles.len() {
            cdt.try_add_constraint(handles[i], handles[(i + 1) % handles.len()]);
        }
    }
    let inside = faces_inside(&cdt, &loops);
    sorted_into_regions(borders(&cdt, &inside))
}

/// The loops, led through each other's points and crossings.
fn snapped(loops: &[Vec<P2>]) -> Vec<Vec<P2>> {
    let sides = |points: &Vec<P2>| -> Vec<(P2, P2)> {
        (0..points.len()).map(|i| (points[i], points[(i + 1) % points.len()])).collect()
    };
    let mut runs = snap_round(&loops.iter().flat_map(sides).collect::<Vec<_>>()).into_iter();
    loops
        .iter()
        .map(|points| {
            let mut led: Vec<P2> = runs.by_ref().take(points.len()).flatten().collect();
            led.dedup();
            led
        })
        .collect()
}

/// For each face (by index), whether it lies in the region.
fn faces_inside(cdt: &Mesh2, loops: &[Vec<P2>]) -> Vec<bool> {
    let mut inside = vec![false; cdt.num_all_faces()];
    let mut seen = vec![false; cdt.num_all_faces()];
    for seed in cdt.fixed_inner_faces() {
        if seen[seed.index()] {
            continue;
        }
        seen[seed.index()] = true;
        let mut area: Vec<FixedFaceHandle<InnerTag>> = vec![seed];
        let mut next = 0;
        while let Some(face) = area.get(next).copied() {
            next += 1;
            for edge in cdt.face(face).adjacent_edges() {
                if let Some(other) = edge.rev().face().as_inner().map(|f| f.fix())
                    && !edge.is_constraint_edge()
                    && !seen[other.index()]
                {
                    seen[other.index()] = true;
                    area.push(other);
                }
            }
        }
        // The largest triangle's middle stands for the area: it is the furthest from every border.
        let widest = area.iter().max_by(|a, b| cdt.face(**a).area().total_cmp(&cdt.face(**b).area()));
        if let Some(widest) = widest {
            let middle = cdt.face(*widest).center();
            if loops.iter().map(|l| winding(l, P2::new(middle.x, middle.y))).sum::<i32>() != 0 {
                area.iter().for_each(|face| inside[face.index()] = true);
            }
        }
    }
    inside
}

/// How often the loop runs round `p`, counter-clockwise positive.
fn winding(points: &[P2], p: P2) -> i32 {
    let n = points.len();
    (0..n)
        .map(|i| {
            let (a, b) = (points[i], points[(i + 1) % n]);
            let side = cross(b - a, p - a);
            i32::from(a.y <= p.y && b.y > p.y && side > 0.0) - i32::from(a.y > p.y && b.y <= p.y && side < 0.0)
        })
        .sum()
}

/// Simple loops with the inside on the left.
fn borders(cdt: &Mesh2, inside: &[bool]) -> Vec<Vec<P2>> {
    let is_inside = |edge: DirectedEdgeHandle<'_, Point2<f64>, (), _, ()>| inside[edge.face().fix().index()];
    let mut used = vec![false; cdt.num_directed_edges()];
    let mut loops = Vec::new();
    for start in cdt.directed_edges() {
        if used[start.fix().index()] || !is_inside(start) || is_inside(start.rev()) {
            continue;
        }
        let mut corners: Vec<(usize, P2)> = Vec::new();
        let mut edge = start;
        loop {
            used[edge.fix().index()] = true;
            let from = edge.from();
            corners.push((from.fix().index(), P2::new(from.position().x, from.position().y)));
            // Turn through the inside faces at the edge's end until the far side is outside.
            edge = edge.next();
            while is_inside(edge.rev()) {
                edge = edge.rev().next();
            }
            if edge == start {
                break;
            }
        }
        split_at_repeats(corners, &mut loops);
    }
    loops
}

/// Cuts a loop that passes a point twice into loops that do not.
fn split_at_repeats(corners: Vec<(usize, P2)>, loops: &mut Vec<Vec<P2>>) {
    let mut place = std::collections::HashMap::new();
    let mut path: Vec<(usize, P2)> = Vec::new();
    for corner in corners {
        if let Some(first) = place.get(&corner.0).copied() {
            let part = path.split_off(first);
            part.iter().for_each(|(i, _)| {
                place.remove(i);
            });
            loops.push(part.into_iter().map(|(_, p)| p).collect());
        }
        place.insert(corner.0, path.len());
        path.push(corner);
    }
    loops.push(path.into_iter().map(|(_, p)| p).collect());
}

/// Gives every clockwise loop to the smallest counter-clockwise one around it.
fn sorted_into_regions(loops: Vec<Vec<P2>>) -> Vec<Region> {
    let (outer, holes): (Vec<Vec<P2>>, Vec<Vec<P2>>) = loops.into_iter().partition(|l| signed_area(l) > 0.0);
    let mut regions: Vec<Region> = outer.into_iter().map(|outer| Region { outer, holes: Vec::new() }).collect();
    regions.sort_by(|a, b| signed_area(&a.outer).total_cmp(&signed_area(&b.outer)));
    for hole in holes {
        if let Some(around) = regions.iter_mut().find(|region| surrounds(&region.outer, &hole)) {
            around.holes.push(hole);
        }
    }
    regions.sort_by(|a, b| b.area().total_cmp(&a.area()));
    regions
}

/// True when `inner`, which crosses `outer` nowhere but may touch it, lies inside: decided at the middle of an edge off the border.
fn surrounds(outer: &[P2], inner: &[P2]) -> bool {
    let middles = (0..inner.len()).map(|i| nalgebra::center(&inner[i], &inner[(i + 1) % inner.len()]));
    let furthest = middles.map(|p| (crate::geom::distance_to_loop(outer, p), p)).max_by(|a, b| a.0.total_cmp(&b.0));
    furthest.is_some_and(|(_, p)| crate::geom::contains(outer, p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::segments_cross;
    use proptest::prelude::*;

    fn rectangle(x: f64, y: f64, w: f64, h: f64) -> Vec<P2> {
        [(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| P2::new(x, y)).to_vec()
    }

    fn reversed(mut points: Vec<P2>) -> Vec<P2> {
        points.reverse();
        points
    }

    fn areas(loops: &[Vec<P2>]) -> Vec<f64> {
        regions(loops).iter().map(|r| (r.area() * 1e3).round() / 1e3).collect()
    }

    #[test]
    fn overlapping_touching_and_repeated_loops_are_united() {
        let a = rectangle(0.0, 0.0, 4.0, 4.0);
        assert_eq!(areas(&[a.clone(), rectangle(2.0, 1.0, 4.0, 2.0)]), [20.0]);
        assert_eq!(areas(&[a.clone(), rectangle(4.0, 0.0, 4.0, 4.0)]), [32.0]);
        assert_eq!(areas(&[a.clone(), a.clone(), rectangle(1.0, 1.0, 1.0, 1.0)]), [16.0]);
        assert_eq!(areas(&[rectangle(9.0, 0.0, 1.0, 1.0), a]), [16.0, 1.0]);
    }

    #[test]
    fn a_clockwise_loop_inside_is_a_hole_and_one_alone_is_a_body() {
        let hole = reversed(rectangle(1.0, 1.0, 2.0, 2.0));
        let found = regions(&[rectangle(0.0, 0.0, 4.0, 4.0), hole.clone()]);
        assert_eq!((found.len(), found[0].holes.len(), found[0].area()), (1, 1, 12.0));
        assert!(signed_area(&found[0].holes[0]) < 0.0);
        assert_eq!(areas(std::slice::from_ref(&hole)), [4.0]);
        assert_eq!(areas(&[rectangle(0.0, 0.0, 4.0, 4.0), hole, rectangle(1.5, 1.5, 1.0, 1.0)]), [12.0, 1.0]);
    }

    #[test]
    fn what_touches_in_a_point_comes_apart_there() {
        // Two squares corner to corner, and a square hole whose corner touches the border.
        assert_eq!(areas(&[rectangle(0.0, 0.0, 2.0, 2.0), rectangle(2.0, 2.0, 1.0, 1.0)]), [4.0, 1.0]);
        let hole = [(0.0, 2.0), (1.0, 3.0), (2.0, 2.0), (1.0, 1.0)].map(|(x, y)| P2::new(x, y)).to_vec();
        let found = regions(&[rectangle(0.0, 0.0, 4.0, 4.0), hole]);
        assert_eq!((found.len(), found[0].holes.len(), found[0].area()), (1, 1, 14.0));
    }

    proptest! {
        #[test]
        fn scribbles_become_simple_disjoint_loops_of_the_area_they_wind_round(
            points in prop::collection::vec((-9i32..9, -9i32..9), 3..24),
        ) {
            let scribble: Vec<P2> = points.iter().map(|(x, y)| P2::new(f64::from(*x), f64::from(*y))).collect();
            let found = regions(std::slice::from_ref(&scribble));
            let loops: Vec<&Vec<P2>> = found.iter().flat_map(|r| std::iter::once(&r.outer).chain(&r.holes)).collect();
            let edges: Vec<(P2, P2)> =
                loops.iter().flat_map(|l| (0..l.len()).map(|i| (l[i], l[(i + 1) % l.len()]))).collect();
            for (i, a) in edges.iter().enumerate() {
                for b in &edges[..i] {
                    prop_assert!(!segments_cross(a.0, a.1, b.0, b.1));
                }
            }
            // Areas by counting a fine raster of the winding number.
            let mut wound = 0;
            for i in 0..90 {
                for j in 0..90 {
                    let p = P2::new(-9.0 + 0.2 * f64::from(i) + 0.0917, -9.0 + 0.2 * f64::from(j) + 0.1093);
                    wound += i32::from(winding(&scribble, p) != 0);
                }
            }
            let area: f64 = found.iter().map(Region::area).sum();
            let length: f64 = edges.iter().map(|(a, b)| (b - a).norm()).sum();
            prop_assert!((area - 0.04 * f64::from(wound)).abs() <= 0.3 * length * 0.2 + 1e-6);
        }
    }
}
