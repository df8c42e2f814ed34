//! A program on its bed: what a dry run shows.

use crate::gcode::{Action, Beam, Move, Timing};
use crate::geom::{P2, Rect, V2};

/// The machine a program is shown on.
#[derive(Debug, Clone, PartialEq)]
pub struct Bed {
    /// Name of the machine.
    pub machine: String,
    /// What the head reaches, mm in work coordinates.
    pub reach: Rect,
    /// What stands on the bed: its name, and where, mm.
    pub keep_outs: Vec<(String, Rect)>,
    /// The S word of full power (GRBL $30).
    pub max_s: f64,
    /// Light that leaves the lens at full power, W; `None` when nobody knows.
    pub optical_power_w: Option<f64>,
    /// True when the tool burns; a knife or a pen works wherever it moves at a feed.
    pub laser: bool,
}

/// Which way a sheet's grain runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GrainRun {
    /// Along x; along y otherwise.
    pub along_x: bool,
    /// False when the stock does not say and the usual is taken.
    pub known: bool,
}

/// The sheet a program cuts, as it lies on the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Stock {
    /// "A4".
    pub name: String,
    /// Its lower left corner, mm in work coordinates.
    pub at: P2,
    /// Along x, mm.
    pub width_mm: f64,
    /// Along y, mm.
    pub height_mm: f64,
    /// How its grain runs; `None` when it has none or nobody knows of any.
    pub grain: Option<GrainRun>,
}

/// One program, ready to be shown.
#[derive(Debug, Clone)]
pub struct Run<'a> {
    /// Heading: "sheet-01".
    pub name: String,
    /// The program as it stands in its file.
    pub text: String,
    /// What it makes the machine do.
    pub moves: &'a [Move],
    /// How long each move takes on the bed's machine.
    pub timing: Timing,
    /// The sheet, when it is known.
    pub stock: Option<Stock>,
    /// Lettering on the sheet, such as names of pieces, each with its middle, mm.
    pub labels: Vec<(P2, String)>,
    /// Lines people should read beside the picture.
    pub notes: Vec<String>,
}

/// What cuts and travels of a run come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lengths {
    /// With the tool at work, mm.
    pub cut_mm: f64,
    /// With it off the sheet, mm.
    pub travel_mm: f64,
}

impl Run<'_> {
    pub(super) fn lengths(&self, bed: &Bed) -> Lengths {
        let sum =
            |working: bool| self.moves.iter().filter(|m| m.works(bed.laser) == working).map(Move::length_mm).sum();
        Lengths { cut_mm: sum(true), travel_mm: sum(false) }
    }

    /// The box around all moves, mm.
    pub(super) fn bounds(&self) -> Rect {
        let moving = self.moves.iter().filter(|m| !matches!(m.action, Action::Dwell { .. } | Action::Stop));
        moving.fold(Rect::EMPTY, |bounds, m| bounds.union(m.bounds()))
    }
}

impl Stock {
    /// Where it lies, mm in work coordinates.
    pub fn rect(&self) -> Rect {
        Rect { min: self.at, max: self.at + V2::new(self.width_mm, self.height_mm) }
    }
}

impl Bed {
    /// Share of full power commanded in a move, 0 when the laser is off; 1 for a knife or a pen at work.
    pub(super) fn power(&self, m: &Move) -> f64 {
        match m.works(self.laser) {
            true if self.laser => m.power_s / self.max_s,
            works => f64::from(u8::from(works)),
        }
    }

    /// Energy a burning move leaves per length, J/mm for `optical_power_w` watts or for one: E = p W t / L. Under M4 power follows speed, so that
    /// it is what the commanded feed would leave; under M3 what the true time leaves.
    pub(super) fn energy_j_per_mm(&self, m: &Move, time_s: f64) -> f64 {
        let watts = self.power(m) * self.optical_power_w.unwrap_or(1.0);
        let length_mm = m.length_mm();
        match m.beam {
            Beam::Off => 0.0,
            _ if watts == 0.0 || length_mm == 0.0 => 0.0,
            Beam::Dynamic => watts * 60.0 / m.feed_mm_per_min,
            Beam::Constant => watts * time_s / length_mm,
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::gcode::{Limits, estimate, parse, trace};

    pub(crate) fn bed() -> Bed {
        Bed {
            machine: "test-bed".into(),
            reach: Rect::from_size(400.0, 300.0),
            keep_outs: vec![("magnet".into(), Rect { min: P2::new(350.0, 0.0), max: P2::new(370.0, 20.0) })],
            max_s: 1000.0,
            optical_power_w: Some(5.0),
            laser: true,
        }
    }

    pub(crate) fn moves(text: &str) -> Vec<Move> {
        trace(&parse(text).unwrap()).unwrap()
    }

    pub(crate) fn run<'a>(text: &str, moves: &'a [Move]) -> Run<'a> {
        Run {
            name: "sheet-01".into(),
            text: text.into(),
            moves,
            timing: estimate(moves, &Limits::USUAL),
            stock: Some(Stock {
                name: "A4".into(),
                at: P2::origin(),
                width_mm: 297.0,
                height_mm: 210.0,
                grain: Some(GrainRun { along_x: true, known: false }),
            }),
            labels: vec![(P2::new(20.0, 20.0), "A1".into())],
            notes: Vec::new(),
        }
    }

    #[test]
    fn constant_power_leaves_more_where_the_machine_is_slow_and_dynamic_power_does_not() {
        let short = |mode: &str| {
            let moves = moves(&format!("{mode}S500\nG1X0.2F6000"));
            let time_s = estimate(&moves, &Limits::USUAL).move_s[1];
            bed().energy_j_per_mm(&moves[1], time_s)
        };
        // 2.5 W at 100 mm/s.
        assert!((short("M4") - 0.025).abs() < 1e-12);
        // 0.2 mm from rest to rest at 500 mm/s2 take 40 ms: 0.1 J.
        assert!((short("M3") - 0.5).abs() < 1e-9);
    }

    #[test]
    fn lengths_and_bounds_tell_cuts_from_travels() {
        let text = "M4S0\nG0X10\nG1X30S300F600\nG0Y40S0\nG4P1";
        let moves = moves(text);
        let run = run(text, &moves);
        assert_eq!(run.lengths(&bed()), Lengths { cut_mm: 20.0, travel_mm: 50.0 });
        assert_eq!(run.bounds(), Rect::from_size(30.0, 40.0));
    }
}
