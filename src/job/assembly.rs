//! The job as the person at the table reads it.

use super::settings::Setup;
use super::sheets::{Sheets, minutes};
use super::strips::Strips;
use super::{Order, Realised};
use crate::assembly::{self, Book, Card, CutSheet, Handling, Marks, Paper, book, patterns};
use crate::config::{Grain, LabelKind, Process, StockGrain, ToolClass};
use crate::design::{self, StripAlong};

/// The assembly sheets.
pub(super) const FILE: &str = "assembly.pdf";

/// The patterns at true size of a job that is cut by hand.
pub(super) const PATTERNS: &str = "print.pdf";

/// Time a person needs for one flap of paper, and of anything that does not crease, s: from practice.
const PAPER_FLAP_S: f64 = 30.0;
const SOFT_FLAP_S: f64 = 45.0;
/// Strips are curled round a rod at least this thick beforehand, mm: a pencil.
const LEAST_ROD_MM: f64 = 10.0;

/// Files of a job that are printed, with their names.
pub(super) fn files(
    order: &Order,
    setup: &Setup,
    realised: &Realised,
    strips: &Strips,
    sheets: &Sheets,
) -> Vec<(&'static str, Vec<u8>)> {
    let times: Vec<String> = sheets.sheets.iter().map(|sheet| minutes(sheet.time_s)).collect();
    let cut_sheets: Vec<CutSheet> = sheets
        .sheets
        .iter()
        .zip(&times)
        .map(|(sheet, time)| CutSheet {
            file: &sheet.file,
            stock: &sheet.stock,
            layout: &sheet.layout,
            drawings: &sheet.drawings,
            time,
        })
        .collect();
    let known = sheets.sheets.iter().all(|s| strips.stock[s.layout.container].grain != StockGrain::Unknown);
    let directional = setup.profile.grain == Grain::Directional;
    let (hash, card) = (order.hash(), card(setup, sheets));
    let job = Book {
        name: &order.name,
        hash: &hash,
        paper: match order.design.paper {
            design::Paper::A4 => Paper::A4,
            design::Paper::Letter => Paper::Letter,
        },
        mesh: realised.mesh.as_ref(),
        parts: &realised.parts,
        pieces: &strips.pieces,
        splices: &strips.splices,
        sheets: &cut_sheets,
        card: &card,
        handling: Handling {
            flap_s: if directional { PAPER_FLAP_S } else { SOFT_FLAP_S },
            rod_mm: (2.0 * setup.profile.min_bend_radius_mm).max(LEAST_ROD_MM),
            grain: directional.then_some(assembly::Grain { along: setup.strip_along == StripAlong::Grain, known }),
            marks: match setup.label_kind() {
                LabelKind::Engrave | LabelKind::Pen | LabelKind::Perforate => Marks::Letters,
                LabelKind::Notch => Marks::Notches,
                LabelKind::Map => Marks::Nothing,
            },
        },
    };
    let mut files = vec![(FILE, book(&job))];
    if setup.by_hand() {
        files.push((PATTERNS, patterns(&job)));
    }
    files
}

/// What the person at the machine reads.
fn card(setup: &Setup, sheets: &Sheets) -> Card {
    let (machine, profile, pairing) = (&setup.machine, &setup.profile, &setup.pairing);
    let mut facts = vec![("Machine", machine.title.clone()), ("Material", profile.title.clone())];
    if !setup.by_hand() {
        facts.extend(at_the_machine(setup));
        let total_s: f64 = sheets.sheets.iter().map(|sheet| sheet.time_s).sum();
        facts.push(("Time", format!("{} in all", minutes(total_s))));
    }
    // What a material needs is said for machines: how it burns, how it smokes.
    let of_material = profile.setup.iter().filter(|_| !setup.by_hand());
    Card {
        facts: facts.into_iter().map(|(what, value)| (what.to_owned(), value)).collect(),
        setup: machine.setup.iter().chain(of_material).cloned().collect(),
        uncalibrated: (!pairing.cut.calibrated).then(|| {
            format!(
                "values {}. Cut a small test piece with one joint first, and see that it holds.",
                pairing.cut.source
            )
        }),
        by_hand: setup.by_hand(),
    }
}

/// How it is cut and marked.
fn at_the_machine(setup: &Setup) -> Vec<(&'static str, String)> {
    let cut = &setup.pairing.cut;
    let told = |process: &Process| told(process, setup.machine.tool.class);
    if setup.machine.tool.class == ToolClass::Pen {
        return vec![("Lines", told(cut))];
    }
    let mut facts = vec![("Cut", told(cut))];
    if cut.kerf_mm > 0.0 {
        facts.push(("Kerf", format!("{} mm, already in the programs", cut.kerf_mm)));
    }
    let labels = match (setup.marking(), setup.pen(), setup.label_kind()) {
        (Some(marks), ..) => told(marks),
        (None, Some(_), _) => "drawn first by a pen in the tool's place: the programs in pen/, same zero".into(),
        (None, None, LabelKind::Pen) => "with a pen: black in sheets/*.svg and *.dxf, layer \"engrave\"".into(),
        (None, None, LabelKind::Perforate) => "numbers are cut in dashes".into(),
        (None, None, LabelKind::Notch) => "notches in the edges are cut with the outlines".into(),
        (None, None, LabelKind::Engrave | LabelKind::Map) => "nothing".into(),
    };
    facts.push(("Labels", labels));
    facts
}

fn told(process: &Process, tool: ToolClass) -> String {
    let passes = match process.pass_power.len() {
        1 => "1 pass".to_owned(),
        n => format!("{n} passes"),
    };
    let feed = process.feed_mm_per_min;
    let speed = format!("{feed:.0} mm/min ({:.0} mm/s)", feed / 60.0);
    match (tool.is_laser(), process.blade) {
        (true, _) => format!("{speed}, power {:.0} %, {passes}, air {}", 100.0 * process.power, process.air.word()),
        (false, Some(blade)) => {
            format!("{speed}, blade {:.0} deg, {:.0} gf, {passes}", blade.angle_deg, blade.force_gf)
        }
        (false, None) => format!("{speed}, {passes}"),
    }
}
