//! The machine on the line: programs go to a board, and what it says comes back as events.
//!
//! ```text
//! bytes, time, commands --Session--> bytes, events        Link: a session on a thread, with a Port and the clock
//! reports, endings --Recorder--> Journal --Record--> where a job is taken up again
//! moves, Board --preflight--> findings                    before the first line is sent
//! moves --Extent--> Frame --lines--> a program            the border, to see where a job lies
//! ```
//!
//! On Unix `ServedBoard` puts the emulated board behind a pseudo-terminal, so that any sender can be tried on it.
//!
//! [`Session`] has no clock, no port and no thread: it is told what came and when, and says what to write. Lines are counted into the board's receive
//! buffer; each answer is matched to its line; a line that makes the board write its memory goes alone and at rest. Whatever goes wrong ends in a
//! hold, a wait for rest and a reset, and in an account of which lines are carried out. The protocol is that of GRBL 1.1
//! (<https://github.com/gnea/grbl/wiki/Grbl-v1.1-Interface>), which grblHAL and FluidNC speak too.

mod advice;
mod alignment;
mod board;
mod course;
mod emulated;
mod event;
mod forecast;
mod frame;
mod jog;
mod journal;
mod ledger;
mod link;
mod overrides;
mod pace;
mod plan;
mod port;
mod preflight;
mod realtime;
mod reply;
mod sendable;
#[cfg(unix)]
mod served;
mod session;
mod status;
mod survey;
mod trouble;
mod window;

pub use advice::{alarm_advice, error_advice};
pub use alignment::{Alignment, AlignmentError};
pub use board::Board;
pub use event::{Action, Command, Ending, Event, Lines, Outcome};
pub use forecast::{Forecast, Outlook};
pub use frame::{Extent, Frame, Tracing};
pub use jog::within_travel;
pub use journal::{Head, Journal, JournalError, Mark, Note, Record, Recorder, Standing};
pub use ledger::{Progress, Reached};
pub use link::Link;
pub use plan::{Plan, Planned};
pub use port::{Address, Listed, OpenError, Port, lasting_name, list_ports};
pub use preflight::{Demand, Expected, Finding, Weight, preflight};
pub use realtime::Override;
pub use reply::Firmware;
#[cfg(unix)]
pub use served::ServedBoard;
pub use session::{Session, Settings};
pub use status::{State, Status};
pub use survey::Survey;
pub use trouble::Trouble;
