//! What sending needs to know of a file, taken in while it is checked: nothing of it is held.

use super::plan::{Plan, Planned};
use super::preflight::Demand;
use crate::gcode::{Move, Witness};

/// What a program asks of the machine, and when.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Survey {
    /// Where it goes and how bright.
    pub demand: Demand,
    /// When its lines should be done.
    pub plan: Plan,
}

impl Witness for Survey {
    fn asked(&mut self, m: &Move) {
        self.demand.add(m);
    }

    fn took(&mut self, m: &Move, seconds: f64) {
        self.plan.add(m.line, Planned::of(m, seconds));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::{CheckSettings, Checker, Limits, estimate, parse, trace};
    use crate::geom::Rect;

    #[test]
    fn a_file_read_by_lines_is_surveyed_as_one_held_in_memory_is() {
        let text = "; head\nG21G90M4S0\nG0X10Y10\nG1X60S500F600\nG3X60Y30J10\n\nG4P0.5\nG0X0Y0\nM5\n";
        let settings = CheckSettings {
            work_area: Rect::from_size(100.0, 100.0),
            travel_z_mm: 0.0,
            keep_outs: Vec::new(),
            max_s: 1000.0,
            limits: Limits::USUAL,
            laser: true,
            laser_mode: true,
            mist: false,
            strike_floor: 0.0,
            energy: None,
        };
        let mut survey = Survey::default();
        let mut checker = Checker::watched(&settings, &mut survey);
        checker.read(text.as_bytes(), |_| ()).unwrap();
        let report = checker.finish();
        let moves = trace(&parse(text).unwrap()).unwrap();
        assert_eq!(survey.demand, Demand::of(&moves));
        let timing = estimate(&moves, &Limits::USUAL);
        assert!((survey.plan.total().total_s() - report.time_s).abs() < 1e-9);
        for line in 1..=9 {
            let planned: f64 =
                moves.iter().zip(&timing.move_s).filter(|(m, _)| m.line <= line).map(|(_, seconds)| seconds).sum();
            assert!((survey.plan.until(line).total_s() - planned).abs() < 1e-9, "line {line}");
        }
        assert!((survey.plan.total().rest_s - 0.5).abs() < 0.02 && survey.plan.total().travel_s > 0.1);
    }
}
