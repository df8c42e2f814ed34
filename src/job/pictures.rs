//! Pictures of parts and sheets.

use super::dry_run;
use super::settings::Setup;
use super::sheets::{CutSheet, minutes};
use crate::drawing::Operation;
use crate::fit::{FootUsed, Part};
use crate::gcode::Move;
use crate::preview::{
    Canvas, MoveKind, PartView, Pen, Run, SheetMove, SheetView, flattened, part_canvas, sheet_canvas,
};
use crate::toolpath::Toolpath;

/// Longer side of a part's PNG, pixels.
pub(super) const PART_PX: u32 = 1200;
/// Longer side of a sheet's PNG, pixels: a 0.15 mm kerf on A3 still shows.
pub(super) const SHEET_PX: u32 = 2400;

/// The folded ruffle in its outline.
pub(super) fn part(part: &Part) -> Canvas {
    let x = &part.equilibrium.positions;
    let joints = part.ruffle.connection_points();
    let report = &part.report;
    let foot = match report.foot {
        FootUsed::Free => "stands free",
        FootUsed::Pinned => "foot glued",
        FootUsed::Tied => "tied to what it rests on",
    };
    part_canvas(&PartView {
        name: &part.name,
        outline: &part.outline,
        ruffle: &part.ruffle,
        positions: x,
        joints: joints.iter().map(|c| (x[c.node.index()], c.joint.to_string())).collect(),
        caption: vec![
            format!(
                "{:.0} % filled, {:.1} % sticks out, {foot}",
                100.0 * (1.0 - report.uncovered_fraction),
                100.0 * report.protruding_fraction
            ),
            format!(
                "strip {:.0} mm, {:.1} g, {} joints, tightest bend {:.1} mm",
                report.strip_length_mm,
                report.strip_mass_g,
                joints.len(),
                report.min_radius_mm
            ),
        ],
    })
}

/// What the machine will do on a sheet, drawn from the program's own moves.
pub(super) fn sheet(sheet: &CutSheet, run: &Run, setup: &Setup) -> Canvas {
    let moves: Vec<SheetMove> = kinds(&sheet.moves, &sheet.toolpath)
        .map(|(m, kind)| SheetMove { points: flattened(m), pen: kind as usize })
        .collect();
    let pens: Vec<Pen> = MoveKind::ALL.map(MoveKind::pen).into();
    let bed = dry_run::bed(&setup.machine);
    let cut = &setup.pairing.cut;
    let title = format!("{} ({}, {})", sheet.file, sheet.stock, setup.profile.name);
    sheet_canvas(&SheetView {
        title: &title,
        stock: run.stock.as_ref(),
        reach: Some(bed.reach),
        keep_outs: &bed.keep_outs,
        pens: &pens,
        moves: &moves,
        piece_names: run.labels.clone(),
        legend: vec![
            format!("planned time {}", minutes(sheet.time_s)),
            format!(
                "{}: {:.0} mm/min, {:.1} %, kerf {} mm{}",
                setup.machine.name,
                cut.feed_mm_per_min,
                100.0 * cut.power,
                cut.kerf_mm,
                if cut.calibrated { "" } else { ", UNCALIBRATED" }
            ),
        ],
    })
}

/// Tells engraving, inner cuts and outlines apart: the program makes them in this order, so the length burnt so far says which it is.
fn kinds<'a>(moves: &'a [Move], toolpath: &Toolpath) -> impl Iterator<Item = (&'a Move, MoveKind)> {
    let engraved = toolpath.length_mm(Operation::Engrave);
    let inner = engraved + toolpath.length_mm(Operation::CutInner);
    let mut burnt = 0.0;
    moves.iter().filter(|m| m.length_mm() > 0.0).map(move |m| {
        if !m.burns() {
            return (m, MoveKind::Travel);
        }
        let middle = burnt + 0.5 * m.length_mm();
        burnt += m.length_mm();
        let kind = if middle < engraved {
            MoveKind::Engrave
        } else if middle < inner {
            MoveKind::CutInner
        } else {
            MoveKind::CutOutline
        };
        (m, kind)
    })
}
