//! A program read by the board in check mode: `$C`, the lines, `$C` again, and the banner with which GRBL comes back.
//!
//! No line goes before a report says that the board is in check mode, and none after one that says it is not: whatever goes wrong, nothing moves.

use std::time::Duration;

use super::sending::read_on;
use super::{Job, Session};
use crate::stream::course::Effect;
use crate::stream::event::{Action, Event, Lines, Outcome};
use crate::stream::sendable::Sendable;
use crate::stream::status::State;
use crate::stream::trouble::Trouble;

/// Goes into check mode, and out of it.
const CHECK_MODE: &str = "$C";

/// Reports of another state after `$C` was answered that are borne: one may have been under way. As many in a row must say that the board checks: of one
/// that was in check mode before, the first may tell of then.
const STRAY_REPORTS: u32 = 2;

/// How long a board may take to come back from check mode: it starts anew, without a boot loader.
const LEAVE_WAIT: Duration = Duration::from_secs(3);

/// How far a check has come.
#[derive(Debug)]
pub(super) struct Checking {
    stage: Stage,
    refused: usize,
    stray_reports: u32,
    check_reports: u32,
}

#[derive(Debug, PartialEq)]
enum Stage {
    /// `$C` is on its way, or answered and not yet seen in a report.
    Entering,
    /// Lines are being read.
    Reading,
    /// The second `$C` is on its way.
    Leaving { since: Duration },
}

impl Checking {
    /// All lines are answered: what to send now.
    pub(super) fn leave(&mut self, now: Duration) -> &'static str {
        self.stage = Stage::Leaving { since: now };
        CHECK_MODE
    }
}

impl Session {
    pub(super) fn start_check(&mut self, lines: Lines) {
        if self.state() != Some(State::Idle) {
            return self.tell(Event::Denied("the machine is not idle: home, unlock, resume or reset it first"));
        }
        self.begin(lines, Some(Checking { stage: Stage::Entering, refused: 0, stray_reports: 0, check_reports: 0 }));
        self.alone.push_back(CHECK_MODE.to_owned());
    }

    pub(super) fn is_checking(&self) -> bool {
        self.check().is_some()
    }

    /// True when a banner is the end of the check and no mishap.
    pub(super) fn leaves_check(&self) -> bool {
        self.check().is_some_and(|check| matches!(check.stage, Stage::Leaving { .. }))
    }

    /// False while a check must not send lines.
    pub(super) fn may_read_on(&self) -> bool {
        self.check().is_none_or(|check| check.stage == Stage::Reading)
    }

    fn check(&self) -> Option<&Checking> {
        self.job.as_ref()?.check.as_ref()
    }

    pub(super) fn on_status_while_checking(&mut self, state: State) {
        let answered = self.window.is_empty() && self.alone.is_empty();
        let Some(check) = self.job.as_mut().and_then(|job| job.check.as_mut()) else { return };
        let strays = match check.stage {
            Stage::Entering if state == State::Check && answered => {
                check.check_reports += 1;
                if check.check_reports >= STRAY_REPORTS {
                    check.stage = Stage::Reading;
                }
                false
            }
            Stage::Entering if !answered => false,
            Stage::Entering => {
                check.stray_reports += 1;
                check.stray_reports >= STRAY_REPORTS
            }
            Stage::Reading => state != State::Check,
            Stage::Leaving { .. } => false,
        };
        if strays {
            self.fail(Trouble::NoCheckMode);
        }
    }

    /// The board has refused a line, and reads on.
    pub(super) fn refused_in_check(&mut self, line: usize, trouble: Trouble) {
        if let Some(job) = &mut self.job {
            job.ledger.accepted(line, Effect { blocks: 0, rests: true }, 0);
            if let Some(check) = &mut job.check {
                check.refused += 1;
            }
        }
        self.tell(Event::Trouble(trouble));
    }

    /// Notices a board that does not come back from check mode.
    pub(super) fn watch_check(&mut self) {
        if let Some(Checking { stage: Stage::Leaving { since }, .. }) = self.check()
            && self.now.saturating_sub(*since) >= LEAVE_WAIT
        {
            self.fail(Trouble::NoCheckMode);
        }
    }

    /// The board has come back.
    pub(super) fn finish_check(&mut self) {
        let Some(job) = &mut self.job else { return };
        job.ledger.agreed();
        let refused = job.check.as_ref().map_or(0, |check| check.refused);
        self.finish_at_rest(match refused {
            0 => Outcome::Done,
            refused => Outcome::Failed(Trouble::CheckRefused { refused }),
        });
    }
}

/// The next line a check may send. Lines that cannot be sent are told and count as refused; those that would change the board are passed over.
///
/// # Errors
/// The program cannot be read on.
pub(super) fn read_on_checking(
    job: &mut Job,
    limit: usize,
    out: &mut Vec<Action>,
) -> Result<Option<(usize, Sendable)>, Trouble> {
    loop {
        match read_on(job, limit) {
            Err(trouble @ (Trouble::Unsendable { .. } | Trouble::TooLong { .. })) => {
                out.push(Action::Event(Event::Trouble(trouble)));
                if let Some(check) = &mut job.check {
                    check.refused += 1;
                }
            }
            // Check mode holds back motion, not `G10`, `$X` or `$30=`.
            Ok(Some((number, line))) if line.alone || line.text.starts_with('$') => {
                let message = format!("line {number}: {:?} would change the board and is not checked", line.text);
                out.push(Action::Event(Event::Message(message)));
            }
            answer => return answer,
        }
    }
}
