//! Lids over the loops in which a plane cuts a mesh, holes left open.

use super::{edges, polygon};
use crate::geom::{P2, P3, V3, contains, cross, distance_to_segment, segments_cross, signed_area, tolerance};

/// A loop in the plane: corners, and where they lie.
struct Loop {
    corners: Vec<u32>,
    flat: Vec<P2>,
    area: f64,
}

/// Triangles that close the loops which `steps` form, walked along the steps and facing along the unit vector `normal` where a loop runs counter-clockwise about
/// it. Loops that run the other way are holes of the smallest loop around them: a bridge leads to each, and the whole is cut as one polygon.
pub(super) fn lids(vertices: &[P3], steps: &[(u32, u32)], normal: V3) -> Vec<[u32; 3]> {
    let mut axis = V3::zeros();
    axis[normal.iamin()] = 1.0;
    let u = axis.cross(&normal).normalize();
    let v = normal.cross(&u);
    let flattened = |corners: Vec<u32>| {
        let flat: Vec<P2> =
            corners.iter().map(|i| vertices[*i as usize].coords).map(|p| P2::new(p.dot(&u), p.dot(&v))).collect();
        Loop { area: signed_area(&flat), corners, flat }
    };
    let loops = edges::loops(steps.iter().copied()).into_iter().map(flattened);
    let (mut outer, mut holes): (Vec<Loop>, Vec<Loop>) = loops.partition(|l| l.area >= 0.0);
    outer.sort_by(|a, b| a.area.total_cmp(&b.area));
    let reach = |hole: &Loop| hole.flat.iter().map(|p| p.x).fold(f64::NEG_INFINITY, f64::max);
    // From the right: a hole then sees the border, or a hole that is bridged already, to its right.
    holes.sort_by(|a, b| reach(b).total_cmp(&reach(a)));
    let mut alone = Vec::new();
    let mut held: Vec<Vec<Loop>> = outer.iter().map(|_| Vec::new()).collect();
    for hole in holes {
        match outer.iter().position(|o| o.area > -hole.area && contains(&o.flat, hole.flat[0])) {
            Some(around) => held[around].push(hole),
            None => alone.push(hole),
        }
    }
    for (around, holes) in outer.iter_mut().zip(&held) {
        for k in 0..holes.len() {
            bridge(around, &holes[k..]);
        }
    }
    outer.iter().chain(&alone).flat_map(|l| polygon::triangulate(vertices, &l.corners)).collect()
}

/// Leads `around` to the first of the holes and back along one line, from the hole's rightmost corner to the nearest corner it sees past the others.
fn bridge(around: &mut Loop, holes: &[Loop]) {
    let hole = &holes[0];
    let from = (0..hole.flat.len()).max_by(|a, b| hole.flat[*a].x.total_cmp(&hole.flat[*b].x)).unwrap_or(0);
    let eye = hole.flat[from];
    let n = around.flat.len();
    let mut near: Vec<usize> = (0..n).collect();
    near.sort_by(|a, b| (around.flat[*a] - eye).norm().total_cmp(&(around.flat[*b] - eye).norm()));
    let sees = |k: &usize| {
        let (before, at, after) = (around.flat[(k + n - 1) % n], around.flat[*k], around.flat[(k + 1) % n]);
        let left = |p: P2, q: P2, r: P2| cross(q - p, r - p) > 0.0;
        let opens = if left(before, at, after) {
            left(before, at, eye) && left(at, after, eye)
        } else {
            left(before, at, eye) || left(at, after, eye)
        };
        let clear = |flat: &[P2]| {
            let m = flat.len();
            let in_the_way =
                |p: &P2| *p != eye && *p != at && distance_to_segment(*p, eye, at) < tolerance::SAME_POINT_MM;
            !flat.iter().any(in_the_way) && !(0..m).any(|i| segments_cross(eye, at, flat[i], flat[(i + 1) % m]))
        };
        opens && clear(&around.flat) && holes.iter().all(|h| clear(&h.flat))
    };
    // Loops of one sound body always see each other; those of bodies that pass through each other still get a lid that closes them.
    let to = near.iter().copied().find(sees).unwrap_or(near[0]);
    let round = |k: usize| (from + k) % hole.corners.len();
    let detour = 0..=hole.corners.len();
    let corners: Vec<u32> = detour.clone().map(|k| hole.corners[round(k)]).chain([around.corners[to]]).collect();
    let flat: Vec<P2> = detour.map(|k| hole.flat[round(k)]).chain([around.flat[to]]).collect();
    around.corners.splice(to + 1..to + 1, corners);
    around.flat.splice(to + 1..to + 1, flat);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::trimesh::area_vector;
    use proptest::prelude::*;

    /// Points of several loops in the plane y = 2, and the steps along them.
    fn drawn(loops: &[Vec<(f64, f64)>]) -> (Vec<P3>, Vec<(u32, u32)>) {
        let (mut vertices, mut steps) = (Vec::new(), Vec::new());
        for points in loops {
            let (first, n) = (vertices.len() as u32, points.len() as u32);
            vertices.extend(points.iter().map(|(x, z)| P3::new(*x, 2.0, *z)));
            steps.extend((0..n).map(|i| (first + i, first + (i + 1) % n)));
        }
        (vertices, steps)
    }

    fn square(x: f64, z: f64, side: f64) -> Vec<(f64, f64)> {
        // Counter-clockwise about +y: x to the right, z toward the viewer.
        vec![(x, z), (x, z + side), (x + side, z + side), (x + side, z)]
    }

    fn hole(x: f64, z: f64, side: f64) -> Vec<(f64, f64)> {
        square(x, z, side).into_iter().rev().collect()
    }

    fn areas(loops: &[Vec<(f64, f64)>]) -> (f64, f64) {
        let (vertices, steps) = drawn(loops);
        let of = |t: &[u32; 3]| area_vector(&t.map(|i| vertices[i as usize])).y;
        let lids = lids(&vertices, &steps, V3::y());
        (lids.iter().map(of).sum(), lids.iter().map(|t| of(t).abs()).sum())
    }

    #[test]
    fn holes_stay_open_and_islands_in_them_are_covered() {
        let loops = [
            square(0.0, 0.0, 10.0),
            hole(1.0, 1.0, 8.0),
            square(2.0, 2.0, 6.0),
            hole(3.0, 3.0, 1.0),
            hole(5.0, 5.0, 2.0),
        ];
        let (net, gross) = areas(&loops);
        assert!((net - 67.0).abs() < 1e-9 && (gross - 67.0).abs() < 1e-9, "{net} {gross}");
    }

    proptest! {
        #[test]
        fn a_plate_with_a_raster_of_holes_is_covered_once(open in prop::collection::vec(any::<bool>(), 16), dx in 0.0..0.9f64) {
            let mut loops = vec![square(0.0, 0.0, 8.0)];
            for (k, _) in open.iter().enumerate().filter(|(_, open)| **open) {
                let (i, j) = ((k % 4) as f64, (k / 4) as f64);
                loops.push(hole(2.0 * i + 0.3 + dx * (j / 4.0), 2.0 * j + 0.4, 0.7));
            }
            let whole = 64.0 - 0.49 * (loops.len() - 1) as f64;
            let (net, gross) = areas(&loops);
            prop_assert!((net - whole).abs() < 1e-9 && (gross - whole).abs() < 1e-9, "{net} {gross} {whole}");
        }
    }
}
