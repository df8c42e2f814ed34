//! Tests of the check: a good program stays in peace, every fault is found at its line.

use super::super::{estimate, parse, trace};
use super::*;
use crate::geom::P2;

/// A 400 x 300 mm diode laser whose y axis is slower than its x axis.
pub(in super::super) fn diode() -> CheckSettings {
    let limits = Limits { max_rate_mm_per_min: [6000.0, 3000.0, 600.0], ..Limits::USUAL };
    CheckSettings {
        work_area: Rect::from_size(400.0, 300.0),
        travel_z_mm: 50.0,
        keep_outs: Vec::new(),
        max_s: 1000.0,
        limits,
        laser: true,
        laser_mode: true,
        mist: true,
        strike_floor: 0.0,
        energy: None,
    }
}

fn read(text: &str, settings: &CheckSettings) -> Report {
    let mut checker = Checker::new(settings);
    checker.read(text.as_bytes(), |_| ()).unwrap();
    checker.finish()
}

fn told(findings: &[Finding]) -> Vec<(&str, usize)> {
    findings.iter().map(|f| (f.code.as_str(), f.line)).collect()
}

fn errors(text: &str) -> Vec<(String, usize)> {
    let report = read(&format!("{text}\nM5"), &diode());
    told(&report.errors).into_iter().map(|(code, line)| (code.to_owned(), line)).collect()
}

fn warnings(text: &str, settings: &CheckSettings) -> Vec<(String, usize)> {
    let report = read(&format!("G21G90\n{text}\nM5"), settings);
    assert_eq!(report.errors, [], "{text}");
    told(&report.warnings).into_iter().map(|(code, line)| (code.to_owned(), line)).collect()
}

fn one(code: &str, line: usize) -> Vec<(String, usize)> {
    vec![(code.to_owned(), line)]
}

#[test]
fn a_good_program_is_left_in_peace_and_measured() {
    let text = "G21G90\nM4S0\nG0X400Y300S0\nG1X0S1000F6000\nG0Y0S0\nM5\nG0X0S500";
    let report = read(text, &diode());
    assert_eq!((&report.errors[..], &report.warnings[..]), (&[][..], &[][..]));
    assert_eq!((report.cut_mm, report.travel_mm, report.lines), (400.0, 800.0, 7));
    assert_eq!((report.bounds.min, report.bounds.max), (P2::new(0.0, 300.0), P2::new(400.0, 300.0)));
    let timing = estimate(&trace(&parse(text).unwrap()).unwrap(), &diode().limits);
    assert!((report.time_s - timing.total_s).abs() < 1e-9 && (report.laser_on_s - timing.laser_on_s).abs() < 1e-9);
}

#[test]
fn moves_beyond_the_work_area_are_found_arcs_and_travels_too() {
    assert_eq!(errors("G0X10\nX400.5\nX400"), [("outside-work-area".into(), 2), ("outside-work-area".into(), 3)]);
    assert_eq!(errors("G0X10Y10\nG2X30Y10I10F100\nG3X50Y10I10F100"), []);
    assert_eq!(errors("G0X10Y5\nG3X30Y5I10F100"), one("outside-work-area", 2));
    assert_eq!(errors("G0Z-51"), one("outside-work-area", 1));
}

#[test]
fn keep_outs_are_hit_only_by_what_runs_through_them() {
    let magnet = Rect { min: P2::new(100.0, 100.0), max: P2::new(120.0, 120.0) };
    let settings = CheckSettings { keep_outs: vec![("magnet".into(), magnet)], ..diode() };
    let hits = |text: &str| told(&read(text, &settings).errors).len();
    assert_eq!(hits("G0X99Y130\nX121\nY50\nX100\nY100"), 0, "around it, and up to its corner");
    assert_eq!(hits("G0X90Y100\nX110Y130"), 1, "across its corner");
    assert_eq!(hits("G0X90Y99\nG2X130Y99I20F100"), 1, "an arc over it");
    assert_eq!(hits("G0X90Y125\nG2X130Y125I20F100"), 0, "an arc around it");
}

