//! When lines reach the planner: the serial link, the controller's receive buffer and the time it takes to read a line.
//!
//! The sender counts characters: it never has more bytes under way than the receive buffer holds. Measured on GRBL 1.1h on an ATmega328p: about
//! 270 motion lines a second, and one and a half times that time from a rest to the next motion when a motion line and a line with an M word follow
//! it (120 such rests took 5.5 ms each), hence half for lines without motion.

use std::collections::VecDeque;

use super::{Held, Limits};

/// Reading a line without motion, as a share of reading one with.
const PLAIN_LINE_SHARE: f64 = 0.5;

/// When a line came in; s on the planner's clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arrival {
    /// Its last byte is in the receive buffer.
    pub(super) arrived_s: f64,
    /// It has been read and its blocks are planned.
    pub(super) read_s: f64,
    /// What made it come when it came.
    pub(super) held: Held,
}

/// The way of lines from the sender to the planner.
#[derive(Debug)]
pub(super) struct Feeder {
    bytes_per_s: f64,
    rx_bytes: usize,
    line_s: f64,
    link_free_s: f64,
    last: Arrival,
    /// Lines not yet known to be answered when the next was sent: bytes and when read.
    under_way: VecDeque<(usize, f64)>,
    bytes_under_way: usize,
}

impl Feeder {
    pub(super) fn new(limits: &Limits) -> Feeder {
        Feeder {
            bytes_per_s: limits.bytes_per_s,
            rx_bytes: limits.rx_bytes,
            line_s: limits.line_s,
            link_free_s: 0.0,
            last: Arrival { arrived_s: 0.0, read_s: 0.0, held: Held::Link },
            under_way: VecDeque::new(),
            bytes_under_way: 0,
        }
    }

    /// The line taken last.
    pub(super) fn last(&self) -> Arrival {
        self.last
    }

    /// Sends a line and lets the controller read it.
    pub(super) fn receive(&mut self, bytes: usize, has_motion: bool) {
        self.answer_last();
        while self.bytes_under_way + bytes > self.rx_bytes
            && let Some((answered, read_s)) = self.under_way.pop_front()
        {
            self.bytes_under_way -= answered;
            self.link_free_s = self.link_free_s.max(read_s);
        }
        self.link_free_s += bytes as f64 / self.bytes_per_s;
        let arrived_s = self.link_free_s;
        let held = if arrived_s > self.last.read_s { Held::Link } else { Held::Controller };
        let cost_s = self.line_s * if has_motion { 1.0 } else { PLAIN_LINE_SHARE };
        self.last = Arrival { arrived_s, read_s: arrived_s.max(self.last.read_s) + cost_s, held };
        self.under_way.push_back((bytes, self.last.read_s));
        self.bytes_under_way += bytes;
    }

    /// The line taken last is done with no sooner than this: its reader waits for a place in the planner's buffer, or for the machine to rest.
    pub(super) fn wait_until(&mut self, time_s: f64) {
        self.last.read_s = self.last.read_s.max(time_s);
    }

    /// The answer to the last line goes out when it has been carried out.
    fn answer_last(&mut self) {
        if let Some(last) = self.under_way.back_mut() {
            last.1 = self.last.read_s;
        }
    }
}
