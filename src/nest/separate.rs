//! Takes overlapping bodies apart: guided local search (the separation procedure of J. Gardeyn, G. Vanden Berghe, T. Wauters, "An open-source heuristic to
//! reboot 2D nesting research", arXiv:2509.13329), with moves along exact lines instead of samples in the plane.

use super::look::Found;
use super::pairs::Pairs;
use super::random::Random;
use super::relocate::Relocate;
use super::scene::{Pose, Scene};
use super::watch::Watch;

/// Less overlap than before by this factor is worth going on for.
const WORTH: f64 = 0.98;

/// How long to try.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Patience {
    /// Rounds without much less overlap before a strike.
    pub(super) rounds: usize,
    /// Strikes before giving up.
    pub(super) strikes: usize,
}

/// Takes bodies apart.
#[derive(Debug, Clone)]
pub(super) struct Separator {
    pairs: Pairs,
    relocate: Relocate,
    pub(super) random: Random,
}

impl Separator {
    pub(super) fn new(scene: &Scene, seed: u64) -> Separator {
        let pairs = Pairs::new(scene.bodies.len());
        Separator { pairs, relocate: Relocate::new(scene), random: Random::new(seed) }
    }

    /// Measures every overlap, and forgets all weights.
    fn begin(&mut self, scene: &mut Scene) {
        self.pairs = Pairs::new(scene.bodies.len());
        self.measure(scene);
    }

    fn measure(&mut self, scene: &mut Scene) {
        for a in 0..scene.bodies.len() {
            for b in 0..a {
                self.pairs.set_depth(a, b, scene.depth(a, b));
            }
        }
    }

    fn put(&mut self, scene: &mut Scene, body: usize, pose: Pose) {
        scene.poses[body] = pose;
        for other in (0..scene.bodies.len()).filter(|o| *o != body) {
            self.pairs.set_depth(body, other, scene.depth(body, other));
        }
    }

    /// Sum of all depths.
    pub(super) fn overlap(&self) -> f64 {
        self.pairs.total()
    }

    /// Gives a body the place where it overlaps least; false when no bay holds it.
    pub(super) fn insert(&mut self, scene: &mut Scene, body: usize) -> bool {
        self.begin(scene);
        let nowhere = Found { pose: Pose::NONE, cost: f64::INFINITY };
        let found = self.relocate.search(scene, &self.pairs, &mut self.random, body, nowhere);
        scene.poses[body] = found.pose;
        !found.pose.is_none()
    }

    /// Moves bodies until none overlap (true), or patience, effort or the caller's will end (false): then the scene has the least overlap found.
    pub(super) fn separate(&mut self, scene: &mut Scene, patience: Patience, watch: &mut Watch, until: u64) -> bool {
        self.begin(scene);
        // A scene without overlaps is an effort as well: whoever goes on until the effort is spent gets there.
        scene.looked += 1;
        let mut best = (self.overlap(), scene.poses.clone());
        let mut strikes = 0;
        while best.0 > 0.0 && strikes < patience.strikes {
            let before = best.0;
            let mut idle = 0;
            while idle < patience.rounds {
                if watch.is_over(scene, until) {
                    strikes = patience.strikes;
                    break;
                }
                self.round(scene);
                let overlap = self.overlap();
                idle = if overlap < WORTH * best.0 { 0 } else { idle + 1 };
                if overlap < best.0 {
                    best = (overlap, scene.poses.clone());
                }
                if overlap == 0.0 {
                    return true;
                }
                self.pairs.learn();
            }
            strikes = if best.0 < WORTH * before { 0 } else { strikes + 1 };
            scene.poses.clone_from(&best.1);
            self.measure(scene);
        }
        best.0 == 0.0
    }

    /// Moves every overlapping body once, in random order.
    fn round(&mut self, scene: &mut Scene) {
        // A round in which nothing can move is an effort as well.
        scene.looked += 1;
        let movable = (0..scene.bodies.len()).filter(|b| !scene.bodies[*b].fixed);
        let mut overlapping: Vec<usize> = movable.filter(|b| self.pairs.overlaps(*b)).collect();
        self.random.shuffle(&mut overlapping);
        for body in overlapping {
            if !self.pairs.overlaps(body) {
                continue;
            }
            let now = Found { pose: scene.poses[body], cost: self.pairs.cost(body) };
            let found = self.relocate.search(scene, &self.pairs, &mut self.random, body, now);
            if found.cost < now.cost {
                self.put(scene, body, found.pose);
            }
        }
    }
}
