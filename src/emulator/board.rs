//! The board: what it is made of, and the loop that takes it from one event to the next.

use super::assembler::{Assembler, Text};
use super::faults::{Fault, Faults, When};
use super::link::Link;
use super::motion::{Ended, Lamp, Motion, Overrides};
use super::settings::{BoardSettings, Settings};
use super::steps::Step;
use super::trace::Segment;
use crate::gcode::Interpreter;
use crate::geom::{P3, V3};
use std::collections::VecDeque;

/// Reading a line without motion, as a share of reading one with: measured with the planner's own feeder.
const PLAIN_LINE_SHARE: f64 = 0.5;

/// GRBL's states. Whether a hold or an open door has come to rest, [`Board::is_moving`] tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Ready.
    Idle,
    /// Runs blocks.
    Run,
    /// Feed hold.
    Hold,
    /// Jogs.
    Jog,
    /// Homes.
    Home,
    /// Locked.
    Alarm,
    /// Reads lines without moving.
    Check,
    /// The safety door was opened.
    Door,
    /// Asleep until a reset.
    Sleep,
}

/// An emulated GRBL board with its machine. Times are virtual and in s, and never go back.
#[derive(Debug)]
pub struct Board {
    pub(super) hardware: BoardSettings,
    pub(super) settings: Settings,
    /// Origins of G54 to G59 as the EEPROM has them, mm.
    pub(super) stored_mm: [V3; 6],
    pub(super) link: Link,
    pub(super) motion: Motion,
    pub(super) interpreter: Interpreter,
    pub(super) state: State,
    pub(super) clock_s: f64,
    assembler: Assembler,
    /// The line being read, done at `busy_until_s`.
    pub(super) reading: Option<Text>,
    pub(super) busy_until_s: f64,
    /// What is left to do of the line last read.
    pub(super) steps: VecDeque<Step>,
    /// An alarm after which only a reset is heard.
    pub(super) critical: bool,
    /// A jog is being cancelled.
    pub(super) jog_cancelled: bool,
    pub(super) reports_to_wco: u32,
    pub(super) reports_to_overrides: u32,
    pub(super) switches: [bool; 3],
    pub(super) faults: Faults,
    boots_until_s: Option<f64>,
    plugged: bool,
    powered: bool,
}

impl Board {
    /// A board whose port is opened at time 0: it boots.
    pub fn new(hardware: BoardSettings) -> Board {
        let settings = hardware.settings.clone();
        let limits = settings.limits(&hardware);
        let mut board = Board {
            link: Link::new(hardware.baud, hardware.rx_bytes),
            motion: Motion::new(limits, lamp(&settings), hardware.head_mm),
            interpreter: Interpreter::new(P3::origin(), hardware.offsets_mm),
            stored_mm: hardware.offsets_mm,
            faults: Faults::new(hardware.seed),
            settings,
            hardware,
            state: State::Idle,
            clock_s: 0.0,
            assembler: Assembler::default(),
            reading: None,
            busy_until_s: 0.0,
            steps: VecDeque::new(),
            critical: false,
            jog_cancelled: false,
            reports_to_wco: 0,
            reports_to_overrides: 0,
            switches: [false; 3],
            boots_until_s: None,
            plugged: true,
            powered: true,
        };
        board.boot();
        board
    }

    /// The host opens the port at `now_s`: the board resets if it is one that does. False when it is not plugged in.
    pub fn open(&mut self, now_s: f64) -> bool {
        self.run_to(now_s);
        if self.plugged && self.powered && self.hardware.resets_on_open {
            self.boot();
        }
        self.plugged
    }

    /// Runs to `now_s`, when the host writes `bytes_in`; gives the bytes that have reached the host by then.
    pub fn step(&mut self, now_s: f64, bytes_in: &[u8]) -> Vec<u8> {
        self.run_to(now_s);
        if self.plugged {
            bytes_in.iter().for_each(|byte| self.link.send_in(self.clock_s, *byte));
        }
        self.link.delivered(self.clock_s)
    }

    /// When something next happens by itself: on the board, or a byte reaching the host; s.
    pub fn next_s(&self) -> Option<f64> {
        self.next_event_s().into_iter().chain(self.link.next_out_s()).min_by(f64::total_cmp)
    }

    /// Makes something go wrong.
    pub fn schedule(&mut self, when: When, fault: Fault) {
        self.faults.schedule(when, fault);
    }

    /// Closes or opens the limit switch of an axis (0 x, 1 y, 2 z) now.
    pub fn set_switch(&mut self, axis: usize, closed: bool) {
        if let Some(switch) = self.switches.get_mut(axis) {
            *switch = closed;
        }
        if closed && self.settings.is_on(21) && !matches!(self.state, State::Alarm | State::Home) {
            self.alarm(1);
        }
    }

    /// What the machine did up to the time of the last step, in order.
    pub fn trace(&self) -> &[Segment] {
        &self.motion.record.segments
    }

    /// Hands the trace out and starts it anew, so that long jobs need no memory.
    pub fn take_trace(&mut self) -> Vec<Segment> {
        self.motion.record.take()
    }

    /// Its state.
    pub fn state(&self) -> State {
        self.state
    }

    /// True while the head moves.
    pub fn is_moving(&self) -> bool {
        self.motion.is_running()
    }

    /// Where the board believes the head is, machine coordinates, mm.
    pub fn position_mm(&self) -> P3 {
        self.motion.position
    }

    /// Where the head really is, mm from the home corner.
    pub fn head_mm(&self) -> P3 {
        self.motion.position + self.motion.drift
    }

    /// Share of full power the beam has now.
    pub fn power(&self) -> f64 {
        self.motion.power()
    }

