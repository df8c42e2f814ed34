//! How far a step may go before something passes through something else. All nodes move along straight lines, so a node meets the line of a segment where a
//! quadratic vanishes.

use crate::geom::{P2, V2, cross};

/// Start position and step of a node.
#[derive(Debug, Clone, Copy)]
pub struct Moving {
    /// Where it is.
    pub at: P2,
    /// Where it is going, as a difference.
    pub by: V2,
}

impl Moving {
    fn after(&self, t: f64) -> P2 {
        self.at + self.by * t
    }
}

/// Smallest share t in (0, 1] of the step at which node `p` lies on segment `a b`; nothing if it never does.
pub fn first_touch(p: Moving, a: Moving, b: Moving) -> Option<f64> {
    let (e, f) = (b.at - a.at, p.at - a.at);
    let (de, df) = (b.by - a.by, p.by - a.by);
    // cross(e + t de, f + t df) = 0
    let roots = roots(cross(de, df), cross(e, df) + cross(de, f), cross(e, f));
    roots.into_iter().flatten().find(|t| {
        let (p, a, b) = (p.after(*t), a.after(*t), b.after(*t));
        let (ab, ap) = (b - a, p - a);
        let along = ap.dot(&ab);
        let length_squared = ab.norm_squared();
        // A little beyond the ends still counts: whether a corner is passed on one side or the other must not hang on rounding.
        let slack = 1e-9 * length_squared;
        (-slack..=length_squared + slack).contains(&along)
    })
}

/// Roots of a t² + b t + c in (0, 1], ascending.
fn roots(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    let within = |t: f64| (t > 0.0 && t <= 1.0).then_some(t);
    // Too flat to bend within the step: a line.
    if a.abs() <= 1e-14 * (b.abs() + c.abs()) {
        return [if b != 0.0 { within(-c / b) } else { None }, None];
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return [None; 2];
    }
    // The form that loses no digits to cancellation.
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let (first, second) = (q / a, if q != 0.0 { c / q } else { 0.0 });
    let (low, high) = if first <= second { (first, second) } else { (second, first) };
    [within(low), within(high)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::distance_to_segment;
    use proptest::prelude::*;

    fn moving(at: (f64, f64), by: (f64, f64)) -> Moving {
        Moving { at: P2::new(at.0, at.1), by: V2::new(by.0, by.1) }
    }

    #[test]
    fn a_node_falling_onto_a_segment_touches_at_half_the_step() {
        let (a, b) = (moving((0.0, 0.0), (0.0, 0.0)), moving((2.0, 0.0), (0.0, 0.0)));
        assert_eq!(first_touch(moving((1.0, 1.0), (0.0, -2.0)), a, b), Some(0.5));
        assert_eq!(first_touch(moving((1.0, 1.0), (0.0, -0.5)), a, b), None);
        assert_eq!(first_touch(moving((3.0, 1.0), (0.0, -2.0)), a, b), None);
    }

    #[test]
    fn a_swinging_segment_hits_a_node_that_stands_still() {
        let (a, b) = (moving((0.0, 0.0), (0.0, 0.0)), moving((2.0, 0.0), (0.0, 2.0)));
        let touch = first_touch(moving((1.0, 0.5), (0.0, 0.0)), a, b).unwrap();
        assert!((touch - 0.5).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn before_the_first_touch_nothing_changes_sides(
            start in prop::array::uniform6(-2.0..2.0f64), step in prop::array::uniform6(-3.0..3.0f64),
        ) {
            let m = |i: usize| moving((start[i], start[i + 1]), (step[i], step[i + 1]));
            let (p, a, b) = (m(0), m(2), m(4));
            prop_assume!(distance_to_segment(p.at, a.at, b.at) > 1e-3);
            let touch = first_touch(p, a, b);
            // Sampled: the segment is never reached before the reported touch, and is reached there.
            let gap = |t: f64| distance_to_segment(p.after(t), a.after(t), b.after(t));
            let until = touch.unwrap_or(1.0);
            for k in 0..200 {
                prop_assert!(gap(until * 0.995 * k as f64 / 200.0) > 0.0);
            }
            if let Some(t) = touch {
                prop_assert!(gap(t) < 1e-6, "{}", gap(t));
            }
        }
    }
}
