//! The joints of a ruffle in the order they are closed, with a box to tick for each.

use super::flow::{BODY, Flow, check_box};
use super::joints::{Held, Joint};
use super::letters::{Face, wrapped};
use super::order::{FINGERS_MM, Step, TWEEZERS_MM, order};
use super::page::{At, Lettering, Pen};
use super::{Book, count, cover, folded};
use crate::fit::Part;
use crate::geom::{P2, Rect, V2};

const NUMBER: Lettering = Lettering::new(9.0, Face::Bold);
const TEXT: Lettering = Lettering::new(3.3, Face::Plain);
const SMALL: Lettering = Lettering { size_mm: 3.0, face: Face::Plain, gray: 0.3 };
const BORDER: Pen = Pen::gray(0.2, 0.6);
/// Height of one step, mm, unless its words need more.
const STEP_MM: f64 = 53.0;
const ACROSS: usize = 2;
/// Share of a step's width that words take; the picture has the rest.
const WORDS: f64 = 0.45;
const GAP_MM: f64 = 4.0;
/// Height of a step's head line with its number, mm.
const HEAD_MM: f64 = 16.0;
/// From baseline to baseline, and between two sentences, mm.
const LEADING_MM: f64 = 4.4;
const BETWEEN_MM: f64 = 0.8;

/// The steps of one ruffle.
pub(super) fn steps(flow: &mut Flow, job: &Book, part: &Part, joints: &[Joint]) {
    let title = format!("Ruffle {}: steps", part.name);
    let order = order(part);
    let connections = part.ruffle.connection_points();
    let numbers: Vec<u32> = order.iter().map(|step| connections[step.joint].joint).collect();
    let name = |number: u32| format!("{}{number}", part.name);
    let cut = |number: u32| joints.iter().find(|joint| joint.name == name(number));
    flow.page(&title);
    let own: Vec<&Joint> = numbers.iter().filter_map(|n| cut(*n)).collect();
    let minutes = cover::assembly_minutes(job, &own, 0);
    let side = job.handling.marks.side();
    let note = format!(
        "{} in this order, so that none is out of reach later: about {minutes} minutes. The large number is the joint, ringed in the picture; black is closed, grey still loose. Flaps fold toward the {side} of their own piece, or away from it.",
        count(numbers.len(), "joint"),
    );
    flow.paragraph(BODY, &note, &title);
    flow.skip(1.5);
    let width = (flow.width_mm() - GAP_MM * (ACROSS - 1) as f64) / ACROSS as f64;
    let words_mm = WORDS * width - 4.0;
    let lines = |step: &Step| lines(&sentences(cut(connections[step.joint].joint), step, side), words_mm);
    for (row, steps) in order.chunks(ACROSS).enumerate() {
        let words: Vec<Vec<(String, f64)>> = steps.iter().map(lines).collect();
        let needed = words.iter().map(|w| HEAD_MM + w.last().map_or(0.0, |line| line.1) + 3.0).fold(STEP_MM, f64::max);
        let space = flow.take(needed + GAP_MM, &title);
        for (column, (step, words)) in steps.iter().zip(&words).enumerate() {
            let k = row * ACROSS + column;
            let number = connections[step.joint].joint;
            let min = P2::new(space.min.x + column as f64 * (width + GAP_MM), space.min.y + GAP_MM);
            let card = Rect { min, max: min + V2::new(width, needed) };
            let page = flow.paper();
            page.frame(&card, BORDER);
            check_box(page, P2::new(card.min.x + 3.0, card.max.y - 9.5));
            page.text(P2::new(card.min.x + 9.5, card.max.y - 9.8), At::Left, NUMBER, &name(number));
            let counter = format!("step {} of {}", k + 1, order.len());
            page.text(card.max - V2::new(3.0, 5.5), At::Right, SMALL, &counter);
            for (line, down) in words {
                let at = P2::new(card.min.x + 3.0, card.max.y - HEAD_MM - down);
                page.text(at, At::Left, TEXT, line);
            }
            let corner = P2::new(card.min.x + WORDS * width, card.min.y + 1.0);
            let picture = Rect { min: corner, max: card.max - V2::new(1.0, 7.0) };
            folded::small(page, &picture, part, &numbers[..k], number);
        }
    }
}

/// Sentences in lines no wider than `width_mm`, each with how far its baseline lies below the first, mm.
fn lines(sentences: &[String], width_mm: f64) -> Vec<(String, f64)> {
    let mut down = 0.0;
    let mut lines = Vec::new();
    for sentence in sentences {
        for line in wrapped(sentence, TEXT.size_mm, TEXT.face, width_mm) {
            lines.push((line, down));
            down += LEADING_MM;
        }
        down += BETWEEN_MM;
    }
    lines
}

/// What to do in one step, in a few short sentences. `side` is what the drawn side of the pieces is called.
fn sentences(joint: Option<&Joint>, step: &Step, side: &str) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(joint) = joint {
        let on = |pieces: &[&str]| match pieces {
            [one] if one.contains('-') => format!("connector {one}"),
            [one] => format!("piece {one}"),
            several => format!("pieces {}", several.join(" + ")),
        };
        let sheets = |then: &str| joint.through.iter().map(|p| on(p)).collect::<Vec<String>>().join(then);
        let (flaps, slits) = match joint.abreast {
            1 => ("Flap".to_owned(), "slit"),
            n => (format!("{n} flaps"), "slits"),
        };
        match joint.held {
            Held::Flaps => {
                lines.push(format!("{flaps} on {}", on(&joint.flap_on)));
                lines.push(format!("through the {slits} on {}.", sheets(", then on ")));
            }
            Held::Holes => {
                lines.push(format!("Lay {} on each other, hole on hole.", sheets(" and ")));
                lines.push("Close with rivets, fasteners or thread.".into());
            }
            Held::Tape => {
                lines.push(format!("Lay {} on each other, cross on cross.", sheets(" and ")));
                lines.push("Tape or glue them.".into());
            }
        }
        match joint.toward {
            Some(true) => lines.push(format!("Fold toward the {side}.")),
            Some(false) => lines.push(format!("Fold away from the {side}.")),
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
