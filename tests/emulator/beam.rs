//! What the beam does: on in cuts, off in travels and holds, M4 dark at rest, M3 not.

use furbelow::emulator::Segment;

use super::bench::Bench;

fn lit(trace: &[Segment]) -> Vec<&Segment> {
    trace.iter().filter(|s| s.is_lit()).collect()
}

#[test]
fn travels_are_dark_and_power_follows_speed_under_m4() {
    let mut bench = Bench::ready(&[]);
    bench.stream(&["M4S500", "G0X10", "G1X20F1200", "G0X30"]);
    bench.settle();
    let trace = bench.board.trace();
    for s in trace {
        assert_eq!(s.is_lit(), s.from_mm.x > 9.99 && s.to_mm.x < 20.01, "{s:?}");
        let share = if s.is_lit() { 0.5 / 20.0 } else { 0.0 };
        assert!((s.start_power - share * s.start_mm_per_s).abs() < 1e-9, "{s:?}");
        assert!((s.end_power - share * s.end_mm_per_s).abs() < 1e-9, "{s:?}");
    }
    let burnt_mm: f64 = lit(trace).iter().map(|s| s.length_mm()).sum();
    assert!((burnt_mm - 10.0).abs() < 1e-6, "{burnt_mm}");
    assert_eq!(bench.board.power(), 0.0);
}

#[test]
fn a_constant_beam_burns_on_at_rest_in_a_feed_mode_only() {
    let mut bench = Bench::ready(&[]);
    bench.ok("M3S500");
    assert_eq!(bench.board.power(), 0.0, "G0 is in effect");
    bench.ok("G1F1000");
    assert_eq!(bench.board.power(), 0.5);
    bench.stream(&["X1", "G4P0.5", "M5"]);
    bench.wait(1.0);
    assert_eq!(bench.board.power(), 0.0);
    let resting: f64 =
        lit(bench.board.trace()).iter().filter(|s| s.length_mm() == 0.0).map(|s| s.end_s - s.start_s).sum();
    assert!(resting > 0.5, "{resting}");
    bench.ok("M4");
    bench.ok("G1X2");
    bench.settle();
    assert_eq!(bench.board.power(), 0.0, "M4 is dark at rest");
}

#[test]
fn a_hold_puts_either_beam_out_no_later_than_the_head_stands() {
    for mode in ["M3S500", "M4S500"] {
        let mut bench = Bench::ready(&[]);
        bench.ok(mode);
        bench.ok("G1X100F6000");
        let now_s = bench.now_s;
        bench.ask(b"!");
        assert_eq!(bench.board.power(), 0.0, "{mode}");
        let braking_s = 100.0 / 500.0;
        let last_s = lit(bench.board.trace()).last().unwrap().end_s;
        assert!(last_s <= now_s + braking_s + 0.001, "{mode}: {last_s} {now_s}");
        assert_eq!(bench.ask(b"~"), ["[MSG:Restoring spindle]"]);
        assert_eq!(bench.board.power(), 0.5, "{mode}");
        bench.send(&[0x84]);
        bench.wait(0.3);
        assert_eq!(bench.lines(), ["[MSG:Check Door]"]);
        assert_eq!((bench.state().as_str(), bench.board.power()), ("Door:0", 0.0));
    }
}

#[test]
fn a_reset_puts_the_beam_out_at_once() {
    let mut bench = Bench::ready(&[]);
    bench.ok("M3S1000");
    bench.ok("G1X100F6000");
    let now_s = bench.now_s;
    bench.ask(&[0x18]);
    let last_s = lit(bench.board.trace()).last().unwrap().end_s;
    assert!(last_s <= now_s + 0.0002 && bench.board.power() == 0.0);
}

#[test]
fn the_trace_is_whole_however_often_the_board_is_stepped() {
    let run = |dt: f64| {
        let mut bench = Bench::ready(&[]);
        bench.send(b"M4S300\nG1X10F600\nG3X0Y10I-10F1200\nG0X0Y0\n");
        for _ in 0..(6.0 / dt) as usize {
            bench.wait(dt);
        }
        let trace = bench.board.take_trace();
        assert!(bench.board.trace().is_empty());
        for pair in trace.windows(2) {
            assert!(pair[0].end_s <= pair[1].start_s + 1e-9);
            assert!((pair[0].to_mm - pair[1].from_mm).norm() < 1e-6, "{pair:?}");
        }
        trace
    };
    let (fine, coarse) = (run(0.001), run(1.0));
    assert_eq!(fine.len(), coarse.len());
    assert!(
        fine.iter().zip(&coarse).all(|(a, b)| (a.end_s - b.end_s).abs() < 1e-6 && (a.to_mm - b.to_mm).norm() < 1e-6)
    );
}
