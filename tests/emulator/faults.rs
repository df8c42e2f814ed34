//! What goes wrong on command goes wrong as on a real link.

use furbelow::emulator::{BoardSettings, Fault, When};
use furbelow::geom::P3;

use super::bench::{Bench, with};

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

/// A small linear congruential generator (Knuth's MMIX constants).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }
}

#[test]
fn no_bytes_and_no_faults_make_the_board_hang_or_its_trace_jump() {
    const LINES: &[&str] = &[
        "G1X10F6000\n",
        "G0X0Y0\n",
        "G2X5Y5I2.5J2.5F900\n",
        "M3S500\n",
        "M4S900\n",
        "M5\n",
        "G1Y3S1\n",
        "M0\n",
        "M2\n",
        "G4P0.05\n",
        "$J=G91X3F900\n",
        "$X\n",
        "$H\n",
        "$C\n",
        "$110=nan\n",
        "$12=0\n",
        "$32=0\n",
        "$32=1\n",
        "$22=1\n",
        "$20=1\n",
        "$RST=*\n",
        "$SLP\n",
        "G10L20P1X0Y0\n",
        "G92X1\n",
        "G91X0.001\n",
        "G90\n",
        "X1e9\n",
        "G1X1",
        "\r",
        "(",
        "G28\n",
        "$$\n",
        "G53G0X-3\n",
        "G93\n",
        "S-\n",
        "G38.2X50F600\n",
        "G38.5X-5F900\n",
        "G28.1\n",
        "G30X1\n",
        "$N0=G91\n",
        "$N1=G38.3X2F600\n",
        "$N\n",
        "$I=A\n",
    ];
    const BYTES: &[u8] =
        &[0x18, b'?', b'~', b'~', b'!', b'~', 0x84, 0x85, 0x91, 0x92, 0x96, 0x97, 0x99, 0x9B, 0x9E, 0xFF, 0x7F, 0];
    let mut segments = 0;
    for seed in 0..150 {
        let mut random = Random(seed);
        let kin = [BoardSettings::default(), BoardSettings::grbl_hal(), BoardSettings::fluid_nc()];
        let limits = with(&[(21, f64::from(u8::from(seed % 2 == 0)))]).settings;
        let mut bench = Bench::booted(BoardSettings { settings: limits, ..kin[seed as usize % 3].clone() });
        bench.lines();
        for _ in 0..300 {
            match random.below(40) {
                0 if random.below(2) == 0 => bench.board.set_switch(random.below(3), random.below(2) == 0),
                0 => bench.board.set_probe(random.below(2) == 0),
                1 => {
                    let faults =
                        [Fault::DropIn(2), Fault::CorruptIn(3), Fault::TornLine, Fault::Reset, Fault::CorruptOut(2)];
                    bench.board.schedule(When::At(bench.now_s + 0.01), faults[random.below(faults.len())]);
                }
                // Otherwise most boards would end locked or asleep.
                2..5 => {
                    bench.send(&[0x18]);
                    bench.wait(0.02);
                    bench.send(b"\n$X\n");
                    bench.wait(0.02);
                }
                5..12 => bench.send(&[BYTES[random.below(BYTES.len())]]),
                _ => bench.send(LINES[random.below(LINES.len())].as_bytes()),
            }
            bench.wait(0.001 * random.below(100) as f64);
            bench.lines();
        }
        let trace = bench.board.take_trace();
        for s in &trace {
            assert!(
                s.end_s > s.start_s && s.end_s.is_finite() && (0.0..=1.0).contains(&s.start_power),
                "seed {seed}: {s:?}"
            );
            assert!((0.0..=1.0).contains(&s.end_power), "seed {seed}: {s:?}");
            let way_mm = 0.5 * (s.start_mm_per_s + s.end_mm_per_s) * (s.end_s - s.start_s);
            assert!((s.length_mm() - way_mm).abs() < 1e-4, "seed {seed}: {way_mm} {s:?}");
        }
        segments += trace.len();
        for pair in trace.windows(2) {
            assert!(pair[0].end_s <= pair[1].start_s + 1e-9, "seed {seed}: {pair:?}");
            // Homing takes the head for where the switches are: to rounding.
            assert!((pair[0].to_mm - pair[1].from_mm).norm() < 1e-6, "seed {seed}: {pair:?}");
        }
    }
    assert!(segments > 5000, "the boards must have done something: {segments}");
}
