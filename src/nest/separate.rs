//! Takes overlapping bodies apart: guided local search (algorithms 4 to 9 of J. Gardeyn, G. Vanden Berghe, T. Wauters, "An open-source heuristic to reboot
//! 2D nesting research", arXiv:2509.13329), with moves along exact lines instead of samples in the plane.

use super::look::{Found, Look, Weights};
use super::random::Random;
use super::scene::{Pose, Scene};
use std::ops::ControlFlow;

/// Weights of overlaps, grown while they last.
#[derive(Debug, Clone)]
pub(super) struct Pairs {
    n: usize,
    weight: Vec<f64>,
    depth: Vec<f64>,
}

impl Weights for Pairs {
    fn weight(&self, a: usize, b: usize) -> f64 {
        self.weight[a * self.n + b]
    }
}

impl Pairs {
    fn new(n: usize) -> Pairs {
        Pairs { n, weight: vec![1.0; n * n], depth: vec![0.0; n * n] }
    }

    fn depth(&self, a: usize, b: usize) -> f64 {
        self.depth[a * self.n + b]
    }

    fn set_depth(&mut self, a: usize, b: usize, depth: f64) {
        self.depth[a * self.n + b] = depth;
        self.depth[b * self.n + a] = depth;
    }

    fn row(&self, a: usize) -> f64 {
        self.depth[a * self.n..(a + 1) * self.n].iter().sum()
    }

    fn weighted_row(&self, a: usize) -> f64 {
        let row = a * self.n..(a + 1) * self.n;
        self.depth[row.clone()].iter().zip(&self.weight[row]).map(|(d, w)| d * w).sum()
    }

    fn total(&self) -> f64 {
        0.5 * self.depth.iter().sum::<f64>()
    }

    /// Overlaps that last weigh more, the deepest most; others are slowly forgotten.
    fn learn(&mut self) {
        let deepest = self.depth.iter().copied().fold(0.0, f64::max);
        for (weight, depth) in self.weight.iter_mut().zip(&self.depth) {
            *weight = match *depth > 0.0 {
                true => *weight * (LEAST_GROWTH + (MOST_GROWTH - LEAST_GROWTH) * depth / deepest),
                false => (*weight * DECAY).max(1.0),
            };
        }
    }
}

const LEAST_GROWTH: f64 = 1.2;
const MOST_GROWTH: f64 = 2.0;
const DECAY: f64 = 0.95;

/// How long to try.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Patience {
    /// Rounds without a better layout before a strike.
    pub(super) rounds: usize,
    /// Strikes before giving up.
    pub(super) strikes: usize,
}

/// Takes bodies apart.
#[derive(Debug, Clone)]
pub(super) struct Separator {
    pub(super) pairs: Pairs,
    look: Look,
    pub(super) random: Random,
    /// Typical extent of a body, mm: what "near" means.
    scale: f64,
    finest: f64,
}

impl Separator {
    pub(super) fn new(scene: &Scene, seed: u64) -> Separator {
        let area = |b: usize| scene.shape(b, 0).size.x * scene.shape(b, 0).size.y;
        let n = scene.bodies.len();
        let scale = ((0..n).map(area).sum::<f64>() / n.max(1) as f64).sqrt();
        Separator {
            pairs: Pairs::new(n),
            look: Look::default(),
            random: Random::new(seed),
            scale,
            finest: scale * FINEST,
        }
    }

    /// Brings all depths up to date, and forgets all weights.
    pub(super) fn reset(&mut self, scene: &mut Scene) {
        let n = scene.bodies.len();
        self.pairs = Pairs::new(n);
        for a in 0..n {
            for b in 0..a {
                self.remeasure(scene, a, b);
            }
        }
    }

    fn remeasure(&mut self, scene: &mut Scene, a: usize, b: usize) {
        let fixed = scene.bodies[a].fixed && scene.bodies[b].fixed;
        let depth = if fixed || scene.poses[a].bay != scene.poses[b].bay { 0.0 } else { scene.depth(a, b) };
        self.pairs.set_depth(a, b, depth);
    }

    fn put(&mut self, scene: &mut Scene, body: usize, pose: Pose) {
        scene.poses[body] = pose;
        for other in (0..scene.bodies.len()).filter(|o| *o != body) {
            self.remeasure(scene, body, other);
        }
    }

    /// Sum of all depths.
    pub(super) fn overlap(&self) -> f64 {
        self.pairs.total()
    }

    /// Moves bodies until none overlap (true), or patience ends (false) with the least overlap found in the scene.
    pub(super) fn separate(
        &mut self,
        scene: &mut Scene,
        patience: Patience,
        keep_on: &mut dyn FnMut(&Scene) -> ControlFlow<()>,
    ) -> bool {
        self.reset(scene);
        let mut best = (self.overlap(), scene.poses.clone());
        let mut strikes = 0;
        while strikes < patience.strikes && best.0 > 0.0 {
            let at_start = best.0;
            let mut idle = 0;
            while idle < patience.rounds {
                self.round(scene);
                let overlap = self.overlap();
                if overlap < best.0 {
                    idle = if overlap < 0.98 * best.0 { 0 } else { idle + 1 };
                    best = (overlap, scene.poses.clone());
                } else {
                    idle += 1;
                }
                if overlap == 0.0 {
                    return true;
                }
                if keep_on(scene).is_break() {
                    strikes = patience.strikes;
                    break;
                }
                self.pairs.learn();
            }
            strikes = if best.0 < 0.98 * at_start { 0 } else { strikes + 1 };
            scene.poses.clone_from(&best.1);
            let weight = std::mem::take(&mut self.pairs.weight);
            self.reset(scene);
            self.pairs.weight = weight;
        }
        best.0 == 0.0
    }

