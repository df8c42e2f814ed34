//! A small scripted board for tests: buffers of GRBL 1.1, one block a line, replies worded as recorded from the firmware.

use std::collections::VecDeque;
use std::time::Duration;

use super::super::event::{Action, Command, Ending, Event};
use super::super::status::State;
use super::{Session, Settings};

pub(super) const RX: usize = 128;
pub(super) const BLOCKS: usize = 15;
/// How long the scripted machine brakes, ms.
pub(super) const BRAKE_MS: u64 = 60;

/// A board that can be told to misbehave.
pub(super) struct Board {
    pub(super) rx: VecDeque<u8>,
    pub(super) line: Vec<u8>,
    /// Remaining time of each block, ms, and where it ends on X of its work coordinates, mm.
    pub(super) blocks: VecDeque<(u64, f64)>,
    /// Where the head is, at the end of a block always, mm.
    pub(super) x_mm: f64,
    /// It stands there whatever it is told.
    pub(super) still: bool,
    /// A line that waits for a place in the planner.
    pub(super) waiting: bool,
    pub(super) state: State,
    pub(super) braking_ms: u64,
    pub(super) out: Vec<u8>,
    pub(super) block_ms: u64,
    pub(super) fullest_rx: usize,
    pub(super) lines: Vec<String>,
    pub(super) feed_percent: u16,
    pub(super) realtime: Vec<u8>,
    /// Answers not given, by the count of the line, from 1.
    pub(super) lose_answers_to: Vec<usize>,
    pub(super) refuse: Option<(usize, u16)>,
    pub(super) mute: bool,
    pub(super) banner: bool,
    pub(super) beam: bool,
}

impl Board {
    pub(super) fn new(block_ms: u64) -> Board {
        Board {
            rx: VecDeque::new(),
            line: Vec::new(),
            blocks: VecDeque::new(),
            x_mm: 5.0,
            still: false,
            waiting: false,
            state: State::Idle,
            braking_ms: 0,
            out: Vec::new(),
            block_ms,
            fullest_rx: 0,
            lines: Vec::new(),
            feed_percent: 100,
            realtime: Vec::new(),
            lose_answers_to: Vec::new(),
            refuse: None,
            mute: false,
            banner: true,
            beam: false,
        }
    }

    pub(super) fn say(&mut self, text: &str) {
        if !self.mute {
            self.out.extend(text.bytes());
            self.out.extend(b"\r\n");
        }
    }

    pub(super) fn boot(&mut self, locked: bool) {
        (self.rx, self.line, self.blocks, self.waiting) = Default::default();
        self.state = if locked { State::Alarm } else { State::Idle };
        self.feed_percent = 100;
        self.beam = false;
        self.say("");
        self.say("Grbl 1.1h ['$' for help]");
        if locked {
            self.say("[MSG:'$H'|'$X' to unlock]");
        }
    }

    pub(super) fn receive(&mut self, bytes: &[u8]) {
        for byte in bytes {
            match byte {
                b'?' => self.report(),
                b'!' if self.state == State::Run => (self.state, self.braking_ms) = (State::Hold(1), BRAKE_MS),
                b'!' if self.state == State::Idle => self.state = State::Hold(0),
                b'~' if matches!(self.state, State::Hold(0)) => self.state = State::Run,
                0x18 => {
                    let moving = matches!(self.state, State::Run | State::Hold(1));
                    if moving {
                        self.say("ALARM:3");
                    }
                    self.boot(moving);
                }
                0x90 => self.feed_percent = 100,
                0x91 => self.feed_percent += 10,
                0x93 => self.feed_percent += 1,
                byte if *byte < 0x80 && !b"!~".contains(byte) => {
                    self.rx.push_back(*byte);
                    self.fullest_rx = self.fullest_rx.max(self.rx.len());
                    continue;
                }
                _ => {}
            }
            if *byte != b'?' {
                self.realtime.push(*byte);
            }
        }
    }

    pub(super) fn report(&mut self) {
        let state = match self.state {
            State::Idle => "Idle".to_owned(),
            State::Run => "Run".to_owned(),
            State::Hold(n) => format!("Hold:{n}"),
            State::Alarm => "Alarm".to_owned(),
            _ => "Sleep".to_owned(),
        };
        let (blocks, bytes) = (BLOCKS - self.blocks.len(), RX - self.rx.len());
        let report = format!(
            "<{state}|MPos:{:.3},2.000,0.000|Bf:{blocks},{bytes}|FS:0,0|WCO:-4.000,0.000,0.000|Ov:{},100,100>",
            self.x_mm - 4.0,
            self.feed_percent
        );
        self.say(&report);
    }

