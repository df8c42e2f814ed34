//! A better place for one body: lines near where it lies, beside others, and anywhere; then slides along x in shrinking steps.
//!
//! For flat strips lying along x these are long slides along, the exact step across, flips by half a turn, and re-seating in gaps between others' ends.

use super::look::{Found, Line, Look};
use super::pairs::Pairs;
use super::random::Random;
use super::scene::Scene;

/// Lines a turn and bay: near the body, anywhere, and with one end where another body ends.
const NEAR: usize = 3;
const ANYWHERE: usize = 4;
const BESIDE: usize = 4;
/// Turns that are tried at a time: all of few, some of many.
const TURNS: usize = 4;
/// Bays that are tried at a time besides the body's own.
const BAYS: usize = 8;
/// Of all lines so many are refined, which must lie this share of the body's length apart.
const KEPT: usize = 2;
const APART: f64 = 0.02;
/// "Near" spans this share of the body's length; slides begin with the second share and end with the third, of a typical extent.
const NEARNESS: f64 = 0.25;
const BOLDEST: f64 = 0.05;
const FINEST: f64 = 2e-5;
/// A slide that gained nothing is this much shorter next time.
const SHORTER: f64 = 0.3;

/// Looks for places.
#[derive(Debug, Clone)]
pub(super) struct Relocate {
    look: Look,
    /// Typical extent of a body, mm.
    scale: f64,
    /// The best lines, cheapest first.
    kept: Vec<Found>,
}

impl Relocate {
    pub(super) fn new(scene: &Scene) -> Relocate {
        let n = scene.bodies.len().max(1);
        let area: f64 = (0..scene.bodies.len()).map(|b| scene.box_area(b)).sum();
        Relocate { look: Look::default(), scale: (area / n as f64).sqrt(), kept: Vec::new() }
    }

    /// The cheapest place found for a body, or where it is `now` when none is cheaper.
    pub(super) fn search(
        &mut self,
        scene: &mut Scene,
        pairs: &Pairs,
        random: &mut Random,
        body: usize,
        now: Found,
    ) -> Found {
        self.kept.clear();
        for bay in some_of(scene.bays.len(), BAYS, now.pose.bay, random) {
            for turn in some_of(scene.bodies[body].turns.len(), TURNS, now.pose.turn, random) {
                for x in self.lines(scene, random, body, now, (turn, bay)) {
                    let bound = if self.kept.len() < KEPT { f64::INFINITY } else { self.kept[KEPT - 1].cost };
                    let line = Line { turn, bay, x };
                    let Some(found) = self.look.along(scene, pairs, body, line, bound) else { continue };
                    if found.cost == 0.0 {
                        return found;
                    }
                    self.keep(found, APART * scene.shape(body, turn).size.x);
                }
            }
        }
        let mut best = now;
        for k in 0..self.kept.len() {
            let refined = self.refined(scene, pairs, random, body, self.kept[k]);
            if refined.cost < best.cost {
                best = refined;
            }
            if best.cost == 0.0 {
                break;
            }
        }
        best
    }

    /// Where along x to look.
    fn lines(
        &self,
        scene: &Scene,
        random: &mut Random,
        body: usize,
        now: Found,
        (turn, bay): (usize, usize),
    ) -> Vec<f64> {
        let Some((end, _)) = scene.bays[bay].reach(scene.shape(body, turn)) else { return Vec::new() };
        let width = scene.shape(body, turn).size.x;
        let mut xs = Vec::with_capacity(2 + NEAR + ANYWHERE + BESIDE);
        if now.pose.bay == bay {
            xs.push(now.pose.x);
            for _ in 0..NEAR {
                let far = random.half_normal(NEARNESS * width.max(self.scale));
                xs.push(if random.coin() { now.pose.x - far } else { now.pose.x + far });
            }
        }
        xs.extend((0..ANYWHERE).map(|_| random.between(0.0, end)));
        for _ in 0..BESIDE {
            let other = random.below(scene.bodies.len());
            if other != body && scene.poses[other].bay == bay {
                xs.push(if random.coin() { scene.poses[other].x - width } else { scene.right(other) });
            }
        }
        xs.push(if random.coin() { 0.0 } else { end });
        xs.iter_mut().for_each(|x| *x = x.clamp(0.0, end));
        xs
    }

    /// Remembers a line if it is among the cheapest; of lines close to each other only the cheapest.
    fn keep(&mut self, found: Found, apart: f64) {
        let same = |k: &Found| (k.pose.turn, k.pose.bay) == (found.pose.turn, found.pose.bay);
        match self.kept.iter_mut().find(|k| same(k) && (k.pose.x - found.pose.x).abs() < apart) {
            Some(near) if found.cost < near.cost => *near = found,
            Some(_) => {}
            None => self.kept.push(found),
        }
        self.kept.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        self.kept.truncate(KEPT);
    }

    /// Slides along x while that gets cheaper, in shrinking steps.
    fn refined(&mut self, scene: &mut Scene, pairs: &Pairs, random: &mut Random, body: usize, start: Found) -> Found {
        let Line { turn, bay, .. } = Line { turn: start.pose.turn, bay: start.pose.bay, x: start.pose.x };
        let shape = scene.shape(body, turn);
        let mut step = BOLDEST * self.scale.max(shape.size.x);
        let Some((end, _)) = scene.bays[bay].reach(shape) else { return start };
        let mut best = start;
        while step > FINEST * self.scale && best.cost > 0.0 {
            let first = if random.coin() { step } else { -step };
            let cheaper = [first, -first].into_iter().find_map(|dx| {
                let x = (best.pose.x + dx).clamp(0.0, end);
                if x == best.pose.x {
                    return None;
                }
                self.look.along(scene, pairs, body, Line { turn, bay, x }, best.cost)
            });
            match cheaper {
                Some(found) => best = found,
                None => step *= SHORTER,
            }
        }
        best
    }
}

/// All of the first `n` numbers when they are few; else `own`, if it is one of them, and `most` others.
fn some_of(n: usize, most: usize, own: usize, random: &mut Random) -> Vec<usize> {
    if n <= most {
        return (0..n).collect();
    }
    let mut some: Vec<usize> = (0..n).collect();
    random.shuffle(&mut some);
    some.truncate(most);
    if own < n && !some.contains(&own) {
        some.push(own);
    }
    some
}
