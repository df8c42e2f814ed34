//! What the machine did: where the head was and how bright the beam.

use crate::geom::P3;

/// A stretch of time in which the head moves evenly faster or slower along a line, or stands with the beam lit. Where no segment covers an instant
/// the head stood and the beam was dark.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// When it starts, s.
    pub start_s: f64,
    /// When it ends, s.
    pub end_s: f64,
    /// Where the head really is at its start, mm from the home corner.
    pub from_mm: P3,
    /// Where at its end, mm.
    pub to_mm: P3,
    /// Speed at its start, mm/s; it changes evenly in time.
    pub start_mm_per_s: f64,
    /// Speed at its end, mm/s.
    pub end_mm_per_s: f64,
    /// Share of full power at its start; it changes evenly in time.
    pub start_power: f64,
    /// Share of full power at its end.
    pub end_power: f64,
}

impl Segment {
    /// True when the beam burns anywhere in it.
    pub fn is_lit(&self) -> bool {
        self.start_power > 0.0 || self.end_power > 0.0
    }

    /// Length of its way, mm.
    pub fn length_mm(&self) -> f64 {
        (self.to_mm - self.from_mm).norm()
    }

    /// Share of full power at a time, 0 outside.
    pub fn power_at(&self, time_s: f64) -> f64 {
        if time_s < self.start_s || time_s >= self.end_s {
            return 0.0;
        }
        let t = (time_s - self.start_s) / (self.end_s - self.start_s);
        self.start_power + (self.end_power - self.start_power) * t
    }
}

/// Gathers segments; pieces of one even stretch become one.
#[derive(Debug, Default)]
pub(super) struct Recorder {
    pub(super) segments: Vec<Segment>,
    stretch: Option<u64>,
}

impl Recorder {
    /// Takes a piece of the stretch with this number; stretches are told apart by it.
    pub(super) fn add(&mut self, stretch: u64, piece: Segment) {
        if piece.end_s <= piece.start_s {
            return;
        }
        let same = self.stretch.replace(stretch) == Some(stretch);
        match self.segments.last_mut() {
            Some(last) if same && last.end_s == piece.start_s && last.end_power == piece.start_power => {
                last.end_s = piece.end_s;
                last.to_mm = piece.to_mm;
                last.end_mm_per_s = piece.end_mm_per_s;
                last.end_power = piece.end_power;
            }
            _ => self.segments.push(piece),
        }
    }

    /// Hands the segments out and starts anew.
    pub(super) fn take(&mut self) -> Vec<Segment> {
        self.stretch = None;
        std::mem::take(&mut self.segments)
    }
}
