//! A plane through a mesh gives the outline that a ruffle has to fill.

mod outline;
mod plane;

pub use outline::Outline;
pub use plane::{Plane, PlaneFrame};
