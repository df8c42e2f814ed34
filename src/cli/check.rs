//! `furbelow check JOB.nc`: would this machine do what the G-code says, and is that what is meant.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use super::{Exit, Failure, output};
use crate::config::Library;
use crate::gcode::{self, CheckSettings, Checker, Finding, Report};
use crate::job;

/// Arguments of `check`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// G-code file, `-` for stdin; or a plot, .plt
    #[arg(value_name = "JOB.nc")]
    job: PathBuf,
    /// Machine it is meant for (see `furbelow machine list`), or a path
    #[arg(short, long)]
    machine: String,
    /// Material it cuts (see `furbelow profile list`), or a path: tells scorching
    #[arg(short = 'p', long, alias = "profile")]
    material: Option<String>,
    /// Print one JSON object on stdout instead of sentences
    #[arg(long)]
    json: bool,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Json<'a> {
    errors: &'a [Finding],
    warnings: &'a [Finding],
    bounds_mm: [f64; 4],
    cut_mm: f64,
    travel_mm: f64,
    time_s: f64,
    laser_on_s: f64,
    lines: usize,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let library = Library::open();
    let machine = library.machine(&args.machine)?;
    super::connection::require_board(&machine)?;
    let pairing = match &args.material {
        Some(name) => Some(machine.pair(&library.profile(name)?)?),
        None => None,
    };
    let settings = job::check_settings(&machine, pairing.as_ref());
    let report = if is_plot(&args.job) {
        read_plot(args, &settings, machine.max_feed_mm_per_min())?
    } else {
        read(args, Checker::new(&settings))?
    };
    let bounds = report.bounds;
    let bounds_mm = if bounds.is_empty() { [0.0; 4] } else { [bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y] };
    if args.json {
        let Report { errors, warnings, cut_mm, travel_mm, time_s, laser_on_s, lines, .. } = &report;
        output::json(&Json {
            errors,
            warnings,
            bounds_mm,
            cut_mm: *cut_mm,
            travel_mm: *travel_mm,
            time_s: *time_s,
            laser_on_s: *laser_on_s,
            lines: *lines,
        })?;
    } else {
        tell(args, &report, bounds_mm)?;
    }
    match report.errors.len() {
        0 => Ok(()),
        n => Err(Failure {
            exit: Exit::Refused,
            source: format!("{} must not be sent: {} on {}", name(args), output::count(n, "error"), machine.name)
                .into(),
        }),
    }
}

/// Plots are told by their name: they are read whole, G-code line by line.
fn is_plot(job: &Path) -> bool {
    let ending = job.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    matches!(ending.as_deref(), Some("plt" | "hpgl" | "hgl"))
}

fn read_plot(args: &Args, settings: &CheckSettings, feed_mm_per_min: f64) -> Result<Report, Failure> {
    let told = |e: String| Failure::config(format!("{}: {e}", name(args)));
    let bytes = std::fs::read(&args.job).map_err(|e| told(e.to_string()))?;
    let text = String::from_utf8_lossy(&bytes);
    let moves = gcode::trace_plot(&text, feed_mm_per_min).map_err(|e| told(e.to_string()))?;
    Ok(gcode::check_moves(&moves, text.lines().count(), settings))
}

/// Reads the file line by line.
fn read(args: &Args, mut checker: Checker) -> Result<Report, Failure> {
    let unreadable = |e: std::io::Error| Failure::config(format!("{} cannot be read: {e}", name(args)));
    let (input, size): (Box<dyn Read>, u64) = if args.job.as_os_str() == "-" {
        (Box::new(std::io::stdin().lock()), 0)
    } else {
        let file = File::open(&args.job).map_err(unreadable)?;
        let size = file.metadata().map_or(0, |m| m.len());
        (Box::new(file), size)
    };
    // Nothing is written: Ctrl-C may end it at once.
    ctrlc::set_handler(|| std::process::exit(Exit::STOPPED)).map_err(Failure::config)?;
    let bar = ProgressBar::new(size.max(1));
    // A literal template: it cannot fail to parse.
    if let Ok(style) = ProgressStyle::with_template("checking  {bar:30} {percent} %") {
        bar.set_style(style);
    }
    let input = BufReader::with_capacity(1 << 16, input);
    checker.read(input, |done| bar.set_position(done)).map_err(unreadable)?;
    bar.finish_and_clear();
    Ok(checker.finish())
}

fn name(args: &Args) -> String {
    if args.job.as_os_str() == "-" { "<stdin>".into() } else { args.job.display().to_string() }
}

fn tell(args: &Args, report: &Report, [x0, y0, x1, y1]: [f64; 4]) -> Result<(), Failure> {
    let file = name(args);
    for (kind, findings) in [("error", &report.errors), ("warning", &report.warnings)] {
        for finding in findings {
            output::line(&format!("{file}:{}:{}: {kind}: {}", finding.line, finding.column, finding.message))?;
        }
    }
    let number = output::number;
    let rows = [
        output::fact("lines", report.lines.to_string()),
        output::fact("cuts", format!("{:.2} m", report.cut_mm / 1e3)),
        output::fact("travels", format!("{:.2} m", report.travel_mm / 1e3)),
        output::fact("within", format!("X{} Y{} to X{} Y{} mm", number(x0), number(y0), number(x1), number(y1))),
        output::fact("time", job::minutes(report.time_s)),
    ];
    output::line(&output::table(&rows))?;
    if report.errors.is_empty() && report.warnings.is_empty() {
        output::line("OK: nothing to object to")?;
    }
    Ok(())
}
