//! When each line of a job should be done: a table that does not grow with the job.

use crate::gcode::{Action, Move};

/// Most knots of the table: 100 kB, and finer than a screen shows.
const MAX_KNOTS: usize = 4096;

/// Planned time, told apart by what an override makes of it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Planned {
    /// Moves at a feed, s.
    pub feed_s: f64,
    /// Travels, s.
    pub travel_s: f64,
    /// Dwells and stops, s: no override shortens them.
    pub rest_s: f64,
}

/// Planned time over the lines of a job. With more lines than knots every second knot is dropped, and between knots time runs evenly.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The sum at the end of lines 0, `stride`, 2 `stride`, ...
    knots: Vec<Planned>,
    stride: usize,
    /// The last line that takes time, and the sum at its end.
    line: usize,
    sum: Planned,
}

impl Planned {
    /// A move that takes so long.
    pub fn of(m: &Move, seconds: f64) -> Planned {
        let (feed_s, travel_s, rest_s) = match m.action {
            Action::Line | Action::Arc { .. } => (seconds, 0.0, 0.0),
            Action::Rapid => (0.0, seconds, 0.0),
            Action::Dwell { .. } | Action::Stop => (0.0, 0.0, seconds),
        };
        Planned { feed_s, travel_s, rest_s }
    }

    /// All of it, s.
    pub fn total_s(&self) -> f64 {
        self.feed_s + self.travel_s + self.rest_s
    }

    /// How long it takes with feed and travels scaled, both in %. Corners and axes that are slower than the feed are taken to scale too.
    pub fn scaled_s(&self, feed_percent: f64, rapid_percent: f64) -> f64 {
        self.feed_s * 100.0 / feed_percent + self.travel_s * 100.0 / rapid_percent + self.rest_s
    }

    pub(super) fn less(&self, other: &Planned) -> Planned {
        self.plus(other, -1.0)
    }

    fn plus(&self, other: &Planned, times: f64) -> Planned {
        Planned {
            feed_s: self.feed_s + times * other.feed_s,
            travel_s: self.travel_s + times * other.travel_s,
            rest_s: self.rest_s + times * other.rest_s,
        }
    }

    fn towards(&self, other: &Planned, share: f64) -> Planned {
        self.plus(&other.less(self), share)
    }
}

impl Default for Plan {
    /// Nothing takes any time.
    fn default() -> Plan {
        Plan { knots: vec![Planned::default()], stride: 1, line: 0, sum: Planned::default() }
    }
}

impl Plan {
    /// A line, from 1, takes so much more; lines come in order.
    pub fn add(&mut self, line: usize, planned: Planned) {
        while self.knots.len() * self.stride < line {
            self.knots.push(self.sum);
            if self.knots.len() > MAX_KNOTS {
                let mut nth = 0;
                self.knots.retain(|_| {
                    nth += 1;
                    nth % 2 == 1
                });
                self.stride *= 2;
            }
        }
        self.line = self.line.max(line);
        self.sum = self.sum.plus(&planned, 1.0);
    }

    /// Planned from the start to the end of a line; 0 for none.
    pub fn until(&self, line: usize) -> Planned {
        let k = (line / self.stride).min(self.knots.len() - 1);
        let (from, to, reach) = match self.knots.get(k + 1) {
            Some(next) => (&self.knots[k], next, self.stride),
            None => (&self.knots[k], &self.sum, self.line.saturating_sub(k * self.stride).max(1)),
        };
        from.towards(to, ((line - k * self.stride) as f64 / reach as f64).min(1.0))
    }

    /// Planned for the whole job.
    pub fn total(&self) -> Planned {
        self.sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feed(feed_s: f64) -> Planned {
        Planned { feed_s, ..Planned::default() }
    }

    #[test]
    fn a_short_job_is_known_line_by_line() {
        let mut plan = Plan::default();
        for (line, seconds) in [(2, 1.0), (2, 0.5), (5, 2.0), (6, 0.25)] {
            plan.add(line, feed(seconds));
        }
        let until: Vec<f64> = (0..=8).map(|line| plan.until(line).total_s()).collect();
        assert_eq!(until, [0.0, 0.0, 1.5, 1.5, 1.5, 3.5, 3.75, 3.75, 3.75]);
        assert_eq!(Plan::default().until(7), Planned::default());
    }

    #[test]
    fn a_long_job_takes_no_more_room_and_is_known_within_a_knot() {
        let mut plan = Plan::default();
        let seconds = |line: usize| 0.01 * (1 + line % 7) as f64;
        let mut sums = vec![0.0];
        for line in 1..=300_000 {
            plan.add(line, feed(seconds(line)));
            sums.push(sums[line - 1] + seconds(line));
        }
        assert!(plan.knots.len() <= MAX_KNOTS && plan.knots.capacity() <= 2 * MAX_KNOTS);
        assert_eq!(plan.stride, 128);
        for line in (0..=300_000).step_by(777) {
            let error = (plan.until(line).total_s() - sums[line]).abs();
            assert!(error < 0.15, "line {line}: {error} s");
        }
        assert!((plan.until(300_000).total_s() - plan.total().total_s()).abs() < 1e-6);
        // A line far on, as after a million comments.
        plan.add(50_000_000, feed(1.0));
        assert!(plan.knots.len() <= MAX_KNOTS && (plan.until(40_000_000).total_s() - sums[300_000]).abs() < 1.0);
    }
}
