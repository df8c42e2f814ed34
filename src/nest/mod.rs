//! Places polygons on sheets and rolls. Knows nothing of ruffles.

use crate::geom::{Motion, P2, V2};

/// A shape to place.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// Name for reports and errors.
    pub name: String,
    /// Outer polygon, mm, counter-clockwise, anywhere in the plane.
    pub polygon: Vec<P2>,
    /// Turns allowed, in degrees, as the grain of the material permits. Never empty.
    pub angles_deg: Vec<f64>,
}

/// Something to place shapes on.
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
    /// A roll: x along the feed and open-ended, y across.
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
