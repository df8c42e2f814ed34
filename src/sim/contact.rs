//! Sheets do not pass through each other: every node keeps its distance from every segment that it is not an end of.
//!
//! Two sheets that leave a connection tangentially are s² / R apart at distance s from it, however thick they are. So the distance kept near a connection
//! shrinks with the way along the strip: nothing else tells a joint from a collision, and the order of the sheets round a joint is kept too.

use super::barrier::{self, Gap};
use super::ccd::{Moving, first_touch};
use super::{Material, Pattern};
use crate::geom::{MotionTree, P2, Rect, distance_to_segment};
use crate::ruffle::Ruffle;

/// Beyond the sheet's thickness the barrier reaches this far, mm: a twentieth of a thin layer, and within it a Newton step still sees it coming.
pub(super) const REACH_MM: f64 = 0.3;
/// Sheets part from a connection at least as fast as two circles of this radius, mm: flatter than any loop that gets folded.
const FLATTEST_MM: f64 = 100.0;
/// Stiffness of the barrier against that of the sheet: kappa = D w / R² times this, with the radius of a typical loop. A force of 12 kappa leaves a tenth of the
/// reach. Sheets pressed with tens of newtons keep a good part of it: with a thirtieth of this they come so close that the least turn of one lets it touch, and
/// they jam there (`cargo bench --bench press`).
const BENDING_SHARE: f64 = 3.0;
const TYPICAL_RADIUS_MM: f64 = 15.0;
/// And against the strip's weight: a sheet too soft to stand lies down, and then a few nodes carry all of it.
const WEIGHT_SHARE: f64 = 3.0;
/// A step ends at this share of the way to the first touch.
const BEFORE_TOUCH: f64 = 0.9;
/// Pairs are collected for this much more motion than was asked for, mm: near rest the steps are shorter, and the same pairs serve many of them.
const SLACK_MM: f64 = 0.2;

/// A node and a segment close enough to matter.
#[derive(Debug, Clone, Copy)]
struct Pair {
    node: usize,
    ends: [usize; 2],
    gap: Gap,
    kappa_n: f64,
}

/// Contact terms of one ruffle.
#[derive(Debug, Clone)]
pub(super) struct Contacts {
    segments: Vec<[usize; 2]>,
    neighbours: Vec<Vec<usize>>,
    rest_mm: Vec<f64>,
    /// For every node the nodes near it along the strip and how far, mm; sorted by node.
    near: Vec<Vec<(usize, f64)>>,
    /// Stiffness at each node, N.
    kappa_n: Vec<f64>,
    thickness_mm: f64,
    /// Share of the full distance that is asked for: 1, or less where a start lies closer.
    share: f64,
    /// Nodes, and segments in strip order, on the current step.
    trees: [MotionTree; 2],
    /// Every pair that may come within reach on the current step, or while each node is near its place in `around`.
    pairs: Vec<Pair>,
    /// End of the step that the pairs were collected for; empty when they hold no longer.
    around: Vec<P2>,
}

impl Contacts {
    /// The terms of `ruffle`; lengths and widths come with [`Contacts::measure`].
    pub fn new(ruffle: &Ruffle) -> Contacts {
        let segments: Vec<[usize; 2]> = ruffle.segments().map(|(i, j)| [i, j]).collect();
        let mut neighbours = vec![Vec::new(); ruffle.node_count];
        for (s, [i, j]) in segments.iter().enumerate() {
            neighbours[*i].push(s);
            neighbours[*j].push(s);
        }
        Contacts {
            rest_mm: vec![0.0; segments.len()],
            near: vec![Vec::new(); ruffle.node_count],
            kappa_n: vec![0.0; ruffle.node_count],
            thickness_mm: 0.0,
            share: 1.0,
            trees: Default::default(),
            pairs: Vec::new(),
            around: Vec::new(),
            segments,
            neighbours,
        }
    }

