//! `furbelow frame JOB`: drives around everything a job burns, to show where it lies on the bed.

use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::json;

use super::connection::{self, Where, refused};
use super::keyboard::Keyboard;
use super::placing::{Placing, settings_here};
use super::talk::{OnInterrupt, Talk};
use super::{Failure, job_files, output};
use crate::config::Machine;
use crate::geom::Similarity;
use crate::stream::{self, Command, Demand, Extent, Frame, Outcome, Tracing, Weight};
use crate::{gcode, job};

/// Feed unless asked otherwise, mm/min: an eye can follow it.
const USUAL_FEED_MM_PER_MIN: f64 = 3000.0;

/// Arguments of `frame`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// G-code, one of our sheets' drawings (.svg), or a folder `make` wrote: around all its sheets
    #[arg(value_name = "JOB.nc|SVG|DIR")]
    job: PathBuf,
    #[command(flatten)]
    at: Where,
    #[command(flatten)]
    placing: Placing,
    /// Around the upright box instead of the tightest border
    #[arg(long = "box")]
    upright: bool,
    /// Show the beam at this many % of full power while it moves, never at rest [default: off; alone: as much as the machine file's frame_power_max
    /// allows]
    #[arg(long, value_name = "PERCENT", num_args = 0..=1)]
    beam: Option<Option<f64>>,
    /// Go round until Enter is pressed
    #[arg(long)]
    repeat: bool,
    /// mm/min [default: 3000, or what the machine can]
    #[arg(long, value_name = "MM/MIN")]
    feed: Option<f64>,
    /// With --beam: the setup checklist is done, do not ask
    #[arg(short, long)]
    yes: bool,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let machine = args.at.machine()?;
    let tracing = tracing(args, &machine)?;
    let job = read(args, &machine)?;
    if args.placing.is_by_hand() && args.repeat {
        return Err(Failure::config(
            "--align without places and --repeat both wait for Enter: give --align the places",
        ));
    }
    let mut talk = Talk::open(&args.at.port, &machine)?;
    connection::require_idle(&talk.status)?;
    let keyboard = (args.placing.is_by_hand() && std::io::stdin().is_terminal()).then(Keyboard::open);
    let placing = args.placing.solve(job.crosses_mm, &mut talk, &machine, keyboard.as_ref())?;
    let Some(placing) = placing else { talk.leave_stopped() };
    let frame = job.frame(&placing, args)?;
    let lines = frame.lines(tracing);
    let settings = match args.placing.is_asked_for() {
        true => settings_here(&talk, &machine)?,
        false => job::check_settings(&machine, None),
    };
    let moves = checked(&lines, &settings)?;
    preflight(&talk, &Demand::of(&moves), &job, &machine, tracing.beam_s > 0.0)?;
    if tracing.beam_s > 0.0 && !args.yes {
        connection::confirm(&machine)?;
    }
    let began_mm = talk.status.work_mm.map(|[x, y, _]| [x, y]);
    talk.on_interrupt(OnInterrupt::Stop);
    let enough = args.repeat.then(wait_for_enter);
    let mut rounds = 0;
    let mut outcome = Outcome::Done;
    while outcome == Outcome::Done && !talk.interrupted() {
        outcome = drive(&mut talk, lines.clone())?;
        rounds += usize::from(outcome == Outcome::Done);
        if enough.as_ref().is_none_or(|enough| enough.load(Ordering::SeqCst)) {
            break;
        }
    }
    if outcome == Outcome::Done && !talk.interrupted() {
        // A board without switches takes where the head stands for its place when the port is opened again: it ends where it began.
        outcome = drive(&mut talk, Frame::way_to(began_mm.unwrap_or_default(), machine.up_mm()))?;
    }
    tell(&talk, args, &frame, tracing, rounds, &outcome, began_mm.is_some())?;
    match outcome {
        Outcome::Failed(trouble) => Err(connection::machine_failure(trouble)),
        _ if talk.interrupted() => talk.leave_stopped(),
        _ => Ok(()),
    }
}

/// What is traced, and for which machines its files were made.
struct Job {
    extent: Extent,
    made_for: Option<String>,
    crosses_mm: Option<[[f64; 2]; 2]>,
}

