//! Everything that is being placed, and where: bodies with poses in bays.

use super::shape::{Shape, Span, forbidden};
use std::rc::Rc;

/// Overlaps shallower than this count as touching, mm: far above round-off at 10 m (2e-12), a tenth of what validation forgives.
pub(super) const TOUCH_MM: f64 = 1e-7;

/// The room inside a container in use: whole boxes of bodies lie between 0 and its width and height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bay {
    /// Index into the containers.
    pub(super) container: usize,
    /// Room along x.
    pub(super) width: f64,
    /// Room along y.
    pub(super) height: f64,
}

impl Bay {
    /// The greatest x and y for the box of a shape; `None` when it is too large.
    pub(super) fn reach(&self, shape: &Shape) -> Option<(f64, f64)> {
        let (dx, dy) = (self.width - shape.size.x, self.height - shape.size.y);
        (dx >= -TOUCH_MM && dy >= -TOUCH_MM).then(|| (dx.max(0.0), dy.max(0.0)))
    }
}

/// Where a body lies: which of its turns, in which bay, and its box's lower left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    pub(super) turn: usize,
    pub(super) bay: usize,
    pub(super) x: f64,
    pub(super) y: f64,
}

/// The bay of what has no place yet.
const NOWHERE: usize = usize::MAX;

impl Pose {
    /// Of a body without a place.
    pub(super) const NONE: Pose = Pose { turn: 0, bay: NOWHERE, x: 0.0, y: 0.0 };

    pub(super) fn is_none(&self) -> bool {
        self.bay == NOWHERE
    }
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
    /// Bodies without a place, and no bays.
    pub(super) fn new(bodies: Vec<Body>) -> Scene {
        let poses = vec![Pose::NONE; bodies.len()];
        Scene { bodies, bays: Vec::new(), poses, looked: 0, spans: Vec::new() }
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

    /// Extent of a body's box, longer side first.
    pub(super) fn sides(&self, body: usize) -> (f64, f64) {
        let size = self.shape(body, 0).size;
        (size.x.max(size.y), size.x.min(size.y))
    }

    /// Area of a body's box.
    pub(super) fn box_area(&self, body: usize) -> f64 {
        let size = self.shape(body, 0).size;
        size.x * size.y
    }

    /// Bodies in a bay that can move.
    pub(super) fn movable(&self, bay: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.bodies.len()).filter(move |b| self.poses[*b].bay == bay && !self.bodies[*b].fixed)
    }

    /// Bodies that can move and have no place.
    pub(super) fn homeless(&self) -> Vec<usize> {
        (0..self.bodies.len()).filter(|b| self.poses[*b].is_none() && !self.bodies[*b].fixed).collect()
    }

    /// Greatest x of what lies in a bay and is an item: the first `items` bodies.
    pub(super) fn used(&self, bay: usize, items: usize) -> f64 {
        (0..items).filter(|b| self.poses[*b].bay == bay).map(|b| self.right(b)).fold(0.0, f64::max)
    }

    /// Takes a bay away; what lay in it has no place.
    pub(super) fn close(&mut self, bay: usize) {
        self.bays.remove(bay);
        for pose in &mut self.poses {
            match pose.bay {
                NOWHERE => {}
                b if b == bay => *pose = Pose::NONE,
                b if b > bay => pose.bay -= 1,
                _ => {}
            }
        }
    }

    /// How deep two bodies lie in each other: the shortest shift along y, or along x past each other's boxes, that parts them.
    pub(super) fn depth(&mut self, a: usize, b: usize) -> f64 {
        let (p, q) = (self.poses[a], self.poses[b]);
        if p.bay != q.bay || p.is_none() || (self.bodies[a].fixed && self.bodies[b].fixed) {
            return 0.0;
        }
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
