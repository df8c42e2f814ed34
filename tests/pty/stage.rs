//! A served board, a link to it, and what both have said.

use furbelow::emulator::{Board, BoardSettings, Fault, Memory, Segment, Settings as BoardNumbers, State, When};
use furbelow::geom::V3;
use furbelow::stream::{Address, Command, Ending, Event, Link, Outcome, ServedBoard, Settings, Status, Trouble};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Nothing here takes longer, unless it never comes.
const PATIENCE: Duration = Duration::from_secs(20);

/// One scenario.
pub struct Case {
    pub name: &'static str,
    pub board: fn() -> BoardSettings,
    pub play: fn(&mut Stage),
}

/// Patience of a session, short enough for tests and long enough for a busy computer.
fn settings() -> Settings {
    Settings {
        status_every: Duration::from_millis(50),
        banner_wait: Duration::from_millis(1200),
        silent_after: Duration::from_millis(1500),
        answer_wait: Duration::from_millis(700),
        stop_wait: Duration::from_millis(2000),
        homing_wait: Duration::from_secs(20),
    }
}

/// A fast machine on a board that is soon there, with settings changed.
pub fn board_with(changes: &[(u16, f64)]) -> BoardSettings {
    let settings = changes.iter().fold(BoardNumbers::default(), |s, (n, value)| s.with(*n, *value));
    BoardSettings { settings, boot_s: 0.05, ..BoardSettings::default() }
}

pub fn plain() -> BoardSettings {
    board_with(&[])
}

/// Homing and soft limits; it homes to a corner nearby at 100 mm/s, and work zero lies 90 mm inside.
pub fn limited() -> BoardSettings {
    let mut memory = Memory::default();
    memory.offsets_mm[0] = V3::new(-90.0, -90.0, 0.0);
    BoardSettings { memory, ..board_with(&[(22, 1.0), (20, 1.0), (23, 0.0), (24, 600.0), (25, 6000.0), (132, 5.0)]) }
}

/// A cut of two seconds from X2 on, at 20 mm/s.
pub const LONG_CUT: &str = "M4S500\nG0X2F1200\nG1X42\nM5S0\n";

/// A square of 8 mm in half a second.
pub const SQUARE: &str = "M4S500\nG0X1Y1\nG1X3F3000\nY3\nX1\nY1\nM5S0\nG0X0Y0\n";

pub struct Stage {
    pub served: ServedBoard,
    seen: Arc<Mutex<Vec<Segment>>>,
    link: Option<Link>,
    pub events: Vec<Event>,
}

impl Stage {
    pub fn new(board: BoardSettings) -> Stage {
        let seen: Arc<Mutex<Vec<Segment>>> = Arc::default();
        let noting = Arc::clone(&seen);
        let note = move |trace: Vec<Segment>| noting.lock().unwrap().extend(trace);
        let served = ServedBoard::start(Board::new(board), note).unwrap();
        Stage { served, seen, link: None, events: Vec::new() }
    }

    /// Opens the port, as soon as it is there, and starts a session on it.
    pub fn open(&mut self) {
        let address = Address::Device(self.served.path().to_owned());
        let port = Stage::until("the port", || address.open(115_200).ok());
        self.link = Some(Link::start(port, settings()));
    }

    /// Opens the port and waits until a job can start, unlocking the board where it is locked.
    pub fn ready(&mut self) {
        self.events.clear();
        self.open();
        self.event("ready", |e| matches!(e, Event::Ready(_)));
        if self.status("a first report", |_| true).state == furbelow::stream::State::Alarm {
            self.give(Command::Unlock);
        }
        self.state(furbelow::stream::State::Idle);
    }

    /// Ends the session, which closes the port.
    pub fn close(&mut self) {
        if let Some(link) = self.link.take() {
            self.let_go(link);
        }
    }

    /// Drops what holds the port, and waits until the board has noticed and waits on another terminal.
    pub fn let_go<T>(&mut self, holder: T) {
        let terminal = |served: &ServedBoard| served.path().canonicalize().ok();
        let before = terminal(&self.served);
        drop(holder);
        let served = &self.served;
        Stage::until("another terminal", || (terminal(served) != before || before.is_none()).then_some(()));
    }

    pub fn give(&mut self, command: Command) {
        self.link.as_ref().unwrap().command(command);
    }

    pub fn send(&mut self, text: &str) {
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        self.give(Command::Run { lines: Box::new(lines.into_iter().map(Ok)) });
    }