    /// Moves every overlapping body once, in random order.
    fn round(&mut self, scene: &mut Scene) {
        let mut overlapping: Vec<usize> =
            (0..scene.bodies.len()).filter(|b| !scene.bodies[*b].fixed && self.pairs.row(*b) > 0.0).collect();
        self.random.shuffle(&mut overlapping);
        for body in overlapping {
            if self.pairs.row(body) > 0.0 {
                self.relocate(scene, body);
            }
        }
    }

    fn relocate(&mut self, scene: &mut Scene, body: usize) {
        let now = Found { pose: scene.poses[body], cost: self.pairs.weighted_row(body) };
        let found = self.search(scene, body, now);
        if found.cost < now.cost {
            self.put(scene, body, found.pose);
        }
    }

    /// The best place for a body that a few dozen lines find.
    fn search(&mut self, scene: &mut Scene, body: usize, now: Found) -> Found {
        let mut best: Vec<Found> = Vec::with_capacity(KEPT + 1);
        let turns = scene.bodies[body].turns.len();
        for bay in 0..scene.bays.len() {
            for turn in 0..turns {
                let Some((x0, x1)) = scene.reach(scene.shape(body, turn), &scene.bays[bay]) else { continue };
                let width = scene.shape(body, turn).size.x;
                let mut xs: Vec<f64> = Vec::with_capacity(32);
                if now.pose.bay == bay {
                    xs.push(now.pose.x);
                    for _ in 0..NEAR {
                        let far = self.random.half_normal(0.25 * width.max(self.scale));
                        xs.push(if self.random.unit() < 0.5 { now.pose.x - far } else { now.pose.x + far });
                    }
                }
                for _ in 0..ANYWHERE {
                    xs.push(self.random.between(x0, x1));
                }
                for _ in 0..BESIDE {
                    let other = self.random.below(scene.bodies.len());
                    if other != body && scene.poses[other].bay == bay {
                        let left = self.random.unit() < 0.5;
                        xs.push(if left { scene.poses[other].x - width } else { scene.right(other) });
                    }
                }
                xs.push(if self.random.unit() < 0.5 { x0 } else { x1 });
                for x in xs {
                    let x = x.clamp(x0, x1);
                    let bound = if best.len() < KEPT { f64::INFINITY } else { best[KEPT - 1].cost };
                    let Some(found) = self.look.along(scene, &self.pairs, body, (turn, bay, x), bound) else { continue };
                    if best.iter().any(|b| b.pose.turn == turn && (b.pose.x - x).abs() < 0.02 * width) {
                        if let Some(k) = best.iter().position(|b| {
                            b.pose.turn == turn && (b.pose.x - x).abs() < 0.02 * width && found.cost < b.cost
                        }) {
                            best[k] = found;
                        }
                    } else {
                        best.push(found);
                    }
                    best.sort_by(|a, b| a.cost.total_cmp(&b.cost));
                    best.truncate(KEPT);
                    if found.cost == 0.0 {
                        return found;
                    }
                }
            }
        }
        let mut winner = now;
        for start in best {
            let refined = self.refine(scene, body, start);
            if refined.cost < winner.cost {
                winner = refined;
            }
            if winner.cost == 0.0 {
                break;
            }
        }
        winner
    }

    /// Slides along x in shrinking steps.
    fn refine(&mut self, scene: &mut Scene, body: usize, start: Found) -> Found {
        let mut best = start;
        let shape = scene.shape(body, start.pose.turn);
        let Some((x0, x1)) = scene.reach(shape, &scene.bays[start.pose.bay]) else { return best };
        let mut step = 0.05 * self.scale.max(shape.size.x);
        while step > self.finest && best.cost > 0.0 {
            let sign = if self.random.unit() < 0.5 { -1.0 } else { 1.0 };
            let mut better = None;
            for dx in [sign * step, -sign * step] {
                let x = (best.pose.x + dx).clamp(x0, x1);
                if x == best.pose.x {
                    continue;
                }
                let at = (start.pose.turn, start.pose.bay, x);
                better = self.look.along(scene, &self.pairs, body, at, best.cost);
                if better.is_some() {
                    break;
                }
            }
            match better {
                Some(found) => best = found,
                None => step *= 0.4,
            }
        }
        best
    }
}

const KEPT: usize = 3;
const NEAR: usize = 4;
const ANYWHERE: usize = 6;
const BESIDE: usize = 6;
const FINEST: f64 = 2e-5;
