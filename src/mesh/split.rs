//! A plane takes a mesh apart; both halves get lids, so that closed meshes stay closed.

use super::{TriMesh, caps, weld};
use crate::geom::{P3, V3, tolerance};
use std::collections::HashMap;

/// A mesh in two. A half without triangles means that the plane passes the mesh by.
#[derive(Debug, Clone, PartialEq)]
pub struct Halves {
    /// What lies on the side the normal points away from.
    pub behind: TriMesh,
    /// What lies on the side the normal points to.
    pub ahead: TriMesh,
}

/// A half with less volume than this share of (area)^1.5 is the skin of a face in the plane, not a body.
const SKIN: f64 = 1e-9;

/// Cuts `mesh` by the plane through `origin` (mesh frame, mm) across `normal` (any length but 0). Both halves share the corners of their lids exactly.
///
/// Corners on the plane count as ahead of it, as if the plane were moved by less than any number: no triangle is cut in more than one segment (symbolic
/// perturbation, Edelsbrunner and Muecke 1990, doi:10.1145/77635.77639). Where the mesh is open the lids stay open too.
pub fn split(mesh: &TriMesh, origin: P3, normal: V3) -> Halves {
    let normal = normal.normalize();
    let height = |p: &P3| {
        let h = (p - origin).dot(&normal);
        // A sliver nobody can cut is no half.
        if h.abs() < tolerance::SAME_POINT_MM { 0.0 } else { h }
    };
    let heights: Vec<f64> = mesh.vertices.iter().map(height).collect();
    let mut cutter = Cutter { heights: &heights, vertices: mesh.vertices.clone(), crossings: HashMap::new() };
    let (mut behind, mut ahead, mut rims) = (Vec::new(), Vec::new(), Vec::new());
    for triangle in &mesh.triangles {
        cutter.cut(*triangle, &mut behind, &mut ahead, &mut rims);
    }
    let lids = caps::lids(&cutter.vertices, &rims, normal);
    ahead.extend(lids.iter().map(|[a, b, c]| [*a, *c, *b]));
    behind.extend(lids);
    let half = |triangles: Vec<[u32; 3]>| {
        let soup = weld::compact(&cutter.vertices, triangles);
        let half = TriMesh { vertices: soup.vertices, triangles: soup.triangles, up: mesh.up };
        let skin = half.volume().abs() <= SKIN * half.area().powf(1.5);
        if skin { TriMesh { vertices: Vec::new(), triangles: Vec::new(), up: mesh.up } } else { half }
    };
    Halves { behind: half(behind), ahead: half(ahead) }
}

/// Cuts triangles one by one; an edge is cut once for all triangles at it.
struct Cutter<'a> {
    heights: &'a [f64],
    vertices: Vec<P3>,
    crossings: HashMap<(u32, u32), u32>,
}

impl Cutter<'_> {
    fn ahead(&self, i: u32) -> bool {
        self.heights[i as usize] >= 0.0
    }

    /// Where the edge from `i` to `j` meets the plane: the corner itself when it lies there.
    fn crossing(&mut self, i: u32, j: u32) -> u32 {
        let (a, b) = (i.min(j), i.max(j));
        let (ha, hb) = (self.heights[a as usize], self.heights[b as usize]);
        for (corner, h) in [(a, ha), (b, hb)] {
            if h == 0.0 {
                return corner;
            }
        }
        let vertices = &mut self.vertices;
        *self.crossings.entry((a, b)).or_insert_with(|| {
            let (p, q) = (vertices[a as usize], vertices[b as usize]);
            vertices.push(p + (q - p) * (ha / (ha - hb)));
            vertices.len() as u32 - 1
        })
    }

    /// Hands the two sides of a triangle out, and the step that a lid over the side behind takes along the cut.
    fn cut(
        &mut self,
        triangle: [u32; 3],
        behind: &mut Vec<[u32; 3]>,
        ahead: &mut Vec<[u32; 3]>,
        rims: &mut Vec<(u32, u32)>,
    ) {
        let sides = triangle.map(|i| self.ahead(i));
        if sides == [true; 3] || sides == [false; 3] {
            if sides[0] {
                ahead.push(triangle)
            } else {
                behind.push(triangle)
            }
            return;
        }
        let (mut low, mut high) = (Vec::with_capacity(4), Vec::with_capacity(4));
        let (mut down, mut up) = (0, 0);
        for k in 0..3 {
            let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
            if sides[k] {
                high.push(from)
            } else {
                low.push(from)
            }
            if sides[k] != sides[(k + 1) % 3] {
                let at = self.crossing(from, to);
                low.push(at);
                high.push(at);
                if sides[k] { down = at } else { up = at }
            }
        }
        fan(low, behind);
        fan(high, ahead);
        if down != up {
            rims.push((down, up));
        }
    }
}

