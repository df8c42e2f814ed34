//! How the strip lies around a connection point: which way each pass runs, on which face its partners lie, and what is behind them.

use crate::fit::Part;
use crate::geom::{P2, V2, contains, cross, signed_area};
use crate::ruffle::ConnectionPoint;

/// A side of the strip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Face {
    /// The side pieces are drawn and engraved on: seen with s to the right and w up. Walking along the strip it is on the right hand.
    Front,
    /// The other.
    Back,
}

/// Sheets that touch at a connection point lie s²/R apart at a distance s from it: this far away, mm, their order is plain, and no other joint interferes.
const LOOK_MM: f64 = 6.0;

/// Looking for what is behind a partner starts this far from the connection point, mm: farther than sheets that touch there.
const BEHIND_MM: f64 = 1.5;

impl Face {
    /// The opposite side.
    pub fn other(self) -> Face {
        match self {
            Face::Front => Face::Back,
            Face::Back => Face::Front,
        }
    }
}

/// One connection point, seen in the folded strip.
pub(super) struct Meeting<'a> {
    part: &'a Part,
    passes: &'a [usize],
}

impl<'a> Meeting<'a> {
    pub fn new(part: &'a Part, connection: &'a ConnectionPoint) -> Meeting<'a> {
        Meeting { part, passes: &connection.passes }
    }

    fn place(&self, k: usize) -> P2 {
        self.part.equilibrium.positions[self.part.ruffle.at(k)]
    }

    /// The strip from a pass outward, forward or backward, as far as [`LOOK_MM`]. Beyond its ends it runs on straight, as end tabs do.
    fn arm(&self, pass: usize, forward: bool) -> Vec<P2> {
        let last = self.part.ruffle.rest_lengths.len();
        let at = self.passes[pass];
        let next = |k: usize| if forward { (k < last).then_some(k + 1) } else { k.checked_sub(1) };
        let mut points = vec![self.place(at)];
        let (mut k, mut length) = (at, 0.0);
        while let Some(to) = next(k).filter(|_| length < LOOK_MM) {
            length += (self.place(to) - self.place(k)).norm();
            points.push(self.place(to));
            k = to;
        }
        if points.len() == 1 {
            let inner = if forward { at - 1 } else { at + 1 };
            points.push(points[0] + (points[0] - self.place(inner)).normalize() * LOOK_MM);
        }
        points
    }

    /// Direction of growing s at a pass.
    pub fn tangent(&self, pass: usize) -> V2 {
        let end = |forward| self.arm(pass, forward).last().copied().unwrap_or_default();
        (end(true) - end(false)).normalize()
    }

    /// +1 when two passes run the same way, -1 when they run against each other.
    pub fn alignment(&self, a: usize, b: usize) -> f64 {
        if self.tangent(a).dot(&self.tangent(b)) >= 0.0 { 1.0 } else { -1.0 }
    }

    /// The face of pass `a` on which pass `b` lies: the sign of the area between them.
    pub fn face_toward(&self, a: usize, b: usize) -> Face {
        let same_way = self.alignment(a, b) > 0.0;
        let between = |forward: bool| {
            let mut ring = self.arm(a, forward);
            ring.extend(self.arm(b, forward == same_way).iter().skip(1).rev());
            signed_area(&ring)
        };
        // Left of an arm seen outward is left of the strip ahead, and right of it behind.
        if between(true) - between(false) > 0.0 { Face::Back } else { Face::Front }
    }

    /// Partners of `a` in the order a flap of `a` goes through them, and the face of `a` it leaves by; `None` when `a` lies between its partners.
    pub fn partners(&self, a: usize) -> Option<(Face, Vec<usize>)> {
        let mut others: Vec<usize> = (0..self.passes.len()).filter(|b| *b != a).collect();
        let face = self.face_toward(a, *others.first()?);
        if others.iter().any(|b| self.face_toward(a, *b) != face) {
            return None;
        }
        // A partner with `a` and k more sheets on one side is the k-th.
        let sheets_before = |b: usize| {
            let toward_a = self.face_toward(b, a);
            (0..self.passes.len()).filter(|c| *c != b && self.face_toward(b, *c) == toward_a).count()
        };
        others.sort_by_key(|b| (sheets_before(*b), *b));
        Some((face, others))
    }

    /// Turn per length at a pass, rad/mm; infinite at an end of the strip.
    pub fn bend(&self, pass: usize) -> f64 {
        let (k, ruffle) = (self.passes[pass], &self.part.ruffle);
        if k == 0 || k == ruffle.rest_lengths.len() {
            return f64::INFINITY;
        }
        let (e1, e2) = (self.place(k) - self.place(k - 1), self.place(k + 1) - self.place(k));
        e1.angle(&e2) / (ruffle.rest_lengths[k - 1] + ruffle.rest_lengths[k])
    }

    /// How much room there is for the head of a flap that leaves `a` by `face`, mm: from the connection point straight on to the next sheet. `None` when that
    /// leads out of the ruffle.
    pub fn room_mm(&self, a: usize, face: Face) -> Option<f64> {
        let t = self.tangent(a);
        let right = V2::new(t.y, -t.x);
        let out = if face == Face::Front { right } else { -right };
        let at = self.place(self.passes[a]);
        let probe = at + out * BEHIND_MM;
        let inside = self.part.report.covered.iter().filter(|l| contains(l, probe)).count() % 2 == 1;
        let positions = &self.part.equilibrium.positions;
        let hit = |(i, j): (usize, usize)| {
            let (p, q) = (positions[i], positions[j]);
            let along = q - p;
            let turn = cross(out, along);
            if turn.abs() < 1e-12 {
                return None;
            }
            let (reach, share) = (cross(p - at, along) / turn, cross(p - at, out) / turn);
            ((0.0..=1.0).contains(&share) && reach > BEHIND_MM).then_some(reach)
        };
        let next = self.part.ruffle.segments().filter_map(hit).min_by(f64::total_cmp);
        next.filter(|_| inside)
    }

    /// The pass that carries the flap. Its head never goes to the outside, nor into a void too low for it (`head_mm`) when there is another; then the pass that
    /// bends most, since a flap on the convex side of a bend lifts by itself toward its partner and the slit lies in the flatter sheet. An end of the strip bends
    /// most of all: the other sheet lies inside of it.
    pub fn flap_pass(&self, head_mm: f64) -> (usize, Face, Vec<usize>) {
        let rank = |a: usize, face: Face| {
            let room = self.room_mm(a, face);
            (room.is_none(), room.is_some_and(|r| r < head_mm))
        };
        let outermost =
            (0..self.passes.len()).filter_map(|a| self.partners(a).map(|(face, through)| (a, face, through)));
        let best = outermost.min_by(|x, y| {
            rank(x.0, x.1).cmp(&rank(y.0, y.1)).then(self.bend(y.0).total_cmp(&self.bend(x.0))).then(x.0.cmp(&y.0))
        });
        // Sheets that lie on one another have an outermost; where a strip passes through itself there may be none.
        best.unwrap_or_else(|| (0, self.face_toward(0, 1), (1..self.passes.len()).collect()))
    }
}
