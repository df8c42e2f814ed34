//! How long a program takes: GRBL 1.1's motion planner, replayed.
//!
//! Rules of GRBL's planner.c, motion_control.c and gcode.c: rates and accelerations limited per axis, corner speeds by junction deviation,
//! trapezoids, arcs cut into chords, a look-ahead of a fixed number of blocks at whose end the machine must be able to stand still, and a stop
//! for every change of laser mode or air. A block is planned only once its line has arrived and been read ([`Feeder`]).

use std::collections::VecDeque;

use super::feeder::{Arrival, Feeder};
use super::{Action, Move};
use crate::geom::{P3, V3};

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
    /// Blocks the planner holds, the one being run among them: 15 on an ATmega328p.
    pub planner_blocks: usize,
    /// Bytes the link carries: a tenth of the baud rate.
    pub bytes_per_s: f64,
    /// Bytes of the controller's receive buffer, kept full by counting characters.
    pub rx_bytes: usize,
    /// Time the controller needs to read and plan a line with a motion, s.
    pub line_s: f64,
}

/// What keeps a cut slower than its feed, its corners and the axes would allow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Held {
    /// Lines do not arrive fast enough.
    Link,
    /// The controller cannot read lines fast enough.
    Controller,
    /// The moves are too short: the planner must be able to stop within those it sees.
    LookAhead,
}

/// What the machine does in one go: a straight block (a line or one chord of an arc), or a rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Which move it belongs to, counted from 0 in the order pushed.
    pub index: usize,
    /// How long it takes, s, with the wait before it.
    pub seconds: f64,
    /// Its length, mm.
    pub length_mm: f64,
    /// Speed at its start, mm/s.
    pub entry_mm_per_s: f64,
    /// Greatest speed along it, mm/s.
    pub cruise_mm_per_s: f64,
    /// Speed at its end, mm/s.
    pub exit_mm_per_s: f64,
    /// Acceleration between these, mm/s2.
    pub acceleration_mm_per_s2: f64,
    /// What keeps its end slow, if that is neither feed nor corner.
    pub held: Option<Held>,
}

impl Stretch {
    /// How much of its length is run slower than a speed, mm: from its start, and up to its end. All of it counts from the start.
    pub fn slow_ends_mm(&self, speed_mm_per_s: f64) -> (f64, f64) {
        if self.cruise_mm_per_s < speed_mm_per_s {
            return (self.length_mm, 0.0);
        }
        let ramp =
            |end: f64| (speed_mm_per_s * speed_mm_per_s - end * end).max(0.0) / (2.0 * self.acceleration_mm_per_s2);
        let before_mm = ramp(self.entry_mm_per_s).min(self.length_mm);
        (before_mm, ramp(self.exit_mm_per_s).min(self.length_mm - before_mm))
    }
}

/// A straight block waiting to be run; speeds in mm/s.
#[derive(Debug, Clone, Copy)]
struct Block {
    index: usize,
    length_mm: f64,
    nominal: f64,
    acceleration: f64,
    /// Square of the fastest speed at its start that corner and rates allow.
    max_entry_squared: f64,
    arrival: Arrival,
}

/// Plans moves one by one in bounded memory: holds as many blocks as the controller does.
#[derive(Debug)]
pub struct Planner {
    limits: Limits,
    feeder: Feeder,
    queue: VecDeque<Block>,
    /// When the last blocks were done with, one for each place in the controller's buffer.
    done_s: VecDeque<f64>,
    /// Direction and nominal speed of the block queued last, unless the machine rests after it.
    last: Option<(V3, f64)>,
    clock_s: f64,
    entry_squared: f64,
    resting: bool,
    /// A rest that lasts until the next block starts: its move and when it began.
    rest: Option<(usize, f64)>,
    moved: bool,
    line: usize,
    pushed: usize,
}

impl Planner {
    /// A machine at rest with empty buffers.
    pub fn new(limits: &Limits) -> Planner {
        Planner {
            limits: *limits,
            feeder: Feeder::new(limits),
            queue: VecDeque::new(),
            done_s: VecDeque::new(),
            last: None,
            clock_s: 0.0,
            entry_squared: 0.0,
            resting: true,
            rest: None,
            moved: false,
            line: 0,
            pushed: 0,
        }
    }

    /// Takes the next move; what is settled by it goes to `sink`, in order.
    pub fn push(&mut self, m: &Move, sink: &mut impl FnMut(Stretch)) {
        let index = self.pushed;
        self.pushed += 1;
        let stands = matches!(m.action, Action::Stop | Action::Dwell { .. });
        if m.line != self.line {
            self.line = m.line;
            self.feeder.receive(m.bytes, !stands);
        }
        match m.action {
            Action::Rapid | Action::Line | Action::Arc { .. } => {
                let feed_mm_per_min = if m.feeds() { m.feed_mm_per_min } else { f64::INFINITY };
                let mut from = m.from;
                for to in self.limits.ends(m) {
                    self.add(index, from, to, feed_mm_per_min, sink);
                    from = to;
                }
            }
            Action::Stop => self.stand(index, 0.0, sink),
            Action::Dwell { seconds } => self.stand(index, seconds, sink),
        }
    }

