//! One board, one job at a time, as a state machine without clock, port or thread.
//!
//! ```text
//! Opening --banner, or answer to a probe--> Asking --$I $$ $# $G answered--> Ready <--> a job in it
//!                                                                             |
//!                                                      stop or trouble: Braking (!) --rest--> Resetting (^X) --banner--> Ready
//! ```
//!
//! Time is what callers say it is: a [`Duration`] since any moment of their choice, never running backwards.

mod checking;
mod modes;
mod place;
mod replies;
#[cfg(test)]
mod scripted;
mod sending;
mod stopping;
#[cfg(test)]
mod tests;
mod watch;

use std::collections::VecDeque;
use std::time::Duration;

use super::board::Board;
use super::course::Course;
use super::event::{Action, Command, Event, Lines};
use super::ledger::{Ledger, Progress};
use super::overrides::Overrides;
use super::realtime;
use super::sendable::Sendable;
use super::status::{State, Status};
use super::trouble::Trouble;
use super::window::Window;
use crate::gcode::Interpreter;

/// A line of a board's that is longer is noise: the longest real one, `$` help, has under 200 bytes.
const MAX_LINE_BYTES: usize = 1024;

/// Patience, and what may be done to a board that does not speak.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Between two questions for status; boards bear 5 to 10 a second.
    pub status_every: Duration,
    /// How long to wait for a banner after opening: the boot loader of an Arduino takes 1.7 s.
    pub banner_wait: Duration,
    /// After this long without a byte the board is taken for silent.
    pub silent_after: Duration,
    /// How long the machine may rest with a line unanswered, beyond the dwells it was sent.
    pub answer_wait: Duration,
    /// How long braking may take before the board is reset all the same.
    pub stop_wait: Duration,
    /// How long homing may take, in which GRBL answers nothing.
    pub homing_wait: Duration,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            status_every: Duration::from_millis(150),
            banner_wait: Duration::from_secs(3),
            silent_after: Duration::from_secs(2),
            answer_wait: Duration::from_secs(1),
            stop_wait: Duration::from_secs(5),
            homing_wait: Duration::from_secs(180),
        }
    }
}

/// Where a session stands.
#[derive(Debug)]
enum Phase {
    /// Waits for the board to speak; `probed` when it was asked to.
    Opening { since: Duration, probed: Option<Duration> },
    /// The first questions are being answered.
    Asking,
    /// Takes commands; a job may run.
    Ready,
    /// On the way to a safe end.
    Stopping(stopping::Stopping),
    /// The board does not answer or the port is gone.
    Lost,
}

/// A program on its way.
struct Job {
    lines: Lines,
    /// Lines read from it.
    number: usize,
    /// Read and not sent, with its line in the file.
    next: Option<(usize, Sendable)>,
    /// All lines are read.
    read: bool,
    /// What follows the last line has been sent: the laser off, or the way out of check mode.
    closed: bool,
    /// The board only reads it.
    check: Option<checking::Checking>,
    ledger: Ledger,
    /// The way it takes; `None` before the first report tells where it begins.
    course: Option<Course>,
}

/// Talks to one board.
pub struct Session {
    settings: Settings,
    phase: Phase,
    board: Board,
    status: Option<Status>,
    /// The modes in effect; `None` when they are not known.
    modes: Option<Interpreter>,
    /// The beginning of a line that has not come whole.
    partial: Vec<u8>,
    window: Window,
    /// Lines that go one by one, each when nothing is under way.
    alone: VecDeque<String>,
    job: Option<Job>,
    overrides: Overrides,
    /// When the last byte came.
    heard: Duration,
    /// When status was last asked for.
    polled: Option<Duration>,
    /// Since when the machine rests with lines unanswered.
    idle_since: Option<Duration>,
    /// Reports of rest since a line was last sent.
    rest_reports: u32,
    /// An alarm has sounded after which only a reset helps.
    deaf: bool,
    /// Silence has been told.
    silence_told: bool,
    now: Duration,
    out: Vec<Action>,
}

impl Session {
    /// A session whose port was opened at `now`.
    pub fn new(now: Duration, settings: Settings) -> Session {
        Session {
            settings,
            phase: Phase::Opening { since: now, probed: None },
            board: Board::default(),
            status: None,
            modes: None,
            partial: Vec::new(),
            window: Window::default(),
            alone: VecDeque::new(),
            job: None,
            overrides: Overrides::default(),
            heard: now,
            polled: None,
            idle_since: None,
            rest_reports: 0,
            deaf: false,
            silence_told: false,
            now,
            out: Vec::new(),
        }
    }

    /// What is known of the board.
    pub fn board(&self) -> &Board {
        &self.board
    }

    /// True when a job can be started.
    pub fn is_ready(&self) -> bool {
        matches!(self.phase, Phase::Ready) && self.job.is_none()
    }

    /// True while a job runs or something is being stopped.
    pub fn is_busy(&self) -> bool {
        self.job.is_some() || matches!(self.phase, Phase::Stopping(_))
    }

    /// How far the job has come.
    pub(super) fn progress(&self) -> Progress {
        self.job.as_ref().map(|job| job.ledger.progress()).unwrap_or_default()
    }