    /// Takes rest lengths (mm), widths at the nodes (mm), the sheet, and the weight of the whole strip (N).
    pub fn measure(&mut self, rest_lengths_mm: &[f64], widths_mm: &[f64], material: &Material, weight_n: f64) {
        self.rest_mm.copy_from_slice(rest_lengths_mm);
        self.thickness_mm = material.thickness_mm;
        self.share = 1.0;
        self.around.clear();
        for (kappa, width) in self.kappa_n.iter_mut().zip(widths_mm) {
            *kappa = kappa_n(material, *width, weight_n);
        }
        let limit = (2.0 * FLATTEST_MM * (self.thickness_mm + REACH_MM)).sqrt();
        let mut places = vec![None; self.near.len()];
        for node in 0..self.near.len() {
            let mut found = std::mem::take(&mut self.near[node]);
            found.clear();
            self.walk_from(node, limit, &mut found, &mut places);
            self.near[node] = found;
        }
    }

    /// Nodes within `limit` of `start` along the strip. `places` has room for the place of every node among those found; it is left empty.
    fn walk_from(&self, start: usize, limit: f64, found: &mut Vec<(usize, f64)>, places: &mut [Option<usize>]) {
        found.push((start, 0.0));
        places[start] = Some(0);
        let mut k = 0;
        while k < found.len() {
            let (node, way) = found[k];
            k += 1;
            for s in &self.neighbours[node] {
                let [i, j] = self.segments[*s];
                let next = if i == node { j } else { i };
                let way = way + self.rest_mm[*s];
                if way > limit {
                    continue;
                }
                match places[next] {
                    None => {
                        places[next] = Some(found.len());
                        found.push((next, way));
                    }
                    // A shorter way to a node already left behind: look at its neighbours again.
                    Some(at) if found[at].1 > way => {
                        found[at].1 = way;
                        k = k.min(at);
                    }
                    Some(_) => {}
                }
            }
        }
        found.iter().for_each(|(n, _)| places[*n] = None);
        found.sort_unstable_by_key(|(n, _)| *n);
    }

    /// Distance between a node and a segment along the strip, mm; infinite when it is long.
    fn way(&self, node: usize, ends: [usize; 2]) -> f64 {
        let to = |end: usize| {
            let near = &self.near[node];
            near.binary_search_by_key(&end, |(n, _)| *n).map_or(f64::INFINITY, |k| near[k].1)
        };
        to(ends[0]).min(to(ends[1]))
    }

    fn gap(&self, node: usize, ends: [usize; 2]) -> Gap {
        let full = self.thickness_mm + REACH_MM;
        let allowed = self.way(node, ends).powi(2) / (2.0 * FLATTEST_MM);
        let scale = (allowed / full).min(1.0) * self.share;
        Gap { least_mm: self.thickness_mm * scale, reach_mm: REACH_MM * scale }
    }

    /// Sees to it that every pair is at hand that can come within reach while the nodes move straight from `x` to `to`.
    fn collect(&mut self, x: &[P2], to: &[P2]) {
        let near = |p: &P2, around: &P2| (p - around).norm_squared() <= SLACK_MM * SLACK_MM;
        let mut moves = x.iter().zip(to).zip(&self.around);
        if self.around.len() == x.len() && moves.all(|((p, q), around)| near(p, around) && near(q, around)) {
            return;
        }
        self.around.clear();
        self.around.extend_from_slice(to);
        let outer = self.thickness_mm + REACH_MM + 2.0 * SLACK_MM;
        let [mut nodes, mut segments] = std::mem::take(&mut self.trees);
        nodes.fill(x.iter().zip(to).map(|(p, q)| [Rect::around([p]).grown(outer), Rect::around([q]).grown(outer)]));
        let swept = |[i, j]: &[usize; 2]| [Rect::around([&x[*i], &x[*j]]), Rect::around([&to[*i], &to[*j]])];
        segments.fill(self.segments.iter().map(swept));
        let mut pairs = std::mem::take(&mut self.pairs);
        pairs.clear();
        nodes.near(&segments, &mut |node, s| {
            let ends = self.segments[s];
            if ends[0] != node && ends[1] != node {
                let gap = self.gap(node, ends);
                // Closing a short reach takes as much energy as closing a long one.
                let kappa_n = self.kappa_n[node] * REACH_MM / gap.reach_mm;
                pairs.push(Pair { node, ends, gap, kappa_n });
            }
        });
        self.trees = [nodes, segments];
        self.pairs = pairs;
    }

