//! `furbelow make SHAPE`: everything up to files; nothing is sent.

use std::path::{Path, PathBuf};

use super::batch::BatchArgs;
use super::order::Shape;
use super::output;
use super::screen::Screen;
use super::{Exit, Failure};
use crate::config::Library;
use crate::job::{self, Made, minutes};

/// Arguments of `make`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    shape: Shape,
    #[command(flatten)]
    batch: BatchArgs,
    /// Folder to write into [default: out/ and the shape's name, or the design's own folder]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace a different design in that folder
    #[arg(long)]
    force: bool,
    /// Also write drawings with the kerf in them, NAME-kerf.svg, for programs that know none
    #[arg(long)]
    svg_kerf: bool,
    /// Print report.json on stdout instead of a table
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: Args) -> Result<(), Failure> {
    let mut order = args.shape.order()?;
    order.force = args.force;
    order.svg_kerf = args.svg_kerf;
    order.batch = args.batch.batch()?;
    let out = args.out.unwrap_or_else(|| default_folder(&args.shape, &order.name));
    let mut screen = Screen::open()?;
    let made = job::make(&order, &Library::open(), &out, &mut screen);
    screen.close();
    let made = made?;
    if args.json { output::json(&made.report) } else { tell(&made, &out) }
}

/// A design file's own folder, for anything else one of its name.
fn default_folder(shape: &Shape, name: &str) -> PathBuf {
    match shape.design_file() {
        Some(file) => {
            let folder = file.parent().unwrap_or(Path::new("."));
            if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_path_buf() }
        }
        None => Path::new("out").join(name),
    }
}

/// The table at the end.
fn tell(made: &Made, out: &Path) -> Result<(), Failure> {
    let report = &made.report;
    let row = |cells: &[&str]| cells.iter().map(|c| (*c).to_owned()).collect::<Vec<String>>();
    let mut rows = vec![row(&["part", "filled", "sticks out", "joints", "strip", "mass"])];
    for part in &report.parts {
        rows.push(vec![
            part.name.clone(),
            format!("{:.0} %", 100.0 * (1.0 - part.uncovered_fraction)),
            format!("{:.1} %", 100.0 * part.protruding_fraction),
            part.connection_points.to_string(),
            format!("{:.0} mm", part.strip_length_mm),
            format!("{:.1} g", part.strip_mass_g),
        ]);
    }
    output::line(&output::table(&rows))?;
    let mut rows = vec![row(&["sheet", "stock", "pieces", "used", "cut", "engrave", "time"])];
    for sheet in &report.sheets {
        rows.push(vec![
            sheet.file.clone(),
            sheet.stock.clone(),
            sheet.pieces.to_string(),
            format!("{:.0} %", 100.0 * sheet.density),
            format!("{:.2} m", sheet.cut_mm / 1e3),
            format!("{:.2} m", sheet.engrave_mm / 1e3),
            minutes(sheet.time_s),
        ]);
    }
    output::line(&format!("\n{}", output::table(&rows)))?;
    let totals = &report.totals;
    output::line(&format!(
        "\n{} on {}: {} on {}, {:.1} g, {} of cutting",
        report.material,
        report.machine,
        output::count(report.pieces.len(), "piece"),
        output::count(totals.sheets, "sheet"),
        totals.mass_g,
        minutes(totals.time_s)
    ))?;
    if !report.warnings.is_empty() {
        output::line("")?;
    }
    for warning in &report.warnings {
        let place: Vec<&str> = [&warning.part, &warning.place].into_iter().flatten().map(String::as_str).collect();
        let place = if place.is_empty() { String::new() } else { format!(" ({})", place.join(", ")) };
        output::line(&format!("! {}{place}", warning.message))?;
    }
    let next = if made.files.iter().any(|file| file.ends_with("print.pdf")) {
        "\nto cut it: print print.pdf at 100 %, cut along the lines, and follow assembly.pdf".to_owned()
    } else if made.files.iter().any(|file| file.extension().is_some_and(|e| e == "plt")) {
        ": look at parts/ and sheets/*.png\nto cut it: give sheets/*.plt to the cutter as they are, by its own driver or by copying them to its port; then follow assembly.pdf".to_owned()
    } else {
        format!(
            ": look at parts/ and sheets/*.png\nto cut it: furbelow send {o} -m {m} --port PORT  (furbelow ports names them), or load sheets/*.nc into your sender; then follow assembly.pdf",
            o = quoted(out),
            m = report.machine,
        )
    };
    output::line(&format!(
        "\nwrote {} files to {}{next}\nto change something: edit {d} and run  furbelow make {d}",
        made.files.len(),
        out.display(),
        d = quoted(&out.join("design.toml")),
    ))
}

/// A path that can be copied into a shell.
pub(super) fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/\\._-:".contains(c);
    if text.chars().all(plain) { text } else { format!("\"{text}\"") }
}

impl From<job::Error> for Failure {
    fn from(error: job::Error) -> Failure {
        let exit = if error.refuses_job() { Exit::Refused } else { Exit::Config };
        Failure { exit, source: error.into() }
    }
}
