//! How far a job has come: what is sent, accepted, surely carried out.
//!
//! `ok` says that a line is in the planner, not that it is done. What lies between is at most the planner's blocks in use and the segments being
//! stepped (GRBL keeps 6), each of which belongs to one line at least.

use std::collections::VecDeque;

/// Segments GRBL may still be stepping after their block has left the planner (SEGMENT_BUFFER_SIZE, stepper.h).
const SEGMENTS: usize = 6;

/// Lines of the file, from 1; 0 for none yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Progress {
    /// The last line that was sent.
    pub sent: usize,
    /// The last line the board has accepted.
    pub acked: usize,
    /// The last line that is surely carried out.
    pub executed: usize,
}

/// Numbers the lines of a job through. Holds the lines between carried out and sent, which the board's buffers bound.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    progress: Progress,
    /// Lines accepted and not surely carried out, oldest first.
    accepted: VecDeque<usize>,
    /// The last line behind which the machine rested with every line answered: what got lost is behind it.
    agreed: usize,
    /// What the board says no longer tells what is carried out.
    closed: bool,
}

impl Ledger {
    pub(super) fn progress(&self) -> Progress {
        self.progress
    }

    /// Lines held.
    #[cfg(test)]
    pub(super) fn held(&self) -> usize {
        self.accepted.len()
    }

    pub(super) fn sent(&mut self, line: usize) {
        self.progress.sent = line;
    }

    /// A line was accepted; with `blocks` in the planner it is the last of at most so many that are not carried out.
    pub(super) fn accepted(&mut self, line: usize, blocks: usize) {
        self.progress.acked = line;
        self.accepted.push_back(line);
        self.carried_out_but(blocks + SEGMENTS);
    }

    /// A report says how many blocks the planner holds while the machine moves.
    pub(super) fn moving(&mut self, used_blocks: usize) {
        self.carried_out_but(used_blocks + SEGMENTS);
    }

    /// A report says how many blocks the planner holds at rest: nothing is being stepped.
    pub(super) fn resting(&mut self, used_blocks: usize) {
        self.carried_out_but(used_blocks);
    }

    /// A report says that the machine rests, and every line sent is answered.
    pub(super) fn agreed(&mut self) {
        self.carried_out_but(0);
        self.agreed = self.progress.acked;
    }

    /// Answers and lines do not agree: a line may have been lost whose answer seemed to come, anywhere behind the last time they did.
    pub(super) fn doubt(&mut self) {
        self.progress.executed = self.progress.executed.min(self.agreed);
        self.close();
    }

    /// The board has thrown its lines away: that its planner is empty says nothing any more.
    pub(super) fn close(&mut self) {
        self.closed = true;
    }

    fn carried_out_but(&mut self, open: usize) {
        while self.accepted.len() > open
            && let Some(line) = self.accepted.pop_front()
        {
            if !self.closed {
                self.progress.executed = line;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accepted_is_not_carried_out() {
        let mut ledger = Ledger::default();
        for line in (2..=100).step_by(2) {
            ledger.sent(line);
            ledger.accepted(line, 15);
        }
        assert_eq!(ledger.progress(), Progress { sent: 100, acked: 100, executed: 100 - 2 * 21 });
        ledger.moving(3);
        assert_eq!(ledger.progress().executed, 100 - 2 * 9);
        ledger.resting(3);
        assert_eq!(ledger.progress().executed, 94);
        // A report that is older than what is known takes nothing back.
        ledger.moving(15);
        assert_eq!(ledger.progress().executed, 94);
        ledger.resting(0);
        assert_eq!(ledger.progress().executed, 100);
    }

    #[test]
    fn when_answers_and_lines_disagree_only_what_was_agreed_is_sure() {
        let mut ledger = Ledger::default();
        (1..=3).for_each(|line| ledger.accepted(line, 15));
        ledger.agreed();
        (4..=9).for_each(|line| ledger.accepted(line, 15));
        ledger.resting(0);
        assert_eq!(ledger.progress().executed, 9);
        ledger.doubt();
        ledger.accepted(10, 15);
        ledger.resting(0);
        assert_eq!(ledger.progress(), Progress { sent: 0, acked: 10, executed: 3 });
    }

    #[test]
    fn a_long_job_holds_no_more_lines_than_the_board() {
        let mut ledger = Ledger::default();
        for line in 1..100_000 {
            ledger.accepted(line, 15);
            assert!(ledger.held() <= 21);
        }
    }
}
