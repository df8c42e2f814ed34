//! `furbelow nest FILES...`: anyone's outlines, or one nesting instance, on sheets, offcuts or a roll.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::ArgGroup;
use serde::Serialize;

use super::output::{self, read_argument};
use super::screen::Screen;
use super::{Exit, Failure};
use crate::job::{self, Nestable, Nested};
use crate::nest::{self, Container, Instance, Item, Layouts, Settings};
use crate::progress::{Observer, Progress};

/// Distances for outlines, mm, when none are given: what a laser's kerf and a sheet's ragged edge ask for.
const SPACING_MM: f64 = 2.0;
const MARGIN_MM: f64 = 5.0;

/// Arguments of `nest`.
#[derive(Debug, clap::Args)]
#[command(group(ArgGroup::new("stock").multiple(true).args(["roll", "sheet", "offcut"])))]
pub struct Args {
    /// Outlines, .svg at true size; or one nesting instance, .json (jagua-rs, ESICUP), `-` for one on stdin
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Place on a roll of this width
    #[arg(long, value_name = "MM")]
    roll: Option<f64>,
    /// Longest stretch of the roll to cut at a time
    #[arg(long, value_name = "MM", requires = "roll", default_value_t = 10_000.0)]
    max_length_mm: f64,
    /// Place on sheets: WxH in mm, @N for how many there are, :COST where sizes cost differently; several in order of preference
    #[arg(long, value_name = "WxH[@N][:COST]", value_delimiter = ',')]
    sheet: Vec<String>,
    /// Use up an offcut first: an .svg with its outline, holes and blocked places inside
    #[arg(long, value_name = "FILE")]
    offcut: Vec<PathBuf>,
    /// Turns allowed, degrees [default: 0,180; an instance says its own]
    #[arg(long, value_name = "DEGREES", value_delimiter = ',', allow_negative_numbers = true)]
    angles: Vec<f64>,
    /// Outlines may be turned over: for material without a right side
    #[arg(long)]
    mirror: bool,
    /// How many of everything
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    copies: u32,
    /// Distance between outlines [default: 2; an instance says its own]
    #[arg(long, value_name = "MM")]
    spacing_mm: Option<f64>,
    /// Distance to the edge of the stock [default: 5; for an instance its spacing]
    #[arg(long, value_name = "MM")]
    margin_mm: Option<f64>,
    /// How long to search: lines looked along, some 100000 a second; the same effort and seed give the same result
    #[arg(long, value_name = "N", default_value_t = 500_000)]
    effort: u64,
    /// Stop after so many seconds with the best so far
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    time_s: Option<f64>,
    /// Start of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Folder to write the sheets into: .svg, offcuts, and the job and its solution as JSON
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print placements as JSON on stdout instead of a table
    #[arg(long)]
    json: bool,
}

/// What is asked for, whichever files it came in.
struct Job {
    name: String,
    /// Ids or names, as scripts know them.
    ids: Vec<serde_json::Value>,
    items: Vec<Item>,
    shapes: Vec<Nestable>,
    containers: Vec<Container>,
    /// The file's own coordinates.
    instance: Option<Instance>,
    spacing_mm: f64,
    margin_mm: f64,
}

#[derive(Serialize)]
struct Answer {
    sheets: usize,
    length_mm: f64,
    density: f64,
    seconds: f64,
    stopped_early: bool,
    placements: Vec<Placed>,
    unplaced: Vec<LeftOut>,
}

#[derive(Serialize)]
struct Placed {
    item: serde_json::Value,
    copy: u32,
    /// Which sheet or stretch of the roll, from 0.
    container: usize,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    mirrored: bool,
    rotation_deg: f64,
    x_mm: f64,
    y_mm: f64,
}

#[derive(Serialize)]
struct LeftOut {
    item: serde_json::Value,
    reason: String,
}

/// Stops the search when its time is up, counted from the start of the command.
struct Capped {
    screen: Screen,
    end: Option<Instant>,
}

