//! What all commands that talk to a board begin with: open the port, ask the board what it is; and how they give it orders and wait for it.

use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::mpsc::Sender;
use std::time::Duration;

use serde_json::json;

use super::{Exit, Failure, output};
use crate::config::Machine;
use crate::stream::{Address, Board, Command, Ending, Event, Link, Settings, State, Status, Trouble, error_advice};

/// How long to wait for one event before looking again.
pub(super) const EVENT_WAIT: Duration = Duration::from_millis(200);

/// How long a board may take to be asked everything: 3 s for a banner, 2 s for a probe, the answers.
const READY_WAIT_S: f64 = 15.0;

/// Where work zero lies is told in the first report after a start and then in every tenth at rest (GRBL's config.h): a board that was not reset by
/// opening the port is asked so often for it.
const ZERO_REPORTS: usize = 12;

/// Reports of rest that are believed after an order was answered: the first may have been under way before.
const REST_REPORTS: u32 = 2;

/// What most one-shot commands need to know to reach a board.
#[derive(Debug, clap::Args)]
pub(super) struct Where {
    /// Machine it drives (see `furbelow machine list`), or a path
    #[arg(short, long)]
    pub(super) machine: String,
    /// Where its board hangs (see `furbelow ports`): a device, tcp:HOST[:PORT], or emulator
    #[arg(long)]
    pub(super) port: String,
}

/// Opens the port a machine's board hangs on.
pub(super) fn open(port: &str, machine: &Machine) -> Result<Link, Failure> {
    open_at(port, machine.controller.baud)
}

fn open_at(port: &str, baud: u32) -> Result<Link, Failure> {
    let port = Address::parse(port).open(baud).map_err(machine_failure)?;
    Ok(Link::start(port, Settings::default()))
}

/// Waits until the board has answered all questions: what it is, and a report that says where work zero lies, whatever
/// state it tells.
pub(super) fn wait_until_ready(link: &Link) -> Result<(Board, Status), Failure> {
    wait_until_asked(link, &mut Vec::new(), false)
}

/// The same; `answers` takes what it said to the questions. A board that is silent after an alarm is reset once, where that is allowed.
fn wait_until_asked(link: &Link, answers: &mut Vec<String>, mut may_reset: bool) -> Result<(Board, Status), Failure> {
    let mut ready = None;
    let mut reports = 0;
    let mut waited_s = 0.0;
    while waited_s < READY_WAIT_S {
        match link.next(EVENT_WAIT) {
            None => waited_s += EVENT_WAIT.as_secs_f64(),
            Some((_, Event::Ready(board))) => ready = Some(board),
            Some((_, Event::Text(text))) => answers.push(text),
            Some((_, Event::Trouble(Trouble::Silent(_)))) if std::mem::take(&mut may_reset) => {
                answers.clear();
                link.command(Command::Reset);
            }
            Some((_, Event::Trouble(trouble))) => return Err(machine_failure(trouble)),
            Some((_, Event::Status(status, _))) => {
                reports += usize::from(ready.is_some());
                let known = offset(&status);
                if known.is_none() && reports < ZERO_REPORTS {
                    continue;
                }
                let Some(mut board) = ready.take() else { continue };
                board.offset_mm = known.or(board.offset_mm);
                return Ok((board, status));
            }
            Some(_) => {}
        }
    }
    Err(failed("the board does not answer as GRBL does: wrong port, or wrong baud in the machine file"))
}

fn offset(status: &Status) -> Option<[f64; 3]> {
    let (machine, work) = (status.machine_mm?, status.work_mm?);
    Some(std::array::from_fn(|k| machine[k] - work[k]))
}

/// What Ctrl-C, SIGTERM and SIGHUP mean at the moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OnInterrupt {
    /// Nothing of ours moves: leave at once.
    Leave,
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
    /// Opens a machine's board and asks it everything. Ctrl-C leaves at once until [`Talk::on_interrupt`] says otherwise.
    pub(super) fn open(port: &str, machine: &Machine) -> Result<Talk, Failure> {
        Talk::open_with(port, machine.controller.baud, false)
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
            self.board.offset_mm = offset(status).or(self.board.offset_mm);
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

fn lock(handling: &Mutex<Handling>) -> std::sync::MutexGuard<'_, Handling> {
    // A panic elsewhere leaves three plain values, all of them valid.
    handling.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

fn interrupt(handling: &Mutex<Handling>) {
    let mut handling = lock(handling);
    let command = match handling.meaning {
        OnInterrupt::Leave => std::process::exit(Exit::STOPPED),
        OnInterrupt::Stop => Command::Stop,
        OnInterrupt::CancelJog => Command::JogCancel,
        OnInterrupt::Reset => Command::Reset,
    };
    handling.interrupted = true;
    if let Some(commands) = &handling.commands {
        // A session that has ended has told why.
        let _ = commands.send(command);
    }
}

/// An error unless the machine is idle.
pub(super) fn require_idle(status: &Status) -> Result<(), Failure> {
    match status.state {
        State::Idle => Ok(()),
        state => {
            Err(failed(format!("the machine is not idle but in {}: home, unlock or reset it first", state.word())))
        }
    }
}

/// Has the setup checklist ticked off by somebody at the terminal.
///
/// # Errors
/// Nobody is there.
pub(super) fn confirm(machine: &Machine) -> Result<(), Failure> {
    output::checklist(&machine.setup)?;
    if !std::io::stdin().is_terminal() {
        return Err(Failure::config("nobody is there to tick the checklist off; give --yes when it is done"));
    }
    output::line("all done? Enter starts the machine, Ctrl-C leaves it alone")?;
    std::io::stdin().read_line(&mut String::new())?;
    Ok(())
}

/// Ends the command with the exit code of machine errors.
pub(super) fn machine_failure(source: impl std::error::Error + Send + Sync + 'static) -> Failure {
    Failure { exit: Exit::Machine, source: source.into() }
}

/// A machine error told in words.
pub(super) fn failed(why: impl Into<String>) -> Failure {
    Failure { exit: Exit::Machine, source: why.into().into() }
}

/// What must not or cannot be done, told in words.
pub(super) fn refused(why: impl Into<String>) -> Failure {
    Failure { exit: Exit::Refused, source: why.into().into() }
}
