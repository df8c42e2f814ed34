//! What labels look like: joint numbers, fold marks and piece names as strokes, dashes or notches.

use super::edge::Notch;
use crate::drawing::{DrawnPath, KerfSide, Role, text_paths, text_width};
use crate::geom::{Motion, P2, Path, V2};

/// How pieces are labelled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Labels {
    /// Lettering on the surface, engraved or drawn with a pen.
    Strokes {
        /// Height of capitals and digits, mm.
        height_mm: f64,
    },
    /// Lettering cut through in dashes, where the surface takes no mark.
    Perforated {
        /// Height of capitals and digits, mm.
        height_mm: f64,
    },
    /// Notches in the edge at every joint: deep ones count five, shallow ones one; in the lower edge for a flap that folds toward you, in the upper for one that folds
    /// away, and so for the slits they enter. Of the two joints of a lap only the first is told.
    Notches,
    /// Nothing on the sheet; the assembly sheets show which joint is which.
    Nothing,
}

impl Labels {
    /// Height of lettering that is engraved or drawn, mm; `None` for labels that are cut and for none.
    pub(super) fn drawn_mm(&self) -> Option<f64> {
        match self {
            Labels::Strokes { height_mm } => Some(*height_mm),
            Labels::Perforated { .. } | Labels::Notches | Labels::Nothing => None,
        }
    }
}

/// Which way a flap folds, seen from the side a piece is drawn on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fold {
    /// Toward the reader: a solid triangle.
    Toward,
    /// Away: a hollow one.
    Away,
}

/// Dashes of perforated lettering and what is left between them, mm: short enough to read, far enough apart to hold.
const DASH_MM: f64 = 0.6;
const DASH_GAP_MM: f64 = 0.7;
/// A solid triangle is filled with this many lines.
const FILL_LINES: usize = 5;

/// Notches of felt, mm: wide enough for its kerf, shallow beside deep told at a glance.
const NOTCH_WIDTH_MM: f64 = 2.5;
const NOTCH_PITCH_MM: f64 = 4.0;
const SHALLOW_MM: f64 = 2.0;
const DEEP_MM: f64 = 4.0;
/// What a deep notch counts.
const DEEP_COUNTS: u32 = 5;

/// A label before it has its place: its strokes, standing on y = 0 from x = 0, and its size.
pub(super) struct Lettered {
    pub strokes: Vec<Path>,
    pub size: V2,
}

/// Letters `text`, behind the mark of a fold if there is one.
pub(super) fn letter(text: &str, fold: Option<Fold>, height_mm: f64) -> Lettered {
    let mut strokes = Vec::new();
    let mut width = 0.0;
    if let Some(fold) = fold {
        strokes = triangle(fold, height_mm);
        width = 1.3 * height_mm;
    }
    let along = Motion::translation(width, 0.0);
    strokes.extend(text_paths(text, height_mm).iter().map(|p| p.moved(&along)));
    Lettered { strokes, size: V2::new(width + text_width(text, height_mm), height_mm) }
}

/// A triangle as high and as wide as the letters.
fn triangle(fold: Fold, height: f64) -> Vec<Path> {
    let at = |x: f64, y: f64| P2::new(x * height, y * height);
    let mut strokes = vec![Path::open([at(0.0, 0.0), at(1.0, 0.0), at(0.5, 1.0), at(0.0, 0.0)])];
    if fold == Fold::Toward {
        strokes.extend((1..=FILL_LINES).map(|i| {
            let y = i as f64 / (FILL_LINES + 1) as f64;
            let ends = [at(0.5 * y, y), at(1.0 - 0.5 * y, y)];
            Path::open(if i % 2 == 0 { ends } else { [ends[1], ends[0]] })
        }));
    }
    strokes
}

/// Strokes as they are made: drawn, or cut in dashes.
pub(super) fn made(labels: &Labels, strokes: &[Path], motion: &Motion, joint: Option<&str>) -> Vec<DrawnPath> {
    let joint = joint.map(str::to_owned);
    let drawn = |path: Path, role: Role| DrawnPath { path, role, kerf: KerfSide::On, joint: joint.clone() };
    let placed = strokes.iter().map(|s| s.moved(motion));
    match labels {
        Labels::Perforated { .. } => placed.flat_map(|s| dashes(&s)).map(|p| drawn(p, Role::Hole)).collect(),
        _ => placed.map(|p| drawn(p, Role::Label)).collect(),
    }
}

