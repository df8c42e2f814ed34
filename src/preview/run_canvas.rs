//! The picture of a program, its cuts coloured by what they are told apart by.

use super::canvas::{Canvas, Colour};
use super::run::{Bed, Run};
use super::shade::{ColorBy, Scale, light};
use super::sheet::{MoveKind, Pen, SheetMove, SheetView, sheet_canvas};
use crate::gcode::{Action, Move};
use crate::geom::P2;

/// Colours a range of values is told by: as many as the eye keeps apart in a key.
const BINS: usize = 6;

/// Width of a cut's line, hundredths of the sheet's longer side.
const CUT_WEIGHT: f64 = 0.16;

/// Chords of a move may leave its curve by this much, mm: well under a pixel.
const PICTURE_MM: f64 = 0.02;

/// Chords one arc is drawn with at most, however large it is.
const MAX_CHORDS: usize = 2000;

/// Draws a program on its sheet and bed with the length of what is cut at each value in the key; travels are dashed.
pub fn run_canvas(run: &Run, bed: &Bed, by: ColorBy) -> Canvas {
    let values = by.values(run, bed);
    let scale = by.scale(std::slice::from_ref(run), bed);
    let mut pens = vec![Pen {
        name: if bed.laser { "laser off" } else { "tool up" }.into(),
        colour: Colour::GREY,
        ..MoveKind::Travel.pen()
    }];
    pens.extend(cut_pens(by, &scale, bed));
    let moving = run.moves.iter().zip(values).filter(|(m, _)| m.length_mm() > 0.0);
    let moves: Vec<SheetMove> = moving
        .map(|(m, value)| SheetMove { points: flattened(m), pen: value.map_or(0, |v| 1 + bin(&scale, v)) })
        .collect();
    let mut legend = vec![format!("planned time {} on {}", clock(run.timing.total_s), bed.machine)];
    // The lettering has no semicolon.
    legend.extend(run.notes.iter().map(|note| note.replace(';', ",")));
    sheet_canvas(&SheetView {
        title: &format!("{}: {}", run.name, what(by, bed)),
        stock: run.stock.as_ref(),
        reach: Some(bed.reach),
        keep_outs: &bed.keep_outs,
        pens: &pens,
        moves: &moves,
        piece_names: run.labels.clone(),
        legend,
    })
}

/// The way of a move as points, fine enough for any picture of a sheet.
pub fn flattened(m: &Move) -> Vec<P2> {
    stretch(m, 0.0, 1.0)
}

/// A stretch of the way, between two shares of it.
pub(super) fn stretch(m: &Move, from: f64, to: f64) -> Vec<P2> {
    let steps = match m.action {
        Action::Arc { radius_mm, .. } => {
            let chord = 2.0 * (2.0 * PICTURE_MM * radius_mm).sqrt();
            ((m.length_mm() / chord).ceil() as usize).clamp(1, MAX_CHORDS)
        }
        _ => 1,
    };
    (0..=steps).map(|i| m.point_at(from + (to - from) * i as f64 / steps as f64).xy()).collect()
}

fn what(by: ColorBy, bed: &Bed) -> &'static str {
    match by {
        ColorBy::Power if !bed.laser => "moves",
        ColorBy::Power => "power",
        ColorBy::Feed => "feed",
        ColorBy::Energy => "energy per mm",
        ColorBy::Order => "order of cutting",
    }
}

fn cut_pens(by: ColorBy, scale: &Scale, bed: &Bed) -> Vec<Pen> {
    let pen = |share: f64, name: String| Pen { name, colour: light(share), weight: CUT_WEIGHT, dashed: false };
    let unit = by.unit(bed);
    let tell = |value: f64| if by == ColorBy::Order { clock(value) } else { figures(value) };
    let with_unit = |text: String| if by == ColorBy::Order { text } else { format!("{text} {unit}") };
    if by == ColorBy::Power && !bed.laser {
        return vec![pen(1.0, "tool down".into())];
    }
    if !scale.steps.is_empty() {
        return scale.steps.iter().map(|v| pen(scale.share(*v), with_unit(tell(*v)))).collect();
    }
    let edge = |k: usize| scale.lo + (scale.hi - scale.lo) * k as f64 / BINS as f64;
    let bins = (0..BINS).map(|k| {
        let name = with_unit(format!("{} to {}", tell(edge(k)), tell(edge(k + 1))));
        pen(k as f64 / (BINS - 1) as f64, name)
    });
    bins.collect()
}

/// Which of [`cut_pens`] a value is drawn with.
fn bin(scale: &Scale, value: f64) -> usize {
    if scale.steps.is_empty() {
        return ((scale.share(value) * BINS as f64) as usize).min(BINS - 1);
    }
    let distance = |k: &usize| (scale.steps[*k] - value).abs();
    (0..scale.steps.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

/// Three significant figures without trailing zeros.
fn figures(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let decimals = (2 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// "m:ss".
fn clock(time_s: f64) -> String {
    let seconds = time_s.round() as u64;
    format!("{}:{:02}", seconds / 60, seconds % 60)
}

#[cfg(test)]
mod tests {
    use super::super::run::tests::{bed, moves, run};
    use super::*;

    #[test]
    fn figures_are_told_as_people_write_them() {
        let told = [1200.0, 50.0, 12.345, 0.25, 0.012_345, 0.0].map(figures);
        assert_eq!(told, ["1200", "50", "12.3", "0.25", "0.0123", "0"]);
        assert_eq!([0.2, 61.0, 3600.0].map(clock), ["0:00", "1:01", "60:00"]);
    }

    #[test]
    fn cuts_of_two_powers_are_drawn_in_two_colours_and_named_in_the_key() {
        let text = "M4S0\nG0X10Y10\nG1X60S80F1800\nG0Y20S0\nG1X10S500F1200\nG3X60I25\nM5";
        let moves = moves(text);
        let svg = run_canvas(&run(text, &moves), &bed(), ColorBy::Power).to_svg();
        for colour in [light(0.0), light(1.0)] {
            assert!(svg.contains(&colour.hex()), "{svg}");
        }
        let by_order = run_canvas(&run(text, &moves), &bed(), ColorBy::Order).to_svg();
        assert_ne!(svg, by_order);
        assert!(run_canvas(&run(text, &moves), &bed(), ColorBy::Energy).to_png(400).is_ok());
    }

    #[test]
    fn a_program_without_a_sheet_or_without_cuts_is_drawn_too() {
        for text in ["G0X10Y10", "M5", "M4S100\nG1X-50Y-20F100"] {
            let moves = moves(text);
            let bare = Run { stock: None, ..run(text, &moves) };
            assert!(run_canvas(&bare, &bed(), ColorBy::Feed).to_png(300).is_ok(), "{text}");
        }
    }

    #[test]
    fn every_value_has_a_pen() {
        let few = Scale { lo: 1.0, hi: 3.0, steps: vec![1.0, 3.0] };
        assert_eq!([0.0, 1.9, 2.1, 9.0].map(|v| bin(&few, v)), [0, 0, 1, 1]);
        let many = Scale { lo: 0.0, hi: 60.0, steps: Vec::new() };
        assert_eq!([0.0, 9.0, 11.0, 60.0].map(|v| bin(&many, v)), [0, 0, 1, 5]);
    }
}
