//! Ways to an end. The safe one: `!`, wait until the machine holds at rest, `^X`: no alarm, the position is kept, the beam is off.

use std::time::Duration;

use super::{Job, Phase, Session};
use crate::stream::event::{Ending, Event, Outcome};
use crate::stream::realtime;
use crate::stream::status::State;
use crate::stream::trouble::Trouble;

/// Reports of rest after the hold was sent that are believed: a first one of idleness may have been under way before the board read it, and what a
/// single one tells of the place may be garbled.
const REST_REPORTS: u32 = 2;

/// How long a board may take to come back after a reset.
const RESET_WAIT: Duration = Duration::from_secs(3);

/// On the way to a safe end.
#[derive(Debug)]
pub(super) struct Stopping {
    /// Why; `None` when it was asked for.
    trouble: Option<Trouble>,
    since: Duration,
    /// The reset has been sent.
    reset: bool,
    /// It was sent at rest, and no alarm followed.
    pub(super) clean: bool,
    rest_reports: u32,
}

impl Session {
    /// The user wants an end; asked twice, at once.
    pub(super) fn stop(&mut self) {
        match self.phase {
            Phase::Stopping(_) => self.reset(),
            Phase::Lost => self.tell(Event::Denied("there is no board that answers")),
            _ if self.deaf => self.reset(),
            _ => self.brake(None),
        }
    }

    /// The user wants an end at once.
    pub(super) fn reset(&mut self) {
        match &self.phase {
            Phase::Stopping(stopping) if stopping.reset => self.byte(realtime::RESET),
            Phase::Stopping(stopping) => {
                let trouble = stopping.trouble.clone();
                self.reset_for(trouble);
            }
            _ if self.job.is_some() => self.reset_for(None),
            _ => self.byte(realtime::RESET),
        }
    }

    /// Brakes; the reset follows at rest.
    pub(super) fn brake(&mut self, trouble: Option<Trouble>) {
        self.alone.clear();
        self.byte(realtime::HOLD);
        self.polled = None;
        self.phase =
            Phase::Stopping(Stopping { trouble, since: self.now, reset: false, clean: false, rest_reports: 0 });
    }

    /// Resets without waiting for rest.
    pub(super) fn reset_for(&mut self, trouble: Option<Trouble>) {
        self.alone.clear();
        self.close_account();
        let clean = self.state().is_some_and(|state| matches!(state, State::Hold(0) | State::Door(0 | 1)));
        self.byte(realtime::RESET);
        self.phase = Phase::Stopping(Stopping { trouble, since: self.now, reset: true, clean, rest_reports: 0 });
    }

    pub(super) fn on_status_while_stopping(&mut self, state: State) {
        let Phase::Stopping(stopping) = &mut self.phase else { return };
        if stopping.reset {
            return;
        }
        let rests = match state {
            State::Check | State::Sleep | State::Alarm => true,
            State::Hold(0) | State::Door(0 | 1) | State::Idle => {
                stopping.rest_reports += 1;
                let believed = stopping.rest_reports >= REST_REPORTS;
                if !believed {
                    // At rest nothing is gained by waiting.
                    self.polled = None;
                }
                believed
            }
            _ => false,
        };
        if rests {
            stopping.clean = !matches!(state, State::Sleep | State::Alarm);
            stopping.reset = true;
            stopping.since = self.now;
            self.close_account();
            self.byte(realtime::RESET);
        }
    }

    /// What is answered from now on may be answered because the board is reset.
    fn close_account(&mut self) {
        if let Some(job) = &mut self.job {
            job.ledger.close();
        }
    }

    /// Goes on when the board does not do its part in time.
    pub(super) fn watch_stop(&mut self) {
        let Phase::Stopping(stopping) = &mut self.phase else { return };
        let waited = self.now.saturating_sub(stopping.since);
        if !stopping.reset && waited >= self.settings.stop_wait {
            stopping.reset = true;
            stopping.since = self.now;
            self.close_account();
            self.byte(realtime::RESET);
        } else if stopping.reset && waited >= RESET_WAIT {
            self.finish_stop(false);
        }
    }

    /// The reset has been answered, or not.
    pub(super) fn finish_stop(&mut self, answered: bool) {
        let next = if answered { Phase::Ready } else { Phase::Lost };
        let Phase::Stopping(stopping) = std::mem::replace(&mut self.phase, next) else { return };
        let outcome = stopping.trouble.map_or(Outcome::Stopped, Outcome::Failed);
        let clean = answered && stopping.reset && stopping.clean;
        if !clean {
            self.board.homed = false;
        }
        self.end(outcome, clean, answered);
    }

    /// Nothing can be said to the board any more.
    pub(super) fn lose(&mut self, trouble: Trouble) {
        self.phase = Phase::Lost;
        self.board.homed = false;
        self.end(Outcome::Failed(trouble), false, false);
    }

    /// The machine rests where it should, dark.
    pub(super) fn finish_at_rest(&mut self, outcome: Outcome) {
        self.end(outcome, true, true);
    }

    fn end(&mut self, outcome: Outcome, position_kept: bool, beam_off: bool) {
        let job = self.job.take();
        let progress = job.as_ref().map(|job| job.ledger.progress()).unwrap_or_default();
        if let Some(Job { course: Some(course), check: None, .. }) = job.filter(|_| outcome == Outcome::Done) {
            self.set_modes(course.modes());
        }
        // Lines that were sent may have been read until the very end, whether or not their answers came.
        let maybe = if outcome == Outcome::Done { progress.executed } else { progress.sent };
        self.window.clear();
        self.alone.clear();
        self.tell(Event::Ended(Ending { outcome, progress, maybe, position_kept, beam_off }));
    }
}
