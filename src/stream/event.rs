//! What goes in and out of a session.

use super::board::Board;
use super::ledger::Progress;
use super::realtime::Override;
use super::status::Status;
use super::trouble::Trouble;

/// The lines of a job, read while it is sent.
pub type Lines = Box<dyn Iterator<Item = std::io::Result<String>> + Send>;

/// What a user asks of a session.
pub enum Command {
    /// Send a program.
    Run {
        /// Its lines.
        lines: Lines,
    },
    /// Let the board read a program in its check mode (`$C`): nothing moves or burns. Every line it refuses is told as an [`Event::Trouble`]; the
    /// outcome is [`Outcome::Done`] when it takes all of them. Lines that begin with `$` or would write the board's memory are not
    /// sent, and told as messages. The position and work zero stay; G92 is forgotten.
    Check {
        /// Its lines.
        lines: Lines,
    },
    /// Send one line by itself: a question or an order. [`Event::Answered`] follows, at once when nothing of it is to be sent.
    Line(String),
    /// Ask the board all first questions again; [`Event::Ready`] follows, with its settings as they are now.
    Ask,
    /// Seek the switches (`$H`).
    Home,
    /// Unlock after an alarm (`$X`).
    Unlock,
    /// Move from where the tool stands, mm, at a feed in mm/min.
    Jog {
        /// Along x, mm.
        dx_mm: f64,
        /// Along y, mm.
        dy_mm: f64,
        /// mm/min.
        feed_mm_per_min: f64,
    },
    /// Move to a place in work coordinates, mm, at a feed in mm/min; an axis without a place stays where it is.
    JogTo {
        /// Along x, mm.
        x_mm: Option<f64>,
        /// Along y, mm.
        y_mm: Option<f64>,
        /// mm/min.
        feed_mm_per_min: f64,
    },
    /// End a jog at once and drop those that wait.
    JogCancel,
    /// Send the board to sleep: motors and laser off.
    Sleep,
    /// Brake and hold; the beam goes out.
    Hold,
    /// Go on after a hold or a door.
    Resume,
    /// As if the door were opened.
    Door,
    /// Scale feeds, travels or power, %.
    Override(Override, u16),
    /// End the job: hold, wait for rest, reset. The position is kept.
    Stop,
    /// Reset at once, even while moving: the position may be lost.
    Reset,
    /// The user goes away: a job that runs is stopped as by [`Command::Stop`], once, and a jog is ended.
    Close,
}

/// What a session wants done.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Bytes for the port.
    Write(Vec<u8>),
    /// Something to tell.
    Event(Event),
}

/// What a session tells.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// The board has answered all questions: ready for a job.
    Ready(Board),
    /// A status report, its work position filled in where work zero is known, and how far the job has come.
    Status(Status, Progress),
    /// A message of the board's.
    Message(String),
    /// Any other line of the board's, answers to questions among them.
    Text(String),
    /// `ok` or the error number of a line that was sent by itself.
    Answered {
        /// The line.
        line: String,
        /// GRBL's number of an error.
        error: Option<u16>,
    },
    /// Something went wrong. When a job runs, it is being ended: [`Event::Ended`] follows. A check goes on after a line that is refused.
    Trouble(Trouble),
    /// A command that cannot be obeyed now, and why.
    Denied(&'static str),
    /// The board has started anew, as asked.
    Restarted,
    /// A job, or whatever was stopped, has come to its end.
    Ended(Ending),
}

/// How a job ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// All lines are carried out.
    Done,
    /// Stopped because it was asked for.
    Stopped,
    /// Ended by trouble.
    Failed(Trouble),
}

/// How a job ended, and what is known of its lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Ending {
    /// How.
    pub outcome: Outcome,
    /// How far it came.
    pub progress: Progress,
    /// The last line that may be carried out, in part or whole; no later one is. Equal to `progress.executed` when nothing is in doubt.
    pub maybe: usize,
    /// The board's position is still right: it came to rest before it was reset.
    pub position_kept: bool,
    /// The board answered at the end, so that its beam is known to be off.
    pub beam_off: bool,
}

impl Ending {
    /// The same where the board had started anew before the job began, and so did not know where it was.
    pub fn after_restart(self) -> Ending {
        Ending { outcome: Outcome::Failed(Trouble::Restarted), position_kept: false, ..self }
    }

    /// The account of the lines, for people.
    pub fn account(&self) -> String {
        let Ending { progress: Progress { executed, .. }, maybe, .. } = self;
        let mut account = match executed {
            0 => "no line is surely carried out".to_owned(),
            n => format!("lines up to {n} are carried out"),
        };
        if maybe > executed {
            account += &format!(", lines {} to {maybe} may be, in part or whole", executed + 1);
        }
        if self.outcome != Outcome::Done {
            account += if self.position_kept {
                "; the position is kept"
            } else {
                "; the position is in doubt: home or zero again"
            };
        }
        if !self.beam_off {
            account += "; the board does not answer: SWITCH THE LASER OFF BY HAND";
        }
        account
    }
}
