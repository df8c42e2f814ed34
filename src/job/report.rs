//! report.json: what the job amounts to, for scripts and for the table on the screen.

use super::Realised;
use super::settings::Setup;
use super::sheets::Sheets;
use super::strips::Strips;
use crate::fit::FootUsed;
use crate::progress::Warning;
use crate::sim::Outcome;
use serde::Serialize;

/// report.json.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Version of this format.
    pub schema: u32,
    /// Version of the program.
    pub version: &'static str,
    /// Name of the machine.
    pub machine: String,
    /// Name of the material.
    pub material: String,
    /// What was filled.
    pub parts: Vec<PartReport>,
    /// What is cut.
    pub pieces: Vec<PieceReport>,
    /// From what, and how long it takes.
    pub sheets: Vec<SheetReport>,
    /// Strips that tie parts together.
    pub connectors: Vec<ConnectorReport>,
    /// Sums and worst cases.
    pub totals: Totals,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// The only part of all files that differs from run to run.
    pub timing: Timing,
}

/// One part.
#[derive(Debug, Clone, Serialize)]
pub struct PartReport {
    /// Name.
    pub name: String,
    /// Outline area not enclosed over outline area.
    pub uncovered_fraction: f64,
    /// Enclosed area outside the outline over outline area.
    pub protruding_fraction: f64,
    /// Pairs of segments that pass through each other.
    pub self_intersections: usize,
    /// Strip without end tabs, mm.
    pub strip_length_mm: f64,
    /// Its mass, g.
    pub strip_mass_g: f64,
    /// Sections.
    pub sections: usize,
    /// Connection points.
    pub connection_points: usize,
    /// Nodes.
    pub nodes: usize,
    /// Tightest bend, mm.
    pub min_radius_mm: f64,
    /// Thinnest void, mm.
    pub min_void_mm: f64,
    /// How it stands.
    pub foot: FootUsed,
    /// How the solve ended.
    pub outcome: Outcome,
}

/// One piece.
#[derive(Debug, Clone, Serialize)]
pub struct PieceReport {
    /// Name.
    pub name: String,
    /// Part it belongs to.
    pub part: String,
    /// Number of its sheet, from 1.
    pub sheet: usize,
    /// Length, mm.
    pub length_mm: f64,
    /// Width, mm.
    pub width_mm: f64,
    /// Mass, g.
    pub mass_g: f64,
}

/// One sheet.
#[derive(Debug, Clone, Serialize)]
pub struct SheetReport {
    /// The program, or the drawing where it is cut by hand; relative to the output folder.
    pub file: String,
    /// What it is cut from.
    pub stock: String,
    /// Extent along x, mm.
    pub width_mm: f64,
    /// Extent along y, mm.
    pub length_mm: f64,
    /// Area of the pieces over area of the sheet.
    pub density: f64,
    /// Number of pieces.
    pub pieces: usize,
    /// Cut length, mm.
    pub cut_mm: f64,
    /// Engraved length, mm.
    pub engrave_mm: f64,
    /// Way between cuts, mm.
    pub travel_mm: f64,
    /// The same in drawing order, mm.
    pub travel_unordered_mm: f64,
    /// Planned time, s.
    pub time_s: f64,
    /// Lines of the program.
    pub lines: usize,
}

/// One connector strip.
#[derive(Debug, Clone, Serialize)]
pub struct ConnectorReport {
    /// Joint at one end: "A7".
    pub from: String,
    /// Joint at the other.
    pub to: String,
    /// The piece.
    pub piece: String,
}

/// Sums and worst cases.
#[derive(Debug, Clone, Serialize)]
pub struct Totals {
    /// Cut length, mm.
    pub cut_mm: f64,
    /// Planned time, s.
    pub time_s: f64,
    /// Mass of all pieces, g.
    pub mass_g: f64,
    /// Number of sheets.
    pub sheets: usize,
    /// Largest distance between a flap's root and its slit in space, mm.
    pub max_mating_error_mm: f64,
    /// How far a neck can shift in its slit, across the strip, at worst, mm.
    pub joint_play_mm: f64,
    /// How far two sheets that a joint holds can move apart, at worst, mm.
    pub joint_slack_mm: f64,
    /// How much sheet holds each barb of a flap, at worst, mm.
    pub joint_retention_mm: f64,
    /// Labels over cuts or other labels.
    pub label_collisions: usize,
    /// Largest distance of a tool path from where the kerf wants it, mm.
    pub max_kerf_deviation_mm: f64,
}