/// A stroke in dashes, a gap at each end so that strokes that meet do not cut anything out.
fn dashes(stroke: &Path) -> Vec<Path> {
    let points = stroke.flatten(0.05);
    let length: f64 = points.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
    let pitch = DASH_MM + DASH_GAP_MM;
    let count = ((length - DASH_GAP_MM) / pitch).round().max(1.0);
    let spare = (length - count * DASH_MM) / (count + 1.0);
    let at = |s: f64| {
        let mut left = s;
        for p in points.windows(2) {
            let step = (p[1] - p[0]).norm();
            if left <= step {
                return p[0] + (p[1] - p[0]) * (left / step.max(1e-12));
            }
            left -= step;
        }
        points[points.len() - 1]
    };
    if spare <= 0.0 {
        return Vec::new();
    }
    (0..count as usize)
        .map(|i| {
            let from = spare + i as f64 * (DASH_MM + spare);
            Path::open([at(from), at(from + DASH_MM)])
        })
        .collect()
}

/// The notches of joint `number` about a station, moved in between two others where it has to be; `None` where they do not fit.
pub(super) fn notches(number: u32, at_mm: f64, between: (f64, f64), fold: Fold) -> Option<Vec<Notch>> {
    let deep = (number / DEEP_COUNTS) as usize;
    let count = deep + (number % DEEP_COUNTS) as usize;
    let half = 0.5 * NOTCH_PITCH_MM * count as f64;
    let (least, most) = (between.0 + half, between.1 - half);
    let notch = |i: usize| Notch {
        at_mm: at_mm.clamp(least, most) + (i as f64 - 0.5 * (count - 1) as f64) * NOTCH_PITCH_MM,
        width_mm: NOTCH_WIDTH_MM,
        depth_mm: if i < deep { DEEP_MM } else { SHALLOW_MM },
        upper: fold == Fold::Away,
    };
    (least <= most).then(|| (0..count).map(notch).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Rect;

    #[test]
    fn a_fold_mark_stands_before_the_number_and_solid_has_more_strokes_than_hollow() {
        let plain = letter("A7", None, 3.0);
        let toward = letter("A7", Some(Fold::Toward), 3.0);
        let away = letter("A7", Some(Fold::Away), 3.0);
        assert_eq!(toward.size, away.size);
        assert!(toward.size.x > plain.size.x + 3.0 && toward.strokes.len() > away.strokes.len() + 3);
        let bounds = toward.strokes.iter().fold(Rect::EMPTY, |r, p| r.union(p.bounds()));
        assert!(bounds.min.x > -1e-9 && bounds.max.x < toward.size.x + 0.1 && bounds.max.y < 3.1);
    }

    #[test]
    fn perforated_letters_are_short_open_cuts_that_do_not_meet() {
        let lettered = letter("A8", Some(Fold::Toward), 6.0);
        let cuts = made(&Labels::Perforated { height_mm: 6.0 }, &lettered.strokes, &Motion::identity(), Some("A8"));
        assert!(cuts.len() > 30 && cuts.iter().all(|c| c.role == Role::Hole && !c.path.closed));
        assert!(cuts.iter().all(|c| c.path.length() <= DASH_MM + 1e-9));
        // No stroke's dashes touch.
        for stroke in &lettered.strokes {
            let dashes = dashes(stroke);
            let gap = |p: &[Path]| (p[1].start().unwrap() - p[0].end().unwrap()).norm();
            assert!(dashes.windows(2).all(|p| gap(p) > 0.3), "{dashes:?}");
        }
    }

    #[test]
    fn notches_count_in_fives_and_ones() {
        let seven = notches(7, 50.0, (0.0, 100.0), Fold::Away).unwrap();
        assert_eq!(seven.iter().map(|n| n.depth_mm).collect::<Vec<_>>(), [4.0, 2.0, 2.0]);
        assert!(seven.iter().all(|n| n.upper));
        let near_the_end = notches(9, 0.0, (-7.0, 100.0), Fold::Toward).unwrap();
        assert!(near_the_end[0].at_mm > -7.0 && !near_the_end[0].upper);
        assert!(notches(9, 0.0, (-7.0, 7.0), Fold::Toward).is_none());
    }
}
