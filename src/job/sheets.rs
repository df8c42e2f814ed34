//! Pieces on sheets, and the program that cuts each sheet.

use super::label::motion_told;
use super::order::StartFrom;
use super::settings::Setup;
use super::stock;
use super::strips::Strips;
use super::{Error, Order, SheetLabel};
use crate::config::Grain;
use crate::drawing::{Drawing, DrawnPath, KerfSide, Role, text_paths};
use crate::gcode::{self, CheckSettings, Header, Move, Program};
use crate::geom::{Motion, Rect, V2, tolerance};
use crate::nest::{self, Container, Item, Layout};
use crate::progress::{Observer, Warning};
use crate::toolpath::{self, Toolpath};

/// Where a set's name stands on the scrap: this far from the left edge, mm, beside the first alignment cross.
const NAME_AT_MM: f64 = 10.0;

/// Room above and below it, mm.
const NAME_ROOM_MM: f64 = 1.5;

/// One sheet, ready to cut.
#[derive(Debug, Clone)]
pub(super) struct CutSheet {
    /// "sheet-01".
    pub file: String,
    /// What the file with the program ends in: "nc", "plt".
    pub ending: &'static str,
    /// What it is cut from: "A4".
    pub stock: String,
    /// Where the pieces lie.
    pub layout: Layout,
    /// The pieces, sheet frame, nominal.
    pub drawings: Vec<Drawing>,
    /// What the tool follows.
    pub toolpath: Toolpath,
    /// What the machine reads; empty for a job that is cut by hand.
    pub text: String,
    /// What the machine's pen draws before, as the machine reads it.
    pub pen: Option<String>,
    /// What the tool's own program makes it do.
    pub moves: Vec<Move>,
    /// Planned time, s.
    pub time_s: f64,
}

/// All sheets.
#[derive(Debug, Clone)]
pub(super) struct Sheets {
    /// In cutting order.
    pub sheets: Vec<CutSheet>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// Nests the pieces and writes a program for every sheet of every set. All sets are nested alike and none shares a sheet with another, so that each
/// stays together.
pub(super) fn sheets(
    strips: &Strips,
    setup: &Setup,
    order: &Order,
    observer: &mut dyn Observer,
) -> Result<Sheets, Error> {
    let items: Vec<Item> = strips
        .pieces
        .iter()
        .map(|piece| Item {
            name: piece.name.clone(),
            polygon: piece.drawing.outline().map_or_else(Vec::new, |path| path.flatten(tolerance::FLATTEN_MM)),
            angles_deg: setup.angles_deg(),
        })
        .collect();
    let sets = order.batch.copies.max(order.batch.names.len()).max(1);
    let containers: Vec<_> = strips.stock.iter().map(|sheet| shared(stock::container(sheet, setup), sets)).collect();
    let layouts = nest::nest(&items, &containers, &setup.nest(), observer)?;
    let count = layouts.layouts.len() * sets;
    let used: Vec<_> = layouts.layouts.iter().map(|l| &strips.stock[l.container]).collect();
    let cut_from: Vec<_> = strips.stock.iter().filter(|sheet| used.contains(sheet)).collect();
    let mut warnings = stock::warnings(&cut_from, setup);
    let mut sheets: Vec<CutSheet> = Vec::with_capacity(count);
    for set in 0..sets {
        let name = order.batch.names.get(set).cloned().or_else(|| (sets > 1).then(|| format!("set {}", set + 1)));
        for (layout, stock) in layouts.layouts.iter().zip(&used) {
            let placed = |p: &nest::Placement| strips.pieces[p.item].drawing.moved(&p.motion());
            let mut drawings: Vec<Drawing> = layout.placements.iter().map(placed).collect();
            drawings.extend(name.as_deref().and_then(|name| lettered(name, setup)));
            let number = sheets.len() + 1;
            let place = Place { number, count, stock: &stock.name, set: name.as_deref() };
            sheets.push(program(place, layout.clone(), drawings, setup, order)?);
        }
    }
    for warning in sheets.iter().flat_map(|sheet| &sheet.toolpath.warnings) {
        if !warnings.contains(warning) {
            warnings.push(warning.clone());
        }
    }
    Ok(Sheets { sheets, warnings })
}

/// What one set may take of a stock that is shared by all.
fn shared(container: Container, sets: usize) -> Container {
    match container {
        Container::Sheet { name, width_mm, height_mm, count: Some(count) } => {
            Container::Sheet { name, width_mm, height_mm, count: Some(count / sets as u32) }
        }
        other => other,
    }
}

/// The name of a set on the margin, where no piece lies; `None` where the tool cannot letter or the margin is too narrow.
fn lettered(name: &str, setup: &Setup) -> Option<Drawing> {
    let least_mm = setup.lettering_mm()?;
    let height_mm = (setup.nest().margin_mm - 2.0 * NAME_ROOM_MM).min(2.0 * least_mm);
    if height_mm < least_mm {
        return None;
    }
    let motion = Motion::new(V2::new(NAME_AT_MM, NAME_ROOM_MM), 0.0);
    let label = |path: &crate::geom::Path| DrawnPath {
        path: path.moved(&motion),
        role: Role::Label,
        kerf: KerfSide::On,
        joint: None,
    };
    Some(Drawing { name: name.to_owned(), paths: text_paths(name, height_mm).iter().map(label).collect() })
}

/// Which sheet of the job it is.
#[derive(Clone, Copy)]
struct Place<'a> {
    number: usize,
    count: usize,
    stock: &'a str,
    set: Option<&'a str>,
}

