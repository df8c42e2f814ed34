//! The way a job should take: the moves of the lines between what is surely carried out and what was sent, and where on it a reported position is.
//!
//! A report says where the head is to a step of its motors. It must lie on one of the moves under way; the first of them that passes there is how far
//! the job has come at least, however often the way crosses itself. A report may be garbled and still make sense, so that only what two in a row agree
//! on counts: the lesser of two places, and a departure only when it is seen twice.

use std::collections::VecDeque;
use std::time::Duration;

use super::board::Board;
use super::ledger::Reached;
use super::pace::Pace;
use crate::gcode::{Action, Interpreter, Line, Move, parse_line};
use crate::geom::{P3, V3};

/// How far a report may lie beside the way beyond half a step and the chords of arcs, mm: three decimals in mm, four in inches.
const REPORT_MM: f64 = 0.02;

/// Steps for each mm where the board does not tell: the coarsest of the usual ones.
const STEPS_PER_MM: f64 = 40.0;

/// $12 where the board does not tell: GRBL's own, mm.
const ARC_TOLERANCE_MM: f64 = 0.002;

/// Reports in a row beside the way that are believed.
const DEPARTED_REPORTS: u32 = 2;

/// What a line makes the board do, at least.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Effect {
    /// Blocks it surely puts into the planner.
    pub(super) blocks: usize,
    /// It is answered only when all before it is carried out.
    pub(super) rests: bool,
}

/// The head is not where it should be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Departure {
    /// How far off, mm.
    pub(super) off_mm: f64,
    /// The line it is nearest to.
    pub(super) line: usize,
}

/// A place on the way; places are ordered along it.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
struct Spot {
    /// Moves before it, from the start of the job.
    nth: u64,
    along_mm: f64,
}

/// Nothing is earlier.
const START: Spot = Spot { nth: 0, along_mm: 0.0 };

/// A move under way.
#[derive(Debug, Clone, Copy)]
struct Leg {
    line: usize,
    /// How long the moves of the same line before it are, mm.
    before_mm: f64,
    way: Move,
}

/// The way of one job.
#[derive(Debug)]
pub(super) struct Course {
    /// `None` when where the program leads is known to the board only.
    interpreter: Option<Interpreter>,
    /// What G92.1 and G49 would leave of work zero is known.
    knows_shift: bool,
    legs: VecDeque<Leg>,
    /// Moves before the first of the legs.
    passed: u64,
    /// Where the legs begin.
    base: P3,
    steps_per_mm: [f64; 3],
    arc_tolerance_mm: f64,
    seen: Option<Spot>,
    sure: Option<Spot>,
    departed_reports: u32,
    pace: Pace,
}

impl Course {
    /// A way that begins where the head stands. Without modes, a position or work zero, nothing is known of it.
    pub(super) fn new(modes: Option<&Interpreter>, machine_mm: Option<[f64; 3]>, board: &Board) -> Course {
        let interpreter = || {
            let (mut interpreter, at, origin) = (modes?.clone(), machine_mm?, board.offset_mm?);
            interpreter.find(P3::from(at), V3::from(origin));
            Some(interpreter)
        };
        let setting =
            |number: u16, usual: f64| board.settings.get(&number).copied().filter(|v| *v > 0.0).unwrap_or(usual);
        Course {
            interpreter: interpreter(),
            knows_shift: board.shift_mm.is_some() && board.tool_length_mm.is_some(),
            legs: VecDeque::new(),
            passed: 0,
            base: machine_mm.map_or(P3::origin(), P3::from),
            steps_per_mm: std::array::from_fn(|axis| setting(100 + axis as u16, STEPS_PER_MM)),
            arc_tolerance_mm: setting(12, ARC_TOLERANCE_MM),
            seen: None,
            sure: None,
            departed_reports: 0,
            pace: Pace::new(board),
        }
    }

    /// What its lines leave in effect, and where they end; `None` when that is not known.
    pub(super) fn end(&self) -> Option<&Interpreter> {
        self.interpreter.as_ref()
    }