impl Job {
    /// Its border where it is to lie.
    fn frame(&self, placing: &Similarity, args: &Args) -> Result<Frame, Failure> {
        let extent = self.extent.laid(placing);
        let frame = if args.upright { extent.boxed() } else { extent.hull() };
        frame.ok_or_else(|| refused(format!("{} burns nothing: there is no border to trace", args.job.display())))
    }
}

fn read(args: &Args, machine: &Machine) -> Result<Job, Failure> {
    let burns = machine.tool.class.is_laser();
    let mut extent = Extent::default();
    let (mut made_for, mut crosses_mm) = (None, None);
    for path in job_files::programs(&args.job)? {
        let name = path.display().to_string();
        let text =
            std::fs::read_to_string(&path).map_err(|e| Failure::config(format!("{name} cannot be read: {e}")))?;
        job::take_in(&mut extent, &name, &text, burns).map_err(|e| refused(e.to_string()))?;
        let label = job::Label::read(text.as_bytes()).map_err(Failure::config)?;
        made_for = made_for.or(label.machine);
        crosses_mm = crosses_mm.or(label.crosses_mm);
    }
    let job = Job { extent, made_for, crosses_mm };
    // A job without a border is no reason to open a port.
    job.frame(&Similarity::identity(), args)?;
    Ok(job)
}

fn tracing(args: &Args, machine: &Machine) -> Result<Tracing, Failure> {
    let most = machine.max_feed_mm_per_min();
    let feed_mm_per_min = match args.feed {
        None => USUAL_FEED_MM_PER_MIN.min(most),
        Some(feed) if feed >= 1.0 && feed <= most => feed,
        Some(feed) => {
            return Err(Failure::config(format!("--feed {feed}: {} runs at 1 to {most} mm/min", machine.name)));
        }
    };
    let share = match args.beam {
        None => 0.0,
        Some(percent) => beam_share(machine, percent)?,
    };
    // Rounded down: never brighter than allowed.
    let beam_s = (share * machine.controller.max_s * 1e3).floor() / 1e3;
    Ok(Tracing { feed_mm_per_min, beam_s, up_mm: machine.up_mm() })
}

/// The share of full power the beam may have, or why it may not.
fn beam_share(machine: &Machine, asked_percent: Option<f64>) -> Result<f64, Failure> {
    let name = &machine.name;
    if !machine.tool.class.is_laser() {
        return Err(refused(format!("{name} has no laser: leave --beam out")));
    }
    let most = machine.tool.frame_power_max.unwrap_or(0.0);
    if most <= 0.0 {
        return Err(refused(format!(
            "{name}'s file does not allow the beam while the border is traced (frame_power_max): leave --beam out"
        )));
    }
    let most_percent = 100.0 * most;
    match asked_percent {
        None => Ok(most),
        Some(percent) if percent > 0.0 && percent <= most_percent => Ok(percent / 100.0),
        Some(percent) => Err(refused(format!(
            "--beam {percent}: {name}'s file allows more than 0 and at most {} % while the border is traced (frame_power_max)",
            output::number(most_percent)
        ))),
    }
}

/// The moves, when the machine's file has nothing against them: reach, keep-outs.
fn checked(lines: &[String], settings: &gcode::CheckSettings) -> Result<Vec<gcode::Move>, Failure> {
    let unfit = |why: String| refused(format!("the border cannot be traced: {why}"));
    let program = gcode::parse(&lines.join("\n")).map_err(|e| unfit(e.to_string()))?;
    let report = gcode::check(&program, settings);
    if let Some(finding) = report.errors.first() {
        return Err(unfit(finding.message.clone()));
    }
    gcode::trace(&program).map_err(|e| unfit(e.to_string()))
}

/// What stands between the border and this board. With the beam off only what concerns the way is a reason not to go.
fn preflight(talk: &Talk, demand: &Demand, job: &Job, machine: &Machine, beam: bool) -> Result<(), Failure> {
    let mut refusals = Vec::new();
    for finding in stream::preflight(demand, job.made_for.as_deref(), &talk.board, &job::expected(machine)) {
        let fix = finding.fix.map(|fix| format!(" [{fix}]")).unwrap_or_default();
        let message = format!("{}{fix}", finding.message);
        let concerns = match finding.code {
            "beyond-travel" => true,
            "other-machine" => false,
            _ => beam,
        };
        if finding.weight == Weight::Refusal && concerns {
            refusals.push(message);
        } else {
            eprintln!("warning: {message}");
        }
    }
    if refusals.is_empty() { Ok(()) } else { Err(refused(refusals.join("; "))) }
}

