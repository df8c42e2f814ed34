//! Plots: the same toolpath as HP-GL, which most roll cutters speak, and back to moves.
//!
//! HP-GL knows no arcs that all cutters draw alike, no feed in mm/min and no power: curves are chords, speed is VS in cm/s and force FS in gf, both of
//! which many cutters leave to their panel. 40 steps are a millimetre (Hewlett-Packard, The HP-GL/2 and HP RTL Reference Guide, 1997).

use super::emit::{Error, check_contour};
use super::{Action, Beam, Move};
use crate::geom::{P2, P3};
use crate::toolpath::Toolpath;
use std::fmt::Write as _;

/// Steps of a plotter in a millimetre.
const STEPS_PER_MM: f64 = 40.0;

/// How far chords may leave an arc, mm: with their ends rounded to steps (0.018 mm at most) they stay within one step of it.
const CHORD_MM: f64 = 0.005;

/// Corners in one PD command: small plotters read a line of a few hundred bytes at once.
const CORNERS_PER_LINE: usize = 16;

/// Farthest a plot may reach, steps: what 32 bits hold on the plotters that hold least.
const MAX_STEPS: f64 = 8_388_607.0;

/// What a plotter is told beside the way.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Plotter {
    /// Speed with the tool down, mm/s; `None` leaves it to the cutter.
    pub speed_mm_per_s: Option<f64>,
    /// Force on the blade, gf; `None` leaves it to the cutter.
    pub force_gf: Option<f64>,
}

/// A place in a text that is no plot.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {problem}, found {found:?}")]
pub struct PlotError {
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub problem: &'static str,
    /// What stands there.
    pub found: String,
}

/// Writes a toolpath as a plot. The tool is up on every travel and at the end, which is at the park point.
///
/// # Errors
/// A run that cannot be written, or that reaches below zero or beyond what a plotter counts.
pub fn emit_plot(toolpath: &Toolpath, plotter: &Plotter) -> Result<String, Error> {
    let mut text = String::from("IN;PA;SP1;\n");
    let mut put = |words: std::fmt::Arguments| text.write_fmt(words).expect("a String grows");
    if let Some(speed) = plotter.speed_mm_per_s {
        put(format_args!("VS{};\n", (speed / 10.0).round().max(1.0)));
    }
    if let Some(force) = plotter.force_gf {
        put(format_args!("FS{};\n", force.round().max(1.0)));
    }
    let mut at = None;
    for contour in &toolpath.contours {
        check_contour(contour)?;
        let mut points: Vec<[i64; 2]> = Vec::new();
        let flat = contour.path.flatten(CHORD_MM);
        let closing = contour.path.closed.then(|| flat[0]);
        for p in flat.iter().chain(closing.iter()) {
            let point = steps(*p).ok_or_else(|| Error::Contour {
                piece: contour.piece.clone(),
                role: contour.role.class(),
                flaw: "it lies below zero, or farther than a plotter counts; move the job",
            })?;
            if points.last() != Some(&point) {
                points.push(point);
            }
        }
        if at != Some(points[0]) {
            for p in contour.way.iter().filter_map(|p| steps(*p)).chain([points[0]]) {
                put(format_args!("PU{},{};\n", p[0], p[1]));
            }
        }
        for chunk in points[1..].chunks(CORNERS_PER_LINE) {
            let corners: Vec<String> = chunk.iter().map(|p| format!("{},{}", p[0], p[1])).collect();
            put(format_args!("PD{};\n", corners.join(",")));
        }
        at = points.last().copied();
    }
    for p in toolpath.home.iter().copied().chain([toolpath.park]).filter_map(steps) {
        put(format_args!("PU{},{};\n", p[0], p[1]));
    }
    put(format_args!("SP0;\n"));
    Ok(text)
}