    /// Bytes have come.
    pub fn on_bytes(&mut self, now: Duration, bytes: &[u8]) -> Vec<Action> {
        self.now = now;
        if !bytes.is_empty() {
            self.heard = now;
            self.silence_told = false;
        }
        for byte in bytes {
            match byte {
                b'\n' => {
                    let line = std::mem::take(&mut self.partial);
                    self.on_line(&String::from_utf8_lossy(&line));
                }
                _ if self.partial.len() < MAX_LINE_BYTES => self.partial.push(*byte),
                _ => {}
            }
        }
        self.fill();
        std::mem::take(&mut self.out)
    }

    /// Time has passed; call at least every 50 ms.
    pub fn on_tick(&mut self, now: Duration) -> Vec<Action> {
        self.now = now;
        self.watch();
        self.fill();
        std::mem::take(&mut self.out)
    }

    /// The port failed: nothing can be written any more.
    pub fn on_link_lost(&mut self, now: Duration, reason: &str) -> Vec<Action> {
        self.now = now;
        let trouble = Trouble::Link(reason.to_owned());
        self.tell(Event::Trouble(trouble.clone()));
        self.lose(trouble);
        std::mem::take(&mut self.out)
    }

    /// The user asks for something.
    pub fn command(&mut self, now: Duration, command: Command) -> Vec<Action> {
        self.now = now;
        match command {
            Command::Hold => self.byte(realtime::HOLD),
            Command::Door => self.byte(realtime::DOOR),
            Command::Resume if matches!(self.phase, Phase::Stopping(_)) => {
                self.tell(Event::Denied("the job is being stopped"));
            }
            Command::Resume => self.byte(realtime::RESUME),
            Command::JogCancel => self.cancel_jogs(),
            Command::Override(which, percent) => self.overrides.want(which, percent),
            Command::Stop => self.stop(),
            Command::Reset => self.reset(),
            Command::Close => {
                if self.job.is_some() && !matches!(self.phase, Phase::Stopping(_)) {
                    self.stop();
                } else if self.state() == Some(State::Jog) || self.jogs_wait() {
                    self.cancel_jogs();
                }
            }
            Command::Run { lines } => {
                if self.free_for_orders() {
                    self.start(lines);
                }
            }
            Command::Check { lines } => {
                if self.free_for_orders() {
                    self.start_check(lines);
                }
            }
            Command::Ask => {
                if self.free_for_orders() {
                    self.ask_again();
                }
            }
            Command::Line(line) => self.order(&line),
            Command::Home => self.order("$H"),
            Command::Unlock => self.order("$X"),
            Command::Sleep => self.order("$SLP"),
            Command::Jog { dx_mm, dy_mm, feed_mm_per_min } => {
                self.order(&format!("$J=G91G21X{dx_mm:.3}Y{dy_mm:.3}F{feed_mm_per_min:.0}"));
            }
            Command::JogTo { x_mm, y_mm, feed_mm_per_min } => {
                let word = |axis: char, to: Option<f64>| to.map(|to| format!("{axis}{to:.3}")).unwrap_or_default();
                self.order(&format!("$J=G90G21{}{}F{feed_mm_per_min:.0}", word('X', x_mm), word('Y', y_mm)));
            }
        }
        self.fill();
        std::mem::take(&mut self.out)
    }

    /// Queues a line that goes by itself.
    fn order(&mut self, line: &str) {
        if !self.free_for_orders() {
            return;
        }
        match super::sendable::sendable(line, 1, self.line_limit()) {
            Ok(Some(line)) => self.alone.push_back(line.text),
            Ok(None) => self.tell(Event::Answered { line: String::new(), error: None }),
            Err(trouble) => self.tell(Event::Trouble(trouble)),
        }
    }

    fn jogs_wait(&self) -> bool {
        let waits = self.alone.iter().map(String::as_str).chain(self.window.first().map(|entry| entry.text.as_str()));
        waits.into_iter().any(|line| line.starts_with("$J="))
    }

    fn cancel_jogs(&mut self) {
        self.alone.retain(|line| !line.starts_with("$J="));
        self.byte(realtime::JOG_CANCEL);
    }

    /// Says why not when a line cannot be taken now.
    fn free_for_orders(&mut self) -> bool {
        let reason = match self.phase {
            _ if self.deaf => "the board answers nothing after this alarm: reset it first",
            _ if self.job.is_some() => "a job runs: stop it first",
            Phase::Ready => return true,
            Phase::Stopping(_) => "the machine is being stopped",
            Phase::Opening { .. } | Phase::Asking => "the board has not answered the first questions yet",
            Phase::Lost => "there is no board that answers",
        };
        self.tell(Event::Denied(reason));
        false
    }

    fn start(&mut self, lines: Lines) {
        match self.state() {
            Some(State::Idle | State::Check) => {}
            _ => return self.tell(Event::Denied("the machine is not idle: home, unlock, resume or reset it first")),
        }
        self.begin(lines, None);
    }

    fn begin(&mut self, lines: Lines, check: Option<checking::Checking>) {
        self.idle_since = None;
        self.rest_reports = 0;
        let ledger = Ledger::default();
        // A check moves nothing. A job begins where the next report says that the head is, which is asked for at once.
        let course = check.is_some().then(|| Course::new(None, None, &self.board));
        if course.is_none() {
            self.polled = None;
        }
        self.job = Some(Job { lines, number: 0, next: None, read: false, closed: false, check, ledger, course });
    }

    fn state(&self) -> Option<State> {
        self.status.as_ref().map(|s| s.state)
    }

    fn tell(&mut self, event: Event) {
        self.out.push(Action::Event(event));
    }

    fn byte(&mut self, byte: u8) {
        self.out.push(Action::Write(vec![byte]));
    }
}
