//! A line becomes steps; the controller takes them one by one and waits where GRBL waits: for a place in the planner, for the machine to rest,
//! for a dwell, for the EEPROM.

use std::collections::VecDeque;

use super::assembler::Text;
use super::board::{Board, State};
use super::memory::Memory;
use super::motion::{Overrides, Way};
use super::probe::Seek;
use crate::gcode::{Action, Beam, Move, parse};
use crate::geom::{P3, V3};

/// One thing a line wants done.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Step {
    /// A straight way into the planner.
    Way(Way),
    /// The machine comes to rest; then a beam that stays on shines with this S.
    Rest(f64),
    /// Stands still for so many seconds.
    Dwell(f64),
    /// M0: holds until resumed.
    Pause,
    /// The way ahead leaves the machine: stops and locks (ALARM:2).
    OutOfBounds,
    /// Writes so many bytes of the EEPROM.
    Eeprom(usize),
    Say(String),
    /// Carries out a startup line (`$N`).
    Startup(usize),
    /// Probes.
    Probe(Seek),
    /// Has probed; true when no contact is an alarm.
    Probed(bool),
    /// Drives to the home switches.
    Home,
    /// Has arrived there.
    Homed,
    /// Starts the jog that is queued.
    Jog,
    Sleep,
    /// The overrides go back to 100 %.
    ClearOverrides,
    /// `ok`, or an error.
    Answer(Option<u8>),
    /// A soft reset.
    Reset,
}

impl Board {
    /// What a line wants done, its answer included.
    pub(super) fn steps_of(&mut self, text: Text) -> VecDeque<Step> {
        let line = match text {
            Text::TooLong => return answer(Some(11)),
            Text::Line(line) => line,
        };
        let done = match line.strip_prefix('$') {
            _ if line.is_empty() => return answer(None),
            Some(command) => self.system(command),
            None if matches!(self.state, State::Alarm | State::Jog) => Err(9),
            None => self.g_code(&line),
        };
        match done {
            Ok(steps) => steps,
            Err(code) => answer(Some(code)),
        }
    }

    pub(super) fn g_code(&mut self, text: &str) -> Result<VecDeque<Step>, u8> {
        let program = parse(text).map_err(|e| e.grbl_error)?;
        let Some(line) = program.lines.first() else { return Ok(answer(None)) };
        let says = |codes: &[f64]| line.words.iter().any(|w| w.letter == 'M' && codes.contains(&w.value));
        if says(&[7.0]) {
            // Mist is not built in (config.h, ENABLE_M7).
            return Err(20);
        }
        let before = self.interpreter.clone();
        let moves = self.interpreter.line(line).map_err(|problem| problem.grbl_error())?;
        self.interpreter.round_as_board();
        let (modal, was) = (self.interpreter.modal(), before.modal());
        if self.interpreter.origin() != before.origin() {
            self.reports_to_wco = 0;
        }
        let mut steps = VecDeque::new();
        if self.state == State::Check {
            if says(&[2.0, 30.0]) {
                steps.push_back(Step::Say("[MSG:Pgm End]".into()));
            }
            steps.push_back(Step::Answer(None));
            return Ok(steps);
        }
        let laser = self.motion.lamp.laser;
        let lit_s = |beam: Beam, power_s: f64| match beam {
            Beam::Constant if modal.feeds || !laser => power_s,
            Beam::Dynamic if !laser => power_s,
            _ => 0.0,
        };
        if !laser && (modal.power_s, modal.beam) != (was.power_s, was.beam) {
            // Without laser mode every change of the spindle stops the machine.
            steps.push_back(Step::Rest(lit_s(modal.beam, modal.power_s)));
        }
        for m in &moves {
            match m.action {
                Action::Stop => steps.push_back(Step::Rest(lit_s(m.beam, m.power_s))),
                Action::Dwell { seconds } => {
                    steps.push_back(Step::Rest(lit_s(m.beam, m.power_s)));
                    steps.push_back(Step::Dwell(seconds));
                }
                Action::Rapid if modal.motion == "G38.2" => self.seek(line, m, &mut steps),
                Action::Rapid | Action::Line | Action::Arc { .. } => self.ways(m, &mut steps),
            }
        }
        if says(&[0.0]) {
            steps.push_back(Step::Pause);
        }
        let (offsets_mm, homes_mm) = (self.interpreter.offsets(), self.interpreter.homes());
        steps.extend(self.write(Memory { offsets_mm, homes_mm, ..self.memory.clone() }));
        if says(&[2.0, 30.0]) {
            steps.push_back(Step::Rest(0.0));
            steps.push_back(Step::ClearOverrides);
            steps.push_back(Step::Say("[MSG:Pgm End]".into()));
        }
        steps.push_back(Step::Answer(None));
        Ok(steps)
    }

    /// A move as straight ways, up to the first that leaves the machine.
    fn ways(&self, m: &Move, steps: &mut VecDeque<Step>) {
        let feed_mm_per_min = m.feeds().then_some(m.feed_mm_per_min);
        for to in self.motion.limits.ends(m) {
            if self.settings.is_on(20) && !self.is_within(to) {
                steps.push_back(Step::OutOfBounds);
                return;
            }
            let way = Way { to, feed_mm_per_min, overridable: true, beam: m.beam, power_s: m.power_s };
            steps.push_back(Step::Way(way));
        }
    }

