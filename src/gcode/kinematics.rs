//! What a controller's limits make of one straight way: GRBL's planner.c, shared by whoever plans or runs blocks.

use super::arc_words::chord_count;
use super::{Action, Limits, Move};
use crate::geom::{P3, V3};

/// Cosines beyond this count as straight on or straight back (planner.c).
const STRAIGHT_COSINE: f64 = 0.999_999;

/// GRBL runs no feed slower than this (MINIMUM_FEED_RATE), mm/min.
const MIN_FEED_MM_PER_MIN: f64 = 1.0;

impl Limits {
    /// Fastest speed along a unit direction, each axis within its own rate, mm/s.
    pub fn rapid_mm_per_s(&self, direction: V3) -> f64 {
        along(self.max_rate_mm_per_min, direction) / 60.0
    }

    /// Acceleration along a unit direction, each axis within its own, mm/s2.
    pub fn acceleration_mm_per_s2(&self, direction: V3) -> f64 {
        along(self.acceleration_mm_per_s2, direction)
    }

    /// Speed a feed asks for along a unit direction: no slower than GRBL's slowest, no faster than the axes go, mm/s.
    pub fn feed_mm_per_s(&self, feed_mm_per_min: f64, direction: V3) -> f64 {
        (feed_mm_per_min.max(MIN_FEED_MM_PER_MIN) / 60.0).min(self.rapid_mm_per_s(direction))
    }

    /// Square of the speed at which a corner may be taken, (mm/s)^2: v^2 = a d sin(t/2) / (1 - sin(t/2)), where t is the angle between the
    /// two lines, d the junction deviation and a the acceleration across the corner (planner.c, plan_buffer_line). Infinite straight on.
    pub fn corner_squared(&self, before: V3, after: V3) -> f64 {
        let cosine = -before.dot(&after);
        if cosine > STRAIGHT_COSINE {
            return 0.0;
        }
        if cosine < -STRAIGHT_COSINE {
            return f64::INFINITY;
        }
        let across = (after - before).normalize();
        let acceleration = along(self.acceleration_mm_per_s2, across);
        let sine = (0.5 * (1.0 - cosine)).sqrt();
        acceleration * self.junction_deviation_mm * sine / (1.0 - sine)
    }

    /// Ends of the straight ways a move is run as, mm: one, or an arc's chords; none for rests.
    pub fn ends(&self, m: &Move) -> impl Iterator<Item = P3> + use<> {
        let count = match m.action {
            Action::Rapid | Action::Line => 1.0,
            Action::Arc { radius_mm, sweep_rad, .. } => chord_count(radius_mm, sweep_rad, self.arc_tolerance_mm),
            Action::Stop | Action::Dwell { .. } => 0.0,
        };
        let m = *m;
        (1..=count as u64).map(move |k| {
            let t = k as f64 / count;
            if t >= 1.0 { m.to } else { m.point_at(t) }
        })
    }
}

/// The greatest value along a direction that keeps every axis within its own limit.
fn along(limits: [f64; 3], direction: V3) -> f64 {
    limits.iter().zip(direction.iter()).map(|(limit, d)| limit / d.abs()).fold(f64::INFINITY, f64::min)
}
