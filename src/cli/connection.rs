//! What all commands that talk to a board begin with: open the port, ask the board what it is.

use std::io::IsTerminal;
use std::time::Duration;

use super::{Exit, Failure, output};
use crate::config::{Dialect, Library, Machine};
use crate::stream::{Address, Board, Command, Event, Link, Settings, State, Status, Trouble};

/// How long to wait for one event before looking again.
pub(super) const EVENT_WAIT: Duration = Duration::from_millis(200);

/// How long a board may take to be asked everything: 3 s for a banner, 2 s for a probe, the answers.
pub(super) const READY_WAIT_S: f64 = 15.0;

/// Where work zero lies is told in the first report after a start and then in every tenth at rest (GRBL's config.h): a board that was not reset by
/// opening the port is asked so often for it.
const ZERO_REPORTS: usize = 12;

/// What most one-shot commands need to know to reach a board.
#[derive(Debug, clap::Args)]
pub(super) struct Where {
    /// Machine it drives (see `furbelow machine list`), or a path
    #[arg(short, long)]
    pub(super) machine: String,
    /// Where its board hangs (see `furbelow ports`): a device, tcp:HOST[:PORT], or emulator (emulator:50x runs 50 times as fast)
    #[arg(long)]
    pub(super) port: String,
}

impl Where {
    /// The machine that is named, if it has a board that can be talked to.
    pub(super) fn machine(&self) -> Result<Machine, Failure> {
        let machine = Library::open().machine(&self.machine)?;
        require_board(&machine)?;
        if machine.controller.dialect == Dialect::Hpgl {
            return Err(Failure::config(format!(
                "{} reads plots (HP-GL) and answers nothing: give sheets/*.plt to it as they are, by its own driver or by copying them to its port",
                machine.name
            )));
        }
        Ok(machine)
    }
}

/// Refuses a machine that nothing can be sent to.
pub(super) fn require_board(machine: &Machine) -> Result<(), Failure> {
    if machine.controller.is_none() {
        return Err(Failure::config(format!(
            "machine {} has no controller: nothing can be sent to it; name the one the program was made for",
            machine.name
        )));
    }
    Ok(())
}

/// Opens the port a board hangs on.
pub(super) fn open_at(port: &str, baud: u32) -> Result<Link, Failure> {
    let port = Address::parse(port).open(baud).map_err(machine_failure)?;
    Ok(Link::start(port, Settings::default()))
}

/// Waits until the board has answered all questions: what it is, and a report that says where work zero lies, whatever state it tells.
/// `answers` takes what it said to the questions. A board that is silent after an alarm is reset once, where that is allowed.
pub(super) fn wait_until_asked(
    link: &Link,
    answers: &mut Vec<String>,
    mut may_reset: bool,
) -> Result<(Board, Status), Failure> {
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
                if status.machine_mm.zip(status.work_mm).is_none() && reports < ZERO_REPORTS {
                    continue;
                }
                let Some(mut board) = ready.take() else { continue };
                board.seen(&status);
                return Ok((board, status));
            }
            Some(_) => {}
        }
    }
    Err(failed("the board does not answer as GRBL does: wrong port, or wrong baud in the machine file"))
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
