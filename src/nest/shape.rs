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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{contains, segments_cross};
    use proptest::prelude::*;

    prop_compose! {
        fn star()(radii in prop::collection::vec(2.0..9.0f64, 3..12)) -> Vec<P2> {
            let n = radii.len() as f64;
            let corner = |(k, r): (usize, &f64)| {
                let a = k as f64 / n * std::f64::consts::TAU;
                P2::new(r * a.cos(), r * a.sin())
            };
            radii.iter().enumerate().map(corner).collect()
        }
    }

    fn overlap(a: &[P2], b: &[P2]) -> bool {
        let edge = |p: &[P2], i: usize| (p[i], p[(i + 1) % p.len()]);
        let crosses = |i: usize| {
            let (p, q) = edge(a, i);
            (0..b.len()).map(|j| edge(b, j)).any(|(c, d)| segments_cross(p, q, c, d))
        };
        contains(a, b[0]) || contains(b, a[0]) || (0..a.len()).any(crosses)
    }

    #[test]
    fn a_box_may_not_lie_where_another_is() {
        let bar = |w, h| vec![P2::new(0.0, 0.0), P2::new(w, 0.0), P2::new(w, h), P2::new(0.0, h)];
        let (a, b) = (Shape::new(&[bar(10.0, 4.0)], 0.0, 0.0), Shape::new(&[bar(8.0, 6.0)], 0.0, 1.0));
        assert_eq!((b.size, b.origin), (V2::new(10.0, 8.0), V2::new(-1.0, -1.0)));
        let spans = |dx| {
            let mut spans = Vec::new();
            forbidden(&a, &b, dx, &mut spans);
            spans
        };
        assert_eq!(spans(5.0), [Span { low: -4.0, high: 8.0 }]);
        assert_eq!(spans(10.0), []);
        assert_eq!(spans(-10.0), []);
    }

    proptest! {
        #[test]
        fn heights_are_forbidden_exactly_where_shapes_overlap(a in star(), b in star(), dx in -15.0..15.0f64) {
            let (s, t) = (Shape::new(std::slice::from_ref(&a), 0.0, 0.0), Shape::new(std::slice::from_ref(&b), 0.0, 0.0));
            let mut spans = Vec::new();
            forbidden(&s, &t, dx, &mut spans);
            prop_assert!(spans.windows(2).all(|w| w[0].high < w[1].low));
            let there: Vec<P2> = b.iter().map(|p| p - t.origin).collect();
            for k in 0..60 {
                let y = -20.0 + 40.0 * (f64::from(k) + 0.37) / 60.0;
                let here: Vec<P2> = a.iter().map(|p| p - s.origin + V2::new(dx, y)).collect();
                let inside = spans.iter().any(|span| span.low < y && y < span.high);
                let near = spans.iter().any(|span| (span.low - y).abs() < 1e-4 || (span.high - y).abs() < 1e-4);
                prop_assert!(near || inside == overlap(&here, &there), "at {y}: {spans:?}");
            }
        }
    }
}
