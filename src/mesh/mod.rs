//! OBJ and STL bytes become a checked triangle mesh in mm.
//!
//! The mesh keeps the axes of its file; only the unit changes. [`TriMesh::up`] says which way is up. Steps, one file each: read (`obj`,
//! `stl`), find the size (`size`), merge equal corners (`weld`), turn every triangle outward (`orient`), close small holes (`holes`).
//! What cannot be mended is a warning as long as the mesh can still be cut, an [`Error`] otherwise.

mod edges;
mod error;
mod holes;
mod load;
mod obj;
mod orient;
mod polygon;
#[cfg(test)]
pub(crate) mod samples;
mod size;
mod stl;
mod trimesh;
mod weld;

pub use error::Error;
pub use load::{Format, Loaded, MAX_BYTES, Settings, Up, load, parse};
pub use trimesh::TriMesh;
