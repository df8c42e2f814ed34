//! Toolpaths become G-code for GRBL 1.1, and G-code becomes moves.
//!
//! ```text
//! Toolpath --emit--> Program --trace--> moves --estimate--> times
//!        text --parse--^                  '-----check-----> findings
//! ```
//!
//! [`trace`] is the only interpreter of G-code in the house; whoever wants to know what a program does reads its [`Move`]s.
//! The dialect is that of GRBL 1.1 (<https://github.com/gnea/grbl/wiki>) in laser mode.

mod arcs;
mod check;
mod emit;
mod moves;
mod parse;
mod planner;
mod program;
mod trace;
mod words;
mod writer;

pub use check::{CheckSettings, Finding, check};
pub use emit::{AirWords, Dialect, Error, Header, emit};
pub use moves::{Action, Beam, Move};
pub use parse::{ParseError, parse};
pub use planner::{Limits, Timing, estimate};
pub use program::{Line, Program, Word};
pub use trace::{TraceError, TraceProblem, trace};
