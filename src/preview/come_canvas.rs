//! The picture of a program that was interrupted: what is surely done, what may be, and what is left.

use super::canvas::{Canvas, Colour};
use super::run::{Bed, Run};
use super::run_canvas::{flattened, stretch};
use super::shade::ColorBy;
use super::sheet::{MoveKind, Pen, SheetMove, SheetView, sheet_canvas};
use crate::gcode::Move;

/// Width of a cut's line, hundredths of the sheet's longer side.
const CUT_WEIGHT: f64 = 0.2;

/// How far a program has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Come {
    /// The first line that is not surely done, from 1.
    pub line: usize,
    /// How much of that line's way is surely done, mm.
    pub along_mm: f64,
    /// The last line of which something may be done.
    pub maybe: usize,
}

/// Draws a program on its sheet and bed: cuts that are surely made grey, those in doubt red, those left blue, with the length of each in the key. To be
/// held against the sheet itself.
pub fn come_canvas(run: &Run, bed: &Bed, come: Come) -> Canvas {
    let pen = |name: &str, colour: Colour| Pen { name: name.into(), colour, weight: CUT_WEIGHT, dashed: false };
    let pens = [
        Pen { name: "travel".into(), colour: Colour::PALE, ..MoveKind::Travel.pen() },
        pen("left", Colour::BLUE),
        pen("surely cut", Colour::GREY),
        pen("may be cut", Colour::RED),
    ];
    let cuts = ColorBy::Power.values(run, bed).into_iter().map(|value| value.is_some());
    let (mut line, mut before_mm) = (0, 0.0);
    let mut moves = Vec::new();
    for (m, cut) in run.moves.iter().zip(cuts).filter(|(m, _)| m.length_mm() > 0.0) {
        before_mm = if m.line == line { before_mm } else { 0.0 };
        line = m.line;
        if cut {
            moves.extend(parts(m, before_mm, come));
        } else {
            moves.push(SheetMove { points: flattened(m), pen: 0 });
        }
        before_mm += m.length_mm();
    }
    sheet_canvas(&SheetView {
        title: &run.name,
        stock: run.stock.as_ref(),
        reach: Some(bed.reach),
        keep_outs: &bed.keep_outs,
        pens: &pens,
        moves: &moves,
        piece_names: run.labels.clone(),
        legend: vec![format!("surely done: lines to {}, in doubt: to {}", come.line.saturating_sub(1), come.maybe)],
    })
}

/// A cut with its pens: one whole, or what is surely done of it and what is in doubt.
fn parts(m: &Move, before_mm: f64, come: Come) -> Vec<SheetMove> {
    const LEFT: usize = 1;
    const SURE: usize = 2;
    const DOUBT: usize = 3;
    let whole = |pen| vec![SheetMove { points: flattened(m), pen }];
    // What was sent may be done, seen or not.
    let rest = if m.line <= come.maybe { DOUBT } else { LEFT };
    if m.line < come.line {
        return whole(SURE);
    }
    let done = (come.along_mm - before_mm) / m.length_mm();
    match done {
        _ if m.line > come.line || done <= 0.0 => whole(rest),
        _ if done >= 1.0 => whole(SURE),
        _ => vec![
            SheetMove { points: stretch(m, 0.0, done), pen: SURE },
            SheetMove { points: stretch(m, done, 1.0), pen: rest },
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::super::run::tests::{bed, moves, run};
    use super::*;

    #[test]
    fn a_cut_is_sure_up_to_where_the_head_was_seen_and_in_doubt_up_to_what_was_sent() {
        let text = "M4S100\nG0X10Y10\nG1X60F1200\nG3X60Y50I0J20\nG1X10\nY10\nM5";
        let moves = moves(text);
        let come = Come { line: 4, along_mm: 20.0, maybe: 5 };
        let lengths = |pen: usize| -> f64 {
            let cuts = moves.iter().filter(|m| m.burns()).flat_map(|m| parts(m, 0.0, come));
            let of_pen: Vec<SheetMove> = cuts.filter(|part| part.pen == pen).collect();
            of_pen.iter().flat_map(|part| part.points.windows(2)).map(|w| (w[1] - w[0]).norm()).sum()
        };
        let arc_mm = 20.0 * std::f64::consts::PI;
        for (pen, expected) in [(1, 40.0), (2, 50.0 + 20.0), (3, arc_mm - 20.0 + 50.0)] {
            assert!((lengths(pen) - expected).abs() < 0.1, "{pen}: {}", lengths(pen));
        }
        let svg = come_canvas(&run(text, &moves), &bed(), come).to_svg();
        assert!([Colour::BLUE, Colour::GREY, Colour::RED].iter().all(|colour| svg.contains(&colour.hex())));
    }
}
