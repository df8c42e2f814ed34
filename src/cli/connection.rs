//! What all commands that talk to a board begin with: open the port, ask the board what it is.

use std::time::Duration;

use super::{Exit, Failure};
use crate::config::Machine;
use crate::stream::{Address, Board, Event, Link, Settings, State, Status};

/// How long to wait for one event before looking again.
pub(super) const EVENT_WAIT: Duration = Duration::from_millis(200);

/// How long a board may take to be asked everything: 3 s for a banner, 2 s for a probe, the answers.
const READY_WAIT_S: f64 = 15.0;

/// Opens the port a machine's board hangs on.
pub(super) fn open(port: &str, machine: &Machine) -> Result<Link, Failure> {
    let port = Address::parse(port).open(machine.controller.baud).map_err(machine_failure)?;
    Ok(Link::start(port, Settings::default()))
}

/// Waits until the board has answered all questions: what it is, and its first report, whatever state that tells.
pub(super) fn wait_until_ready(link: &Link) -> Result<(Board, Status), Failure> {
    let mut ready = None;
    let mut waited_s = 0.0;
    while waited_s < READY_WAIT_S {
        match link.next(EVENT_WAIT) {
            None => waited_s += EVENT_WAIT.as_secs_f64(),
            Some((_, Event::Ready(board))) => ready = Some(board),
            Some((_, Event::Trouble(trouble))) => return Err(machine_failure(trouble)),
            Some((_, Event::Status(status, _))) => {
                let Some(mut board) = ready.take() else { continue };
                // Work zero comes with some reports only, the first among them.
                board.offset_mm = match (status.machine_mm, status.work_mm) {
                    (Some(machine), Some(work)) => Some(std::array::from_fn(|k| machine[k] - work[k])),
                    _ => board.offset_mm,
                };
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

/// Ends the command with the exit code of machine errors.
pub(super) fn machine_failure(source: impl std::error::Error + Send + Sync + 'static) -> Failure {
    Failure { exit: Exit::Machine, source: source.into() }
}

/// A machine error told in words.
pub(super) fn failed(why: impl Into<String>) -> Failure {
    Failure { exit: Exit::Machine, source: why.into().into() }
}