impl Observer for Capped {
    fn step(&mut self, progress: Progress) -> ControlFlow<()> {
        let answer = self.screen.step(progress);
        if self.end.is_some_and(|end| Instant::now() >= end) { ControlFlow::Break(()) } else { answer }
    }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let began = Instant::now();
    let cap = args.time_s.map(Duration::try_from_secs_f64).transpose();
    let cap = cap.map_err(|_| Failure::config("--time-s must be a number of seconds, 0 or more"))?;
    let job = job(args)?;
    let settings =
        Settings { spacing_mm: job.spacing_mm, margin_mm: job.margin_mm, effort: args.effort, seed: args.seed };
    let end = cap.and_then(|cap| began.checked_add(cap));
    let mut observer = Capped { screen: Screen::open()?, end };
    let layouts = nest::nest(&job.items, &job.containers, &settings, &mut observer);
    observer.screen.close();
    let layouts = layouts.map_err(refused)?;
    let files = match &args.out {
        Some(folder) => {
            let (items, containers, shapes) = (&job.items, &job.containers, &job.shapes);
            let nested = Nested { name: &job.name, items, containers, settings: &settings, layouts: &layouts, shapes };
            job::write_nested(folder, &nested)?
        }
        None => Vec::new(),
    };
    let answer = answer(&job, &layouts, began.elapsed().as_secs_f64());
    if args.json {
        output::json(&answer)?
    } else {
        tell(args, &job, &layouts, &answer, &files)?
    }
    match layouts.unplaced.is_empty() {
        true => Ok(()),
        false => Err(refused(nest::Error::Unplaced(layouts.unplaced))),
    }
}

/// Items that find no place refuse the job; all else that nesting complains of is in the files and values given.
fn refused(error: nest::Error) -> Failure {
    let exit = if matches!(error, nest::Error::Unplaced(_)) { Exit::Refused } else { Exit::Config };
    Failure { exit, source: error.into() }
}

fn job(args: &Args) -> Result<Job, Failure> {
    let is_instance =
        |file: &PathBuf| file.as_os_str() == "-" || file.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let mut job = match args.files.as_slice() {
        [one] if is_instance(one) => instance(one)?,
        many if many.iter().any(is_instance) => {
            return Err(Failure::config(
                "an instance (.json) is nested by itself; give it alone, or outlines (.svg) only",
            ));
        }
        many => outlines(many)?,
    };
    let mut given = args.offcut.iter().map(|file| job::offcut_stock(file)).collect::<Result<Vec<_>, _>>()?;
    given.extend(args.sheet.iter().map(|text| sheet(text)).collect::<Result<Vec<_>, _>>()?);
    given.extend(args.roll.map(|width_mm| {
        let max_length_mm = args.max_length_mm;
        Container::Roll { name: format!("roll {}", output::number(width_mm)), width_mm, max_length_mm }
    }));
    if !given.is_empty() {
        job.containers = given;
        job.instance = None;
    }
    if job.containers.is_empty() {
        return Err(Failure::config("say what to place on: --sheet WxH, --roll MM or --offcut FILE"));
    }
    job.spacing_mm = args.spacing_mm.unwrap_or(job.spacing_mm);
    job.margin_mm = args.margin_mm.unwrap_or(job.margin_mm);
    for item in &mut job.items {
        item.copies = item.copies.saturating_mul(args.copies);
        item.mirror |= args.mirror;
        if !args.angles.is_empty() {
            item.angles_deg.clone_from(&args.angles);
        }
    }
    Ok(job)
}

fn outlines(files: &[PathBuf]) -> Result<Job, Failure> {
    let mut shapes = Vec::new();
    for file in files {
        let found = job::nestables(file)?;
        if found.is_empty() {
            return Err(Failure::config(format!(
                "{}: no closed outline in it; close the outlines (Z at the end of a path) or draw shapes",
                file.display()
            )));
        }
        shapes.extend(found);
    }
    let item = |shape: &Nestable| Item::new(shape.name.clone(), shape.polygon.clone(), vec![0.0, 180.0]);
    Ok(Job {
        name: stem(&files[0]),
        ids: shapes.iter().map(|shape| shape.name.clone().into()).collect(),
        items: shapes.iter().map(item).collect(),
        shapes,
        containers: Vec::new(),
        instance: None,
        spacing_mm: SPACING_MM,
        margin_mm: MARGIN_MM,
    })
}

fn instance(file: &Path) -> Result<Job, Failure> {
    let named = file.to_str().map(read_argument).transpose()?.flatten();
    let (name, text) = match named {
        Some((name, text)) => (name.to_owned(), text),
        None => {
            let failed = |e: std::io::Error| Failure::config(format!("{}: {e}", file.display()));
            (file.display().to_string(), fs::read_to_string(file).map_err(failed)?)
        }
    };
    let instance = Instance::parse(&text).map_err(|e| Failure::config(format!("{name}: {e}")))?;
    let id = |item: &Item| item.name.parse::<u64>().map_or_else(|_| item.name.clone().into(), Into::into);
    Ok(Job {
        name: if instance.name.is_empty() { stem(file) } else { instance.name.clone() },
        ids: instance.items.iter().map(id).collect(),
        items: instance.items.clone(),
        shapes: Vec::new(),
        containers: instance.containers.clone(),
        spacing_mm: instance.spacing_mm,
        margin_mm: instance.spacing_mm,
        instance: Some(instance),
    })
}