/// Measured times.
#[derive(Debug, Clone, Serialize)]
pub struct Timing {
    /// Last solve of every part, ms.
    pub solve_ms: f64,
    /// Filling, ms.
    pub fit_ms: f64,
    /// Laying flat, nesting and programs, ms.
    pub nest_ms: f64,
    /// Everything, s.
    pub wall_s: f64,
}

impl Report {
    /// The file's text.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a report holds nothing JSON cannot");
        text.push('\n');
        text
    }
}

/// Gathers the report.
pub(super) fn report(
    setup: &Setup,
    realised: &Realised,
    strips: &Strips,
    sheets: &Sheets,
    warnings: Vec<Warning>,
    timing: Timing,
) -> Report {
    let parts = realised.parts.iter().map(|part| PartReport {
        name: part.name.clone(),
        uncovered_fraction: rounded(part.report.uncovered_fraction),
        protruding_fraction: rounded(part.report.protruding_fraction),
        self_intersections: part.equilibrium.self_intersections,
        strip_length_mm: rounded(part.report.strip_length_mm),
        strip_mass_g: rounded(part.report.strip_mass_g),
        sections: part.ruffle.sections.len(),
        connection_points: part.ruffle.connection_points().len(),
        nodes: part.ruffle.node_count,
        min_radius_mm: rounded(part.report.min_radius_mm),
        min_void_mm: rounded(part.report.min_void_mm),
        foot: part.report.foot,
        outcome: part.equilibrium.outcome,
    });
    let sheet_of = |piece: usize| {
        let holds = |s: &super::sheets::CutSheet| s.layout.placements.iter().any(|p| p.item == piece);
        sheets.sheets.iter().position(holds).map_or(0, |i| i + 1)
    };
    let pieces = strips.pieces.iter().enumerate().map(|(i, piece)| PieceReport {
        name: piece.name.clone(),
        part: piece.part.clone(),
        sheet: sheet_of(i),
        length_mm: rounded(piece.length_mm),
        width_mm: rounded(piece.width_mm),
        mass_g: rounded(piece.mass_g),
    });
    let connectors = strips.connectors.iter().map(|c| ConnectorReport {
        from: c.from.clone(),
        to: c.to.clone(),
        piece: c.piece.name.clone(),
    });
    let cut_sheets = sheets.sheets.iter().map(|sheet| SheetReport {
        file: format!("sheets/{}.{}", sheet.file, sheet.ending),
        stock: sheet.stock.clone(),
        width_mm: rounded(sheet.layout.width_mm),
        length_mm: rounded(sheet.layout.height_mm),
        density: rounded(sheet.layout.density),
        pieces: sheet.layout.placements.len(),
        cut_mm: rounded(sheet.toolpath.cut_mm()),
        engrave_mm: rounded(sheet.toolpath.engrave_mm()),
        travel_mm: rounded(sheet.toolpath.travel_mm),
        travel_unordered_mm: rounded(sheet.toolpath.travel_unordered_mm),
        time_s: rounded(sheet.time_s),
        lines: sheet.text.lines().count(),
    });
    let sum = |of: fn(&super::sheets::CutSheet) -> f64| rounded(sheets.sheets.iter().map(of).sum());
    let hold = setup.joint().hold(setup.pairing.cut.kerf_mm);
    let totals = Totals {
        cut_mm: sum(|s| s.toolpath.cut_mm()),
        time_s: sum(|s| s.time_s),
        mass_g: rounded(strips.pieces.iter().map(|p| p.mass_g).sum()),
        sheets: sheets.sheets.len(),
        max_mating_error_mm: rounded(strips.max_mating_error_mm),
        joint_play_mm: rounded(hold.play_mm),
        joint_slack_mm: rounded(hold.most_slack_mm),
        joint_retention_mm: rounded(hold.retention_mm),
        label_collisions: strips.label_collisions,
        max_kerf_deviation_mm: rounded(
            sheets.sheets.iter().map(|s| s.toolpath.max_kerf_deviation_mm).fold(0.0, f64::max),
        ),
    };
    Report {
        schema: 1,
        version: env!("CARGO_PKG_VERSION"),
        machine: setup.machine.name.clone(),
        material: setup.profile.name.clone(),
        parts: parts.collect(),
        pieces: pieces.collect(),
        sheets: cut_sheets.collect(),
        connectors: connectors.collect(),
        totals,
        warnings,
        timing,
    }
}

/// Six decimals: a nanometre, a millionth of a point; more digits are noise in a file people compare.
pub(super) fn rounded(value: f64) -> f64 {
    let r = (value * 1e6).round() / 1e6;
    // No minus zero.
    if r == 0.0 { 0.0 } else { r }
}
