//! `furbelow send JOB`: checks programs and board, then sends the ones to the other and stays to the end.
//!
//! ```text
//! files --program: checked by streaming--> board: homed, zeroed, set right, preflight --> checklist --> sheets: one by one, followed
//! ```

mod board;
mod fleet;
mod keeping;
mod placed;
mod program;
pub(super) mod resume;
mod sheets;
mod teller;
mod watched_file;

use std::io::IsTerminal;
use std::path::PathBuf;

use indicatif::{ProgressBar, ProgressStyle};

use self::program::Program;
use self::teller::Teller;
use super::connection::{Where, machine_failure};
use super::keyboard::Keyboard;
use super::placing::Placing;
use super::talk::Talk;
use super::{Exit, Failure, job_files, output};
use crate::config::{self, Library, Machine};
use crate::job;
use crate::stream::{Outcome, Record};

/// Arguments of `send`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// G-code, or a folder `make` wrote: its sheets one after the other
    #[arg(value_name = "JOB.nc|DIR")]
    job: PathBuf,
    #[command(flatten)]
    at: Option<Where>,
    /// Several machines at once, each NAME@PORT; the sheets of the folder are dealt out among them
    #[arg(long, value_name = "NAME@PORT,...", value_delimiter = ',', conflicts_with_all = ["machine", "port", "zero", "fix", "check_on_board", "from", "align"])]
    machines: Vec<String>,
    /// Material on the bed (see `furbelow profile list`), or a path: adds its own checklist [default: the one the file names]
    #[arg(short = 'p', long, alias = "profile")]
    material: Option<String>,
    /// Begin with this sheet of the folder, from 1
    #[arg(long, value_name = "N", default_value_t = 1)]
    from_sheet: usize,
    #[command(flatten)]
    placing: Placing,
    /// Home the machine first
    #[arg(long)]
    home: bool,
    /// Make the place where the head stands work zero first, as `furbelow jog --zero` does
    #[arg(long)]
    zero: bool,
    /// Set the board's settings right where they differ dangerously from the machine file ($30, $32, $13, $10), for good
    #[arg(long)]
    fix: bool,
    /// Let the board itself read every line first, without moving ($C)
    #[arg(long)]
    check_on_board: bool,
    /// The setup checklist is done: do not ask
    #[arg(short, long)]
    yes: bool,
    /// Between sheets wait so long instead of asking: for who, or what, loads them in that time
    #[arg(long, value_name = "SECONDS")]
    pause_s: Option<u32>,
    /// Send it although it was made for another machine
    #[arg(long)]
    anyway: bool,
    /// One JSON object a line on stdout instead of sentences
    #[arg(long)]
    json: bool,
}

/// All that is at hand while a job is sent.
struct Sending<'a> {
    args: &'a Args,
    at: &'a Where,
    machine: Machine,
    programs: Vec<Program>,
    /// What is to be done before every job, on this machine and with these materials.
    setup: Vec<String>,
    /// Whoever sits at the terminal.
    keyboard: Option<Keyboard>,
    talk: Talk,
    teller: &'a mut Teller,
    /// Programs that lie elsewhere or begin in their middle are written anew here.
    scratch: tempfile::TempDir,
    /// The job this one goes on with.
    resumes: Option<Record>,
    /// So many of the programs, from the first on, lie where they are to be cut.
    placed: usize,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if !args.machines.is_empty() {
        return fleet::run(args);
    }
    let at = args.at.as_ref().ok_or_else(|| {
        Failure::config("name the machine and its port (-m and --port), or several with --machines NAME@PORT,...")
    })?;
    let machine = at.machine()?;
    let mut teller = Teller::new(args.json, machine.controller.max_s);
    let sent = send(args, at, machine, &mut teller);
    tell_end(sent, "all is cut", &teller)
}

/// Tells how it ended, with these words when it is `done`, and makes the exit code say the same.
fn tell_end(sent: Result<Outcome, Failure>, done: &str, teller: &Teller) -> Result<(), Failure> {
    let sent = sent.map_err(|failure| match failure.is_broken_pipe() {
        // For what only prints that is the end; a job that was broken off must not look like success.
        true => super::connection::failed("nobody reads what is told any more: the job was stopped"),
        false => failure,
    });
    match sent {
        Ok(Outcome::Done) => teller.over("done", done),
        Ok(Outcome::Stopped) => {
            // Nobody may be listening, and the exit code says the same.
            let _ = teller.over("stopped", "stopped on request");
            std::process::exit(Exit::STOPPED)
        }
        Ok(Outcome::Failed(trouble)) => {
            teller.over("failed", &trouble.to_string())?;
            Err(machine_failure(trouble))
        }
        Err(failure) => {
            let outcome = if failure.exit == Exit::Machine { "failed" } else { "refused" };
            // The failure itself matters more than that it could not be told twice.
            let _ = teller.over(outcome, &failure.source.to_string());
            Err(failure)
        }
    }
}

