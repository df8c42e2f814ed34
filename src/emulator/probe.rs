//! G38.2 to G38.5: towards a contact or away from one (motion_control.c, mc_probe_cycle).

use std::collections::VecDeque;

use super::board::{Board, State};
use super::motion::Way;
use super::steps::Step;
use crate::gcode::{Beam, Line, Move};
use crate::geom::P3;

/// The contact, and what the last probing found.
#[derive(Debug)]
pub(super) struct Probe {
    pub(super) closed: bool,
    /// What the contact must become while a probing move is under way.
    sought: Option<bool>,
    /// Where it became so, mm.
    touched_mm: Option<P3>,
    /// What `[PRB:]` tells: where, mm, and whether there was contact.
    pub(super) last_mm: P3,
    pub(super) found: bool,
    /// The G38 in effect.
    code: f64,
}

/// What a G38 line asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seek {
    way: Way,
    /// The contact it looks for: true towards one, false away from it.
    contact: bool,
}

impl Probe {
    pub(super) fn new() -> Probe {
        Probe { closed: false, sought: None, touched_mm: None, last_mm: P3::origin(), found: false, code: 38.2 }
    }

    /// A reset forgets what was found; the contact is what it is.
    pub(super) fn forget(&mut self) {
        *self = Probe { closed: self.closed, ..Probe::new() };
    }
}

impl Board {
    /// Closes or opens the probe's contact now.
    pub fn set_probe(&mut self, closed: bool) {
        self.probe.closed = closed;
        if self.probe.sought == Some(closed) {
            self.probe.sought = None;
            self.probe.touched_mm = Some(self.motion.position);
            self.cancelled = true;
            self.motion.brake();
        }
    }

    /// A probing move of `line` as steps.
    pub(super) fn seek(&mut self, line: &Line, m: &Move, steps: &mut VecDeque<Step>) {
        let said = line.words.iter().find(|w| w.letter == 'G' && w.value.trunc() == 38.0);
        self.probe.code = said.map_or(self.probe.code, |w| w.value);
        let tenth = ((self.probe.code - 38.0) * 10.0).round() as u32;
        let beam = if self.motion.lamp.laser { Beam::Off } else { m.beam };
        let feed = Some(m.feed_mm_per_min);
        let way = Way { to: m.to, feed_mm_per_min: feed, overridable: false, beam, power_s: m.power_s };
        steps.push_back(Step::Probe(Seek { way, contact: tenth < 4 }));
        // Without contact G38.2 and G38.4 are an alarm, G38.3 and G38.5 are not.
        steps.push_back(Step::Probed(tenth.is_multiple_of(2)));
    }

    /// Starts a probing move from rest. A contact that is already what it should become is an alarm, and nothing moves.
    pub(super) fn start_probe(&mut self, seek: Seek) {
        if self.probe.closed == seek.contact {
            self.steps.retain(|step| !matches!(step, Step::Probed(_)));
            self.interpreter.set_position(self.motion.position);
            return self.alarm(4);
        }
        self.probe.sought = Some(seek.contact);
        self.probe.touched_mm = None;
        self.motion.push(seek.way);
        self.state = State::Run;
        self.motion.start();
    }

    /// The move has ended, by contact or without.
    pub(super) fn end_probe(&mut self, must_find: bool) {
        self.probe.sought = None;
        let touched_mm = self.probe.touched_mm.take();
        if touched_mm.is_none() && must_find {
            self.alarm(5);
        }
        self.probe.found = touched_mm.is_some();
        self.probe.last_mm = touched_mm.unwrap_or(self.motion.position);
        self.interpreter.set_position(self.motion.position);
        let line = self.probe_line();
        self.say(&line);
    }
}