    /// A millisecond goes by.
    pub(super) fn tick(&mut self) {
        if self.state == State::Hold(1) {
            self.braking_ms -= 1;
            if self.braking_ms == 0 {
                self.state = State::Hold(0);
            }
        }
        if matches!(self.state, State::Run | State::Idle) {
            match self.blocks.front_mut() {
                Some((0, x_mm)) => {
                    self.x_mm = *x_mm;
                    self.blocks.pop_front();
                }
                Some((left, _)) => *left -= 1,
                None => {}
            }
            self.state = if self.blocks.is_empty() { State::Idle } else { State::Run };
        }
        while !(matches!(self.state, State::Hold(_) | State::Sleep) || self.waiting && self.blocks.len() == BLOCKS) {
            if std::mem::take(&mut self.waiting) {
                self.plan();
                continue;
            }
            match self.rx.pop_front() {
                None => break,
                Some(b'\n') => self.take_line(),
                Some(byte) => self.line.push(byte),
            }
        }
    }

    pub(super) fn take_line(&mut self) {
        let line = String::from_utf8(std::mem::take(&mut self.line)).unwrap();
        match line.as_str() {
            "" => return self.say("ok"),
            "$I" => {
                self.say("[VER:1.1h.20190830:]");
                self.say("[OPT:V,15,128]");
            }
            "$$" => self.say("$30=1000"),
            "$#" => self.say("error:7"),
            "$G" => self.say("[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]"),
            _ if self.state == State::Alarm && line != "$X" => return self.say("error:9"),
            "$X" => self.state = State::Idle,
            _ => {}
        }
        if line.starts_with('$') {
            return self.say("ok");
        }
        self.beam = (self.beam || line.contains("M4")) && !line.contains("M5");
        self.lines.push(line);
        let count = self.lines.len();
        match self.refuse {
            Some((at, code)) if at == count => self.say(&format!("error:{code}")),
            _ => self.waiting = true,
        }
    }

    pub(super) fn plan(&mut self) {
        if let Some(line) = self.lines.last().filter(|line| line.starts_with('G')) {
            let number = |text: &str| text.split(char::is_alphabetic).next().and_then(|x| x.parse().ok());
            let before_mm = self.blocks.back().map_or(self.x_mm, |(_, x_mm)| *x_mm);
            let x_mm = line.strip_prefix("G1X").and_then(number).filter(|_| !self.still).unwrap_or(before_mm);
            self.blocks.push_back((self.block_ms, x_mm));
            self.state = State::Run;
        }
        if !self.lose_answers_to.contains(&self.lines.len()) {
            self.say("ok");
        }
    }
}

/// Session and board on one clock.
pub(super) struct Bench {
    pub(super) session: Session,
    pub(super) board: Board,
    pub(super) now_ms: u64,
    pub(super) events: Vec<Event>,
}

impl Bench {
    /// Opened, asked and idle.
    pub(super) fn ready(board: Board) -> Bench {
        let session = Session::new(Duration::ZERO, Settings::default());
        let mut bench = Bench { session, board, now_ms: 0, events: Vec::new() };
        if bench.board.banner {
            bench.board.boot(false);
        }
        bench.run_until(10_000, |b| b.session.is_ready() && b.session.status.is_some());
        bench
    }

    pub(super) fn now(&self) -> Duration {
        Duration::from_millis(self.now_ms)
    }

    pub(super) fn take(&mut self, actions: Vec<Action>) {
        for action in actions {
            match action {
                Action::Write(bytes) => self.board.receive(&bytes),
                Action::Event(event) => self.events.push(event),
            }
        }
    }

    pub(super) fn tick(&mut self) {
        self.now_ms += 1;
        self.board.tick();
        let bytes = std::mem::take(&mut self.board.out);
        let now = self.now();
        let actions = if bytes.is_empty() { self.session.on_tick(now) } else { self.session.on_bytes(now, &bytes) };
        self.take(actions);
        let actions = self.session.on_tick(now);
        self.take(actions);
    }

    pub(super) fn run_until(&mut self, at_most_ms: u64, done: impl Fn(&Bench) -> bool) {
        let end = self.now_ms + at_most_ms;
        while !done(self) {
            assert!(self.now_ms < end, "still not so after {at_most_ms} ms: {:?}", self.events.last());
            self.tick();
        }
    }

    pub(super) fn command(&mut self, command: Command) {
        let now = self.now();
        let actions = self.session.command(now, command);
        self.take(actions);
    }

    pub(super) fn send(&mut self, lines: impl IntoIterator<Item = String, IntoIter: Send + 'static>) {
        let lines = Box::new(lines.into_iter().map(Ok));
        self.command(Command::Run { lines });
    }

    pub(super) fn ending(&self) -> Option<&Ending> {
        self.events.iter().find_map(|e| if let Event::Ended(ending) = e { Some(ending) } else { None })
    }

    pub(super) fn end(&mut self, at_most_ms: u64) -> Ending {
        self.run_until(at_most_ms, |b| b.ending().is_some());
        self.ending().unwrap().clone()
    }
}
