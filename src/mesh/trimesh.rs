//! The mesh as a value, and what can be asked of it.

use super::edges;
use crate::geom::{P3, V3};

/// A triangle mesh in mm: welded, oriented outward, with every index in range.
#[derive(Debug, Clone, PartialEq)]
pub struct TriMesh {
    /// Corner positions, mesh frame, mm.
    pub vertices: Vec<P3>,
    /// Corner indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Unit vector that points up.
    pub up: V3,
}

impl TriMesh {
    /// Corner positions of triangle `triangle`, mm.
    pub fn corners(&self, triangle: usize) -> [P3; 3] {
        self.triangles[triangle].map(|i| self.vertices[i as usize])
    }

    /// Smallest and largest corner of the axis-parallel box around the mesh, mesh frame, mm; infinite and reversed for an empty mesh.
    pub fn bounds(&self) -> (P3, P3) {
        bounds(&self.vertices)
    }

    /// Lowest and highest coordinate along [`TriMesh::up`], mm.
    pub fn height_range(&self) -> (f64, f64) {
        let heights = self.vertices.iter().map(|p| p.coords.dot(&self.up));
        heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), h| (lo.min(h), hi.max(h)))
    }

    /// Area of the surface, mm^2.
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|t| area_vector(&self.corners(t)).norm()).sum()
    }

    /// Enclosed volume, mm^3: the divergence theorem over the triangles, about the surface's middle so that an open mesh gives the
    /// volume of the cones from there. Volumes of overlapping components add up.
    pub fn volume(&self) -> f64 {
        let about = self.area_centroid();
        (0..self.triangles.len()).map(|t| cone_volume(&self.corners(t), about)).sum()
    }

    /// Middle of the enclosed volume; of the surface when the mesh is open or encloses nothing. Mesh frame, mm.
    pub fn centroid(&self) -> P3 {
        let about = self.area_centroid();
        let (mut volume, mut moment) = (0.0, V3::zeros());
        for t in 0..self.triangles.len() {
            let corners = self.corners(t);
            let cone = cone_volume(&corners, about);
            volume += cone;
            moment += corners.iter().map(|p| p - about).sum::<V3>() * (cone / 4.0);
        }
        let (lo, hi) = self.bounds();
        let size = hi - lo;
        if volume > 1e-6 * size.x * size.y * size.z && self.is_closed() { about + moment / volume } else { about }
    }

    /// True when every edge is walked equally often in both directions, so that the mesh bounds a volume.
    pub fn is_closed(&self) -> bool {
        edges::of(&self.triangles).chunk_by(|a, b| a.key == b.key).all(edges::balanced)
    }

    /// Middle of the surface by area; of the corners when it has none.
    fn area_centroid(&self) -> P3 {
        let (mut area, mut moment) = (0.0, V3::zeros());
        for t in 0..self.triangles.len() {
            let corners = self.corners(t);
            let a = area_vector(&corners).norm();
            area += a;
            moment += corners.iter().map(|p| p.coords).sum::<V3>() * (a / 3.0);
        }
        if area > 0.0 { P3::from(moment / area) } else { self.vertices.first().copied().unwrap_or_else(P3::origin) }
    }
}

/// Half the cross product of two sides: as long as the triangle's area, pointing outward.
pub(super) fn area_vector([a, b, c]: &[P3; 3]) -> V3 {
    0.5 * (b - a).cross(&(c - a))
}

/// Signed volume of the cone from `about` to a triangle: positive when the triangle faces away from there.
pub(super) fn cone_volume(corners: &[P3; 3], about: P3) -> f64 {
    area_vector(corners).dot(&(corners[0] - about)) / 3.0
}

/// Smallest and largest corner of the axis-parallel box around `points`.
pub(super) fn bounds<'a>(points: impl IntoIterator<Item = &'a P3>) -> (P3, P3) {
    let empty = (P3::from(V3::repeat(f64::INFINITY)), P3::from(V3::repeat(f64::NEG_INFINITY)));
    points.into_iter().fold(empty, |(lo, hi), p| (lo.inf(p), hi.sup(p)))
}

#[cfg(test)]
mod tests {
    use super::super::samples::{cuboid, sphere};
    use super::*;

    #[test]
    fn a_cuboid_knows_its_size_volume_and_middle() {
        let mesh = cuboid(P3::new(1.0, 2.0, 3.0), V3::new(10.0, 20.0, 30.0));
        assert_eq!(mesh.bounds(), (P3::new(1.0, 2.0, 3.0), P3::new(11.0, 22.0, 33.0)));
        assert_eq!(mesh.height_range(), (2.0, 22.0));
        assert!((mesh.volume() - 6000.0).abs() < 1e-9);
        assert!((mesh.area() - 2.0 * (200.0 + 300.0 + 600.0)).abs() < 1e-9);
        assert!((mesh.centroid() - P3::new(6.0, 12.0, 18.0)).norm() < 1e-9);
    }

    #[test]
    fn the_middle_of_a_solid_is_that_of_its_volume_not_of_its_surface() {
        // A small cube with much surface per volume hardly pulls: (8000 * 0 + 1 * 100) / 8001.
        let mut mesh = cuboid(P3::new(-10.0, -10.0, -10.0), V3::repeat(20.0));
        let small = cuboid(P3::new(99.5, -0.5, -0.5), V3::repeat(1.0));
        let shift = mesh.vertices.len() as u32;
        mesh.vertices.extend(small.vertices);
        mesh.triangles.extend(small.triangles.iter().map(|t| t.map(|i| i + shift)));
        assert!((mesh.centroid().x - 100.0 / 8001.0).abs() < 1e-9);
    }

    #[test]
    fn a_mesh_with_a_triangle_missing_is_open() {
        let mut mesh = sphere(P3::origin(), 10.0, 12);
        assert!(mesh.is_closed());
        mesh.triangles.pop();
        assert!(!mesh.is_closed());
    }
}
