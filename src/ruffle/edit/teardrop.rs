//! Densifying a loop: the room behind it is divided by a little stack of loops (paper section 3.1, figure 7).
//!
//! A loop runs from a knot P to a knot Q; the sections before and after it meet at an apex, so that the three enclose a room. Little loops hold on to the middles
//! a and b of the two other sides and to one new knot c, which replaces the loop's crown:
//!
//! ```text
//!            __b________Q__              P -> c  half of the old loop
//!     __----/  \______     \             c -> a  back along the first side
//!  apex    (       ___c____/             a -> b  a loop that faces the apex
//!     --___ \ ____/   \    \             b -> c  forward along the second side
//!          --a---______P___/             c -> Q  the other half of the old loop
//! ```
//!
//! At a, b and c the strip passes once in each direction, as at every connection.

use super::draft::{Draft, Part};
use super::mesh::{divide, refine};
use crate::geom::P2;
use crate::ruffle::Role;
use crate::ruffle::curve::{Curve, MIN_SEGMENTS, smooth};
use std::f64::consts::PI;

/// Parts that enclose a room together with a loop, each side from the loop to the apex.
struct Room {
    before: Vec<usize>,
    after: Vec<usize>,
}

/// Finds the room behind a part: sides that were one section each before midpoints divided them.
fn room(draft: &Draft, part: usize) -> Option<Room> {
    let chain = |parts: &mut dyn Iterator<Item = usize>, knot: fn(&Part) -> usize| {
        let mut chain = Vec::new();
        for i in parts {
            chain.push(i);
            if !draft.midpoint[knot(&draft.parts[i])] {
                break;
            }
        }
        chain
    };
    let before = chain(&mut (0..part).rev(), |p| p.from);
    let after = chain(&mut (part + 1..draft.parts.len()), |p| p.to);
    let mut found: Option<(usize, usize)> = None;
    for (i, b) in before.iter().enumerate() {
        for (j, a) in after.iter().enumerate() {
            let meets = draft.parts[*b].from == draft.parts[*a].to;
            if meets && found.is_none_or(|(fi, fj)| i + j < fi + fj) {
                found = Some((i, j));
            }
        }
    }
    let (i, j) = found?;
    Some(Room { before: before[..=i].to_vec(), after: after[..=j].to_vec() })
}

/// Whether a part is a loop that closes a room.
pub(super) fn closes_room(draft: &Draft, part: usize) -> bool {
    room(draft, part).is_some()
}

/// The knot nearest to the middle of a side: a midpoint it has already, or a new one. `side` runs along the strip.
fn middle(draft: &mut Draft, side: &[usize], segment_mm: f64) -> usize {
    let lengths: Vec<f64> = side.iter().map(|p| draft.parts[*p].length_mm()).collect();
    let half = 0.5 * lengths.iter().sum::<f64>();
    let mut way = 0.0;
    let mut best: Option<(f64, usize)> = None;
    for (part, length) in side[..side.len() - 1].iter().zip(&lengths) {
        way += length;
        let off = (way - half).abs();
        if off < 0.5 * half && best.is_none_or(|(o, _)| off < o) {
            best = Some((off, draft.parts[*part].to));
        }
    }
    if let Some((_, knot)) = best {
        return knot;
    }
    let mut start = 0.0;
    let mut at = 0;
    while at + 1 < side.len() && start + lengths[at] < half {
        start += lengths[at];
        at += 1;
    }
    let part = side[at];
    // Either half needs its least number of segments.
    let segments = draft.parts[part].rest_mm.len();
    divide(draft, part, &vec![(2 * MIN_SEGMENTS).div_ceil(segments); segments]);
    let knot = draft.divide_part(part, draft.nearest_node(part, half - start));
    refine(draft, part, segment_mm);
    refine(draft, part + 1, segment_mm);
    knot
}

