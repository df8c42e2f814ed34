//! Small closed meshes for tests, y up.

use super::TriMesh;
use crate::geom::{P3, V3};
use std::f64::consts::PI;

/// An axis-parallel box with its smallest corner at `corner`.
pub(crate) fn cuboid(corner: P3, size: V3) -> TriMesh {
    let vertices = (0..8)
        .map(|i| {
            let pick = |bit: i32, extent: f64| if i >> bit & 1 == 1 { extent } else { 0.0 };
            corner + V3::new(pick(0, size.x), pick(1, size.y), pick(2, size.z))
        })
        .collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    TriMesh { vertices, triangles, up: V3::y() }
}

/// A sphere with `n` meridians and `n / 2` bands.
pub(crate) fn sphere(center: P3, radius: f64, n: u32) -> TriMesh {
    let bands = n / 2;
    let mut vertices = vec![center + V3::new(0.0, radius, 0.0)];
    for band in 1..bands {
        let polar = PI * f64::from(band) / f64::from(bands);
        for i in 0..n {
            let turn = 2.0 * PI * f64::from(i) / f64::from(n);
            let (r, y) = (radius * polar.sin(), radius * polar.cos());
            vertices.push(center + V3::new(r * turn.cos(), y, -r * turn.sin()));
        }
    }
    vertices.push(center - V3::new(0.0, radius, 0.0));
    let at = |band: u32, i: u32| 1 + (band - 1) * n + i % n;
    let last = vertices.len() as u32 - 1;
    let mut triangles = Vec::new();
    for i in 0..n {
        triangles.push([0, at(1, i), at(1, i + 1)]);
        for band in 1..bands - 1 {
            triangles.push([at(band, i), at(band + 1, i), at(band + 1, i + 1)]);
            triangles.push([at(band, i), at(band + 1, i + 1), at(band, i + 1)]);
        }
        triangles.push([at(bands - 1, i), last, at(bands - 1, i + 1)]);
    }
    TriMesh { vertices, triangles, up: V3::y() }
}

/// Several meshes as one, nothing merged.
pub(crate) fn together(meshes: &[TriMesh]) -> TriMesh {
    super::together(&meshes.iter().collect::<Vec<_>>())
}

/// The mesh inside out.
pub(crate) fn inside_out(mut mesh: TriMesh) -> TriMesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

/// The mesh as an OBJ file's text.
pub(crate) fn obj_text(mesh: &TriMesh) -> String {
    let vertices = mesh.vertices.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z));
    let faces = mesh.triangles.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    vertices.chain(faces).collect()
}
