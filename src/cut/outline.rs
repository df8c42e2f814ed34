//! The closed 2D target of a ruffle.

use crate::geom::{P2, Rect, contains, distance_to_loop, signed_area};

/// A region of the plane: one outer loop and the holes in it, mm, plane frame (u right, v up, floor at v = 0).
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Counter-clockwise outer loop.
    pub outer: Vec<P2>,
    /// Clockwise loops of the holes, each inside the outer loop.
    pub holes: Vec<Vec<P2>>,
}

impl Outline {
    /// Outer loop first, then the holes.
    pub fn loops(&self) -> impl Iterator<Item = &Vec<P2>> + Clone {
        std::iter::once(&self.outer).chain(&self.holes)
    }

    /// Area of the region, holes taken off.
    pub fn area(&self) -> f64 {
        self.loops().map(|l| signed_area(l)).sum()
    }

    /// True when `p` lies in the region.
    pub fn contains(&self, p: P2) -> bool {
        contains(&self.outer, p) && !self.holes.iter().any(|hole| contains(hole, p))
    }

    /// Distance to the nearest border, positive inside, negative outside (the paper's d, section 4.2).
    pub fn signed_distance(&self, p: P2) -> f64 {
        let distance = self.loops().map(|l| distance_to_loop(l, p)).fold(f64::INFINITY, f64::min);
        if self.contains(p) { distance } else { -distance }
    }

    /// The box around the outer loop.
    pub fn bounds(&self) -> Rect {
        Rect::around(&self.outer)
    }

    /// The intervals of u that lie inside at height `v`, left to right.
    pub fn chords(&self, v: f64) -> Vec<(f64, f64)> {
        let mut crossings: Vec<f64> = Vec::new();
        for points in self.loops() {
            for (i, a) in points.iter().enumerate() {
                let b = points[(i + 1) % points.len()];
                if (a.y > v) != (b.y > v) {
                    crossings.push(a.x + (v - a.y) / (b.y - a.y) * (b.x - a.x));
                }
            }
        }
        crossings.sort_by(f64::total_cmp);
        crossings.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square_with_a_hole() -> Outline {
        let p = |(x, y)| P2::new(x, y);
        Outline {
            outer: [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(p).to_vec(),
            holes: vec![[(4.0, 4.0), (4.0, 6.0), (6.0, 6.0), (6.0, 4.0)].map(p).to_vec()],
        }
    }

    #[test]
    fn a_hole_is_outside_and_costs_area() {
        let outline = square_with_a_hole();
        assert_eq!(outline.area(), 96.0);
        assert!(!outline.contains(P2::new(5.0, 5.0)));
        assert!((outline.signed_distance(P2::new(5.0, 5.0)) + 1.0).abs() < 1e-12);
        assert!((outline.signed_distance(P2::new(2.0, 5.0)) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn chords_go_round_holes() {
        assert_eq!(square_with_a_hole().chords(5.0), vec![(0.0, 4.0), (6.0, 10.0)]);
        assert_eq!(square_with_a_hole().chords(1.0), vec![(0.0, 10.0)]);
        assert!(square_with_a_hole().chords(11.0).is_empty());
    }
}
