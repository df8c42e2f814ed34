//! What is done to the cut pieces before any joint is closed, with a box to tick for each.

use super::flow::{BODY, Flow};
use super::joints::{Held, Joint};
use super::order::{FINGERS_MM, order};
use super::page::Pen;
use super::{Book, Marks, base_cards, beside, closing, connectors, count};
use crate::geom::{P2, V2};
use crate::strip::{Face as Side, Piece, Splice, SpliceKind};

const TITLE: &str = "Before folding";

/// Writes the page.
pub(super) fn prepare(flow: &mut Flow, job: &Book, joints: &[Joint]) {
    flow.page(TITLE);
    flow.heading("Tools", 10.0, TITLE);
    for tool in tools(job, joints) {
        flow.check(&tool, TITLE);
    }
    flow.heading("Prepare the pieces", 20.0, TITLE);
    told_apart(flow, job.handling.marks);
    if joints.iter().any(|joint| joint.held == Held::Flaps) {
        flow.check("Push every flap out of the sheet and back again, gently; free what still hangs on.", TITLE);
    }
    let curl = format!(
        "Curl every piece over its whole length, both ways: pull it over the edge of the table, or wind it round a rod of {:.0} mm. Loops then fall into place by themselves.",
        job.handling.rod_mm
    );
    flow.check(&curl, TITLE);
    if !job.splices.is_empty() {
        flow.heading("Join the pieces of each strip", 20.0, TITLE);
        for splice in job.splices {
            flow.check(&splice_text(splice, joints, job), TITLE);
        }
    }
    closing::pictures(flow, joints, TITLE);
    let connectors = connectors(job);
    if !connectors.is_empty() {
        tied(flow, &connectors);
    }
}

/// The pieces laid out, and how they are told apart.
fn told_apart(flow: &mut Flow, marks: Marks) {
    match marks {
        Marks::Letters => {
            flow.check(
                "Lay out the pieces, lettered side up, as on the pages called \"flat\", and compare the numbers. Pieces and joints have numbers of their own: joint A1 need not lie on piece A1.",
                TITLE,
            );
        }
        Marks::Notches | Marks::Nothing => {
            flow.check(
                "Lay out the pieces as on the pages called \"flat\", and draw a cross on the side of each that is up: it is called the marked side.",
                TITLE,
            );
        }
    }
    match marks {
        Marks::Letters => {}
        Marks::Nothing => flow.check(
            "Nothing is written on them: write the numbers beside flaps and slits, in pencil or on bits of tape, as those pages show.",
            TITLE,
        ),
        Marks::Notches => {
            flow.check(
                "Nothing is written on them: notches in the edges tell the joints. Add them up: a deep notch counts five, a shallow one one. These two joints are 3 and 7:",
                TITLE,
            );
            sample_notches(flow);
            flow.check(
                "Notches in the lower edge: the flap folds toward the marked side, and a slit is entered from there. In the upper edge: from the other side.",
                TITLE,
            );
        }
    }
}

/// The edge of a piece with the notches of joints 3 and 7, as large as they are.
fn sample_notches(flow: &mut Flow) {
    const HEIGHT_MM: f64 = 9.0;
    let space = flow.take(HEIGHT_MM, TITLE);
    let (left, top) = (space.min.x + 6.5, space.max.y - 2.0);
    let mut points = vec![P2::new(left, top)];
    let mut group = |from: f64, depths: &[f64]| {
        for (i, depth) in depths.iter().enumerate() {
            let at = P2::new(left + from + 4.0 * i as f64, top);
            points.extend([at - V2::new(1.25, 0.0), at - V2::new(0.0, *depth), at + V2::new(1.25, 0.0)]);
        }
    };
    group(12.0, &[2.0; 3]);
    group(48.0, &[4.0, 2.0, 2.0]);
    points.push(P2::new(left + 80.0, top));
    flow.paper().line(&points, Pen::black(0.35));
}

