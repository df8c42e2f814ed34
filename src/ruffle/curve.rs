//! Curves that sections are drawn along.

use crate::geom::{P2, V2};
use lyon::geom::{CubicBezierSegment, point};

/// A loop needs this many segments to bend smoothly through half a turn.
pub(super) const MIN_SEGMENTS: usize = 8;
/// Points that stand for a smooth curve.
const FINE: usize = 512;

/// How many segments of about `segment_mm` a section of `length_mm` is divided into.
pub(super) fn segments_for(length_mm: f64, segment_mm: f64) -> usize {
    ((length_mm / segment_mm).round() as usize).max(MIN_SEGMENTS)
}

/// From 0 to 1 with level ends: 3 t² - 2 t³.
pub(super) fn smooth(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

/// A section as drawn: points so close together that chords and curve are the same, and how far along each of them lies.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    points: Vec<P2>,
    along: Vec<f64>,
}

impl Curve {
    /// The curve through two points or more.
    pub fn through(points: Vec<P2>) -> Curve {
        let mut along = vec![0.0];
        for w in points.windows(2) {
            along.push(along[along.len() - 1] + (w[1] - w[0]).norm());
        }
        Curve { points, along }
    }

    /// The curve that `at` describes for 0 to 1.
    pub fn traced(at: impl Fn(f64) -> P2) -> Curve {
        Curve::through((0..=FINE).map(|i| at(i as f64 / FINE as f64)).collect())
    }

    /// The straight line.
    pub fn line(from: P2, to: P2) -> Curve {
        Curve::through(vec![from, to])
    }

    fn bezier(from: P2, ctrl1: P2, ctrl2: P2, to: P2) -> Curve {
        let p = |q: P2| point(q.x, q.y);
        let cubic = CubicBezierSegment { from: p(from), ctrl1: p(ctrl1), ctrl2: p(ctrl2), to: p(to) };
        Curve::traced(|t| {
            let at = cubic.sample(t);
            P2::new(at.x, at.y)
        })
    }

    /// A loop between two points that leaves along the first direction, comes back against the second, and reaches `reach` beyond the middle of its ends. A cubic
    /// reaches three quarters of its handles; unequal ends get handles that bring both to the same extent.
    pub fn loop_beyond([from, to]: [P2; 2], [leave, back]: [V2; 2], reach: f64) -> Curve {
        let out = (leave + back).try_normalize(1e-9).unwrap_or(leave);
        let lead = (to - from).dot(&out);
        let least = reach / 4.0 + 1.0;
        let handle = |r: f64| 4.0 / 3.0 * r.max(least);
        Curve::bezier(from, from + leave * handle(reach + lead / 2.0), to + back * handle(reach - lead / 2.0), to)
    }

    /// The half circle over `from` and `to` on the side of `out`.
    pub fn half_circle(from: P2, to: P2, out: V2) -> Curve {
        let (middle, up) = (nalgebra::center(&from, &to), 0.5 * (to - from));
        let out = out.normalize() * up.norm();
        Curve::traced(|t| {
            let (sin, cos) = (std::f64::consts::PI * t).sin_cos();
            middle - up * cos + out * sin
        })
    }

    /// The points it is drawn through.
    pub fn points(&self) -> &[P2] {
        &self.points
    }

    /// Its length.
    pub fn length(&self) -> f64 {
        self.along[self.along.len() - 1]
    }

    /// The point at a share of the length, 0 to 1.
    pub fn at(&self, share: f64) -> P2 {
        let s = share * self.length();
        let k = self.along.partition_point(|a| *a < s).clamp(1, self.points.len() - 1);
        let (from, to) = (self.along[k - 1], self.along[k]);
        let t = if to > from { ((s - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        self.points[k - 1] + (self.points[k] - self.points[k - 1]) * t
    }

    /// Points that divide the curve into `n` parts of equal length, ends included.
    pub fn divide(&self, n: usize) -> Vec<P2> {
        let mut points: Vec<P2> = (0..=n).map(|i| self.at(i as f64 / n as f64)).collect();
        points[n] = self.points[self.points.len() - 1];
        points
    }

    /// The curve from one share of the length to another; backwards when the second is less.
    pub fn part(&self, from: f64, to: f64) -> Curve {
        let (low, high) = (from.min(to), from.max(to));
        let inside = |k: &usize| (low * self.length()..high * self.length()).contains(&self.along[*k]);
        let between = (0..self.points.len()).filter(inside).map(|k| self.points[k]);
        let mut points: Vec<P2> = std::iter::once(self.at(low)).chain(between).chain([self.at(high)]).collect();
        points.dedup();
        if from > to {
            points.reverse();
        }
        Curve::through(points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_curve_runs_between_its_shares() {
        let bend = Curve::through(vec![P2::new(0.0, 0.0), P2::new(6.0, 0.0), P2::new(6.0, 4.0)]);
        assert_eq!(bend.length(), 10.0);
        assert_eq!(bend.at(0.8), P2::new(6.0, 2.0));
        let part = bend.part(0.8, 0.3);
        assert_eq!(part.points, [P2::new(6.0, 2.0), P2::new(6.0, 0.0), P2::new(3.0, 0.0)]);
        assert_eq!(bend.divide(5)[4], P2::new(6.0, 2.0));
    }
}
