//! How slowly the head goes along a line, against how slowly it may: a feed that was garbled on the way to the board leaves a lit beam nearly standing.
//!
//! Only the slowest is known without the board's planner: from rest to rest between two reported places, at the least feed override there is. What goes
//! slower than that by far, report after report, was sent another feed than was planned.

use std::time::Duration;

use super::board::Board;
use crate::gcode::{Action, Move};

/// The least feed override of GRBL and its relatives.
const LEAST_OVERRIDE: f64 = 0.1;

/// How many times as long as by this account a sound move may take: accelerations ramped up slowly, and steps of coarse clocks.
const LATITUDE: f64 = 1.5;

/// And so much more, s: reports come late when a computer has much to do.
const LATE_S: f64 = 1.0;

/// Reports in a row that are believed: one may have waited to be read.
const SLOW_REPORTS: u32 = 3;

/// How fast the head moves on one straight move after the other.
#[derive(Debug, Default)]
pub(super) struct Pace {
    /// Slowest acceleration of X and Y, mm/s²; `None` where the board does not tell.
    acceleration: Option<f64>,
    /// Slowest top speed of X and Y, mm/s.
    top_mm_per_s: Option<f64>,
    /// The move by its number, where on it the head was first seen, mm, and when.
    first: Option<(u64, f64, Duration)>,
    slow_reports: u32,
}

impl Pace {
    pub(super) fn new(board: &Board) -> Pace {
        let slowest = |first: u16| {
            let [x, y] = [first, first + 1].map(|n| board.settings.get(&n).copied().filter(|v| *v > 0.0));
            Some(x?.min(y?))
        };
        let top_mm_per_s = slowest(110).map(|mm_per_min| mm_per_min / 60.0);
        Pace { acceleration: slowest(120), top_mm_per_s, ..Pace::default() }
    }

    /// The head stands, is held, or is between two moves.
    pub(super) fn rests(&mut self) {
        self.first = None;
        self.slow_reports = 0;
    }

    /// The head is seen inside a move, the `nth` of all, so many mm along it. True when it has gone too slowly there for too many reports.
    pub(super) fn crawls(&mut self, nth: u64, way: &Move, along_mm: f64, now: Duration) -> bool {
        let level = way.from.z == way.to.z;
        let (Some(acceleration), Some(top_mm_per_s), Action::Line, true) =
            (self.acceleration, self.top_mm_per_s, way.action, level)
        else {
            self.rests();
            return false;
        };
        let Some((_, from_mm, since)) = self.first.filter(|(n, ..)| *n == nth) else {
            self.first = Some((nth, along_mm, now));
            self.slow_reports = 0;
            return false;
        };
        let speed_mm_per_s = LEAST_OVERRIDE * (way.feed_mm_per_min / 60.0).min(top_mm_per_s);
        let may_take_s = LATITUDE * rest_to_rest_s(along_mm - from_mm, speed_mm_per_s, acceleration) + LATE_S;
        let slow = now.saturating_sub(since).as_secs_f64() > may_take_s;
        self.slow_reports = if slow { self.slow_reports + 1 } else { 0 };
        self.slow_reports >= SLOW_REPORTS
    }
}

/// How long it takes to go so far from rest to rest, s: a triangle or a trapezoid of speed over time.
fn rest_to_rest_s(mm: f64, speed_mm_per_s: f64, acceleration: f64) -> f64 {
    let mm = mm.max(0.0);
    if mm * acceleration < speed_mm_per_s * speed_mm_per_s {
        2.0 * (mm / acceleration).sqrt()
    } else {
        mm / speed_mm_per_s + speed_mm_per_s / acceleration
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::{Interpreter, parse_line};
    use crate::geom::{P3, V3};

    /// Reports of a head on a line of 100 mm at F3000 that goes at another speed; the time at which it is told to crawl, s.
    fn told_s(mm_per_s: impl Fn(f64) -> f64, known: bool) -> Option<f64> {
        let settings = [(110, 6000.0), (111, 5000.0), (120, 300.0), (121, 500.0)];
        let settings = settings.into_iter().filter(|(n, _)| known || *n != 121).collect();
        let mut pace = Pace::new(&Board { settings, ..Board::default() });
        let mut modes = Interpreter::new(P3::origin(), [V3::zeros(); 6], [P3::origin(); 2]);
        let way = modes.line(&parse_line("G1X100F3000", 1).unwrap()).unwrap()[0];
        let (mut at_mm, mut now_s) = (0.05, 0.0);
        while at_mm < 99.9 && now_s < 60.0 {
            if pace.crawls(0, &way, at_mm, Duration::from_secs_f64(now_s)) {
                return Some(now_s);
            }
            at_mm += 0.15 * mm_per_s(now_s);
            now_s += 0.15;
        }
        None
    }

    #[test]
    fn a_thousandth_of_the_feed_is_noticed_in_two_seconds_and_a_tenth_never() {
        assert!(told_s(|_| 0.05, true).is_some_and(|s| s < 2.0));
        assert_eq!(told_s(|_| 5.0, true), None, "by override");
        assert_eq!(told_s(|_| 50.0, true), None);
        assert_eq!(told_s(|_| 0.05, false), None, "nobody knows how fast the axes are");
    }

    #[test]
    fn reports_that_were_read_late_are_borne() {
        let stalls = |s: f64| if (3.0..3.1).contains(&s) { 0.0 } else { 6.0 };
        assert_eq!(told_s(stalls, true), None);
        let mut pace = Pace::new(&Board {
            settings: [(110, 6e3), (111, 6e3), (120, 300.0), (121, 300.0)].into(),
            ..Board::default()
        });
        let mut modes = Interpreter::new(P3::origin(), [V3::zeros(); 6], [P3::origin(); 2]);
        let way = modes.line(&parse_line("G1X100F3000", 1).unwrap()).unwrap()[0];
        // Two reports waited for five seconds, the next comes in time.
        for (at_mm, now_s) in [(1.0, 0.0), (2.0, 5.0), (3.0, 5.01), (90.0, 5.02), (95.0, 5.1)] {
            assert!(!pace.crawls(0, &way, at_mm, Duration::from_secs_f64(now_s)), "{now_s}");
        }
    }
}
