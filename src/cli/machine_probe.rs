//! `furbelow machine probe`: asks a board what it is and writes a machine file of it.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::talk::Talk;
use super::{Failure, output};
use crate::config::{Library, Machine};
use crate::job::{self, Difference};

/// The machine whose tool and checklist stand in where a board cannot tell.
const USUAL_MACHINE: &str = "diode-400";

/// What the file's machine is called when nobody says.
const USUAL_NAME: &str = "probed";

/// Arguments of `machine probe`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Where the board hangs (see `furbelow ports`): a device, tcp:HOST[:PORT], or emulator
    #[arg(long)]
    port: String,
    /// Machine file to compare with, whose tool and checklist the new one takes over
    #[arg(short, long)]
    machine: Option<String>,
    /// Serial speed [default: that of --machine, or 115200]
    #[arg(long)]
    baud: Option<u32>,
    /// File to write [default: print it]
    #[arg(short, long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
    /// Replace the file when it is there
    #[arg(long)]
    force: bool,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args, library: &Library) -> Result<(), Failure> {
    let name = name(args)?;
    if let Some(out) = args.out.as_deref().filter(|out| out.exists() && !args.force) {
        return Err(Failure::config(format!("{} is there already: name another file, or give --force", out.display())));
    }
    let mut base = library.machine(args.machine.as_deref().unwrap_or(USUAL_MACHINE))?;
    super::connection::require_board(&base)?;
    base.controller.baud = args.baud.unwrap_or(base.controller.baud);
    let talk = Talk::open_with(&args.port, base.controller.baud, false)?;
    let machine = job::probed(&talk.board, &base, &name);
    let text = job::machine_file(&machine, &talk.answers);
    // What is written must be readable; a board may hold values no machine has.
    library.machine_in("what the board tells", text.clone())?;
    let differences = args.machine.as_ref().map(|_| job::differences(&base, &machine));
    if let Some(out) = &args.out {
        write(out, &text)?;
    }
    if args.json {
        return json(&talk, &machine, differences.as_deref());
    }
    if args.out.is_none() {
        output::line(text.trim_end())?;
    }
    tell(args, &talk, &base, differences.as_deref())
}

/// The machine's name: that of the file it goes to.
fn name(args: &Args) -> Result<String, Failure> {
    let Some(out) = &args.out else { return Ok(USUAL_NAME.to_owned()) };
    let stem = out.file_name().and_then(|name| name.to_str()).and_then(|name| name.strip_suffix(".toml"));
    stem.map(str::to_owned)
        .ok_or_else(|| Failure::config(format!("--out {}: machine files end in .toml", out.display())))
}

fn write(out: &Path, text: &str) -> Result<(), Failure> {
    std::fs::write(out, text).map_err(|e| Failure::config(format!("{}: {e}", out.display())))
}

fn json(talk: &Talk, machine: &Machine, differences: Option<&[Difference]>) -> Result<(), Failure> {
    let board = &talk.board;
    let settings: serde_json::Map<_, _> = board.settings.iter().map(|(n, v)| (format!("${n}"), json!(v))).collect();
    output::json(&json!({
        "firmware": board.firmware.title(), "version": board.version, "planner_blocks": board.blocks,
        "rx_bytes": board.rx_bytes, "settings": settings, "work_zero_mm": board.offset_mm, "answers": talk.answers,
        "machine": machine, "differences": differences,
    }))
}

/// A value as people write it.
fn plain(value: &serde_json::Value) -> String {
    match value {
        serde_json::Value::Null => "none".to_owned(),
        serde_json::Value::String(text) => text.clone(),
        value => value.as_f64().map_or_else(|| value.to_string(), output::number),
    }
}

/// What was found, where it does not get into the file that is printed.
fn tell(args: &Args, talk: &Talk, base: &Machine, differences: Option<&[Difference]>) -> Result<(), Failure> {
    let mut lines = Vec::new();
    let board = &talk.board;
    if let Some(out) = &args.out {
        lines.push(format!("{} {}: wrote {}", board.firmware.title(), board.version, out.display()));
        lines.push("check its [tool] table and the setup list: a board does not know what hangs on it".to_owned());
    }
    if let Some(differences) = differences {
        if differences.is_empty() {
            lines.push(format!("the board agrees with {}", base.name));
        }
        for Difference { key, file, board } in differences {
            lines.push(format!("{key}: {} in {}, {} on the board", plain(file), base.name, plain(board)));
        }
    }
    match args.out {
        Some(_) => lines.iter().try_for_each(|line| output::line(line)),
        // The file is on stdout.
        None => lines.iter().try_for_each(|line| {
            eprintln!("{line}");
            Ok(())
        }),
    }
}
