//! What time alone tells: nobody answers, a line stays unanswered, status is due.

use std::time::Duration;

use super::{Phase, Session};
use crate::stream::event::{Action, Event};
use crate::stream::realtime;
use crate::stream::trouble::Trouble;

/// How often status is asked for while the machine brakes.
const BRAKING_STATUS_EVERY: Duration = Duration::from_millis(100);

/// How long a board that has answered a probe with a report alone may take to answer its line feed.
const PROBE_ANSWER_WAIT: Duration = Duration::from_millis(500);

impl Session {
    /// Looks at the clock.
    pub(super) fn watch(&mut self) {
        match self.phase {
            Phase::Opening { since, probed } => self.watch_opening(since, probed),
            Phase::Asking | Phase::Ready => {
                self.poll(self.settings.status_every);
                if let Some(byte) = self.overrides.next(self.now) {
                    self.byte(byte);
                }
                self.watch_silence();
                self.watch_answers();
                self.watch_check();
            }
            Phase::Stopping(_) => {
                self.poll(BRAKING_STATUS_EVERY);
                self.watch_stop();
            }
            Phase::Lost => {}
        }
    }

    /// No banner: the board was not reset by opening the port, and may be at work. It is asked, never reset.
    fn watch_opening(&mut self, since: Duration, probed: Option<Duration>) {
        match probed {
            None if self.now.saturating_sub(since) >= self.settings.banner_wait => {
                // The line feed ends whatever an earlier sender left half said.
                self.out.push(Action::Write(vec![b'\n', realtime::STATUS]));
                self.phase = Phase::Opening { since, probed: Some(self.now) };
            }
            Some(at) if self.status.is_some() && self.now.saturating_sub(at) >= PROBE_ANSWER_WAIT => self.ask(),
            Some(at) if self.now.saturating_sub(at) >= self.settings.silent_after => {
                let waited = self.now.saturating_sub(since).as_secs_f64();
                self.tell(Event::Trouble(Trouble::Silent(waited)));
                self.phase = Phase::Lost;
            }
            _ => {}
        }
    }

    fn poll(&mut self, every: Duration) {
        if self.polled.is_none_or(|at| self.now.saturating_sub(at) >= every) {
            self.polled = Some(self.now);
            self.byte(realtime::STATUS);
        }
    }

    fn watch_silence(&mut self) {
        let homing = self.window.first().is_some_and(|entry| entry.text.starts_with("$H"));
        let patience = if homing { self.settings.homing_wait } else { self.settings.silent_after };
        let silent = self.now.saturating_sub(self.heard);
        if self.deaf || self.silence_told || silent < patience {
            return;
        }
        self.silence_told = true;
        let trouble = Trouble::Silent(silent.as_secs_f64());
        if matches!(self.phase, Phase::Asking) {
            self.phase = Phase::Lost;
        }
        self.fail(trouble);
    }

    fn watch_answers(&mut self) {
        let patience = self.settings.answer_wait + Duration::from_secs_f64(self.window.dwell_s().min(1e6));
        let Some(since) = self.idle_since else { return };
        let Some(first) = self.window.first() else { return };
        if self.now.saturating_sub(since) < patience || self.job.is_none() {
            return;
        }
        let first = match first.kind {
            crate::stream::window::Kind::Job(line) => line,
            crate::stream::window::Kind::Order => 0,
        };
        self.fail(Trouble::LostAnswer { first, lines: self.window.len() });
    }
}