    fn until<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
        let end = Instant::now() + PATIENCE;
        loop {
            if let Some(found) = look() {
                return found;
            }
            assert!(Instant::now() < end, "{what} never came");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// The next event that is so.
    pub fn event(&mut self, what: &str, is: impl Fn(&Event) -> bool) -> Event {
        let end = Instant::now() + PATIENCE;
        while Instant::now() < end {
            if let Some((_, event)) = self.link.as_ref().unwrap().next(Duration::from_millis(50)) {
                self.events.push(event.clone());
                if is(&event) {
                    return event;
                }
            }
        }
        panic!("{what} never came; last of all {:?}", self.events.iter().rev().take(3).collect::<Vec<_>>());
    }

    pub fn status(&mut self, what: &str, is: impl Fn(&Status) -> bool) -> Status {
        let event = self.event(what, |e| matches!(e, Event::Status(status, _) if is(status)));
        let Event::Status(status, _) = event else { unreachable!() };
        status
    }

    pub fn state(&mut self, state: furbelow::stream::State) {
        self.status(&format!("{state:?}"), |s| s.state == state);
    }

    pub fn ending(&mut self) -> Ending {
        let Event::Ended(ending) = self.event("an end", |e| matches!(e, Event::Ended(_))) else { unreachable!() };
        ending
    }

    /// The job ends well and burns so many mm.
    pub fn done(&mut self, burnt_mm: f64) {
        let ending = self.ending();
        assert_eq!(ending.outcome, Outcome::Done, "{ending:?}");
        assert!(ending.beam_off && ending.position_kept, "{ending:?}");
        let ours_mm = self.burnt_mm();
        assert!((ours_mm - burnt_mm).abs() < 0.01, "{ours_mm} mm of {burnt_mm} mm");
    }

    pub fn trouble(&mut self) -> Trouble {
        match self.ending().outcome {
            Outcome::Failed(trouble) => trouble,
            outcome => panic!("it should have failed: {outcome:?}"),
        }
    }

    /// An order is answered with this error, or `ok`.
    pub fn order(&mut self, command: Command, error: Option<u16>) {
        self.give(command);
        let answered = self.event("an answer", |e| matches!(e, Event::Answered { .. }));
        assert!(matches!(answered, Event::Answered { error: e, .. } if e == error), "{answered:?}");
    }

    pub fn denied(&mut self, command: Command) {
        self.give(command);
        self.event("a no", |e| matches!(e, Event::Denied(_)));
    }

    /// The board restarts as asked and is unlocked.
    pub fn restart(&mut self) {
        self.give(Command::Reset);
        self.event("the banner", |e| matches!(e, Event::Restarted));
        self.order(Command::Unlock, None);
        self.state(furbelow::stream::State::Idle);
    }

    /// In the middle of the long cut.
    pub fn cutting(&mut self) {
        self.ready();
        self.send(LONG_CUT);
        self.lit();
    }

    /// Strikes the board now.
    pub fn strike(&mut self, fault: Fault) {
        self.served.with(|board, now_s| board.schedule(When::At(now_s), fault));
    }

    /// Waits until the beam is lit and the head moves.
    pub fn lit(&mut self) {
        let served = &self.served;
        Stage::until("light", || served.with(|b, _| b.power() > 0.0 && b.is_moving()).then_some(()));
    }

    /// Waits until the board is in a state.
    pub fn board_is(&mut self, state: State) {
        let served = &self.served;
        Stage::until(&format!("{state:?}"), || served.with(|b, _| b.state() == state).then_some(()));
    }

    pub fn burnt_mm(&self) -> f64 {
        self.seen.lock().unwrap().iter().filter(|s| s.is_lit()).map(Segment::length_mm).sum()
    }

    /// A stop that was asked for now is over in time: 20 mm/s are braked in 0.04 s; the rest is what a busy computer needs.
    pub fn dark_soon(&mut self) {
        const BUSY_S: f64 = 1.0;
        let now_s = self.served.with(|_, now_s| now_s);
        self.ending();
        let lit_s = self.seen.lock().unwrap().iter().filter(|s| s.is_lit()).map(|s| s.end_s).fold(0.0, f64::max);
        assert!(lit_s < now_s + 0.04 + 0.05 + BUSY_S, "lit until {lit_s}, asked at {now_s}");
    }

    /// Whatever happened, the machine comes to rest with the beam off, also when the session has gone.
    pub fn ends_dark(&mut self) {
        self.close();
        let served = &self.served;
        Stage::until("rest", || served.with(|b, _| !b.is_moving()).then_some(()));
        std::thread::sleep(Duration::from_millis(50));
        served.with(|board, _| assert!(board.power() == 0.0 && !board.is_moving(), "lit at the end"));
    }
}
