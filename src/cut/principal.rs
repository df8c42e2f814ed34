//! The plane a body is cut by when nobody says otherwise.

use super::plane::front;
use super::{Error, Plane};
use crate::geom::{P3, V3};
use crate::mesh::TriMesh;
use nalgebra::{Matrix2, SymmetricEigen};

/// Footprints whose two spreads (variances) differ by less than this fraction have no longer side: squares, rounds, and what tessellation
/// makes of them.
const TIE: f64 = 0.02;

/// Principal axes within half a degree of the file's own are meant to be those: bodies are modelled square to their axes, and the rest is
/// tessellation.
const SQUARE_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// A vertical plane through the mesh's centroid. Its normal is the horizontal direction in which the surface spreads least (principal axes
/// of the surface's area seen from above), so that the outline is the body's widest view and the ruffles are as short as they can be. A
/// footprint as deep as it is wide takes the file's own axis instead of an arbitrary diagonal: z, or y where z is up. The normal points
/// toward the viewer (+z for y up, -y for z up).
///
/// # Errors
/// A mesh without triangles.
pub fn default_plane(mesh: &TriMesh) -> Result<Plane, Error> {
    if mesh.triangles.is_empty() {
        return Err(Error::EmptyMesh);
    }
    let origin = mesh.centroid();
    let front = front(mesh.up);
    let side = mesh.up.cross(&front);
    let spread = surface_spread(mesh, side, front);
    let eigen = SymmetricEigen::new(spread);
    let least = eigen.eigenvalues.imin();
    let (small, large) = (eigen.eigenvalues[least], eigen.eigenvalues[1 - least]);
    let axis = eigen.eigenvectors.column(least);
    let normal = if large - small <= TIE * large { front } else { (side * axis[0] + front * axis[1]).normalize() };
    let square = [front, side].into_iter().find(|axis| normal.cross(axis).norm() < SQUARE_RAD.sin());
    let normal = square.unwrap_or(normal);
    // Toward the viewer; exactly sideways, toward the side.
    let facing = if normal.dot(&front).abs() > 1e-9 { normal.dot(&front) } else { normal.dot(&side) };
    Ok(Plane { origin, normal: if facing < 0.0 { -normal } else { normal } })
}

/// Second moments of the surface's area about its middle, along two horizontal directions, mm^4. Exact for triangles: the mean of the
/// product over a triangle is (sum of corners * sum of corners + sum of corner products) / 12.
fn surface_spread(mesh: &TriMesh, side: V3, front: V3) -> Matrix2<f64> {
    let flat = |p: P3| nalgebra::Vector2::new(p.coords.dot(&side), p.coords.dot(&front));
    let parts: Vec<_> = (0..mesh.triangles.len())
        .map(|t| {
            let corners = mesh.corners(t);
            let area = 0.5 * (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).norm();
            (area, corners.map(flat))
        })
        .collect();
    let area: f64 = parts.iter().map(|(area, _)| area).sum();
    let middle = parts.iter().map(|(a, c)| (c[0] + c[1] + c[2]) * (a / 3.0)).sum::<nalgebra::Vector2<f64>>() / area;
    parts
        .iter()
        .map(|(a, corners)| {
            let c = corners.map(|p| p - middle);
            let sum = c[0] + c[1] + c[2];
            let squares: Matrix2<f64> = c.iter().map(|p| p * p.transpose()).sum();
            (sum * sum.transpose() + squares) * (a / 12.0)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::{cuboid, sphere};
    use nalgebra::{Rotation3, Unit};
    use proptest::prelude::*;

    #[test]
    fn the_normal_is_the_short_side_of_the_footprint() {
        let wide = cuboid(P3::new(0.0, 0.0, 0.0), V3::new(100.0, 10.0, 60.0));
        let plane = default_plane(&wide).unwrap();
        assert!((plane.normal - V3::z()).norm() < 1e-9);
        assert!((plane.origin - P3::new(50.0, 5.0, 30.0)).norm() < 1e-9);
        let deep = cuboid(P3::new(0.0, 0.0, 0.0), V3::new(60.0, 10.0, 100.0));
        assert!((default_plane(&deep).unwrap().normal - V3::x()).norm() < 1e-9);
    }

    #[test]
    fn square_and_round_footprints_take_the_files_own_axis() {
        let turn = Rotation3::from_axis_angle(&V3::y_axis(), 0.3);
        let mut cube = cuboid(P3::new(-5.0, 0.0, -5.0), V3::repeat(10.0));
        cube.vertices.iter_mut().for_each(|p| *p = turn * *p);
        assert_eq!(default_plane(&cube).unwrap().normal, V3::z());
        assert_eq!(default_plane(&sphere(P3::origin(), 5.0, 31)).unwrap().normal, V3::z());
        let upright = TriMesh { up: V3::z(), ..cube };
        assert!(default_plane(&upright).unwrap().normal.dot(&V3::z()).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn the_plane_turns_with_the_body(angle in -1.5..1.5f64) {
            let turn = Rotation3::from_axis_angle(&Unit::new_normalize(V3::y()), angle);
            let mut mesh = cuboid(P3::new(-50.0, 0.0, -20.0), V3::new(100.0, 30.0, 40.0));
            mesh.vertices.iter_mut().for_each(|p| *p = turn * *p);
            let normal = default_plane(&mesh).unwrap().normal;
            let off = (normal - turn * V3::z()).norm();
            prop_assert!(off < if angle.abs() > SQUARE_RAD { 1e-9 } else { 0.01 }, "{normal}");
        }
    }
}