/// Sends a few lines and waits for their end.
pub(super) fn drive(talk: &mut Talk, lines: Vec<String>) -> Result<Outcome, Failure> {
    talk.command(Command::Run { lines: Box::new(lines.into_iter().map(Ok)) });
    let ended = talk.wait_for_end(&mut |message| {
        eprintln!("{message}");
        Ok(())
    });
    let ending = match ended {
        Ok(ending) => ending,
        // The stop came between two rounds.
        Err(_) if talk.interrupted() => return Ok(Outcome::Stopped),
        Err(failure) => return Err(failure),
    };
    if ending.outcome != Outcome::Done {
        if !ending.beam_off {
            eprintln!("the board does not answer: SWITCH THE LASER OFF BY HAND");
        } else if !ending.position_kept {
            eprintln!("the position is in doubt: home or zero again");
        }
        if talk.status.machine_mm.is_some() && ending.beam_off {
            talk.wait_for_rest()?;
        }
    }
    Ok(ending.outcome)
}

/// Becomes true when Enter is pressed; never where nobody can press it.
fn wait_for_enter() -> Arc<AtomicBool> {
    let pressed = Arc::new(AtomicBool::new(false));
    let told = Arc::clone(&pressed);
    eprintln!("Enter ends after this round, Ctrl-C at once");
    std::thread::spawn(move || {
        let read = std::io::stdin().read_line(&mut String::new());
        told.store(matches!(read, Ok(n) if n > 0), Ordering::SeqCst);
    });
    pressed
}

fn tell(
    talk: &Talk,
    args: &Args,
    frame: &Frame,
    tracing: Tracing,
    rounds: usize,
    outcome: &Outcome,
    returned: bool,
) -> Result<(), Failure> {
    let bounds = frame.bounds();
    let done = *outcome == Outcome::Done && !talk.interrupted();
    if args.json {
        let mut object = talk.place_json();
        object["bounds_mm"] = json!([bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y]);
        object["corners_mm"] = json!(frame.corners.iter().map(|p| [p.x, p.y]).collect::<Vec<_>>());
        object["beam_s"] = json!(tracing.beam_s);
        object["rounds"] = json!(rounds);
        object["outcome"] = json!(match outcome {
            Outcome::Failed(_) => "failed",
            _ if !done => "stopped",
            _ => "done",
        });
        return output::json(&object);
    }
    let number = output::number;
    let [width, height] = [bounds.width(), bounds.height()].map(number);
    let end = match done {
        true if returned => "back where it began",
        true => "at work zero: the board did not say where it began",
        false => "stopped on the way",
    };
    let times = if rounds == 1 { "once".to_owned() } else { format!("{rounds} times") };
    output::line(&format!(
        "around X{} Y{} to X{} Y{} ({width} x {height} mm) {times}; {end}: {}",
        number(bounds.min.x),
        number(bounds.min.y),
        number(bounds.max.x),
        number(bounds.max.y),
        talk.place()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Library;

    #[test]
    fn the_beam_is_shown_only_as_far_as_the_machine_file_allows() {
        let library = Library::built_in();
        let diode = library.machine("diode-400").unwrap();
        let share = |machine: &Machine, percent| beam_share(machine, percent).map_err(|f| f.source.to_string());
        assert_eq!(share(&diode, None), Ok(0.01));
        assert_eq!(share(&diode, Some(0.5)), Ok(0.005));
        assert!(share(&diode, Some(2.0)).unwrap_err().contains("at most 1 %"));
        assert!(share(&diode, Some(0.0)).is_err() && share(&diode, Some(f64::NAN)).is_err());
        assert!(share(&library.machine("k40").unwrap(), None).unwrap_err().contains("frame_power_max"));
        let mut dark = diode.clone();
        dark.tool.frame_power_max = Some(0.0);
        assert!(share(&dark, Some(0.001)).is_err());
    }
}
