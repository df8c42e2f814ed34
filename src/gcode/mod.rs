//! Toolpaths become G-code for GRBL 1.1, and G-code becomes moves.
//!
//! ```text
//! Toolpath --emit--> Program --trace--> moves --estimate--> times
//!        text --parse--^
//!        text --Rewriter: elsewhere on the bed, or from its middle on--> text
//!        file --Checker, line by line, through the same interpreter and planner--> Report
//! ```
//!
//! [`trace`] is the only interpreter of G-code in the house; whoever wants to know what a program does reads its [`Move`]s.
//! The dialect is that of GRBL 1.1 (<https://github.com/gnea/grbl/wiki>) in laser mode. Plotters that speak HP-GL get a toolpath by [`emit_plot`], and
//! [`trace_plot`] tells what a plot does, in the same moves.

mod arc_words;
mod arcs;
mod burn;
mod check;
mod emit;
mod feeder;
mod finding;
mod held_feed;
mod hpgl;
mod interpreter;
mod kinematics;
mod line_rules;
mod lines;
mod move_rules;
mod moves;
mod parse;
mod planner;
mod problem;
mod program;
mod restart;
mod rewrite;
mod timing;
mod trace;
mod words;
mod writer;

pub use check::{CheckSettings, Checker, Energy, Report, Witness, check, check_moves};
pub use emit::{AirWords, Dialect, Error, Header, ToolWords, emit};
pub use finding::Finding;
pub use hpgl::{PlotError, Plotter, emit_plot, is_plot, trace_plot};
pub use interpreter::{Interpreter, Modal};
pub use lines::read_lines;
pub use moves::{Action, Beam, Move};
pub use parse::{ParseError, parse, parse_line};
pub use planner::{Held, Limits, Planner, Stretch};
pub use problem::{TraceError, TraceProblem};
pub use program::{Line, Program, Word};
pub use restart::{Restart, restart};
pub use rewrite::{RewriteError, Rewriter};
pub use timing::{Speeds, Timing, estimate};
pub use trace::trace;