fn tools(job: &Book, joints: &[Joint]) -> Vec<String> {
    let mut tools: Vec<String> = Vec::new();
    let mut tool = |text: &str| tools.push(text.to_owned());
    if job.card.by_hand {
        tool("Scissors, and a sharp knife with a ruler and a cutting mat for flaps and slits");
    }
    match job.handling.marks {
        Marks::Letters => {}
        Marks::Notches | Marks::Nothing => tool("A pencil"),
    }
    let narrowest = job.parts.iter().flat_map(order).map(|step| step.room_mm).fold(f64::INFINITY, f64::min);
    if narrowest < FINGERS_MM {
        tool("Blunt tweezers");
    }
    tool("Bone folder, or the back of a spoon, to press joints flat");
    tool(&format!("A round rod of {:.0} mm, or the edge of the table, to curl strips", job.handling.rod_mm));
    let clipped = job.splices.iter().filter(|splice| splice.kind == SpliceKind::Connection).count();
    if clipped > 0 {
        tool(&format!("{}, to hold overlaps until their joints are closed", count(clipped, "paper clip")));
    }
    let sewn = |joint: &&Joint| job.splices.iter().any(|s| s.joints.iter().any(|name| name == joint.name));
    let holed = || joints.iter().filter(|joint| joint.held == Held::Holes);
    if holed().any(|joint| sewn(&joint)) {
        tool("Needle and thread");
    }
    let riveted: usize = holed().filter(|joint| !sewn(joint)).map(|joint| joint.abreast).sum();
    if riveted > 0 {
        tool(&format!("{} or brass fasteners", count(riveted, "rivet")));
    }
    let taped = job.splices.iter().any(|splice| splice.joints.is_empty());
    if !base_cards(job).is_empty() || taped || joints.iter().any(|joint| joint.held == Held::Tape) {
        tool("Glue or double-sided tape");
    }
    tools
}

fn splice_text(splice: &Splice, all: &[Joint], job: &Book) -> String {
    let [from, to] = &splice.pieces;
    let overlap = splice.stations_mm.end - splice.stations_mm.start;
    let joints = splice.joints.join(" and ");
    let drawn_from = |name: &str| job.pieces.iter().find(|p| p.name == name).map_or(Side::Front, |p| p.seen_from);
    let (lower, upper) = (drawn_from(from), drawn_from(to));
    let on = if splice.later_in_front == (lower == Side::Front) { "on" } else { "under" };
    let side = job.handling.marks.side();
    let up = match lower == upper {
        true => format!("{side}s up"),
        false => format!("the {side} of {from} up and that of {to} down"),
    };
    let laid =
        format!("Lay the start of piece {to} {on} the end of piece {from}, {up}, {overlap:.0} mm over each other");
    let held = all.iter().find(|joint| splice.joints.iter().any(|name| name == joint.name)).map(|joint| joint.held);
    match (splice.kind, held) {
        (SpliceKind::Connection, _) => {
            format!(
                "{laid}: the cuts of joint {joints} lie on each other. Clip them; closing joint {joints} holds them."
            )
        }
        (SpliceKind::Lap, Some(Held::Flaps)) => format!("{laid}. Close joints {joints}, which hold them."),
        (SpliceKind::Lap, Some(Held::Holes)) => {
            format!("{laid}: the two rows of holes ({joints}) lie on each other. Sew through them.")
        }
        (SpliceKind::Lap, Some(Held::Tape) | None) => format!("{laid}. Glue or tape them."),
        (SpliceKind::DovetailTape, _) => {
            format!(
                "Put the dovetails of pieces {from} and {to} together, flat on the table, and tape them over between the ticks."
            )
        }
        (SpliceKind::Finger, _) => {
            format!("Put the fingers of pieces {from} and {to} together, flat on the table, and glue or tape them.")
        }
    }
}

/// The pieces that tie ruffles to each other.
fn tied(flow: &mut Flow, connectors: &[&Piece]) {
    const TITLE: &str = "Connectors";
    flow.page(TITLE);
    let how = "These short pieces tie two ruffles together and carry the numbers of the two joints they go into. Each end lies between the two sheets of its joint: the flap goes through the connector first, then through the slit. The steps say when. A connector put into the first ruffle hangs loose until the second is built onto it.";
    flow.paragraph(BODY, how, TITLE);
    flow.skip(2.0);
    beside::draw(flow, connectors, TITLE);
}
