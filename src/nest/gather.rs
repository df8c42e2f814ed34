//! The last touch, at no cost: sets come together on one sheet, and everything slides left.

use super::look::Look;
use super::scene::Scene;
use super::start::{leftmost, slid_left};
use std::collections::BTreeMap;

/// Moves members of sets to the bay where most of the set lies, as long as there is room for them as it is.
pub(super) fn gather(scene: &mut Scene, sets: &[Option<u32>]) {
    let mut look = Look::default();
    let mut members: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (body, set) in sets.iter().enumerate() {
        if let Some(set) = set.filter(|_| !scene.poses[body].is_none()) {
            members.entry(set).or_default().push(body);
        }
    }
    for bodies in members.values() {
        let share = |bay: usize| bodies.iter().filter(|b| scene.poses[**b].bay == bay).count();
        // Of equals the first.
        let Some(home) = (0..scene.bays.len()).rev().max_by_key(|bay| share(*bay)) else { continue };
        for &body in bodies {
            if scene.bodies[body].fixed || scene.poses[body].bay == home {
                continue;
            }
            if let Some(pose) = leftmost(scene, &mut look, body, home) {
                scene.poses[body] = pose;
            }
        }
    }
}

/// Slides everything left, the leftmost first.
pub(super) fn settle(scene: &mut Scene) {
    let mut look = Look::default();
    for bay in 0..scene.bays.len() {
        let mut bodies: Vec<usize> = scene.movable(bay).collect();
        bodies.sort_by(|a, b| scene.poses[*a].x.total_cmp(&scene.poses[*b].x));
        for body in bodies {
            scene.poses[body] = slid_left(scene, &mut look, body, scene.poses[body]);
        }
    }
}