    /// Runs what is queued to its end, at rest.
    pub fn finish(&mut self, sink: &mut impl FnMut(Stretch)) {
        let start_s = self.queue.back().map_or(self.clock_s, |block| block.arrival.read_s);
        self.run_all(start_s, sink);
        self.end_rest(self.clock_s, sink);
    }

    fn stand(&mut self, index: usize, dwell_s: f64, sink: &mut impl FnMut(Stretch)) {
        let read_s = self.feeder.last().read_s;
        self.run_all(read_s, sink);
        // A rest before the first motion is no part of the job's time.
        self.end_rest(self.clock_s, sink);
        self.rest = Some((index, self.clock_s));
        self.clock_s = self.clock_s.max(read_s) + dwell_s;
        self.feeder.wait_until(self.clock_s);
    }

    /// Hands on a rest that lasted until `until_s`.
    fn end_rest(&mut self, until_s: f64, sink: &mut impl FnMut(Stretch)) {
        if let Some((index, since_s)) = self.rest.take() {
            let seconds = if self.moved { until_s - since_s } else { 0.0 };
            sink(Stretch {
                index,
                seconds,
                length_mm: 0.0,
                entry_mm_per_s: 0.0,
                cruise_mm_per_s: 0.0,
                exit_mm_per_s: 0.0,
                acceleration_mm_per_s2: 0.0,
                held: None,
            });
        }
    }

    fn add(&mut self, index: usize, from: P3, to: P3, feed_mm_per_min: f64, sink: &mut impl FnMut(Stretch)) {
        let delta = to - from;
        let length_mm = delta.norm();
        if length_mm == 0.0 {
            return;
        }
        if self.queue.len() >= self.limits.planner_blocks {
            self.run_first(None, sink);
        }
        let direction = delta / length_mm;
        let nominal = self.limits.feed_mm_per_s(feed_mm_per_min, direction);
        let acceleration = self.limits.acceleration_mm_per_s2(direction);
        let max_entry_squared = match self.last {
            None => 0.0,
            Some((before, speed)) => {
                self.limits.corner_squared(before, direction).min(nominal * nominal).min(speed * speed)
            }
        };
        self.last = Some((direction, nominal));
        let places = self.limits.planner_blocks;
        while self.done_s.len() > places {
            self.done_s.pop_front();
        }
        // A place in the buffer is free once the block that held it is done with.
        if self.queue.len() + self.done_s.len() >= places
            && let Some(free_s) = self.done_s.get(self.queue.len() + self.done_s.len() - places)
        {
            self.feeder.wait_until(*free_s);
        }
        let arrival = self.feeder.last();
        self.queue.push_back(Block { index, length_mm, nominal, acceleration, max_entry_squared, arrival });
    }

    /// Runs all that is queued; the line after it, read at `read_s`, makes the machine rest.
    fn run_all(&mut self, read_s: f64, sink: &mut impl FnMut(Stretch)) {
        while !self.queue.is_empty() {
            self.run_first(Some(read_s), sink);
        }
        self.last = None;
        self.resting = true;
    }

    /// Runs the first block. `rest_s` tells when the line was read that stops the machine after the last block queued.
    fn run_first(&mut self, rest_s: Option<f64>, sink: &mut impl FnMut(Stretch)) {
        let Some(block) = self.queue.pop_front() else { return };
        let mut waited_s = 0.0;
        if self.resting || block.arrival.read_s > self.clock_s {
            self.entry_squared = 0.0;
            self.resting = false;
            let start_s = self.clock_s.max(self.cycle_start_s(&block, rest_s));
            if self.rest.is_some() {
                self.end_rest(start_s, sink);
            } else if self.moved {
                waited_s = start_s - self.clock_s;
            }
            self.clock_s = start_s;
        }
        let reach_squared = self.entry_squared + 2.0 * block.acceleration * block.length_mm;
        // What is read while the block runs still counts for its end.
        let soonest_s =
            self.clock_s + block.run(self.entry_squared, reach_squared.min(block.nominal * block.nominal)).1;
        // The block that runs holds a place of the buffer itself.
        let ahead = self.limits.planner_blocks.saturating_sub(1);
        let seen = self.queue.iter().take(ahead).take_while(|b| b.arrival.read_s <= soonest_s).count();
        let (seen_squared, by_horizon) = self.entry_seen(seen);
        // Not below what braking along the whole block leaves: rounding only.
        let least_squared = self.entry_squared - 2.0 * block.acceleration * block.length_mm;
        let exit_squared = reach_squared.min(seen_squared).max(least_squared);
        let ends_here = rest_s.is_some() && seen == self.queue.len();
        let held =
            (by_horizon && !ends_here && seen_squared < reach_squared.min(block.nominal * block.nominal)).then(|| {
                if seen >= ahead {
                    Held::LookAhead
                } else {
                    self.queue.get(seen).map_or(Held::LookAhead, |next| next.arrival.held)
                }
            });
        let (cruise, seconds) = block.run(self.entry_squared, exit_squared);
        self.clock_s += seconds;
        sink(Stretch {
            index: block.index,
            seconds: seconds + waited_s,
            length_mm: block.length_mm,
            entry_mm_per_s: self.entry_squared.sqrt(),
            cruise_mm_per_s: cruise,
            exit_mm_per_s: exit_squared.sqrt(),
            acceleration_mm_per_s2: block.acceleration,
            held,
        });
        self.moved = true;
        self.entry_squared = exit_squared;
        self.done_s.push_back(self.clock_s);
    }