fn program(
    place: Place,
    layout: Layout,
    drawings: Vec<Drawing>,
    setup: &Setup,
    order: &Order,
) -> Result<CutSheet, Error> {
    let file = format!("sheet-{:02}", place.number);
    let start = &order.batch.start;
    let written = |drawings: &[Drawing], settings: &toolpath::Settings| {
        written(&file, place, drawings, [layout.width_mm, layout.height_mm], settings, setup, order)
    };
    let settings = setup.toolpath(start);
    if setup.by_hand() {
        let toolpath = planned(&file, &drawings, [layout.width_mm, layout.height_mm], &settings)?;
        let time_s = 60.0 * toolpath.cut_mm() / setup.pairing.cut.feed_mm_per_min;
        let (stock, text, pen, moves) = (place.stock.to_owned(), String::new(), None, Vec::new());
        return Ok(CutSheet { stock, file, ending: "svg", layout, drawings, toolpath, text, pen, moves, time_s });
    }
    let (pen, program) = match setup.drawing(start) {
        Some(drawing) => (Some(written(&drawings, &drawing)?.text), written(&drawings, &settings)?),
        None => (None, written(&drawings, &settings)?),
    };
    let Written { toolpath, text, moves, time_s } = program;
    let ending = if setup.plots() { "plt" } else { "nc" };
    Ok(CutSheet { stock: place.stock.to_owned(), file, ending, layout, drawings, toolpath, text, pen, moves, time_s })
}

/// A program and what it comes to.
struct Written {
    toolpath: Toolpath,
    text: String,
    moves: Vec<Move>,
    time_s: f64,
}

fn planned(
    file: &str,
    drawings: &[Drawing],
    [width_mm, height_mm]: [f64; 2],
    settings: &toolpath::Settings,
) -> Result<Toolpath, Error> {
    toolpath::plan(drawings, width_mm, height_mm, settings)
        .map_err(|source| Error::Toolpath { sheet: file.to_owned(), source })
}

