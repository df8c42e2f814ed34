//! OBJ and STL bytes become a checked triangle mesh in mm.
//!
//! The mesh keeps the axes of its file; only the unit changes. [`TriMesh::up`] says which way is up.

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
