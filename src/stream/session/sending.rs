//! What goes out: questions, orders and the lines of a job.

use super::checking::read_on_checking;
use super::{Job, Phase, Session};
use crate::stream::course::{Course, Effect};
use crate::stream::event::{Action, Event, Outcome};
use crate::stream::sendable::{Sendable, sendable};
use crate::stream::status::State;
use crate::stream::trouble::Trouble;
use crate::stream::window::{Entry, Kind};

/// Switches the beam off behind a job, whatever the job did.
const DARK: &str = "M5S0";

/// What is asked first: version and buffers, settings, stored places, modes.
const QUESTIONS: [&str; 4] = ["$I", "$$", "$#", "$G"];

/// How far from its end a job may be found, mm: numbers have three decimals and steps are up to 1/40 mm.
const PLACE_MM: f64 = 0.05;

/// Reports of rest that are needed where a report does not tell how full the planner is: a first one may come between a line's answer and its
/// start.
const REST_REPORTS: u32 = 2;

impl Session {
    /// Begins to ask a board that has spoken.
    pub(super) fn ask(&mut self) {
        self.window.clear();
        self.alone.clear();
        self.ask_again();
    }

    /// Asks everything behind what is still under way.
    pub(super) fn ask_again(&mut self) {
        self.phase = Phase::Asking;
        self.alone.extend(QUESTIONS.iter().map(|q| (*q).to_owned()));
    }

    /// Longest line the board takes, in characters without the line feed.
    pub(super) fn line_limit(&self) -> usize {
        self.board.firmware.line_chars().min(self.board.rx_bytes - 1)
    }

    /// True when the board has said often enough that it rests, since a line was last sent.
    pub(super) fn rested(&self) -> bool {
        let tells_blocks = self.status.as_ref().is_some_and(|s| s.free.is_some());
        self.window.is_empty() && self.rest_reports >= if tells_blocks { 1 } else { REST_REPORTS }
    }

    /// Sends what there is room for.
    pub(super) fn fill(&mut self) {
        if !matches!(self.phase, Phase::Asking | Phase::Ready) || self.deaf {
            return;
        }
        let mut bytes = Vec::new();
        let trouble = loop {
            match self.next_line() {
                Ok(Some((kind, line))) => {
                    let effect = match (kind, &mut self.job) {
                        (Kind::Job(number), Some(job)) => {
                            job.ledger.sent(number);
                            job.course.as_mut().map(|course| course.sent(number, &line.text)).unwrap_or_default()
                        }
                        _ => Effect::default(),
                    };
                    bytes.extend(line.text.bytes());
                    bytes.push(b'\n');
                    self.rest_reports = 0;
                    self.idle_since = None;
                    self.window.push(Entry { text: line.text, kind, alone: line.alone, dwell_s: line.dwell_s, effect });
                }
                Ok(None) => break None,
                Err(trouble) => break Some(trouble),
            }
        };
        if !bytes.is_empty() {
            self.out.push(Action::Write(bytes));
        }
        if let Some(trouble) = trouble {
            self.fail(trouble);
        }
    }

    /// The next line that may go now: orders first, then the job's, then the one that darkens the beam behind it.
    fn next_line(&mut self) -> Result<Option<(Kind, Sendable)>, Trouble> {
        if self.window.first().is_some_and(|entry| entry.alone) {
            return Ok(None);
        }
        let by_itself = |text: String| (Kind::Order, Sendable { text, alone: true, dwell_s: 0.0 });
        if !self.alone.is_empty() {
            return Ok(if self.window.is_empty() { self.alone.pop_front().map(by_itself) } else { None });
        }
        let (limit, rested) = (self.line_limit(), self.rested());
        if !self.may_read_on() {
            return Ok(None);
        }
        let Some(job) = self.job.as_mut().filter(|job| job.course.is_some()) else { return Ok(None) };
        if job.next.is_none() {
            job.next = match &job.check {
                Some(_) => read_on_checking(job, limit, &mut self.out)?,
                None => read_on(job, limit)?,
            };
        }
        match &job.next {
            Some((_, line)) if line.alone && !rested => Ok(None),
            Some((_, line)) if !self.window.has_room(line.text.len(), self.board.window_bytes()) => Ok(None),
            Some(_) => Ok(job.next.take().map(|(number, line)| (Kind::Job(number), line))),
            None if job.closed || !self.window.is_empty() => Ok(None),
            None => {
                job.closed = true;
                let last = match &mut job.check {
                    Some(check) => check.leave(self.now),
                    None => DARK,
                };
                if let Some(course) = &mut job.course {
                    course.sent(job.number, last);
                }
                Ok(Some(by_itself(last.to_owned())))
            }
        }
    }

    /// Ends a job whose lines are all carried out.
    pub(super) fn end_when_done(&mut self) {
        let all_sent = self.job.as_ref().is_some_and(|job| job.read && job.next.is_none() && job.closed);
        if !all_sent || !self.alone.is_empty() || !self.rested() {
            return;
        }
        let modes = self.job.as_ref().and_then(|job| job.course.as_ref()).and_then(Course::end);
        let found = self.status.as_ref().filter(|status| status.state == State::Idle).and_then(|s| s.machine_mm);
        if let (Some(modes), Some(found)) = (modes, found)
            && (0..2).any(|k| (modes.position()[k] - found[k]).abs() > PLACE_MM)
        {
            // G92 may have laid zero elsewhere since the last report that told of it.
            let here = |place: [f64; 3]| [place[0] - modes.origin().x, place[1] - modes.origin().y];
            let (expected_mm, found_mm) = (here(modes.position().into()), here(found));
            return self.fail(Trouble::WrongPlace { expected_mm, found_mm });
        }
        self.finish_at_rest(Outcome::Done);
    }

    /// Trouble: tells it and ends the job; without one it is only told.
    pub(super) fn fail(&mut self, trouble: Trouble) {
        self.tell(Event::Trouble(trouble.clone()));
        if let Some(job) = &mut self.job {
            if matches!(trouble, Trouble::LostAnswer { .. } | Trouble::ExtraAnswer) {
                job.ledger.doubt();
            }
            self.brake(Some(trouble));
        }
    }
}

pub(super) fn read_on(job: &mut Job, limit: usize) -> Result<Option<(usize, Sendable)>, Trouble> {
    while !job.read {
        let Some(line) = job.lines.next() else {
            job.read = true;
            break;
        };
        job.number += 1;
        let number = job.number;
        let line = line.map_err(|e| Trouble::Unreadable { line: number, reason: e.to_string() })?;
        if let Some(line) = sendable(&line, number, limit)? {
            return Ok(Some((number, line)));
        }
    }
    Ok(None)
}
