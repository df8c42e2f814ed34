//! Shapes ready for placing, and where one may not lie beside another.

use super::band::{self, Band};
use super::chain;
use crate::geom::{P2, Rect, V2};

/// A shape at one turn, grown by half the spacing, its box's lower left corner at the origin.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shape {
    pub(super) bands: Vec<Band>,
    /// Extent of its box.
    pub(super) size: V2,
    /// From the shape's frame to the turned outline's.
    pub(super) origin: V2,
}

impl Shape {
    /// What the loops enclose, at most `within` too large, then grown by `by`.
    pub(super) fn new(loops: &[Vec<P2>], within: f64, by: f64) -> Shape {
        let mut bands = band::bands(loops);
        if within > 0.0 {
            bands = bands.iter().map(|b| b.simplified(within)).collect();
        }
        if by > 0.0 {
            bands = bands.iter().map(|b| b.grown(by).simplified(0.25 * within)).collect();
        }
        let bounds = bands.iter().fold(Rect::EMPTY, |rect, b| {
            let (low, high) = (chain::range(&b.lower).0, chain::range(&b.upper).1);
            rect.with(P2::new(b.x0, low)).with(P2::new(b.x1, high))
        });
        let origin = bounds.min.coords;
        let bands = bands.iter().map(|b| b.shifted(-origin.x, -origin.y)).collect();
        Shape { bands, size: V2::new(bounds.width(), bounds.height()), origin }
    }
}

/// An open stretch of heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    pub(super) low: f64,
    pub(super) high: f64,
}

/// Heights at which `a` would overlap `b`, which lies at the origin, when `a` lies `dx` to its right: disjoint, from below, appended to `spans`.
pub(super) fn forbidden(a: &Shape, b: &Shape, dx: f64, spans: &mut Vec<Span>) {
    let first = spans.len();
    for p in &a.bands {
        for q in &b.bands {
            let (from, to) = (q.x0.max(p.x0 + dx), q.x1.min(p.x1 + dx));
            if to - from <= super::NARROW_MM {
                continue;
            }
            let high = chain::rise(&q.upper, &p.lower, dx, from, to);
            let low = -chain::rise(&p.upper, &q.lower, -dx, from - dx, to - dx);
            if high - low > super::NARROW_MM {
                spans.push(Span { low, high });
            }
        }
    }
    if spans.len() > first + 1 {
        join(spans, first);
    }
}

/// Joins what overlaps, from `first` on.
fn join(spans: &mut Vec<Span>, first: usize) {
    spans[first..].sort_by(|a, b| a.low.total_cmp(&b.low));
    let mut last = first;
    for k in first + 1..spans.len() {
        if spans[k].low < spans[last].high {
            spans[last].high = spans[last].high.max(spans[k].high);
        } else {
            last += 1;
            spans[last] = spans[k];
        }
    }
    spans.truncate(last + 1);
}
