//! What a program does: the only interpreter of G-code in the house.
//!
//! Follows GRBL 1.1's gcode.c: modal state, the order in which a line's words act, arcs by I and J, and which words make the machine come to rest.
//! Positions are work coordinates of G54 in mm, starting at the origin.

use super::words::{Motion, Said};
use super::{Action, Beam, Move, Program, Word};
use crate::geom::{P3, V2, cross};

/// GRBL turns arcs shorter than this into full circles (ARC_ANGULAR_TRAVEL_EPSILON).
const ARC_EPSILON_RAD: f64 = 5e-7;

/// A line that cannot be carried out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}: {problem}")]
pub struct TraceError {
    /// Line of the program, from 1.
    pub line: usize,
    /// What is wrong.
    pub problem: TraceProblem,
}

/// What is wrong with a line, with the error number GRBL would answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TraceProblem {
    /// A word outside the dialect.
    #[error("{0} is not understood (GRBL error:20); millimetres or inches, G54, the XY plane and arcs by I and J are")]
    Unsupported(Word),
    /// Two words of one modal group.
    #[error("{0} contradicts another word of the line (GRBL error:21); give one")]
    Clash(Word),
    /// A letter given twice.
    #[error("{0} is given twice (GRBL error:25); give one")]
    Repeated(Word),
    /// A feed, power or time below zero.
    #[error("{0} is below 0 (GRBL error:4)")]
    Negative(f64),
    /// G1, G2 or G3 without feed.
    #[error("a feed move without a feed (GRBL error:22); give F before or in this line")]
    NoFeed,
    /// An arc that does not say where to.
    #[error("an arc without X or Y (GRBL error:26); give its end")]
    NoArcEnd,
    /// An arc that does not say around what.
    #[error("an arc without I or J (GRBL error:35); give its centre from its start")]
    NoArcCentre,
    /// An arc whose end is not on its circle.
    #[error(
        "an arc that begins at radius {start_mm:.4} mm and ends at {end_mm:.4} mm (GRBL error:33); correct I and J"
    )]
    ArcRadius {
        /// Distance from start to centre, mm.
        start_mm: f64,
        /// Distance from end to centre, mm.
        end_mm: f64,
    },
    /// G4 without time.
    #[error("a dwell without P (GRBL error:28); give the seconds")]
    NoDwell,
    /// Axis words after G80.
    #[error("a position without a motion mode after G80 (GRBL error:31); give G0 or G1")]
    NoMotion,
}

/// True when GRBL refuses an arc whose ends lie at these distances from its centre (error 33, gcode.c).
pub(super) fn refuses_arc(start_mm: f64, end_mm: f64) -> bool {
    let difference = (end_mm - start_mm).abs();
    difference > 0.5 || (difference > 0.005 && difference > 0.001 * start_mm)
}

/// Carries a program out.
///
/// # Errors
/// The first line that GRBL or this interpreter would refuse.
pub fn trace(program: &Program) -> Result<Vec<Move>, TraceError> {
    let mut machine = Machine::new();
    for (i, line) in program.lines.iter().enumerate() {
        machine.line = i + 1;
        Said::of(line)
            .and_then(|said| machine.obey(&said))
            .map_err(|problem| TraceError { line: machine.line, problem })?;
    }
    Ok(machine.moves)
}

struct Machine {
    moves: Vec<Move>,
    line: usize,
    position: P3,
    motion: Motion,
    inches: bool,
    incremental: bool,
    feed_mm_per_min: f64,
    power_s: f64,
    beam: Beam,
    /// Mist (M7) and flood (M8).
    coolant: [bool; 2],
}

impl Machine {
    fn new() -> Machine {
        Machine {
            moves: Vec::new(),
            line: 0,
            position: P3::origin(),
            motion: Motion::Rapid,
            inches: false,
            incremental: false,
            feed_mm_per_min: 0.0,
            power_s: 0.0,
            beam: Beam::Off,
            coolant: [false; 2],
        }
    }

    fn obey(&mut self, said: &Said) -> Result<(), TraceProblem> {
        self.inches = said.inches.unwrap_or(self.inches);
        let unit_mm = if self.inches { 25.4 } else { 1.0 };
        if let Some(f) = said.f {
            self.feed_mm_per_min = f * unit_mm;
        }
        if let Some(s) = said.s {
            // A new power in a motion changes on the fly; without motion the machine stops for it (gcode.c, GC_PARSER_LASER_ISMOTION).
            let stops = s != self.power_s && self.beam != Beam::Off && !said.has_axes();
            self.power_s = s;
            if stops {
                self.stand(Action::Stop);
            }
        }
        if let Some(spindle) = said.spindle {
            let beam = match spindle {
                3 => Beam::Constant,
                4 => Beam::Dynamic,
                _ => Beam::Off,
            };
            if std::mem::replace(&mut self.beam, beam) != beam {
                self.stand(Action::Stop);
            }
        }
        self.switch_coolant(&said.coolant);
        if said.dwell {
            let seconds = said.p.ok_or(TraceProblem::NoDwell)?;
            self.stand(Action::Dwell { seconds });
        }
        self.incremental = said.incremental.unwrap_or(self.incremental);
        self.motion = said.motion.unwrap_or(self.motion);
        if said.has_axes() {
            self.go(said, unit_mm)?;
        } else if matches!(said.motion, Some(Motion::ArcClockwise | Motion::ArcCounterClockwise)) {
            return Err(TraceProblem::NoArcEnd);
        }
        if said.pause || said.end {
            self.stand(Action::Stop);
        }
        if said.end {
            self.motion = Motion::Line;
            self.incremental = false;
            self.beam = Beam::Off;
            self.coolant = [false; 2];
        }
        Ok(())
    }

