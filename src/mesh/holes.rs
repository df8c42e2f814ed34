//! Open edges: small holes get a lid, larger ones are reported.

use super::edges::{self, Side};
use super::load::Soup;
use super::polygon;
use super::trimesh::bounds;
use crate::geom::P3;

/// An open loop of edges.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hole {
    /// The rim, in the direction a lid walks it: against the surface's own.
    pub(super) rim: Vec<u32>,
    /// Middle of the rim's box, in the soup's unit.
    pub(super) middle: P3,
    /// Diagonal of the rim's box.
    pub(super) extent: f64,
}

/// The loops that edges with a single triangle form. At a corner where several loops meet, each is closed as early as possible. Open edges
/// that form no loop (on sheets whose sides disagree) are left out.
pub(super) fn find(soup: &Soup) -> Vec<Hole> {
    let sides = edges::of(&soup.triangles);
    let open = sides
        .chunk_by(|a, b| a.key == b.key)
        .filter_map(|edge| if let [only] = edge { Some(only.ends()) } else { None });
    edges::loops(open.map(|(from, to)| (to, from))).into_iter().map(|rim| measured(soup, rim)).collect()
}

/// Adds a lid over `hole`.
pub(super) fn close(soup: &mut Soup, hole: &Hole) {
    let lid = polygon::triangulate(&soup.vertices, &hole.rim);
    soup.triangles.extend(lid);
}

/// Edges at which other than one or two triangles meet: how many, and the middle of the first.
pub(super) fn non_manifold(soup: &Soup) -> (usize, Option<P3>) {
    count(soup, |edge| edge.len() > 2)
}

/// Edges not walked equally often in both directions: how many, and the middle of the first. None means the mesh is closed.
pub(super) fn unbalanced(soup: &Soup) -> (usize, Option<P3>) {
    count(soup, |edge| !edges::balanced(edge))
}

fn count(soup: &Soup, wanted: impl Fn(&[Side]) -> bool) -> (usize, Option<P3>) {
    let sides = edges::of(&soup.triangles);
    let found: Vec<(u32, u32)> =
        sides.chunk_by(|a, b| a.key == b.key).filter(|edge| wanted(edge)).map(|edge| edge[0].key).collect();
    let middle = |(a, b): &(u32, u32)| nalgebra::center(&soup.vertices[*a as usize], &soup.vertices[*b as usize]);
    (found.len(), found.first().map(middle))
}

fn measured(soup: &Soup, rim: Vec<u32>) -> Hole {
    let (lo, hi) = bounds(rim.iter().map(|i| &soup.vertices[*i as usize]));
    Hole { middle: nalgebra::center(&lo, &hi), extent: (hi - lo).norm(), rim }
}

#[cfg(test)]
mod tests {
    use super::super::TriMesh;
    use super::super::samples::{cuboid, sphere};
    use super::*;
    use crate::geom::V3;

    fn soup(mesh: TriMesh) -> Soup {
        Soup { vertices: mesh.vertices, triangles: mesh.triangles }
    }

    #[test]
    fn a_closed_mesh_has_no_holes() {
        let ball = soup(sphere(P3::origin(), 10.0, 12));
        assert!(find(&ball).is_empty());
        assert_eq!(unbalanced(&ball), (0, None));
    }

    #[test]
    fn a_lid_closes_a_missing_side_where_it_was() {
        let mut cube = soup(cuboid(P3::origin(), V3::new(10.0, 20.0, 30.0)));
        cube.triangles.retain(|t| !t.iter().all(|i| cube.vertices[*i as usize].y > 19.0));
        let holes = find(&cube);
        assert_eq!(holes.len(), 1);
        assert_eq!(holes[0].middle, P3::new(5.0, 20.0, 15.0));
        assert!((holes[0].extent - 1000.0_f64.sqrt()).abs() < 1e-9);
        close(&mut cube, &holes[0]);
        assert_eq!(unbalanced(&cube).0, 0);
        let whole = TriMesh { vertices: cube.vertices, triangles: cube.triangles, up: V3::y() };
        assert!((whole.volume() - 6000.0).abs() < 1e-9);
    }

    #[test]
    fn holes_that_touch_in_a_corner_are_two() {
        let mut ball = soup(sphere(P3::origin(), 10.0, 8));
        // The two triangles at vertex 1 that share no edge: one of the top band and one two bands below its left neighbour.
        let top = ball.triangles.iter().position(|t| *t == [0, 1, 2]).unwrap();
        let below = ball.triangles.iter().position(|t| t.contains(&1) && !t.contains(&0) && !t.contains(&2)).unwrap();
        ball.triangles =
            ball.triangles.iter().enumerate().filter(|(i, _)| ![top, below].contains(i)).map(|(_, t)| *t).collect();
        let holes = find(&ball);
        assert_eq!(holes.iter().map(|h| h.rim.len()).collect::<Vec<_>>(), [3, 3]);
        holes.iter().for_each(|hole| close(&mut ball, hole));
        assert_eq!(unbalanced(&ball).0, 0);
    }

    #[test]
    fn a_wall_inside_a_cube_is_not_manifold() {
        let mut cube = soup(cuboid(P3::origin(), V3::repeat(1.0)));
        assert_eq!(non_manifold(&cube), (0, None));
        let wall = [cube.triangles[0][0], cube.triangles[0][1], 7];
        cube.triangles.push(wall);
        assert!(non_manifold(&cube).0 > 0);
    }
}
