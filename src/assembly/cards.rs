//! For the machine: the cutting card and the cut list.

use super::flow::{BODY, Flow, STRONG};
use super::letters::Face;
use super::page::{At, Lettering, Page, Pen, Place};
use super::{Book, CutSheet, Grain};
use crate::drawing::Operation;
use crate::geom::{P2, Rect, V2};

const STOCK: Pen = Pen::black(0.3);
const NAME: Lettering = Lettering::new(4.0, Face::Bold);
/// Names on small pieces are written down to this share of the size.
const LEAST_NAME: f64 = 0.42;
const CAPTION: Lettering = Lettering::new(3.4, Face::Plain);
/// Sheets side by side on the card.
const ACROSS: usize = 2;
const GAP_MM: f64 = 8.0;
/// Tallest picture of a sheet, mm.
const TALLEST_MM: f64 = 95.0;

/// Machine, settings, what to look at first, and the sheets.
pub(super) fn cutting_card(flow: &mut Flow, job: &Book) {
    let title = if job.card.by_hand { "Cutting by hand" } else { "Cutting card" };
    flow.page(title);
    if let Some(why) = &job.card.uncalibrated {
        flow.paragraph(STRONG, &format!("UNCALIBRATED: {why}"), title);
        flow.skip(1.0);
    }
    flow.facts(job.card.facts.iter().map(|(what, value)| (what.as_str(), value.as_str())), title);
    if !job.card.setup.is_empty() {
        flow.heading("Before you start", 12.0, title);
        for item in &job.card.setup {
            flow.check(&sentence(item), title);
        }
    }
    if let Some(grain) = job.handling.grain {
        grain_note(flow, grain, title);
    }
    let column = (flow.width_mm() - GAP_MM) / ACROSS as f64;
    let height = |sheet: &CutSheet| (sheet.layout.height_mm * column / sheet.layout.width_mm).min(TALLEST_MM);
    let first = job.sheets.first().map_or(0.0, height);
    flow.heading("Sheets", first + 22.0, title);
    if !job.card.by_hand {
        flow.paragraph(BODY, "As they lie on the machine, the corner X0 Y0 at the lower left.", title);
    }
    for row in job.sheets.chunks(ACROSS) {
        let tallest = row.iter().map(height).fold(0.0, f64::max);
        let space = flow.take(tallest + 13.0, title);
        for (i, sheet) in row.iter().enumerate() {
            let left = space.min.x + i as f64 * (column + GAP_MM);
            let caption = P2::new(left, space.max.y - 5.0);
            super::flow::check_box(flow.paper(), caption - V2::new(0.0, 0.6));
            let text = if job.card.by_hand {
                format!("{}: {}", sheet.file, sheet.stock)
            } else {
                format!("{}: {}, {}", sheet.file, sheet.stock, sheet.time)
            };
            flow.text(caption + V2::new(6.0, 0.0), At::Left, CAPTION, &text);
            let top = space.max.y - 8.0;
            let picture = Rect { min: P2::new(left, top - height(sheet)), max: P2::new(left + column, top) };
            thumbnail(flow.paper(), &picture, sheet);
            if job.handling.grain.is_some() {
                let scale = height(sheet) / sheet.layout.height_mm;
                let right = left + sheet.layout.width_mm * scale;
                grain_arrow(flow.paper(), P2::new(right, caption.y + 1.2));
            }
        }
    }
}

/// How strips run to the grain, and how to find out how it runs, before anything is cut.
fn grain_note(flow: &mut Flow, grain: Grain, title: &str) {
    flow.heading("Grain", 20.0, title);
    let rule = match grain.along {
        true => "All strips run along the grain: the sheet is stiffest that way and springs back best.",
        false => "All strips run across the grain, as the design asks: the sheet bends softer that way.",
    };
    flow.paragraph(BODY, &format!("{rule} The arrow over each sheet below shows the grain."), title);
    if !grain.known {
        flow.paragraph(STRONG, "How the grain runs in this stock is not known. Ten seconds tell:", title);
        flow.check(
            "Tear a corner along one side, then along the other: along the grain it tears straight, across it tears ragged.",
            title,
        );
        flow.check("Or bend the sheet gently both ways: it curls more easily with the fold along the grain.", title);
        flow.check("Lay every sheet so that its grain runs as the arrow shows.", title);
    }
}

