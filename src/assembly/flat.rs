//! The flat pieces of a ruffle with the numbers of their joints, to lay beside the cut ones.

use super::Book;
use super::flow::{BODY, Flow, MARGIN_MM};
use super::folded::CAPITALS;
use super::joints::strip_pieces;
use super::letters::Face;
use super::page::{At, Lettering, Page, Pen, Place};
use crate::drawing::Role;
use crate::fit::Part;
use crate::geom::{P2, Rect, V2};
use crate::strip::{Face as Side, Half, Passage, Piece};

/// Pieces are drawn no smaller than this; longer ones go on in the next row.
const LEAST_SCALE: f64 = 0.42;
/// And no wider on the page than this, mm.
const MOST_WIDTH_MM: f64 = 62.0;
pub(super) const NAME: Lettering = Lettering::new(4.4, Face::Bold);
pub(super) const NUMBER: Lettering = Lettering::new(3.9, Face::Bold);
/// From lane to lane of joint numbers above a piece, mm.
const LANE_MM: f64 = 4.4;
const CONTOUR: Pen = Pen::black(0.35);
const SLIT: Pen = Pen::black(0.8);
const THIN: Pen = Pen::gray(0.2, 0.3);
pub(super) const LEADER: Pen = Pen::gray(0.2, 0.4);
const FLAP_GRAY: f64 = 0.35;

/// Side of the triangle that tells which way a flap is folded, mm.
const TRIANGLE_MM: f64 = 2.6;
/// Air between two numbers in a lane, mm.
const CLEAR_MM: f64 = 1.4;
/// Cuts lie this close to where their passage says, along the strip, mm.
const NEAR_MM: f64 = 3.0;

/// A joint number over a piece.
struct Number<'a> {
    passage: &'a Passage,
    /// Where the passage lies in the drawing, mm.
    x_mm: f64,
    /// Left end on the page, mm.
    left: f64,
    /// The lane it stands in, from below.
    lane: usize,
}

/// Draws the pieces of a part below one another.
pub(super) fn pages(flow: &mut Flow, job: &Book, part: &Part) {
    let title = format!("Ruffle {}: flat", part.name);
    let pieces = strip_pieces(&part.name, job.pieces);
    flow.page(&title);
    let scale = scale(flow, &pieces);
    let side = job.handling.marks.side();
    let ticks = if pieces.len() > 1 && marked(&pieces) {
        " Short ticks at the edges show how far the next piece reaches."
    } else {
        ""
    };
    let note = format!(
        "Drawn at {:.0} % with the {side} toward you. Dark shapes are flaps, thick bars are slits; each goes with its own number. A flap with a solid triangle folds toward you, toward the {side}; one with a hollow triangle away from it.{ticks}",
        100.0 * scale
    );
    flow.paragraph(BODY, &note, &title);
    flow.skip(2.0);
    for piece in pieces {
        draw_rows(flow, piece, scale, &title);
    }
}

/// True when pieces carry ticks where their neighbours end.
fn marked(pieces: &[&Piece]) -> bool {
    pieces.iter().flat_map(|piece| &piece.drawing.paths).any(|path| path.role == Role::Mark && path.joint.is_none())
}

/// At which pieces are drawn below one another: as large as the page is wide, a little less where that saves a page.
fn scale(flow: &Flow, pieces: &[&Piece]) -> f64 {
    let longest = pieces.iter().map(|p| p.length_mm).fold(1.0, f64::max);
    let widest = pieces.iter().map(|p| p.width_mm).fold(1.0, f64::max);
    let most = (flow.width_mm() / longest).clamp(LEAST_SCALE, 1.0).min(MOST_WIDTH_MM / widest);
    let height = |scale: f64| -> f64 {
        let rows = pieces.iter().flat_map(|piece| rows(piece, scale, flow.width_mm()));
        rows.map(|row| row.height_mm).sum()
    };
    let free = flow.free_mm() - NOTE_MM;
    [1.0, 0.95, 0.9, 0.85, 0.8].map(|share| share * most).into_iter().find(|s| height(*s) <= free).unwrap_or(most)
}

/// What the note over the pieces takes, mm.
const NOTE_MM: f64 = 22.0;

/// A stretch of a piece that is drawn in one row.
struct Row<'a> {
    stretch: Rect,
    numbers: Vec<Number<'a>>,
    lanes: usize,
    height_mm: f64,
}

