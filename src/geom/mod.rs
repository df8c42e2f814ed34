//! 2D and 3D maths without domain words. Everything is f64 and in the unit the caller uses (mm everywhere in this crate).
//!
//! Points are positions, vectors are differences; rigid motions are [`Motion`]. Curves that get cut are [`Path`]s: straight lines and
//! circular arcs, because those are what a G-code controller, DXF and SVG all draw exactly.

mod arrangement;
mod beside;
mod company;
mod fillet;
mod path;
mod polygon;
mod similarity;
mod snap;
mod thickness;
pub mod tolerance;

pub use arrangement::{Coverage, Enclosed, clip, enclosed};
pub use beside::Obstacles;
pub use company::MotionTree;
pub use path::{Path, PathVertex, Segment};
pub use polygon::{
    closest_on_segment, contains, convex_hull, distance_to_loop, distance_to_segment, segments_cross, signed_area,
};
pub use similarity::similarity;
pub use snap::snap_round;
pub use thickness::{long_side, thickness};

/// A position in a plane.
pub type P2 = nalgebra::Point2<f64>;
/// A displacement in a plane.
pub type V2 = nalgebra::Vector2<f64>;
/// A position in space.
pub type P3 = nalgebra::Point3<f64>;
/// A displacement in space.
pub type V3 = nalgebra::Vector3<f64>;
/// A rigid motion of the plane: a turn about the origin, then a shift. Never a mirror.
pub type Motion = nalgebra::Isometry2<f64>;

/// A rigid motion of the plane and a scale: scaled and turned about the origin, then shifted. Never a mirror.
pub type Similarity = nalgebra::Similarity2<f64>;

/// The z component of the cross product of two plane vectors: positive when `b` lies counter-clockwise of `a`.
pub fn cross(a: V2, b: V2) -> f64 {
    a.x * b.y - a.y * b.x
}

/// An axis-parallel box. Empty (`min > max`) until a point is added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    /// Lower left corner.
    pub min: P2,
    /// Upper right corner.
    pub max: P2,
}

impl Rect {
    /// A box that holds nothing.
    pub const EMPTY: Rect =
        Rect { min: P2::new(f64::INFINITY, f64::INFINITY), max: P2::new(f64::NEG_INFINITY, f64::NEG_INFINITY) };

    /// The box from (0, 0) to (`width`, `height`).
    pub fn from_size(width: f64, height: f64) -> Rect {
        Rect { min: P2::origin(), max: P2::new(width, height) }
    }

    /// The smallest box around `points`.
    pub fn around<'a>(points: impl IntoIterator<Item = &'a P2>) -> Rect {
        points.into_iter().fold(Rect::EMPTY, |rect, p| rect.with(*p))
    }

    /// This box, grown to hold `p`.
    pub fn with(self, p: P2) -> Rect {
        Rect { min: self.min.inf(&p), max: self.max.sup(&p) }
    }

    /// The smallest box that holds both.
    pub fn union(self, other: Rect) -> Rect {
        Rect { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }

    /// This box with every side moved outward by `by` (inward when negative).
    pub fn grown(self, by: f64) -> Rect {
        Rect { min: self.min - V2::new(by, by), max: self.max + V2::new(by, by) }
    }

    /// True while no point was added.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x || self.min.y > self.max.y
    }

    /// Extent along x; 0 for an empty box.
    pub fn width(&self) -> f64 {
        (self.max.x - self.min.x).max(0.0)
    }

    /// Extent along y; 0 for an empty box.
    pub fn height(&self) -> f64 {
        (self.max.y - self.min.y).max(0.0)
    }

    /// The middle.
    pub fn center(&self) -> P2 {
        nalgebra::center(&self.min, &self.max)
    }

    /// True when `other` lies inside this box, allowing `slack` beyond each side.
    pub fn holds(&self, other: &Rect, slack: f64) -> bool {
        other.is_empty()
            || (other.min.x >= self.min.x - slack
                && other.min.y >= self.min.y - slack
                && other.max.x <= self.max.x + slack
                && other.max.y <= self.max.y + slack)
    }

    /// The side on which `other` reaches farthest beyond this box ("left", "right", "lower", "upper"), and how far; negative when it lies inside.
    pub fn overrun_by(&self, other: &Rect) -> (&'static str, f64) {
        let beyond = [
            ("left", self.min.x - other.min.x),
            ("right", other.max.x - self.max.x),
            ("lower", self.min.y - other.min.y),
            ("upper", other.max.y - self.max.y),
        ];
        beyond.into_iter().fold(beyond[0], |worst, b| if b.1 > worst.1 { b } else { worst })
    }

    /// True when the two boxes share more than their borders.
    pub fn overlaps(&self, other: &Rect) -> bool {
        self.min.x < other.max.x && other.min.x < self.max.x && self.min.y < other.max.y && other.min.y < self.max.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_tells_the_side_on_which_another_reaches_out() {
        let area = Rect::from_size(100.0, 50.0);
        let other = Rect { min: P2::new(5.0, -2.0), max: P2::new(103.0, 40.0) };
        assert_eq!(area.overrun_by(&other), ("right", 3.0));
        assert!(area.overrun_by(&area.grown(-1.0)).1 < 0.0);
        assert!(area.holds(&area.grown(0.4), 0.5) && !area.holds(&other, 0.5));
    }
}
