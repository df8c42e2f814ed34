//! One sheet after the other: asked for, cut, followed to its end.

use std::time::{Duration, Instant};

use super::super::connection::{self, EVENT_WAIT, failed};
use super::super::keyboard::{self, WORDS, Word};
use super::super::talk::OnInterrupt;
use super::super::{Failure, output};
use super::Sending;
use super::keeping::Keeping;
use super::teller::Sheet;
use crate::stream::{Command, Ending, Event, Forecast, Outcome};

impl Sending<'_> {
    /// Has the checklist ticked off and the first sheet laid on the bed, unless that is said to be done. False when the user would rather not.
    ///
    /// # Errors
    /// Nobody is there.
    pub(super) fn tick_off(&mut self) -> Result<bool, Failure> {
        let Some(first) = self.programs.first() else { return Ok(true) };
        let (number, of) = self.place(0);
        if let Some(stock) = first.stock() {
            self.teller.say(&format!("sheet {number} of {of}: {stock}, its corner at work zero"));
        }
        if self.args.yes {
            return Ok(true);
        }
        if let Some(list) = output::checklist_text(&self.setup) {
            self.teller.say(&list);
        }
        Ok(self.ask("all done? Enter starts the machine, Ctrl-C leaves it alone")?.is_some())
    }

    /// Which sheet a program is and of how many.
    pub(super) fn place(&self, k: usize) -> (usize, usize) {
        if let Some(record) = &self.resumes {
            return record.head.sheet;
        }
        let before = self.args.from_sheet - 1;
        self.programs[k].place((before + k + 1, before + self.programs.len()))
    }

    /// Sends every sheet.
    ///
    /// # Errors
    /// Nobody is there to load the next, a file that is no longer what was checked, or a machine that does not obey.
    pub(super) fn cut(&mut self) -> Result<Outcome, Failure> {
        for k in 0..self.programs.len() {
            if k > 0 && !self.load(k)? || self.talk.interrupted() {
                return Ok(Outcome::Stopped);
            }
            connection::require_idle(&self.talk.status)?;
            let (mut keeping, lines) = self.keep(k)?;
            let program = &self.programs[k];
            let forecast = Forecast::new(program.survey.plan.clone());
            let about = Sheet {
                place: self.place(k),
                file: program.name(),
                lines: program.lines,
                time_s: forecast.total_s(),
                job: keeping.number(),
            };
            if let Some(keyboard) = &self.keyboard {
                keyboard.forget();
            }
            self.teller.begins(about)?;
            self.heed(&mut keeping)?;
            if k == 0 && self.keyboard.is_some() {
                self.teller.say(WORDS);
            }
            // From here on it may move: a signal brakes and resets it.
            self.talk.on_interrupt(OnInterrupt::Stop);
            self.talk.command(Command::Run { lines });
            let ending = self.follow(forecast, &mut keeping)?;
            self.talk.on_interrupt(OnInterrupt::Leave);
            keeping.ends(&ending);
            self.heed(&mut keeping)?;
            self.teller.ends(&ending)?;
            if ending.outcome != Outcome::Done {
                if let Some(number) = keeping.number() {
                    self.teller.say(&format!("furbelow resume {number} goes on with it"));
                }
                return Ok(ending.outcome);
            }
        }
        Ok(Outcome::Done)
    }

    /// Tells what happens, and passes on what is typed, until the job has ended.
    fn follow(&mut self, mut forecast: Forecast, keeping: &mut Keeping) -> Result<Ending, Failure> {
        let mut feed_percent = 100;
        let mut runs = false;
        let mut restarted = false;
        loop {
            self.obey_keyboard(&mut feed_percent);
            match self.talk.next(EVENT_WAIT) {
                Some(Event::Status(status, progress)) => {
                    runs |= progress.sent > 0;
                    keeping.reports(&status, progress);
                    self.heed(keeping)?;
                    let outlook = forecast.on_status(self.teller.now(), &status, progress);
                    self.teller.reports(&status, progress, outlook)?;
                }
                Some(Event::Trouble(trouble)) => {
                    keeping.troubled(&trouble);
                    self.teller.note("trouble", &trouble.to_string())?;
                }
                Some(Event::Message(message)) => self.teller.note("message", &message)?,
                // Told of a word that was typed; before the first line it means that nothing begins.
                Some(Event::Denied(reason)) if runs || self.talk.interrupted() => self.teller.note("denied", reason)?,
                Some(Event::Denied(reason)) => return Err(failed(reason)),
                // It lost its place before it was told the first line; in the middle of them that is trouble of its own.
                Some(Event::Restarted) => {
                    restarted = true;
                    self.talk.command(Command::Stop);
                }
                Some(Event::Ended(ending)) if restarted => return Ok(ending.after_restart()),
                Some(Event::Ended(ending)) => return Ok(ending),
                Some(_) | None => {}
            }
        }
    }

    fn obey_keyboard(&mut self, feed_percent: &mut u16) {
        // A terminal that is gone sends a signal of its own.
        while let Some(line) = self.keyboard.as_ref().and_then(|keyboard| keyboard.line().ok().flatten()) {
            match Word::parse(&line) {
                Some(word) => self.talk.command(word.command(feed_percent)),
                None => self.teller.say(WORDS),
            }
        }
    }

    /// Has the next sheet laid on the bed. False when the user has had enough.
    fn load(&mut self, k: usize) -> Result<bool, Failure> {
        let program = &self.programs[k];
        let (number, of) = self.place(k);
        let stock = program.stock().unwrap_or_else(|| program.name());
        self.teller.note("load", &format!("load sheet {number} of {of}: {stock}"))?;
        let Some(pause_s) = self.args.pause_s else {
            return Ok(self.ask("Enter goes on, Ctrl-C ends here")?.is_some() && self.place_loaded(k)?);
        };
        self.teller.say(&format!("it is cut in {pause_s} s; Ctrl-C ends here"));
        let until = Instant::now() + Duration::from_secs(pause_s.into());
        while let Some(left) = until.checked_duration_since(Instant::now()) {
            if !keyboard::idle(&mut self.talk, left.min(EVENT_WAIT))? {
                return Ok(false);
            }
        }
        self.place_loaded(k)
    }

    /// A sheet that is aligned when it lies on the bed is laid and looked at as the first was. False when the user has had enough.
    fn place_loaded(&mut self, k: usize) -> Result<bool, Failure> {
        if k < self.placed {
            return Ok(true);
        }
        if !self.place_next()? {
            return Ok(false);
        }
        self.preflight(k..k + 1)?;
        self.check_on_board(k..k + 1)
    }

    /// Asks something and waits for a line; what was typed before does not count. `None` when the user has stopped it instead.
    ///
    /// # Errors
    /// Nobody is there, or the board fails meanwhile.
    pub(super) fn ask(&mut self, question: &str) -> Result<Option<String>, Failure> {
        let nobody = || Failure::config("nobody is there to answer; give --yes when everything is prepared");
        self.keyboard.as_ref().ok_or_else(nobody)?.answer(&mut self.talk, || self.teller.say(question))
    }

    /// Asks for a yes; nobody there, or `--yes`, which is for the checklist, is a no.
    pub(super) fn agrees(&mut self, question: &str) -> Result<bool, Failure> {
        if self.keyboard.is_none() || self.args.yes {
            return Ok(false);
        }
        let answer = self.ask(&format!("{question} [y/N]"))?;
        Ok(answer.is_some_and(|answer| matches!(answer.trim().to_ascii_lowercase().as_str(), "y" | "yes")))
    }
}
