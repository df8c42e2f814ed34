//! What is asked of a board besides cutting, on virtual time against the emulated one: borders traced, programs checked, jogs, work zero.

use furbelow::emulator::{Board, BoardSettings, Fault, Segment, State, When};
use furbelow::gcode::{parse, trace};
use furbelow::stream::{Action, Command, Ending, Event, Extent, Frame, Outcome, Session, Settings, Tracing, Trouble};
use std::time::Duration;

/// How often the session is told the time, s.
const TICK_S: f64 = 0.002;

struct Bench {
    board: Board,
    session: Session,
    now_s: f64,
    to_board: Vec<u8>,
    events: Vec<Event>,
}

impl Bench {
    fn new(hardware: BoardSettings) -> Bench {
        let board = Board::new(hardware);
        let session = Session::new(Duration::ZERO, Settings::default());
        let mut bench = Bench { board, session, now_s: 0.0, to_board: Vec::new(), events: Vec::new() };
        assert!(bench.until(20.0, |b| b.session.is_ready() && b.told_status()), "no board");
        bench.events.clear();
        bench
    }

    fn told_status(&self) -> bool {
        self.events.iter().any(|e| matches!(e, Event::Status(..)))
    }

    fn act(&mut self, actions: Vec<Action>) {
        for action in actions {
            match action {
                Action::Write(bytes) => self.to_board.extend(bytes),
                Action::Event(event) => self.events.push(event),
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

    fn run(&mut self, lines: Vec<String>) {
        self.command(Command::Run { lines: Box::new(lines.into_iter().map(Ok)) });
    }

    fn check(&mut self, text: &str) {
        let lines: Vec<_> = text.lines().map(|line| Ok(line.to_owned())).collect();
        self.command(Command::Check { lines: Box::new(lines.into_iter()) });
    }

    fn ending(&self) -> Option<&Ending> {
        self.events.iter().find_map(|e| if let Event::Ended(ending) = e { Some(ending) } else { None })
    }

    fn end(&mut self, limit_s: f64) -> Ending {
        assert!(self.until(limit_s, |b| b.ending().is_some()), "no end: {:?}", self.events.last());
        self.ending().cloned().expect("just seen")
    }

    /// Lines the board refused, by their numbers.
    fn refused(&self) -> Vec<usize> {
        let line = |e: &Event| match e {
            Event::Trouble(Trouble::Refused { line, .. } | Trouble::TooLong { line, .. }) => Some(*line),
            _ => None,
        };
        let mut lines: Vec<usize> = self.events.iter().filter_map(line).collect();
        lines.sort_unstable();
        lines
    }

    fn is_dark(&self) -> bool {
        self.board.power() == 0.0 && self.board.trace().iter().all(|s| !s.is_lit())
    }
}

fn square() -> Frame {
    let job = "G21G90M4S600\nG0X20Y20\nG1X60F1200\nY50\nX20\nY20\nM5\n";
    let mut extent = Extent::default();
    for m in trace(&parse(job).expect("a program")).expect("moves").iter().filter(|m| m.burns()) {
        extent.add_move(m);
    }
    extent.hull().expect("something burns")
}

fn traced(beam_s: f64) -> Bench {
    let mut bench = Bench::new(BoardSettings::default());
    bench.run(square().lines(Tracing { feed_mm_per_min: 3000.0, beam_s, up_mm: None }));
    assert_eq!(bench.end(60.0).outcome, Outcome::Done);
    bench
}

#[test]
fn a_border_is_traced_dark_along_its_whole_length() {
    let bench = traced(0.0);
    assert!(bench.is_dark());
    let fed: f64 = bench.board.trace().iter().map(|s| s.length_mm()).sum();
    let approach = (2.0_f64 * 20.0 * 20.0).sqrt();
    assert!((fed - 140.0 - approach).abs() < 0.1, "{fed} mm");
}

#[test]
fn a_shown_border_is_never_lit_at_rest_nor_brighter_than_asked_nor_on_the_way_there() {
    let bench = traced(10.0);
    let (lit, dark): (Vec<&Segment>, Vec<&Segment>) = bench.board.trace().iter().partition(|s| s.is_lit());
    let length: f64 = lit.iter().map(|s| s.length_mm()).sum();
    assert!((length - 140.0).abs() < 0.1, "{length} mm are lit");
    for s in &lit {
        assert!(s.length_mm() > 0.0, "lit at rest: {s:?}");
        assert!(s.start_power <= 0.01 + 1e-9 && s.end_power <= 0.01 + 1e-9, "too bright: {s:?}");
        for (speed, power) in [(s.start_mm_per_s, s.start_power), (s.end_mm_per_s, s.end_power)] {
            assert!(speed > 1e-6 || power < 1e-6, "lit at rest: {s:?}");
        }
    }
    let dark_mm: f64 = dark.iter().map(|s| s.length_mm()).sum();
    assert!((dark_mm - (2.0_f64 * 20.0 * 20.0).sqrt()).abs() < 0.1, "{dark_mm} mm are dark");
    assert_eq!(bench.board.power(), 0.0);
}

#[test]
fn a_shown_border_that_is_stopped_darkens_and_keeps_the_place() {
    let mut bench = Bench::new(BoardSettings::default());
    bench.run(square().lines(Tracing { feed_mm_per_min: 1000.0, beam_s: 10.0, up_mm: None }));
    assert!(bench.until(20.0, |b| b.board.power() > 0.0));
    bench.command(Command::Stop);
    let asked_s = bench.now_s;
    let ending = bench.end(5.0);
    assert!(ending.outcome == Outcome::Stopped && ending.position_kept && ending.beam_off, "{ending:?}");
    let last_lit_s = bench.board.trace().iter().filter(|s| s.is_lit()).map(|s| s.end_s).fold(0.0, f64::max);
    // 1,000 mm/min brake at 500 mm/s² within 34 ms.
    assert!(last_lit_s < asked_s + 0.034 + 0.05, "lit until {last_lit_s}, asked at {asked_s}");
    bench.until(3.0, |_| false);
    assert_eq!(bench.board.power(), 0.0);
}

#[test]
fn a_checked_program_moves_and_burns_nothing_and_names_every_line_that_is_refused() {
    let zero = furbelow::geom::V3::new(-7.0, -9.0, 0.0);
    let mut hardware = BoardSettings::default();
    hardware.memory.offsets_mm[0] = zero;
    let mut bench = Bench::new(hardware);
    bench.command(Command::Line("G1X5Y5F6000".into()));
    assert!(bench.until(10.0, |b| b.board.state() == State::Idle && !b.board.is_moving() && b.now_s > 5.0));
    let before = bench.board.position_mm();
    let length = bench.board.trace().len();
    let long = format!("G1X{}", "1".repeat(90));
    bench.check(&format!(
        "; a job\nG21G90M4S500\nG0X10Y10\nG41\nG1X390F1000\nG10L20P1X0Y0\n{long}\n$30=1\nG0X9999\nM6\nG4P30\nM5\nM2\n"
    ));
    let ending = bench.end(20.0);
    assert_eq!(bench.refused(), [4, 7, 10]);
    assert_eq!(ending.outcome, Outcome::Failed(Trouble::CheckRefused { refused: 3 }));
    assert!(ending.position_kept && ending.beam_off && ending.progress.acked == 13, "{ending:?}");
    assert_eq!((bench.board.position_mm(), bench.board.state()), (before, State::Idle));
    assert!(bench.board.trace().len() == length && bench.is_dark(), "something moved");
    assert_eq!(bench.board.settings().get(30), 1000.0, "a check changes no setting");
    let told = bench.events.iter().filter(|e| matches!(e, Event::Message(m) if m.contains("not checked"))).count();
    assert_eq!(told, 2);
    assert_eq!(bench.session.board().offset_mm, Some([-7.0, -9.0, 0.0]), "work zero stays");
    // And the session goes on as if nothing had been.
    bench.events.clear();
    assert!(bench.until(2.0, Bench::told_status));
    bench.run(vec!["G1X9F6000".into()]);
    assert_eq!(bench.end(10.0).outcome, Outcome::Done);
}

#[test]
fn a_program_the_board_takes_passes_and_a_long_one_streams() {
    let mut bench = Bench::new(BoardSettings::default());
    let text: String = (0..3000).map(|k| format!("G1X{}Y{}F3000S100\n", k % 7, k % 11)).collect();
    let began_s = bench.now_s;
    bench.check(&text);
    let ending = bench.end(60.0);
    assert_eq!((ending.outcome, ending.progress.executed), (Outcome::Done, 3000));
    assert_eq!(bench.board.bytes_lost(), 0);
    // The controller reads some 270 lines a second.
    assert!(bench.now_s - began_s < 3000.0 * 0.0045, "{} s", bench.now_s - began_s);
}

#[test]
fn a_check_that_is_stopped_or_meets_a_fault_never_moves_the_machine() {
    let text: String = (0..3000).map(|k| format!("G1X{}Y{}F3000S100\n", k % 7, k % 11)).collect();
    let text = format!("M3\n{text}");
    for fault in [None, Some(Fault::Reset), Some(Fault::StuckOk(1)), Some(Fault::DropOut(3)), Some(Fault::TornLine)] {
        let mut bench = Bench::new(BoardSettings::default());
        if let Some(fault) = fault {
            bench.board.schedule(When::At(bench.now_s + 2.0), fault);
        }
        bench.check(&text);
        bench.until(2.0, |_| false);
        if fault.is_none() {
            bench.command(Command::Stop);
        }
        let ending = bench.end(60.0);
        assert_eq!(ending.outcome == Outcome::Stopped, fault.is_none(), "{fault:?}: {ending:?}");
        bench.until(5.0, |_| false);
        assert!(bench.board.trace().is_empty() && bench.board.power() == 0.0, "{fault:?}: something moved");
        assert_eq!(bench.board.state(), State::Idle, "{fault:?}");
    }
}

#[test]
fn check_mode_switched_off_behind_the_checks_back_ends_it_before_a_line_moves_anything() {
    // The board is in check mode already, so that the first $C switches it off.
    let mut bench = Bench::new(BoardSettings::default());
    bench.board.step(bench.now_s, b"$C\n");
    bench.check("G1X50F1000\n");
    let ending = bench.end(10.0);
    assert!(matches!(ending.outcome, Outcome::Failed(_)), "{ending:?}");
    bench.until(3.0, |_| false);
    assert!(bench.board.trace().is_empty());
}

#[test]
fn a_jog_goes_so_far_and_is_ended_on_the_way() {
    let mut bench = Bench::new(BoardSettings::default());
    bench.command(Command::Jog { dx_mm: -30.0, dy_mm: 0.5, feed_mm_per_min: 3000.0 });
    assert!(bench.until(10.0, |b| b.board.state() == State::Jog));
    assert!(bench.until(10.0, |b| b.board.state() == State::Idle));
    assert!((bench.board.position_mm() - furbelow::geom::P3::new(-30.0, 0.5, 0.0)).norm() < 0.01);
    bench.command(Command::JogTo { x_mm: Some(-100.0), y_mm: None, feed_mm_per_min: 600.0 });
    bench.command(Command::Jog { dx_mm: 0.0, dy_mm: -50.0, feed_mm_per_min: 600.0 });
    bench.until(1.0, |_| false);
    bench.command(Command::JogCancel);
    assert!(bench.until(2.0, |b| b.board.state() == State::Idle && !b.board.is_moving()));
    bench.until(2.0, |_| false);
    let at = bench.board.position_mm();
    assert!(at.x < -30.0 && at.x > -60.0 && (at.y - 0.5).abs() < 0.01, "{at}");
}

#[test]
fn whoever_leaves_in_the_middle_of_a_jog_ends_it() {
    let mut bench = Bench::new(BoardSettings::default());
    bench.command(Command::Jog { dx_mm: -300.0, dy_mm: 0.0, feed_mm_per_min: 600.0 });
    bench.until(1.0, |_| false);
    bench.command(Command::Close);
    assert!(bench.until(2.0, |b| !b.board.is_moving()));
    assert!(bench.board.position_mm().x > -30.0);
}
