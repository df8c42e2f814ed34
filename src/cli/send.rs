//! `furbelow send JOB.nc`: checks the job and the board, then sends the one to the other.

use std::fs::File;
use std::io::{BufRead, BufReader, IsTerminal};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::json;

use super::connection::{self, EVENT_WAIT};
use super::{Exit, Failure, output};
use crate::config::{Library, Machine};
use crate::stream::{self, Command, Demand, Ending, Event, Link, Outcome, Progress, Status, Weight};
use crate::{gcode, job};

/// Arguments of `send`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// G-code file
    #[arg(value_name = "JOB.nc")]
    job: PathBuf,
    /// Machine it goes to (see `furbelow machine list`), or a path
    #[arg(short, long)]
    machine: String,
    /// Where its board hangs (see `furbelow ports`): a device, tcp:HOST[:PORT], or emulator
    #[arg(long)]
    port: String,
    /// The setup checklist is done: do not ask
    #[arg(short, long)]
    yes: bool,
    /// Send it although it was made for another machine
    #[arg(long)]
    anyway: bool,
    /// One JSON object a line on stdout instead of sentences
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let machine = Library::open().machine(&args.machine)?;
    let name = args.job.display();
    let unreadable = |e: std::io::Error| Failure::config(format!("{name} cannot be read: {e}"));
    let text = std::fs::read_to_string(&args.job).map_err(unreadable)?;
    let refused = |why: String| Failure { exit: Exit::Refused, source: why.into() };
    let program = gcode::parse(&text).map_err(|e| refused(format!("{name}: {e}")))?;
    let report = gcode::check(&program, &job::check_settings(&machine, None));
    if let Some(finding) = report.errors.first() {
        return Err(refused(format!("{name} must not be sent: {finding}; furbelow check tells all")));
    }
    let moves = gcode::trace(&program).map_err(|e| refused(format!("{name}: {e}")))?;
    let demand = Demand::of(&moves);
    let made_for = text.lines().find_map(|line| stream::header_value(line, "machine"));

    let link = connection::open(&args.port, &machine)?;
    let commands = link.commands();
    let started = Arc::new(AtomicBool::new(false));
    let runs = Arc::clone(&started);
    let stop = move || match runs.load(Ordering::SeqCst) {
        // Nothing has been sent that moves: there is nothing to stop.
        false => std::process::exit(Exit::STOPPED),
        // The first stops in order; the session takes a second one as a reset at once.
        true => commands.iter().for_each(|c| drop(c.send(Command::Stop))),
    };
    ctrlc::set_handler(stop).map_err(Failure::config)?;

    let (board, status) = connection::wait_until_ready(&link)?;
    connection::require_idle(&status)?;
    let mut refusals = Vec::new();
    for finding in stream::preflight(&demand, made_for, &board, &job::expected(&machine)) {
        let fix = finding.fix.map(|fix| format!(" [{fix}]")).unwrap_or_default();
        if finding.weight == Weight::Refusal && !(args.anyway && finding.code == "other-machine") {
            refusals.push(format!("{}{fix}", finding.message));
        } else {
            eprintln!("warning: {}{fix}", finding.message);
        }
    }
    if !refusals.is_empty() {
        return Err(refused(refusals.join("; ")));
    }
    if !args.yes {
        confirm(&machine)?;
    }
    let lines = BufReader::new(File::open(&args.job).map_err(unreadable)?).lines();
    started.store(true, Ordering::SeqCst);
    link.command(Command::Run { lines: Box::new(lines), ends_at_mm: demand.ends_at_mm });
    let ending = follow(&link, args, report.lines, machine.controller.max_s)?;
    // Before the process ends, so that the thread has said its last word.
    drop(link);
    match ending.outcome {
        Outcome::Done => Ok(()),
        Outcome::Stopped => std::process::exit(Exit::STOPPED),
        Outcome::Failed(trouble) => Err(connection::machine_failure(trouble)),
    }
}

fn confirm(machine: &Machine) -> Result<(), Failure> {
    output::checklist(&machine.setup)?;
    if !std::io::stdin().is_terminal() {
        return Err(Failure::config("nobody is there to tick the checklist off; give --yes when it is done"));
    }
    output::line("all done? Enter starts the machine, Ctrl-C leaves it alone")?;
    std::io::stdin().read_line(&mut String::new())?;
    Ok(())
}

/// Tells what happens until the job has ended.
fn follow(link: &Link, args: &Args, lines: usize, max_s: f64) -> Result<Ending, Failure> {
    let mut told_percent = None;
    loop {
        let Some((at, event)) = link.next(EVENT_WAIT) else { continue };
        let t_s = at.as_secs_f64();
        match &event {
            Event::Status(status, progress) if args.json => tell_status(t_s, status, *progress, max_s)?,
            Event::Status(status, progress) => {
                let percent = 100 * progress.executed / lines.max(1);
                // One line every five percent is enough for a log.
                if told_percent != Some(percent / 5) {
                    told_percent = Some(percent / 5);
                    output::line(&format!(
                        "{percent:3} %  line {} of {lines}  {}",
                        progress.executed,
                        status.state.word()
                    ))?;
                }
            }
            Event::Trouble(trouble) => tell(args, t_s, "trouble", &trouble.to_string())?,
            Event::Message(message) => tell(args, t_s, "message", message)?,
            Event::Denied(reason) => {
                return Err(connection::failed(*reason));
            }
            Event::Ended(ending) => {
                if args.json {
                    let outcome = match ending.outcome {
                        Outcome::Done => "done",
                        Outcome::Stopped => "stopped",
                        Outcome::Failed(_) => "failed",
                    };
                    let Progress { sent, acked, executed } = ending.progress;
                    compact(&json!({
                        "t_s": t_s, "event": "end", "outcome": outcome, "line": sent, "acked": acked, "executed": executed,
                        "maybe": ending.maybe, "position_kept": ending.position_kept, "beam_off": ending.beam_off,
                        "message": ending.account(),
                    }))?;
                } else {
                    output::line(&ending.account())?;
                }
                return Ok(ending.clone());
            }
            Event::Ready(_) | Event::Text(_) | Event::Answered { .. } | Event::Restarted => {}
        }
    }
}

fn tell_status(t_s: f64, status: &Status, progress: Progress, max_s: f64) -> Result<(), Failure> {
    let place = |axis: usize| status.work_mm.map(|p| p[axis]);
    compact(&json!({
        "t_s": t_s, "event": "status", "line": progress.sent, "acked": progress.acked, "executed": progress.executed,
        "state": status.state.word(), "x_mm": place(0), "y_mm": place(1),
        "feed_mm_per_min": status.feed_mm_per_min, "power": status.power_s / max_s,
    }))
}

fn tell(args: &Args, t_s: f64, event: &str, message: &str) -> Result<(), Failure> {
    if args.json {
        return compact(&json!({ "t_s": t_s, "event": event, "message": message }));
    }
    output::line(message)
}

fn compact(value: &serde_json::Value) -> Result<(), Failure> {
    output::line(&value.to_string())
}
