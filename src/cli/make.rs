//! `furbelow make SHAPE`: everything up to files; nothing is sent.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};

use super::output;
use super::{Exit, Failure};
use crate::config::Library;
use crate::design;
use crate::job::{self, Anchor, Batch, Made, Order, Overrides, StartFrom, minutes};
use crate::progress::{Observer, Progress};

/// Arguments of `make`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The shape: .obj, .stl, or a design .toml
    shape: PathBuf,
    /// Machine to cut on (see `furbelow machine list`), or a path
    #[arg(short, long)]
    machine: Option<String>,
    /// Material to cut (see `furbelow profile list`), or a path
    #[arg(short = 'p', long, alias = "profile")]
    material: Option<String>,
    /// Sheets to cut from: A4, A3, or WxH in mm, with @N for how many there are; several in order of preference
    #[arg(long, value_name = "A4|A3|WxH[@N]", value_delimiter = ',')]
    stock: Vec<String>,
    /// Scale the shape to this height
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    height_mm: Option<f64>,
    /// Axis of the shape's file that points up [default: y for .obj, z for .stl]
    #[arg(long)]
    up: Option<Up>,
    /// Number of layers [default: from the outline]
    #[arg(long, value_name = "N")]
    layers: Option<usize>,
    /// How the bottom stands [default: auto, free where it stands by itself]
    #[arg(long)]
    foot: Option<Foot>,
    /// Cut from a roll of this width instead of sheets
    #[arg(long, value_name = "MM", conflicts_with = "stock")]
    roll: Option<f64>,
    /// Cut only these pieces, as when one was torn: A3,B1
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,
    /// Number of sets, each on sheets of its own
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=500))]
    copies: u32,
    /// File with a name on each line, lettered on the margin of one set each
    #[arg(long, value_name = "FILE")]
    names: Option<PathBuf>,
    /// Where the job lies: where the machine knows the sheet to be, with a point of it (--anchor) at work zero, or at where the head stands
    #[arg(long, value_name = "WHERE", default_value = "absolute")]
    start_from: Start,
    /// Which point of the job lies there, with --start-from origin or current [default: front-left]
    #[arg(long, value_name = "POINT")]
    anchor: Option<AnchorPoint>,
    /// Folder to write into [default: out/ and the shape's name, or the design's own folder]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace a different design in that folder
    #[arg(long)]
    force: bool,
    /// Print report.json on stdout instead of a table
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Start {
    /// The sheet lies in the machine's stop corner
    Absolute,
    /// The anchor lies at work X0 Y0, as set by hand
    Origin,
    /// The anchor lies where the head stands when the job starts
    Current,
}

/// Nine points of the box around the job.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum AnchorPoint {
    FrontLeft,
    Front,
    FrontRight,
    Left,
    Center,
    Right,
    BackLeft,
    Back,
    BackRight,
}

