//! Where the head is, against where the job should take it.

use super::Session;
use crate::stream::course::{Course, Departure};
use crate::stream::status::{State, Status};
use crate::stream::trouble::Trouble;

impl Session {
    /// Follows the head along the job's way; what ends the job when it has left it.
    pub(super) fn locate(&mut self, status: &Status) -> Option<Trouble> {
        let job = self.job.as_mut()?;
        let course = job.course.get_or_insert_with(|| Course::new(self.modes.as_ref(), status.machine_mm, &self.board));
        course.carried_out(job.ledger.progress().executed);
        // An open door may park the head, an alarm may come with a place that is no longer counted.
        if !matches!(status.state, State::Run | State::Idle | State::Hold(_)) {
            course.rests();
            return None;
        }
        let located = course.located(status.machine_mm?);
        job.ledger.reached(course.reached());
        if let Err(Departure { off_mm, line }) = located {
            return Some(Trouble::OffPlan { off_mm, line });
        }
        course.crawls(status.state == State::Run, self.now).map(|line| Trouble::TooSlow { line })
    }
}
