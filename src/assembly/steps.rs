//! What to do, step by step, with a box to tick for each.

use super::flow::{BODY, Flow, STRONG, check_box};
use super::joints::{Held, Joint};
use super::letters::{Face, wrapped};
use super::order::{FINGERS_MM, Step, TWEEZERS_MM, order};
use super::page::{At, Lettering, Page, Pen};
use super::{Book, count, cover, folded, splices_of};
use crate::fit::{FootUsed, Part};
use crate::geom::{P2, Rect, V2};
use crate::strip::{Face as Side, Piece, Splice, SpliceKind};

const NUMBER: Lettering = Lettering::new(9.0, Face::Bold);
const TEXT: Lettering = Lettering::new(3.3, Face::Plain);
const SMALL: Lettering = Lettering { size_mm: 3.0, face: Face::Plain, gray: 0.3 };
const BORDER: Pen = Pen::gray(0.2, 0.6);
/// Height of one step, mm.
const STEP_MM: f64 = 53.0;
const ACROSS: usize = 2;
/// Share of a step's width that words take; the picture has the rest.
const WORDS: f64 = 0.42;
const GAP_MM: f64 = 4.0;

/// What is done to the cut pieces before any joint is closed.
pub(super) fn before(flow: &mut Flow, job: &Book) {
    const TITLE: &str = "Before folding";
    flow.page(TITLE);
    flow.heading("Tools", 10.0, TITLE);
    for tool in tools(job) {
        flow.check(tool, TITLE);
    }
    if let Some(known) = job.handling.grain_known {
        flow.heading("Grain", 20.0, TITLE);
        let rule = "All strips run along the grain: the sheet is stiffest that way and springs back best.";
        flow.paragraph(BODY, rule, TITLE);
        if !known {
            flow.paragraph(STRONG, "How the grain runs in this stock is not known. Ten seconds tell:", TITLE);
            flow.check("Tear a corner along one side, then along the other: along the grain it tears straight, across it tears ragged.", TITLE);
            flow.check(
                "Or bend the sheet gently both ways: it curls more easily with the fold along the grain.",
                TITLE,
            );
            flow.check("Lay the sheets so that the grain runs as the arrow on the cutting card shows, all of them the same way.", TITLE);
        }
    }
    flow.heading("Prepare the pieces", 20.0, TITLE);
    flow.check("Lay out the pieces as on the pages called \"flat\" and compare the numbers.", TITLE);
    if !job.handling.lettered {
        flow.check("Nothing is written on them: write the numbers beside flaps and slits, in pencil or on bits of tape, as those pages show.", TITLE);
    }
    flow.check("Push every flap out of the sheet and back again, gently; free what still hangs on.", TITLE);
    let curl = format!(
        "Curl every piece over its whole length, both ways: pull it over the edge of the table, or wind it round a rod of {:.0} mm. Loops then fall into place by themselves.",
        job.handling.rod_mm
    );
    flow.check(&curl, TITLE);
    if !job.splices.is_empty() {
        flow.heading("Join the pieces of each strip", 20.0, TITLE);
        for splice in job.splices {
            flow.check(&splice_text(splice, job.pieces), TITLE);
        }
    }
    flow.heading("How a joint closes", 36.0, TITLE);
    let how = "Lay the flap's sheet on the slit's sheet, number on number. Bend the barbs of the flap together between two fingers, push the flap through the slit, and let the barbs open behind it. Where a number has two slits the same flap goes through both, one after the other. Pull lightly: it must not slip back.";
    flow.paragraph(BODY, how, TITLE);
}

fn tools(job: &Book) -> Vec<&'static str> {
    let mut tools = Vec::new();
    if job.card.by_hand {
        tools.push("Scissors, and a sharp knife with a ruler and a cutting mat for flaps and slits");
    }
    let narrowest = job.parts.iter().flat_map(order).map(|step| step.room_mm).fold(f64::INFINITY, f64::min);
    if narrowest < FINGERS_MM {
        tools.push("Blunt tweezers");
    }
    tools.push("Bone folder, or the back of a spoon, to press joints flat");
    tools.push("A rod or a pencil to curl strips");
    let pinned = job.parts.iter().any(|part| part.report.foot == FootUsed::Pinned);
    if pinned || job.splices.iter().any(|splice| splice.joints.is_empty()) {
        tools.push("Glue or double-sided tape");
    }
    tools
}

