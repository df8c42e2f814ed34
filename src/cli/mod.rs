//! The command line: one file per command, each turning arguments into calls of the rooms below and their answers into text or JSON.
//!
//! A command returns `Result<(), Failure>`; what a [`Failure`] says goes to stderr as a chain, its [`Exit`] becomes the process's exit code.
//! To add a command: a file with its `Args` and a `run`, a variant in [`Command`], an arm in [`Command::run`].

mod batch;
mod calibrate;
mod check;
mod completions;
mod connection;
mod console;
mod design;
mod files;
mod frame;
mod home;
mod job_files;
mod jobs;
mod jog;
mod jog_keys;
mod keyboard;
mod machine;
mod machine_probe;
mod make;
mod nest;
mod order;
mod output;
mod placing;
mod ports;
mod preview;
mod profile;
mod profile_set;
mod screen;
mod send;
mod talk;
mod today;

use std::error::Error;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// From a 3D shape to soft, springy ruffles cut from flat sheet.
#[derive(Debug, Parser)]
#[command(name = "furbelow", version, max_term_width = 110)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What the user asks for.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Turn a shape into sheets of pieces: drawings, G-code and pictures
    Make(make::Args),
    /// Place outlines, anyone's, close together on sheets, offcuts or a roll
    Nest(nest::Args),
    /// Design files: make one, look at its parts, change how dense they are
    #[command(subcommand)]
    Design(design::Command),
    /// Check G-code, of this or another program, against a machine: reach, power, feeds, time
    Check(check::Args),
    /// Look at what a machine will do with a G-code file: a page that plays it, or a picture
    Preview(preview::Args),
    /// Send G-code to a machine and stay with it to the end
    Send(send::Args),
    /// Go on with a job that was stopped, interrupted, or cut short by a fault
    Resume(send::resume::Args),
    /// What was sent and how far it came
    Jobs(jobs::Args),
    /// Drive around everything a job burns, beam off, to see where it lies
    Frame(frame::Args),
    /// Move the head by hand, and set work zero
    Jog(jog::Args),
    /// Drive to the homing switches, or unlock after an alarm
    Home(home::Args),
    /// Talk to a machine's board line by line
    Console(console::Args),
    /// List the ports a machine's board may hang on
    Ports(ports::Args),
    /// Cutters: list them, show one, check a file of your own, make one of what a board tells
    #[command(subcommand)]
    Machine(machine::Command),
    /// Sheet materials: list them, show one, check a file of your own, set values
    #[command(subcommand)]
    Profile(profile::Command),
    /// Test cards: how strong to cut, how wide the kerf, how stiff the sheet
    #[command(subcommand)]
    Calibrate(calibrate::Command),
    /// Print a completion script for a shell
    Completions(completions::Args),
}

impl Command {
    /// Does it.
    pub fn run(self) -> Result<(), Failure> {
        match self {
            Command::Make(args) => make::run(args),
            Command::Nest(args) => nest::run(&args),
            Command::Design(command) => design::run(command),
            Command::Check(args) => check::run(&args),
            Command::Preview(args) => preview::run(args),
            Command::Send(args) => send::run(&args),
            Command::Resume(args) => send::resume::run(&args),
            Command::Jobs(args) => jobs::run(&args),
            Command::Frame(args) => frame::run(&args),
            Command::Jog(args) => jog::run(&args),
            Command::Home(args) => home::run(&args),
            Command::Console(args) => console::run(&args),
            Command::Ports(args) => ports::run(&args),
            Command::Machine(command) => machine::run(command),
            Command::Profile(command) => profile::run(command),
            Command::Calibrate(command) => calibrate::run(command),
            Command::Completions(args) => completions::run(args),
        }
    }
}

/// Exit codes other than 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// 1: the job cannot be made or breaks a limit.
    Refused,
    /// 2: wrong usage, or a file or setting that is not in order.
    Config,
    /// 3: the machine reports an error or an alarm, or does not answer.
    Machine,
}

impl Exit {
    /// 130: stopped by the user, as shells report an interrupt.
    pub const STOPPED: i32 = 130;
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(match exit {
            Exit::Refused => 1,
            Exit::Config => 2,
            Exit::Machine => 3,
        })
    }
}

/// Why a command failed, and the exit code that says so.
#[derive(Debug)]
pub struct Failure {
    /// Becomes the process's exit code.
    pub exit: Exit,
    /// What is told on stderr.
    pub source: Box<dyn Error + Send + Sync>,
}

impl Failure {
    /// A file, name or setting is not in order.
    pub fn config(source: impl Into<Box<dyn Error + Send + Sync>>) -> Failure {
        Failure { exit: Exit::Config, source: source.into() }
    }

    /// The message and what caused it, outermost first.
    pub fn chain(&self) -> impl Iterator<Item = &(dyn Error + 'static)> {
        let first: &(dyn Error + 'static) = self.source.as_ref();
        std::iter::successors(Some(first), |error| (*error).source())
    }

    /// True when output went to a pipe whose reader has seen enough (`| head`): no failure of ours.
    pub fn is_broken_pipe(&self) -> bool {
        self.chain().any(|error| {
            error.downcast_ref::<std::io::Error>().is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
        })
    }
}

impl From<crate::config::Error> for Failure {
    fn from(error: crate::config::Error) -> Failure {
        let exit = if error.refuses_job() { Exit::Refused } else { Exit::Config };
        Failure { exit, source: error.into() }
    }
}

impl From<crate::design::Error> for Failure {
    fn from(error: crate::design::Error) -> Failure {
        Failure::config(error)
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Failure {
        Failure::config(error)
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_broken_pipe_is_recognised_below_other_errors() {
        let pipe = || std::io::Error::from(std::io::ErrorKind::BrokenPipe);
        assert!(Failure::from(pipe()).is_broken_pipe());
        let below = crate::config::Error::Read { path: "out".into(), source: pipe() };
        assert!(Failure::from(below).is_broken_pipe());
        assert!(!Failure::from(std::io::Error::from(std::io::ErrorKind::NotFound)).is_broken_pipe());
    }

    #[test]
    fn a_forbidden_pair_refuses_the_job_and_a_bad_file_is_a_config_error() {
        let library = crate::config::Library::built_in();
        let film = library.profile("polyester-0.1").expect("built in");
        let error = library.machine("diode-400").expect("built in").pair(&film).expect_err("never");
        assert_eq!(Failure::from(error).exit, Exit::Refused);
        assert_eq!(Failure::from(library.machine("nothing").expect_err("unknown")).exit, Exit::Config);
    }
}
