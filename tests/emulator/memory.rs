//! What survives a reset and what does not: stored places, startup lines, build info, modes; and the ends of programs.

use furbelow::emulator::{BoardSettings, Memory};
use furbelow::geom::P3;

use super::bench::{Bench, with};

const BANNER: &str = "Grbl 1.1h ['$' for help]";

#[test]
fn startup_lines_run_after_every_start_that_does_not_lock_and_are_no_answers() {
    let mut bench = Bench::ready(&[]);
    assert_eq!(bench.ask(b"$N\n"), ["$N0=", "$N1=", "ok"]);
    bench.ok("$N0=G20 G91");
    bench.ok("$N1=M8");
    assert_eq!(bench.ask(b"$N2=M8\n"), ["error:3"]);
    assert_eq!(bench.ask(b"$N0=G5\n"), ["error:20"], "a line that cannot be carried out is not stored");
    assert_eq!(bench.ask(b"$N\n"), ["$N0=G20G91", "$N1=M8", "ok"]);
    bench.ok("G21");
    assert_eq!(bench.ask(&[0x18]), ["", BANNER, ">G20G91:ok", ">M8:ok"]);
    assert_eq!(bench.ask(b"$G\n")[0], "[GC:G0 G54 G17 G20 G91 G94 M5 M8 T0 F0 S0]");
    bench.board.open(bench.now_s);
    bench.wait(2.0);
    assert_eq!(bench.lines(), ["", BANNER, ">G20G91:ok", ">M8:ok"], "they survive power");
}

#[test]
fn a_locked_board_runs_its_startup_lines_when_it_has_homed() {
    let memory = Memory { startup: ["G10L2P7X0".into(), "G90".into()], ..Memory::default() };
    let mut bench = Bench::booted(BoardSettings { memory, ..with(&[(22, 1.0)]) });
    assert_eq!(bench.lines(), ["", BANNER, "[MSG:'$H'|'$X' to unlock]"]);
    assert_eq!(bench.ask(b"$X\n"), ["[MSG:Caution: Unlocked]", "ok"]);
    bench.send(b"$H\n");
    bench.wait(60.0);
    assert_eq!(bench.lines(), [">G10L2P7X0:error:29", ">G90:ok", "ok"]);
}

#[test]
fn the_stored_places_of_g28_and_g30_are_gone_to_axis_by_axis_and_survive_power() {
    let mut bench = Bench::ready(&[]);
    for line in ["G0X10Y20", "G28.1", "G0X-5Y-6", "G30.1", "G0X1Y1", "G28X3"] {
        bench.ok(line);
        bench.settle();
    }
    assert_eq!(bench.board.position_mm(), P3::new(10.0, 1.0, 0.0), "only the axis that was named, by way of X3");
    bench.ok("G30");
    bench.settle();
    assert_eq!(bench.board.position_mm(), P3::new(-5.0, -6.0, 0.0));
    bench.board.open(bench.now_s);
    bench.wait(2.0);
    bench.lines();
    let lines = bench.ask(b"$#\n");
    assert!(lines.contains(&"[G28:10.000,20.000,0.000]".to_owned()), "{lines:?}");
    assert!(lines.contains(&"[G30:-5.000,-6.000,0.000]".to_owned()), "{lines:?}");
}

#[test]
fn storing_a_place_deafens_the_link_like_any_write() {
    let mut bench = Bench::ready(&[]);
    bench.ok("G0X12.345Y6.789");
    bench.settle();
    let burst = "G91\nG90\n".repeat(12);
    assert!(bench.ask(format!("G28.1\n{burst}").as_bytes()).len() < 20);
    assert!(bench.board.bytes_lost() > 20);
}

#[test]
fn a_reset_loses_g92_tool_length_and_modes_and_keeps_g54() {
    let mut bench = Bench::ready(&[]);
    for line in ["G10L2P1X-7", "G92X5", "G43.1Z2", "G91G20G55M4S9F7", "G38.3Z-1"] {
        bench.ask(format!("{line}\n").as_bytes());
    }
    bench.settle();
    bench.ask(&[0x18]);
    let lines = bench.ask(b"$#\n");
    for kept in ["[G54:-7.000,0.000,0.000]", "[G92:0.000,0.000,0.000]", "[TLO:0.000]", "[PRB:0.000,0.000,0.000:0]"] {
        assert!(lines.contains(&kept.to_owned()), "{kept}: {lines:?}");
    }
    assert_eq!(bench.ask(b"$G\n")[0], "[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]");
    bench.ok("G92X5");
    bench.ok("G92.1");
    assert!(bench.ask(b"$#\n").contains(&"[G92:0.000,0.000,0.000]".to_owned()));
}