/// The text with a capital.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A nested sheet: pieces with their names.
fn thumbnail(page: &mut Page, picture: &Rect, sheet: &CutSheet) {
    let stock = Rect::from_size(sheet.layout.width_mm, sheet.layout.height_mm);
    let mut place = Place::fit(&stock, picture, 1.0);
    // To the upper left of its column.
    let size = V2::new(stock.width(), stock.height()) * place.scale;
    place.motion.translation.vector = V2::new(picture.min.x, picture.max.y - size.y);
    let corner = place.point(P2::origin());
    page.frame(&Rect { min: corner, max: corner + size }, STOCK);
    for drawing in sheet.drawings {
        for path in &drawing.paths {
            match path.role.operation() {
                Operation::CutOutline => page.curve(&path.path, &place, Pen::black(0.25)),
                Operation::CutInner => page.curve(&path.path, &place, Pen::gray(0.15, 0.35)),
                Operation::Engrave => {}
            }
        }
    }
    for drawing in sheet.drawings {
        let bounds = drawing.bounds();
        let (middle, wide) = (place.point(bounds.center()), bounds.width() * place.scale);
        // As large as the piece is wide and high.
        let room = (wide - 1.5) / NAME.width_mm(&drawing.name);
        let share = room.min(bounds.height() * place.scale / (2.0 * NAME.size_mm)).clamp(LEAST_NAME, 1.0);
        let name = Lettering { size_mm: share * NAME.size_mm, ..NAME };
        let (half, high) = (0.5 * name.width_mm(&drawing.name) + 0.4, 0.48 * name.size_mm);
        page.block(&Rect { min: middle - V2::new(half, high), max: middle + V2::new(half, high) }, 1.0);
        page.text(middle - V2::new(0.0, 0.36 * name.size_mm), At::Middle, name, &drawing.name);
    }
}

/// An arrow that ends at `right`, for the grain that runs along every sheet's picture.
fn grain_arrow(page: &mut Page, right: P2) {
    let (pen, left) = (Pen::black(0.25), right - V2::new(14.0, 0.0));
    page.line(&[left, right], pen);
    for (tip, way) in [(left, 1.0), (right, -1.0)] {
        page.line(&[tip + V2::new(1.6 * way, 0.9), tip, tip + V2::new(1.6 * way, -0.9)], pen);
    }
    page.text(left - V2::new(1.5, 1.0), At::Right, Lettering { size_mm: 3.0, ..CAPTION }, "grain");
}

/// Every piece with its sheet, size and mass, to tick off.
pub(super) fn cut_list(flow: &mut Flow, job: &Book) {
    const TITLE: &str = "Cut list";
    let rows: Vec<Vec<String>> = job
        .pieces
        .iter()
        .enumerate()
        .map(|(i, piece)| {
            let holds = |sheet: &&CutSheet| sheet.layout.placements.iter().any(|p| p.item == i);
            let sheet = job.sheets.iter().find(holds).map_or("", |sheet| sheet.file);
            let size = format!("{:.0} x {:.0} mm", piece.length_mm, piece.width_mm);
            let mut joints: Vec<&str> = piece.drawing.paths.iter().filter_map(|p| p.joint.as_deref()).collect();
            joints.dedup();
            let mut named: Vec<&str> = Vec::new();
            joints.into_iter().for_each(|j| {
                if !named.contains(&j) {
                    named.push(j);
                }
            });
            vec![piece.name.clone(), sheet.to_owned(), size, format!("{:.2} g", piece.mass_g), named.join(" ")]
        })
        .collect();
    // A short list goes below the card.
    if flow.free_mm() < 24.0 + 6.4 * rows.len() as f64 {
        flow.page(TITLE);
    } else {
        flow.skip(4.0);
        flow.heading(TITLE, 20.0, TITLE);
    }
    flow.table(&["Piece", "Sheet", "Size", "Mass", "Joints"], &rows, &[0.12, 0.16, 0.22, 0.12, 0.38], true, TITLE);
}