/// A convex polygon as triangles; corners that repeat their neighbour count once.
fn fan(mut corners: Vec<u32>, into: &mut Vec<[u32; 3]>) {
    corners.dedup();
    if corners.first() == corners.last() {
        corners.pop();
    }
    into.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
}

#[cfg(test)]
mod tests {
    use super::super::edges;
    use super::super::samples::{cuboid, inside_out, sphere, together};
    use super::*;
    use proptest::prelude::*;

    /// Closed, and exactly two triangles at every edge.
    fn sound(mesh: &TriMesh) -> bool {
        mesh.is_closed() && edges::of(&mesh.triangles).chunk_by(|a, b| a.key == b.key).all(|edge| edge.len() == 2)
    }

    /// A ring round the y axis with a square section: sections of it have holes or fall in two.
    fn ring(n: u32) -> TriMesh {
        let mut vertices = Vec::new();
        for i in 0..n {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
            vertices.extend(
                [(30.0, -5.0), (40.0, -5.0), (40.0, 5.0), (30.0, 5.0)].map(|(r, y)| P3::new(r * cos, y, -r * sin)),
            );
        }
        let at = |i: u32, k: u32| 4 * (i % n) + k % 4;
        let quads = (0..n).flat_map(|i| (0..4).map(move |k| [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)]));
        let triangles: Vec<[u32; 3]> = quads.flat_map(|[a, b, c, d]| [[a, c, b], [a, d, c]]).collect();
        let mesh = TriMesh { vertices, triangles, up: V3::y() };
        if mesh.volume() < 0.0 { inside_out(mesh) } else { mesh }
    }

    #[test]
    fn a_cuboid_falls_into_two_cuboids() {
        let halves = split(&cuboid(P3::origin(), V3::new(10.0, 20.0, 30.0)), P3::new(0.0, 5.0, 0.0), V3::y() * 7.0);
        assert_eq!(halves.behind.bounds(), (P3::origin(), P3::new(10.0, 5.0, 30.0)));
        assert_eq!(halves.ahead.bounds(), (P3::new(0.0, 5.0, 0.0), P3::new(10.0, 20.0, 30.0)));
        assert!((halves.behind.volume() - 1500.0).abs() < 1e-9 && (halves.ahead.volume() - 4500.0).abs() < 1e-9);
        assert!(sound(&halves.behind) && sound(&halves.ahead));
        assert!((halves.behind.area() - 2.0 * (50.0 + 300.0 + 150.0)).abs() < 1e-9, "the lid lies flat and once");
    }

    #[test]
    fn a_plane_beside_the_mesh_or_along_a_face_leaves_it_whole() {
        let cube = cuboid(P3::origin(), V3::repeat(10.0));
        for (y, ahead) in [(-3.0, true), (0.0, true), (10.0, false), (12.0, false)] {
            let halves = split(&cube, P3::new(0.0, y, 0.0), V3::y());
            let (whole, nothing) = if ahead { (halves.ahead, halves.behind) } else { (halves.behind, halves.ahead) };
            assert!(nothing.triangles.is_empty() && nothing.vertices.is_empty(), "{y}");
            assert!((whole.volume() - 1000.0).abs() < 1e-9 && whole.is_closed(), "{y}");
        }
    }

    #[test]
    fn a_hollow_and_a_ring_get_lids_with_holes() {
        let hollow = together(&[
            cuboid(P3::origin(), V3::repeat(10.0)),
            inside_out(cuboid(P3::new(2.0, 2.0, 2.0), V3::new(3.0, 6.0, 6.0))),
            inside_out(cuboid(P3::new(6.0, 3.0, 3.0), V3::new(2.0, 4.0, 4.0))),
        ]);
        let halves = split(&hollow, P3::new(0.0, 5.0, 0.0), V3::y());
        assert!(sound(&halves.behind) && sound(&halves.ahead));
        let lid = 100.0 - 18.0 - 8.0;
        let walls = 5.0 * 40.0 + 3.0 * 18.0 + 2.0 * 12.0;
        assert!((halves.behind.area() - (100.0 + 18.0 + 8.0 + walls + lid)).abs() < 1e-9, "{}", halves.behind.area());
        let ring = ring(24);
        let flat = split(&ring, P3::origin(), V3::y());
        let upright = split(&ring, P3::new(1.0, 0.0, 0.0), V3::x());
        for half in [&flat.behind, &flat.ahead, &upright.behind, &upright.ahead] {
            assert!(sound(half));
        }
        assert!((flat.behind.area() - flat.ahead.area()).abs() < 1e-6);
        assert!((flat.behind.volume() - 0.5 * ring.volume()).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn halves_are_closed_and_add_up(
            n in prop::array::uniform3(-1.0..1.0f64), offset in -38.0..38.0f64, shape in 0usize..4,
        ) {
            prop_assume!(V3::from(n).norm() > 0.1);
            let normal = V3::from(n).normalize();
            let shell = || together(&[sphere(P3::origin(), 40.0, 20), inside_out(sphere(P3::new(3.0, 2.0, -4.0), 25.0, 12))]);
            let mesh = [
                sphere(P3::origin(), 40.0, 16),
                ring(20),
                shell(),
                together(&[ring(16), sphere(P3::new(35.0, 0.0, 0.0), 12.0, 10), cuboid(P3::new(-60.0, -9.0, -9.0), V3::repeat(18.0))]),
            ][shape].clone();
            let halves = split(&mesh, P3::from(normal * offset), normal);
            prop_assert!(sound(&halves.behind) && sound(&halves.ahead));
            let sum = halves.behind.volume() + halves.ahead.volume();
            prop_assert!((sum / mesh.volume() - 1.0).abs() < 1e-9, "{sum} {}", mesh.volume());
            for (half, side) in [(&halves.behind, -1.0), (&halves.ahead, 1.0)] {
                let beyond = half.vertices.iter().map(|p| side * (p.coords.dot(&normal) - offset));
                prop_assert!(half.volume() >= 0.0 && beyond.fold(f64::INFINITY, f64::min) > -1e-5);
            }
        }

        #[test]
        fn planes_through_corners_leave_closed_halves(picks in prop::array::uniform3(0usize..114)) {
            let ball = sphere(P3::origin(), 40.0, 16);
            let [a, b, c] = picks.map(|i| ball.vertices[i % ball.vertices.len()]);
            let normal = (b - a).cross(&(c - a));
            prop_assume!(normal.norm() > 1e-3);
            let halves = split(&ball, a, normal);
            prop_assert!(halves.behind.is_closed() && halves.ahead.is_closed());
            let sum = halves.behind.volume() + halves.ahead.volume();
            prop_assert!((sum / ball.volume() - 1.0).abs() < 1e-6);
        }
    }
}
