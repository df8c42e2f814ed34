//! The controller's main loop: bytes to lines, lines to steps, steps one by one.

use super::assembler::Text;
use super::board::{Board, State};

/// Reading a line without motion, as a share of reading one with: measured with the planner's own feeder.
const PLAIN_LINE_SHARE: f64 = 0.5;

impl Board {
    /// True while the controller's main loop stands still in GRBL's suspend loop or for good.
    fn is_suspended(&self) -> bool {
        self.critical
            || self.cancelled
            || self.boots_until_s.is_some()
            || matches!(self.state, State::Hold | State::Door | State::Sleep)
    }

    /// The controller's main loop (protocol.c), as far as it gets now.
    pub(super) fn run_controller(&mut self) {
        while self.powered && !self.is_suspended() && self.clock_s >= self.busy_until_s {
            if let Some(text) = self.reading.take() {
                self.steps = self.steps_of(text);
            } else if let Some(step) = self.steps.pop_front() {
                if let Some(blocked) = self.take_step(step) {
                    self.steps.push_front(blocked);
                    return;
                }
            } else if let Some(byte) = self.link.read() {
                if let Some(text) = self.assembler.take(byte) {
                    // A full transmit buffer keeps the controller waiting before it reads on.
                    self.busy_until_s = self.clock_s.max(self.link.written_s()) + self.reading_s(&text);
                    self.reading = Some(text);
                }
            } else {
                self.start_cycle();
                return;
            }
        }
    }

    fn reading_s(&self, text: &Text) -> f64 {
        let moves = matches!(text, Text::Line(line) if line.contains(['X', 'Y', 'Z']) && !line.starts_with('$'));
        self.hardware.line_s * if moves { 1.0 } else { PLAIN_LINE_SHARE }
    }

    /// Starts what is planned (protocol.c, protocol_auto_cycle_start).
    pub(super) fn start_cycle(&mut self) {
        if self.state == State::Idle && !self.motion.is_empty() {
            self.state = State::Run;
            self.motion.start();
        }
    }
}