#[test]
fn a_lit_travel_is_found_only_where_it_goes_somewhere() {
    assert_eq!(errors("M3S500\nG0X10"), one("laser-on-travel", 2));
    assert_eq!(errors("M3S500\nG0X0\nM5\nG0X10"), []);
    assert_eq!(warnings("M4S500\nG0X10\nG0X20", &diode()), one("laser-on-travel", 3), "laser mode keeps it off");
    let bare = CheckSettings { laser_mode: false, ..diode() };
    assert_eq!(told(&read("G21G90\nM4S500\nG0X10\nM5", &bare).errors), [("laser-on-travel", 3)]);
    let pen = CheckSettings { laser: false, laser_mode: false, ..diode() };
    assert_eq!(warnings("M3S90\nG0X10", &pen), [], "a pen lifted by a servo");
}

#[test]
fn power_and_feed_over_their_limits_are_told_once_while_they_last() {
    let power = errors("M4S0\nG1X10S1200F100\nX20\nX30S900\nX40S1200");
    assert_eq!(power, [("power-above-max".into(), 2), ("power-above-max".into(), 5)]);
    assert_eq!(errors("G1X10F6500\nX20\nY10\nX100Y11F5000"), one("feed-above-limit", 1));
    assert_eq!(
        errors("G1X10F6500\nX20F900\nX30F6500"),
        [("feed-above-limit".into(), 1), ("feed-above-limit".into(), 3)]
    );
    assert_eq!(errors("G1Y10F5000\nX10\nY20"), one("feed-above-limit", 1), "F5000 is still what was told");
    assert_eq!(errors("G1Y10F5000"), one("feed-above-limit", 1));
    assert_eq!(errors("G3Y10J5F5000"), one("feed-above-limit", 1));
}

#[test]
fn what_grbl_would_refuse_has_its_number_and_column_and_the_rest_is_read_on() {
    let report = read("G21 G90\nG1 X10 Q2 F100\n  G5 X1\n%\nG1X1Y\nG1 X401 F100", &diode());
    let found: Vec<(&str, usize, usize)> = report.errors.iter().map(|f| (f.code.as_str(), f.line, f.column)).collect();
    assert_eq!(
        found,
        [("error:20", 2, 8), ("error:20", 3, 3), ("error:1", 4, 1), ("error:2", 5, 5), ("outside-work-area", 6, 1)]
    );
    let long = format!("G1X{}1F100", "0".repeat(80));
    assert_eq!(errors(&long), one("error:11", 1));
    assert_eq!(errors(&format!("G1 {} X1F100 ({})", " ".repeat(90), "x".repeat(90))), []);
}

#[test]
fn settings_are_not_for_jobs() {
    assert_eq!(errors("$30=255"), one("eeprom-write", 1));
    assert_eq!(errors("G10L20P1X0"), one("eeprom-write", 1));
    assert_eq!(errors("G28.1"), one("eeprom-write", 1));
    assert_eq!(errors("$FOO"), one("error:3", 1));
    assert_eq!(warnings("$H", &diode()), one("system-command", 2));
    assert_eq!(warnings("G55\nG54\nG28X0", &diode()), one("place-unknown", 2), "once");
}

#[test]
fn what_is_only_assumed_is_told() {
    let report = read("G0X1\nG21G90\nG0X2", &diode());
    assert_eq!(told(&report.warnings), [("no-units", 1), ("no-distance-mode", 1)]);
}

#[test]
fn a_line_with_mist_the_machine_lacks_does_nothing() {
    let stock = CheckSettings { mist: false, ..diode() };
    let report = read("G21G90\nM3S500\nG1X10F600\nM5M7", &stock);
    assert_eq!(told(&report.errors), [("laser-left-on", 4), ("error:20", 4)]);
    assert_eq!(report.errors[0].column.max(report.errors[1].column), 3);
    assert_eq!(told(&read("G21G90\nM3S500\nG1X10F600\nM5M7", &diode()).errors), []);
}