/// A piece in as many rows as it takes in a column `width_mm` wide.
fn rows<'a>(piece: &'a Piece, scale: f64, width_mm: f64) -> Vec<Row<'a>> {
    let bounds = piece.drawing.bounds();
    let count = (bounds.width() * scale / width_mm - 1e-9).ceil().max(1.0);
    let row_mm = bounds.width() / count;
    let row = |i: usize| {
        let from = bounds.min.x + i as f64 * row_mm;
        let stretch = Rect { min: P2::new(from, bounds.min.y), max: P2::new(from + row_mm, bounds.max.y) };
        let numbers = numbers(piece, &stretch, scale, MARGIN_MM + width_mm);
        let lanes = numbers.iter().map(|n| n.lane + 1).max().unwrap_or(0);
        let height_mm = bounds.height() * scale + lanes as f64 * LANE_MM + NAME.size_mm + 9.0;
        Row { stretch, numbers, lanes, height_mm }
    };
    (0..count as usize).map(row).collect()
}

fn draw_rows(flow: &mut Flow, piece: &Piece, scale: f64, title: &str) {
    let rows = rows(piece, scale, flow.width_mm());
    let count = rows.len();
    for (i, row) in rows.iter().enumerate() {
        let name = match (count, i) {
            (1, _) => format!("Piece {}", piece.name),
            (_, 0) => format!("Piece {}, goes on below", piece.name),
            _ => format!("Piece {}, row {} of {count}", piece.name, i + 1),
        };
        let name = if piece.seen_from == Side::Front {
            name
        } else {
            format!("{name} (seen from the back, so the strip starts on the right)")
        };
        let space = flow.take(row.height_mm, title);
        let min = space.min + V2::new(0.0, 5.0);
        let window = Rect { min, max: min + V2::new(row.stretch.width(), row.stretch.height()) * scale };
        let place = Place::new(scale, min - row.stretch.min * scale);
        let above = P2::new(MARGIN_MM, window.max.y + row.lanes as f64 * LANE_MM + 2.0);
        flow.text(above, At::Left, NAME, &name);
        flow.paper().within(&window.grown(0.3), |page| draw(page, piece, &place));
        for number in &row.numbers {
            write(flow.paper(), piece, number, &place, window.max.y);
        }
    }
}

/// The piece as it is cut.
pub(super) fn draw(page: &mut Page, piece: &Piece, place: &Place) {
    for path in &piece.drawing.paths {
        match path.role {
            Role::Outline => page.curve(&path.path, place, CONTOUR),
            Role::Flap => {
                let points = place.points(&path.path);
                page.region([points.as_slice()], FLAP_GRAY, Some(Pen::black(0.2)));
            }
            Role::Slit => page.curve(&path.path, place, SLIT),
            Role::Hole => page.curve(&path.path, place, Pen::black(0.2)),
            Role::Mark => page.curve(&path.path, place, THIN.dashed(1.5, 1.0)),
            Role::Label => page.curve(&path.path, place, THIN),
        }
    }
}

/// Joint numbers over a stretch of a piece, each in the lowest lane in which it lies on no other.
fn numbers<'a>(piece: &'a Piece, stretch: &Rect, scale: f64, right: f64) -> Vec<Number<'a>> {
    // A piece seen from the back is drawn mirrored.
    let drawn =
        |passage: &Passage| if piece.seen_from == Side::Front { passage.station_mm } else { -passage.station_mm };
    let within = |(x, _): &(f64, &Passage)| (stretch.min.x..=stretch.max.x).contains(x);
    let mut marks: Vec<(f64, &Passage)> = piece.passages.iter().map(|p| (drawn(p), p)).filter(within).collect();
    marks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut ends: Vec<f64> = Vec::new();
    let number = |(x_mm, passage): (f64, &'a Passage)| {
        let middle = MARGIN_MM + (x_mm - stretch.min.x) * scale;
        let triangle = if passage.half == Half::Flap { TRIANGLE_MM + 1.0 } else { 0.0 };
        let width = NUMBER.width_mm(&passage.joint) + triangle;
        let left = (middle - 0.5 * width).clamp(MARGIN_MM, right - width);
        let lane = ends.iter().position(|end| *end <= left).unwrap_or(ends.len());
        let end = left + width + CLEAR_MM;
        match ends.get_mut(lane) {
            Some(last) => *last = end,
            None => ends.push(end),
        }
        Number { passage, x_mm, left, lane }
    };
    marks.into_iter().map(number).collect()
}