    /// When a resting machine starts: its buffer is full, nothing more has arrived, or a line wants it to rest (protocol.c).
    fn cycle_start_s(&self, first: &Block, rest_s: Option<f64>) -> f64 {
        let mut read_s = first.arrival.read_s;
        for next in self.queue.iter().take(self.limits.planner_blocks.saturating_sub(1)) {
            if next.arrival.arrived_s > read_s {
                return read_s;
            }
            read_s = next.arrival.read_s;
        }
        if self.queue.len() + 1 < self.limits.planner_blocks { rest_s.unwrap_or(read_s).max(read_s) } else { read_s }
    }

    /// Square of the fastest speed at the start of the queue from which the machine can still stop within the first `seen` blocks, and
    /// whether it is the need to stop that decides.
    fn entry_seen(&self, seen: usize) -> (f64, bool) {
        self.queue.range(..seen).rev().fold((0.0, true), |(exit_squared, by_horizon), block| {
            let reach = exit_squared + 2.0 * block.acceleration * block.length_mm;
            if block.max_entry_squared < reach { (block.max_entry_squared, false) } else { (reach, by_horizon) }
        })
    }
}

impl Block {
    /// Greatest speed and time of the trapezoid from one speed to another under the nominal speed.
    fn run(&self, entry_squared: f64, exit_squared: f64) -> (f64, f64) {
        let (v0, v1, a) = (entry_squared.sqrt(), exit_squared.sqrt(), self.acceleration);
        let peak_squared = 0.5 * (2.0 * a * self.length_mm + entry_squared + exit_squared);
        let peak = peak_squared.sqrt().min(self.nominal).max(v0).max(v1);
        let ramps = (2.0 * peak * peak - entry_squared - exit_squared) / (2.0 * a);
        (peak, (2.0 * peak - v0 - v1) / a + (self.length_mm - ramps).max(0.0) / peak)
    }
}

#[cfg(test)]
impl Limits {
    /// A common desktop machine on a board as it is sold, for tests.
    pub(crate) const USUAL: Limits = Limits {
        max_rate_mm_per_min: [6000.0, 6000.0, 600.0],
        acceleration_mm_per_s2: [500.0, 500.0, 100.0],
        junction_deviation_mm: 0.01,
        arc_tolerance_mm: 0.002,
        planner_blocks: 15,
        bytes_per_s: 11_520.0,
        rx_bytes: 128,
        line_s: 0.0037,
    };
}

#[cfg(test)]
mod tests {
    use super::super::{estimate, parse, trace};
    use super::*;

    fn seconds(text: &str) -> f64 {
        estimate(&trace(&parse(text).unwrap()).unwrap(), &Limits::USUAL).total_s
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
        // Before M5: one stop. After it M4 stops again at once, and 1.5 line times go by until G1 runs; the rest before the first motion is no part of it.
        let read_s = (0.5 + 1.0) * Limits::USUAL.line_s;
        assert!((seconds(halves) - (5.08 + read_s)).abs() < 2e-4, "{}", seconds(halves) - 5.08);
        assert!((seconds("G1X100F1200\nG4P0.5") - 5.54).abs() < 1e-9);
    }

    #[test]
    fn times_belong_to_the_moves_that_take_them() {
        let moves = trace(&parse("G0X10\nG1X30F600\nG4P1").unwrap()).unwrap();
        let timing = estimate(&moves, &Limits::USUAL);
        assert_eq!(timing.move_s.len(), 3);
        assert!(timing.move_s[1] > 2.0 && timing.move_s[1] < 2.1);
        assert_eq!(timing.move_s[2], 1.0);
        assert_eq!(estimate(&[], &Limits::USUAL).total_s, 0.0);
    }
}
