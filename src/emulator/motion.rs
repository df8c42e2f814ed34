//! Blocks executed in time: GRBL's planner and stepper as one, in exact ramps instead of steps.
//!
//! Whatever changes the plan (a block more, an override, a hold) plans anew from the speed and place of that instant: braking and speeding up with the
//! block's acceleration, corners no faster than the planner's rules allow, and the last block ending at rest.

use std::collections::VecDeque;

use super::trace::{Recorder, Segment};
use crate::gcode::{Beam, Limits};
use crate::geom::{P3, V3};

/// Ways and speeds below this are rounding: 1e-9 mm, a hundred-thousandth of a motor step's hundredth.
const TINY: f64 = 1e-9;

/// Times below this are rounding, s: a day in seconds has an f64 resolution of 1.5e-11.
const TICK_S: f64 = 1e-10;

/// How long a constant beam (M3) burns on before M5 darkens it, s, from when the head has come to rest: 60 cuts on GRBL 1.1h were lit 14.9 ms longer
/// each than they moved.
const DARKENING_S: f64 = 0.0149;

/// How a block runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Way {
    pub(super) to: P3,
    /// Programmed feed, mm/min; none for a rapid.
    pub(super) feed_mm_per_min: Option<f64>,
    /// False for jogs and homing: overrides leave them alone.
    pub(super) overridable: bool,
    pub(super) beam: Beam,
    pub(super) power_s: f64,
}

#[derive(Debug, Clone, Copy)]
struct Block {
    way: Way,
    from: P3,
    direction: V3,
    length_mm: f64,
    acceleration: f64,
    rapid: f64,
    corner_squared: f64,
}

/// An even change of speed.
#[derive(Debug, Clone, Copy)]
struct Ramp {
    seconds: f64,
    acceleration: f64,
    number: u64,
}

/// What ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ended {
    /// The last block: the machine rests.
    All,
    /// The way to a stop in a hold.
    Hold,
}

/// Shares of the programmed values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Overrides {
    pub(super) feed_percent: u16,
    pub(super) rapid_percent: u16,
    pub(super) spindle_percent: u16,
}

impl Overrides {
    pub(super) const NONE: Overrides = Overrides { feed_percent: 100, rapid_percent: 100, spindle_percent: 100 };
}

/// How S words become light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lamp {
    /// $30.
    pub(super) max_s: f64,
    /// $31.
    pub(super) min_s: f64,
    /// $32.
    pub(super) laser: bool,
}

/// The machine and its blocks.
#[derive(Debug)]
pub(super) struct Motion {
    pub(super) limits: Limits,
    pub(super) overrides: Overrides,
    pub(super) lamp: Lamp,
    queue: VecDeque<Block>,
    ramps: VecDeque<Ramp>,
    clock_s: f64,
    done_mm: f64,
    speed: f64,
    running: bool,
    braking: bool,
    /// Where the board believes the head is, mm.
    pub(super) position: P3,
    /// What must be added to that to get where it is, mm.
    pub(super) drift: V3,
    /// S of a beam that shines at rest.
    pub(super) rest_s: f64,
    /// Since when it rests, s.
    rested_since_s: f64,
    /// A hold keeps the beam dark.
    pub(super) dark: bool,
    /// Where the block queued last ends and which way it goes, unless the machine rests there.
    last: Option<(V3, P3)>,
    stretches: u64,
    pub(super) record: Recorder,
}

impl Motion {
    pub(super) fn new(limits: Limits, lamp: Lamp, head_mm: P3) -> Motion {
        Motion {
            limits,
            overrides: Overrides::NONE,
            lamp,
            queue: VecDeque::new(),
            ramps: VecDeque::new(),
            clock_s: 0.0,
            done_mm: 0.0,
            speed: 0.0,
            running: false,
            braking: false,
            position: P3::origin(),
            drift: head_mm.coords,
            rest_s: 0.0,
            rested_since_s: 0.0,
            dark: false,
            last: None,
            stretches: 0,
            record: Recorder::default(),
        }
    }

    pub(super) fn is_full(&self) -> bool {
        self.queue.len() >= self.limits.planner_blocks
    }

