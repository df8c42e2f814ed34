//! Pieces on sheets, and the program that cuts each sheet.

use super::settings::Setup;
use super::stock;
use super::strips::Strips;
use super::{Error, Order, SheetLabel, offcuts};
use crate::config::Grain;
use crate::drawing::{Drawing, Operation};
use crate::gcode::{self, Header, Move, Program};
use crate::geom::{Rect, tolerance};
use crate::nest::{self, Item, Layout};
use crate::progress::{Observer, Warning};
use crate::strip::Piece;
use crate::toolpath::{self, Toolpath};

/// One sheet, ready to cut.
#[derive(Debug, Clone)]
pub(super) struct CutSheet {
    /// "sheet-01".
    pub file: String,
    /// What it is cut from: "A4".
    pub stock: String,
    /// Where the pieces lie.
    pub layout: Layout,
    /// The pieces, sheet frame, nominal.
    pub drawings: Vec<Drawing>,
    /// What the tool follows.
    pub toolpath: Toolpath,
    /// What the machine reads; empty for a job that is cut by hand.
    pub program: Program,
    /// What that makes it do.
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

/// Nests the pieces and writes a program for every sheet.
pub(super) fn sheets(
    strips: &Strips,
    setup: &Setup,
    order: &Order,
    observer: &mut dyn Observer,
) -> Result<Sheets, Error> {
    let items = items(strips, setup);
    let containers: Vec<_> = strips.stock.iter().map(|sheet| stock::container(sheet, setup)).collect();
    let mut layouts = nest::nest(&items, &containers, &setup.nest(), observer)?;
    if !layouts.unplaced.is_empty() {
        return Err(nest::Error::Unplaced(std::mem::take(&mut layouts.unplaced)).into());
    }
    let count = layouts.layouts.len();
    let used: Vec<_> = layouts.layouts.iter().map(|l| &strips.stock[l.container]).collect();
    let cut_from: Vec<_> = strips.stock.iter().filter(|sheet| used.contains(sheet)).collect();
    let warnings = stock::warnings(&cut_from, setup);
    let sheets = layouts
        .layouts
        .into_iter()
        .enumerate()
        .map(|(i, layout)| {
            let offcut = offcuts::offcut(&items, &containers, &layout, &setup.nest());
            let drawings: Vec<Drawing> =
                layout.placements.iter().map(|p| strips.pieces[p.item].drawing.moved(&p.motion())).collect();
            let file = format!("sheet-{:02}", i + 1);
            let sheet = program(file, (i + 1, count), &used[i].name, layout, drawings, setup, order)?;
            Ok(CutSheet { offcut, ..sheet })
        })
        .collect::<Result<Vec<CutSheet>, Error>>()?;
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

fn program(
    file: String,
    (number, count): (usize, usize),
    stock: &str,
    layout: Layout,
    drawings: Vec<Drawing>,
    setup: &Setup,
    order: &Order,
) -> Result<CutSheet, Error> {
    let sheet = || file.clone();
    let settings = setup.toolpath();
    let made_here: Vec<Drawing> = match settings.engrave {
        Some(_) => drawings.clone(),
        None => drawings.iter().map(|d| d.without(Operation::Engrave)).collect(),
    };
    let toolpath = toolpath::plan(&made_here, layout.width_mm, layout.height_mm, &settings)
        .map_err(|source| Error::Toolpath { sheet: sheet(), source })?;
    if setup.by_hand() {
        let time_s = 60.0 * toolpath.cut_mm() / setup.pairing.cut.feed_mm_per_min;
        let (program, moves) = (Program::default(), Vec::new());
        return Ok(CutSheet {
            stock: stock.to_owned(),
            file,
            layout,
            drawings,
            toolpath,
            program,
            moves,
            time_s,
            offcut: None,
        });
    }
    let write = |header: &Header| {
        gcode::emit(&toolpath, header, &setup.dialect()).map_err(|source| Error::Gcode { sheet: sheet(), source })
    };
    let read = |program: &Program| gcode::trace(program).map_err(|source| Error::Trace { sheet: sheet(), source });
    // The header tells the planned time, which is known once the moves are.
    let time_s = gcode::estimate(&read(&write(&Header::default())?)?, &setup.limits()).total_s;
    let header = header(number, count, stock, &toolpath, time_s, setup, order);
    let program = write(&header)?;
    let moves = read(&program)?;
    if let Some(finding) = gcode::check(&program, &setup.check()).errors.into_iter().next() {
        return Err(Error::Check { sheet: sheet(), finding });
    }
    Ok(CutSheet { stock: stock.to_owned(), file, layout, drawings, toolpath, program, moves, time_s, offcut: None })
}

fn header(
    number: usize,
    count: usize,
    stock: &str,
    toolpath: &Toolpath,
    time_s: f64,
    setup: &Setup,
    order: &Order,
) -> Header {
    let bounds = toolpath.bounds();
    let cut = &setup.pairing.cut;
    let (width_mm, height_mm) = (toolpath.width_mm, toolpath.height_mm);
    let sheet = SheetLabel { number, of: count, stock: stock.to_owned(), width_mm, height_mm };
    let mut entries = vec![
        ("job", order.name.clone()),
        ("design", order.hash()),
        ("sheet", sheet.to_string()),
        ("machine", setup.machine.name.clone()),
        ("material", setup.profile.name.clone()),
        ("kerf", format!("{} mm", cut.kerf_mm)),
        ("cut at", format!("{:.0} mm/min, {:.1} %", cut.feed_mm_per_min, 100.0 * cut.power)),
        (
            "bounds",
            format!("X{:.3} Y{:.3} to X{:.3} Y{:.3} mm", bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y),
        ),
        ("cut length", format!("{:.0} mm", toolpath.cut_mm())),
        ("planned time", minutes(time_s)),
    ];
    if setup.profile.grain == Grain::Directional {
        entries.push(("grain", "along X".to_owned()));
    }
    if !cut.calibrated {
        entries.push(("UNCALIBRATED", format!("values {}; cut a test piece first", cut.source)));
    }
    Header { entries: entries.into_iter().map(|(k, v)| (k.to_owned(), v)).collect() }
}

/// "3 min 20 s".
pub fn minutes(time_s: f64) -> String {
    let seconds = time_s.round() as u64;
    if seconds < 60 { format!("{seconds} s") } else { format!("{} min {:02} s", seconds / 60, seconds % 60) }
}
