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
    let laser = setup.machine.tool.class.is_laser();
    let moves: Vec<SheetMove> = kinds(&sheet.moves, &sheet.toolpath, laser)
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
                "{}: {}{}",
                setup.machine.name,
                setup.cut_told(),
                if cut.calibrated { "" } else { ", UNCALIBRATED" }
            ),
        ],
    })
}

/// Tells engraving, inner cuts and outlines apart: the program makes the runs of the tool path one after the other, so the length made so far says
/// which it is.
fn kinds<'a>(moves: &'a [Move], toolpath: &Toolpath, laser: bool) -> impl Iterator<Item = (&'a Move, MoveKind)> {
    let mut ends: Vec<(f64, MoveKind)> = Vec::new();
    let mut total = 0.0;
    for contour in &toolpath.contours {
        total += contour.path.length();
        let kind = match contour.operation {
            Operation::Engrave => MoveKind::Engrave,
            Operation::CutInner => MoveKind::CutInner,
            Operation::CutOutline => MoveKind::CutOutline,
        };
        match ends.last_mut() {
            Some(last) if last.1 == kind => last.0 = total,
            _ => ends.push((total, kind)),
        }
    }
    let (mut made, mut at) = (0.0, 0);
    moves.iter().filter(|m| m.length_mm() > 0.0).map(move |m| {
        if !m.works(laser) {
            return (m, MoveKind::Travel);
        }
        let middle = made + 0.5 * m.length_mm();
        made += m.length_mm();
        while at + 1 < ends.len() && middle > ends[at].0 {
            at += 1;
        }
        (m, ends.get(at).map_or(MoveKind::CutOutline, |end| end.1))
    })
}