#[test]
fn what_is_restored_is_what_was_asked_for() {
    let soiled = || {
        let mut bench = Bench::ready(&[]);
        for line in ["$110=777", "G10L2P1X-7", "$N0=G91", "$I=LASER7"] {
            bench.ok(line);
        }
        bench
    };
    let left = |command: &str| {
        let mut bench = soiled();
        bench.send(format!("{command}\n").as_bytes());
        bench.wait(1.0);
        let told = bench.lines();
        assert_eq!(told[..4], ["[MSG:Restoring defaults]", "ok", "", BANNER], "{command}");
        let all = [b"$$\n", b"$#\n", b"$N\n", b"$I\n"].map(|q| bench.ask(q).join(" ")).join(" ");
        ["$110=777.000", "[G54:-7.000", "$N0=G91", ":LASER7]"].map(|mark| all.contains(mark))
    };
    assert_eq!(left("$RST=$"), [false, true, true, true]);
    assert_eq!(left("$RST=#"), [true, false, true, true]);
    assert_eq!(left("$RST=*"), [false, false, false, false]);
    assert_eq!(soiled().ask(b"$RST=!\n"), [""; 0], "the hold byte is taken out of it");
}

#[test]
fn the_end_of_a_program_darkens_resets_modes_and_overrides_and_keeps_places() {
    for end in ["M2", "M30"] {
        let mut bench = Bench::ready(&[]);
        for line in ["G92X5", "M3S500", "G91", "G55"] {
            bench.ok(line);
        }
        bench.ask(&[0x91]);
        bench.stream(&["M8", "G1X10F1200"]);
        assert_eq!(bench.ask(format!("{end}\n").as_bytes()), [""; 0], "it waits for the motion");
        bench.wait(1.0);
        assert_eq!(bench.lines(), ["[MSG:Pgm End]", "ok"]);
        assert_eq!(bench.ask(b"$G\n")[0], "[GC:G1 G54 G17 G21 G90 G94 M5 M9 T0 F1200 S500]");
        assert_eq!(bench.board.power(), 0.0);
        let status = [bench.status().join("|"), bench.status().join("|")].join(" ");
        assert!(status.contains("Ov:100,100,100"), "{status}");
        assert!(bench.ask(b"$#\n").contains(&"[G92:-5.000,0.000,0.000]".to_owned()));
    }
}

#[test]
fn a_pause_holds_with_the_laser_dark_and_goes_on_when_told() {
    let mut bench = Bench::ready(&[]);
    for line in ["M3S500", "G1X1F600"] {
        bench.ok(line);
    }
    bench.settle();
    assert_eq!(bench.ask(b"M0\nG1X2\n"), [""; 0]);
    assert_eq!((bench.state().as_str(), bench.board.power()), ("Hold:0", 0.0));
    assert_eq!(bench.ask(b"~"), ["[MSG:Restoring spindle]", "ok", "ok"]);
    bench.settle();
    assert_eq!(bench.board.position_mm().x, 2.0);
}

#[test]
fn a_spindle_stopped_in_a_hold_says_when_it_runs_again() {
    let mut bench = Bench::ready(&[(32, 0.0)]);
    for line in ["M3S500", "G1X50F600"] {
        bench.ok(line);
    }
    bench.ask(b"!");
    assert_eq!(bench.board.power(), 0.5, "without laser mode a hold lets the spindle run");
    assert_eq!((bench.ask(&[0x9E]), bench.board.power()), (vec![], 0.0));
    assert_eq!(bench.ask(&[0x9E]), ["[MSG:Restoring spindle]"]);
    bench.ask(&[0x9E]);
    assert_eq!(bench.ask(b"~"), ["[MSG:Restoring spindle]"]);
    assert_eq!(bench.board.power(), 0.5);
}
