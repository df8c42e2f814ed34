//! Talking to a board: orders given one at a time, waiting for rest and for a job's end, and what Ctrl-C means meanwhile.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde_json::json;

use super::connection::{EVENT_WAIT, READY_WAIT_S, failed, machine_failure, open_at, wait_until_asked};
use super::{Exit, Failure};
use crate::config::Machine;
use crate::stream::{Board, Command, Ending, Event, Link, State, Status, Trouble, error_advice};

/// Reports of rest that are believed after an order was answered: the first may have been under way before.
const REST_REPORTS: u32 = 2;

/// What Ctrl-C, SIGTERM and SIGHUP mean at the moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OnInterrupt {
    /// Nothing of ours moves: leave at once.
    Leave,
    /// Nothing of ours moves, and whoever waits looks at [`Talk::interrupted`].
    Heed,
    /// Brake, wait for rest, reset; a second one resets at once.
    Stop,
    /// End the jog.
    CancelJog,
    /// Reset at once: while it homes, a board hears nothing else.
    Reset,
}

/// What the handler of signals needs.
struct Handling {
    meaning: OnInterrupt,
    interrupted: bool,
    commands: Option<Sender<Command>>,
}

/// A board that has answered all questions, the last report of it, and orders given one at a time.
pub(super) struct Talk {
    link: Link,
    /// What it is.
    pub(super) board: Board,
    /// Its last report.
    pub(super) status: Status,
    /// What it answered to the first questions, line by line.
    pub(super) answers: Vec<String>,
    handling: Arc<Mutex<Handling>>,
}

/// How an order was answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Answer {
    /// `ok`.
    Taken,
    /// GRBL's number of the error.
    Refused(u16),
    /// The user has stopped it.
    Interrupted,
}

impl Talk {
    /// Opens a machine's board and asks it everything; a beam that was left on at rest is switched off. Ctrl-C leaves at once until [`Talk::on_interrupt`] says otherwise.
    pub(super) fn open(port: &str, machine: &Machine) -> Result<Talk, Failure> {
        let mut talk = Talk::open_with(port, machine.controller.baud, false)?;
        if machine.tool.class.is_laser() && talk.status.state == State::Idle && talk.answers.iter().any(|a| is_lit(a)) {
            // A sender that was killed leaves a board that was not started anew as it stands: with M3 the beam burns on one place.
            eprintln!("the board had its beam switched on: it is off now");
            talk.insist(Command::Line("M5".to_owned()))?;
        }
        Ok(talk)
    }

    /// The same at any baud; `may_reset` allows a reset of a board that does not answer: it ends whatever that board is doing.
    pub(super) fn open_with(port: &str, baud: u32, may_reset: bool) -> Result<Talk, Failure> {
        let handling =
            Arc::new(Mutex::new(Handling { meaning: OnInterrupt::Leave, interrupted: false, commands: None }));
        let handled = Arc::clone(&handling);
        ctrlc::set_handler(move || interrupt(&handled)).map_err(Failure::config)?;
        let link = open_at(port, baud)?;
        let mut answers = Vec::new();
        let (board, status) = wait_until_asked(&link, &mut answers, may_reset)?;
        lock(&handling).commands = link.commands();
        Ok(Talk { link, board, status, answers, handling })
    }

    /// Says what Ctrl-C means from now on.
    pub(super) fn on_interrupt(&self, meaning: OnInterrupt) {
        lock(&self.handling).meaning = meaning;
    }

    /// True when the user has asked to stop.
    pub(super) fn interrupted(&self) -> bool {
        lock(&self.handling).interrupted
    }

    /// Gives a command without waiting for anything.
    pub(super) fn command(&self, command: Command) {
        self.link.command(command);
    }

    /// The next event, `None` when none came within `wait`.
    pub(super) fn next(&mut self, wait: Duration) -> Option<Event> {
        let (_, event) = self.link.next(wait)?;
        if let Event::Status(status, _) = &event {
            self.board.seen(status);
            self.status = status.clone();
        }
        Some(event)
    }

    /// Gives an order and waits for its answer. Messages of the board's go to `tell`.
    ///
    /// # Errors
    /// An alarm, a dead port, or an order that cannot be given now.
    pub(super) fn order(
        &mut self,
        command: Command,
        tell: &mut dyn FnMut(&str) -> Result<(), Failure>,
    ) -> Result<Answer, Failure> {
        self.command(command);
        loop {
            match self.next(EVENT_WAIT) {
                Some(Event::Answered { error: None, .. }) => return Ok(Answer::Taken),
                Some(Event::Answered { error: Some(code), .. }) => return Ok(Answer::Refused(code)),
                Some(Event::Denied(reason)) => return Err(failed(reason)),
                // Ours: the alarm and the new start that a reset brings.
                Some(Event::Trouble(Trouble::Alarm { .. }) | Event::Restarted) if self.interrupted() => {
                    return Ok(Answer::Interrupted);
                }
                Some(Event::Trouble(trouble)) => return Err(machine_failure(trouble)),
                Some(Event::Restarted) => return Err(machine_failure(Trouble::Restarted)),
                Some(Event::Message(message) | Event::Text(message)) => tell(&message)?,
                Some(_) | None => {}
            }
        }
    }

