//! A board and a session on one virtual clock.

use furbelow::emulator::{Board, BoardSettings, Segment, State};
use furbelow::stream::{self, Action, Command, Ending, Event, Session, Settings};
use std::time::Duration;

/// How often the session is told the time, s.
const TICK_S: f64 = 0.002;

/// When the board came into a state in which it must be dark soon, and until when that holds; s.
pub struct Halt {
    pub from_s: f64,
    pub to_s: f64,
}

pub struct Bench {
    pub board: Board,
    pub session: Session,
    pub now_s: f64,
    to_board: Vec<u8>,
    pub events: Vec<Event>,
    pub ending: Option<Ending>,
    pub halts: Vec<Halt>,
}

impl Bench {
    pub fn new(board: Board) -> Bench {
        Bench {
            board,
            session: Session::new(Duration::ZERO, Settings::default()),
            now_s: 0.0,
            to_board: Vec::new(),
            events: Vec::new(),
            ending: None,
            halts: Vec::new(),
        }
    }

    /// A board of these settings, brought to where a job may start.
    pub fn ready(settings: BoardSettings) -> Bench {
        let mut bench = Bench::new(Board::new(settings));
        bench.get_ready();
        bench
    }

    pub fn get_ready(&mut self) {
        assert!(self.until(20.0, |b| b.session.is_ready()), "no board: {:?}", self.events);
        assert!(self.until(5.0, |b| matches!(b.events.last(), Some(Event::Status(..)))));
        if self.board.state() == State::Alarm {
            self.command(Command::Unlock);
            assert!(self.until(
                5.0,
                |b| matches!(b.events.last(), Some(Event::Status(s, _)) if s.state == stream::State::Idle)
            ));
        }
    }

    /// The plug is in again: another session opens the port.
    pub fn reopen(&mut self) {
        self.to_board.clear();
        assert!(self.board.open(self.now_s));
        self.session = Session::new(self.now(), Settings::default());
        self.get_ready();
    }

    fn now(&self) -> Duration {
        Duration::from_secs_f64(self.now_s)
    }

    pub fn act(&mut self, actions: Vec<Action>) {
        for action in actions {
            match action {
                Action::Write(bytes) => self.to_board.extend(bytes),
                Action::Event(event) => {
                    if let Event::Ended(ending) = &event {
                        self.ending = Some(ending.clone());
                    }
                    self.events.push(event);
                }
            }
        }
    }

    pub fn step(&mut self) {
        self.now_s += TICK_S;
        let now = self.now();
        let bytes = std::mem::take(&mut self.to_board);
        let answer = self.board.step(self.now_s, &bytes);
        let halted = matches!(self.board.state(), State::Hold | State::Door | State::Alarm | State::Sleep);
        match self.halts.last_mut() {
            Some(halt) if halt.to_s == self.now_s - TICK_S && halted => halt.to_s = self.now_s,
            _ if halted => self.halts.push(Halt { from_s: self.now_s, to_s: self.now_s }),
            _ => {}
        }
        if !answer.is_empty() {
            let actions = self.session.on_bytes(now, &answer);
            self.act(actions);
        }
        let actions = self.session.on_tick(now);
        self.act(actions);
    }

    pub fn until(&mut self, limit_s: f64, done: impl Fn(&Bench) -> bool) -> bool {
        let end_s = self.now_s + limit_s;
        while self.now_s < end_s && !done(self) {
            self.step();
        }
        done(self)
    }

    pub fn wait(&mut self, seconds: f64) {
        self.until(seconds, |_| false);
    }

    pub fn command(&mut self, command: Command) {
        let actions = self.session.command(self.now(), command);
        self.act(actions);
    }

    pub fn run(&mut self, text: &str) {
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        self.command(Command::Run { lines: Box::new(lines.into_iter().map(Ok)) });
    }

    /// Lit longer than it takes to brake and 50 ms after the board was halted: when, s.
    pub fn lit_after_halt(&self) -> Option<f64> {
        // Slowest axis of the board, mm/s².
        const BRAKE_MM_PER_S2: f64 = 500.0;
        self.halts.iter().find_map(|halt| {
            let speed_at = |s: &&Segment| s.start_s <= halt.from_s && halt.from_s < s.end_s;
            let speed = self.board.trace().iter().find(speed_at).map_or(0.0, |s| s.start_mm_per_s.max(s.end_mm_per_s));
            let dark_s = halt.from_s + speed / BRAKE_MM_PER_S2 + 0.05;
            let lit = |s: &&Segment| s.is_lit() && s.end_s > dark_s && s.start_s < halt.to_s;
            self.board.trace().iter().find(lit).map(|s| s.end_s)
        })
    }
}
