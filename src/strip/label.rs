//! Where labels go: beside the cuts they belong to, clear of everything.

use super::Face;
use super::lettering::{Fold, Labels, letter, made};
use super::passage::{Half, Passage};
use crate::drawing::{DrawnPath, Role};
use crate::geom::{Motion, P2, Rect, V2, contains, segments_cross, tolerance};
use std::ops::Range;

/// Room between a drawn label and anything else, mm.
const CLEAR_MM: f64 = 0.8;
/// The same for one that is cut through: it must not join other cuts in a tear.
const CUT_CLEAR_MM: f64 = 2.5;
/// A number is looked for this far from its cuts, mm; farther off nobody would see what it belongs to.
const NEAR_MM: f64 = 30.0;
/// Cuts whose middle lies this close across the strip to a flap's or a slit's are its own, mm: hinge dashes, reliefs.
const SEAT_MM: f64 = 7.0;
/// Steps of that search, mm.
const STEP_MM: f64 = 1.5;

/// One piece while it is labelled. Everything is in the frame it is drawn in.
pub(super) struct Labelling<'a> {
    /// Name of the piece.
    pub name: &'a str,
    /// Names of the pieces it is joined to, at its start and its end.
    pub neighbours: [Option<&'a str>; 2],
    /// Its cuts and marks, the contour first.
    pub paths: &'a [DrawnPath],
    /// Its passages, and each one's station in this frame.
    pub passages: &'a [(&'a Passage, f64)],
    /// The side it is drawn from.
    pub seen_from: Face,
    /// Stretches in which nothing may be written.
    pub clean: &'a [Range<f64>],
}

/// Labels of one piece.
pub(super) struct Written {
    /// Drawn or cut.
    pub paths: Vec<DrawnPath>,
    /// Texts that found no free place and are left out.
    pub left_out: Vec<String>,
    /// Texts that cross a cut, another text or the edge: counted from what is drawn.
    pub collisions: usize,
}

impl Labelling<'_> {
    /// Writes joint numbers, each with the fold of its flap, and the piece's name at both ends.
    pub fn write(&self, labels: &Labels) -> Written {
        let mut written = Written { paths: Vec::new(), left_out: Vec::new(), collisions: 0 };
        let drawn = matches!(labels, Labels::Strokes { .. });
        let (height_mm, clear_mm) = match labels {
            Labels::Strokes { height_mm } => (*height_mm, CLEAR_MM),
            Labels::Perforated { height_mm } => (*height_mm, CUT_CLEAR_MM),
            Labels::Notches | Labels::Nothing => return written,
        };
        let contour = self.paths[0].path.flatten(tolerance::FLATTEN_MM);
        let mut taken: Vec<Rect> = self.paths[1..].iter().map(|p| p.path.bounds()).collect();
        let mut texts: Vec<Vec<DrawnPath>> = Vec::new();
        let mut left_out: Vec<String> = Vec::new();
        let mut put = |text: &str, fold: Option<Fold>, joint: Option<&str>, corners: &dyn Fn(V2) -> Vec<P2>| {
            let lettered = letter(text, fold, height_mm);
            let boxed = |corner: P2| Rect { min: corner, max: corner + lettered.size };
            let free = corners(lettered.size).into_iter().map(boxed).find(|rect| {
                let grown = rect.grown(clear_mm);
                let clean = !self.clean.iter().any(|c| c.start < rect.max.x && rect.min.x < c.end);
                clean && inside(&grown, &contour) && !taken.iter().any(|t| t.overlaps(&grown))
            });
            if let Some(rect) = free {
                taken.push(rect);
                texts.push(made(labels, &lettered.strokes, &Motion::new(rect.min.coords, 0.0), joint));
            }
            free.is_some()
        };
        for (passage, station) in self.passages {
            let cuts = self.paths.iter().filter(|p| p.joint.as_ref() == Some(&passage.joint));
            let near = cuts.map(|p| p.path.bounds()).filter(|b| (b.center().x - station).abs() < NEAR_MM);
            let boxes: Vec<Rect> = near.collect();
            let mut number = |boxes: &[Rect]| {
                put(&passage.joint, self.fold(passage), Some(&passage.joint), &|size| beside(boxes, size))
            };
            // A number at every flap; where it is cut through, one is weakening enough.
            let seats = if drawn { passage.seats.as_slice() } else { &[] };
            let of_seat = |across: f64| -> Vec<Rect> {
                let own = |b: &&Rect| (b.center().y - across).abs() < SEAT_MM;
                boxes.iter().filter(own).copied().collect()
            };
            let numbered = seats.iter().filter(|s| number(&of_seat(s.across_mm))).count();
            if numbered == 0 && !number(&boxes) {
                left_out.push(passage.joint.clone());
            }
        }
        let bounds = Rect::around(&contour);
        for (end, neighbour) in self.neighbours.iter().enumerate() {
            let text = match neighbour {
                Some(other) if drawn => format!("PIECE {} - {other}", self.name),
                _ => format!("PIECE {}", self.name),
            };
            if !put(&text, None, None, &|size| from_end(&bounds, end == 1, size)) {
                left_out.push(text);
            }
        }
        written.left_out = left_out;
        written.collisions = collisions(&texts, self.paths, &contour);
        written.paths = texts.into_iter().flatten().collect();
        written
    }

    /// The fold of a passage's flaps, if it carries flaps.
    fn fold(&self, passage: &Passage) -> Option<Fold> {
        let toward = if passage.face == self.seen_from { Fold::Toward } else { Fold::Away };
        (passage.half == Half::Flap).then_some(toward)
    }
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

