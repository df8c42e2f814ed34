//! Pieces that belong to no strip, two in a row: connectors and base cards.

use super::flat::{self, LEADER, NAME, NUMBER};
use super::flow::Flow;
use super::page::{At, Place};
use crate::geom::{P2, Rect, V2};
use crate::strip::Piece;

const ACROSS: usize = 2;
const GAP_MM: f64 = 10.0;
/// A piece's name and the numbers of its joints stand above it, mm.
const ABOVE_MM: f64 = 12.0;
const BELOW_MM: f64 = 5.0;

fn column_mm(flow: &Flow) -> f64 {
    (flow.width_mm() - GAP_MM * (ACROSS - 1) as f64) / ACROSS as f64
}

/// One scale for all of them: true size where that fits.
fn scale(flow: &Flow, pieces: &[&Piece]) -> f64 {
    let longest = pieces.iter().map(|p| p.length_mm).fold(1.0, f64::max);
    (column_mm(flow) / longest).min(1.0)
}

fn row_mm(row: &[&Piece], scale: f64) -> f64 {
    ABOVE_MM + row.iter().map(|p| p.width_mm * scale).fold(0.0, f64::max) + BELOW_MM
}

/// Height of all of them, mm.
pub(super) fn height_mm(flow: &Flow, pieces: &[&Piece]) -> f64 {
    let scale = scale(flow, pieces);
    pieces.chunks(ACROSS).map(|row| row_mm(row, scale)).sum()
}

/// Draws them; `title` heads a page that one of them starts.
pub(super) fn draw(flow: &mut Flow, pieces: &[&Piece], title: &str) {
    let (scale, column) = (scale(flow, pieces), column_mm(flow));
    for row in pieces.chunks(ACROSS) {
        let space = flow.take(row_mm(row, scale), title);
        for (i, piece) in row.iter().enumerate() {
            let bounds = piece.drawing.bounds();
            let left = space.min.x + i as f64 * (column + GAP_MM);
            let top = space.max.y - ABOVE_MM;
            let place = Place::new(scale, P2::new(left, top) - P2::new(bounds.min.x, bounds.max.y) * scale);
            flow.text(P2::new(left, space.max.y - 5.0), At::Left, NAME, &format!("Piece {}", piece.name));
            flat::draw(flow.paper(), piece, &place);
            for passage in &piece.passages {
                let own = piece.drawing.paths.iter().filter(|p| p.joint.as_ref() == Some(&passage.joint));
                let near = own.map(|p| p.path.bounds()).filter(|b| (b.center().x - passage.station_mm).abs() < 1.0);
                let cut = near.fold(Rect::EMPTY, Rect::union);
                let foot = place.point(P2::new(passage.station_mm, cut.max.y.min(bounds.max.y)));
                let head = P2::new(foot.x, top + 1.0);
                flow.paper().line(&[foot, head], LEADER);
                flow.text(head + V2::new(0.0, 0.5), At::Middle, NUMBER, &passage.joint);
            }
        }
    }
}
