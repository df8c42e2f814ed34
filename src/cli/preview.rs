//! `furbelow preview JOB.nc`: what the machine will do, as a page that plays it or as a picture.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::Failure;
use super::output::{self, read_argument};
use crate::config::Library;
use crate::job::{self, Form, Look, minutes};
use crate::preview::ColorBy;

/// Longer side of a PNG, pixels: a 0.15 mm kerf on A3 still shows.
const PNG_PX: u32 = 2400;

/// Arguments of `preview`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// G-code or a plot, furbelow's or any other program's; `-` for stdin
    job: PathBuf,
    /// Machine it runs on (see `furbelow machine list`), or a path [default: the one the file names]
    #[arg(short, long)]
    machine: Option<String>,
    /// Material it cuts (see `furbelow profile list`), or a path [default: the one the file names]
    #[arg(short = 'p', long, alias = "profile")]
    material: Option<String>,
    /// File to write, .html, .svg or .png; `-` for a page on stdout [default: the job's name with .html]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// What the cuts' colours tell
    #[arg(long, value_enum, default_value_t = Color::Power)]
    color: Color,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Color {
    /// Share of full power
    Power,
    /// Commanded speed
    Feed,
    /// Energy left per mm
    Energy,
    /// When it is cut
    Order,
}

impl From<Color> for ColorBy {
    fn from(color: Color) -> ColorBy {
        match color {
            Color::Power => ColorBy::Power,
            Color::Feed => ColorBy::Feed,
            Color::Energy => ColorBy::Energy,
            Color::Order => ColorBy::Order,
        }
    }
}

pub(super) fn run(args: Args) -> Result<(), Failure> {
    let out = args.out.clone().unwrap_or_else(|| default_out(&args.job));
    let form = if out == Path::new("-") { Some(Form::Html) } else { form_of(&out) };
    let form = form.ok_or_else(|| {
        Failure::config(format!("--out {}: name a file that ends in .html, .svg or .png", out.display()))
    })?;
    if out == args.job && out != Path::new("-") {
        return Err(Failure::config(format!(
            "--out {} would replace the job itself; name another file",
            out.display()
        )));
    }
    let (name, text) = read(&args.job)?;
    let look = Look { name: &name, text: &text, machine: args.machine.as_deref(), material: args.material.as_deref() };
    let looked = job::look(&look, &Library::open(), form, args.color.into())?;
    if out == Path::new("-") {
        std::io::stdout().lock().write_all(&looked.bytes)?;
        return Ok(());
    }
    fs::write(&out, &looked.bytes).map_err(|e| Failure::config(format!("{}: {e}", out.display())))?;
    let planned = format!("wrote {}: {} on {}", out.display(), minutes(looked.time_s), looked.machine);
    let guessed = if looked.guessed { ", which nobody named (--machine says otherwise)" } else { "" };
    output::line(&format!("{planned}{guessed}"))
}

/// What is written, by the file's ending; `None` for an ending that tells nothing.
pub(super) fn form_of(file: &Path) -> Option<Form> {
    match file.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "html" | "htm" => Some(Form::Html),
        "svg" => Some(Form::Svg),
        "png" => Some(Form::Png(PNG_PX)),
        _ => None,
    }
}

fn default_out(job: &Path) -> PathBuf {
    if job == Path::new("-") { PathBuf::from("preview.html") } else { job.with_extension("html") }
}

/// The job's name for people and its text. Comments of foreign programs come in all encodings: what is not UTF-8 becomes a mark.
fn read(job: &Path) -> Result<(String, String), Failure> {
    if let Some((name, text)) = job.to_str().map(read_argument).transpose()?.flatten() {
        return Ok((name.to_owned(), text));
    }
    let bytes = fs::read(job).map_err(|e| Failure::config(format!("{}: {e}", job.display())))?;
    let name = job.file_name().unwrap_or(job.as_os_str()).to_string_lossy().into_owned();
    Ok((name, String::from_utf8_lossy(&bytes).into_owned()))
}
