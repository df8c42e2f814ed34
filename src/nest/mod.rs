//! Places polygons on sheets and rolls. Knows nothing of ruffles.
//!
//! [`nest`] packs the boxes around the turned polygons (`maxrects`), tries several orders and rules (`search`) and keeps the best by
//! fewest layouts, then preferred stock, then shortest used length. [`validate`] checks a result on the true polygons; nothing leaves
//! [`nest`] that fails it.

mod band;
mod chain;
mod error;
mod item;
pub mod lab;
mod look;
mod maxrects;
mod random;
mod scene;
mod search;
mod separate;
mod shape;
mod shorten;
mod start;
mod validate;

/// Lengths below this are round-off, mm.
const NARROW_MM: f64 = 1e-7;

pub use error::{Error, Reason, Unplaced};
pub use search::nest;
pub use validate::validate;

use crate::geom::{Motion, P2, V2};

/// Distances to keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Smallest distance between two items, mm; room for the kerf of both included.
    pub spacing_mm: f64,
    /// Smallest distance from an item to the border of its container, mm.
    pub margin_mm: f64,
}

/// A shape to place.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// Name for reports and errors.
    pub name: String,
    /// Outer polygon, mm, anywhere in the plane, in either direction; the first point is not repeated.
    pub polygon: Vec<P2>,
    /// Turns allowed, in degrees, as the grain of the material permits. Never empty.
    pub angles_deg: Vec<f64>,
}

/// Something to place shapes on. Sizes are the usable outer size; the margin is taken off inside [`nest`].
#[derive(Debug, Clone, PartialEq)]
pub enum Container {
    /// A rectangular sheet, origin bottom left, x right, y up.
    Sheet {
        /// What people call it: "A4".
        name: String,
        /// Extent along x, mm.
        width_mm: f64,
        /// Extent along y, mm.
        height_mm: f64,
        /// How many there are; `None` for as many as needed.
        count: Option<u32>,
    },
    /// A roll: x along the feed and open-ended, y across. When one layout is full, the next takes a fresh length of the roll.
    Roll {
        /// What people call it.
        name: String,
        /// Usable width across the feed, mm.
        width_mm: f64,
        /// Longest layout along the feed, mm.
        max_length_mm: f64,
    },
}

/// Where one item went: its own coordinates turned about their origin, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Index into the items.
    pub item: usize,
    /// Turn, degrees counter-clockwise.
    pub rotation_deg: f64,
    /// Shift after the turn, mm.
    pub shift: V2,
}

impl Placement {
    /// From item coordinates to layout coordinates.
    pub fn motion(&self) -> Motion {
        Motion::new(self.shift, self.rotation_deg.to_radians())
    }
}

/// One filled container.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Index into the containers.
    pub container: usize,
    /// Extent along x, mm: the sheet's, or the length of roll used, margins included.
    pub width_mm: f64,
    /// Extent along y, mm.
    pub height_mm: f64,
    /// What lies on it.
    pub placements: Vec<Placement>,
    /// Area of the items over the layout's area.
    pub density: f64,
}

/// Everything placed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layouts {
    /// One layout per sheet, or per length of roll, in the order they were opened.
    pub layouts: Vec<Layout>,
    /// The observer stopped the search before every order was tried; the result is complete and valid all the same.
    pub stopped_early: bool,
}

impl Container {
    /// What people call it.
    pub fn name(&self) -> &str {
        match self {
            Container::Sheet { name, .. } | Container::Roll { name, .. } => name,
        }
    }

    /// Greatest extent along x and y, mm: the sheet's, or the roll's longest layout and its width.
    pub fn size_mm(&self) -> V2 {
        match *self {
            Container::Sheet { width_mm, height_mm, .. } => V2::new(width_mm, height_mm),
            Container::Roll { width_mm, max_length_mm, .. } => V2::new(max_length_mm, width_mm),
        }
    }

    /// How many layouts it can give; `None` for as many as needed.
    pub fn count(&self) -> Option<u32> {
        match self {
            Container::Sheet { count, .. } => *count,
            Container::Roll { .. } => None,
        }
    }
}
