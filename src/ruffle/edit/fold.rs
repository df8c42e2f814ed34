//! Densifying a section that closes no room: a rung, a diagonal, or a part of one. It is folded back on itself in its middle, into two loops around a diagonal.
//!
//! ```text
//!            /----------Y--__          P -> X  the first stretch
//!           (    __--~~   )  \__ Q     X -> Y  below and round the right end
//!    P __    \~~         /             Y -> X  back across
//!        ~~--X----------/              X -> Y  round the left end and above
//!                                      Y -> Q  the last stretch
//! ```
//!
//! At X and at Y the strip passes once in each direction, as at every connection.

use super::draft::{Draft, Part};
use crate::geom::{P2, Rect, V2, cross};
use crate::ruffle::Role;
use crate::ruffle::curve::{Curve, smooth};
use std::f64::consts::PI;

/// Middle of the fold on the section, as a share of its length: the first of those where the free space across it is largest. A rung has more room where a loop leaves
/// it than where a diagonal does.
const MIDDLES: [f64; 5] = [0.5, 0.42, 0.58, 0.35, 0.65];
/// Half the way between X and Y over the section's length.
const HALF_LENGTH: f64 = 0.17;
/// Full height of the fold over the section's length: its rooms are then about half as high as long.
const HEIGHT: f64 = 0.22;
/// Heights tried, as shares of the full one: between sheets that turn towards it a lower fold may fit.
pub(super) const SHARES: [f64; 4] = [1.0, 0.75, 0.55, 0.4];
/// Least segments in the half turn of a loop: with fewer it starts out with a crease.
const TURN_SEGMENTS: f64 = 2.0;
/// Share of the free space beside the section that is used.
const FREE_SHARE: f64 = 0.6;
/// Stations at which the free space is measured.
const STATIONS: usize = 64;

/// Frame along a section: s from 0 to 1 along it, n across it, mm, positive to its left.
struct Frame {
    curve: Curve,
    /// Free space to the left and to the right at every station, mm.
    free: [Vec<f64>; 2],
}

impl Frame {
    fn new(draft: &Draft, part: usize) -> Frame {
        let mut frame = Frame { curve: draft.curve(part), free: Default::default() };
        let obstacles = Obstacles::new(draft, part);
        for (side, free) in [1.0, -1.0].into_iter().zip(&mut frame.free) {
            *free = (0..=STATIONS)
                .map(|i| {
                    let s = i as f64 / STATIONS as f64;
                    obstacles.free_mm(frame.curve.at(s), normal(&frame.curve, s) * side)
                })
                .collect();
        }
        frame
    }

    /// Free space at s on a side, mm: the least of three stations, since a sheet between two may bulge.
    fn free_mm(&self, side: usize, s: f64) -> f64 {
        let near = (s * STATIONS as f64).round() as usize;
        let (low, high) = (near.saturating_sub(1), (near + 1).min(STATIONS));
        self.free[side][low..=high].iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Point at s, n, drawn in where there is no room for it.
    fn at(&self, s: f64, n: f64) -> P2 {
        let room = FREE_SHARE * self.free_mm(usize::from(n < 0.0), s);
        self.curve.at(s) + normal(&self.curve, s) * n.clamp(-room, room)
    }
}

/// Unit vector to the left of the curve's general direction around s.
fn normal(curve: &Curve, s: f64) -> V2 {
    let along = curve.at((s + 0.5 * HEIGHT).min(1.0)) - curve.at((s - 0.5 * HEIGHT).max(0.0));
    V2::new(-along.y, along.x).try_normalize(0.0).unwrap_or_default()
}

/// What a fold must not run into: the rest of the strip, and the level of the drawing's lowest node, below which a floor may be.
struct Obstacles {
    segments: Vec<(P2, P2)>,
    floor_mm: f64,
    size_mm: f64,
}

impl Obstacles {
    fn new(draft: &Draft, part: usize) -> Obstacles {
        let all: Vec<Vec<P2>> = (0..draft.parts.len()).map(|p| draft.points(p)).collect();
        let bounds = Rect::around(all.iter().flatten());
        let others = all.iter().enumerate().filter(|(p, _)| *p != part);
        let segments = others.flat_map(|(_, points)| points.windows(2).map(|w| (w[0], w[1]))).collect();
        Obstacles { segments, floor_mm: bounds.min.y, size_mm: bounds.width() + bounds.height() }
    }