fn splice_text(splice: &Splice, pieces: &[Piece]) -> String {
    let [from, to] = &splice.pieces;
    let overlap = splice.stations_mm.end - splice.stations_mm.start;
    let joints = splice.joints.join(" and ");
    let front_up = pieces.iter().find(|p| p.name == *from).is_none_or(|p| p.seen_from == Side::Front);
    let on = if splice.later_in_front == front_up { "on" } else { "under" };
    let laid = format!(
        "Lay the start of piece {to} {on} the end of piece {from}, the sides shown on the pages called \"flat\" up; they overlap by {overlap:.0} mm"
    );
    match splice.kind {
        SpliceKind::Connection => {
            format!("{laid}, cut on cut at joint {joints}. Clip them: they are held when the turn of {joints} comes.")
        }
        SpliceKind::Lap if joints.is_empty() => format!("{laid}. Glue or tape them."),
        SpliceKind::Lap => format!("{laid}. Close joints {joints}, which hold them."),
        SpliceKind::DovetailTape => {
            format!("Put the dovetails of pieces {from} and {to} together, flat on the table, and tape them over.")
        }
        SpliceKind::Finger => {
            format!("Put the fingers of pieces {from} and {to} together, flat on the table, and glue or tape them.")
        }
    }
}

/// The steps of one ruffle.
pub(super) fn steps(flow: &mut Flow, job: &Book, part: &Part, joints: &[Joint]) {
    let title = format!("Ruffle {}: steps", part.name);
    let order = order(part);
    let connections = part.ruffle.connection_points();
    let numbers: Vec<u32> = order.iter().map(|step| connections[step.joint].joint).collect();
    let name = |number: u32| format!("{}{number}", part.name);
    let cut = |number: u32| joints.iter().find(|joint| joint.name == name(number));
    let flaps = numbers.iter().filter_map(|n| cut(*n)).map(|joint| joint.abreast).sum();
    let own = splices_of(job, &part.name).count();
    flow.page(&title);
    let minutes = cover::assembly_minutes(job, flaps, own);
    let note = format!(
        "{} in this order, so that none is out of reach later: about {minutes} minutes. Black is closed, grey is still loose, the ring is this step. Toward you and away from you are meant with {} up.",
        count(numbers.len(), "joint"),
        if job.handling.lettered { "the lettered side" } else { "the side on the pages called \"flat\"" }
    );
    flow.paragraph(BODY, &note, &title);
    flow.skip(1.5);
    let width = (flow.width_mm() - GAP_MM * (ACROSS - 1) as f64) / ACROSS as f64;
    for (row, steps) in order.chunks(ACROSS).enumerate() {
        let space = flow.take(STEP_MM + GAP_MM, &title);
        for (column, step) in steps.iter().enumerate() {
            let k = row * ACROSS + column;
            let min = P2::new(space.min.x + column as f64 * (width + GAP_MM), space.min.y + GAP_MM);
            let card = Rect { min, max: min + V2::new(width, STEP_MM) };
            let page = flow.paper();
            page.frame(&card, BORDER);
            check_box(page, P2::new(card.min.x + 3.0, card.max.y - 9.5));
            page.text(P2::new(card.min.x + 9.5, card.max.y - 9.8), At::Left, NUMBER, &name(numbers[k]));
            page.text(
                P2::new(card.min.x + 3.0, card.min.y + 2.5),
                At::Left,
                SMALL,
                &format!("step {} of {}", k + 1, order.len()),
            );
            let middle = card.min.x + WORDS * width;
            words(
                page,
                P2::new(card.min.x + 3.0, card.max.y - 16.0),
                middle - card.min.x - 4.0,
                &sentences(cut(numbers[k]), step),
            );
            let picture = Rect { min: P2::new(middle, card.min.y + 1.0), max: card.max - V2::new(1.0, 1.0) };
            folded::small(page, &picture, part, &numbers[..k], numbers[k]);
        }
    }
}

