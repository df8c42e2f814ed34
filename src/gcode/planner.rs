//! How long a program takes: GRBL 1.1's motion planner, replayed.
//!
//! Rules of GRBL's planner.c, motion_control.c and gcode.c: rates and accelerations limited per axis, corner speeds by junction deviation,
//! trapezoids, arcs cut into chords, a look-ahead of a fixed number of blocks at whose end the machine must be able to stand still, and a stop
//! for every change of laser mode or air.

use super::{Action, Move};
use crate::geom::{P3, V3};

/// A change of laser mode or air costs about this much beyond coming to rest, s (measured on unmodified GRBL 1.1h on an ATmega328p).
const STOP_S: f64 = 0.005;

/// Cosines beyond this count as straight on or straight back (planner.c).
const STRAIGHT_COSINE: f64 = 0.999_999;

/// What the controller can do; axes are x, y, z. All above 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Fastest rate of each axis, mm/min (GRBL $110-$112).
    pub max_rate_mm_per_min: [f64; 3],
    /// Acceleration of each axis, mm/s2 (GRBL $120-$122).
    pub acceleration_mm_per_s2: [f64; 3],
    /// How far a corner may be rounded to keep speed, mm (GRBL $11).
    pub junction_deviation_mm: f64,
    /// How far chords may leave an arc, mm (GRBL $12).
    pub arc_tolerance_mm: f64,
    /// Blocks the planner looks ahead: 15 on an ATmega328p.
    pub planner_blocks: usize,
}

/// How long a program takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// Time of each move, s, by index.
    pub move_s: Vec<f64>,
    /// Their sum, s.
    pub total_s: f64,
}

/// Time of every move, from rest to rest, when lines arrive as fast as the planner takes them.
pub fn estimate(moves: &[Move], limits: &Limits) -> Timing {
    let mut planner = Planner { limits, queue: Vec::new(), move_s: vec![0.0; moves.len()] };
    for (index, m) in moves.iter().enumerate() {
        match m.action {
            Action::Rapid => planner.add(index, m.from, m.to, f64::INFINITY),
            Action::Line => planner.add(index, m.from, m.to, m.feed_mm_per_min),
            Action::Arc { .. } => planner.add_arc(index, m),
            Action::Dwell { seconds } => {
                planner.run();
                planner.move_s[index] += seconds;
            }
            Action::Stop => {
                planner.run();
                planner.move_s[index] += STOP_S;
            }
        }
    }
    planner.run();
    let total_s = planner.move_s.iter().sum();
    Timing { move_s: planner.move_s, total_s }
}

/// A straight stretch; speeds in mm/s.
struct Block {
    index: usize,
    direction: V3,
    length_mm: f64,
    nominal: f64,
    acceleration: f64,
    /// Square of the fastest speed at its start that corner and rates allow.
    max_entry_squared: f64,
}

struct Planner<'a> {
    limits: &'a Limits,
    queue: Vec<Block>,
    move_s: Vec<f64>,
}

