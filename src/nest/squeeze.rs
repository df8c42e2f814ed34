//! Brings bodies without a place into the bays there are: everything makes room for them.

use super::scene::{Pose, Scene};
use super::separate::{Patience, Separator};
use super::shorten::exchange;
use super::watch::Watch;

const PATIENCE: Patience = Patience { rounds: 60, strikes: 2 };
/// Failed layouts from which new starts are made: the least overlapping ones, and how far down the list they are picked as a share of it.
const POOL: usize = 20;
const PICK: f64 = 0.25;

/// Places everything that has no place in the open bays, if that can be done before so many lines are looked along. The scene stays as it was when not.
pub(super) fn squeeze(scene: &mut Scene, separator: &mut Separator, watch: &mut Watch, until: u64) -> bool {
    let before = scene.poses.clone();
    let mut homeless = scene.homeless();
    homeless.sort_by(|a, b| scene.box_area(*b).total_cmp(&scene.box_area(*a)));
    if !homeless.iter().all(|body| separator.insert(scene, *body)) {
        scene.poses = before;
        return false;
    }
    let mut failed: Vec<(f64, Vec<Pose>)> = Vec::new();
    while !watch.is_over(scene, until) {
        if separator.separate(scene, PATIENCE, watch, until) {
            return true;
        }
        let overlap = separator.overlap();
        let rank = failed.partition_point(|f| f.0 < overlap);
        failed.insert(rank, (overlap, scene.poses.clone()));
        failed.truncate(POOL);
        let rank = (separator.random.half_normal(PICK) * failed.len() as f64) as usize;
        scene.poses.clone_from(&failed[rank.min(failed.len() - 1)].1);
        exchange(scene, separator);
    }
    scene.poses = before;
    false
}
