//! Mesh and plane meet in chains of segments.

use super::PlaneFrame;
use crate::geom::P2;
use crate::mesh::TriMesh;
use std::collections::HashMap;

/// A run of points on the plane. A closed chain does not repeat its first point.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chain {
    pub(super) points: Vec<P2>,
    pub(super) closed: bool,
}

/// Cuts every triangle and joins the segments over the mesh's edges: no distance is compared, so chains break only where the mesh does.
///
/// A corner on the plane counts as above it. The result is that of a plane moved by less than any number, no triangle meets it in more
/// than one segment, and every edge in at most one point (symbolic perturbation, Edelsbrunner and Muecke 1990, doi:10.1145/77635.77639).
/// Chains have the body on their left, seen against the normal, wherever the mesh faces outward.
pub(super) fn chains(mesh: &TriMesh, frame: &PlaneFrame) -> Vec<Chain> {
    let heights: Vec<f64> = mesh.vertices.iter().map(|p| frame.height_of(*p)).collect();
    let above = |i: u32| heights[i as usize] >= 0.0;
    let mut points = Vec::new();
    let mut number: HashMap<(u32, u32), usize> = HashMap::new();
    let mut crossing = |i: u32, j: u32| {
        let (a, b) = (i.min(j), i.max(j));
        *number.entry((a, b)).or_insert_with(|| {
            let (ha, hb) = (heights[a as usize], heights[b as usize]);
            let (p, q) = (frame.to_plane(mesh.vertices[a as usize]), frame.to_plane(mesh.vertices[b as usize]));
            points.push(p + (q - p) * (ha / (ha - hb)));
            points.len() - 1
        })
    };
    let mut segments = Vec::new();
    for t in &mesh.triangles {
        let sides = [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
        let down = sides.iter().find(|(a, b)| above(*a) && !above(*b));
        let up = sides.iter().find(|(a, b)| !above(*a) && above(*b));
        if let (Some(down), Some(up)) = (down, up) {
            segments.push([crossing(down.0, down.1), crossing(up.0, up.1)]);
        }
    }
    Walker::new(&segments, points.len()).walk().into_iter().map(|path| path.chain(&points)).collect()
}

/// Offsets along the normal, from the frame's plane, at which a plane meets the mesh: disjoint intervals, mm, ascending.
pub(super) fn hits(mesh: &TriMesh, frame: &PlaneFrame) -> Vec<(f64, f64)> {
    let mut spans: Vec<(f64, f64)> = (0..mesh.triangles.len())
        .map(|t| {
            let h = mesh.corners(t).map(|p| frame.height_of(p));
            (h[0].min(h[1]).min(h[2]), h[0].max(h[1]).max(h[2]))
        })
        .collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut merged: Vec<(f64, f64)> = Vec::new();
    for (lo, hi) in spans {
        match merged.last_mut() {
            Some(last) if lo <= last.1 => last.1 = last.1.max(hi),
            _ => merged.push((lo, hi)),
        }
    }
    merged
}

/// Node numbers in order, and whether the last joins the first.
struct Walk {
    nodes: Vec<usize>,
    closed: bool,
    /// Segments walked along their direction, less those walked against it.
    agreement: i64,
}

impl Walk {
    fn chain(mut self, points: &[P2]) -> Chain {
        if self.agreement < 0 {
            self.nodes.reverse();
        }
        Chain { points: self.nodes.into_iter().map(|i| points[i]).collect(), closed: self.closed }
    }
}

/// Walks every segment once.
struct Walker<'a> {
    segments: &'a [[usize; 2]],
    at_node: Vec<Vec<usize>>,
    used: Vec<bool>,
}

