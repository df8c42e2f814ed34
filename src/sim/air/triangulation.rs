//! The triangulated void: who neighbours whom, and the flips that keep its triangles fat.
//!
//! The triangulation is that of a sphere: the plane with one vertex more, at infinity (paper section 4.1.3). It has no position. An *infinite* triangle joins it to an edge that the outside
//! begins at; such triangles have a constant quality and cannot invert, so they never push, but they have neighbours like all others, and with them every edge has two sides. An edge is
//! flipped where the worse of the two triangles gets better. Beside infinity that reads: a triangle worse than [`INFINITE_QUALITY`] is given up to the outside, and a corner
//! that the outside reaches into is filled by a triangle better than it.
//!
//! Two things the paper leaves open are decided here. A triangle is given up only across its longest side: the slivers between two loops that touch from outside are bad as well, and given up
//! from the mouth inwards they would let the loops pass through each other. And a corner is filled only when nothing else reaches into it.

use super::triangle::{area, quality};
use crate::geom::P2;

/// Quality of an infinite triangle (paper section 4.1.3): a triangle on the hull is given up when it is flatter than a sixth of its base.
pub const INFINITE_QUALITY: f64 = 0.05;
/// A flip must better the quality by this much: far above rounding (1e-16), so that no sequence of flips returns to where it was.
const GAIN: f64 = 1e-9;

/// A triangle, its corners counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Triangle {
    /// Nodes; the number of nodes stands for infinity.
    pub corners: [usize; 3],
    /// The triangle across the side opposite each corner.
    pub across: [usize; 3],
    /// Whether the side opposite each corner is a segment of the strip.
    pub strip: [bool; 3],
}

/// Triangles over the nodes of a strip and infinity.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Triangulation {
    nodes: usize,
    triangles: Vec<Triangle>,
    /// Sides still to look at while flipping.
    pending: Vec<(usize, usize)>,
}

impl Triangulation {
    /// Takes finished triangles over `nodes` nodes and infinity.
    pub fn new(nodes: usize, triangles: Vec<Triangle>) -> Triangulation {
        Triangulation { nodes, triangles, pending: Vec::new() }
    }

    /// Corners of the finite triangles.
    pub fn finite(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.triangles.iter().map(|t| t.corners).filter(|corners| self.is_finite(*corners))
    }

    fn is_finite(&self, corners: [usize; 3]) -> bool {
        corners.iter().all(|c| *c < self.nodes)
    }

    /// Flips sides that are no segments while that makes triangles better; returns how many flips that took. A triangle that is inside out keeps its sides: its
    /// corners are to go back the way they came. Flipped triangles are right way round before and after, so the energy stays what it was.
    pub fn improve(&mut self, x: &[P2]) -> usize {
        let mut flips = 0;
        loop {
            let before = flips;
            self.pending.extend((0..self.triangles.len()).flat_map(|t| [(t, 0), (t, 1), (t, 2)]));
            while let Some((t, k)) = self.pending.pop() {
                if self.improves(t, k, x) {
                    let u = self.triangles[t].across[k];
                    self.flip(t, k);
                    flips += 1;
                    self.pending.extend([t, u].into_iter().flat_map(|t| [(t, 0), (t, 1), (t, 2)]));
                }
            }
            // A corner of the outside may be free for filling only when something far from it has been given up.
            if flips == before {
                return flips;
            }
        }
    }

    /// The corner of `u` opposite the side that it shares with `t`, where that side is opposite corner `k`.
    fn facing(&self, t: usize, k: usize) -> (usize, usize) {
        let u = self.triangles[t].across[k];
        let end = self.triangles[t].corners[(k + 2) % 3];
        let j = (0..3).find(|j| self.triangles[u].corners[(j + 1) % 3] == end && self.triangles[u].across[*j] == t);
        (u, j.expect("neighbours share a side, run through in opposite directions"))
    }

    /// Whether flipping the side opposite corner `k` of triangle `t` is possible and makes the triangles better.
    fn improves(&self, t: usize, k: usize, x: &[P2]) -> bool {
        let this = &self.triangles[t];
        if this.strip[k] {
            return false;
        }
        let (u, j) = self.facing(t, k);
        let other = &self.triangles[u];
        let [a, b, c] = [0, 1, 2].map(|i| this.corners[(k + i) % 3]);
        let d = other.corners[j];
        // A vertex keeps three triangles at least: with two, they would lie on each other.
        let last_at_b = this.across[(k + 2) % 3] == other.across[(j + 1) % 3];
        let last_at_c = this.across[(k + 1) % 3] == other.across[(j + 2) % 3];
        if a == d || last_at_b || last_at_c {
            return false;
        }
        let infinity = self.nodes;
        let q = |i: usize, j: usize, k: usize| quality(x[i], x[j], x[k]);
        let given_up = |q: f64, apex: usize| {
            let wide = (x[b] - x[apex]).dot(&(x[c] - x[apex])) <= 0.0;
            wide && (0.0..INFINITE_QUALITY - GAIN).contains(&q)
        };
        let filled = |from: usize, at: usize, to: usize| {
            q(from, at, to) > INFINITE_QUALITY + GAIN && self.nothing_reaches_into([from, at, to], t, x)
        };
        match infinity {
            i if i == a => given_up(q(d, c, b), d),
            i if i == d => given_up(q(a, b, c), a),
            i if i == b => filled(a, d, c),
            i if i == c => filled(a, b, d),
            _ => {
                let before = q(a, b, c).min(q(d, c, b));
                before >= 0.0 && q(a, b, d).min(q(a, d, c)) > before + GAIN
            }
        }
    }

