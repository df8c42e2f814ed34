//! A board, a session and a journal's last word on one virtual clock.

use furbelow::emulator::{Board, Segment, State};
use furbelow::stream::{Action, Command, Ending, Event, Progress, Session, Settings, Status, Trouble};
use std::time::Duration;

/// How often the session is told the time, s.
const TICK_S: f64 = 0.004;

/// Acceleration of the slowest axis, mm/s2.
const BRAKE_MM_PER_S2: f64 = 500.0;

/// Board and session.
pub struct Rig {
    pub board: Board,
    pub now_s: f64,
    session: Session,
    to_board: Vec<u8>,
    /// The sender is alive and its cable is in.
    pub connected: bool,
    /// The last report, and how far the job had come as it said.
    pub status: Option<Status>,
    pub progress: Progress,
    /// Bytes that have gone to the board and come from it.
    pub bytes: [u64; 2],
    /// Reports so far.
    pub reports: usize,
    pub ending: Option<Ending>,
    pub trouble: Option<Trouble>,
    /// Since when the board has been halted, its speed then in mm/s, and the last instant at which the beam was lit since.
    halted: Option<(f64, f64)>,
    /// The longest the beam was lit beyond the time it takes to brake, after the board was told to stop, s.
    pub lit_late_s: f64,
}

impl Rig {
    /// A board that is opened, homed and idle.
    pub fn homed(board: Board) -> Rig {
        let mut rig = Rig {
            board,
            now_s: 0.0,
            session: Session::new(Duration::ZERO, Settings::default()),
            to_board: Vec::new(),
            connected: true,
            status: None,
            progress: Progress::default(),
            bytes: [0; 2],
            reports: 0,
            ending: None,
            trouble: None,
            halted: None,
            lit_late_s: 0.0,
        };
        rig.home();
        rig
    }

    /// Another session opens the port, and homes.
    pub fn reopen(&mut self) {
        assert!(self.board.open(self.now_s), "it is plugged in");
        self.session = Session::new(self.now(), Settings::default());
        self.to_board.clear();
        (self.connected, self.status, self.progress, self.ending, self.trouble) =
            (true, None, Progress::default(), None, None);
        self.home();
    }

    fn home(&mut self) {
        assert!(self.until(20.0, |rig| rig.session.is_ready()), "a board that answers");
        self.wait(0.5);
        self.command(Command::Home);
        assert!(self.until(60.0, |rig| rig.session.board().homed), "home: {:?}", self.status);
        let before = self.reports;
        assert!(self.until(5.0, |rig| rig.reports > before + 1), "a report");
    }

    fn now(&self) -> Duration {
        Duration::from_secs_f64(self.now_s)
    }

    fn act(&mut self, actions: Vec<Action>) {
        for action in actions {
            match action {
                Action::Write(bytes) => self.to_board.extend(bytes),
                Action::Event(Event::Status(status, progress)) => {
                    (self.status, self.progress) = (Some(status), progress);
                    self.reports += 1;
                }
                Action::Event(Event::Ended(ending)) => self.ending = Some(ending),
                Action::Event(Event::Trouble(trouble)) if self.trouble.is_none() => self.trouble = Some(trouble),
                Action::Event(_) => {}
            }
        }
    }

    /// A tick goes by.
    pub fn step(&mut self) {
        self.now_s += TICK_S;
        let bytes = std::mem::take(&mut self.to_board);
        let answer = self.board.step(self.now_s, if self.connected { &bytes } else { &[] });
        self.bytes = [self.bytes[0] + bytes.len() as u64, self.bytes[1] + answer.len() as u64];
        self.watch_beam();
        if !self.connected {
            return;
        }
        let now = self.now();
        if !answer.is_empty() {
            let actions = self.session.on_bytes(now, &answer);
            self.act(actions);
        }
        let actions = self.session.on_tick(now);
        self.act(actions);
    }

    fn watch_beam(&mut self) {
        let halted = matches!(self.board.state(), State::Hold | State::Door | State::Alarm | State::Sleep);
        if !halted {
            self.halted = None;
            return;
        }
        let last = self.board.trace().last();
        let speed = |s: &Segment| s.start_mm_per_s.max(s.end_mm_per_s);
        // A tick before the state was seen it may just have begun to brake.
        let (from_s, fastest) = *self.halted.get_or_insert((self.now_s, last.map_or(0.0, speed)));
        let lit_until_s = last.filter(|s| s.is_lit()).map_or(0.0, |s| s.end_s);
        self.lit_late_s = self.lit_late_s.max(lit_until_s - from_s - fastest / BRAKE_MM_PER_S2);
    }

    pub fn until(&mut self, limit_s: f64, done: impl Fn(&Rig) -> bool) -> bool {
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

    /// Begins to send a program.
    pub fn send(&mut self, text: &str) {
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let lines = Box::new(lines.into_iter().map(Ok));
        self.command(Command::Run { lines });
    }

    /// The system notices that the port is gone.
    pub fn lose_link(&mut self) {
        let actions = self.session.on_link_lost(self.now(), "unplugged");
        self.act(actions);
        self.connected = false;
    }
}
