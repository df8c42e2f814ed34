//! A session against the emulated board, both on virtual time: nothing is lost or doubled unnoticed, and the beam goes out.

use furbelow::emulator::{Board, BoardSettings, Fault, When};
use furbelow::stream::{Action, Command, Ending, Event, Outcome, Session, Settings};
use std::time::Duration;

const JOBS: [(&str, &str); 5] = [
    ("a-rectangles", include_str!("planner_truth/a-rectangles.nc")),
    ("b-ribbons-1mm", include_str!("planner_truth/b-ribbons-1mm.nc")),
    ("e-arcs", include_str!("planner_truth/e-arcs.nc")),
    ("f-slits-toggle", include_str!("planner_truth/f-slits-toggle.nc")),
    ("g-zigzag", include_str!("planner_truth/g-zigzag.nc")),
];
/// How often the session is told the time, s.
const TICK_S: f64 = 0.002;

/// A board and a session on one clock.
struct Bench {
    board: Board,
    session: Session,
    now_s: f64,
    to_board: Vec<u8>,
    ending: Option<Ending>,
    denied: bool,
}

impl Bench {
    fn new() -> Bench {
        Bench {
            board: Board::new(BoardSettings::default()),
            session: Session::new(Duration::ZERO, Settings::default()),
            now_s: 0.0,
            to_board: Vec::new(),
            ending: None,
            denied: false,
        }
    }

    fn act(&mut self, actions: Vec<Action>) {
        for action in actions {
            match action {
                Action::Write(bytes) => self.to_board.extend(bytes),
                Action::Event(Event::Ended(ending)) => self.ending = Some(ending),
                Action::Event(Event::Denied(_)) => self.denied = true,
                Action::Event(_) => {}
            }
        }
    }

    fn step(&mut self) {
        self.now_s += TICK_S;
        let now = Duration::from_secs_f64(self.now_s);
        let bytes = std::mem::take(&mut self.to_board);
        let answer = self.board.step(self.now_s, &bytes);
        if !answer.is_empty() {
            let actions = self.session.on_bytes(now, &answer);
            self.act(actions);
        }
        let actions = self.session.on_tick(now);
        self.act(actions);
    }

    fn until(&mut self, limit_s: f64, done: impl Fn(&Bench) -> bool) -> bool {
        let end_s = self.now_s + limit_s;
        while self.now_s < end_s && !done(self) {
            self.step();
        }
        done(self)
    }

    fn command(&mut self, command: Command) {
        let actions = self.session.command(Duration::from_secs_f64(self.now_s), command);
        self.act(actions);
    }

    /// Brings the board to where a job may start.
    fn ready() -> Bench {
        let mut bench = Bench::new();
        assert!(bench.until(20.0, |b| b.session.is_ready()), "no board");
        bench.command(Command::Unlock);
        assert!(bench.until(5.0, |b| !b.session.is_busy()));
        bench
    }

    fn run(&mut self, text: &'static str) {
        let lines = text.lines().map(|line| Ok(line.to_owned()));
        self.command(Command::Run { lines: Box::new(lines), ends_at_mm: None });
    }
}

/// Length of what was burnt, mm.
fn burnt_mm(board: &Board) -> f64 {
    board.trace().iter().filter(|s| s.is_lit()).map(|s| s.length_mm()).sum()
}

#[test]
fn the_measured_jobs_arrive_whole_and_are_burnt_as_they_are_written() {
    for (name, text) in JOBS {
        let mut bench = Bench::ready();
        bench.run(text);
        assert!(bench.until(400.0, |b| b.ending.is_some()), "{name} does not end");
        let ending = bench.ending.clone().expect("ended");
        assert_eq!(ending.outcome, Outcome::Done, "{name}: {ending:?}");
        assert_eq!(bench.board.bytes_lost(), 0, "{name}");
        assert!(ending.beam_off && bench.board.power() == 0.0 && !bench.board.is_moving(), "{name}: {ending:?}");
        let report = furbelow::gcode::trace(&furbelow::gcode::parse(text).expect("a program")).expect("moves");
        let written: f64 = report.iter().filter(|m| m.burns()).map(|m| m.length_mm()).sum();
        let burnt = burnt_mm(&bench.board);
        assert!((burnt / written - 1.0).abs() < 0.02, "{name}: {burnt} mm of {written} mm");
    }
}

