//! Looking along a vertical line: of all heights, which one is best for a body at this x?

use super::scene::{Bay, Pose, Scene, TOUCH_MM};
use super::shape::{Span, forbidden};

/// How much it matters that two bodies overlap.
pub(super) trait Weights {
    /// Weight of the overlap of bodies `a` and `b`, above 0.
    fn weight(&self, a: usize, b: usize) -> f64;
}

/// What is in the way at one x: overlapping costs depth times weight.
#[derive(Debug, Clone, Copy)]
struct Obstruction {
    span: Span,
    /// Parting sideways is never farther than this.
    past: f64,
    weight: f64,
}

/// A pose and what it costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub(super) pose: Pose,
    pub(super) cost: f64,
}

/// Looks for places; keeps its buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct Look {
    spans: Vec<Span>,
    obstructions: Vec<Obstruction>,
    heights: Vec<f64>,
}

impl Look {
    /// The best height for `body` at this turn and x, when that costs less than `bound`. Exact: the cost is a sum of tents over y, so it is least
    /// where a tent ends, or at the border.
    pub(super) fn along(
        &mut self,
        scene: &mut Scene,
        weights: &impl Weights,
        body: usize,
        (turn, bay, x): (usize, usize, f64),
        bound: f64,
    ) -> Option<Found> {
        scene.looked += 1;
        self.obstruct(scene, weights, body, (turn, bay, x));
        let (y, cost) = self.lowest(scene.bays[bay].height - scene.shape(body, turn).size.y, bound)?;
        Some(Found { pose: Pose { turn, bay, x, y }, cost })
    }

    /// Finds everything in the way of `body` at this turn and x.
    fn obstruct(&mut self, scene: &Scene, weights: &impl Weights, body: usize, (turn, bay, x): (usize, usize, f64)) {
        self.obstructions.clear();
        let shape = scene.shape(body, turn);
        let Bay { height, .. } = scene.bays[bay];
        let room = height - shape.size.y;
        for (other, pose) in scene.poses.iter().enumerate() {
            if pose.x >= x + shape.size.x - TOUCH_MM || pose.bay != bay || other == body {
                continue;
            }
            let beside = scene.shape(other, pose.turn);
            let past = (x + shape.size.x - pose.x).min(pose.x + beside.size.x - x);
            if past <= TOUCH_MM {
                continue;
            }
            self.spans.clear();
            forbidden(shape, beside, x - pose.x, &mut self.spans);
            let weight = weights.weight(body, other);
            for span in &self.spans {
                let span = Span { low: span.low + pose.y, high: span.high + pose.y };
                if span.high > TOUCH_MM && span.low < room - TOUCH_MM {
                    self.obstructions.push(Obstruction { span, past, weight });
                }
            }
        }
    }

    fn lowest(&mut self, room: f64, bound: f64) -> Option<(f64, f64)> {
        let room = room.max(0.0);
        self.heights.clear();
        self.heights.extend([0.0, room]);
        for o in &self.obstructions {
            self.heights.extend([o.span.low, o.span.high].into_iter().filter(|y| *y > 0.0 && *y < room));
        }
        let mut best: Option<(f64, f64)> = None;
        let mut least = bound;
        for &y in &self.heights {
            let mut cost = 0.0;
            for o in &self.obstructions {
                let depth = (y - o.span.low).min(o.span.high - y);
                if depth > TOUCH_MM {
                    cost += o.weight * depth.min(o.past);
                    if cost >= least {
                        break;
                    }
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