    /// True while plugged in.
    pub fn is_plugged(&self) -> bool {
        self.plugged
    }

    /// Bytes lost on their way in: by a full receive buffer or during EEPROM writes, not by faults on command.
    pub fn bytes_lost(&self) -> u64 {
        self.link.lost
    }

    /// The settings in its EEPROM.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Powers up or resets by its pin: everything but the EEPROM is forgotten, and the boot loader eats bytes for a while.
    fn boot(&mut self) {
        self.motion.flush();
        self.motion.drift += self.motion.position.coords;
        self.motion.position = P3::origin();
        self.state = if self.settings.is_on(22) { State::Alarm } else { State::Idle };
        self.forget();
        self.boots_until_s = Some(self.clock_s + self.hardware.boot_s);
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
        self.interpreter = Interpreter::new(self.motion.position, self.stored_mm);
        self.link.clear_ring();
        self.assembler = Assembler::default();
        self.reading = None;
        self.steps.clear();
        self.busy_until_s = self.clock_s;
        (self.critical, self.jog_cancelled) = (false, false);
        (self.reports_to_wco, self.reports_to_overrides) = (0, 0);
    }

    /// The banner and what follows it (protocol.c, protocol_main_loop).
    fn greet(&mut self) {
        self.say("");
        self.say("Grbl 1.1h ['$' for help]");
        if self.settings.is_on(21) && self.switches.contains(&true) {
            self.state = State::Alarm;
            self.say("[MSG:Check Limits]");
        }
        self.state = match self.state {
            State::Alarm | State::Sleep => {
                self.say("[MSG:'$H'|'$X' to unlock]");
                State::Alarm
            }
            _ => State::Idle,
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

    /// Takes settings over where they act at once.
    pub(super) fn apply_settings(&mut self) {
        self.motion.limits = self.settings.limits(&self.hardware);
        self.motion.lamp = lamp(&self.settings);
    }

    /// Writes a line to the host.
    pub(super) fn say(&mut self, text: &str) {
        if !self.plugged {
            return;
        }
        for byte in text.bytes().chain(*b"\r\n") {
            if let Some(byte) = self.faults.outward(byte) {
                self.link.send_out(self.clock_s, byte);
            }
        }
    }

    /// Answers a line: `ok`, or `error:` with a number.
    pub(super) fn answer(&mut self, error: Option<u8>) {
        match error {
            Some(code) => self.say(&format!("error:{code}")),
            None if self.faults.swallows_ok() => {}
            None => self.say("ok"),
        }
    }

    fn next_event_s(&self) -> Option<f64> {
        if !self.powered {
            return self.faults.next_s();
        }
        let busy = (self.busy_until_s > self.clock_s).then_some(self.busy_until_s);
        let events = [self.link.next_in_s(), self.motion.next_s(), busy, self.boots_until_s, self.faults.next_s()];
        events.into_iter().flatten().min_by(f64::total_cmp)
    }

    fn run_to(&mut self, now_s: f64) {
        while let Some(event_s) = self.next_event_s().filter(|s| *s <= now_s) {
            self.run_motion(event_s);
            while let Some(fault) = self.faults.due(self.clock_s) {
                self.strike(fault);
            }
            if self.boots_until_s.is_some_and(|s| s <= self.clock_s) {
                self.boots_until_s = None;
                self.link.clear_ring();
                self.greet();
            }
            while let Some((arrived_s, byte)) = self.link.arrived(self.clock_s) {
                self.receive(arrived_s, byte);
            }
            self.run_controller();
        }
        self.run_motion(now_s);
    }

    /// Lets the machine run on; a time before now is now.
    fn run_motion(&mut self, to_s: f64) {
        let to_s = to_s.max(self.clock_s);
        self.clock_s = to_s;
        match self.motion.advance(to_s) {
            Some(Ended::Hold) => self.came_to_hold(),
            Some(Ended::All) if matches!(self.state, State::Run | State::Jog) => self.state = State::Idle,
            Some(Ended::All) | None => {}
        }
    }

    fn strike(&mut self, fault: Fault) {
        match fault {
            Fault::Unplug { powered } => {
                self.plugged = false;
                self.link.cut(self.clock_s);
                if !powered {
                    self.boot();
                    self.boots_until_s = None;
                    self.powered = false;
                }
            }
            Fault::Replug => {
                self.plugged = true;
                if !std::mem::replace(&mut self.powered, true) {
                    self.boot();
                }
            }
            Fault::Reset => self.boot(),
            _ => {}
        }
    }

    fn receive(&mut self, arrived_s: f64, byte: u8) {
        let Some(byte) = self.faults.inward(byte) else { return };
        while let Some(fault) = self.faults.due(self.clock_s) {
            self.strike(fault);
        }
        if self.boots_until_s.is_some() || !self.plugged || !self.link.is_heard(arrived_s) {
            return;
        }
        if !self.real_time(byte) {
            self.link.store(byte);
            // What the controller does not wait for it reads at once, byte by byte.
            self.run_controller();
        }
    }

    /// True while the controller's main loop stands still in GRBL's suspend loop or for good.
    fn is_suspended(&self) -> bool {
        self.critical
            || self.jog_cancelled
            || self.boots_until_s.is_some()
            || matches!(self.state, State::Hold | State::Door | State::Sleep)
    }

    /// The controller's main loop (protocol.c), as far as it gets now.
    fn run_controller(&mut self) {
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

fn lamp(settings: &Settings) -> Lamp {
    Lamp { max_s: settings.get(30), min_s: settings.get(31), laser: settings.is_on(32) }
}
