//! Pieces on sheets, and the program that cuts each sheet.

use super::program::{self, Written};
use super::settings::Setup;
use super::stock;
use super::strips::Strips;
use super::{Error, Order, SheetLabel, offcuts};
use crate::drawing::{Drawing, DrawnPath, KerfSide, Role, text_paths};
use crate::gcode::{Header, Move};
use crate::geom::{Motion, Rect, V2, tolerance};
use crate::nest::{self, Container, Item, Layout};
use crate::progress::{Observer, Warning};
use crate::strip::Piece;
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
    /// The largest rectangle that is left, where it is worth keeping; sheet frame.
    pub offcut: Option<Rect>,
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
    let items = items(strips, setup);
    let sets = order.batch.copies.max(order.batch.names.len()).max(1);
    let container =
        |sheet| stock::beside_clamps(shared(stock::container(sheet, setup), sets), setup, &order.batch.start);
    let containers: Vec<_> = strips.stock.iter().map(container).collect();
    let mut layouts = nest::nest(&items, &containers, &setup.nest(), observer)?;
    if !layouts.unplaced.is_empty() {
        return Err(nest::Error::Unplaced(std::mem::take(&mut layouts.unplaced)).into());
    }
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
            let offcut = offcuts::offcut(&items, &containers, layout, &setup.nest());
            sheets.push(CutSheet { offcut, ..cut_sheet(place, layout.clone(), drawings, setup, order)? });
        }
    }
    for warning in sheets.iter().flat_map(|sheet| &sheet.toolpath.warnings) {
        if !warnings.contains(warning) {
            warnings.push(warning.clone());
        }
    }
    Ok(Sheets { sheets, warnings })
}

/// The outlines of all pieces; those of one part are kept together.
fn items(strips: &Strips, setup: &Setup) -> Vec<Item> {
    let mut parts: Vec<&str> = strips.pieces.iter().map(|piece| piece.part.as_str()).collect();
    parts.sort_unstable();
    parts.dedup();
    let item = |piece: &Piece| {
        let polygon = piece.drawing.outline().map_or_else(Vec::new, |path| path.flatten(tolerance::FLATTEN_MM));
        let set = parts.binary_search(&piece.part.as_str()).ok().map(|part| part as u32);
        Item { set, ..Item::new(piece.name.clone(), polygon, setup.angles_deg()) }
    };
    strips.pieces.iter().map(item).collect()
}

/// What one set may take of a stock that is shared by all.
fn shared(container: Container, sets: usize) -> Container {
    match container {
        Container::Sheet { name, width_mm, height_mm, count: Some(count), .. } => {
            Container::sheet(name, width_mm, height_mm, Some(count / sets as u32))
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

fn cut_sheet(
    place: Place,
    layout: Layout,
    drawings: Vec<Drawing>,
    setup: &Setup,
    order: &Order,
) -> Result<CutSheet, Error> {
    let file = format!("sheet-{:02}", place.number);
    let start = &order.batch.start;
    let header = |toolpath: &Toolpath, tool, time_s: f64| header(place, toolpath, tool, time_s, setup, order);
    let size_mm = [layout.width_mm, layout.height_mm];
    let written = |drawings: &[Drawing], settings: &toolpath::Settings| {
        program::written(&file, drawings, size_mm, settings, &header, setup, start)
    };
    let settings = setup.toolpath(start);
    if setup.by_hand() {
        let toolpath = program::planned(&file, &drawings, size_mm, &settings)?;
        let time_s = 60.0 * toolpath.cut_mm() / setup.pairing.cut.feed_mm_per_min;
        let (stock, text, pen, moves) = (place.stock.to_owned(), String::new(), None, Vec::new());
        return Ok(CutSheet {
            stock,
            file,
            ending: "svg",
            layout,
            drawings,
            toolpath,
            text,
            pen,
            moves,
            time_s,
            offcut: None,
        });
    }
    let (pen, program) = match setup.drawing(start) {
        Some(drawing) => (Some(written(&drawings, &drawing)?.text), written(&drawings, &settings)?),
        None => (None, written(&drawings, &settings)?),
    };
    let Written { toolpath, text, moves, time_s } = program;
    let ending = if setup.plots() { "plt" } else { "nc" };
    Ok(CutSheet {
        stock: place.stock.to_owned(),
        file,
        ending,
        layout,
        drawings,
        toolpath,
        text,
        pen,
        moves,
        time_s,
        offcut: None,
    })
}

fn header(
    place: Place,
    toolpath: &Toolpath,
    tool: toolpath::Tool,
    time_s: f64,
    setup: &Setup,
    order: &Order,
) -> Header {
    let Place { number, count, stock, set } = place;
    let (width_mm, height_mm) = (toolpath.width_mm, toolpath.height_mm);
    let sheet = SheetLabel { number, of: count, stock: stock.to_owned(), width_mm, height_mm };
    let mut entries = vec![("job", order.name.clone()), ("design", order.hash()), ("sheet", sheet.to_string())];
    entries.extend(set.map(|set| ("set", set.to_owned())));
    program::header(entries, toolpath, tool, time_s, setup)
}

/// "3 min 20 s".
pub fn minutes(time_s: f64) -> String {
    let seconds = time_s.round() as u64;
    if seconds < 60 { format!("{seconds} s") } else { format!("{} min {:02} s", seconds / 60, seconds % 60) }
}