#[test]
fn a_beam_left_on_is_an_error_when_it_would_burn_on() {
    let left = |text: &str| {
        let report = read(&format!("G21G90\n{text}"), &diode());
        (told(&report.errors).len(), told(&report.warnings).len())
    };
    assert_eq!(left("M3S500\nG1X10F100"), (1, 0));
    assert_eq!(left("M4S500\nG1X10F100"), (0, 1));
    assert_eq!(left("M3S500\nG1X10F100\nM5"), (0, 0));
    assert_eq!(left("M3S500\nG1X10F100\nM2"), (0, 0));
}

#[test]
fn a_tube_goes_out_where_the_machine_is_slow() {
    let co2 = CheckSettings { strike_floor: 0.10, ..diode() };
    // 50 mm/s at 500 mm/s2: at 12 % the tube is out below 0.1 / 0.12 of the feed, 1.74 mm at either end; at 60 % only 0.07 mm.
    assert_eq!(warnings("M4S0\nG1X100S120F3000\nG0X0S0", &co2), one("below-strike", 3));
    assert_eq!(warnings("M4S0\nG1X100S600F3000\nG0X0S0", &co2), []);
    assert_eq!(warnings("M3S0\nG1X100S120F3000\nX101S0", &co2), [], "constant power");
    assert_eq!(warnings("M3S0\nG1X100S80F3000\nX101S0", &co2), one("below-strike", 3));
    let message = &read("M4S0\nG1X100S120F3000\nM5", &co2).warnings[2].message;
    assert!(message.contains("3.5 mm in all"), "{message}");
}

#[test]
fn too_much_energy_for_the_material_scorches() {
    let paper = CheckSettings { energy: Some(Energy { full_power_w: 10.0, cut_j_per_mm: 0.25 }), ..diode() };
    assert_eq!(warnings("M4S0\nG1X100S500F1200\nX0S80F1800", &paper), [], "what cuts, and what engraves");
    assert_eq!(warnings("M4S0\nG1X100S1000F1000", &paper), one("scorch", 3), "0.6 J/mm");
    // 0.5 mm cuts under M3 at F6000 never come near their feed.
    let zigzag: String = (1..40).map(|k| format!("X{}\n", 0.5 * f64::from(k % 2))).collect();
    assert_eq!(warnings(&format!("M4S0\nG1S1000F3000\n{zigzag}"), &paper), []);
    assert_eq!(warnings(&format!("M3S0\nG1S1000F3000\n{zigzag}S0"), &paper), one("scorch", 4));
    assert_eq!(warnings("M3S0\nG1X10S300F3000\nG4P0.5\nG1S0", &paper), one("burns-at-rest", 4));
}

#[test]
fn a_contour_in_short_chords_counts_as_one_way() {
    let chords: String = (1..=1000).map(|k| format!("X{:.1}\n", 0.1 * f64::from(k))).collect();
    let paper = CheckSettings { energy: Some(Energy { full_power_w: 10.0, cut_j_per_mm: 0.25 }), ..diode() };
    assert_eq!(warnings(&format!("M4S0\nG1S1000F1000\n{chords}"), &paper), one("scorch", 4));
    let co2 = CheckSettings { strike_floor: 0.10, ..diode() };
    assert_eq!(warnings(&format!("M3S0\nG1S80F600\n{chords}S0"), &co2), one("below-strike", 4));
    assert_eq!(warnings("M3S0\nG1X0.1S80F600\nG0X5S0\nG1X5.1S80", &co2), [], "the spot bridges each");
}

