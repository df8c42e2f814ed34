//! The board before a job: homed or zeroed as asked, its settings set right, and nothing standing between it and the programs.

use std::ops::Range;

use super::super::connection::{self, EVENT_WAIT, failed, machine_failure, refused};
use super::super::talk::OnInterrupt;
use super::super::{Failure, home, jog};
use super::Sending;
use crate::geom::Rect;
use crate::job;
use crate::stream::{self, Command, Event, Finding, Outcome, State, Trouble, Weight};

/// Work zero is the same when it is told so to three decimals, mm, of inches too.
const SAME_ZERO_MM: f64 = 0.03;

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

    /// Tells what stands between some of the programs and this board, and sets the board right where that is agreed to.
    ///
    /// # Errors
    /// Something that forbids sending.
    pub(super) fn preflight(&mut self, of: Range<usize>) -> Result<(), Failure> {
        let mut findings = self.findings(of.clone());
        if self.set_right(&findings)? {
            self.ask_again()?;
            findings = self.findings(of);
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

    /// Objections to any of these programs, each once; with the program's name where not all of them are meant. Where one lies that is yet to be laid
    /// is nothing to object to.
    fn findings(&self, of: Range<usize>) -> Vec<Finding> {
        let expected = job::expected(&self.machine);
        let mut findings: Vec<(Finding, Vec<String>)> = Vec::new();
        let sheets = of.len();
        for k in of {
            let program = &self.programs[k];
            let made_for = program.label.machine.as_deref();
            let mut demand = program.survey.demand.clone();
            if k >= self.placed {
                demand.bounds = Rect::EMPTY;
            }
            for finding in stream::preflight(&demand, made_for, &self.talk.board, &expected) {
                match findings.iter_mut().find(|(known, _)| *known == finding) {
                    Some((_, programs)) => programs.push(program.name()),
                    None => findings.push((finding, vec![program.name()])),
                }
            }
        }
        let name = |(mut finding, programs): (Finding, Vec<String>)| {
            if programs.len() < sheets {
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

    /// Lets the board read some of the programs without moving, where that is asked for. False when the user has broken it off.
    ///
    /// # Errors
    /// It refuses a line of them, or forgets where work zero is.
    pub(super) fn check_on_board(&mut self, of: Range<usize>) -> Result<bool, Failure> {
        if !self.args.check_on_board {
            return Ok(true);
        }
        if self.talk.answers.iter().any(|answer| is_shift(answer)) {
            return Err(refused(
                "work zero is shifted by G92, which the board forgets when it leaves its check mode: leave --check-on-board out, or clear it (G92.1, in furbelow console), put the head at the sheet's corner and give --zero",
            ));
        }
        let was_mm = self.talk.board.offset_mm;
        for k in of {
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
        let moved = |(was, is): ([f64; 3], [f64; 3])| (0..3).any(|axis| (was[axis] - is[axis]).abs() > SAME_ZERO_MM);
        if was_mm.zip(self.talk.board.offset_mm).is_some_and(moved) {
            return Err(refused(
                "work zero is no longer where it was before the board's check: put the head at the sheet's corner and give --zero, or leave --check-on-board out",
            ));
        }
        Ok(true)
    }
}

/// True for an answer to `$#` that tells of a shift by G92: "[G92:0.000,-5.000,0.000]".
fn is_shift(answer: &str) -> bool {
    let places = answer.strip_prefix("[G92:").and_then(|rest| rest.strip_suffix(']'));
    places.is_some_and(|places| places.split(',').any(|place| place.parse() != Ok(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shift_by_g92_is_told_from_none() {
        assert!(is_shift("[G92:0.000,-5.000,0.000]") && is_shift("[G92:0.001,0.000]"));
        assert!(!is_shift("[G92:0.000,0.000,-0.000]") && !is_shift("[G54:-5.000,0.000,0.000]") && !is_shift("ok"));
    }
}
