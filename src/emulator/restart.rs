//! Starting anew: by power, by the reset pin, by `^X`, by an alarm.

use super::assembler::Assembler;
use super::board::{Board, State};
use super::memory::STARTUP_LINES;
use super::motion::Overrides;
use super::steps::Step;
use crate::gcode::Interpreter;
use crate::geom::P3;

impl Board {
    /// Powers up or resets by its pin: everything but the EEPROM is forgotten, and the boot loader eats bytes for a while.
    pub(super) fn boot(&mut self) {
        self.motion.flush();
        self.motion.drift += self.motion.position.coords;
        self.motion.position = P3::origin();
        self.state = if self.settings.is_on(22) { State::Alarm } else { State::Idle };
        self.forget();
        self.boots_until_s = Some(self.clock_s + self.hardware.boot_s);
        for line in self.hardware.personality.boot_noise() {
            self.say(line);
        }
    }

    /// The soft reset `^X` (motion_control.c, mc_reset; main.c): `homing_alarm` is what it means while homing.
    pub(super) fn reset(&mut self, homing_alarm: u8) {
        if self.motion.is_running() {
            let code = if self.state == State::Home { homing_alarm } else { 3 };
            self.say(&format!("ALARM:{code}"));
            self.state = State::Alarm;
        }
        self.motion.flush();
        // The line under way returns to the main loop, which answers it before it begins anew.
        if self.reading.is_some() || self.steps.iter().any(|step| matches!(step, Step::Answer(_))) {
            self.answer(None);
        }
        self.forget();
        self.greet();
    }

    fn forget(&mut self) {
        self.motion.rest_s = 0.0;
        self.motion.dark = false;
        self.motion.overrides = Overrides::NONE;
        self.interpreter = Interpreter::new(self.motion.position, self.memory.offsets_mm, self.memory.homes_mm);
        self.link.clear_ring();
        self.assembler = Assembler::new(self.hardware.personality.line_chars());
        self.reading = None;
        self.steps.clear();
        self.busy_until_s = self.clock_s;
        (self.critical, self.cancelled) = (false, false);
        self.probe.forget();
        (self.reports_to_wco, self.reports_to_overrides) = (0, 0);
    }

    /// The banner and what follows it (protocol.c, protocol_main_loop).
    pub(super) fn greet(&mut self) {
        self.say("");
        self.say(self.hardware.personality.banner());
        if self.settings.is_on(21) && self.switches.contains(&true) {
            self.state = State::Alarm;
            self.say("[MSG:Check Limits]");
        }
        self.state = match self.state {
            State::Alarm | State::Sleep => {
                self.say("[MSG:'$H'|'$X' to unlock]");
                State::Alarm
            }
            _ => {
                self.steps.extend((0..STARTUP_LINES).map(Step::Startup));
                State::Idle
            }
        };
    }

    /// Stops everything; after a limit (1, 2) only a reset is heard (protocol.c, protocol_exec_rt_system).
    pub(super) fn alarm(&mut self, code: u8) {
        self.motion.flush();
        self.motion.rest_s = 0.0;
        self.state = State::Alarm;
        self.say(&format!("ALARM:{code}"));
        if matches!(code, 1 | 2) {
            self.say("[MSG:Reset to continue]");
            self.critical = true;
        }
    }
}