impl Planner<'_> {
    fn add(&mut self, index: usize, from: P3, to: P3, feed_mm_per_min: f64) {
        let delta = to - from;
        let length_mm = delta.norm();
        if length_mm == 0.0 {
            return;
        }
        let direction = delta / length_mm;
        let rapid = along(self.limits.max_rate_mm_per_min, direction);
        let nominal = feed_mm_per_min.min(rapid) / 60.0;
        let acceleration = along(self.limits.acceleration_mm_per_s2, direction);
        let max_entry_squared = match self.queue.last() {
            None => 0.0,
            Some(last) => {
                self.corner_squared(last.direction, direction).min(nominal * nominal).min(last.nominal * last.nominal)
            }
        };
        self.queue.push(Block { index, direction, length_mm, nominal, acceleration, max_entry_squared });
    }

    /// Chords as motion_control.c cuts them; the last one ends exactly at the target.
    fn add_arc(&mut self, index: usize, m: &Move) {
        let Action::Arc { radius_mm, sweep_rad, .. } = m.action else { return };
        let tolerance = self.limits.arc_tolerance_mm;
        let half_chord_squared = tolerance * (2.0 * radius_mm - tolerance);
        let chords = (0.5 * sweep_rad.abs() * radius_mm / half_chord_squared.max(f64::MIN_POSITIVE).sqrt()).floor();
        let chords = if half_chord_squared > 0.0 { chords.max(1.0) } else { 1.0 };
        let mut from = m.from;
        for k in 1..=chords as u64 {
            let t = k as f64 / chords;
            let to = if t >= 1.0 { m.to } else { m.point_at(t) };
            self.add(index, from, to, m.feed_mm_per_min);
            from = to;
        }
    }

    /// Square of the speed at which a corner may be taken: v^2 = a d sin(t/2) / (1 - sin(t/2)), where t is the angle between the two
    /// lines, d the junction deviation and a the acceleration across the corner (planner.c, plan_buffer_line).
    fn corner_squared(&self, before: V3, after: V3) -> f64 {
        let cosine = -before.dot(&after);
        if cosine > STRAIGHT_COSINE {
            return 0.0;
        }
        if cosine < -STRAIGHT_COSINE {
            return f64::INFINITY;
        }
        let across = (after - before).normalize();
        let acceleration = along(self.limits.acceleration_mm_per_s2, across);
        let sine = (0.5 * (1.0 - cosine)).sqrt();
        acceleration * self.limits.junction_deviation_mm * sine / (1.0 - sine)
    }

    /// Runs the queued blocks from rest to rest.
    fn run(&mut self) {
        let blocks = std::mem::take(&mut self.queue);
        let mut entry_squared = 0.0;
        for (k, block) in blocks.iter().enumerate() {
            let reach = entry_squared + 2.0 * block.acceleration * block.length_mm;
            let exit_squared = reach.min(self.entry_seen(&blocks[k + 1..]));
            self.move_s[block.index] += block.seconds(entry_squared, exit_squared);
            entry_squared = exit_squared;
        }
    }

    /// Square of the fastest speed at the start of `ahead` from which the machine can still stop within the blocks it sees.
    fn entry_seen(&self, ahead: &[Block]) -> f64 {
        let seen = &ahead[..ahead.len().min(self.limits.planner_blocks)];
        seen.iter().rev().fold(0.0, |exit_squared: f64, block| {
            block.max_entry_squared.min(exit_squared + 2.0 * block.acceleration * block.length_mm)
        })
    }
}

impl Block {
    /// Time of the trapezoid from one speed to another under the nominal speed.
    fn seconds(&self, entry_squared: f64, exit_squared: f64) -> f64 {
        let (v0, v1, a) = (entry_squared.sqrt(), exit_squared.sqrt(), self.acceleration);
        let peak_squared = 0.5 * (2.0 * a * self.length_mm + entry_squared + exit_squared);
        let peak = peak_squared.sqrt().min(self.nominal);
        let ramps = (2.0 * peak * peak - entry_squared - exit_squared) / (2.0 * a);
        (2.0 * peak - v0 - v1) / a + (self.length_mm - ramps).max(0.0) / peak
    }
}

