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
        if locked && !home {
            return Err(failed(
                "the machine is locked: --home homes it first; without switches, `furbelow home --unlock`",
            ));
        }
        self.talk.wait_for_rest()?;
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

    /// What is told by scripts and people apart before anything moves: objections of board and programs, warnings first, refusals as the error.
    ///
    /// # Errors
    /// Something stands between a program and this board.
    pub(super) fn preflight(&mut self) -> Result<(), Failure> {
        let mut findings = self.findings();
        let mut fixes: Vec<String> =
            findings.iter().filter_map(|f| f.fix.clone()).filter(|f| f.contains('=')).collect();
        fixes.dedup();
        if !fixes.is_empty() {
            let differences: Vec<&str> = findings
                .iter()
                .filter(|f| f.fix.as_ref().is_some_and(|f| f.contains('=')))
                .map(|f| f.message.as_str())
                .collect();
            let question = format!("{}\nset {} on the board, for good?", differences.join("\n"), fixes.join(", "));
            if self.args.fix || self.agrees(&question)? {
                for fix in &fixes {
                    self.talk.insist(Command::Line(fix.clone()))?;
                    self.teller.note("fixed", &format!("{fix} is set on the board"))?;
                }
                self.ask_again()?;
                findings = self.findings();
            }
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

    /// Objections to any of the programs, each once.
    fn findings(&self) -> Vec<Finding> {
        let expected = job::expected(&self.machine);
        let mut findings: Vec<Finding> = Vec::new();
        for program in &self.programs {
            let made_for = program.label.machine.as_deref();
            for finding in stream::preflight(&program.survey.demand, made_for, &self.talk.board, &expected) {
                if !findings.contains(&finding) {
                    findings.push(finding);
                }
            }
        }
        findings
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