    pub(super) fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }

    pub(super) fn is_running(&self) -> bool {
        self.running
    }

    pub(super) fn free_blocks(&self) -> usize {
        self.limits.planner_blocks - self.queue.len()
    }

    /// Queues a way from where the last one ends; a way of no length is none.
    pub(super) fn push(&mut self, way: Way) {
        let from = self.last.map_or_else(|| self.queue.back().map_or(self.position, |b| b.way.to), |(_, end)| end);
        let delta = way.to - from;
        let length_mm = delta.norm();
        if length_mm < TINY {
            if way.feed_mm_per_min.is_some() && way.beam == Beam::Constant {
                self.rest_s = way.power_s;
            }
            return;
        }
        let direction = delta / length_mm;
        let corner_squared = self.last.map_or(0.0, |(before, _)| self.limits.corner_squared(before, direction));
        let acceleration = self.limits.acceleration_mm_per_s2(direction);
        let rapid = self.limits.rapid_mm_per_s(direction);
        self.queue.push_back(Block { way, from, direction, length_mm, acceleration, rapid, corner_squared });
        self.last = Some((direction, way.to));
        self.plan();
    }

    /// Starts, or goes on after a hold.
    pub(super) fn start(&mut self) {
        self.braking = false;
        self.dark = false;
        self.running = !self.queue.is_empty();
        self.plan();
    }

    /// Brakes to a stop, wherever that is.
    pub(super) fn brake(&mut self) {
        self.braking = true;
        self.plan();
    }

    /// Stops at once and forgets all blocks.
    pub(super) fn flush(&mut self) {
        self.queue.clear();
        self.ramps.clear();
        (self.running, self.braking, self.last) = (false, false, None);
        (self.done_mm, self.speed) = (0.0, 0.0);
    }

    /// When a beam that burns on at rest can be dark, s: see [`DARKENING_S`].
    pub(super) fn darkest_s(&self) -> f64 {
        if self.rest_s > 0.0 { self.rested_since_s + DARKENING_S } else { self.clock_s }
    }

    /// Takes over changed overrides.
    pub(super) fn set_overrides(&mut self, overrides: Overrides) {
        self.overrides = overrides;
        self.plan();
    }

    /// Speed, mm/s.
    pub(super) fn speed_mm_per_s(&self) -> f64 {
        self.speed
    }

    /// When the machine next changes its acceleration or ends a block.
    pub(super) fn next_s(&self) -> Option<f64> {
        self.ramps.front().map(|ramp| self.clock_s + ramp.seconds)
    }

    /// S in effect, after override and limits (spindle_control.c, spindle_compute_pwm_value).
    pub(super) fn shown_s(&self) -> f64 {
        let raw = match self.queue.front() {
            _ if self.dark => 0.0,
            Some(block) if self.running => self.lit_s(block, self.speed),
            _ => self.rest_s,
        };
        let s = raw * f64::from(self.overrides.spindle_percent) / 100.0;
        if s > 0.0 { s.max(self.lamp.min_s).min(self.lamp.max_s) } else { 0.0 }
    }

    /// Share of full power now.
    pub(super) fn power(&self) -> f64 {
        if self.lamp.max_s > 0.0 { self.shown_s() / self.lamp.max_s } else { 0.0 }
    }

    /// S of a block at a speed, without override: M4 follows the speed as programmed.
    fn lit_s(&self, block: &Block, speed: f64) -> f64 {
        let way = &block.way;
        let feed = match way.feed_mm_per_min {
            _ if !self.lamp.laser && way.beam != Beam::Off => return way.power_s,
            Some(feed) => self.limits.feed_mm_per_s(feed, block.direction),
            None => return 0.0,
        };
        match way.beam {
            Beam::Off => 0.0,
            Beam::Constant => way.power_s,
            Beam::Dynamic => way.power_s * speed / feed,
        }
    }

    /// Runs to a time no later than [`Motion::next_s`]; tells what ends then.
    pub(super) fn advance(&mut self, to_s: f64) -> Option<Ended> {
        let start = (self.clock_s, self.position, self.speed, self.power());
        let seconds = to_s - self.clock_s;
        self.clock_s = to_s;
        let Some(ramp) = self.ramps.front().copied() else {
            if start.3 > 0.0 && seconds > 0.0 {
                self.note(0, start);
            }
            return None;
        };
        let block = *self.queue.front()?;
        let over = seconds >= ramp.seconds - TICK_S;
        let dt = if over { ramp.seconds } else { seconds };
        self.done_mm += (self.speed + 0.5 * ramp.acceleration * dt) * dt;
        self.speed = (self.speed + ramp.acceleration * dt).max(0.0);
        self.position = block.from + block.direction * self.done_mm.min(block.length_mm);
        if !over {
            if let Some(first) = self.ramps.front_mut() {
                first.seconds -= dt;
            }
            self.note(ramp.number, start);
            return None;
        }
        self.ramps.pop_front();
        let last_of_block = self.ramps.is_empty();
        if last_of_block && (!self.braking || self.done_mm >= block.length_mm - TINY) {
            self.position = block.way.to;
        }
        self.note(ramp.number, start);
        if last_of_block { self.end_block(&block) } else { None }
    }

    fn end_block(&mut self, block: &Block) -> Option<Ended> {
        if self.done_mm < block.length_mm - TINY && self.braking {
            self.speed = 0.0;
            self.running = false;
            return Some(Ended::Hold);
        }
        self.rest_s = match (block.way.feed_mm_per_min, block.way.beam) {
            (Some(_), Beam::Constant) => block.way.power_s,
            (_, Beam::Constant | Beam::Dynamic) if !self.lamp.laser => block.way.power_s,
            _ => 0.0,
        };
        self.queue.pop_front();
        self.done_mm = 0.0;
        if self.queue.is_empty() {
            self.speed = 0.0;
            self.rested_since_s = self.clock_s;
            (self.running, self.last) = (false, None);
            return Some(if std::mem::take(&mut self.braking) { Ended::Hold } else { Ended::All });
        }
        if self.braking && self.speed < 1e-6 {
            self.speed = 0.0;
            self.running = false;
            return Some(Ended::Hold);
        }
        self.plan();
        None
    }

    fn note(&mut self, number: u64, (start_s, from, speed, power): (f64, P3, f64, f64)) {
        let piece = Segment {
            start_s,
            end_s: self.clock_s,
            from_mm: from + self.drift,
            to_mm: self.position + self.drift,
            start_mm_per_s: speed,
            end_mm_per_s: self.speed,
            start_power: power,
            end_power: self.power(),
        };
        self.record.add(number, piece);
    }

    /// Speed a block may reach, mm/s.
    fn nominal(&self, block: &Block) -> f64 {
        let share = |percent: u16| if block.way.overridable { f64::from(percent) / 100.0 } else { 1.0 };
        match block.way.feed_mm_per_min {
            Some(feed) => self.limits.feed_mm_per_s(feed * share(self.overrides.feed_percent), block.direction),
            None => block.rapid * share(self.overrides.rapid_percent),
        }
    }

    /// Square of the speed at which the block after the first may be entered (planner.c, planner_recalculate, backward pass).
    fn exit_squared(&self) -> f64 {
        let mut exit_squared = 0.0;
        for k in (1..self.queue.len()).rev() {
            let (block, before) = (&self.queue[k], &self.queue[k - 1]);
            let nominal = self.nominal(block).min(self.nominal(before));
            let entry_squared = block.corner_squared.min(nominal * nominal);
            exit_squared = entry_squared.min(exit_squared + 2.0 * block.acceleration * block.length_mm);
        }
        exit_squared
    }

    /// The ramps of the first block from here to its end, or to a stop.
    fn plan(&mut self) {
        self.ramps.clear();
        let Some(block) = self.queue.front().copied().filter(|_| self.running) else { return };
        let left_mm = (block.length_mm - self.done_mm).max(0.0);
        let (a, mut v0) = (block.acceleration, self.speed);
        if self.braking {
            let stop_mm = v0 * v0 / (2.0 * a);
            let end = if stop_mm <= left_mm { 0.0 } else { (v0 * v0 - 2.0 * a * left_mm).sqrt() };
            return self.ramp((v0 - end) / a, -a);
        }
        let nominal = self.nominal(&block);
        let mut left_mm = left_mm;
        if v0 > nominal + TINY {
            // An override has made the block slower than it runs.
            let slowed = (v0 * v0 - 2.0 * a * left_mm).max(nominal * nominal).sqrt();
            self.ramp((v0 - slowed) / a, -a);
            left_mm = (left_mm - (v0 * v0 - slowed * slowed) / (2.0 * a)).max(0.0);
            v0 = slowed;
        }
        let reach = |sign: f64| (v0 * v0 + sign * 2.0 * a * left_mm).max(0.0).sqrt();
        let v1 = self.exit_squared().sqrt().min(nominal).min(reach(1.0)).max(reach(-1.0));
        let peak = (a * left_mm + 0.5 * (v0 * v0 + v1 * v1)).sqrt().min(nominal).max(v0).max(v1);
        let cruise_mm = left_mm - (2.0 * peak * peak - v0 * v0 - v1 * v1) / (2.0 * a);
        self.ramp((peak - v0) / a, a);
        if peak > 0.0 {
            self.ramp(cruise_mm.max(0.0) / peak, 0.0);
        }
        self.ramp((peak - v1) / a, -a);
        if self.ramps.is_empty() {
            // Nothing left but to end the block.
            self.ramps.push_back(Ramp { seconds: 0.0, acceleration: 0.0, number: self.stretches });
        }
    }

    fn ramp(&mut self, seconds: f64, acceleration: f64) {
        if seconds > TICK_S || self.braking {
            self.stretches += 1;
            self.ramps.push_back(Ramp { seconds: seconds.max(0.0), acceleration, number: self.stretches });
        }
    }
}