/// From the arguments to the end of the last sheet. The board is let go of at its end, whatever that is.
fn send(args: &Args, at: &Where, machine: Machine, teller: &mut Teller) -> Result<Outcome, Failure> {
    let files = files(args)?;
    let somebody = std::io::stdin().is_terminal();
    if !somebody && !args.yes {
        return Err(Failure::config("nobody is there to tick the checklist off; give --yes when it is done"));
    }
    if !somebody && files.len() > 1 && args.pause_s.is_none() {
        return Err(Failure::config(format!(
            "{} and nobody is there to load the next: send them one by one, or say with --pause-s how many seconds loading takes",
            output::count(files.len(), "sheet")
        )));
    }
    if files.len() > 1 && args.placing.is_of_one_sheet() {
        return Err(Failure::config(format!(
            "--align gives the crosses of one sheet, and there are {}: send them one by one, or give --align alone and move the head onto the crosses of each",
            files.len()
        )));
    }
    // All sheets before the first is cut: a set that cannot be finished is not begun.
    let programs = check(&files, &machine)?;
    let setup = setup(args, &machine, &programs, &mut |code, message| teller.warn(code, message))?;
    for program in &programs {
        if program.warnings > 0 {
            let count = output::count(program.warnings, "warning");
            teller.warn("check", &format!("{}: {count}; furbelow check tells them", program.name()))?;
        }
    }
    let talk = Talk::open(&at.port, &machine)?;
    let keyboard = somebody.then(Keyboard::open);
    let scratch = tempfile::tempdir()?;
    let (resumes, placed) = (None, 0);
    let mut sending = Sending { args, at, machine, programs, setup, keyboard, talk, teller, scratch, resumes, placed };
    if !sending.get_ready()? || !sending.place_programs()? {
        return Ok(Outcome::Stopped);
    }
    sending.go()
}

impl Sending<'_> {
    /// From a machine that is ready and programs that lie where they should to the end of the last sheet.
    fn go(&mut self) -> Result<Outcome, Failure> {
        self.preflight(0..self.programs.len())?;
        if !self.check_on_board(0..self.placed)? {
            return Ok(Outcome::Stopped);
        }
        if !self.tick_off()? {
            return Ok(Outcome::Stopped);
        }
        self.cut()
    }
}

/// The files to send, in order.
fn files(args: &Args) -> Result<Vec<PathBuf>, Failure> {
    let mut files = job_files::programs(&args.job)?;
    if !(1..=files.len()).contains(&args.from_sheet) {
        let count = output::count(files.len(), "sheet");
        return Err(Failure::config(format!("--from-sheet {}: there are {count}", args.from_sheet)));
    }
    files.drain(..args.from_sheet - 1);
    Ok(files)
}

/// Reads and checks every file.
fn check(files: &[PathBuf], machine: &Machine) -> Result<Vec<Program>, Failure> {
    let settings = job::check_settings(machine, None);
    let size = |path: &PathBuf| path.metadata().map_or(0, |m| m.len());
    let bar = ProgressBar::new(files.iter().map(size).sum::<u64>().max(1));
    // A literal template: it cannot fail to parse.
    if let Ok(style) = ProgressStyle::with_template("checking  {bar:30} {percent} %") {
        bar.set_style(style);
    }
    let mut before = 0;
    let programs = files.iter().map(|path| {
        let program =
            Program::read(path, path.display().to_string(), &settings, |done| bar.set_position(before + done));
        before += size(path);
        program
    });
    let programs = programs.collect();
    bar.finish_and_clear();
    programs
}

/// The machine's checklist and that of every material, each step once; doubts about where values come from are told to `warn`, code first.
///
/// # Errors
/// A material that must never go under this tool.
fn setup(
    args: &Args,
    machine: &Machine,
    programs: &[Program],
    warn: &mut dyn FnMut(&str, &str) -> Result<(), Failure>,
) -> Result<Vec<String>, Failure> {
    let library = Library::open();
    let mut steps = machine.setup.clone();
    let mut told = Vec::new();
    for program in programs {
        for doubt in program.label.doubts(machine) {
            if !told.contains(&doubt.message) {
                warn(doubt.code, &doubt.message)?;
                told.push(doubt.message);
            }
        }
        // A name in a file may be of another computer's library; one on the command line must be known.
        let profile = match (&args.material, &program.label.material) {
            (Some(name), _) => Some(library.profile(name)?),
            (None, Some(name)) => library.profile(name).ok(),
            (None, None) => None,
        };
        let Some(profile) = profile else { continue };
        if let Err(error @ config::Error::Forbidden { .. }) = machine.pair(&profile) {
            return Err(error.into());
        }
        steps.extend(profile.setup.into_iter().filter(|step| !machine.setup.contains(step)));
    }
    let mut once = Vec::new();
    steps.retain(|step| {
        !once.contains(step) && {
            once.push(step.clone());
            true
        }
    });
    Ok(steps)
}