/// Writes a number over the piece, with a line down to its cut.
fn write(page: &mut Page, piece: &Piece, number: &Number, place: &Place, top: f64) {
    let Number { passage, x_mm, left, lane } = number;
    let baseline = top + 1.2 + *lane as f64 * LANE_MM;
    let x = place.point(P2::new(*x_mm, 0.0)).x;
    let cuts = piece.drawing.paths.iter().filter(|p| p.joint.as_ref() == Some(&passage.joint));
    let near = cuts
        .filter(|p| matches!(p.role, Role::Flap | Role::Slit))
        .map(|p| p.path.bounds())
        .filter(|b| (b.min.x - NEAR_MM..=b.max.x + NEAR_MM).contains(x_mm));
    let foot = near.map(|b| place.point(b.max).y).fold(f64::NEG_INFINITY, f64::max);
    let foot = if foot.is_finite() { foot.min(top) } else { top };
    page.line(&[P2::new(x, foot), P2::new(x, baseline - 0.6)], LEADER);
    let (width, height) = (NUMBER.width_mm(&passage.joint), CAPITALS * NUMBER.size_mm);
    let min = P2::new(*left, baseline);
    page.block(&Rect { min, max: min + V2::new(width, height) }.grown(0.3), 1.0);
    page.text(min, At::Left, NUMBER, &passage.joint);
    if passage.half == Half::Flap {
        let corner = min + V2::new(width + 1.0, 0.2);
        let triangle =
            [V2::zeros(), V2::new(TRIANGLE_MM, 0.0), V2::new(0.5 * TRIANGLE_MM, TRIANGLE_MM)].map(|v| corner + v);
        let gray = if passage.face == piece.seen_from { 0.0 } else { 1.0 };
        page.region([triangle.as_slice()], gray, Some(Pen::black(0.25)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Drawing;
    use crate::strip::Seat;

    fn piece(stations: &[f64]) -> Piece {
        let passage = |(i, station_mm): (usize, &f64)| Passage {
            joint: format!("A{}", i + 1),
            station_mm: *station_mm,
            half: if i % 2 == 0 { Half::Flap } else { Half::Slit },
            face: Side::Front,
            depth: i % 2,
            sheets: 1,
            seats: vec![Seat { across_mm: 0.0, direction: 1.0 }],
        };
        Piece {
            name: "A1".into(),
            part: "A".into(),
            drawing: Drawing::default(),
            seen_from: Side::Front,
            stations_mm: 0.0..300.0,
            passages: stations.iter().enumerate().map(passage).collect(),
            length_mm: 300.0,
            width_mm: 30.0,
            mass_g: 1.0,
        }
    }

    #[test]
    fn crowded_numbers_stand_in_lanes_and_none_lies_on_another_or_beyond_the_page() {
        let piece = piece(&[0.0, 4.0, 9.0, 11.0, 60.0, 140.0, 296.0, 299.0]);
        let stretch = Rect { min: P2::new(0.0, -15.0), max: P2::new(300.0, 15.0) };
        let numbers = numbers(&piece, &stretch, 0.6, 195.0);
        assert_eq!(numbers.len(), 8);
        for (i, a) in numbers.iter().enumerate() {
            let end = a.left + NUMBER.width_mm(&a.passage.joint);
            assert!(a.left >= MARGIN_MM && end <= 195.0);
            for b in numbers[i + 1..].iter().filter(|b| b.lane == a.lane) {
                assert!(b.left >= end, "{} on {}", b.passage.joint, a.passage.joint);
            }
        }
        assert!(numbers.iter().all(|n| n.lane < 4));
    }

    #[test]
    fn a_row_shows_the_numbers_of_its_own_stretch() {
        let piece = piece(&[10.0, 120.0, 250.0]);
        let stretch = Rect { min: P2::new(100.0, -15.0), max: P2::new(200.0, 15.0) };
        let shown = numbers(&piece, &stretch, 1.0, 195.0);
        assert_eq!(shown.iter().map(|n| n.passage.joint.as_str()).collect::<Vec<_>>(), ["A2"]);
    }
}