/// What to do in one step, in a few short sentences.
fn sentences(joint: Option<&Joint>, step: &Step) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(joint) = joint {
        let on = |pieces: &[&str]| format!("piece{} {}", if pieces.len() > 1 { "s" } else { "" }, pieces.join(" + "));
        let several = joint.abreast > 1;
        let sheets = |what: &str| -> Vec<String> {
            joint.through.iter().map(|pieces| format!("{what} {} on {}", joint.name, on(pieces))).collect()
        };
        match joint.held {
            Held::Flaps => {
                let flap = if several { format!("{} flaps", joint.abreast) } else { "Flap".to_owned() };
                lines.push(format!("{flap} {} on {}", joint.name, on(&joint.flap_on)));
                let slits = sheets(if several { "slits" } else { "slit" });
                if !slits.is_empty() {
                    lines.push(format!("through {}.", slits.join(", then ")));
                }
            }
            Held::Holes => {
                lines.push(format!("Lay {} on each other.", sheets("holes").join(", ")));
                lines.push("Close with rivets, fasteners or thread.".into());
            }
            Held::Tape => {
                lines.push(format!("Lay {} on each other.", sheets("marks").join(", ")));
                lines.push("Tape or glue them.".into());
            }
        }
        match joint.toward {
            Some(true) => lines.push("Fold toward you.".into()),
            Some(false) => lines.push("Fold away from you.".into()),
            None => {}
        }
    }
    lines.push(if step.room_mm >= FINGERS_MM {
        "Fingers fit.".into()
    } else if step.room_mm >= TWEEZERS_MM {
        format!("Tweezers: {:.0} mm of room.", step.room_mm)
    } else {
        format!("Only {:.0} mm of room: tweezers, from the open side.", step.room_mm)
    });
    lines
}

fn words(page: &mut Page, top: P2, width: f64, sentences: &[String]) {
    let mut baseline = top.y;
    for sentence in sentences {
        for line in wrapped(sentence, TEXT.size_mm, TEXT.face, width) {
            page.text(P2::new(top.x, baseline), At::Left, TEXT, &line);
            baseline -= 4.4;
        }
        baseline -= 0.8;
    }
}

/// What is left when every ruffle is closed.
pub(super) fn after(flow: &mut Flow, job: &Book) {
    const TITLE: &str = "Finish";
    let strips: Vec<&str> = job
        .parts
        .iter()
        .flat_map(|part| super::joints::strip_pieces(&part.name, job.pieces))
        .map(|piece| piece.name.as_str())
        .collect();
    let others: Vec<&Piece> = job.pieces.iter().filter(|piece| !strips.contains(&piece.name.as_str())).collect();
    flow.heading("Finish", 24.0, TITLE);
    for part in job.parts.iter().filter(|part| part.report.foot == FootUsed::Pinned) {
        let card = format!("{}-base", part.name);
        let on = match others.iter().any(|piece| piece.name == card) {
            true => format!("on the marks of piece {card}"),
            false => "to a base card".to_owned(),
        };
        let text = format!(
            "Glue both ends of the bottom rung of ruffle {} {on}, {:.0} mm apart: standing free it tips or sags.",
            part.name,
            foot_mm(part)
        );
        flow.check(&text, TITLE);
    }
    for piece in others.iter().filter(|piece| !piece.passages.is_empty()) {
        let ends: Vec<&str> = piece.passages.iter().map(|p| p.joint.as_str()).collect();
        let text = format!(
            "See that piece {} ties joints {}: their flaps go through it last.",
            piece.name,
            ends.join(" and ")
        );
        flow.check(&text, TITLE);
    }
    flow.check(
        "Press every joint flat between two fingers, and turn the object over once: no flap may stand loose.",
        TITLE,
    );
    flow.check("Push it down gently a few times and let it come up: it settles into its shape.", TITLE);
    if !others.is_empty() {
        flow.heading("Pieces beside the strips", 40.0, TITLE);
        super::flat::beside(flow, &others, TITLE);
    }
}

/// Distance of the two points that hold a glued foot, mm.
fn foot_mm(part: &Part) -> f64 {
    let [a, b] = part.ruffle.foot.map(|node| part.equilibrium.positions[node.index()]);
    (b - a).norm()
}
