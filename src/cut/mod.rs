//! A plane through a mesh gives the outline that a ruffle has to fill.
//!
//! [`default_plane`] proposes a plane. [`cut`] intersects (`section`), closes what an open mesh leaves open (`close`), unites loops that
//! overlap (`union`), thins the result out (`simplify`) and puts it into a frame with the floor at v = 0.

mod close;
mod error;
mod outline;
mod plane;
mod principal;
mod section;
mod simplify;
mod slice;
mod union;

pub use error::Error;
pub use outline::Outline;
pub use plane::{Plane, PlaneFrame};
pub use principal::default_plane;
pub use slice::{Cut, Settings, cut};
