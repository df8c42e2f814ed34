//! The empty space beside boxes, as the list of all maximal empty rectangles, which overlap each other (J. Jylänki, "A thousand ways to pack the bin",
//! 2010, section 6).

use crate::geom::{P2, Rect, V2};

/// Rectangles thinner than this are round-off (1e-13 at a metre), mm.
const THIN_MM: f64 = 1e-9;

/// What is left of a rectangle.
pub(super) struct Empty {
    free: Vec<Rect>,
}

impl Empty {
    /// A rectangle from (0, 0), all empty.
    pub(super) fn new(size: V2) -> Empty {
        Empty { free: vec![Rect::from_size(size.x, size.y)] }
    }

    /// The empty rectangle with the largest area, if anything is left.
    pub(super) fn largest(&self) -> Option<Rect> {
        let area = |r: &Rect| r.width() * r.height();
        self.free.iter().copied().max_by(|a, b| area(a).total_cmp(&area(b)))
    }

    /// Takes a box out of the empty space.
    pub(super) fn fill(&mut self, taken: Rect) {
        let shrunk = taken.grown(-THIN_MM);
        let mut kept = Vec::with_capacity(self.free.len() + 4);
        let mut cut = Vec::new();
        for free in &self.free {
            if free.overlaps(&shrunk) {
                cut.extend(around(free, &taken));
            } else {
                kept.push(*free);
            }
        }
        for (i, rect) in cut.iter().enumerate() {
            // Of equal rectangles the first stays.
            let covered = kept.iter().any(|k| k.holds(rect, 0.0))
                || cut.iter().enumerate().any(|(j, c)| j != i && c.holds(rect, 0.0) && (j < i || !rect.holds(c, 0.0)));
            if !covered {
                kept.push(*rect);
            }
        }
        self.free = kept;
    }
}

/// The maximal rectangles of `free` beside, below and above `taken`.
fn around(free: &Rect, taken: &Rect) -> impl Iterator<Item = Rect> {
    let left = Rect { max: P2::new(taken.min.x, free.max.y), ..*free };
    let right = Rect { min: P2::new(taken.max.x, free.min.y), ..*free };
    let below = Rect { max: P2::new(free.max.x, taken.min.y), ..*free };
    let above = Rect { min: P2::new(free.min.x, taken.max.y), ..*free };
    [left, right, below, above].into_iter().filter(|r| r.width() > THIN_MM && r.height() > THIN_MM)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_largest_empty_rectangle_is_empty_and_none_is_larger(
            boxes in prop::collection::vec((0.0..90.0f64, 0.0..70.0f64, 1.0..40.0f64, 1.0..40.0f64), 1..12),
        ) {
            let all = Rect::from_size(100.0, 80.0);
            let mut empty = Empty::new(V2::new(100.0, 80.0));
            let taken: Vec<Rect> =
                boxes.iter().map(|(x, y, w, h)| Rect { min: P2::new(*x, *y), max: P2::new(x + w, y + h) }).collect();
            taken.iter().for_each(|t| empty.fill(*t));
            let largest = empty.largest().map_or(0.0, |r| {
                assert!(all.holds(&r, 1e-6) && taken.iter().all(|t| !t.overlaps(&r.grown(-1e-6))));
                r.width() * r.height()
            });
            // The largest one's sides lie on the border or on sides of boxes.
            let sides = |f: &dyn Fn(&Rect) -> [f64; 2], end: f64| -> Vec<f64> {
                taken.iter().flat_map(f).chain([0.0, end]).filter(|v| *v <= end).collect()
            };
            let (xs, ys) = (sides(&|t| [t.min.x, t.max.x], 100.0), sides(&|t| [t.min.y, t.max.y], 80.0));
            for (x0, x1) in xs.iter().flat_map(|a| xs.iter().map(move |b| (*a, *b))).filter(|(a, b)| a < b) {
                for (y0, y1) in ys.iter().flat_map(|a| ys.iter().map(move |b| (*a, *b))).filter(|(a, b)| a < b) {
                    let rect = Rect { min: P2::new(x0, y0), max: P2::new(x1, y1) };
                    let free = taken.iter().all(|t| !t.overlaps(&rect));
                    prop_assert!(!free || rect.width() * rect.height() <= largest + 1e-6, "{rect:?}");
                }
            }
        }
    }
}
