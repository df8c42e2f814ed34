//! A complete layout at once: every body goes as far left as it can, the largest first.

use super::look::{Found, Look, Weights};
use super::scene::{Bay, Pose, Scene};

/// All overlaps matter alike.
struct Alike;

impl Weights for Alike {
    fn weight(&self, _: usize, _: usize) -> f64 {
        1.0
    }
}

/// A bay that does not exist: where bodies are that have no place yet.
pub(super) const NOWHERE: usize = usize::MAX;

/// The pose of a body without a place.
pub(super) const UNPLACED: Pose = Pose { turn: 0, bay: NOWHERE, x: 0.0, y: 0.0 };

/// The leftmost free place for `body` in a bay, among those beside other bodies' boxes and what sliding left from there finds.
pub(super) fn leftmost(scene: &mut Scene, look: &mut Look, body: usize, bay: usize) -> Option<Pose> {
    let mut best: Option<(f64, Pose)> = None;
    for turn in 0..scene.bodies[body].turns.len() {
        let size = scene.shape(body, turn).size;
        let Some((x0, x1)) = scene.reach(scene.shape(body, turn), &scene.bays[bay]) else { continue };
        let mut xs = vec![x0];
        for other in (0..scene.bodies.len()).filter(|o| scene.poses[*o].bay == bay) {
            xs.extend([scene.right(other), scene.poses[other].x - size.x]);
        }
        xs.retain(|x| *x >= x0 && *x <= x1);
        xs.sort_by(f64::total_cmp);
        xs.dedup();
        for x in xs {
            if best.is_some_and(|(right, _)| x + size.x >= right) {
                break;
            }
            let Some(found) = free(scene, look, body, (turn, bay, x)) else { continue };
            let pose = slid_left(scene, look, body, found, x0);
            if best.is_none_or(|(right, _)| pose.x + size.x < right) {
                best = Some((pose.x + size.x, pose));
            }
            break;
        }
    }
    best.map(|(_, pose)| pose)
}

fn free(scene: &mut Scene, look: &mut Look, body: usize, at: (usize, usize, f64)) -> Option<Pose> {
    let found: Found = look.along(scene, &Alike, body, at, f64::MIN_POSITIVE)?;
    Some(found.pose)
}

fn slid_left(scene: &mut Scene, look: &mut Look, body: usize, pose: Pose, x0: f64) -> Pose {
    let mut best = pose;
    let mut step = 0.1 * scene.shape(body, pose.turn).size.x;
    let finest = 1e-3 * step;
    while step > finest {
        let x = (best.x - step).max(x0);
        match free(scene, look, body, (pose.turn, pose.bay, x)) {
            Some(pose) if x < best.x => best = pose,
            _ => step *= 0.5,
        }
    }
    best
}

/// Places bodies in the given order, each in the first bay with room for it; `open` makes another bay for a body that fits none, or says that there
/// is none. Returns those without a place.
pub(super) fn place_all(
    scene: &mut Scene,
    order: &[usize],
    mut open: impl FnMut(&Scene, usize) -> Option<Bay>,
) -> Vec<usize> {
    let mut look = Look::default();
    let mut left = Vec::new();
    for &body in order {
        let mut pose = (0..scene.bays.len()).find_map(|bay| leftmost(scene, &mut look, body, bay));
        if pose.is_none()
            && let Some(bay) = open(scene, body)
        {
            scene.bays.push(bay);
            pose = leftmost(scene, &mut look, body, scene.bays.len() - 1);
        }
        match pose {
            Some(pose) => scene.poses[body] = pose,
            None => left.push(body),
        }
    }
    left
}
