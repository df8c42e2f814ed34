//! The job as the person at the table reads it.

use super::settings::Setup;
use super::sheets::{Sheets, minutes};
use super::strips::Strips;
use super::{Order, Realised};
use crate::assembly::{self, Book, Card, CutSheet, Handling, Marks, Paper, book, patterns};
use crate::config::{Grain, LabelKind, Process, StockGrain};
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
        facts.push(("Cut", process(&pairing.cut)));
        facts.push(("Kerf", format!("{} mm, already in the programs", pairing.cut.kerf_mm)));
        let marks = match (setup.label_kind(), &pairing.engrave) {
            (LabelKind::Engrave, Some(settings)) => process(settings),
            (LabelKind::Pen, _) => "with a pen: black in sheets/*.svg and *.dxf, layer \"engrave\"".to_owned(),
            (LabelKind::Perforate, _) => "numbers are cut in dashes".to_owned(),
            (LabelKind::Notch, _) => "notches in the edges are cut with the outlines".to_owned(),
            (LabelKind::Engrave | LabelKind::Map, _) => "nothing".to_owned(),
        };
        facts.push(("Labels", marks));
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

fn process(process: &Process) -> String {
    let passes = if process.passes == 1 { "1 pass".to_owned() } else { format!("{} passes", process.passes) };
    format!(
        "{:.0} mm/min ({:.0} mm/s), power {:.0} %, {passes}, air {}",
        process.feed_mm_per_min,
        process.feed_mm_per_min / 60.0,
        100.0 * process.power,
        process.air.word()
    )
}
