//! Where a filled outline stays empty, and where a split would help.

use super::Part;
use crate::cut::Outline;
use crate::geom::{P2, Rect, contains, signed_area};

/// A connected stretch of an outline that stays empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Its share of the outline's area.
    pub share: f64,
    /// Its middle, plane frame, mm.
    pub at: P2,
}

/// The narrowest place between an empty stretch and the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neck {
    /// One end, on the outline, plane frame, mm. The smaller side lies on the right of the way to the other end.
    pub from: P2,
    /// The other.
    pub to: P2,
    /// Share of the outline's area on the smaller side.
    pub share: f64,
}

/// The outline is looked at in this many cells along its longer side.
const CELLS: usize = 120;
/// Both sides of a neck hold at least this share of the outline: less is a corner.
const MIN_SIDE: f64 = 0.08;
/// A neck is narrower than this many times the side of a square as large as the smaller side: two legs part where they are about as wide as they are long.
const NARROW: f64 = 0.9;
/// A neck that does not part the empty stretch from most of the outline has to be narrower by this much to be taken.
const ELSEWHERE: f64 = 1.5;
/// Points on the outline between which necks are looked for.
const BORDER_POINTS: usize = 160;
/// Points of a chord that must lie inside the outline.
const CHORD_POINTS: usize = 16;

/// The largest stretch of the part's outline that its strip leaves empty, all of it thicker than a cell (1/120 of the outline's longer side); none where there is none.
pub fn largest_gap(part: &Part) -> Option<Gap> {
    let bounds = part.outline.bounds();
    let side = bounds.width().max(bounds.height()) / CELLS as f64;
    let (columns, rows) = ((bounds.width() / side) as usize + 1, (bounds.height() / side) as usize + 1);
    let middle = |cell: usize| {
        bounds.min + nalgebra::Vector2::new((cell % columns) as f64 + 0.5, (cell / columns) as f64 + 0.5) * side
    };
    let covered = |p: P2| part.report.covered.iter().filter(|l| contains(l, p)).count() % 2 == 1;
    let inside: Vec<bool> = (0..columns * rows).map(|c| part.outline.contains(middle(c))).collect();
    let mut empty: Vec<bool> = (0..columns * rows).map(|c| inside[c] && !covered(middle(c))).collect();
    let whole = inside.iter().filter(|i| **i).count();
    let mut largest: Option<Gap> = None;
    for seed in 0..empty.len() {
        if !std::mem::replace(&mut empty[seed], false) {
            continue;
        }
        let mut stretch = vec![seed];
        let mut next = 0;
        while let Some(cell) = stretch.get(next).copied() {
            next += 1;
            let (column, row) = (cell % columns, cell / columns);
            let beside = [
                (column > 0).then(|| cell - 1),
                (column + 1 < columns).then(|| cell + 1),
                (row > 0).then(|| cell - columns),
                (row + 1 < rows).then(|| cell + columns),
            ];
            for other in beside.into_iter().flatten() {
                if std::mem::replace(&mut empty[other], false) {
                    stretch.push(other);
                }
            }
        }
        let share = stretch.len() as f64 / whole as f64;
        if largest.is_none_or(|l| share > l.share) {
            let sum = stretch.iter().map(|c| middle(*c).coords).sum::<nalgebra::Vector2<f64>>();
            largest = Some(Gap { share, at: P2::from(sum / stretch.len() as f64) });
        }
    }
    largest
}

/// The chord of the outline that parts most with least width (over the square root of the smaller side's area), rather one with `gap` on its smaller side. None where the outline has no place narrower than its parts, and where a hole lies in the way.
pub fn neck(outline: &Outline, gap: P2) -> Option<Neck> {
    let border = resampled(&outline.outer, BORDER_POINTS);
    let (n, whole) = (border.len(), outline.area());
    let mut best: Option<(f64, Neck)> = None;
    for i in 0..n {
        for j in i + 2..n {
            let (from, to) = (border[i], border[j]);
            let width = (to - from).norm();
            let one = signed_area(&border[i..=j]);
            let other: Vec<P2> = border[j..].iter().chain(&border[..=i]).copied().collect();
            let (less, parts_it) = if 2.0 * one < whole {
                (one, contains(&border[i..=j], gap))
            } else {
                (whole - one, contains(&other, gap))
            };
            let narrow = width / less.max(f64::MIN_POSITIVE).sqrt();
            let score = narrow * if parts_it { 1.0 } else { ELSEWHERE };
            let better = best.as_ref().is_none_or(|(b, _)| score < *b);
            if better && less >= MIN_SIDE * whole && narrow < NARROW && is_chord(outline, from, to) {
                // The border runs counter-clockwise: what it passes from the first point to the second lies on the right of the way between them.
                let (from, to) = if 2.0 * one < whole { (from, to) } else { (to, from) };
                best = Some((score, Neck { from, to, share: less / whole }));
            }
        }
    }
    best.map(|(_, neck)| neck)
}

/// True when the line between two border points runs inside.
fn is_chord(outline: &Outline, from: P2, to: P2) -> bool {
    (1..CHORD_POINTS).all(|k| outline.contains(from + (to - from) * (k as f64 / CHORD_POINTS as f64)))
}

/// Points along a loop, at most twice `count`: its corners, unless they are too many, and points between them.
fn resampled(points: &[P2], count: usize) -> Vec<P2> {
    let n = points.len();
    let sides: Vec<f64> = (0..n).map(|i| (points[(i + 1) % n] - points[i]).norm()).collect();
    let step = (sides.iter().sum::<f64>() / count as f64).max(Rect::around(points).width() * 1e-9);
    let mut border = Vec::with_capacity(count + n);
    for (i, side) in sides.iter().enumerate() {
        let parts = (side / step).ceil().max(1.0) as usize;
        border.extend((0..parts).map(|k| points[i] + (points[(i + 1) % n] - points[i]) * (k as f64 / parts as f64)));
    }
    // Fine outlines have more corners than points are wanted.
    let skip = border.len().div_ceil(2 * count);
    border.into_iter().step_by(skip).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[(f64, f64)]) -> Outline {
        Outline { outer: points.iter().map(|(x, y)| P2::new(*x, *y)).collect(), holes: Vec::new() }
    }

    #[test]
    fn a_dumbbell_is_parted_at_its_neck_and_a_square_is_not() {
        let dumbbell = polygon(&[
            (0.0, 0.0),
            (80.0, 0.0),
            (80.0, 60.0),
            (50.0, 70.0),
            (50.0, 80.0),
            (80.0, 90.0),
            (80.0, 140.0),
            (0.0, 140.0),
            (0.0, 90.0),
            (30.0, 80.0),
            (30.0, 70.0),
            (0.0, 60.0),
        ]);
        let neck = neck(&dumbbell, P2::new(10.0, 130.0)).unwrap();
        assert!((neck.to - neck.from).norm() < 20.5, "{neck:?}");
        assert!([neck.from, neck.to].iter().all(|p| (69.0..81.0).contains(&p.y)) && (0.4..0.5).contains(&neck.share));
        // The upper half, a little smaller, lies ahead: on the right of a way to the left.
        assert!(neck.to.x < neck.from.x);
        let square = polygon(&[(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)]);
        assert_eq!(super::neck(&square, P2::new(10.0, 90.0)), None);
    }
}
