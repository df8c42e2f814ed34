//! How far a job has come and how long it still takes, from report to report.
//!
//! Lines alone tell it badly: one line may take a minute and the next ten a second, and what is surely carried out lags behind by what the planner
//! holds. So planned time is followed by the clock while the machine runs, scaled by the overrides, and kept between what is surely
//! carried out and what the board has accepted.

use std::time::Duration;

use super::ledger::Progress;
use super::plan::Plan;
use super::status::{State, Status};

/// Seconds of a job after which its own pace counts as much as the plan.
const TRUST_S: f64 = 10.0;

/// Nothing runs this much slower or faster than planned by itself.
const PACES: (f64, f64) = (0.05, 1000.0);

/// What is to come.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Outlook {
    /// Share of the planned time that has passed, 0 to 1.
    pub done: f64,
    /// Time left, s, with the overrides as they are and the machine at the pace it has kept so far.
    pub left_s: f64,
}

/// Follows one job.
#[derive(Debug)]
pub struct Forecast {
    plan: Plan,
    /// When the last report came.
    at: Option<Duration>,
    /// Feed and rapid override last reported, %.
    overrides: [f64; 2],
    /// Planned time that has passed, s.
    done_s: f64,
    /// What of it had passed at the first report, s.
    begun_s: f64,
    /// What should have passed while the machine ran, had it kept to the plan, s.
    due_s: f64,
}

impl Forecast {
    /// A job that has not begun.
    pub fn new(plan: Plan) -> Forecast {
        Forecast { plan, at: None, overrides: [100.0; 2], done_s: 0.0, begun_s: 0.0, due_s: 0.0 }
    }

    /// Planned time of the whole job, s.
    pub fn total_s(&self) -> f64 {
        self.plan.total().total_s()
    }

    /// Takes a report that came at `now`, on any clock that does not run back.
    pub fn on_status(&mut self, now: Duration, status: &Status, progress: Progress) -> Outlook {
        if let Some([feed, rapid, _]) = status.overrides {
            self.overrides = [feed, rapid].map(|percent| f64::from(percent).max(1.0));
        }
        let [feed, rapid] = self.overrides;
        let surely = self.plan.until(progress.executed);
        let left = self.plan.total().less(&surely);
        let left_scaled_s = left.scaled_s(feed, rapid);
        // Planned seconds that pass in one of the clock's.
        let rate = if left_scaled_s > 0.0 { left.total_s() / left_scaled_s } else { 1.0 };
        let before = self.at.replace(now);
        if let Some(before) = before.filter(|_| status.state == State::Run) {
            let due_s = now.saturating_sub(before).as_secs_f64() * rate;
            self.done_s += due_s * self.pace();
            self.due_s += due_s;
        }
        let (least_s, most_s) = (surely.total_s(), self.plan.until(progress.acked).total_s());
        self.done_s = self.done_s.clamp(least_s, most_s.max(least_s));
        if before.is_none() {
            self.begun_s = self.done_s;
        }
        let total_s = self.total_s();
        let done = if total_s > 0.0 { (self.done_s / total_s).min(1.0) } else { 1.0 };
        Outlook { done, left_s: (total_s - self.done_s).max(0.0) / rate / self.pace() }
    }

    /// How fast the job has run, 1 as planned: a board may be slower than its machine file says, an emulated one faster.
    fn pace(&self) -> f64 {
        ((self.done_s - self.begun_s + TRUST_S) / (self.due_s + TRUST_S)).clamp(PACES.0, PACES.1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::plan::Planned;
    use super::*;

    fn status(state: &str, overrides: &str) -> Status {
        Status::parse(&format!("<{state}|MPos:0,0,0|FS:1000,500{overrides}>"), false).unwrap()
    }

    fn at(seconds: f64) -> Duration {
        Duration::from_secs_f64(seconds)
    }

    fn progress(executed: usize, acked: usize) -> Progress {
        Progress { sent: acked, acked, executed }
    }

    /// Ten lines of 10 s each.
    fn even(planned: Planned) -> Forecast {
        let mut plan = Plan::default();
        (1..=10).for_each(|line| plan.add(line, planned));
        Forecast::new(plan)
    }

    fn feed() -> Forecast {
        even(Planned { feed_s: 10.0, ..Planned::default() })
    }

    #[test]
    fn half_the_feed_is_twice_the_time_left() {
        let mut forecast = feed();
        let full = forecast.on_status(at(0.0), &status("Run", "|Ov:100,100,100"), progress(4, 10));
        let half = forecast.on_status(at(0.0), &status("Run", "|Ov:50,100,100"), progress(4, 10));
        assert_eq!((full.left_s, half.left_s), (60.0, 120.0));
        assert_eq!(full.done, half.done);
        // Reports mostly leave overrides out; the last ones hold.
        let later = forecast.on_status(at(0.0), &status("Run", ""), progress(4, 10));
        assert_eq!(later, half);
    }

    #[test]
    fn the_rapid_override_scales_travels_and_no_override_shortens_rests() {
        let left_s = |planned: Planned, overrides: &str| {
            even(planned).on_status(at(0.0), &status("Run", overrides), progress(0, 10)).left_s
        };
        let travel = Planned { travel_s: 10.0, ..Planned::default() };
        let rest = Planned { rest_s: 10.0, ..Planned::default() };
        assert_eq!(left_s(travel, "|Ov:100,25,100"), 400.0);
        assert_eq!(left_s(travel, "|Ov:50,100,100"), 100.0);
        assert_eq!(left_s(rest, "|Ov:200,25,100"), 100.0);
    }

    #[test]
    fn time_passes_within_a_line_and_stands_still_in_a_hold() {
        let mut forecast = feed();
        let run = status("Run", "");
        forecast.on_status(at(0.0), &run, progress(0, 3));
        let later = forecast.on_status(at(5.0), &run, progress(0, 3));
        assert!((later.done - 0.05).abs() < 1e-9 && (later.left_s - 95.0).abs() < 1e-9, "{later:?}");
        let held = forecast.on_status(at(65.0), &status("Hold:0", ""), progress(0, 3));
        assert_eq!(held.done, later.done);
        // However late it is, no more can have passed than was accepted.
        assert!((forecast.on_status(at(265.0), &run, progress(0, 3)).done - 0.3).abs() < 1e-9);
        assert_eq!(forecast.on_status(at(266.0), &run, progress(10, 10)), Outlook { done: 1.0, left_s: 0.0 });
    }

    #[test]
    fn a_machine_half_as_fast_as_planned_is_found_out() {
        let mut forecast = feed();
        let run = status("Run", "");
        let mut outlook = forecast.on_status(at(0.0), &run, progress(0, 1));
        // A line every 20 s, one ahead accepted.
        for second in 1..=100_usize {
            let executed = second / 20;
            outlook = forecast.on_status(at(second as f64), &run, progress(executed, executed + 1));
        }
        // Half of it has been done in 100 s: as much is left, and not the 50 s of the plan.
        assert!((75.0..110.0).contains(&outlook.left_s), "{outlook:?}");
    }

    #[test]
    fn an_empty_job_is_done() {
        let outlook = Forecast::new(Plan::default()).on_status(at(0.0), &status("Idle", ""), progress(0, 0));
        assert_eq!(outlook, Outlook { done: 1.0, left_s: 0.0 });
    }
}
