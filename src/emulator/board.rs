//! The board: what it is made of, and the loop that takes it from one event to the next.

use super::assembler::{Assembler, Text};
use super::faults::{Fault, Faults, When};
use super::link::Link;
use super::memory::Memory;
use super::motion::{Ended, Lamp, Motion};
use super::probe::Probe;
use super::settings::{BoardSettings, Settings};
use super::steps::Step;
use super::trace::Segment;
use crate::gcode::Interpreter;
use crate::geom::P3;
use std::collections::VecDeque;

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
    pub(super) memory: Memory,
    pub(super) link: Link,
    pub(super) motion: Motion,
    pub(super) interpreter: Interpreter,
    pub(super) state: State,
    pub(super) clock_s: f64,
    pub(super) assembler: Assembler,
    /// The line being read, done at `busy_until_s`.
    pub(super) reading: Option<Text>,
    pub(super) busy_until_s: f64,
    /// What is left to do of the line last read.
    pub(super) steps: VecDeque<Step>,
    /// An alarm after which only a reset is heard.
    pub(super) critical: bool,
    /// The motion under way brakes and the rest of it is thrown away: a cancelled jog, a probe that has found its contact.
    pub(super) cancelled: bool,
    pub(super) reports_to_wco: u32,
    pub(super) reports_to_overrides: u32,
    pub(super) switches: [bool; 3],
    pub(super) probe: Probe,
    pub(super) faults: Faults,
    pub(super) boots_until_s: Option<f64>,
    plugged: bool,
    pub(super) powered: bool,
}

impl Board {
    /// A board whose port is opened at time 0: it boots.
    pub fn new(hardware: BoardSettings) -> Board {
        let settings = hardware.settings.clone();
        let limits = settings.limits(&hardware);
        let mut board = Board {
            link: Link::new(hardware.baud, hardware.rx_bytes, hardware.personality.eeprom_byte_s()),
            motion: Motion::new(limits, lamp(&settings), hardware.head_mm),
            interpreter: Interpreter::new(P3::origin(), hardware.memory.offsets_mm, hardware.memory.homes_mm),
            memory: hardware.memory.clone(),
            faults: Faults::new(hardware.seed),
            settings,
            state: State::Idle,
            clock_s: 0.0,
            assembler: Assembler::new(hardware.personality.line_chars()),
            reading: None,
            busy_until_s: 0.0,
            steps: VecDeque::new(),
            critical: false,
            cancelled: false,
            reports_to_wco: 0,
            reports_to_overrides: 0,
            switches: [false; 3],
            probe: Probe::new(),
            boots_until_s: None,
            plugged: true,
            powered: true,
            hardware,
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
            Fault::Reset if self.powered => self.boot(),
            Fault::Chatter(lines) => (0..lines).for_each(|k| self.say(&format!("[MSG:INFO: heap {}]", 170_000 - k))),
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
}

/// How the settings turn S words into light.
pub(super) fn lamp(settings: &Settings) -> Lamp {
    Lamp { max_s: settings.get(30), min_s: settings.get(31), laser: settings.is_on(32) }
}