impl AnchorPoint {
    fn anchor(self) -> Anchor {
        let (x, y) = match self {
            AnchorPoint::FrontLeft => (0.0, 0.0),
            AnchorPoint::Front => (0.5, 0.0),
            AnchorPoint::FrontRight => (1.0, 0.0),
            AnchorPoint::Left => (0.0, 0.5),
            AnchorPoint::Center => (0.5, 0.5),
            AnchorPoint::Right => (1.0, 0.5),
            AnchorPoint::BackLeft => (0.0, 1.0),
            AnchorPoint::Back => (0.5, 1.0),
            AnchorPoint::BackRight => (1.0, 1.0),
        };
        Anchor { x, y }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Up {
    X,
    Y,
    Z,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Foot {
    Auto,
    Free,
    Pinned,
}

pub(super) fn run(args: Args) -> Result<(), Failure> {
    let is_design = args.shape.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    let overrides = Overrides {
        machine: args.machine.clone(),
        material: args.material.clone(),
        stock: args.roll.map_or_else(|| args.stock.clone(), |width_mm| vec![format!("roll {width_mm}")]),
        height_mm: args.height_mm,
        up: args.up.map(|up| match up {
            Up::X => design::Up::X,
            Up::Y => design::Up::Y,
            Up::Z => design::Up::Z,
        }),
        layers: args.layers,
        foot: args.foot.map(|foot| match foot {
            Foot::Auto => design::Foot::Auto,
            Foot::Free => design::Foot::Free,
            Foot::Pinned => design::Foot::Pinned,
        }),
    };
    let mut order = if is_design {
        Order::from_file(&args.shape, &overrides)?
    } else {
        let named = |value: &Option<String>, what: &str, list: &str| match value {
            Some(_) => Ok(()),
            None => Err(Failure::config(format!("--{what} is missing; `furbelow {list} list` shows what there is"))),
        };
        named(&args.machine, "machine", "machine")?;
        named(&args.material, "material", "profile")?;
        Order::from_mesh(&args.shape, &overrides)?
    };
    order.force = args.force;
    order.batch = batch(&args)?;
    let out = args.out.unwrap_or_else(|| default_folder(&args.shape, is_design));
    listen_for_interrupts()?;
    let mut screen = Screen::new();
    let made = job::make(&order, &Library::open(), &out, &mut screen);
    screen.bar.finish_and_clear();
    let made = made?;
    if args.json { output::json(&made.report) } else { tell(&made, &out) }
}

/// What is cut this time.
fn batch(args: &Args) -> Result<Batch, Failure> {
    let anchor = args.anchor.unwrap_or(AnchorPoint::FrontLeft).anchor();
    let start = match args.start_from {
        Start::Absolute if args.anchor.is_some() => {
            let way_out = "--anchor says which point lies at a place set by hand: add --start-from origin or --start-from current";
            return Err(Failure::config(way_out.to_owned()));
        }
        Start::Absolute => StartFrom::Absolute,
        Start::Origin => StartFrom::Origin(anchor),
        Start::Current => StartFrom::Current(anchor),
    };
    let names = match &args.names {
        None => Vec::new(),
        Some(file) => {
            let text =
                std::fs::read_to_string(file).map_err(|e| Failure::config(format!("{}: {e}", file.display())))?;
            text.lines().map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect()
        }
    };
    Ok(Batch { only: args.only.clone(), copies: args.copies as usize, names, start })
}

fn default_folder(shape: &Path, is_design: bool) -> PathBuf {
    if is_design {
        let folder = shape.parent().unwrap_or(Path::new("."));
        return if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_path_buf() };
    }
    Path::new("out").join(shape.file_stem().unwrap_or(shape.as_os_str()))
}

/// How often the user pressed Ctrl-C.
static INTERRUPTS: AtomicU32 = AtomicU32::new(0);

/// True once files are being written.
static WRITING: AtomicBool = AtomicBool::new(false);

/// First Ctrl-C: go on with the best so far. Second: end at once; nothing is written before everything is.
fn listen_for_interrupts() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        // What is being written takes a moment and is put in place as one: that is finished.
        if INTERRUPTS.fetch_add(1, Ordering::SeqCst) > 0 && !WRITING.load(Ordering::SeqCst) {
            eprintln!("furbelow: stopped, nothing was written");
            std::process::exit(Exit::STOPPED);
        }
    })
    .map_err(Failure::config)
}

/// Shows progress on stderr when that is a terminal, and passes a Ctrl-C on.
struct Screen {
    bar: ProgressBar,
    stage: &'static str,
}

impl Screen {
    fn new() -> Screen {
        let bar = ProgressBar::new(0);
        // Literal templates: they cannot fail to parse.
        if let Ok(style) = ProgressStyle::with_template("{prefix:<9} {bar:30} {msg}") {
            bar.set_style(style);
        }
        Screen { bar, stage: "" }
    }
}

impl Observer for Screen {
    fn step(&mut self, progress: Progress) -> ControlFlow<()> {
        if progress.stage != self.stage {
            self.stage = progress.stage;
            self.bar.set_prefix(progress.stage);
            WRITING.store(progress.stage == job::WRITING, Ordering::SeqCst);
        }
        self.bar.set_length(progress.total.max(1));
        self.bar.set_position(progress.done);
        self.bar.set_message(progress.note);
        if INTERRUPTS.load(Ordering::SeqCst) > 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
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
    output::line(&format!(
        "\nwrote {} files to {}: look at parts/ and sheets/*.png, then load the programs in sheets/ into your sender.\nto change something: edit {d} and run  furbelow make {d}",
        made.files.len(),
        out.display(),
        d = quoted(&out.join("design.toml")),
    ))
}

/// A path that can be copied into a shell.
fn quoted(path: &Path) -> String {
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
