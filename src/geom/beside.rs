//! Finds a free place beside each of many points, for its label.

use super::{P2, Rect, V2};
use std::f64::consts::TAU;

/// Directions tried around a dot.
const DIRECTIONS: usize = 16;
/// Distances tried between dot and label, as multiples of the label's height; also what a candidate costs for being far.
const DISTANCES: [f64; 4] = [0.4, 0.8, 1.3, 1.9];

// Costs that rank what a label may come to lie on: the picture's edge, another text, a dot, a curve, the air beside a curve.
const COST_OUTSIDE: f64 = 1e4;
const COST_ON_TEXT: f64 = 1e3;
const COST_ON_DOT: f64 = 200.0;
const COST_ON_LINE: f64 = 10.0;
const COST_NEAR_LINE: f64 = 3.0;

/// What labels keep clear of.
#[derive(Debug, Clone, Copy)]
pub struct Obstacles<'a> {
    /// Straight pieces of the curve.
    pub lines: &'a [(P2, P2)],
    /// The dots that get labels.
    pub dots: &'a [P2],
    /// Radius of a dot.
    pub dot_mm: f64,
    /// Labels stay in this box.
    pub area: Rect,
}

impl Obstacles<'_> {
    /// The boxes of labels `widths_mm` wide and `height_mm` high, one for each dot in their order, each at the place that covers least;
    /// `clear_mm` of air is kept to the curve where there is room.
    pub fn place(&self, widths_mm: &[f64], height_mm: f64, clear_mm: f64) -> Vec<Rect> {
        let mut taken: Vec<Rect> = Vec::new();
        for (dot, width) in self.dots.iter().zip(widths_mm) {
            let half = V2::new(*width, height_mm) * 0.5;
            let far = self.dot_mm + DISTANCES[DISTANCES.len() - 1] * height_mm + clear_mm;
            let reach = Rect { min: *dot, max: *dot }.grown(far + 2.0 * half.max());
            let lines: Vec<(P2, P2)> = self.lines.iter().filter(|(a, b)| meets(&reach, *a, *b)).copied().collect();
            let mut best: Option<(f64, Rect)> = None;
            for distance in DISTANCES {
                let gap = self.dot_mm + distance * height_mm;
                for direction in 0..DIRECTIONS {
                    let (sin, cos) = (TAU * direction as f64 / DIRECTIONS as f64).sin_cos();
                    let center = dot + V2::new(cos * (half.x + gap), sin * (half.y + gap));
                    let rect = Rect { min: center - half, max: center + half };
                    let cost = distance + self.cost(&rect, &lines, &taken, clear_mm);
                    if best.is_none_or(|(least, _)| cost < least) {
                        best = Some((cost, rect));
                    }
                }
            }
            taken.extend(best.map(|(_, rect)| rect));
        }
        taken
    }

    fn cost(&self, rect: &Rect, lines: &[(P2, P2)], taken: &[Rect], clear_mm: f64) -> f64 {
        let with_air = rect.grown(clear_mm);
        let to_dot = rect.grown(self.dot_mm);
        let count = |n: usize, cost: f64| n as f64 * cost;
        count(usize::from(!self.area.holds(rect, 0.0)), COST_OUTSIDE)
            + count(taken.iter().filter(|t| t.overlaps(&with_air)).count(), COST_ON_TEXT)
            + count(self.dots.iter().filter(|d| to_dot.overlaps(&Rect { min: **d, max: **d })).count(), COST_ON_DOT)
            + count(lines.iter().filter(|(a, b)| meets(rect, *a, *b)).count(), COST_ON_LINE)
            + count(usize::from(lines.iter().any(|(a, b)| meets(&with_air, *a, *b))), COST_NEAR_LINE)
    }
}

/// True when the line from `a` to `b` passes through the box: the parts of it within the two slabs overlap
/// (Liang and Barsky 1984, doi:10.1145/357332.357333).
fn meets(rect: &Rect, a: P2, b: P2) -> bool {
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        let (from, along) = (a[axis], b[axis] - a[axis]);
        if along == 0.0 {
            if from < rect.min[axis] || from > rect.max[axis] {
                return false;
            }
            continue;
        }
        let (s, t) = ((rect.min[axis] - from) / along, (rect.max[axis] - from) / along);
        enter = enter.max(s.min(t));
        leave = leave.min(s.max(t));
    }
    enter <= leave
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_meets_a_box_it_crosses_or_lies_in_and_no_other() {
        let rect = Rect::from_size(4.0, 2.0);
        let p = |x, y| P2::new(x, y);
        assert!(meets(&rect, p(-1.0, 1.0), p(9.0, 1.0)));
        assert!(meets(&rect, p(1.0, 1.0), p(2.0, 1.5)));
        assert!(meets(&rect, p(-1.0, -0.5), p(5.0, 2.5)), "corner to corner");
        assert!(!meets(&rect, p(-1.0, 3.0), p(9.0, 3.0)));
        assert!(!meets(&rect, p(-1.0, 1.0), p(-0.5, 1.0)));
        assert!(!meets(&rect, p(3.0, -2.0), p(7.0, 2.0)));
    }

    #[test]
    fn labels_beside_a_crowded_curve_cover_neither_the_curve_nor_each_other() {
        // A zigzag 12 mm wide with a dot in each corner: there is room beside every dot.
        let dots: Vec<P2> = (0..12).map(|i| P2::new(f64::from(i % 2) * 12.0, f64::from(i) * 5.0)).collect();
        let lines: Vec<(P2, P2)> = dots.windows(2).map(|w| (w[0], w[1])).collect();
        let area = Rect::around(&dots).grown(10.0);
        let obstacles = Obstacles { lines: &lines, dots: &dots, dot_mm: 0.5, area };
        let placed = obstacles.place(&[3.0; 12], 2.0, 0.5);
        assert_eq!(placed.len(), 12);
        for (i, rect) in placed.iter().enumerate() {
            assert!(area.holds(rect, 0.0) && (rect.center() - dots[i]).norm() < 7.0);
            assert!(!lines.iter().any(|(a, b)| meets(rect, *a, *b)), "label {i} covers the curve");
            assert!(!placed[..i].iter().any(|other| other.overlaps(rect)), "label {i} covers another");
        }
    }
}