/// The room as a surface: t runs from the apex (-1) over the middles a, b (0) and the loop's ends (1) to its crown (2), u from the first side (0) across to the
/// second (1). Curves that do not cross in t, u do not cross in the plane.
struct Surface {
    low: [Curve; 3],
    high: [Curve; 3],
}

impl Surface {
    fn at(&self, t: f64, u: f64) -> P2 {
        let piece = ((t + 1.0).floor() as usize).min(2);
        let share = t + 1.0 - piece as f64;
        let (low, high) = (self.low[piece].at(share), self.high[piece].at(share));
        low + (high - low) * u
    }

    /// How far the surface extends from t = `from` to the next whole t, mm.
    fn reach_mm(&self, piece: usize) -> f64 {
        0.5 * (self.low[piece].length() + self.high[piece].length())
    }

    /// A loop from u to u across the line t = `from`, round on both sides, [`DEPTH`] deep but at most [`DEEPEST`].
    fn lobe(&self, from: f64, side: f64, [start, end]: [f64; 2]) -> Curve {
        let width = (self.at(from, end) - self.at(from, start)).norm();
        let piece = if side < 0.0 { 0 } else { 2 };
        let depth = side * (DEPTH * width / self.reach_mm(piece)).min(DEEPEST);
        Curve::traced(|v| {
            let (sin, cos) = (PI * v).sin_cos();
            self.at(from + depth * sin, start + (end - start) * 0.5 * (1.0 - cos))
        })
    }
}

/// Depth of a lobe over its width, a little more than a half circle's: with it the dense load-test strip is as long as the paper's table says.
const DEPTH: f64 = 0.6;
/// Deepest lobe, as a share of the side or half loop it lies beside: beyond it the room is too narrow for a loop.
const DEEPEST: f64 = 0.8;

/// Divides the room behind `part`; `None`, and nothing changed, when it closes none.
pub(super) fn divide_room(draft: &mut Draft, part: usize, segment_mm: f64) -> Option<()> {
    let sides = room(draft, part)?;
    let count = draft.parts.len();
    let a = middle(draft, &sides.before.iter().rev().copied().collect::<Vec<usize>>(), segment_mm);
    let moved = draft.parts.len() - count;
    let b = middle(draft, &sides.after.iter().map(|p| p + moved).collect::<Vec<usize>>(), segment_mm);
    let part = part + moved;

    let sides = room(draft, part)?;
    let curve = |parts: &[usize]| draft.joined(parts.iter().copied());
    let before: Vec<usize> = sides.before.into_iter().rev().collect();
    let until_a = before.iter().position(|p| draft.parts[*p].to == a)? + 1;
    let until_b = sides.after.iter().position(|p| draft.parts[*p].to == b)? + 1;
    let turned = |c: Curve| c.part(1.0, 0.0);
    let crown = draft.curve(part);
    let surface = Surface {
        low: [curve(&before[..until_a]), curve(&before[until_a..]), crown.part(0.0, 0.5)],
        high: [turned(curve(&sides.after[until_b..])), turned(curve(&sides.after[..until_b])), crown.part(1.0, 0.5)],
    };
    let Part { role, from: p, to: q, .. } = draft.parts[part];
    let c = draft.new_knot(surface.at(1.0, 0.5));
    let runs = [
        (role, [p, c], surface.lobe(1.0, 1.0, [0.0, 0.5])),
        (Role::Densified, [c, a], Curve::traced(|v| surface.at(1.0 - v, 0.5 * smooth(1.0 - v)))),
        (Role::Densified, [a, b], surface.lobe(0.0, -1.0, [0.0, 1.0])),
        (Role::Densified, [b, c], Curve::traced(|v| surface.at(v, 1.0 - 0.5 * smooth(v)))),
        (role, [c, q], surface.lobe(1.0, 1.0, [0.5, 1.0])),
    ];
    let parts = runs.map(|(role, ends, curve)| draft.part(role, ends, &curve, curve.length(), segment_mm));
    draft.densified(part, parts.to_vec());
    Some(())
}
