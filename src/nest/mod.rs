//! Places polygons on sheets, offcuts and rolls. Knows nothing of ruffles.
//!
//! ```text
//! items --shape--> bands, grown by half the spacing      containers --bays--> rectangles side by side, and what is blocked in them
//!                       `--start--> a complete layout --squeeze--> fewer sheets --shorten--> shorter --gather, settle--> tidy
//! ```
//!
//! A shape is a few y-monotone bands (`band`, `chain`); a flat strip lying along x is one. For two shapes and an offset along x, the heights at which they
//! overlap follow exactly from the bands' borders (`shape`): a vertical line through their no-fit polygon, without the polygon. So `look` finds the best of
//! all heights at once, and `separate` takes overlapping layouts apart by guided local search over x and turns alone. Effort is the number of lines looked
//! along, so results do not depend on how busy the machine is.
//!
//! All of it is f64 and errs outward. [`validate`] checks a result on the true polygons, knowing nothing of how it was made; nothing leaves [`nest`] that
//! fails it.

mod band;
mod bays;
mod chain;
mod empty;
mod error;
mod fewer;
mod format;
mod gather;
mod instance;
mod item;
mod layouts;
mod look;
mod offcut;
mod pairs;
mod random;
mod relocate;
mod scene;
mod search;
mod separate;
mod shape;
mod shorten;
mod squeeze;
mod start;
mod validate;
mod watch;

#[cfg(test)]
mod tests;

pub use error::{Error, Reason, Unplaced};
pub use format::Solution;
pub use instance::{Instance, InstanceError};
pub use offcut::offcut;
pub use search::nest;
pub use validate::validate;

use crate::geom::{Motion, P2, V2};

/// Lengths below this are round-off, mm: a tenth of what [`validate`] forgives.
const NARROW_MM: f64 = 1e-7;

/// Distances to keep, and how long to search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Smallest distance between two items, and between an item and what is blocked, mm; room for the kerf of both included.
    pub spacing_mm: f64,
    /// Smallest distance from an item to the border of its container, mm.
    pub margin_mm: f64,
    /// How many lines to look along for better places; 0 takes the first complete layout. A processor core looks along some 100 000 in a second.
    pub effort: u64,
    /// Start of the random numbers: the same seed and effort give the same layouts.
    pub seed: u64,
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
    /// How many of it.
    pub copies: u32,
    /// It may be turned over: only where the material has no right side and the shape none either.
    pub mirror: bool,
    /// Where stock runs out, items of higher priority are placed first.
    pub priority: i32,
    /// Items with the same number lie on one sheet when that costs nothing.
    pub set: Option<u32>,
    /// It lies here already and stays.
    pub fixed: Option<Fixed>,
}

impl Item {
    /// One of a shape, never turned over, with nothing special about it.
    pub fn new(name: impl Into<String>, polygon: Vec<P2>, angles_deg: Vec<f64>) -> Item {
        let name = name.into();
        Item { name, polygon, angles_deg, copies: 1, mirror: false, priority: 0, set: None, fixed: None }
    }
}

/// Where an item lies that is not to be moved: on the first sheet of its kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fixed {
    /// Index into the containers.
    pub container: usize,
    /// Turn, degrees counter-clockwise.
    pub rotation_deg: f64,
    /// Shift after the turn, mm.
    pub shift: V2,
}

/// Something to place shapes on. Sizes are the usable outer size; the margin is taken off inside [`nest`].
#[derive(Debug, Clone, PartialEq)]
pub enum Container {
    /// A sheet or an offcut, origin bottom left, x right, y up.
    Sheet {
        /// What people call it: "A4".
        name: String,
        /// Extent along x, mm.
        width_mm: f64,
        /// Extent along y, mm.
        height_mm: f64,
        /// How many there are; `None` for as many as needed.
        count: Option<u32>,
        /// What one costs, in any unit, against the others; an offcut costs less than a fresh sheet.
        cost: f64,
        /// Its border where it is no rectangle, mm; empty for the whole rectangle.
        outline: Vec<P2>,
        /// Where nothing may lie, mm: holes, defects, clamps.
        blocked: Vec<Vec<P2>>,
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

impl Container {
    /// A rectangular sheet without flaws, at the cost of 1.
    pub fn sheet(name: impl Into<String>, width_mm: f64, height_mm: f64, count: Option<u32>) -> Container {
        let name = name.into();
        Container::Sheet { name, width_mm, height_mm, count, cost: 1.0, outline: Vec::new(), blocked: Vec::new() }
    }

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

    /// What one costs against the others.
    pub fn cost(&self) -> f64 {
        match self {
            Container::Sheet { cost, .. } => *cost,
            Container::Roll { .. } => 1.0,
        }
    }

    /// Its border where it is no rectangle, and what is blocked.
    fn flaws(&self) -> (&[P2], &[Vec<P2>]) {
        match self {
            Container::Sheet { outline, blocked, .. } => (outline, blocked),
            Container::Roll { .. } => (&[], &[]),
        }
    }
}

/// Where one item went: its own coordinates, turned over if `mirrored`, turned about their origin, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Index into the items.
    pub item: usize,
    /// Which of its copies, from 0.
    pub copy: u32,
    /// Turned over first: y becomes -y.
    pub mirrored: bool,
    /// Turn, degrees counter-clockwise.
    pub rotation_deg: f64,
    /// Shift after the turn, mm.
    pub shift: V2,
}

impl Placement {
    /// From item coordinates, turned over if need be, to layout coordinates.
    pub fn motion(&self) -> Motion {
        Motion::new(self.shift, self.rotation_deg.to_radians())
    }

    /// An outline in item coordinates as it lies in the layout.
    pub fn placed(&self, polygon: &[P2]) -> Vec<P2> {
        let motion = self.motion();
        polygon.iter().map(|p| motion * if self.mirrored { P2::new(p.x, -p.y) } else { *p }).collect()
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

/// Everything that found a place.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layouts {
    /// One layout per sheet, or per length of roll, in the order they were opened.
    pub layouts: Vec<Layout>,
    /// Copies of items that found no place, and why.
    pub unplaced: Vec<Unplaced>,
    /// The observer stopped the search before its effort was spent; the result is valid all the same.
    pub stopped_early: bool,
}
