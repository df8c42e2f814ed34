//! A GRBL 1.1 board in the computer: for tests, for `--port emulator` and for trying a job without a machine.
//!
//! ```text
//! host bytes --link--> receive buffer --lines--> steps --motion--> blocks in time --trace--> Segments
//!            <--link-- answers, reports <--status--
//! ```
//!
//! [`Board::step`] takes a time and bytes and gives bytes; there is no clock, thread or file inside, so that a day's job runs in seconds and the
//! same input always gives the same output. Lines mean what [`crate::gcode::Interpreter`] says and blocks run by the planner's own
//! kinematics; what is added here is time: bytes on the wire, a receive buffer that overflows, a controller that needs time to read,
//! an EEPROM whose writes deafen the link, holds, overrides, alarms and the beam at every instant ([`Board::trace`]).
//! Behaviour follows what GRBL 1.1h was measured to do; [`Personality`] says what its kin do otherwise.

mod assembler;
mod board;
mod controller;
mod faults;
mod link;
mod memory;
mod motion;
mod personality;
mod probe;
mod realtime;
mod restart;
mod settings;
mod status;
mod steps;
mod system;
mod trace;

pub use board::{Board, State};
pub use faults::{Fault, When};
pub use memory::Memory;
pub use personality::Personality;
pub use settings::{BoardSettings, Settings};
pub use trace::Segment;
