//! How wide the strip is at each node: the mesh seen along the plane's normal.
//!
//! A line through a node, parallel to the normal, runs inside the mesh for some stretches (`silhouette`); the one that holds the plane is
//! the node's span (the extrusion width of the paper's figure 10). Nodes whose line misses the mesh take what their neighbours on the
//! strip have (`extruder`).

mod extruder;
mod silhouette;
mod span;

pub use extruder::{Beyond, Extruder, Solid};
pub use span::{Error, Span};
