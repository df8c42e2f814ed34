//! The board before a job: homed or zeroed as asked, its settings set right, and nothing standing between it and the programs.

use super::super::connection::{self, EVENT_WAIT, failed, machine_failure, refused};
use super::super::talk::OnInterrupt;
use super::super::{Failure, home, jog};
use super::Sending;
use crate::job;
use crate::stream::{self, Command, Event, Finding, Outcome, State, Trouble, Weight};

impl Sending<'_> {
    /// Brings the machine to where a job can start. False when the user has broken it off.
    ///
    /// # Errors
    /// It is locked or busy, or does not obey.
    pub(super) fn get_ready(&mut self) -> Result<bool, Failure> {
        let locked = self.talk.status.state == State::Alarm;
        let ask = locked && self.talk.homes() && !self.args.home;
        let home = self.args.home
            || ask && self.agrees("the machine is locked until it is homed: home it now? The head will move.")?;
        if home && !home::home(&mut self.talk, &self.machine.name)? {
            return Ok(false);
        }
        if self.talk.interrupted() {
            return Ok(false);
        }
        if locked && !home {
            return Err(failed(
                "the machine is locked: --home homes it first; without switches, `furbelow home --unlock`",
            ));
        }
        if home {
            self.talk.wait_for_rest()?;
        }
        connection::require_idle(&self.talk.status)?;
        if self.args.zero {
            jog::zero_here(&mut self.talk)?;
            self.talk.wait_for_rest()?;
        }
        if home || self.args.zero {
            self.ask_again()?;
        }
        self.teller.say(&format!("the head stands {}", self.talk.place()));
        Ok(true)
    }

    /// Tells what stands between the programs and this board, and sets the board right where that is agreed to.
    ///
    /// # Errors
    /// Something that forbids sending.
    pub(super) fn preflight(&mut self) -> Result<(), Failure> {
        let mut findings = self.findings();
        if self.set_right(&findings)? {
            self.ask_again()?;
            findings = self.findings();
        }
        if self.talk.interrupted() {
            return Ok(());
        }
        let mut refusals = Vec::new();
        for Finding { weight, code, message, fix } in findings {
            let hint = match fix.as_deref() {
                None => String::new(),
                Some("$H") => " [--home]".to_owned(),
                Some(fix) => format!(" [{fix}: --fix sets it]"),
            };
            let message = format!("{message}{hint}");
            if weight == Weight::Refusal && !(self.args.anyway && code == "other-machine") {
                refusals.push(message);
            } else {
                self.teller.warn(code, &message)?;
            }
        }
        if refusals.is_empty() { Ok(()) } else { Err(refused(refusals.join("; "))) }
    }

    /// Writes the settings that objections ask for, one by one, when somebody agrees. False when nothing was written.
    fn set_right(&mut self, findings: &[Finding]) -> Result<bool, Failure> {
        let (mut wrong, mut fixes) = (String::new(), Vec::new());
        for finding in findings {
            if let Some(fix) = finding.fix.as_deref().filter(|fix| fix.contains('=')) {
                wrong += &format!("{}\n", finding.message);
                fixes.push(fix);
            }
        }
        let question = format!("{wrong}set {} on the board, for good?", fixes.join(", "));
        if fixes.is_empty() || !self.args.fix && !self.agrees(&question)? {
            return Ok(false);
        }
        for fix in fixes {
            self.talk.insist(Command::Line(fix.to_owned()))?;
            self.teller.note("fixed", &format!("{fix} is set on the board"))?;
        }
        Ok(true)
    }

    /// Objections to any of the programs, each once; with the program's name where not all of them are meant.
    fn findings(&self) -> Vec<Finding> {
        let expected = job::expected(&self.machine);
        let mut findings: Vec<(Finding, Vec<String>)> = Vec::new();
        for program in &self.programs {
            let made_for = program.label.machine.as_deref();
            for finding in stream::preflight(&program.survey.demand, made_for, &self.talk.board, &expected) {
                match findings.iter_mut().find(|(known, _)| *known == finding) {
                    Some((_, programs)) => programs.push(program.name()),
                    None => findings.push((finding, vec![program.name()])),
                }
            }
        }
        let name = |(mut finding, programs): (Finding, Vec<String>)| {
            if programs.len() < self.programs.len() {
                finding.message = format!("{}: {}", programs.join(", "), finding.message);
            }
            finding
        };
        findings.into_iter().map(name).collect()
    }

    /// Asks the board everything again and waits until it has answered and rests.
    fn ask_again(&mut self) -> Result<(), Failure> {
        self.talk.command(Command::Ask);
        loop {
            match self.talk.next(EVENT_WAIT) {
                Some(Event::Ready(board)) => {
                    self.talk.board = board;
                    return self.talk.wait_for_rest();
                }
                Some(Event::Trouble(trouble)) => return Err(machine_failure(trouble)),
                Some(Event::Denied(reason)) => return Err(failed(reason)),
                Some(Event::Restarted) => return Err(machine_failure(Trouble::Restarted)),
                Some(_) | None => {}
            }
        }
    }

    /// Lets the board read every program without moving. False when the user has broken it off.
    ///
    /// # Errors
    /// It refuses a line of them.
    pub(super) fn check_on_board(&mut self) -> Result<bool, Failure> {
        for k in 0..self.programs.len() {
            let lines = self.programs[k].open()?;
            self.talk.on_interrupt(OnInterrupt::Stop);
            self.talk.command(Command::Check { lines });
            let outcome = loop {
                match self.talk.next(EVENT_WAIT) {
                    Some(Event::Ended(ending)) => break ending.outcome,
                    Some(Event::Trouble(trouble)) => self.teller.note("trouble", &trouble.to_string())?,
                    Some(Event::Message(message)) => self.teller.note("message", &message)?,
                    Some(Event::Denied(reason)) if !self.talk.interrupted() => return Err(failed(reason)),
                    Some(_) | None => {}
                }
            };
            self.talk.on_interrupt(OnInterrupt::Leave);
            match outcome {
                Outcome::Done => {
                    let text = format!("{}: the board takes every line", self.programs[k].name());
                    self.teller.note("checked", &text)?;
                }
                Outcome::Stopped => return Ok(false),
                Outcome::Failed(trouble) => {
                    return Err(refused(format!("{} must not be sent: {trouble}", self.programs[k].name())));
                }
            }
            self.talk.wait_for_rest()?;
        }
        Ok(true)
    }
}
