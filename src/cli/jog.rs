//! `furbelow jog`: moves the head by hand, beam off, and sets work zero.

use std::io::IsTerminal;

use serde_json::json;

use super::connection::{self, Where, refused};
use super::talk::{Answer, OnInterrupt, Talk};
use super::{Failure, jog_keys, output};
use crate::config::Machine;
use crate::job;
use crate::stream::{Command, within_travel};

/// Feed unless asked otherwise, mm/min: quick, and still followed by the eye.
const USUAL_FEED_MM_PER_MIN: f64 = 3000.0;

/// Makes where the tool stands work zero in G54, which boards keep when they are switched off.
const ZERO_HERE: &str = "G10L20P1X0Y0";

/// Switches the beam off.
const DARK: &str = "M5S0";

/// Arguments of `jog`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// How far along x, mm; without X and Y the arrow keys jog
    #[arg(allow_negative_numbers = true)]
    x: Option<f64>,
    /// How far along y, mm
    #[arg(allow_negative_numbers = true)]
    y: Option<f64>,
    #[command(flatten)]
    at: Where,
    /// X and Y are a place in work coordinates, not distances
    #[arg(long, requires = "y")]
    to: bool,
    /// Where the head stands in the end becomes work zero
    #[arg(long)]
    zero: bool,
    /// mm/min [default: 3000, or what the machine can]
    #[arg(long, value_name = "MM/MIN")]
    feed: Option<f64>,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let machine = args.at.machine()?;
    let feed = feed(args.feed, &machine)?;
    let by_keys = args.x.is_none() && !args.zero;
    if by_keys && !(std::io::stdin().is_terminal() && std::io::stdout().is_terminal()) {
        return Err(Failure::config(
            "say how far, in mm (furbelow jog 10 -5), or run it in a terminal to use arrow keys",
        ));
    }
    let mut talk = Talk::open(&args.at.port, &machine)?;
    connection::require_idle(&talk.status)?;
    // A jog keeps the beam as it is: a constant one would burn along.
    talk.insist(Command::Line(DARK.to_owned()))?;
    if by_keys {
        return jog_keys::run(talk, &machine, feed);
    }
    let asked_mm = [args.x.unwrap_or(0.0), args.y.unwrap_or(0.0)];
    let short_by_mm = match (args.x, args.to) {
        (None, _) => [0.0; 2],
        (Some(_), false) => jog_by(&mut talk, &machine, asked_mm, feed)?,
        (Some(_), true) => jog_to(&mut talk, &machine, asked_mm, feed)?,
    };
    talk.wait_for_rest()?;
    if talk.interrupted() {
        eprintln!("stopped: {}", talk.place());
        talk.leave_stopped();
    }
    if args.zero {
        zero_here(&mut talk)?;
    }
    tell(&talk, args, short_by_mm)
}

fn tell(talk: &Talk, args: &Args, short_by_mm: [f64; 2]) -> Result<(), Failure> {
    if args.json {
        let mut object = talk.place_json();
        object["short_by_mm"] = json!(short_by_mm);
        object["zeroed"] = json!(args.zero);
        return output::json(&object);
    }
    for (axis, short_mm) in ["X", "Y"].into_iter().zip(short_by_mm).filter(|(_, mm)| *mm != 0.0) {
        output::line(&format!("{axis} ends at the machine's travel, {} mm short", output::number(short_mm.abs())))?;
    }
    output::line(&format!("{}{}", talk.place(), if args.zero { ": work zero is here" } else { "" }))
}

/// The feed of jogs, mm/min.
fn feed(asked: Option<f64>, machine: &Machine) -> Result<f64, Failure> {
    let most = machine.max_feed_mm_per_min();
    match asked {
        None => Ok(USUAL_FEED_MM_PER_MIN.min(most)),
        Some(feed) if feed >= 1.0 && feed <= most => Ok(feed),
        Some(feed) => Err(Failure::config(format!("--feed {feed}: {} runs at 1 to {most} mm/min", machine.name))),
    }
}

/// Moves so far, within the travel; returns what was left out.
fn jog_by(talk: &mut Talk, machine: &Machine, asked_mm: [f64; 2], feed_mm_per_min: f64) -> Result<[f64; 2], Failure> {
    let way_mm = clamped(talk, machine, asked_mm);
    jog(talk, Command::Jog { dx_mm: way_mm[0], dy_mm: way_mm[1], feed_mm_per_min })?;
    Ok([asked_mm[0] - way_mm[0], asked_mm[1] - way_mm[1]])
}

/// What of a way the machine can go from where it stands, mm.
pub(super) fn clamped(talk: &Talk, machine: &Machine, asked_mm: [f64; 2]) -> [f64; 2] {
    let [x, y, _] = machine.controller.max_travel_mm;
    within_travel(&talk.board, talk.status.machine_mm, asked_mm, [x, y])
}

/// Moves to a place in work coordinates that the machine reaches.
fn jog_to(talk: &mut Talk, machine: &Machine, to_mm: [f64; 2], feed_mm_per_min: f64) -> Result<[f64; 2], Failure> {
    let reach = job::check_settings(machine, None).work_area;
    let number = output::number;
    for (axis, name) in ["X", "Y"].into_iter().enumerate() {
        let (at, low, high) = (to_mm[axis], reach.min[axis], reach.max[axis]);
        if !(low..=high).contains(&at) {
            return Err(refused(format!(
                "{name}{} lies outside {}'s work area, which runs from {name}{} to {name}{} mm",
                number(at),
                machine.name,
                number(low),
                number(high)
            )));
        }
    }
    jog(talk, Command::JogTo { x_mm: Some(to_mm[0]), y_mm: Some(to_mm[1]), feed_mm_per_min })?;
    Ok([0.0; 2])
}

fn jog(talk: &mut Talk, command: Command) -> Result<Answer, Failure> {
    talk.on_interrupt(OnInterrupt::CancelJog);
    talk.insist(command)
}

/// Makes where the tool stands work zero.
pub(super) fn zero_here(talk: &mut Talk) -> Result<(), Failure> {
    talk.insist(Command::Line(ZERO_HERE.to_owned()))?;
    talk.wait_for_rest()
}
