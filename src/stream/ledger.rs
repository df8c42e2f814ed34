//! How far a job has come: what is sent, accepted, surely carried out.
//!
//! `ok` says that a line is in the planner, not that it is done. What lies between is at most the blocks the planner holds and the segments being
//! stepped. Which lines these are is told by how many blocks each line surely made, and by where the head is ([`super::course`]).

use std::collections::VecDeque;

use super::course::Effect;

/// Lines of the file, from 1; 0 for none yet.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Progress {
    /// The last line that was sent.
    pub sent: usize,
    /// The last line the board has accepted.
    pub acked: usize,
    /// The last line that is surely carried out.
    pub executed: usize,
    /// Where the head was seen for sure; `None` where its way cannot be followed.
    pub reached: Option<Reached>,
}

impl Progress {
    /// The place up to which the job is surely carried out.
    pub fn place(&self) -> Reached {
        let line_end = Reached { line: self.executed + 1, along_mm: 0.0 };
        self.reached.filter(|reached| reached.line > self.executed).unwrap_or(line_end)
    }
}

/// A place on a job's way.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Reached {
    /// Line of the file, from 1.
    pub line: usize,
    /// How much of the line's way lies behind, mm.
    pub along_mm: f64,
}

/// A line that is accepted and not surely carried out, or the last of several that ask for no block.
#[derive(Debug, Clone, Copy)]
struct Accepted {
    line: usize,
    blocks: usize,
}

