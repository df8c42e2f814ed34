//! `furbelow jobs`: what was sent, how far it came, and tidying up.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::{Value, json};

use super::{Failure, output, preview};
use crate::config::{self, Library};
use crate::job::{self, Form, Look, minutes};
use crate::preview::Come;
use crate::stream::{Journal, JournalError, Mark, Progress, Record, Standing};

/// Seconds in a day.
const DAY_S: u64 = 86_400;

/// Arguments of `jobs`.
#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

#[derive(Debug, clap::Subcommand)]
enum Command {
    /// All that is known of one job
    Show {
        /// Its number
        job: u32,
        /// Draw what is surely cut, what may be and what is left, .png or .svg, to hold against the sheet
        #[arg(long, value_name = "FILE")]
        picture: Option<PathBuf>,
        /// One JSON object on stdout
        #[arg(long)]
        json: bool,
    },
    /// Remove jobs that are done or old, with their copies of the programs
    Prune {
        /// Keep so many of those that are done, the last ones
        #[arg(long, value_name = "N", default_value_t = 20)]
        keep: usize,
        /// Remove those that were not finished after so many days
        #[arg(long, value_name = "N", default_value_t = 90)]
        days: u64,
        /// One JSON object on stdout
        #[arg(long)]
        json: bool,
    },
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let journal = journal()?;
    match &args.command {
        None => list(&journal, args.json),
        Some(Command::Show { job, picture, json }) => {
            let record = journal.record(*job)?;
            if let Some(file) = picture {
                draw(&record, file)?;
            }
            show(&record, *json)
        }
        Some(Command::Prune { keep, days, json }) => prune(&journal, *keep, *days, *json),
    }
}

/// The user's journal.
///
/// # Errors
/// There is no home directory to keep it in.
pub(super) fn journal() -> Result<Journal, JournalError> {
    config::jobs_folder().map(Journal::at).ok_or_else(|| JournalError::Garbled {
        path: "the folder for jobs".into(),
        reason: format!("there is no home directory; set {} to a folder", config::FOLDER_VARIABLE),
    })
}

fn list(journal: &Journal, as_json: bool) -> Result<(), Failure> {
    let records = journal.records()?;
    if as_json {
        return output::json(&json!({ "jobs": records.iter().map(told).collect::<Vec<Value>>() }));
    }
    if records.is_empty() {
        return output::line("nothing was sent yet");
    }
    let mut rows = vec![["JOB", "WHEN", "MACHINE", "HOW IT STANDS", "PROGRAM"].map(str::to_owned).to_vec()];
    let now_s = now_unix_s();
    rows.extend(records.iter().map(|record| {
        let (Record { number, head, .. }, (sheet, of)) = (record, record.head.sheet);
        let sheet = if of > 1 { format!(" (sheet {sheet} of {of})") } else { String::new() };
        let name = format!("{}{sheet}", head.name);
        vec![
            number.to_string(),
            ago(now_s.saturating_sub(head.began_unix_s)),
            head.machine.clone(),
            stands(record),
            name,
        ]
    }));
    output::line(&output::table(&rows))
}

/// "stopped in line 120 of 400".
fn stands(record: &Record) -> String {
    let word = record.standing.word();
    match record.standing {
        Standing::Done => word.to_owned(),
        Standing::Resumed => record.resumed_by().map_or(word.to_owned(), |by| format!("{word} as job {by}")),
        _ => format!("{word}, line {} of {}", record.progress().executed, record.head.lines),
    }
}

fn show(record: &Record, as_json: bool) -> Result<(), Failure> {
    let Record { number, head, notes, standing, .. } = record;
    if as_json {
        let mut object = told(record);
        object["notes"] = json!(notes);
        object["head"] = json!(head);
        return output::json(&object);
    }
    let Progress { sent, acked, executed, reached } = record.progress();
    let place = |at: Option<[f64; 3]>| {
        at.map_or("not known".to_owned(), |[x, y, _]| format!("X{} Y{}", output::number(x), output::number(y)))
    };
    let last = notes.last();
    let mut rows = vec![
        output::fact("job", format!("{number}: {}", head.name)),
        output::fact("how it stands", stands(record)),
        output::fact("began", ago(now_unix_s().saturating_sub(head.began_unix_s))),
        output::fact("took", last.map_or("-".to_owned(), |note| minutes(note.t_s))),
        output::fact("machine", format!("{} at {}, {}", head.machine, head.port, head.firmware)),
        output::fact("homed", if head.homed { "yes" } else { "no" }),
        output::fact("work zero", format!("machine {}", place(head.offset_mm))),
        output::fact("lines", format!("{executed} surely done, {acked} accepted, {sent} sent, of {}", head.lines)),
    ];
    if let Some(reached) = reached.filter(|reached| reached.line > executed) {
        let seen = format!("{} mm into line {}", output::number(reached.along_mm), reached.line);
        rows.push(output::fact(
            "last seen",
            format!("{seen}, machine {}", place(notes.iter().rev().find_map(|n| n.machine_mm))),
        ));
    }
    rows.extend(head.resumes.map(|before| output::fact("goes on with", format!("job {before}"))));
    for note in notes.iter().filter(|note| matches!(note.mark, Mark::Trouble | Mark::Failed | Mark::Stopped)) {
        let text = note.message.as_deref().unwrap_or_default();
        rows.push(output::fact(&format!("after {}", minutes(note.t_s)), text));
    }
    if standing.is_open() {
        rows.push(output::fact("to go on", format!("furbelow resume {number}")));
    }
    output::line(&output::table(&rows))
}