fn steps(p: P2) -> Option<[i64; 2]> {
    let step = |v: f64| (v * STEPS_PER_MM).round();
    let counts = |v: f64| (0.0..=MAX_STEPS).contains(&v);
    let (x, y) = (step(p.x) + 0.0, step(p.y) + 0.0);
    (counts(x) && counts(y)).then_some([x as i64, y as i64])
}

/// True for a text that begins like a plot rather than like G-code.
pub fn is_plot(text: &str) -> bool {
    let start: String = text.chars().filter(|c| !c.is_whitespace() && *c != ';').take(2).collect();
    ["IN", "PA", "PU", "PD", "SP", "DF"].contains(&start.to_ascii_uppercase().as_str())
}

/// Carries a plot out: what the plotter does, command by command. `feed_mm_per_min` is taken where the plot names no speed.
///
/// # Errors
/// The first command that is none, or whose numbers are none.
pub fn trace_plot(text: &str, feed_mm_per_min: f64) -> Result<Vec<Move>, PlotError> {
    let mut pen = PenState { at: P3::origin(), down: false, relative: false, feed_mm_per_min };
    let mut moves = Vec::new();
    for (index, line) in text.split('\n').enumerate() {
        let mut rest = line.trim();
        while let Some(start) = rest.find(|c: char| !(c.is_whitespace() || c == ';')) {
            rest = &rest[start..];
            let failed = |problem, found: &str| PlotError { line: index + 1, problem, found: found.to_owned() };
            let word = rest.get(..2).filter(|w| w.chars().all(|c| c.is_ascii_alphabetic()));
            let word = word.ok_or_else(|| failed("a command is two letters such as PU or PD", rest))?;
            rest = &rest[2..];
            let end = rest.find(|c: char| c == ';' || c.is_ascii_alphabetic()).unwrap_or(rest.len());
            let numbers: Option<Vec<f64>> = rest[..end]
                .split(|c: char| c == ',' || c.is_whitespace())
                .filter(|part| !part.is_empty())
                .map(|part| part.parse::<f64>().ok().filter(|v| v.is_finite() && v.abs() <= MAX_STEPS))
                .collect();
            let numbers = numbers.ok_or_else(|| failed("numbers are separated by commas", &rest[..end]))?;
            pen.obey(word, &numbers, index + 1, &mut moves).map_err(|problem| failed(problem, word))?;
            rest = &rest[end..];
        }
    }
    Ok(moves)
}

struct PenState {
    at: P3,
    down: bool,
    relative: bool,
    feed_mm_per_min: f64,
}

