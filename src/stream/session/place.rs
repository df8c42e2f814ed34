//! Where the head is, against where the job should take it.

use super::Session;
use crate::stream::course::Departure;
use crate::stream::status::{State, Status};
use crate::stream::trouble::Trouble;

impl Session {
    /// Follows the head along the job's way; what ends the job when it has left it.
    pub(super) fn locate(&mut self, status: &Status) -> Option<Trouble> {
        let job = self.job.as_mut()?;
        job.course.carried_out(job.ledger.progress().executed);
        // An open door may park the head, an alarm may come with a place that is no longer counted.
        if !matches!(status.state, State::Run | State::Idle | State::Hold(_)) {
            return None;
        }
        let located = job.course.located(status.machine_mm?);
        job.ledger.reached(job.course.reached());
        located.err().map(|Departure { off_mm, line }| Trouble::OffPlan { off_mm, line })
    }
}
