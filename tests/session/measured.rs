//! The jobs that were measured on GRBL, sent and stopped.

use furbelow::emulator::BoardSettings;
use furbelow::stream::{Command, Outcome};

use super::bench::Bench;
use super::burn::{burnt_mm, planned_mm};

const JOBS: [(&str, &str); 5] = [
    ("a-rectangles", include_str!("../planner_truth/a-rectangles.nc")),
    ("b-ribbons-1mm", include_str!("../planner_truth/b-ribbons-1mm.nc")),
    ("e-arcs", include_str!("../planner_truth/e-arcs.nc")),
    ("f-slits-toggle", include_str!("../planner_truth/f-slits-toggle.nc")),
    ("g-zigzag", include_str!("../planner_truth/g-zigzag.nc")),
];

#[test]
fn the_measured_jobs_arrive_whole_and_are_burnt_as_they_are_written() {
    for (name, text) in JOBS {
        let mut bench = Bench::ready(BoardSettings::default());
        bench.run(text);
        assert!(bench.until(400.0, |b| b.ending.is_some()), "{name} does not end");
        let ending = bench.ending.clone().expect("ended");
        assert_eq!(ending.outcome, Outcome::Done, "{name}: {ending:?}");
        assert_eq!(bench.board.bytes_lost(), 0, "{name}");
        assert!(ending.beam_off && bench.board.power() == 0.0 && !bench.board.is_moving(), "{name}: {ending:?}");
        let (written, burnt) = (planned_mm(text), burnt_mm(bench.board.trace()));
        // Arcs are burnt in chords.
        assert!((burnt / written - 1.0).abs() < 1e-3, "{name}: {burnt} mm of {written} mm");
    }
}

/// Share of the feed that short segments must hold when characters are counted.
const HELD_SHARE: f64 = 0.98;

#[test]
fn segments_of_a_fifth_of_a_millimetre_hold_their_feed() {
    let (segment_mm, feed) = (0.2, 3000.0);
    let at = |k: u32| segment_mm * f64::from(k) / 50.0;
    let lines: String = (1..=2000).map(|k| format!("X{:.3}Y{:.3}\n", 50.0 * at(k).cos(), 50.0 * at(k).sin())).collect();
    let mut bench = Bench::ready(BoardSettings::default());
    bench.run(&format!("M4S500\nG0X50Y0\nG1F{feed}\n{lines}"));
    assert!(bench.until(100.0, |b| b.ending.is_some()));
    let lit_s: f64 = bench.board.trace().iter().filter(|s| s.is_lit()).map(|s| s.end_s - s.start_s).sum();
    let share = 2000.0 * segment_mm * 60.0 / lit_s / feed;
    assert!(share >= HELD_SHARE, "{share}");
}

#[test]
fn a_stop_brakes_and_darkens_and_keeps_the_position() {
    for after_s in [3.0, 7.3, 11.9] {
        let mut bench = Bench::ready(BoardSettings::default());
        bench.run(JOBS[0].1);
        bench.wait(after_s);
        bench.command(Command::Stop);
        let asked_s = bench.now_s;
        assert!(bench.until(20.0, |b| b.ending.is_some()));
        let ending = bench.ending.clone().expect("ended");
        assert_eq!(ending.outcome, Outcome::Stopped, "{ending:?}");
        assert!(ending.position_kept && ending.beam_off, "{ending:?}");
        // The fastest move brakes from 10,000 mm/min at 500 mm/s² within a third of a second.
        let last_lit = bench.board.trace().iter().filter(|s| s.is_lit()).map(|s| s.end_s).fold(0.0, f64::max);
        assert!(last_lit < asked_s + 0.34 + 0.05, "lit until {last_lit}, asked at {asked_s}");
        assert_eq!(bench.lit_after_halt(), None);
        bench.wait(5.0);
        assert_eq!(bench.board.power(), 0.0);
    }
}
