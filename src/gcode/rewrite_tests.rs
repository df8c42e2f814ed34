//! What is written anew does what the original does.

use super::super::{Move, parse, restart, trace};
use super::*;
use crate::geom::{V2, similarity};
use proptest::prelude::*;

fn rewritten(text: &str, placing: Similarity, laser: bool, from: Option<Restart>) -> String {
    let mut rewriter = Rewriter::new(P3::origin(), placing, laser, from);
    let lines: Vec<String> = text.lines().flat_map(|line| rewriter.line(line).unwrap()).collect();
    rewriter.finish().unwrap();
    lines.join("\n") + "\n"
}

fn burns(text: &str) -> Vec<Move> {
    trace(&parse(text).unwrap()).unwrap().into_iter().filter(Move::burns).collect()
}

fn places(moves: &[Move]) -> Vec<P3> {
    moves.iter().flat_map(|m| (0..=8).map(|k| m.point_at(f64::from(k) / 8.0))).collect()
}

const JOB: &str = "; furbelow\n; machine: k40\nG20G90M4S0\nG0X1Y1\nM8\nG91G1X1F60S400\nG3X0Y1J.5S300\nG90G92X0Y0\nG1X.5\nG21\nM9\nG0X0Y0S0\nG4P.2\nM5\nM2\n";

#[test]
fn inches_increments_and_shifts_become_plain_millimetres() {
    let text = rewritten(JOB, Similarity::identity(), true, None);
    let expected = "; furbelow\n; machine: k40\nG21G90G94G17G54M5S0\nM4S0\nG0X25.4Y25.4\nM8\nG1X50.8S400F1524\nG3X50.8Y50.8I0J12.7S300\nG1X63.5\nM9\nG0X50.8S0\nG4P0.2\nM5S0\nM2\n";
    assert_eq!(text, expected);
    assert_eq!(rewritten(&text, Similarity::identity(), true, None), text, "once more changes nothing");
}

#[test]
fn a_program_is_turned_shifted_and_stretched_as_a_whole() {
    let crosses = [P2::new(10.0, 10.0), P2::new(110.0, 10.0)];
    let found = [P2::new(20.0, 5.0), P2::new(20.0, 105.2)];
    let placing = similarity(crosses, found).unwrap();
    let text = "G21G90M4S0\nG0X10Y10\nG1X30S500F600\nG2X50Y10I10J0\nG1Y40\nM5\n";
    let moved = rewritten(text, placing, true, None);
    for (a, b) in places(&burns(text)).into_iter().zip(places(&burns(&moved))) {
        assert!((placing * a.xy() - b.xy()).norm() < 2e-3, "{a} {b}");
    }
    assert_eq!(burns(&moved).iter().map(|m| m.feed_mm_per_min).fold(0.0, f64::max), 600.0);
}

#[test]
fn a_job_that_is_taken_up_says_all_modes_and_travels_dark() {
    let from = Some(Restart { line: 7, along_mm: 20.0 });
    let text = rewritten(JOB, Similarity::identity(), true, from);
    let lines: Vec<&str> = text.lines().collect();
    let arc = (lines[5].strip_prefix("G3"), burns(&text)[0]);
    assert_eq!(lines[..2], ["; furbelow", "; machine: k40"]);
    assert!(lines[2] == "G21G90G94G17G54M5S0" && lines[3].starts_with("G0X") && lines[4] == "M4S0", "{text}");
    assert!(lines[5] == "M8" && lines[6].starts_with("G3X50.8Y50.8I") && lines[6].ends_with("S300F1524"), "{text}");
    // 20 mm into a half circle of 12.7 mm.
    let turn = 20.0 / 12.7 - std::f64::consts::FRAC_PI_2;
    let place = P2::new(50.8 + 12.7 * turn.cos(), 38.1 + 12.7 * turn.sin());
    assert!((arc.1.from.xy() - place).norm() < 1e-3, "{place} {arc:?}");
    assert!(text.ends_with("G1X63.5\nM9\nG0X50.8S0\nG4P0.2\nM5S0\nM2\n"), "{text}");
}

