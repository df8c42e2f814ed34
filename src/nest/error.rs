//! What can be wrong with a nesting job or its result.

use std::fmt;

/// Why a nesting job has no layout, or what [`super::validate`] found wrong with one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The distances make no sense.
    #[error("{name} is {value_mm} mm; give a finite distance of at least 0 mm")]
    Distance {
        /// "spacing" or "margin".
        name: &'static str,
        /// What was given, mm.
        value_mm: f64,
    },
    /// There is nothing to place on.
    #[error("there is no stock to nest on; give at least one sheet or roll")]
    NoContainer,
    /// More than can be handled at once.
    #[error("{pieces} pieces are asked for, and {most} can be nested at a time; nest them in several jobs")]
    TooMany {
        /// Pieces asked for.
        pieces: u64,
        /// Most that is possible.
        most: u64,
    },
    /// A sheet or roll without a proper size.
    #[error("stock {container:?} measures {width_mm} x {height_mm} mm; both sides must be finite and above 0 mm")]
    ContainerSize {
        /// Name of the container.
        container: String,
        /// Extent along x, mm.
        width_mm: f64,
        /// Extent along y, mm.
        height_mm: f64,
    },
    /// A price that is none.
    #[error("stock {container:?} costs {cost}; give a finite number of at least 0")]
    Cost {
        /// Name of the container.
        container: String,
        /// What was given.
        cost: f64,
    },
    /// The border of an offcut, or what is blocked on a sheet, is no shape.
    #[error("stock {container:?}, its border or what is blocked on it: {flaw}")]
    ContainerShape {
        /// Name of the container.
        container: String,
        /// What is wrong, and what is needed.
        flaw: &'static str,
    },
    /// An item lies over a border that is no rectangle, over a hole, a defect or a clamp.
    #[error(
        "item {item:?} on layout {layout} comes within {distance_mm:.6} mm of {what} of {container:?}; {limit_mm} mm are asked for"
    )]
    Blocked {
        /// Name of the item.
        item: String,
        /// Number of the layout, from 1.
        layout: usize,
        /// Name of the container.
        container: String,
        /// "the border" or "what is blocked".
        what: &'static str,
        /// Distance found, mm; 0 when they overlap.
        distance_mm: f64,
        /// Distance to keep, mm.
        limit_mm: f64,
    },
    /// An item was fixed in place and lies elsewhere.
    #[error("item {item:?} is fixed in place, but is placed elsewhere")]
    Moved {
        /// Name of the item.
        item: String,
    },
    /// A shape that cannot be placed because it is none.
    #[error("item {item:?} cannot be nested: {flaw}")]
    Item {
        /// Name of the item.
        item: String,
        /// What is wrong, and what is needed.
        flaw: &'static str,
    },
    /// Not everything found a place.
    #[error("{} of the items found no place: {}", .0.len(), list(.0))]
    Unplaced(Vec<Unplaced>),
    /// A layout or placement that names something that does not exist.
    #[error("layout {layout} refers to {what} number {index}, which does not exist")]
    Dangling {
        /// Number of the layout, from 1.
        layout: usize,
        /// "container", "item" or "copy".
        what: &'static str,
        /// The index that is out of range.
        index: usize,
    },
    /// An item is not placed exactly once.
    #[error("item {item:?} is placed {times} times instead of once")]
    Times {
        /// Name of the item.
        item: String,
        /// How often it is placed.
        times: usize,
    },
    /// A turn the grain does not permit.
    #[error("item {item:?} is turned by {rotation_deg} degrees, which its allowed angles do not contain")]
    Angle {
        /// Name of the item.
        item: String,
        /// The turn, degrees.
        rotation_deg: f64,
    },
    /// A side up that the material does not permit.
    #[error("item {item:?} is turned over, which is not allowed for it")]
    Mirrored {
        /// Name of the item.
        item: String,
    },
    /// A layout that is larger or smaller than its container.
    #[error("layout {layout} measures {width_mm} x {height_mm} mm, which its stock {container:?} cannot give")]
    LayoutSize {
        /// Number of the layout, from 1.
        layout: usize,
        /// Name of the container.
        container: String,
        /// Extent along x, mm.
        width_mm: f64,
        /// Extent along y, mm.
        height_mm: f64,
    },
    /// More sheets used than there are.
    #[error("{used} sheets of {container:?} are used, but there are {count}")]
    Stock {
        /// Name of the container.
        container: String,
        /// Sheets used.
        used: usize,
        /// Sheets there are.
        count: u32,
    },
    /// An item comes too near the border.
    #[error("item {item:?} on layout {layout} reaches {by_mm:.6} mm into the margin of {margin_mm} mm")]
    Margin {
        /// Name of the item.
        item: String,
        /// Number of the layout, from 1.
        layout: usize,
        /// How far, mm.
        by_mm: f64,
        /// What was asked for, mm.
        margin_mm: f64,
    },
    /// Two items lie on each other.
    #[error("items {first:?} and {second:?} on layout {layout} overlap by {area_mm2:.6} mm2")]
    Overlap {
        /// Name of one item.
        first: String,
        /// Name of the other.
        second: String,
        /// Number of the layout, from 1.
        layout: usize,
        /// Common area, mm2.
        area_mm2: f64,
    },
    /// Two items are too near each other.
    #[error(
        "items {first:?} and {second:?} on layout {layout} are {distance_mm:.6} mm apart, the spacing is {spacing_mm} mm"
    )]
    Spacing {
        /// Name of one item.
        first: String,
        /// Name of the other.
        second: String,
        /// Number of the layout, from 1.
        layout: usize,
        /// Distance found, mm.
        distance_mm: f64,
        /// What was asked for, mm.
        spacing_mm: f64,
    },
}

/// One item without a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Unplaced {
    /// Index into the items.
    pub item: usize,
    /// Which of its copies, from 0.
    pub copy: u32,
    /// Name of the item.
    pub name: String,
    /// Why.
    pub reason: Reason,
}

/// Why an item has no place.
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    /// No container holds it, however it is turned.
    TooLarge {
        /// The container it comes nearest to fitting.
        container: String,
        /// How much is missing there, mm, margins taken off.
        by_mm: f64,
    },
    /// Its box would fit, but no stock is free of borders and blocked places where it would lie.
    NoRoom,
    /// It would fit, but every sheet that holds it is full.
    StockUsedUp,
}

impl fmt::Display for Unplaced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.reason {
            Reason::TooLarge { container, by_mm } => write!(
                f,
                "{:?} is {by_mm:.1} mm too large for every stock at the angles allowed (nearest: {container:?}); \
                 give larger stock, a smaller margin, or shorter pieces",
                self.name
            ),
            Reason::NoRoom => write!(
                f,
                "{:?} fits into no stock beside what is blocked there, at the angles allowed; give larger stock, or move the clamps",
                self.name
            ),
            Reason::StockUsedUp => write!(f, "{:?} fits, but the stock is used up; give more sheets", self.name),
        }
    }
}

/// Every reason once, with how often it holds.
fn list(unplaced: &[Unplaced]) -> String {
    let mut reasons: Vec<(String, usize)> = Vec::new();
    for text in unplaced.iter().map(Unplaced::to_string) {
        match reasons.iter_mut().find(|(known, _)| *known == text) {
            Some((_, times)) => *times += 1,
            None => reasons.push((text, 1)),
        }
    }
    let told = |(text, times): (String, usize)| if times == 1 { text } else { format!("{times} times {text}") };
    reasons.into_iter().map(told).collect::<Vec<_>>().join("; ")
}
