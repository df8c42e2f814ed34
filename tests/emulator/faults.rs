//! What goes wrong on command goes wrong as on a real link.

use furbelow::emulator::{Fault, When};
use furbelow::geom::P3;

use super::bench::Bench;

const JOB: &[&str] = &["G1X10F1200", "Y10", "X0", "Y0", "X20", "Y20"];

#[test]
fn an_unplugged_board_with_power_finishes_what_it_holds_and_only_m3_stays_lit() {
    for (mode, left_on) in [("M3S500", 0.5), ("M4S500", 0.0)] {
        let mut bench = Bench::ready(&[]);
        bench.ok(mode);
        bench.board.schedule(When::At(bench.now_s + 0.2), Fault::Unplug { powered: true });
        bench.send(format!("{}\n", JOB.join("\n")).as_bytes());
        bench.wait(20.0);
        assert!(!bench.board.is_plugged());
        assert_eq!(bench.board.position_mm(), P3::new(20.0, 20.0, 0.0), "all lines it held");
        assert_eq!(bench.board.power(), left_on, "{mode}");
        bench.lines();
        assert_eq!(bench.ask(b"?"), [""; 0]);
        bench.board.schedule(When::At(bench.now_s), Fault::Replug);
        bench.wait(0.1);
        assert!(bench.board.open(bench.now_s));
        assert_eq!(bench.board.power(), 0.0, "opening resets");
        bench.wait(2.0);
        bench.lines();
        assert_eq!(bench.status()[1], "MPos:0.000,0.000,0.000");
        assert!((bench.board.head_mm() - P3::new(20.0, 20.0, 0.0)).norm() < 1e-9);
    }
}

#[test]
fn an_unplugged_board_without_power_stops_dark_at_once() {
    let mut bench = Bench::ready(&[]);
    bench.ok("M3S500");
    bench.board.schedule(When::At(bench.now_s + 0.2), Fault::Unplug { powered: false });
    let now_s = bench.now_s;
    bench.send(b"G1X100F3000\n");
    bench.wait(1.0);
    assert!(!bench.board.open(bench.now_s));
    let last = *bench.board.trace().last().unwrap();
    assert!(last.end_s <= now_s + 0.2 + 1e-9 && bench.board.power() == 0.0);
}

#[test]
fn bytes_are_dropped_corrupted_and_torn_where_told() {
    let mut bench = Bench::ready(&[]);
    let heard = |fault: Fault, bench: &mut Bench| {
        bench.board.schedule(When::At(bench.now_s), fault);
        bench.wait(0.001);
        bench.ask(b"G1X12F600\nG90\n")
    };
    assert_eq!(heard(Fault::DropIn(1), &mut bench), ["error:1", "ok"]);
    assert_eq!(heard(Fault::TornLine, &mut bench), ["ok"]);
    assert_eq!(heard(Fault::StuckOk(1), &mut bench), ["ok"]);
    assert_eq!(heard(Fault::DropOut(2), &mut bench), ["", "ok"]);
    assert_ne!(heard(Fault::CorruptOut(2), &mut bench), ["ok", "ok"]);
    assert_ne!(heard(Fault::CorruptIn(6), &mut bench), ["ok", "ok"]);
}

#[test]
fn a_byte_count_places_a_fault_to_the_byte() {
    let mut bench = Bench::ready(&[]);
    bench.board.schedule(When::ByteIn(3), Fault::DropIn(1));
    bench.ok("G1X18F6000");
    bench.settle();
    assert_eq!(bench.board.position_mm().x, 8.0, "a dropped digit is a different number, silently");
    bench.board.schedule(When::ByteOut(0), Fault::Reset);
    bench.send(b"G90\n");
    bench.wait(2.0);
    assert_eq!(bench.lines().last().unwrap(), "Grbl 1.1h ['$' for help]");
}

#[test]
fn the_same_faults_give_the_same_bytes() {
    let run = || {
        let mut bench = Bench::ready(&[]);
        bench.board.schedule(When::ByteIn(5), Fault::CorruptIn(20));
        bench.board.schedule(When::ByteOut(30), Fault::CorruptOut(4));
        bench.ask(format!("{}\n", JOB.join("\n")).as_bytes())
    };
    assert_eq!(run(), run());
}