    /// True within the soft limits: machine space runs from 0 down to minus the travel ($130 to $132).
    pub(super) fn is_within(&self, p: P3) -> bool {
        [p.x, p.y, p.z].into_iter().zip(130..).all(|(at, n)| at <= 0.0 && at >= -self.settings.get(n))
    }

    /// Takes a step; gives back what must wait, or what remains of it.
    pub(super) fn take_step(&mut self, step: Step) -> Option<Step> {
        match step {
            Step::Way(_) if self.motion.is_full() => {
                self.start_cycle();
                return Some(step);
            }
            Step::Way(way) => self.motion.push(way),
            Step::Rest(_)
            | Step::Dwell(_)
            | Step::Pause
            | Step::OutOfBounds
            | Step::Eeprom(_)
            | Step::Probe(_)
            | Step::Probed(_)
                if !self.motion.is_empty() =>
            {
                if step == Step::OutOfBounds && self.state == State::Run {
                    self.motion.brake();
                    if !self.motion.is_running() {
                        self.alarm(2);
                    }
                }
                self.start_cycle();
                return Some(step);
            }
            Step::Rest(0.0) if self.clock_s < self.motion.darkest_s() => {
                self.busy_until_s = self.motion.darkest_s();
                return Some(step);
            }
            Step::Rest(s) => self.motion.rest_s = s,
            Step::Dwell(seconds) => self.busy_until_s = self.clock_s + seconds,
            Step::Pause => self.hold(),
            Step::OutOfBounds => {
                self.alarm(2);
                // Its line is answered when the reset comes.
                return None;
            }
            Step::Eeprom(bytes) => self.busy_until_s = self.link.stall(self.clock_s, bytes),
            Step::Say(text) => self.say(&text),
            Step::Startup(number) => {
                let mut steps = self.startup_steps(number);
                steps.append(&mut self.steps);
                self.steps = steps;
            }
            Step::Probe(seek) => self.start_probe(seek),
            Step::Probed(must_find) => self.end_probe(must_find),
            Step::Home => self.go_home(),
            Step::Homed if !self.motion.is_empty() => return Some(step),
            Step::Homed => self.arrive_home(),
            Step::Jog if self.state == State::Idle && !self.motion.is_empty() => {
                self.state = State::Jog;
                self.motion.start();
            }
            Step::Jog => {}
            Step::Sleep => {
                self.motion.rest_s = 0.0;
                self.say("[MSG:Sleeping]");
                self.state = State::Sleep;
            }
            Step::ClearOverrides => {
                self.motion.set_overrides(Overrides::NONE);
                self.reports_to_overrides = 0;
            }
            Step::Answer(error) => self.answer(error),
            Step::Reset => self.reset(6),
        }
        None
    }

    /// Forgets the ways of the line under way.
    pub(super) fn drop_ways(&mut self) {
        self.steps.retain(|step| !matches!(step, Step::Way(_)));
    }

    /// The homing cycle as ways: Z, then X and Y together, to the switches at the seek rate ($25), back by the pull-off ($27), to them again at the
    /// slow rate ($24), back again.
    fn go_home(&mut self) {
        let corner = self.corner() - self.motion.drift;
        let pull_off = self.pull_off();
        let (seek, locate) = (self.settings.get(25), self.settings.get(24));
        let up = P3::new(self.motion.position.x, self.motion.position.y, corner.z);
        let ends =
            [(up, seek), (corner, seek), (corner + pull_off, seek), (corner, locate), (corner + pull_off, locate)];
        self.state = State::Home;
        self.motion.rest_s = 0.0;
        for (to, feed) in ends {
            let way = Way { to, feed_mm_per_min: Some(feed), overridable: false, beam: Beam::Off, power_s: 0.0 };
            self.motion.push(way);
        }
        self.motion.start();
    }

    fn arrive_home(&mut self) {
        self.motion.drift = V3::zeros();
        self.motion.position = self.corner() + self.pull_off();
        self.interpreter.set_position(self.motion.position);
        self.state = State::Idle;
    }

    /// Where the home switches are, mm: at 0 or at the far end ($23).
    fn corner(&self) -> P3 {
        let at = |axis: u16| if self.homes_low(axis) { -self.settings.get(130 + axis) } else { 0.0 };
        P3::new(at(0), at(1), at(2))
    }

    fn pull_off(&self) -> V3 {
        let by = |axis: u16| self.settings.get(27) * if self.homes_low(axis) { 1.0 } else { -1.0 };
        V3::new(by(0), by(1), by(2))
    }

    fn homes_low(&self, axis: u16) -> bool {
        self.settings.get(23) as u32 >> axis & 1 == 1
    }
}

/// Nothing but an answer.
pub(super) fn answer(error: Option<u8>) -> VecDeque<Step> {
    VecDeque::from([Step::Answer(error)])
}