    /// Whether no node on the border of the outside lies in the triangle `corners`. `t` is an infinite triangle.
    fn nothing_reaches_into(&self, corners: [usize; 3], t: usize, x: &[P2]) -> bool {
        let [a, b, c] = corners.map(|node| x[node]);
        let mut at = t;
        loop {
            let this = &self.triangles[at];
            let Some(k) = (0..3).find(|k| this.corners[*k] == self.nodes) else { return true };
            let node = this.corners[(k + 1) % 3];
            let p = x[node];
            let inside = area(a, b, p) > 0.0 && area(b, c, p) > 0.0 && area(c, a, p) > 0.0;
            if inside && !corners.contains(&node) {
                return false;
            }
            at = this.across[(k + 1) % 3];
            if at == t {
                return true;
            }
        }
    }

    /// Replaces the side opposite corner `k` of triangle `t` by the other diagonal of the two triangles beside it.
    fn flip(&mut self, t: usize, k: usize) {
        let (u, j) = self.facing(t, k);
        let (this, other) = (self.triangles[t], self.triangles[u]);
        let [a, b, c] = [0, 1, 2].map(|i| this.corners[(k + i) % 3]);
        let d = other.corners[j];
        let beside = |triangle: &Triangle, k: usize| (triangle.across[k % 3], triangle.strip[k % 3]);
        let (ab, ca) = (beside(&this, k + 2), beside(&this, k + 1));
        let (bd, dc) = (beside(&other, j + 1), beside(&other, j + 2));
        self.point_back(bd.0, d, b, u, t);
        self.point_back(ca.0, a, c, t, u);
        self.triangles[t] = Triangle { corners: [a, b, d], across: [bd.0, u, ab.0], strip: [bd.1, false, ab.1] };
        self.triangles[u] = Triangle { corners: [a, d, c], across: [dc.0, ca.0, t], strip: [dc.1, ca.1, false] };
    }

    /// Tells `triangle` that across its side from `start` to `end` lies no longer `from` but `to`.
    fn point_back(&mut self, triangle: usize, start: usize, end: usize, from: usize, to: usize) {
        let this = &mut self.triangles[triangle];
        for k in 0..3 {
            if this.across[k] == from && this.corners[(k + 1) % 3] == start && this.corners[(k + 2) % 3] == end {
                this.across[k] = to;
            }
        }
    }
}

#[cfg(test)]
impl Triangulation {
    /// Checks that this triangulates the sphere over all nodes and infinity, with exactly `segments` for its strip.
    pub fn check(&self, segments: &[[usize; 2]]) {
        let t = &self.triangles;
        assert_eq!(t.len(), 2 * (self.nodes + 1) - 4, "Euler's formula for a sphere");
        let mut around = vec![0; self.nodes + 1];
        let mut strip = Vec::new();
        for (i, this) in t.iter().enumerate() {
            let [a, b, c] = this.corners;
            assert!(a != b && b != c && c != a, "triangle {i}: {this:?}");
            for k in 0..3 {
                around[this.corners[k]] += 1;
                let (u, j) = self.facing(i, k);
                let (start, end) = (this.corners[(k + 1) % 3], this.corners[(k + 2) % 3]);
                assert_eq!((t[u].corners[(j + 1) % 3], t[u].corners[(j + 2) % 3]), (end, start));
                assert_eq!((t[u].across[j], t[u].strip[j]), (i, this.strip[k]));
                if this.strip[k] && start < end {
                    strip.push([start, end]);
                }
            }
        }
        // Walking round a vertex meets every triangle at it: the triangles form one disc there.
        let mut seen = vec![false; self.nodes + 1];
        for (i, this) in t.iter().enumerate() {
            for k in 0..3 {
                if std::mem::replace(&mut seen[this.corners[k]], true) {
                    continue;
                }
                let (mut at, mut count) = ((i, k), 0);
                while count == 0 || at.0 != i {
                    count += 1;
                    let next = t[at.0].across[(at.1 + 1) % 3];
                    let corner = t[next].corners.iter().position(|c| *c == this.corners[k]);
                    at = (next, corner.expect("a neighbour across a side at this corner"));
                    assert!(count <= t.len());
                }
                assert_eq!(count, around[this.corners[k]], "vertex {}", this.corners[k]);
            }
        }
        let mut expected: Vec<[usize; 2]> = segments.iter().map(|[i, j]| [*i.min(j), *i.max(j)]).collect();
        expected.sort_unstable();
        expected.dedup();
        strip.sort_unstable();
        assert_eq!(strip, expected);
    }
}
