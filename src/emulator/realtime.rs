//! Bytes that act on arrival, wherever they stand (serial.c, protocol.c).

use super::board::{Board, State};
use super::motion::Overrides;
use crate::gcode::Beam;

/// Said when a spindle that a hold has stopped runs again.
const RESTORING: &str = "[MSG:Restoring spindle]";

impl Board {
    /// Acts on a real-time byte; false for a byte of a line.
    pub(super) fn real_time(&mut self, byte: u8) -> bool {
        match byte {
            0x18 => self.reset(6),
            b'?' | b'!' | b'~' | 0x80.. if self.critical => {}
            b'?' => self.report(),
            b'!' => self.hold(),
            b'~' => self.resume(),
            0x84 => self.open_door(),
            0x85 if self.state == State::Jog => self.cancel_jog(),
            0x90..=0x9D => self.override_by(byte),
            0x9E => self.stop_spindle(),
            // GRBL throws away what it does not know.
            0x80.. => {}
            _ => return false,
        }
        true
    }

    /// `!`, and M0 (protocol.c, EXEC_FEED_HOLD).
    pub(super) fn hold(&mut self) {
        match self.state {
            State::Run => {
                self.state = State::Hold;
                self.motion.brake();
            }
            State::Idle => {
                self.state = State::Hold;
                self.darken();
            }
            State::Jog => self.cancel_jog(),
            _ => {}
        }
    }

    fn cancel_jog(&mut self) {
        self.cancelled = true;
        self.motion.brake();
    }

    fn resume(&mut self) {
        let rests = !self.motion.is_running();
        match self.state {
            State::Hold if rests => {
                let stopped = self.settings.is_on(32) || self.motion.dark;
                if stopped && self.interpreter.modal().beam != Beam::Off {
                    self.say(RESTORING);
                }
                self.go_on();
            }
            State::Door if rests => self.go_on(),
            State::Idle => self.start_cycle(),
            _ => {}
        }
    }

    fn go_on(&mut self) {
        self.state = if self.motion.is_empty() { State::Idle } else { State::Run };
        self.motion.start();
    }

    fn open_door(&mut self) {
        match self.state {
            State::Home => return self.reset(7),
            State::Alarm | State::Sleep | State::Door | State::Check => return,
            State::Jog => self.cancelled = true,
            State::Idle | State::Run | State::Hold => {}
        }
        self.say("[MSG:Check Door]");
        self.state = State::Door;
        if self.motion.is_running() {
            self.motion.brake();
        } else {
            self.darken();
        }
    }

    /// The machine has come to rest after `!`, a door, a cancelled jog or a way out of bounds.
    pub(super) fn came_to_hold(&mut self) {
        if std::mem::take(&mut self.cancelled) {
            self.motion.flush();
            self.interpreter.set_position(self.motion.position);
            self.drop_ways();
            if matches!(self.state, State::Jog | State::Run) {
                self.state = State::Idle;
            }
        }
        self.darken();
    }

    /// In laser mode a hold puts the beam out at rest; it comes back with the next motion only. An open door puts it out in any mode.
    fn darken(&mut self) {
        if self.state == State::Door || self.state == State::Hold && self.settings.is_on(32) {
            self.motion.dark = true;
            self.motion.rest_s = 0.0;
        }
    }

    /// 0x9E acts in a hold only; in laser mode the beam is out already, and the byte lets it come back when the motion does.
    fn stop_spindle(&mut self) {
        if self.state == State::Hold && !self.motion.is_running() && !self.settings.is_on(32) {
            self.motion.dark = !self.motion.dark;
            if !self.motion.dark && self.interpreter.modal().beam != Beam::Off {
                self.say(RESTORING);
            }
        }
    }

    fn override_by(&mut self, byte: u8) {
        let mut o = self.motion.overrides;
        let by = |percent: u16, change: i16| percent.saturating_add_signed(change).clamp(10, 200);
        match byte {
            0x90 => o.feed_percent = Overrides::NONE.feed_percent,
            0x91 => o.feed_percent = by(o.feed_percent, 10),
            0x92 => o.feed_percent = by(o.feed_percent, -10),
            0x93 => o.feed_percent = by(o.feed_percent, 1),
            0x94 => o.feed_percent = by(o.feed_percent, -1),
            0x95 => o.rapid_percent = 100,
            0x96 => o.rapid_percent = 50,
            0x97 => o.rapid_percent = 25,
            0x99 => o.spindle_percent = Overrides::NONE.spindle_percent,
            0x9A => o.spindle_percent = by(o.spindle_percent, 10),
            0x9B => o.spindle_percent = by(o.spindle_percent, -10),
            0x9C => o.spindle_percent = by(o.spindle_percent, 1),
            0x9D => o.spindle_percent = by(o.spindle_percent, -1),
            _ => {}
        }
        if o != self.motion.overrides {
            self.reports_to_overrides = 0;
            self.motion.set_overrides(o);
        }
    }
}
