//! A complete layout at once: every body goes as far left as it can, one after the other.

use super::look::{Line, Look};
use super::scene::{Pose, Scene};
use super::watch::Watch;

/// First step of a slide to the left as a share of a body's length, and the last.
const SLIDE: f64 = 0.1;
const SLIDE_END: f64 = 1e-4;

/// So many lines, a fraction of a second's, are looked along before a stop makes the first layout a hasty one.
const AT_LEAST: u64 = 20_000;

/// The leftmost free place for `body` in a bay, among those where its box touches another's and what sliding left from there finds.
pub(super) fn leftmost(scene: &mut Scene, look: &mut Look, body: usize, bay: usize) -> Option<Pose> {
    let mut best: Option<(f64, Pose)> = None;
    for turn in 0..scene.bodies[body].turns.len() {
        let width = scene.shape(body, turn).size.x;
        let Some((end, _)) = scene.bays[bay].reach(scene.shape(body, turn)) else { continue };
        let mut xs = vec![0.0, end];
        for other in (0..scene.bodies.len()).filter(|o| scene.poses[*o].bay == bay && *o != body) {
            xs.extend(
                [scene.right(other), scene.poses[other].x - width].into_iter().filter(|x| (0.0..=end).contains(x)),
            );
        }
        xs.sort_by(f64::total_cmp);
        xs.dedup();
        let mut nearer = xs.into_iter().take_while(|x| best.is_none_or(|(right, _)| x + width < right));
        if let Some(pose) = nearer.find_map(|x| look.free(scene, body, Line { turn, bay, x })) {
            let pose = slid_left(scene, look, body, pose);
            if best.is_none_or(|(right, _)| pose.x + width < right) {
                best = Some((pose.x + width, pose));
            }
        }
    }
    best.map(|(_, pose)| pose)
}

/// As far left as steps that end in free places lead.
pub(super) fn slid_left(scene: &mut Scene, look: &mut Look, body: usize, pose: Pose) -> Pose {
    let Pose { turn, bay, .. } = pose;
    let width = scene.shape(body, turn).size.x;
    let mut best = pose;
    let mut step = SLIDE * width;
    while step > SLIDE_END * width && best.x > 0.0 {
        match look.free(scene, body, Line { turn, bay, x: (best.x - step).max(0.0) }) {
            Some(pose) => best = pose,
            None => step *= 0.5,
        }
    }
    best
}

/// In line with, or else behind, the foremost body of the last bay: hardly looked for at all.
fn behind(scene: &mut Scene, look: &mut Look, body: usize) -> Option<Pose> {
    let bay = scene.bays.len().checked_sub(1)?;
    let foremost = scene.movable(bay).max_by(|a, b| scene.poses[*a].x.total_cmp(&scene.poses[*b].x))?;
    let end = scene.movable(bay).map(|b| scene.right(b)).fold(0.0, f64::max);
    let turns = 0..scene.bodies[body].turns.len();
    let xs = [scene.poses[foremost].x, end];
    let mut lines = xs.into_iter().flat_map(|x| turns.clone().map(move |turn| Line { turn, bay, x }));
    lines.find_map(|line| {
        let (right, _) = scene.bays[bay].reach(scene.shape(body, line.turn))?;
        if line.x <= right { look.free(scene, body, line) } else { None }
    })
}

/// Places bodies in the given order, each in the first bay with room for it; `open` makes another bay for a body that fits none, if there is one. What
/// finds no place keeps none. Once the caller stops the search, the rest of many bodies go behind the others.
pub(super) fn place(
    scene: &mut Scene,
    order: &[usize],
    watch: &mut Watch,
    mut open: impl FnMut(&mut Scene, usize) -> Option<Pose>,
) {
    let mut look = Look::default();
    for &body in order {
        let hurried = watch.is_over(scene, u64::MAX) && scene.looked > AT_LEAST;
        let free = match hurried {
            true => behind(scene, &mut look, body),
            false => (0..scene.bays.len()).find_map(|bay| leftmost(scene, &mut look, body, bay)),
        };
        if let Some(pose) = free.or_else(|| open(scene, body)) {
            scene.poses[body] = pose;
        }
    }
}
