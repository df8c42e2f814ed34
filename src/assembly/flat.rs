//! The flat pieces of a ruffle with the numbers of their joints, to lay beside the cut ones.

use super::Book;
use super::flow::{BODY, Flow};
use super::folded::CAPITALS;
use super::joints::{root, strip_pieces};
use super::letters::Face;
use super::page::{At, Lettering, Page, Pen, Place};
use crate::drawing::Role;
use crate::fit::Part;
use crate::geom::{P2, Rect, V2, tolerance};
use crate::strip::Piece;

/// Pieces are drawn no smaller than this; longer ones go on in the next row.
const LEAST_SCALE: f64 = 0.42;
/// And no wider on the page than this, mm.
const MOST_WIDTH_MM: f64 = 62.0;
const NAME: Lettering = Lettering::new(4.4, Face::Bold);
const NUMBER: Lettering = Lettering::new(3.9, Face::Bold);
/// From lane to lane of joint numbers above a piece, mm.
const LANE_MM: f64 = 4.4;
const LANES: usize = 3;
const CONTOUR: Pen = Pen::black(0.35);
const SLIT: Pen = Pen::black(0.8);
const THIN: Pen = Pen::gray(0.2, 0.3);
const LEADER: Pen = Pen::gray(0.2, 0.4);
const FLAP_GRAY: f64 = 0.35;

/// Draws the pieces of a part below one another.
pub(super) fn pages(flow: &mut Flow, job: &Book, part: &Part) {
    let title = format!("Ruffle {}: flat", part.name);
    let pieces = strip_pieces(&part.name, job.pieces);
    let longest = pieces.iter().map(|p| p.length_mm).fold(1.0, f64::max);
    let widest = pieces.iter().map(|p| p.width_mm).fold(1.0, f64::max);
    let scale = (flow.width_mm() / longest).clamp(LEAST_SCALE, 1.0).min(MOST_WIDTH_MM / widest);
    flow.page(&title);
    let face = if job.handling.lettered { "the lettered side" } else { "the side shown here" };
    let note = format!(
        "Drawn at {:.0} % with {face} toward you. Dark shapes are flaps, thick bars are slits; each goes with its own number. Start of the strip on the left.",
        100.0 * scale
    );
    flow.paragraph(BODY, &note, &title);
    for piece in pieces {
        rows(flow, piece, scale, &title);
    }
}

fn rows(flow: &mut Flow, piece: &Piece, scale: f64, title: &str) {
    let bounds = piece.drawing.bounds();
    let most = flow.width_mm() / scale;
    let count = (bounds.width() / most).ceil().max(1.0) as usize;
    let row_mm = bounds.width() / count as f64;
    for row in 0..count {
        let from = bounds.min.x + row as f64 * row_mm;
        let stretch = Rect { min: P2::new(from, bounds.min.y), max: P2::new(from + row_mm, bounds.max.y) };
        let drawn_mm = bounds.height() * scale;
        let space = flow.take(drawn_mm + LANES as f64 * LANE_MM + 9.0, title);
        let name = match (count, row) {
            (1, _) => format!("Piece {}", piece.name),
            (_, 0) => format!("Piece {}, goes on below", piece.name),
            _ => format!("Piece {}, row {} of {count}", piece.name, row + 1),
        };
        flow.text(P2::new(space.min.x, space.max.y - NAME.size_mm), At::Left, NAME, &name);
        let window = Rect {
            min: space.min + V2::new(0.0, 2.0),
            max: P2::new(space.min.x + row_mm * scale, space.min.y + 2.0 + drawn_mm),
        };
        let place = Place::new(scale, window.min - stretch.min * scale);
        flow.paper().within(&window.grown(0.3), |page| draw(page, piece, &place));
        let left = space.min.x + NAME.width_mm(&name) + 3.0;
        numbers(flow.paper(), piece, &stretch, &place, &window, left, space.max.x);
    }
}

/// The piece as it is cut.
fn draw(page: &mut Page, piece: &Piece, place: &Place) {
    for path in &piece.drawing.paths {
        match path.role {
            Role::Outline => page.curve(&path.path, place, CONTOUR),
            Role::Flap => {
                let points = place.points(&path.path);
                page.region([points.as_slice()], FLAP_GRAY, Some(Pen::black(0.2)));
            }
            Role::Slit => page.curve(&path.path, place, SLIT),
            Role::Hole => page.curve(&path.path, place, Pen::black(0.25)),
            Role::Mark => page.curve(&path.path, place, THIN.dashed(1.5, 1.0)),
            Role::Label => page.curve(&path.path, place, THIN),
        }
    }
}

/// Joint numbers in lanes above the piece, each with a line to its cut: the lowest lane with room is taken, so that none lies on another. The top lane leaves out
/// what is left of `name_end`, where the piece's name stands.
fn numbers(page: &mut Page, piece: &Piece, stretch: &Rect, place: &Place, window: &Rect, name_end: f64, right: f64) {
    let mut marks: Vec<(f64, &str)> = Vec::new();
    for path in piece.drawing.paths.iter().filter(|p| matches!(p.role, Role::Flap | Role::Slit)) {
        let at = if path.role == Role::Flap { root(path).map(|p| p.x) } else { Some(path.path.bounds().center().x) };
        let (Some(s), Some(name)) = (at, path.joint.as_deref()) else { continue };
        let known = marks.iter().any(|(other, n)| *n == name && (s - other).abs() < tolerance::LIMIT_SLACK_MM);
        if (stretch.min.x..=stretch.max.x).contains(&s) && !known {
            marks.push((s, name));
        }
    }
    marks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut taken = [f64::NEG_INFINITY; LANES];
    taken[LANES - 1] = name_end;
    for (s, name) in marks {
        let x = place.point(P2::new(s, 0.0)).x;
        let width = NUMBER.width_mm(name);
        let start = (x - 0.5 * width).clamp(window.min.x, right - width);
        let free = (0..LANES).find(|lane| taken[*lane] <= start).unwrap_or(LANES - 1);
        taken[free] = start + width + 1.2;
        let baseline = window.max.y + 1.0 + free as f64 * LANE_MM;
        let foot = edge_above(piece, s, place).unwrap_or(window.max.y);
        page.line(&[P2::new(x, foot), P2::new(x, baseline - 0.4)], LEADER);
        let height = CAPITALS * NUMBER.size_mm;
        page.block(
            &Rect { min: P2::new(start - 0.3, baseline - 0.3), max: P2::new(start + width + 0.3, baseline + height) },
            1.0,
        );
        page.text(P2::new(start, baseline), At::Left, NUMBER, name);
    }
}

/// The upper end of the cuts at station `s`, on the page: leaders run down to them.
fn edge_above(piece: &Piece, s: f64, place: &Place) -> Option<f64> {
    let cuts = piece.drawing.paths.iter().filter(|p| matches!(p.role, Role::Flap | Role::Slit));
    let at = cuts.map(|p| p.path.bounds()).filter(|b| b.min.x - 1.0 <= s && s <= b.max.x + 1.0);
    at.map(|b| place.point(b.max).y).reduce(f64::max)
}
