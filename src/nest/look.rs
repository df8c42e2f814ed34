//! Looking along a vertical line: of all heights, which one is best for a body at this x?

use super::scene::{Pose, Scene, TOUCH_MM};
use super::shape::{Span, forbidden};

/// How much it matters that two bodies overlap.
pub(super) trait Weights {
    /// Weight of the overlap of bodies `a` and `b`, above 0.
    fn weight(&self, a: usize, b: usize) -> f64;
}

/// All overlaps matter alike.
pub(super) struct Alike;

impl Weights for Alike {
    fn weight(&self, _: usize, _: usize) -> f64 {
        1.0
    }
}

/// A line: the left border of a body's box at one of its turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub(super) turn: usize,
    pub(super) bay: usize,
    pub(super) x: f64,
}

/// A pose and what it costs: the sum of depths times weights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub(super) pose: Pose,
    pub(super) cost: f64,
}

/// Another body in the way on a line.
#[derive(Debug, Clone, Copy)]
struct Obstruction {
    span: Span,
    /// Parting sideways is never farther than this.
    past: f64,
    weight: f64,
}

impl Obstruction {
    fn cost(&self, y: f64) -> f64 {
        let depth = (y - self.span.low).min(self.span.high - y);
        if depth > TOUCH_MM { self.weight * depth.min(self.past) } else { 0.0 }
    }
}

/// Looks along lines; keeps its buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct Look {
    spans: Vec<Span>,
    obstructions: Vec<Obstruction>,
    heights: Vec<f64>,
}

impl Look {
    /// The best height for `body` on a line, when that costs less than `bound`. Exact: the cost is a sum of tents over y, so it is least where a tent
    /// ends, or at the border. `None` too when the body is too large for the bay.
    pub(super) fn along(
        &mut self,
        scene: &mut Scene,
        weights: &impl Weights,
        body: usize,
        line: Line,
        bound: f64,
    ) -> Option<Found> {
        scene.looked += 1;
        let (_, top) = scene.bays[line.bay].reach(scene.shape(body, line.turn))?;
        self.obstruct(scene, weights, body, line, top);
        let (y, cost) = self.cheapest(top, bound)?;
        Some(Found { pose: Pose { turn: line.turn, bay: line.bay, x: line.x, y }, cost })
    }

    /// The lowest height at which nothing is in the way.
    pub(super) fn free(&mut self, scene: &mut Scene, body: usize, line: Line) -> Option<Pose> {
        let found = self.along(scene, &Alike, body, line, f64::MIN_POSITIVE)?;
        Some(found.pose)
    }

    /// Finds everything in the way of `body` on a line.
    fn obstruct(&mut self, scene: &Scene, weights: &impl Weights, body: usize, line: Line, top: f64) {
        self.obstructions.clear();
        let shape = scene.shape(body, line.turn);
        let right = line.x + shape.size.x;
        for (other, pose) in scene.poses.iter().enumerate() {
            if pose.bay != line.bay || pose.x >= right - TOUCH_MM || other == body {
                continue;
            }
            let beside = scene.shape(other, pose.turn);
            let past = (right - pose.x).min(pose.x + beside.size.x - line.x);
            if past <= TOUCH_MM {
                continue;
            }
            self.spans.clear();
            forbidden(shape, beside, line.x - pose.x, &mut self.spans);
            let weight = weights.weight(body, other);
            for span in &self.spans {
                let span = Span { low: span.low + pose.y, high: span.high + pose.y };
                if span.high > TOUCH_MM && span.low < top - TOUCH_MM {
                    self.obstructions.push(Obstruction { span, past, weight });
                }
            }
        }
    }

    fn cheapest(&mut self, top: f64, bound: f64) -> Option<(f64, f64)> {
        self.heights.clear();
        self.heights.push(0.0);
        let ends = self.obstructions.iter().flat_map(|o| [o.span.low, o.span.high]);
        self.heights.extend(ends.filter(|y| *y > 0.0 && *y < top));
        self.heights.push(top);
        let mut best: Option<(f64, f64)> = None;
        let mut least = bound;
        for &y in &self.heights {
            let mut cost = 0.0;
            for obstruction in &self.obstructions {
                cost += obstruction.cost(y);
                if cost >= least {
                    break;
                }
            }
            if cost < least {
                least = cost;
                best = Some((y, cost));
                if cost == 0.0 {
                    break;
                }
            }
        }
        best
    }
}