    /// Gives an order; anything but `ok` is a failure, told with what it means.
    pub(super) fn insist(&mut self, command: Command) -> Result<Answer, Failure> {
        match self.order(command, &mut |_| Ok(()))? {
            Answer::Refused(code) => Err(failed(self.explained(code))),
            answer => Ok(answer),
        }
    }

    /// "error:9: what it means".
    pub(super) fn explained(&self, code: u16) -> String {
        format!("error:{code}: {}", error_advice(self.board.firmware, code))
    }

    /// Resets the board and waits until it is back.
    ///
    /// # Errors
    /// It does not come back.
    pub(super) fn reset(&mut self) -> Result<(), Failure> {
        self.command(Command::Reset);
        let mut waited_s = 0.0;
        while waited_s < READY_WAIT_S {
            match self.next(EVENT_WAIT) {
                Some(Event::Restarted) => return Ok(()),
                Some(_) => {}
                None => waited_s += EVENT_WAIT.as_secs_f64(),
            }
        }
        Err(failed("the board does not come back after a reset: switch it off and on"))
    }

    /// Waits until the machine rests, or is locked.
    ///
    /// # Errors
    /// An alarm, or a dead port.
    pub(super) fn wait_for_rest(&mut self) -> Result<(), Failure> {
        let mut reports = 0;
        while reports < REST_REPORTS {
            match self.next(EVENT_WAIT) {
                Some(Event::Status(status, _)) => reports = if status.state.at_rest() { reports + 1 } else { 0 },
                Some(Event::Trouble(Trouble::Alarm { .. })) if self.interrupted() => {}
                Some(Event::Trouble(trouble)) => return Err(machine_failure(trouble)),
                Some(_) | None => {}
            }
        }
        Ok(())
    }

    /// Waits for a job's end. Troubles and messages on the way go to `tell`.
    pub(super) fn wait_for_end(
        &mut self,
        tell: &mut dyn FnMut(&str) -> Result<(), Failure>,
    ) -> Result<Ending, Failure> {
        loop {
            match self.next(EVENT_WAIT) {
                Some(Event::Ended(ending)) => return Ok(ending),
                Some(Event::Denied(reason)) => return Err(failed(reason)),
                Some(Event::Message(message)) => tell(&message)?,
                Some(_) | None => {}
            }
        }
    }

    /// Where the tool stands, for people.
    pub(super) fn place(&self) -> String {
        let state = self.status.state.word();
        let pair = |[x, y, _]: [f64; 3]| format!("X{x:.3} Y{y:.3}");
        match (self.status.work_mm, self.status.machine_mm) {
            (Some(work), Some(machine)) => {
                format!("{state} at {} (machine {})", pair(work), pair(machine))
            }
            (Some(at), None) | (None, Some(at)) => format!("{state} at {}", pair(at)),
            (None, None) => state.to_owned(),
        }
    }

    /// The same for scripts.
    pub(super) fn place_json(&self) -> serde_json::Value {
        let pair = |at: Option<[f64; 3]>| at.map(|[x, y, _]| [x, y]);
        json!({ "state": self.status.state.word(), "work_mm": pair(self.status.work_mm), "machine_mm": pair(self.status.machine_mm) })
    }

    /// True when the board homes ($22); boards that do not tell are taken to.
    pub(super) fn homes(&self) -> bool {
        self.board.switch(22) != Some(false)
    }

    /// Ends the program as stopped by the user, when the machine has been told so.
    pub(super) fn leave_stopped(self) -> ! {
        drop(self.link);
        std::process::exit(Exit::STOPPED)
    }
}

/// True for an answer to `$G` that has the beam commanded on: "[GC:G1 G54 G17 G21 G90 G94 M3 M9 T0 F6000 S500]".
fn is_lit(answer: &str) -> bool {
    let modes = answer.strip_prefix("[GC:").and_then(|rest| rest.strip_suffix(']'));
    modes.is_some_and(|modes| modes.split(' ').any(|word| matches!(word, "M3" | "M4" | "M03" | "M04")))
}

fn lock(handling: &Mutex<Handling>) -> MutexGuard<'_, Handling> {
    // A panic elsewhere leaves three plain values, all of them valid.
    handling.lock().unwrap_or_else(PoisonError::into_inner)
}

fn interrupt(handling: &Mutex<Handling>) {
    let mut handling = lock(handling);
    let command = match handling.meaning {
        OnInterrupt::Leave => std::process::exit(Exit::STOPPED),
        OnInterrupt::Heed => None,
        OnInterrupt::Stop => Some(Command::Stop),
        OnInterrupt::CancelJog => Some(Command::JogCancel),
        OnInterrupt::Reset => Some(Command::Reset),
    };
    handling.interrupted = true;
    if let (Some(commands), Some(command)) = (&handling.commands, command) {
        // A session that has ended has told why.
        let _ = commands.send(command);
    }
}
