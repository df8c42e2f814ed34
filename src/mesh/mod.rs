//! OBJ and STL bytes become a checked triangle mesh in mm.
//!
//! The mesh keeps the axes of its file; only the unit changes. [`TriMesh::up`] says which way is up. Steps, one file each: read (`obj`,
//! `stl`), find the size (`size`), merge equal corners (`weld`), turn every triangle outward (`orient`), close small holes (`holes`).
//! What cannot be mended is a warning as long as the mesh can still be cut, an [`Error`] otherwise.
//!
//! A mesh is taken apart into its bodies ([`components`]) or by planes ([`split()`], with lids from `caps`); bodies that overlap are parted by the plane in which
//! their surfaces meet ([`parting_plane`]). [`contact`] tells where two of the pieces touch.

mod caps;
mod components;
mod edges;
mod error;
mod holes;
mod load;
mod obj;
mod orient;
mod parting;
mod polygon;
#[cfg(test)]
pub(crate) mod samples;
mod size;
mod split;
mod stl;
mod touching;
mod trimesh;
mod weld;

pub use components::{components, together};
pub use error::Error;
pub use load::{Format, Loaded, MAX_BYTES, Settings, Up, load, parse};
pub use parting::{Parting, parting_plane};
pub use split::{Halves, split};
pub use touching::{Contact, contact};
pub use trimesh::TriMesh;