impl PenState {
    fn obey(&mut self, word: &str, numbers: &[f64], line: usize, moves: &mut Vec<Move>) -> Result<(), &'static str> {
        match word.to_ascii_uppercase().as_str() {
            "IN" | "DF" => (self.down, self.relative) = (false, false),
            "PU" => self.down = false,
            "PD" => self.down = true,
            "PA" => self.relative = false,
            "PR" => self.relative = true,
            "VS" => {
                if let Some(speed) = numbers.first() {
                    self.feed_mm_per_min = speed * 600.0;
                }
                return Ok(());
            }
            // Force, pen, line type, input window: nothing moves.
            "SP" | "FS" | "LT" | "IP" | "SC" | "RO" => return Ok(()),
            _ => return Err("this command is not known here; write the plot with PU, PD, PA and PR"),
        }
        if !numbers.len().is_multiple_of(2) {
            return Err("coordinates come in pairs");
        }
        for pair in numbers.chunks(2) {
            let by = P3::new(pair[0] / STEPS_PER_MM, pair[1] / STEPS_PER_MM, 0.0);
            let to = if self.relative { self.at + by.coords } else { by };
            let from = std::mem::replace(&mut self.at, to);
            moves.push(Move {
                line,
                action: if self.down { Action::Line } else { Action::Rapid },
                from,
                to,
                feed_mm_per_min: self.feed_mm_per_min,
                power_s: 0.0,
                beam: Beam::Off,
                feeding: self.down,
                // A plotter keeps up with its line: nothing waits for bytes.
                bytes: 0,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::emit::tests::{contour, toolpath};
    use super::*;
    use crate::drawing::Role;
    use crate::geom::{Path, distance_to_segment};
    use crate::toolpath::Air;
    use proptest::prelude::*;

    #[test]
    fn a_plot_reads_like_this() {
        let square = Path::closed([(1.0, 1.0), (2.0, 1.0), (2.0, 2.0)].map(|(x, y)| P2::new(x, y)));
        let path = toolpath(vec![contour(square, Role::Outline, Air::Off)]);
        let plotter = Plotter { speed_mm_per_s: Some(50.0), force_gf: Some(130.0) };
        let text = emit_plot(&path, &plotter).unwrap();
        assert_eq!(text, "IN;PA;SP1;\nVS5;\nFS130;\nPU40,40;\nPD80,40,80,80,40,40;\nPU0,0;\nSP0;\n");
        assert!(is_plot(&text) && !is_plot("G21G90\n") && !is_plot("; comment"));
        assert_eq!(trace_plot(&text, 1.0).unwrap()[1].feed_mm_per_min, 3000.0);
    }

    #[test]
    fn foreign_plots_are_read_however_they_are_spaced_and_what_is_none_is_refused_by_line() {
        let moves = trace_plot("IN; SP1 ;PU0 0 PD 400,0;PR;PD0,400;PU;PA0,0", 600.0).unwrap();
        let ends: Vec<(f64, f64, bool)> = moves.iter().map(|m| (m.to.x, m.to.y, m.feeds())).collect();
        assert_eq!(ends, [(0.0, 0.0, false), (10.0, 0.0, true), (10.0, 10.0, true), (0.0, 0.0, false)]);
        for (text, word) in [("IN;\nXX1;", "XX"), ("IN;\nPU1;", "PU"), ("IN;\nPU1,?2;", "?2"), ("IN;\n5;", "5")] {
            let error = trace_plot(text, 600.0).unwrap_err();
            assert!(error.line == 2 && error.to_string().contains(word), "{error}");
        }
    }

    #[test]
    fn what_lies_below_zero_is_refused() {
        let path = Path::open([P2::new(-1.0, 0.0), P2::new(5.0, 0.0)]);
        assert!(emit_plot(&toolpath(vec![contour(path, Role::Slit, Air::Off)]), &Plotter::default()).is_err());
    }

    proptest! {
        #[test]
        fn a_plot_read_back_is_the_toolpath_to_a_fortieth_of_a_millimetre(
            arcs in prop::collection::vec((10.0..300.0f64, 10.0..300.0f64, 0.5..9.0f64, -1.0..1.0f64), 1..6),
        ) {
            let runs: Vec<_> = arcs.iter().map(|(x, y, size, bulge)| {
                let mut path = Path::open([P2::new(*x, *y), P2::new(x + size, *y), P2::new(x + size, y + size)]);
                path.vertices[0].bulge = *bulge;
                contour(path, Role::Slit, Air::Off)
            }).collect();
            let text = emit_plot(&toolpath(runs.clone()), &Plotter::default()).unwrap();
            let moves = trace_plot(&text, 600.0).unwrap();
            let drawn: Vec<&[Move]> = moves.split(|m| !m.feeds()).filter(|run| !run.is_empty()).collect();
            prop_assert_eq!(drawn.len(), runs.len());
            for (run, wanted) in drawn.iter().zip(&runs) {
                let off = |p: P2| run.iter().map(|m| distance_to_segment(p, m.from.xy(), m.to.xy())).fold(f64::INFINITY, f64::min);
                for p in wanted.path.flatten(0.001) {
                    prop_assert!(off(p) <= 1.0 / STEPS_PER_MM + 0.001, "{}", off(p));
                }
                prop_assert!((run[run.len() - 1].to.xy() - wanted.path.end().unwrap()).norm() <= 0.018);
            }
        }
    }
}