/// Places to try for a joint number, best first: those nearest to its cuts, across the strip before along it, since sheets lie on one another at a joint and hide what is
/// written there.
fn beside(cuts: &[Rect], size: V2) -> Vec<P2> {
    let around = cuts.iter().fold(Rect::EMPTY, |r, b| r.union(*b));
    let reach = around.grown(NEAR_MM);
    let mut places: Vec<(f64, P2)> = Vec::new();
    let columns = ((reach.width() - size.x) / STEP_MM).max(0.0) as usize;
    let rows = ((reach.height() - size.y) / STEP_MM).max(0.0) as usize;
    for column in 0..=columns {
        for row in 0..=rows {
            let corner = reach.min + V2::new(column as f64, row as f64) * STEP_MM;
            let rect = Rect { min: corner, max: corner + size };
            let apart = |b: &Rect| {
                let dx = (b.min.x - rect.max.x).max(rect.min.x - b.max.x).max(0.0);
                let dy = (b.min.y - rect.max.y).max(rect.min.y - b.max.y).max(0.0);
                let off = (rect.center().x - b.center().x).abs();
                2.0 * dx + dy + 0.1 * off
            };
            let nearest = cuts.iter().map(apart).fold(f64::INFINITY, f64::min);
            places.push((nearest, corner));
        }
    }
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    places.into_iter().map(|(_, corner)| corner).collect()
}

/// Places for a piece's name, from one of its ends inward.
fn from_end(bounds: &Rect, at_end: bool, size: V2) -> Vec<P2> {
    let columns = ((bounds.width() - size.x) / STEP_MM).max(0.0) as usize;
    let rows = ((bounds.height() - size.y) / STEP_MM).max(0.0) as usize;
    let half = if columns > 1 { columns / 2 } else { columns };
    (0..=half)
        .flat_map(|column| (0..=rows).map(move |row| (column as f64 * STEP_MM, row as f64 * STEP_MM)))
        .map(|(along, down)| {
            let x = if at_end { bounds.max.x - size.x - along } else { bounds.min.x + along };
            P2::new(x, bounds.max.y - size.y - down)
        })
        .collect()
}

/// How many texts cross a cut, another text or the edge, from their strokes.
fn collisions(texts: &[Vec<DrawnPath>], paths: &[DrawnPath], contour: &[P2]) -> usize {
    let strokes = |paths: &[DrawnPath]| -> Vec<[P2; 2]> {
        let points = paths.iter().map(|p| {
            let mut points = p.path.flatten(tolerance::FLATTEN_MM);
            if p.path.closed {
                points.extend(points.first().copied());
            }
            points
        });
        points.flat_map(|p| p.windows(2).map(|w| [w[0], w[1]]).collect::<Vec<_>>()).collect()
    };
    let cuts: Vec<DrawnPath> = paths.iter().filter(|p| p.role != Role::Mark).cloned().collect();
    let others = strokes(&cuts);
    let lettered: Vec<Vec<[P2; 2]>> = texts.iter().map(|t| strokes(t)).collect();
    let boxes: Vec<Rect> = lettered.iter().map(|l| Rect::around(l.iter().flatten())).collect();
    let cross = |own: &[[P2; 2]], other: &[[P2; 2]]| {
        own.iter().any(|a| other.iter().any(|b| segments_cross(a[0], a[1], b[0], b[1])))
    };
    (0..texts.len())
        .filter(|i| {
            let own = &lettered[*i];
            let near: Vec<[P2; 2]> =
                others.iter().filter(|s| Rect::around(*s).grown(1e-9).overlaps(&boxes[*i])).copied().collect();
            let texts_cross =
                (0..texts.len()).filter(|j| j != i && boxes[*j].overlaps(&boxes[*i])).any(|j| cross(own, &lettered[j]));
            texts_cross || cross(own, &near) || own.iter().flatten().any(|p| !contains(contour, *p))
        })
        .count()
}