#[test]
fn a_stop_brakes_and_darkens_and_keeps_the_position() {
    for after_s in [3.0, 7.3, 11.9] {
        let mut bench = Bench::ready();
        bench.run(JOBS[0].1);
        bench.until(after_s, |_| false);
        bench.command(Command::Stop);
        let asked_s = bench.now_s;
        assert!(bench.until(20.0, |b| b.ending.is_some()));
        let ending = bench.ending.clone().expect("ended");
        assert_eq!(ending.outcome, Outcome::Stopped, "{ending:?}");
        assert!(ending.position_kept && ending.beam_off, "{ending:?}");
        // The fastest move brakes from 10,000 mm/min at 500 mm/s² within a third of a second.
        let last_lit = bench.board.trace().iter().filter(|s| s.is_lit()).map(|s| s.end_s).fold(0.0, f64::max);
        assert!(last_lit < asked_s + 0.34 + 0.05, "lit until {last_lit}, asked at {asked_s}");
        bench.until(5.0, |_| false);
        assert_eq!(bench.board.power(), 0.0);
    }
}

#[test]
fn lines_lost_or_spoilt_on_the_way_never_pass_for_done() {
    let clean = {
        let mut bench = Bench::ready();
        bench.run(JOBS[4].1);
        assert!(bench.until(200.0, |b| b.ending.is_some()));
        burnt_mm(&bench.board)
    };
    let mut outcomes = [0; 2];
    let mut seed = 0x9E37_79B9_7F4A_7C15_u64;
    for run in 0..RUNS {
        let mut random = |n: u64| {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            seed % n
        };
        let fault = match random(5) {
            0 => Fault::DropOut(1 + random(8) as u32),
            1 => Fault::StuckOk(1),
            2 => Fault::TornLine,
            3 => Fault::Unplug { powered: random(2) == 0 },
            _ => Fault::Reset,
        };
        let mut bench = Bench::ready();
        let at_s = bench.now_s + 0.5 + random(20_000) as f64 / 1000.0;
        bench.board.schedule(When::At(at_s), fault);
        bench.run(JOBS[4].1);
        let place = format!("run {run}, {fault:?} at {at_s:.3} s");
        let ended = bench.until(200.0, |b| b.ending.is_some() || !b.board.is_plugged());
        assert!(ended, "{place}: neither done nor given up");
        if bench.ending.is_none() {
            // The system notices a pulled plug.
            let actions = bench.session.on_link_lost(Duration::from_secs_f64(bench.now_s), "unplugged");
            bench.act(actions);
            bench.until(120.0, |_| false);
        }
        let ending = bench.ending.clone().unwrap_or_else(|| panic!("{place}: no account"));
        if ending.outcome == Outcome::Done {
            outcomes[0] += 1;
            let burnt = burnt_mm(&bench.board);
            assert!((burnt / clean - 1.0).abs() < 1e-6, "{place}: done, but {burnt} mm of {clean} mm are burnt");
        } else {
            outcomes[1] += 1;
            assert!(ending.progress.executed <= ending.maybe, "{place}: {ending:?}");
        }
        bench.until(3.0, |_| false);
        assert_eq!(bench.board.power(), 0.0, "{place}: the beam is on");
    }
    assert!(outcomes.iter().all(|n| *n > RUNS / 50), "{outcomes:?}: faults that do nothing, or nothing else");
}

/// Seeded fault runs.
const RUNS: usize = 2000;