impl Walker<'_> {
    fn new(segments: &[[usize; 2]], nodes: usize) -> Walker<'_> {
        let mut at_node = vec![Vec::new(); nodes];
        for (k, [from, to]) in segments.iter().enumerate() {
            at_node[*from].push(k);
            at_node[*to].push(k);
        }
        Walker { segments, at_node, used: vec![false; segments.len()] }
    }

    /// Open chains start where an odd number of segments meets, first those where one leaves; what is left then is closed.
    fn walk(mut self) -> Vec<Walk> {
        let odd = |node: &usize| self.at_node[*node].len() % 2 == 1;
        let leaves = |node: &usize| self.at_node[*node].iter().any(|k| self.segments[*k][0] == *node);
        let (first, last): (Vec<usize>, Vec<usize>) = (0..self.at_node.len()).filter(odd).partition(leaves);
        let mut walks = Vec::new();
        for start in first.into_iter().chain(last) {
            walks.extend(self.from(start, false));
        }
        for start in (0..self.segments.len()).map(|k| self.segments[k][0]) {
            walks.extend(self.from(start, true));
        }
        walks
    }

    /// Follows unused segments from `start`, along their direction where there is a choice, until there is none or, when `round`, until it
    /// is back.
    fn from(&mut self, start: usize, round: bool) -> Option<Walk> {
        let mut walk = Walk { nodes: vec![start], closed: false, agreement: 0 };
        let mut here = start;
        loop {
            let unused = |k: &&usize| !self.used[**k];
            let along = self.at_node[here].iter().filter(unused).find(|k| self.segments[**k][0] == here);
            let Some(k) = along.or_else(|| self.at_node[here].iter().find(unused)).copied() else { break };
            self.used[k] = true;
            let [from, to] = self.segments[k];
            walk.agreement += if from == here { 1 } else { -1 };
            here = if from == here { to } else { from };
            if here == start && round {
                walk.closed = true;
                break;
            }
            walk.nodes.push(here);
        }
        // An open walk may end where it began.
        if !walk.closed && walk.nodes.len() > 1 && here == start {
            walk.nodes.pop();
            walk.closed = true;
        }
        (walk.nodes.len() > 1).then_some(walk)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Plane;
    use super::*;
    use crate::geom::{P3, V3, signed_area};
    use crate::mesh::samples::{cuboid, inside_out, sphere};
    use proptest::prelude::*;

    fn cut_at(mesh: &TriMesh, origin: P3, normal: V3) -> Vec<Chain> {
        chains(mesh, &PlaneFrame::new(&Plane { origin, normal: normal.normalize() }, V3::y()))
    }

    #[test]
    fn a_plane_through_corners_and_edges_gives_one_closed_loop() {
        let cube = cuboid(P3::new(-1.0, -1.0, -1.0), V3::repeat(2.0));
        // Through four corners and two edges; through one corner; along a side.
        for (origin, normal, area) in [
            (P3::origin(), V3::new(1.0, 0.0, -1.0), 2.0 * 8.0_f64.sqrt()),
            (P3::origin(), V3::new(1.0, 1.0, 1.0), 3.0 * 3.0_f64.sqrt()),
            (P3::new(0.0, 0.0, 1.0), V3::z(), 4.0),
        ] {
            let found = cut_at(&cube, origin, normal);
            assert_eq!(found.len(), 1, "{normal}");
            assert!(found[0].closed);
            assert!((signed_area(&found[0].points) - area).abs() < 1e-9, "{normal}");
        }
        assert!(cut_at(&cube, P3::new(0.0, 0.0, 1.0), -V3::z()).is_empty());
        assert!(cut_at(&cube, P3::new(0.0, 0.0, 1.1), V3::z()).is_empty());
    }

    #[test]
    fn the_body_is_on_the_left() {
        let ball = sphere(P3::origin(), 5.0, 16);
        assert!(signed_area(&cut_at(&ball, P3::origin(), V3::z())[0].points) > 0.0);
        assert!(signed_area(&cut_at(&inside_out(ball), P3::origin(), V3::z())[0].points) < 0.0);
    }

    #[test]
    fn a_mesh_with_a_hole_on_the_plane_gives_an_open_chain() {
        let mut cube = cuboid(P3::origin(), V3::repeat(2.0));
        cube.triangles.retain(|t| !t.iter().all(|i| cube.vertices[*i as usize].y > 1.0));
        let found = cut_at(&cube, P3::new(1.0, 1.0, 1.0), V3::z());
        assert_eq!(found.len(), 1);
        assert!(!found[0].closed);
        assert!((found[0].points[0] - found[0].points[found[0].points.len() - 1]).norm() > 1.9);
    }

    #[test]
    fn one_triangle_facing_the_wrong_way_breaks_nothing() {
        let mut ball = sphere(P3::origin(), 5.0, 16);
        let wrong = ball.triangles.iter().position(|t| {
            let z = t.map(|i| ball.vertices[i as usize].z);
            z.iter().any(|z| *z > 0.5) && z.iter().any(|z| *z < 0.5)
        });
        ball.triangles[wrong.unwrap()].swap(1, 2);
        let found = cut_at(&ball, P3::new(0.0, 0.0, 0.5), V3::z());
        assert_eq!(found.len(), 1);
        assert!(found[0].closed && signed_area(&found[0].points) > 0.0);
    }

    proptest! {
        #[test]
        fn any_plane_through_a_ball_gives_one_closed_ccw_loop_on_the_plane(
            n in prop::array::uniform3(-1.0..1.0f64), offset in -4.0..4.0f64,
        ) {
            prop_assume!(V3::from(n).norm() > 0.1);
            let n = V3::from(n).normalize();
            let found = cut_at(&sphere(P3::origin(), 5.0, 16), P3::from(n * offset), n);
            prop_assert_eq!(found.len(), 1);
            prop_assert!(found[0].closed && signed_area(&found[0].points) > 0.0);
        }

        #[test]
        fn planes_through_three_corners_of_a_ball_give_closed_loops(picks in prop::array::uniform3(0usize..114)) {
            let ball = sphere(P3::origin(), 5.0, 16);
            let [a, b, c] = picks.map(|i| ball.vertices[i % ball.vertices.len()]);
            let normal = (b - a).cross(&(c - a));
            prop_assume!(normal.norm() > 1e-3);
            for chain in cut_at(&ball, a, normal) {
                prop_assert!(chain.closed);
            }
        }
    }

    #[test]
    fn hits_are_the_offsets_that_meet_the_mesh() {
        let both = crate::mesh::samples::together(&[
            cuboid(P3::new(0.0, 0.0, 5.0), V3::repeat(2.0)),
            cuboid(P3::new(0.0, 0.0, -9.0), V3::repeat(2.0)),
        ]);
        let frame = PlaneFrame::new(&Plane { origin: P3::origin(), normal: V3::z() }, V3::y());
        assert_eq!(hits(&both, &frame), [(-9.0, -7.0), (5.0, 7.0)]);
    }
}