#[test]
fn a_pen_is_up_while_it_travels_to_where_it_goes_on() {
    let servo = "G21G90\nM3S40\nG4P0.2\nG0X5Y5\nM3S90\nG4P0.2\nG1X9F900\nM3S40\nG4P0.2\nG0X0Y0\nM5\n";
    let text = rewritten(servo, Similarity::identity(), false, Some(Restart { line: 4, along_mm: 1e9 }));
    assert_eq!(text, "G21G90G94G17G54M5S0\nM3S40\nG0X5Y5\nM3S90\nG4P0.2\nG1X9F900\nM3S40\nG4P0.2\nG0X0Y0\nM5S0\n");
    let lift = "G21G90\nG0Z3\nX5Y5\nG1Z0F800\nX9\nG0Z3\nX0Y0\n";
    let text = rewritten(lift, Similarity::identity(), false, Some(Restart { line: 3, along_mm: 1e9 }));
    assert_eq!(text, "G21G90G94G17G54M5S0\nG0Z3\nX5Y5\nG1Z0F800\nX9\nG0Z3\nX0Y0\n");
}

#[test]
fn a_tool_with_a_height_goes_up_before_it_goes_anywhere() {
    // Up is where it began: what a stop in the depth has left of that nobody knows.
    let mill = "G21G90\nG0X5Y5\nG1Z-1F300\nX9\nG0Z0\nX20\nG1Z-1\nX30\nG0Z0\n";
    let text = rewritten(mill, Similarity::identity(), false, Some(Restart { line: 6, along_mm: 1e9 }));
    assert_eq!(text, "G21G90G94G17G54M5S0\nG0Z0\nX20Y5\nG1Z-1F300\nX30\nG0Z0\n");
    let text = rewritten(mill, Similarity::identity(), false, Some(Restart { line: 8, along_mm: 1.0 }));
    assert_eq!(text, "G21G90G94G17G54M5S0\nG0Z0\nX21Y5\nZ-1\nG1X30F300\nG0Z0\n");
    let text = rewritten("G21G90\nG0Z0\nX5\n", Similarity::identity(), false, None);
    assert_eq!(text, "G21G90G94G17G54M5S0\nG0Z0\nX0Y0\nX5\n", "it may stand deeper than the job takes it to");
}

#[test]
fn remarks_in_a_part_that_is_left_out_are_left_out() {
    let job = "; head\nG21G90\n; first\nG0X1\n; second\nG1X2F60\n; third\nX3\n";
    let text = rewritten(job, Similarity::identity(), true, Some(Restart { line: 6, along_mm: 0.0 }));
    assert_eq!(text, "; head\nG21G90G94G17G54M5S0\nG0X1Y0\nG1X2F60\n; third\nX3\n");
}

#[test]
fn a_program_that_works_before_it_travels_is_led_to_its_start_first() {
    let placing = Similarity::new(V2::new(100.0, 50.0), 0.0, 1.0);
    let laser = "G21G90\nM4S500F600\nG1X10\nY10\n";
    assert_eq!(rewritten(laser, placing, true, None), "G21G90G94G17G54M5S0\nM4S0\nG0X100Y50\nG1X110S500F600\nY60\n");
    let servo = "G21G90\nM3S90\nG4P0.2\nG1X10F600\nM3S40\n";
    assert_eq!(
        rewritten(servo, placing, false, None),
        "G21G90G94G17G54M5S0\nM3S90\nG4P0.2\nM5S0\nG0X100Y50\nM3S90\nG4P0.2\nG1X110F600\nM3S40\n"
    );
    let dot = "G21G90\nG1F600M3S9\nG4P0.5\nG0X5\n";
    assert_eq!(rewritten(dot, placing, true, None), "G21G90G94G17G54M5S0\nM3S0\nG0X100Y50\nS9\nG4P0.5\nX105S0\n",);
}