    fn switch_coolant(&mut self, words: &[u8]) {
        let before = self.coolant;
        for word in words {
            match word {
                7 => self.coolant[0] = true,
                8 => self.coolant[1] = true,
                _ => self.coolant = [false; 2],
            }
        }
        if self.coolant != before {
            self.stand(Action::Stop);
        }
    }

    fn go(&mut self, said: &Said, unit_mm: f64) -> Result<(), TraceProblem> {
        let axis = |word: Option<f64>, now: f64| match word {
            Some(v) if self.incremental => now + v * unit_mm,
            Some(v) => v * unit_mm,
            None => now,
        };
        let from = self.position;
        let to = P3::new(axis(said.x, from.x), axis(said.y, from.y), axis(said.z, from.z));
        let action = match self.motion {
            Motion::Rapid => Action::Rapid,
            Motion::Line => Action::Line,
            Motion::ArcClockwise => arc(said, from, to, unit_mm, true)?,
            Motion::ArcCounterClockwise => arc(said, from, to, unit_mm, false)?,
            Motion::Cancelled => return Err(TraceProblem::NoMotion),
        };
        if action != Action::Rapid && self.feed_mm_per_min == 0.0 {
            return Err(TraceProblem::NoFeed);
        }
        self.position = to;
        self.push(action, from, to);
        Ok(())
    }

    fn stand(&mut self, action: Action) {
        self.push(action, self.position, self.position);
    }

    fn push(&mut self, action: Action, from: P3, to: P3) {
        let Machine { line, feed_mm_per_min, power_s, beam, .. } = *self;
        self.moves.push(Move { line, action, from, to, feed_mm_per_min, power_s, beam });
    }
}

fn arc(said: &Said, from: P3, to: P3, unit_mm: f64, clockwise: bool) -> Result<Action, TraceProblem> {
    if said.x.is_none() && said.y.is_none() {
        return Err(TraceProblem::NoArcEnd);
    }
    if said.i.is_none() && said.j.is_none() {
        return Err(TraceProblem::NoArcCentre);
    }
    let offset = V2::new(said.i.unwrap_or(0.0), said.j.unwrap_or(0.0)) * unit_mm;
    let center = from.xy() + offset;
    let (start, end) = (-offset, to.xy() - center);
    let (start_mm, end_mm) = (start.norm(), end.norm());
    if start_mm == 0.0 || refuses_arc(start_mm, end_mm) {
        return Err(TraceProblem::ArcRadius { start_mm, end_mm });
    }
    // mc_arc: the turn from start to end, a full circle when they coincide.
    let mut sweep_rad = cross(start, end).atan2(start.dot(&end));
    if clockwise && sweep_rad >= -ARC_EPSILON_RAD {
        sweep_rad -= std::f64::consts::TAU;
    } else if !clockwise && sweep_rad <= ARC_EPSILON_RAD {
        sweep_rad += std::f64::consts::TAU;
    }
    Ok(Action::Arc { center, radius_mm: start_mm, sweep_rad })
}

#[cfg(test)]
mod tests {
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
            ("G54.1", 1, "error:20"),
            ("M6", 1, "error:20"),
            ("G55", 1, "error:20"),
            ("G1X1X2F1", 1, "error:25"),
            ("G0G1X1", 1, "error:21"),
            ("M3M5", 1, "error:21"),
            ("G2X1F1", 1, "error:35"),
            ("G2I1F1", 1, "error:26"),
            ("G2X10I2F1", 1, "error:33"),
            ("G2X1R5F1", 1, "R5 is not"),
            ("G4", 1, "error:28"),
            ("S-1", 1, "error:4"),
            ("G80X1", 1, "error:31"),
            ("G1.05X1", 1, "error:20"),
        ];
        for (text, line, words) in cases {
            let (at, message) = problem(text);
            assert_eq!(at, line, "{text}");
            assert!(message.contains(words), "{text}: {message}");
        }
    }

    #[test]
    fn an_arc_may_miss_its_circle_by_as_much_as_grbl_lets_pass() {
        assert!(!refuses_arc(10.0, 10.004) && !refuses_arc(100.0, 100.09));
        assert!(refuses_arc(1.0, 1.006) && refuses_arc(1000.0, 1000.6) && !refuses_arc(1000.0, 1000.4));
    }
}
