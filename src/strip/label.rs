//! Joint numbers and piece names, lettered beside the cuts they belong to.

use super::joint::Joint;
use super::passage::Passage;
use crate::drawing::{DrawnPath, KerfSide, Role, text_paths, text_width};
use crate::geom::{Motion, P2, Rect, V2, contains, segments_cross, tolerance};

/// Room between a label and anything else, mm.
const CLEAR_MM: f64 = 0.8;

/// Labels for one piece, and how many of them could not be kept clear of cuts and of one another. `paths` are the piece's cuts, its contour first.
pub(super) fn labels(
    piece: &str,
    paths: &[DrawnPath],
    passages: &[Passage],
    joint: &Joint,
    height_mm: f64,
) -> (Vec<DrawnPath>, usize) {
    let contour = paths[0].path.flatten(tolerance::FLATTEN_MM);
    let mut taken: Vec<Rect> = paths[1..].iter().map(|p| p.path.bounds()).collect();
    let (mut labels, mut collisions) = (Vec::new(), 0);
    let mut write = |text: &str, joint: Option<&str>, corners: Vec<P2>| {
        let size = V2::new(text_width(text, height_mm), height_mm);
        let boxed = |corner: &P2| Rect { min: *corner, max: corner + size };
        let clear = |rect: &Rect| {
            let grown = rect.grown(CLEAR_MM);
            inside(&grown, &contour) && !taken.iter().any(|t| t.overlaps(&grown))
        };
        let free = corners.iter().map(boxed).find(clear);
        collisions += usize::from(free.is_none());
        if let Some(rect) = free.or_else(|| corners.first().map(boxed)) {
            taken.push(rect);
            let motion = Motion::new(rect.min.coords, 0.0);
            labels.extend(text_paths(text, height_mm).iter().map(|path| DrawnPath {
                path: path.moved(&motion),
                role: Role::Label,
                kerf: KerfSide::On,
                joint: joint.map(str::to_owned),
            }));
        }
    };
    for passage in passages {
        let width = text_width(&passage.joint, height_mm);
        write(&passage.joint, Some(&passage.joint), beside(passage, joint, width, height_mm));
    }
    let bounds = Rect::around(&contour);
    let step = height_mm + CLEAR_MM;
    let rows = (bounds.height() / step) as usize + 1;
    // The name goes to the first free place from the piece's start.
    let anywhere = (0..(bounds.width() / step) as usize).flat_map(|column| {
        (0..rows).map(move |row| {
            P2::new(bounds.min.x + 1.5 + column as f64 * step, bounds.max.y - 1.5 - (row + 1) as f64 * step)
        })
    });
    write(&format!("PIECE {piece}"), None, anywhere.collect());
    (labels, collisions)
}

/// True when a box lies in a contour, all of it.
fn inside(rect: &Rect, contour: &[P2]) -> bool {
    let (a, b) = (rect.min, rect.max);
    let corners = [a, P2::new(b.x, a.y), b, P2::new(a.x, b.y)];
    let n = contour.len();
    let crosses = |i: usize| {
        let (p, q) = (contour[i], contour[(i + 1) % n]);
        (0..4).any(|k| segments_cross(p, q, corners[k], corners[(k + 1) % 4]))
    };
    corners.iter().all(|p| contains(contour, *p)) && !(0..n).any(crosses)
}

/// Places to try for a joint number, best first: behind the hinge or the slit, on the side the flap does not point to; then ahead; then beside, across the strip.
fn beside(passage: &Passage, joint: &Joint, width: f64, height: f64) -> Vec<P2> {
    let bounds = passage.bounds(joint).grown(1.2 * CLEAR_MM);
    let (left, right) = (bounds.min.x - width, bounds.max.x);
    let sides = if passage.seats.first().is_none_or(|s| s.direction > 0.0) { [left, right] } else { [right, left] };
    let mut corners = Vec::new();
    for w in passage.seats.iter().map(|s| s.across_mm) {
        corners.extend(sides.map(|s| P2::new(s, w - 0.5 * height)));
    }
    let middle = 0.5 * (bounds.min.x + bounds.max.x - width);
    let across = 0.5 * joint.head_mm() + joint.hook_radius_mm + 1.2 * CLEAR_MM;
    for w in passage.seats.iter().map(|s| s.across_mm) {
        corners.extend([P2::new(middle, w + across), P2::new(middle, w - across - height)]);
    }
    corners
}
