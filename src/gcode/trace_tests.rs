//! Tests of the interpreter.

use super::super::parse;
use super::*;
use crate::geom::P2;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn moves(text: &str) -> Vec<Move> {
    trace(&parse(text).unwrap()).unwrap()
}

fn problem(text: &str) -> (usize, String) {
    let error = trace(&parse(text).unwrap()).unwrap_err();
    (error.line, error.problem.to_string())
}

#[test]
fn words_stay_in_effect_until_changed() {
    let moves = moves("G21G90\nM4S0\nG0X10Y5\nG1X20S300F1200\nY15\nG0X0S0\nM5");
    let burning: Vec<(usize, bool)> = moves.iter().map(|m| (m.line, m.burns())).collect();
    assert_eq!(burning, [(2, false), (3, false), (4, true), (5, true), (6, false), (7, false)]);
    let m = moves[3];
    assert_eq!((m.from, m.to), (P3::new(20.0, 5.0, 0.0), P3::new(20.0, 15.0, 0.0)));
    assert_eq!((m.feed_mm_per_min, m.power_s, m.beam), (1200.0, 300.0, Beam::Dynamic));
    assert_eq!(moves[4].action, Action::Rapid);
}

#[test]
fn inches_and_increments_come_out_as_millimetres() {
    let moves = moves("G20G91\nG1X1Y-2F10\nX1\nG21G90\nX0");
    assert_eq!(moves[0].to, P3::new(25.4, -50.8, 0.0));
    assert_eq!(moves[0].feed_mm_per_min, 254.0);
    assert_eq!(moves[1].to.x, 50.8);
    assert_eq!(moves[2].to, P3::new(0.0, -50.8, 0.0));
}

#[test]
fn arcs_turn_the_way_they_are_told() {
    let sweep = |text: &str| match moves(text)[1].action {
        Action::Arc { center, radius_mm, sweep_rad } => (center, radius_mm, sweep_rad),
        other => panic!("{other:?}"),
    };
    let (center, radius, quarter) = sweep("G0X10\nG3X0Y10I-10F600");
    assert_eq!((center, radius), (P2::origin(), 10.0));
    assert!((quarter - FRAC_PI_2).abs() < 1e-12);
    assert!((sweep("G0X10\nG2X0Y10I-10F600").2 + 1.5 * PI).abs() < 1e-12);
    assert!((sweep("G0X10\nG2X10I-10F600").2 + TAU).abs() < 1e-12, "a full circle");
}

#[test]
fn the_machine_stops_where_grbl_does() {
    let stops = |text: &str| {
        let stands = |m: &&Move| matches!(m.action, Action::Stop | Action::Dwell { .. });
        moves(text).iter().filter(stands).count()
    };
    assert_eq!(stops("M5S0\nM5"), 0, "nothing changes");
    assert_eq!(stops("M3S500\nM3\nM5"), 2);
    assert_eq!(stops("M4S0\nG1X1F100S10\nX2S20\nG0X3S0"), 1, "power changes on the fly");
    assert_eq!(stops("M3S10\nS20"), 2, "but not without a motion");
    assert_eq!(stops("M8\nM8\nM9\nM9"), 2);
    assert_eq!(stops("G4P0.5\nM0\nM2"), 3);
}

#[test]
fn the_end_of_the_program_puts_out_the_laser() {
    let moves = moves("G91\nM3S100\nG1X5F100\nM2\nX1");
    let last = moves[moves.len() - 1];
    assert_eq!((last.beam, last.to.x, last.burns()), (Beam::Off, 1.0, false));
}

#[test]
fn refusals_name_line_word_and_grbl_error() {
    let cases = [
        ("G1X1", 1, "error:22"),
        ("G21\nG5X1", 2, "G5 is not"),
        ("G54.1", 1, "error:23"),
        ("M6", 1, "error:20"),
        ("G1X1X2F1", 1, "error:25"),
        ("G0G1X1", 1, "error:24"),
        ("M3M5", 1, "error:21"),
        ("G2X1F1", 1, "error:35"),
        ("G2I1F1", 1, "error:26"),
        ("G2X10I2F1", 1, "error:33"),
        ("G2X9R2F1", 1, "error:34"),
        ("G4", 1, "error:28"),
        ("S-1", 1, "error:4"),
        ("G80X1", 1, "error:31"),
        ("G1.05X1", 1, "error:23"),
    ];
    for (text, line, words) in cases {
        let (at, message) = problem(text);
        assert_eq!(at, line, "{text}");
        assert!(message.contains(words), "{text}: {message}");
    }
}

#[test]
fn refusals_have_the_column_of_their_word() {
    let error = trace(&parse("G21\nG1X10F100Q2").unwrap()).unwrap_err();
    assert_eq!((error.line, error.column, error.problem.grbl_error()), (2, 10, 20));
}