    /// The modes its lines leave in effect; `None` when that is not known.
    pub(super) fn modes(self) -> Option<Interpreter> {
        self.interpreter
    }

    /// A line was sent. What it makes the board do when nobody knows where it leads is surely nothing: it may lead to where the head stands.
    pub(super) fn sent(&mut self, number: usize, text: &str) -> Effect {
        let Some(interpreter) = &mut self.interpreter else { return Effect::default() };
        let leads_elsewhere =
            |line: &Line| line.leads_elsewhere().is_some() || !self.knows_shift && line.clears_shift();
        let line = parse_line(text, number).ok().filter(|line| !text.starts_with('$') && !leads_elsewhere(line));
        let moves = line.and_then(|line| interpreter.line(&line).ok());
        interpreter.round_as_board();
        let Some(moves) = moves else {
            // The board will refuse it, or goes where only it knows.
            self.interpreter = None;
            self.legs.clear();
            return Effect::default();
        };
        let mut effect = Effect::default();
        let mut before_mm = 0.0;
        for way in moves {
            if way.goes() {
                effect.blocks += self.least_blocks(&way);
                self.legs.push_back(Leg { line: number, before_mm, way });
                before_mm += way.length_mm();
            } else {
                effect.rests = true;
            }
        }
        effect
    }

    /// Lines up to this one are surely carried out.
    pub(super) fn carried_out(&mut self, line: usize) {
        while self.legs.front().is_some_and(|leg| leg.line <= line) {
            self.drop_first();
        }
    }

    /// A report says where the head is in machine coordinates, mm.
    ///
    /// # Errors
    /// It has left the way, as the second report in a row says.
    pub(super) fn located(&mut self, machine_mm: [f64; 3]) -> Result<(), Departure> {
        if self.interpreter.is_none() {
            return Ok(());
        }
        let at = P3::from(machine_mm);
        let Some(spot) = self.spot(at, self.seen.or(self.sure)) else {
            self.departed_reports += 1;
            // Behind what was seen but once, it may be that report which was garbled.
            self.seen = self.spot(at, self.sure);
            return if self.departed_reports < DEPARTED_REPORTS { Ok(()) } else { Err(self.departure(at)) };
        };
        self.departed_reports = 0;
        let agreed = self.seen.replace(spot).map(|seen| if seen < spot { seen } else { spot });
        if let Some(agreed) = agreed.filter(|agreed| self.sure.is_none_or(|sure| sure < *agreed)) {
            self.sure = Some(agreed);
            while self.passed < agreed.nth {
                self.drop_first();
            }
        }
        Ok(())
    }

    /// The line on which the head nearly stands though it should go, as the last reports say; to be asked after each that was located.
    pub(super) fn crawls(&mut self, runs: bool, now: Duration) -> Option<usize> {
        let limit_mm = self.limit_mm();
        let place = self.seen.filter(|_| runs).and_then(|seen| {
            let leg = self.legs.get(usize::try_from(seen.nth.checked_sub(self.passed)?).ok()?)?;
            // At the end of a move it may well stand: for a dwell, or for want of lines.
            let inside = limit_mm < seen.along_mm && seen.along_mm < leg.way.length_mm() - limit_mm;
            inside.then_some((seen, *leg))
        });
        let Some((seen, leg)) = place else {
            self.pace.rests();
            return None;
        };
        self.pace.crawls(seen.nth, &leg.way, seen.along_mm, now).then_some(leg.line)
    }

    /// The head stands for a reason of its own: at an open door, say.
    pub(super) fn rests(&mut self) {
        self.pace.rests();
    }

    /// How far the reports say that the job has come at least.
    pub(super) fn reached(&self) -> Option<Reached> {
        let sure = self.sure.filter(|sure| sure.nth == self.passed)?;
        let leg = self.legs.front()?;
        Some(Reached { line: leg.line, along_mm: leg.before_mm + sure.along_mm })
    }