fn stem(file: &Path) -> String {
    file.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

/// `600x400`, `600x400@3`, `600x400@3:0.5`.
fn sheet(text: &str) -> Result<Container, Failure> {
    let no_sheet =
        || Failure::config(format!("--sheet {text}: give width x height in mm, 600x400, 600x400@3 or 600x400@3:0.5"));
    let number = |t: &str| t.trim().parse::<f64>().ok().filter(|v| v.is_finite() && *v > 0.0);
    let (rest, own_cost) = match text.split_once(':') {
        Some((rest, cost)) => (rest, Some(cost.trim().parse::<f64>().ok().filter(|c| *c >= 0.0).ok_or_else(no_sheet)?)),
        None => (text, None),
    };
    let (size, own_count) = match rest.split_once('@') {
        Some((size, n)) => (size, Some(n.trim().parse::<u32>().ok().filter(|n| *n > 0).ok_or_else(no_sheet)?)),
        None => (rest, None),
    };
    let sides = size.split_once(['x', 'X']).and_then(|(w, h)| Some((number(w)?, number(h)?)));
    let (width_mm, height_mm) = sides.ok_or_else(no_sheet)?;
    let mut sheet = Container::sheet(size.trim(), width_mm, height_mm, own_count);
    if let (Container::Sheet { cost, .. }, Some(own)) = (&mut sheet, own_cost) {
        *cost = own;
    }
    Ok(sheet)
}

fn answer(job: &Job, layouts: &Layouts, seconds: f64) -> Answer {
    let area = |l: &nest::Layout| l.width_mm * l.height_mm;
    let all: f64 = layouts.layouts.iter().map(area).sum();
    let filled: f64 = layouts.layouts.iter().map(|l| l.density * area(l)).sum();
    let placements = layouts.layouts.iter().enumerate().flat_map(|(container, layout)| {
        layout.placements.iter().map(move |p| {
            let shift = job.instance.as_ref().map_or(p.shift, |instance| instance.shift(layout, p.shift));
            let (item, copy, mirrored) = (job.ids[p.item].clone(), p.copy, p.mirrored);
            Placed { item, copy, container, mirrored, rotation_deg: p.rotation_deg, x_mm: shift.x, y_mm: shift.y }
        })
    });
    let left_out = |u: &nest::Unplaced| LeftOut { item: job.ids[u.item].clone(), reason: u.to_string() };
    Answer {
        sheets: layouts.layouts.len(),
        length_mm: layouts.layouts.iter().map(|l| l.width_mm).sum(),
        density: if all > 0.0 { filled / all } else { 0.0 },
        seconds,
        stopped_early: layouts.stopped_early,
        placements: placements.collect(),
        unplaced: layouts.unplaced.iter().map(left_out).collect(),
    }
}

fn tell(args: &Args, job: &Job, layouts: &Layouts, answer: &Answer, files: &[PathBuf]) -> Result<(), Failure> {
    let heading = ["sheet", "stock", "size", "pieces", "used"].map(str::to_owned).to_vec();
    let rows = layouts.layouts.iter().enumerate().map(|(k, layout)| {
        vec![
            format!("{}", k + 1),
            job.containers[layout.container].name().to_owned(),
            format!("{} x {} mm", output::number(layout.width_mm), output::number(layout.height_mm)),
            layout.placements.len().to_string(),
            format!("{:.1} %", 100.0 * layout.density),
        ]
    });
    output::line(&output::table(&std::iter::once(heading).chain(rows).collect::<Vec<_>>()))?;
    let placed = output::count(answer.placements.len(), "piece");
    let on = output::count(answer.sheets, "sheet");
    output::line(&format!("\n{placed} on {on}, {:.1} % used", 100.0 * answer.density))?;
    if layouts.stopped_early {
        output::line("stopped early: this is the best found until then; a longer search may do better")?;
    }
    match &args.out {
        Some(folder) => output::line(&format!("wrote {} to {}", output::count(files.len(), "file"), folder.display())),
        None => output::line("nothing was written: add --out DIR for drawings, or --json for placements"),
    }
}