#[test]
fn a_constant_beam_is_lit_at_rest_in_a_feed_mode() {
    let rest = |text: &str| warnings(text, &diode()).into_iter().filter(|w| w.0 == "burns-at-rest").collect::<Vec<_>>();
    assert_eq!(rest("G0X10S0\nG1F600\nM3S1000\nG4P10"), one("burns-at-rest", 5));
    assert_eq!(rest("M3\nG1X10S0F600\nS1000\nG4P10"), one("burns-at-rest", 5));
    assert_eq!(rest("M3S1000\nG4P10\nG1X10F600S0"), [], "G0 keeps it off");
    assert_eq!(rest("M4S1000\nG1X10F600\nG4P10"), [], "no power at rest");
    assert_eq!(rest("M3S0\nG1X10F600S500\nZ-1\nS0"), one("burns-at-rest", 4));
}

#[test]
fn a_line_too_long_to_hold_is_an_error_and_not_read() {
    let long = |line: String| {
        let report = read(&format!("G21G90\n{line}\nG0X1"), &diode());
        (
            report.lines,
            told(&report.errors).iter().map(|(code, line)| format!("{code} {line}")).collect(),
            report.travel_mm,
        )
    };
    let too_long = (3, vec!["line-too-long 2".to_owned()], 1.0);
    assert_eq!(long(format!("({}) G0X500", "x".repeat(300_000))), too_long);
    assert_eq!(long(format!("G0X5 ({})", "x".repeat(65_530))), too_long);
    assert_eq!(long("X1".repeat(300_000)), too_long);
    assert_eq!(long(format!("G0X1 ({})", "x".repeat(65_529))), (3, Vec::new(), 1.0));
}

#[test]
fn a_carriage_return_ends_a_line() {
    let report = read("; title\rG21G90\rM3S1000\rG0X500\r\nG0X0\rM5", &diode());
    assert_eq!(report.lines, 6);
    assert_eq!(
        told(&report.errors),
        [("outside-work-area", 4), ("laser-on-travel", 4), ("outside-work-area", 5), ("laser-on-travel", 5)]
    );
    assert_eq!(parse("; title\rG21G90\r\nM5").unwrap().lines.len(), 3);
}

#[test]
fn bytes_grbl_acts_on_at_once_are_told() {
    assert_eq!(errors("G0X1 ; a\u{18}b\nG0\u{18}X2"), [("soft-reset".into(), 1), ("soft-reset".into(), 2)]);
    assert!(parse("G0\u{18}X2").is_err());
    assert_eq!(warnings("G0X1 (why?)\nX2;go!\nX3 (~)\nX4", &diode()).len(), 3);
    assert_eq!(warnings("G0X1 (a) ; (Gr\u{f6}\u{df}e)", &diode()), one("real-time-byte", 2));
    assert_eq!(errors("G0X1!"), one("error:1", 1));
    let settings = diode();
    let mut checker = Checker::new(&settings);
    checker.read(&b"G21G90\nG0X1 (20 \xB0C)\nM5"[..], |_| ()).unwrap();
    let warnings = checker.finish().warnings;
    assert_eq!((told(&warnings), warnings[0].column), (vec![("real-time-byte", 2)], 10));
    assert!(warnings[0].message.contains("0xB0"));
}

#[test]
fn feeds_that_short_moves_cannot_reach_are_told_with_the_reason() {
    let run = |step_mm: f64, more: &str| -> String {
        let lines: String = (1..=500).map(|k| format!("X{:.3}{more}\n", step_mm * f64::from(k))).collect();
        let report = read(&format!("G21G90\nM4S0\nG1F6000S100\n{lines}M5"), &diode());
        assert_eq!(report.errors, []);
        report.warnings.iter().map(|w| format!("{} {}\n", w.code, w.message)).collect()
    };
    assert!(run(0.3, "").contains("feed-held") && run(0.3, "").contains("too short a way"), "{}", run(0.3, ""));
    assert!(run(0.1, "").contains("read lines fast enough"), "{}", run(0.1, ""));
    assert_eq!(run(0.8, ""), "");
    let wordy = "Y0.000000000000000000000000000000000000000000000000000000000000000000";
    assert!(run(0.4, wordy).contains("arrive fast enough"), "{}", run(0.4, wordy));
}