    /// Way from `from` along the unit vector `ray` to the first obstacle, mm.
    fn free_mm(&self, from: P2, ray: V2) -> f64 {
        let to_floor = if ray.y < 0.0 { (self.floor_mm - from.y) / ray.y } else { f64::INFINITY };
        let hits = self.segments.iter().filter_map(|(a, b)| {
            let (e, d) = (b - a, a - from);
            let turn = cross(ray, e);
            let (way, share) = (cross(d, e) / turn, cross(d, ray) / turn);
            (way > 0.0 && (0.0..=1.0).contains(&share)).then_some(way)
        });
        hits.fold(to_floor.min(self.size_mm), f64::min)
    }
}

/// Lowest and highest n of a fold around `middle`, mm: no higher than `height_mm`, as near to the old section as the free space allows.
fn extent(frame: &Frame, middle: f64, height_mm: f64) -> [f64; 2] {
    let reach = HALF_LENGTH + 0.5 * HEIGHT;
    let within = |i: &usize| (*i as f64 / STATIONS as f64 - middle).abs() <= reach;
    let least = |free: &Vec<f64>| (0..=STATIONS).filter(within).map(|i| free[i]).fold(f64::INFINITY, f64::min);
    let [left, right] = [0, 1].map(|side| FREE_SHARE * least(&frame.free[side]));
    let up = (0.5 * height_mm).min(left);
    let down = (height_mm - up).min(right);
    [-down, (height_mm - down).min(left)]
}

/// Folds a part back on itself, `share` (0 to 1) of full height. `None`, and nothing changed, where that is too low to bend round.
pub(super) fn fold(draft: &mut Draft, part: usize, share: f64, segment_mm: f64) -> Option<()> {
    let frame = Frame::new(draft, part);
    let length = frame.curve.length();
    let height_mm = share * HEIGHT * length;
    let (mut middle, mut span) = (0.5, [0.0; 2]);
    for candidate in MIDDLES {
        let found = extent(&frame, candidate, height_mm);
        if found[1] - found[0] > 1.01 * (span[1] - span[0]) {
            (middle, span) = (candidate, found);
        }
    }
    let [low, high] = span;
    let (level, half) = (0.5 * (low + high), 0.5 * (high - low));
    let round = PI * half;
    if round < TURN_SEGMENTS * segment_mm {
        return None;
    }
    let bulge = half / length;
    let (start, end) = (middle - HALF_LENGTH, middle + HALF_LENGTH);

    let Part { role, from: p, to: q, .. } = draft.parts[part];
    let x = draft.new_knot(frame.at(start, low));
    let y = draft.new_knot(frame.at(end, high));
    // Along and round: the trace spends on each about what it is long.
    let turn_share = round / ((end - start) * length + round);
    let across = |v: f64| start + (end - start) * v;
    let below = |v: f64| {
        if v < 1.0 - turn_share {
            return frame.at(across(v / (1.0 - turn_share)), low);
        }
        let (sin, cos) = (PI * (v - 1.0 + turn_share) / turn_share).sin_cos();
        frame.at(end + bulge * sin, level - half * cos)
    };
    let above = |v: f64| {
        if v > turn_share {
            return frame.at(across((v - turn_share) / (1.0 - turn_share)), high);
        }
        let (sin, cos) = (PI * v / turn_share).sin_cos();
        frame.at(start - bulge * sin, level - half * cos)
    };
    let (lead, tail) = (start - bulge, 1.0 - end - bulge);
    let eased = |n: f64, way: f64| n * smooth(way.min(1.0));
    let first = |v: f64| frame.at(start * v, eased(low, start * v / lead));
    let back = |v: f64| frame.at(across(1.0 - v), high + (low - high) * smooth(v));
    let last = |v: f64| {
        let s = end + (1.0 - end) * v;
        frame.at(s, eased(high, (1.0 - s) / tail))
    };
    let runs = [
        (role, [p, x], Curve::traced(first)),
        (Role::Densified, [x, y], Curve::traced(below)),
        (Role::Densified, [y, x], Curve::traced(back)),
        (Role::Densified, [x, y], Curve::traced(above)),
        (role, [y, q], Curve::traced(last)),
    ];
    let parts = runs.map(|(role, ends, curve)| draft.part(role, ends, &curve, curve.length(), segment_mm));
    draft.densified(part, parts.to_vec());
    Some(())
}