/// The greatest value along a direction that keeps every axis within its own limit.
fn along(limits: [f64; 3], direction: V3) -> f64 {
    limits.iter().zip(direction.iter()).map(|(limit, d)| limit / d.abs()).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::super::{parse, trace};
    use super::*;

    const LIMITS: Limits = Limits {
        max_rate_mm_per_min: [6000.0, 6000.0, 600.0],
        acceleration_mm_per_s2: [500.0, 500.0, 100.0],
        junction_deviation_mm: 0.01,
        arc_tolerance_mm: 0.002,
        planner_blocks: 15,
    };

    fn seconds(text: &str) -> f64 {
        estimate(&trace(&parse(text).unwrap()).unwrap(), &LIMITS).total_s
    }

    #[test]
    fn one_line_is_a_trapezoid_or_a_triangle() {
        // 20 mm/s over 100 mm at 500 mm/s2: 5 s and one ramp of 0.04 s.
        assert!((seconds("G1X100F1200") - 5.04).abs() < 1e-9);
        // 0.2 mm: up and down within it, 2 sqrt(L / a).
        assert!((seconds("G1X0.2F6000") - 2.0 * (0.2_f64 / 500.0).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn a_diagonal_rapid_runs_faster_than_either_axis() {
        let rate = 100.0 * 2.0_f64.sqrt();
        let acceleration = 500.0 * 2.0_f64.sqrt();
        let expected = 200.0 * 2.0_f64.sqrt() / rate + rate / acceleration;
        assert!((seconds("G0X200Y200") - expected).abs() < 1e-9);
    }

    #[test]
    fn a_square_corner_is_taken_at_the_junction_speed() {
        // Both lines at 50 mm/s; through the corner with v^2 = a d s / (1 - s), s = sin 45 degrees; the corner's acceleration acts on both axes.
        let s = 0.5_f64.sqrt();
        let v = (500.0 * 2.0_f64.sqrt() * 0.01 * s / (1.0 - s)).sqrt();
        let ramp = |v: f64| (50.0 - v) / 500.0 - 0.5 * (50.0 * 50.0 - v * v) / 500.0 / 50.0;
        let expected = 2.0 * (100.0 / 50.0 + ramp(0.0) + ramp(v));
        assert!((seconds("G1X100F3000\nY100") - expected).abs() < 1e-9);
        assert!(seconds("G1X100F3000\nX0") > seconds("G1X100F3000\nY100"), "turning back needs a stop");
    }

    #[test]
    fn splitting_a_line_costs_nothing_until_the_look_ahead_is_too_short() {
        let split = |n: u32, f: u32| {
            let lines: String =
                (1..=n).map(|k| format!("G1X{:.3}F{f}\n", 60.0 * f64::from(k) / f64::from(n))).collect();
            seconds(&lines)
        };
        assert!((split(10, 6000) - split(1, 6000)).abs() < 1e-9);
        // 15 blocks of 0.3 mm: no faster than sqrt(2 * 500 * 4.5) = 67 mm/s instead of 100.
        assert!(split(200, 6000) > 60.0 / 67.5 && split(1, 6000) < 60.0 / 74.0);
    }

    #[test]
    fn an_arc_takes_as_long_as_its_length_and_a_stop_is_paid_for() {
        let circle = seconds("G0X50\nG3X50I-50F3000") - seconds("G0X50");
        let expected = std::f64::consts::TAU * 50.0 / 50.0;
        assert!((circle / expected - 1.0).abs() < 0.02, "{circle} {expected}");
        let halves = "M4S0\nG1X50F1200S10\nM5\nM4\nG1X100";
        assert!((seconds(halves) - (5.08 + 3.0 * STOP_S)).abs() < 1e-9);
        assert!((seconds("G1X100F1200\nG4P0.5") - 5.54).abs() < 1e-9);
    }

    #[test]
    fn times_belong_to_the_moves_that_take_them() {
        let moves = trace(&parse("G0X10\nG1X30F600\nG4P1").unwrap()).unwrap();
        let timing = estimate(&moves, &LIMITS);
        assert_eq!(timing.move_s.len(), 3);
        assert!(timing.move_s[1] > 2.0 && timing.move_s[1] < 2.1);
        assert_eq!(timing.move_s[2], 1.0);
        assert_eq!(estimate(&[], &LIMITS).total_s, 0.0);
    }

    /// Times of unmodified GRBL 1.1h firmware on a board model with real UART timing, 80 steps/mm, $110 = $111 = 10000, $120 = $121 = 500,
    /// lines sent by character counting: from the first to the last step.
    #[test]
    fn measured_jobs_take_as_long_as_they_did() {
        let rectangles: String = (0..8)
            .map(|k| (10 + 45 * k, 50 + 45 * k))
            .map(|(l, r)| format!("G0X{l}Y10\nG1X{r}Y10F1800S300\nG1X{r}Y200\nG1X{l}Y200\nG1X{l}Y10\n"))
            .collect();
        let small = (0..6).map(|k| (40 + 60 * k, 60, 5 + 4 * k));
        let large = (0..6).map(|k| (40 + 60 * k, 180, 28));
        let circles: String = small
            .chain(large)
            .map(|(x, y, r)| (x - r, x + r, y, r))
            .map(|(l, r, y, i)| format!("G0X{l}Y{y}\nG2X{r}Y{y}I{i}J0F3000S400\nG2X{l}Y{y}I-{i}J0\n"))
            .collect();
        let limits = Limits { max_rate_mm_per_min: [10_000.0, 10_000.0, 3000.0], ..LIMITS };
        for (job, measured_s) in [(rectangles, 130.288), (circles, 45.109)] {
            let moves = trace(&parse(&format!("M4S0\n{job}M5S0\nG0X0Y0")).unwrap()).unwrap();
            let estimated_s = estimate(&moves, &limits).total_s;
            assert!((estimated_s / measured_s - 1.0).abs() < 0.002, "{estimated_s} {measured_s}");
        }
    }
}