    /// The first place of the way that is where the head is, no earlier than where it was, as no machine goes back; `None` beside it.
    fn spot(&self, at: P3, was: Option<Spot>) -> Option<Spot> {
        let limit_mm = self.limit_mm();
        let earliest = was.unwrap_or(START);
        for (nth, leg) in (self.passed..).zip(&self.legs) {
            let behind = |along_mm: f64| Spot { nth, along_mm: along_mm + limit_mm } < earliest;
            if let Action::Arc { .. } = leg.way.action
                && (at - leg.way.from).norm() <= limit_mm
                && !behind(0.0)
            {
                // A hair before the start of a full circle is not its end.
                return Some(Spot { nth, along_mm: 0.0 });
            }
            let (t, off_mm) = leg.way.nearest(at);
            let length_mm = leg.way.length_mm();
            // Of a full circle that was seen to be cut it is the end, and not the start that is nearest too.
            let places = [(t * length_mm, off_mm), (length_mm, (at - leg.way.to).norm())];
            if let Some((along_mm, _)) =
                places.into_iter().find(|(along_mm, off_mm)| *off_mm <= limit_mm && !behind(*along_mm))
            {
                return Some(Spot { nth, along_mm });
            }
        }
        let waits = self.legs.is_empty() && (at - self.base).norm() <= limit_mm;
        waits.then_some(Spot { nth: self.passed, along_mm: 0.0 })
    }

    /// How far from what is left of the way.
    fn departure(&self, at: P3) -> Departure {
        let earliest = self.seen.or(self.sure).unwrap_or(START);
        let off_mm = |nth: u64, way: &Move| {
            let (t, off_mm) = way.nearest(at);
            let (from, length_mm) = (earliest.along_mm, way.length_mm());
            let passed = nth == earliest.nth && t * length_mm < from && length_mm > 0.0;
            if passed { (way.point_at((from / length_mm).min(1.0)) - at).norm() } else { off_mm }
        };
        let left = (self.passed..).zip(&self.legs).filter(|(nth, _)| *nth >= earliest.nth);
        let near = left.map(|(nth, leg)| Departure { off_mm: off_mm(nth, &leg.way), line: leg.line });
        let nearest = near.min_by(|a, b| a.off_mm.total_cmp(&b.off_mm));
        nearest.unwrap_or(Departure { off_mm: (at - self.base).norm(), line: 0 })
    }

    /// Farther beside the way than this no report of a sound job is, mm.
    fn limit_mm(&self) -> f64 {
        let half_step_mm = self.steps_per_mm.map(|steps| 0.5 / steps);
        V3::from(half_step_mm).norm() + self.arc_tolerance_mm + REPORT_MM
    }

    /// Blocks of a move: none when it is less than a step, which GRBL leaves out; of an arc's chords one is left off for rounding.
    fn least_blocks(&self, way: &Move) -> usize {
        let surely_steps = |by: V3| (0..3).any(|axis| by[axis].abs() * self.steps_per_mm[axis] >= 1.0);
        match way.action {
            Action::Arc { radius_mm, sweep_rad, .. } => {
                let chord_rad = 2.0 * (1.0 - (self.arc_tolerance_mm / radius_mm).min(1.0)).acos();
                let chords = (sweep_rad.abs() / chord_rad).floor() - 1.0;
                let step_mm = 1.0 / self.steps_per_mm.into_iter().fold(f64::INFINITY, f64::min);
                // A chord longer than the diagonal of a step has one on one axis at least.
                if chords >= 1.0 && 2.0 * radius_mm * (0.5 * chord_rad).sin() > step_mm * 3.0_f64.sqrt() {
                    return chords as usize;
                }
                usize::from(surely_steps(way.to - way.from))
            }
            _ => usize::from(surely_steps(way.to - way.from)),
        }
    }

