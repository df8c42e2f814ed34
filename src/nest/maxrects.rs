//! One container being filled with boxes: the maximal-rectangles method (J. Jylänki, "A thousand ways to pack the bin", 2010, section 6).
//!
//! The empty space is kept as the list of all maximal empty rectangles, which overlap each other; a box goes to the lower left corner of
//! the one that a [`Rule`] likes best.

use crate::geom::{P2, Rect, V2};

/// Boxes that fit exactly must survive the round-off of turning and adding (1e-13 at a metre); far below the validator's own slack.
const FIT_SLACK_MM: f64 = 1e-9;

/// Which empty rectangle a box prefers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rule {
    /// The one that leaves least along its tighter side.
    ShortSide,
    /// The one that leaves least along its looser side.
    LongSide,
    /// The one with the least area.
    Area,
    /// The one that keeps the used length along x shortest, then lies lowest.
    Left,
}

impl Rule {
    pub(super) const ALL: [Rule; 4] = [Rule::ShortSide, Rule::Left, Rule::LongSide, Rule::Area];

    /// Smaller is better, first number first.
    fn score(self, free: &Rect, size: V2) -> [f64; 2] {
        let left = V2::new(free.width() - size.x, free.height() - size.y);
        match self {
            Rule::ShortSide => [left.x.min(left.y), left.x.max(left.y)],
            Rule::LongSide => [left.x.max(left.y), left.x.min(left.y)],
            Rule::Area => [free.width() * free.height(), left.x.min(left.y)],
            Rule::Left => [free.min.x + size.x, free.min.y],
        }
    }
}

/// Where a box could go, and how well that suits the rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    pub(super) corner: P2,
    pub(super) score: [f64; 2],
}

impl Spot {
    pub(super) fn better_than(&self, other: &Spot) -> bool {
        self.score[0].total_cmp(&other.score[0]).then(self.score[1].total_cmp(&other.score[1])).is_lt()
    }
}

/// A container being filled, from (0, 0).
pub(super) struct Bin {
    /// Every maximal empty rectangle.
    free: Vec<Rect>,
}

impl Bin {
    pub(super) fn new(size: V2) -> Bin {
        Bin { free: vec![Rect::from_size(size.x, size.y)] }
    }

    /// The best place for a box of `size`, if there is one.
    pub(super) fn best(&self, size: V2, rule: Rule) -> Option<Spot> {
        let mut best: Option<Spot> = None;
        for free in &self.free {
            if size.x > free.width() + FIT_SLACK_MM || size.y > free.height() + FIT_SLACK_MM {
                continue;
            }
            let spot = Spot { corner: free.min, score: rule.score(free, size) };
            if best.is_none_or(|b| spot.better_than(&b)) {
                best = Some(spot);
            }
        }
        best
    }

    /// Takes a box out of the empty space.
    pub(super) fn fill(&mut self, taken: Rect) {
        let shrunk = taken.grown(-FIT_SLACK_MM);
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
    [left, right, below, above].into_iter().filter(|r| r.width() > FIT_SLACK_MM && r.height() > FIT_SLACK_MM)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn four_quarters_fill_a_bin_exactly() {
        for rule in Rule::ALL {
            let mut bin = Bin::new(V2::new(0.3, 0.3));
            let size = V2::new(0.15, 0.1 + 0.05);
            for _ in 0..4 {
                let spot = bin.best(size, rule).expect("room is left");
                bin.fill(Rect { min: spot.corner, max: spot.corner + size });
            }
            assert!(bin.best(V2::new(0.001, 0.001), rule).is_none());
        }
    }

    proptest! {
        #[test]
        fn boxes_never_overlap_and_an_empty_rectangle_is_never_missed(
            sizes in prop::collection::vec((1.0..40.0f64, 1.0..40.0f64), 1..25),
            rule in prop::sample::select(Rule::ALL.to_vec()),
        ) {
            let mut bin = Bin::new(V2::new(100.0, 80.0));
            let mut taken: Vec<Rect> = Vec::new();
            for (w, h) in sizes {
                let size = V2::new(w, h);
                match bin.best(size, rule) {
                    Some(spot) => {
                        let rect = Rect { min: spot.corner, max: spot.corner + size };
                        prop_assert!(Rect::from_size(100.0, 80.0).holds(&rect, 1e-6));
                        prop_assert!(taken.iter().all(|t| !t.overlaps(&rect.grown(-1e-6))));
                        bin.fill(rect);
                        taken.push(rect);
                    }
                    None => {
                        // A free place's lower left corner can slide left and down until it meets right and upper sides of boxes.
                        let xs: Vec<f64> = taken.iter().map(|t| t.max.x).chain([0.0]).collect();
                        let ys: Vec<f64> = taken.iter().map(|t| t.max.y).chain([0.0]).collect();
                        for x in &xs {
                            for y in &ys {
                                let rect = Rect { min: P2::new(*x, *y), max: P2::new(x + w, y + h) };
                                let free = Rect::from_size(100.0, 80.0).holds(&rect, 0.0)
                                    && taken.iter().all(|t| !t.overlaps(&rect));
                                prop_assert!(!free, "{rect:?} is free but was not offered");
                            }
                        }
                    }
                }
            }
        }
    }
}
