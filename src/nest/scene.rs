//! Everything that is being placed, on every container in use: bays side by side along x, each a rectangle that holds whole items.

use super::shape::{Shape, Span, forbidden};
use std::rc::Rc;

/// Overlaps shallower than this count as touching, mm: far above round-off at 10 m (2e-12), a tenth of what validation forgives.
pub(super) const TOUCH_MM: f64 = 1e-7;

/// A container in use.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bay {
    /// Index into the containers.
    pub(super) container: usize,
    /// Left border in the scene.
    pub(super) x: f64,
    /// Room along x.
    pub(super) width: f64,
    /// Room along y, from 0.
    pub(super) height: f64,
}

/// Where an item lies: which of its turns, in which bay, and its box's lower left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    pub(super) turn: usize,
    pub(super) bay: usize,
    pub(super) x: f64,
    pub(super) y: f64,
}

/// Something that is placed, or lies there for good.
#[derive(Debug, Clone)]
pub(super) struct Body {
    /// Its shape at each of its turns.
    pub(super) turns: Rc<[Shape]>,
    /// It never moves: a clamp, a hole, an item fixed by the user.
    pub(super) fixed: bool,
}

/// Bodies, bays and where everything lies.
#[derive(Debug, Clone)]
pub(super) struct Scene {
    pub(super) bodies: Vec<Body>,
    pub(super) bays: Vec<Bay>,
    pub(super) poses: Vec<Pose>,
    /// Lines looked along so far: the measure of effort.
    pub(super) looked: u64,
    spans: Vec<Span>,
}

impl Scene {
    pub(super) fn new(bodies: Vec<Body>, bays: Vec<Bay>, poses: Vec<Pose>) -> Scene {
        Scene { bodies, bays, poses, looked: 0, spans: Vec::new() }
    }

    /// The shape of a body at one of its turns.
    pub(super) fn shape(&self, body: usize, turn: usize) -> &Shape {
        &self.bodies[body].turns[turn]
    }

    /// The shape of a body as it lies.
    pub(super) fn lying(&self, body: usize) -> &Shape {
        self.shape(body, self.poses[body].turn)
    }

    /// Right border of a body's box.
    pub(super) fn right(&self, body: usize) -> f64 {
        self.poses[body].x + self.lying(body).size.x
    }

    /// Range of `x` for a shape in a bay; `None` when it is too large for it.
    pub(super) fn reach(&self, shape: &Shape, bay: &Bay) -> Option<(f64, f64)> {
        let (dx, dy) = (bay.width - shape.size.x, bay.height - shape.size.y);
        (dx >= -TOUCH_MM && dy >= -TOUCH_MM).then(|| (bay.x, bay.x + dx.max(0.0)))
    }

    /// How deep two bodies lie in each other: the shortest shift along y, or along x past each other's boxes, that parts them.
    pub(super) fn depth(&mut self, a: usize, b: usize) -> f64 {
        let (p, q) = (self.poses[a], self.poses[b]);
        let (s, t) = (&self.bodies[a].turns[p.turn], &self.bodies[b].turns[q.turn]);
        let past = (p.x + s.size.x - q.x).min(q.x + t.size.x - p.x);
        if past <= TOUCH_MM || p.y + s.size.y <= q.y || q.y + t.size.y <= p.y {
            return 0.0;
        }
        self.spans.clear();
        forbidden(s, t, p.x - q.x, &mut self.spans);
        let y = p.y - q.y;
        let up_or_down = self.spans.iter().map(|s| (y - s.low).min(s.high - y)).fold(0.0, f64::max);
        let depth = up_or_down.min(past);
        if depth > TOUCH_MM { depth } else { 0.0 }
    }
}