#[test]
fn every_error_grbl_was_seen_to_give_is_given() {
    let cases = [
        (20, "G5 G41 G28.2 M6 M62 G64 G81 M98 O1 G90.1 G38.1X1 G61.1 G10L3P1X0 A1"),
        (23, "G54.1 G59.1 M3.5 G21.5"),
        (38, "T300"),
        (22, "F0G1X1 G1 G38.2X1"),
        (28, "G4 G10X1 G10L2X1"),
        (27, "N100000001"),
        (24, "G0G1X1 G92G1X1 G28G92X1"),
        (25, "X1X1"),
        (4, "S-1 F-1 G4P-1 N-1"),
        (21, "M3M5 G20G21 G90G91 M7M8 M0M2 G17G18 G54G55 G4P1G53"),
        (26, "G10L2P1 G92 F1G2I1 F1G38.2"),
        (29, "G10L2P7X1"),
        (30, "F1G53G2X1I.5"),
        (31, "G80X1"),
        (32, "F1G2Z1I1"),
        (33, "F1G2X10I2 F1G2X0Y0R5 F1G38.2X0"),
        (34, "F1G2X9R2"),
        (35, "F1G2X1"),
        (36, "P1 I1 L2 F1G1X1R5 G0X1J2"),
        (37, "G43.1X1 G43.1"),
    ];
    for (number, lines) in cases {
        for line in lines.split(' ') {
            match trace(&parse(line).unwrap()) {
                Err(error) => assert_eq!(error.problem.grbl_error(), number, "{line}: {error}"),
                Ok(_) => panic!("{line} is carried out"),
            }
        }
    }
    for line in ["T1", "M1", "G17G21G40G49G54G61G80G90G91.1G94", "G0", "N5G4P0", "G53G0X1", "F1G1", "G43.1Z1"] {
        assert!(trace(&parse(line).unwrap()).is_ok(), "{line}");
    }
}

#[test]
fn a_refused_line_changes_nothing() {
    let mut tracer = Tracer::new();
    let mut moves = Vec::new();
    let mut give = |text: &str| {
        let line = parse(text).unwrap().lines[0].clone();
        tracer.line(&line, 1, 1, &mut moves).is_ok()
    };
    assert!(give("G1X1F100") && !give("G20G91M3S500X7F9R1") && give("X2"));
    assert_eq!(moves.len(), 2);
    assert_eq!((moves[1].to, moves[1].feed_mm_per_min, moves[1].beam), (P3::new(2.0, 0.0, 0.0), 100.0, Beam::Off));
}

#[test]
fn zero_can_be_moved_and_positions_stay_those_of_the_start() {
    let last = |text: &str| moves(text).last().unwrap().to;
    assert_eq!(last("G0X10Y5\nG92X0Y0\nG0X1Y1"), P3::new(11.0, 6.0, 0.0));
    assert_eq!(last("G0X10\nG92X0\nG92X2\nG0X3"), P3::new(11.0, 0.0, 0.0), "a second shift replaces the first");
    assert_eq!(last("G0X10\nG92X0\nG92.1\nG0X3"), P3::new(3.0, 0.0, 0.0));
    assert_eq!(last("G0X10\nG10L20P1X0\nG0X1"), P3::new(11.0, 0.0, 0.0));
    assert_eq!(last("G10L2P2X5\nG55\nG0X1"), P3::new(6.0, 0.0, 0.0));
    assert_eq!(last("G10L2P2X5\nG55\nG53G0X1"), P3::new(1.0, 0.0, 0.0), "machine coordinates");
    assert_eq!(last("G43.1Z2\nG0Z1\nG49\nG0Z1"), P3::new(0.0, 0.0, 1.0));
    assert_eq!(last("G43.1Z2\nG49Z7\nG0Z1"), P3::new(0.0, 0.0, 1.0), "G49 takes no length");
    let home = moves("G0X10Y5\nG91G28X1");
    assert_eq!([home[1].to, home[2].to], [P3::new(11.0, 5.0, 0.0), P3::new(0.0, 5.0, 0.0)]);
}

#[test]
fn inverse_time_makes_the_feed_from_the_length() {
    let moves = moves("G93\nG1X10F2\nY30F4");
    assert_eq!([moves[0].feed_mm_per_min, moves[1].feed_mm_per_min], [20.0, 120.0]);
    assert!(problem("G93G1X10F2\nX20").1.contains("error:22"), "every move needs its time");
}

#[test]
fn a_constant_beam_is_switched_at_rest_when_the_motion_mode_changes_without_a_motion() {
    let stops = |text: &str| moves(text).iter().filter(|m| m.action == Action::Stop).count();
    assert_eq!(stops("M3S100\nG1F100"), 2);
    assert_eq!(stops("M4S100\nG1F100"), 1);
    assert_eq!(stops("M3S100\nG1F100X1"), 1);
}

#[test]
fn a_line_is_sent_without_blanks_and_comments() {
    assert_eq!(["G1 X1 (a b) F2 ; c", "(x)", "; x", "", "G1X1"].map(sent_bytes), [7, 0, 0, 0, 5]);
    assert_eq!(["(a;b) G1X1", "G1 (;) X1;(", "(;"].map(sent_bytes), [5, 5, 0]);
    assert!(moves("G0X10 (there)").iter().all(|m| m.bytes == 6));
}