/// Draws how far a job has come.
fn draw(record: &Record, file: &Path) -> Result<(), Failure> {
    let named = |reason: String| Failure::config(format!("--picture {}: {reason}", file.display()));
    let longer_px = match preview::form_of(file) {
        Some(Form::Png(px)) => Some(px),
        Some(Form::Svg) => None,
        Some(Form::Html) | None => return Err(named("name a file that ends in .png or .svg".to_owned())),
    };
    let program = record.program()?;
    let bytes = fs::read(&program).map_err(|e| Failure::config(format!("{}: {e}", program.display())))?;
    let text = String::from_utf8_lossy(&bytes);
    let title = format!("job {}: {}", record.number, record.head.name);
    let library = Library::open();
    // The machine may be another computer's file by now.
    let machine = Some(record.head.machine.as_str()).filter(|name| library.machine(name).is_ok());
    let place = record.progress().place();
    let come = Come { line: place.line, along_mm: place.along_mm, maybe: record.maybe() };
    let look = Look { name: &title, text: &text, machine, material: None };
    let looked = job::look_back(&look, &library, come, longer_px)?;
    fs::write(file, looked.bytes).map_err(|e| named(e.to_string()))
}

fn prune(journal: &Journal, keep: usize, days: u64, as_json: bool) -> Result<(), Failure> {
    let records = journal.records()?;
    let is_over = |record: &&Record| matches!(record.standing, Standing::Done | Standing::Resumed);
    let over = records.iter().filter(is_over).count();
    let done = records.iter().filter(is_over).take(over.saturating_sub(keep));
    let oldest_s = now_unix_s().saturating_sub(days * DAY_S);
    let old = records.iter().filter(|r| r.standing.is_open() && r.head.began_unix_s < oldest_s);
    let mut removed: Vec<u32> = done.chain(old).map(|record| record.number).collect();
    removed.extend(journal.stillborn()?);
    removed.sort_unstable();
    for number in &removed {
        journal.remove(*number)?;
    }
    let left = records.len() + journal.stillborn()?.len()
        - removed.iter().filter(|n| records.iter().any(|r| r.number == **n)).count();
    if as_json {
        return output::json(&json!({ "removed": removed, "left": left }));
    }
    output::line(&format!("{} removed, {left} left", output::count(removed.len(), "job")))
}

fn told(record: &Record) -> Value {
    let Record { number, head, standing, .. } = record;
    let Progress { sent, acked, executed, reached } = record.progress();
    json!({
        "job": number, "standing": standing.word(), "name": head.name, "sheet": head.sheet.0, "sheets": head.sheet.1,
        "machine": head.machine, "port": head.port, "began_unix_s": head.began_unix_s, "lines": head.lines,
        "sent": sent, "acked": acked, "executed": executed, "reached": reached, "maybe": record.maybe(),
        "position_kept": record.position_kept(), "resumes": head.resumes, "resumed_by": record.resumed_by(),
        "message": record.message(),
    })
}

fn now_unix_s() -> u64 {
    // A clock before 1970 makes every job young.
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

/// "3 h ago".
fn ago(seconds: u64) -> String {
    match seconds {
        0..=59 => "just now".to_owned(),
        60..=3599 => format!("{} min ago", seconds / 60),
        3600..=172_799 => format!("{} h ago", seconds / 3600),
        _ => format!("{} days ago", seconds / DAY_S),
    }
}

impl From<JournalError> for Failure {
    fn from(error: JournalError) -> Failure {
        Failure::config(error)
    }
}