/// Plans, writes, reads back and checks one program.
fn written(
    file: &str,
    place: Place,
    drawings: &[Drawing],
    size_mm: [f64; 2],
    settings: &toolpath::Settings,
    setup: &Setup,
    order: &Order,
) -> Result<Written, Error> {
    let sheet = || file.to_owned();
    let start = &order.batch.start;
    let toolpath = planned(file, drawings, size_mm, settings)?;
    let refused = |source| Error::Gcode { sheet: sheet(), source };
    let checked = check_settings(setup, start, settings.tool, &toolpath);
    let (text, moves, findings) = if let Some(plotter) = setup.plotter(settings.tool) {
        let text = gcode::emit_plot(&toolpath, &plotter).map_err(refused)?;
        let feed_mm_per_min = setup.machine.max_feed_mm_per_min();
        let moves =
            gcode::trace_plot(&text, feed_mm_per_min).map_err(|source| Error::Plot { file: sheet(), source })?;
        let findings = gcode::check_moves(&moves, text.lines().count(), &checked).errors;
        (text, moves, findings)
    } else {
        let write =
            |header: &Header| gcode::emit(&toolpath, header, &setup.dialect(start, settings.tool)).map_err(refused);
        let read = |program: &Program| gcode::trace(program).map_err(|source| Error::Trace { sheet: sheet(), source });
        // The header tells the planned time, which is known once the moves are.
        let time_s = gcode::estimate(&read(&write(&Header::default())?)?, &setup.limits()).total_s;
        let program = write(&header(place, &toolpath, settings.tool, time_s, setup, order))?;
        let moves = read(&program)?;
        (program.to_string(), moves, gcode::check(&program, &checked).errors)
    };
    if let Some(finding) = findings.into_iter().next() {
        return Err(Error::Check { sheet: sheet(), finding });
    }
    let time_s = gcode::estimate(&moves, &setup.limits()).total_s;
    Ok(Written { toolpath, text, moves, time_s })
}

/// What the machine permits. A job placed by hand lies nobody knows where: it is only checked for its size.
fn check_settings(setup: &Setup, start: &StartFrom, tool: toolpath::Tool, toolpath: &Toolpath) -> CheckSettings {
    let mut settings = setup.check();
    settings.laser &= !setup.is_second(tool);
    match start {
        StartFrom::Absolute => settings,
        StartFrom::Origin(_) | StartFrom::Current(_) => {
            let least = toolpath.bounds().with(toolpath.park).min;
            let size = V2::new(settings.work_area.width(), settings.work_area.height());
            CheckSettings { work_area: Rect { min: least, max: least + size }, keep_outs: Vec::new(), ..settings }
        }
    }
}

fn header(
    place: Place,
    toolpath: &Toolpath,
    tool: toolpath::Tool,
    time_s: f64,
    setup: &Setup,
    order: &Order,
) -> Header {
    let bounds = toolpath.bounds();
    let cut = &setup.pairing.cut;
    let Place { number, count, stock, set } = place;
    let (width_mm, height_mm) = (toolpath.width_mm, toolpath.height_mm);
    let sheet = SheetLabel { number, of: count, stock: stock.to_owned(), width_mm, height_mm };
    let mut entries = vec![("job", order.name.clone()), ("design", order.hash()), ("sheet", sheet.to_string())];
    entries.extend(motion_told(&toolpath.motion).map(|told| ("sheet lies", told)));
    entries.extend(set.map(|set| ("set", set.to_owned())));
    entries.extend([("machine", setup.machine.name.clone()), ("material", setup.profile.name.clone())]);
    if setup.is_second(tool) {
        let turn = "before the program of the same name in sheets/, from the same zero";
        entries.extend([("tool", "pen".to_owned()), ("turn", turn.to_owned())]);
    } else {
        let length = format!("{:.0} mm", toolpath.cut_mm());
        entries.extend([("kerf", format!("{} mm", cut.kerf_mm)), ("cut at", setup.cut_told()), ("cut length", length)]);
    }
    entries.extend([
        (
            "bounds",
            format!("X{:.3} Y{:.3} to X{:.3} Y{:.3} mm", bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y),
        ),
        ("planned time", minutes(time_s)),
    ]);
    if let [a, b] = toolpath.crosses[..] {
        entries.push(("crosses", format!("X{:.3} Y{:.3} and X{:.3} Y{:.3} mm", a.x, a.y, b.x, b.y)));
    }
    if setup.profile.grain == Grain::Directional {
        entries.push(("grain", if setup.turned() { "along Y" } else { "along X" }.to_owned()));
    }
    if !cut.calibrated && !setup.is_second(tool) {
        entries.push(("UNCALIBRATED", format!("values {}; cut a test piece first", cut.source)));
    }
    Header { entries: entries.into_iter().map(|(k, v)| (k.to_owned(), v)).collect() }
}

/// "3 min 20 s".
pub fn minutes(time_s: f64) -> String {
    let seconds = time_s.round() as u64;
    if seconds < 60 { format!("{seconds} s") } else { format!("{} min {:02} s", seconds / 60, seconds % 60) }
}