#[test]
fn what_only_the_machine_knows_is_refused_with_its_line() {
    for line in ["G28", "G53G0X0", "G55", "G10L20P1X0"] {
        let mut rewriter = Rewriter::new(P3::origin(), Similarity::identity(), true, None);
        rewriter.line("G21G90").unwrap();
        let error = rewriter.line(line).unwrap_err().to_string();
        assert!(error.starts_with("line 2: G") && error.contains("only the machine knows"), "{error}");
    }
    let mut rewriter =
        Rewriter::new(P3::origin(), Similarity::identity(), true, Some(Restart { line: 9, along_mm: 0.0 }));
    rewriter.line("G0X1").unwrap();
    assert!(rewriter.finish().is_err());
}

proptest! {
    #[test]
    fn wherever_it_is_taken_up_what_is_burnt_is_the_rest(
        steps in prop::collection::vec((0.0..20.0_f64, 0.0..20.0_f64, 0..4_u8), 2..12),
        share in 0.0..1.0_f64,
    ) {
        let mut text = String::from("G21G90M4S0\n");
        let mut at = P2::origin();
        for (x, y, kind) in &steps {
            let to = P2::new((x * 1e3).round() / 1e3, (y * 1e3).round() / 1e3);
            let offset = (to - at) * 0.5;
            text += &match kind {
                0 => format!("G0X{}Y{}S0\n", to.x, to.y),
                3 if offset.norm() > 0.5 => format!("G2X{}Y{}I{:.3}J{:.3}S200F900\n", to.x, to.y, offset.x, offset.y),
                _ => format!("G1X{}Y{}S500F1200\n", to.x, to.y),
            };
            at = to;
        }
        let whole = trace(&parse(&text).unwrap()).unwrap();
        let line = 2 + ((steps.len() - 1) as f64 * share) as usize;
        let lengths: f64 = whole.iter().filter(|m| m.line == line).map(Move::length_mm).sum();
        let from = Restart { line, along_mm: lengths * share };
        let rest = rewritten(&text, Similarity::identity(), true, Some(from));
        let burnt = |moves: &[Move]| moves.iter().filter(|m| m.burns()).map(Move::length_mm).sum::<f64>();
        let before: Vec<Move> = whole.iter().filter(|m| m.line < line).copied().collect();
        let of_line: f64 = if burnt(&whole.iter().filter(|m| m.line == line).copied().collect::<Vec<_>>()) > 0.0 { from.along_mm } else { 0.0 };
        let left = burnt(&whole) - burnt(&before) - of_line;
        let told = trace(&parse(&rest).unwrap()).unwrap();
        prop_assert!((burnt(&told) - left).abs() < 0.02, "{} {left}\n{text}\n{rest}", burnt(&told));
        // It fires nowhere before the place it goes on from.
        let first = told.iter().position(Move::burns).unwrap_or(told.len());
        prop_assert!(told[..first].iter().all(|m| m.beam == Beam::Off || m.power_s == 0.0 || !m.feeds()));
        let place = restart(text.lines().map(|l| Ok(l.to_owned())), P3::origin(), from, true, None).unwrap();
        if let Some(place) = place {
            prop_assert!(place.line <= from.line || burnt(&told) <= left + 0.02);
        }
    }
}

#[test]
fn a_similarity_needs_two_places() {
    let p = P2::new(3.0, 4.0);
    assert_eq!(similarity([p, p], [p, P2::origin()]), None);
    let shifted = similarity([P2::origin(), p], [P2::origin() + V2::x(), p + V2::x()]).unwrap();
    assert!((shifted * p - (p + V2::x())).norm() < 1e-12 && (shifted.scaling() - 1.0).abs() < 1e-12);
}