    /// Shortens the straight step from `x` to `to` so that it ends before anything touches, and returns the share that is left. Energies can then be asked for at
    /// both ends.
    pub fn advance(&mut self, x: &[P2], to: &mut [P2]) -> f64 {
        self.collect(x, to);
        let moving = |i: usize| Moving { at: x[i], by: to[i] - x[i] };
        let touch = |pair: &Pair| first_touch(moving(pair.node), moving(pair.ends[0]), moving(pair.ends[1]));
        let open = BEFORE_TOUCH * self.pairs.iter().filter_map(touch).fold(f64::INFINITY, f64::min);
        if open < 1.0 {
            to.iter_mut().zip(x).for_each(|(to, from)| *to = from + (*to - from) * open);
        }
        open.min(1.0)
    }

    /// Asks for less distance until a start that lies closer than the full one has a finite energy. Sheets that touch are pulled apart from there. False when
    /// some lie on each other.
    pub fn admit(&mut self, x: &[P2]) -> bool {
        self.share = 1.0;
        for _ in 0..60 {
            self.around.clear();
            self.collect(x, x);
            if self.energy(x).is_finite() {
                return true;
            }
            self.share *= 0.8;
        }
        false
    }

    /// Energy of the pairs collected, N mm.
    pub fn energy(&self, x: &[P2]) -> f64 {
        self.pairs.iter().map(|p| barrier::energy(x[p.node], x[p.ends[0]], x[p.ends[1]], p.gap, p.kappa_n)).sum()
    }

    /// Adds the gradient of [`Contacts::energy`], N.
    pub fn add_gradient(&self, x: &[P2], gradient: &mut [f64]) {
        for pair in self.active(x) {
            let g = barrier::gradient(x[pair.node], x[pair.ends[0]], x[pair.ends[1]], pair.gap, pair.kappa_n);
            for (k, unknown) in unknowns(pair).into_iter().enumerate() {
                gradient[unknown] += g[k];
            }
        }
    }

    /// Adds the Hessian of [`Contacts::energy`], N/mm; with `convex`, the part of it that is never indefinite. Every active pair must be in the pattern.
    pub fn add_hessian(&self, x: &[P2], convex: bool, pattern: &Pattern, values: &mut [f64]) {
        for pair in self.active(x) {
            let (p, a, b) = (x[pair.node], x[pair.ends[0]], x[pair.ends[1]]);
            let block = barrier::hessian(p, a, b, pair.gap, pair.kappa_n, convex);
            let unknowns = unknowns(pair);
            for (i, row) in unknowns.iter().enumerate() {
                for (j, column) in unknowns.iter().enumerate().skip(i) {
                    if let Some(slot) = pattern.slot(*row, *column) {
                        values[slot] += block[(i, j)];
                    }
                }
            }
        }
    }

    /// True when the pattern has room for every active pair.
    pub fn fits(&self, x: &[P2], pattern: &Pattern) -> bool {
        self.active(x).all(|pair| {
            let [p, _, a, _, b, _] = unknowns(pair);
            pattern.slot(p, a).is_some() && pattern.slot(p, b).is_some()
        })
    }

    /// Unknowns of every pair that is active or soon may be: four times as far apart, so that the system need not be analysed again and again while sheets come near.
    pub fn elements(&self, x: &[P2]) -> impl Iterator<Item = [usize; 6]> + '_ {
        let soon = |pair: &&Pair| distance(pair, x) < 4.0 * pair.gap.outer_mm();
        let near: Vec<[usize; 6]> = self.pairs.iter().filter(soon).map(unknowns).collect();
        near.into_iter()
    }

    fn active<'a>(&'a self, x: &'a [P2]) -> impl Iterator<Item = &'a Pair> {
        self.pairs.iter().filter(|pair| distance(pair, x) < pair.gap.outer_mm())
    }
}

/// Stiffness of the barrier, N, at a node where the strip is `width_mm` wide; `weight_n` is the whole strip's.
pub(super) fn kappa_n(material: &Material, width_mm: f64, weight_n: f64) -> f64 {
    BENDING_SHARE * material.flexural_rigidity_n_mm * width_mm / TYPICAL_RADIUS_MM.powi(2) + WEIGHT_SHARE * weight_n
}

fn distance(pair: &Pair, x: &[P2]) -> f64 {
    distance_to_segment(x[pair.node], x[pair.ends[0]], x[pair.ends[1]])
}

fn unknowns(pair: &Pair) -> [usize; 6] {
    let [a, b] = pair.ends;
    [2 * pair.node, 2 * pair.node + 1, 2 * a, 2 * a + 1, 2 * b, 2 * b + 1]
}