    fn drop_first(&mut self) {
        if let Some(leg) = self.legs.pop_front() {
            self.base = leg.way.to;
            self.passed += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(lines: &[&str]) -> Course {
        let board = Board {
            offset_mm: Some([-100.0, -50.0, 0.0]),
            settings: [(12, 0.002), (100, 80.0), (101, 80.0), (102, 80.0)].into(),
            ..Board::default()
        };
        let modes = Interpreter::new(P3::origin(), [V3::zeros(); 6], [P3::origin(); 2]);
        let mut course = Course::new(Some(&modes), Some([-100.0, -50.0, 0.0]), &board);
        for (k, line) in lines.iter().enumerate() {
            course.sent(k + 1, line);
        }
        course
    }

    fn reached(course: &mut Course, x: f64, y: f64) -> Option<(usize, f64)> {
        let at = [x - 100.0, y - 50.0, 0.0];
        assert_eq!(course.located(at), Ok(()));
        assert_eq!(course.located(at), Ok(()));
        course.reached().map(|r| (r.line, (r.along_mm * 1e3).round() / 1e3))
    }

    #[test]
    fn a_position_is_found_on_the_way_and_what_lies_before_it_is_done() {
        let mut course = course(&["M4S0", "G0X10Y10", "G1X30F1000S500", "Y20", "M5S0", "G0X0"]);
        assert_eq!(reached(&mut course, 0.0, 0.0), Some((2, 0.0)));
        assert_eq!(reached(&mut course, 25.0, 10.01), Some((3, 15.0)));
        assert_eq!(reached(&mut course, 29.0, 10.0), Some((3, 19.0)));
        assert_eq!(course.legs.len(), 3);
        assert_eq!(
            reached(&mut course, 30.0, 20.0),
            Some((4, 10.0)),
            "the end of one line before the start of the next"
        );
    }

    #[test]
    fn one_garbled_report_neither_carries_on_nor_alarms() {
        let mut course = course(&["G1X100F1000", "Y100"]);
        assert_eq!(reached(&mut course, 10.0, 0.0), Some((1, 10.0)));
        for garbled in [[70.0, 0.0], [100.0, 80.0], [10.0, 30.0]] {
            assert_eq!(course.located([garbled[0] - 100.0, garbled[1] - 50.0, 0.0]), Ok(()));
            assert_eq!(reached(&mut course, 11.0, 0.0), Some((1, 11.0)), "{garbled:?}");
        }
    }

    #[test]
    fn a_head_beside_the_way_is_noticed_with_the_second_report() {
        let mut course = course(&["G1X10F1000", "Y10"]);
        assert_eq!(course.located([-95.0, -49.0, 0.0]), Ok(()));
        let departure = course.located([-94.0, -48.0, 0.0]).unwrap_err();
        assert!((departure.off_mm - 2.0).abs() < 1e-9 && departure.line == 1, "{departure:?}");
    }

    #[test]
    fn a_head_that_goes_back_has_left_its_way() {
        let mut course = course(&["G1X100F1000", "Y1", "X0"]);
        assert_eq!(reached(&mut course, 90.0, 0.0), Some((1, 90.0)));
        // The second line was lost.
        assert_eq!(course.located([-20.0, -50.0, 0.0]), Ok(()));
        let departure = course.located([-40.0, -50.0, 0.0]).unwrap_err();
        assert!((departure.off_mm - 1.0).abs() < 1e-9 && departure.line == 3, "{departure:?}");
    }

    #[test]
    fn a_way_that_crosses_itself_is_never_taken_to_be_farther_than_it_may_be() {
        let mut course = course(&["G1X10F1000", "X0", "G3X0Y0I5J0"]);
        assert_eq!(reached(&mut course, 5.0, 0.0), Some((1, 5.0)));
        assert_eq!(reached(&mut course, 4.0, 0.0), Some((2, 6.0)), "it has gone on and come back");
        course.carried_out(2);
        assert_eq!(reached(&mut course, -0.01, 0.005), Some((3, 0.0)), "not the end of the circle");
        let (line, along_mm) = reached(&mut course, 5.0, -5.0).unwrap();
        assert!(line == 3 && (along_mm - 2.5 * std::f64::consts::PI).abs() < 0.01);
    }

    #[test]
    fn a_circle_that_is_cut_and_waits_at_its_end_has_not_left_its_way() {
        let mut course = course(&["G1X60Y50F1000", "G2X60Y50I-10J0", "G4P2"]);
        course.carried_out(1);
        assert_eq!(reached(&mut course, 60.0, 50.0), Some((2, 0.0)), "the start, before it was seen elsewhere");
        let (line, along_mm) = reached(&mut course, 50.0, 40.0).unwrap();
        assert!(line == 2 && (along_mm - 5.0 * std::f64::consts::PI).abs() < 0.01, "{along_mm}");
        let (line, along_mm) = reached(&mut course, 60.0, 50.0).unwrap();
        assert!(line == 2 && (along_mm - 20.0 * std::f64::consts::PI).abs() < 0.01, "{along_mm}");
    }

    #[test]
    fn small_steps_lose_what_the_board_loses() {
        let mut course = course(&["G0X-200", "G91G1F1000"]);
        // Rows of 440 steps of 0.1 mm and a way back, added up in single precision.
        let mut x = -300.0_f32;
        for row in 0..30 {
            for k in 0..440 {
                course.sent(3 + row * 441 + k, "X0.1");
                x += 0.1;
            }
            course.sent(3 + row * 441 + 440, "X-44");
            x -= 44.0;
        }
        assert!((f64::from(x) + 300.0).abs() > 2.0 * course.limit_mm(), "{x}");
        course.carried_out(3 + 30 * 441 - 1);
        assert_eq!(course.located([f64::from(x), -50.0, 0.0]), Ok(()));
        assert_eq!(course.located([f64::from(x), -50.0, 0.0]), Ok(()));
    }

    #[test]
    fn what_is_cleared_of_work_zero_is_followed_where_it_is_known() {
        let offset_mm = Some([-100.0, -50.0, 3.0]);
        let told = Board { offset_mm, shift_mm: Some([20.0, 0.0, 0.0]), tool_length_mm: Some(3.0), ..Board::default() };
        let mut modes = Interpreter::new(P3::origin(), [V3::zeros(); 6], [P3::origin(); 2]);
        modes.set_shift(V3::new(20.0, 0.0, 0.0), 3.0);
        let mut followed = Course::new(Some(&modes), Some([-100.0, -50.0, 3.0]), &told);
        for (k, line) in ["G92.1", "G49", "G0X5Z0"].into_iter().enumerate() {
            followed.sent(k + 1, line);
        }
        assert_eq!(followed.end().map(Interpreter::position), Some(P3::new(-115.0, -50.0, 0.0)));
        for line in ["G92.1", "G49"] {
            let mut course = Course::new(Some(&modes), Some([0.0; 3]), &Board { offset_mm, ..Board::default() });
            course.sent(1, line);
            assert_eq!(course.end().map(Interpreter::position), None, "{line}");
        }
    }

    #[test]
    fn blocks_are_those_that_are_surely_made() {
        let mut course = course(&[]);
        let mut effect = |text: &str| course.sent(1, text);
        let moves = |blocks: usize| Effect { blocks, rests: false };
        assert_eq!(effect("G1X10F1000"), moves(1));
        assert_eq!(effect("X10.004"), moves(0), "a third of a step");
        assert_eq!(effect("F500"), moves(0));
        assert_eq!(effect("M4S100"), Effect { blocks: 0, rests: true });
        assert_eq!(effect("M4S100"), moves(0), "it changes nothing, and the board goes on");
        assert_eq!(effect("G4P0.1"), Effect { blocks: 0, rests: true });
        let Effect { blocks, .. } = effect("G2X30.004I10");
        // Half a circle of 10 mm radius in chords of 0.4 mm.
        assert!((75..=79).contains(&blocks), "{blocks}");
    }

    #[test]
    fn where_only_the_board_knows_nothing_is_said() {
        for line in ["G28", "G55", "G10L20P1X0", "$H", "nonsense"] {
            let mut course = course(&["G1X10F1000", line, "X20"]);
            assert_eq!(course.located([400.0, 0.0, 0.0]), Ok(()));
            assert_eq!(course.located([400.0, 0.0, 0.0]), Ok(()), "{line}");
            assert_eq!(course.reached(), None);
            assert_eq!(course.sent(4, "G1X30"), Effect::default(), "it may stand there already");
        }
    }
}