/// Numbers the lines of a job through. Holds the lines between carried out and sent, which the board's buffers bound.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    progress: Progress,
    /// Oldest first.
    accepted: VecDeque<Accepted>,
    /// Blocks that all of these surely made.
    blocks: usize,
    /// The last line that is carried out as the last report counts.
    told: Option<usize>,
    /// The last line behind which the machine rested with every line answered: what got lost is behind it.
    agreed: usize,
    /// A line that is answered at rest, when nothing was heard since: a board that is reset answers the line it was reading, carried out or not.
    rested: Option<usize>,
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

    /// A line was accepted by a board whose planner and stepper hold at most `most` blocks.
    pub(super) fn accepted(&mut self, line: usize, effect: Effect, most: usize) {
        self.believe_rest();
        self.progress.acked = line;
        match self.accepted.back_mut() {
            // Lines that ask for nothing are done together; of a program nobody can follow there are any number.
            Some(last) if last.blocks == 0 && effect.blocks == 0 => last.line = line,
            _ => self.accepted.push_back(Accepted { line, blocks: effect.blocks }),
        }
        self.blocks += effect.blocks;
        self.rested = effect.rests.then_some(line);
        self.carry_out(self.done_but(most));
    }

    /// A report says that so many blocks are not carried out. One report may be garbled: what two in a row say counts.
    pub(super) fn reported(&mut self, open_blocks: usize) {
        self.believe_rest();
        let done = self.done_but(open_blocks);
        if let Some(before) = self.told.replace(done) {
            self.carry_out(before.min(done));
        }
    }

    /// The head has passed every line before one, and stands at a place.
    pub(super) fn reached(&mut self, reached: Option<Reached>) {
        if self.closed {
            return;
        }
        self.progress.reached = reached;
        if let Some(Reached { line, .. }) = reached {
            self.carry_out(line - 1);
        }
    }

    /// A report says that the machine rests, and every line sent is answered.
    pub(super) fn agreed(&mut self) {
        self.carry_out(usize::MAX);
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

    fn believe_rest(&mut self) {
        if let Some(line) = self.rested.take() {
            self.carry_out(line);
        }
    }

    /// The last line that is done when so many blocks are not; 0 for none of those held.
    fn done_but(&self, open_blocks: usize) -> usize {
        let mut behind = self.blocks;
        let done = self.accepted.iter().take_while(|accepted| {
            behind -= accepted.blocks;
            behind >= open_blocks
        });
        done.last().map_or(0, |accepted| accepted.line)
    }

    fn carry_out(&mut self, line: usize) {
        while let Some(first) = self.accepted.front().filter(|first| first.line <= line) {
            self.blocks -= first.blocks;
            if !self.closed {
                self.progress.executed = first.line;
            }
            self.accepted.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOVES: Effect = Effect { blocks: 1, rests: false };
    const NOTHING: Effect = Effect { blocks: 0, rests: false };
    const RESTS: Effect = Effect { blocks: 0, rests: true };

    fn reported(ledger: &mut Ledger, open: usize) -> usize {
        ledger.reported(open);
        ledger.reported(open);
        ledger.progress().executed
    }

    #[test]
    fn accepted_is_not_carried_out() {
        let mut ledger = Ledger::default();
        for line in (2..=100).step_by(2) {
            ledger.sent(line);
            ledger.accepted(line, MOVES, 20);
        }
        assert_eq!(ledger.progress(), Progress { sent: 100, acked: 100, executed: 100 - 2 * 20, reached: None });
        assert_eq!(reported(&mut ledger, 8), 100 - 2 * 8);
        assert_eq!(reported(&mut ledger, 3), 94);
        // A report that is older than what is known takes nothing back.
        assert_eq!(reported(&mut ledger, 15), 94);
        assert_eq!(reported(&mut ledger, 0), 100);
    }

    #[test]
    fn a_single_report_may_be_garbled() {
        let mut ledger = Ledger::default();
        (1..=30).for_each(|line| ledger.accepted(line, MOVES, 20));
        assert_eq!(reported(&mut ledger, 15), 15);
        ledger.reported(0);
        ledger.reported(14);
        assert_eq!(ledger.progress().executed, 16, "the lesser of the two");
    }

    #[test]
    fn lines_without_blocks_hide_no_line_with_one() {
        let mut ledger = Ledger::default();
        for (k, effect) in [MOVES, NOTHING, NOTHING, MOVES, NOTHING].into_iter().enumerate() {
            ledger.accepted(k + 1, effect, 20);
        }
        assert_eq!(reported(&mut ledger, 2), 0, "two blocks are those of lines 1 and 4");
        assert_eq!(reported(&mut ledger, 1), 3, "and what asks for nothing is done with the line before it");
        ledger.accepted(6, RESTS, 20);
        assert_eq!(ledger.progress().executed, 3);
        ledger.reported(7);
        assert_eq!(ledger.progress().executed, 6, "it is answered at rest, and the board goes on");
        ledger.accepted(7, MOVES, 20);
        ledger.accepted(8, RESTS, 20);
        ledger.close();
        reported(&mut ledger, 0);
        assert_eq!(ledger.progress().executed, 6, "it may have been answered by a reset");
    }

    #[test]
    fn a_place_on_the_way_tells_what_lies_before_it() {
        let mut ledger = Ledger::default();
        (1..=9).for_each(|line| ledger.accepted(line, MOVES, 20));
        ledger.reached(Some(Reached { line: 6, along_mm: 0.5 }));
        assert_eq!(ledger.progress().executed, 5);
        ledger.reached(Some(Reached { line: 12, along_mm: 0.0 }));
        assert_eq!(ledger.progress().executed, 9, "a line whose answer is still on its way is not counted yet");
    }

    #[test]
    fn when_answers_and_lines_disagree_only_what_was_agreed_is_sure() {
        let mut ledger = Ledger::default();
        (1..=3).for_each(|line| ledger.accepted(line, MOVES, 20));
        ledger.agreed();
        (4..=9).for_each(|line| ledger.accepted(line, MOVES, 20));
        assert_eq!(reported(&mut ledger, 0), 9);
        ledger.doubt();
        ledger.accepted(10, MOVES, 20);
        reported(&mut ledger, 0);
        assert_eq!(ledger.progress(), Progress { sent: 0, acked: 10, executed: 3, reached: None });
    }

    #[test]
    fn a_long_job_holds_no_more_lines_than_the_board() {
        let mut ledger = Ledger::default();
        for line in 1..100_000 {
            ledger.accepted(line, MOVES, 20);
            assert!(ledger.held() <= 20);
        }
        for line in 100_000..200_000 {
            ledger.accepted(line, NOTHING, 20);
            assert!(ledger.held() <= 21 && ledger.progress().executed < 100_000);
        }
        ledger.agreed();
        assert_eq!(ledger.progress().executed, 199_999);
    }
}
