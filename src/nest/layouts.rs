//! What a scene comes to in the caller's terms.

use super::look::Look;
use super::scene::Scene;
use super::search::Job;
use super::{Container, Layout, Layouts, Placement, Reason, Unplaced, start};
use crate::geom::V2;

impl Job<'_> {
    /// A layout for every bay that is used, and what found no place.
    pub(super) fn layouts(&self, scene: &Scene, stopped_early: bool) -> Layouts {
        let mut layouts: Vec<Layout> = Vec::new();
        for (k, bay) in scene.bays.iter().enumerate() {
            let mut bodies: Vec<usize> = (0..self.copies.len()).filter(|b| scene.poses[*b].bay == k).collect();
            if bodies.is_empty() {
                continue;
            }
            // Along the feed.
            bodies.sort_by(|a, b| scene.poses[*a].x.total_cmp(&scene.poses[*b].x));
            let container = &self.containers[bay.container];
            let size = container.size_mm();
            let used_mm = scene.used(k, self.copies.len()) + 2.0 * self.grounds.offset.x;
            let width_mm = match container {
                Container::Sheet { .. } => size.x,
                // An exact fit may end a round-off beyond the longest layout.
                Container::Roll { .. } => used_mm.min(size.x),
            };
            let filled: f64 = bodies.iter().map(|b| self.ready[self.copies[*b].0].area).sum();
            let placements = bodies.iter().map(|b| self.placement(scene, *b)).collect();
            let density = filled / (width_mm * size.y);
            layouts.push(Layout { container: bay.container, width_mm, height_mm: size.y, placements, density });
        }
        let unplaced = scene.homeless().into_iter().map(|b| Unplaced {
            item: self.copies[b].0,
            copy: self.copies[b].1,
            name: self.items[self.copies[b].0].name.clone(),
            reason: self.reason(scene, b),
        });
        Layouts { layouts, unplaced: unplaced.collect(), stopped_early }
    }

    fn placement(&self, scene: &Scene, body: usize) -> Placement {
        let (item, copy) = self.copies[body];
        let pose = scene.poses[body];
        let turn = self.ready[item].turns[pose.turn];
        let shift = match self.items[item].fixed {
            Some(fixed) => fixed.shift,
            None => V2::new(pose.x, pose.y) + self.grounds.offset - scene.lying(body).origin,
        };
        Placement { item, copy, mirrored: turn.mirrored, rotation_deg: turn.angle_deg, shift }
    }

    /// Why a body found no place.
    fn reason(&self, scene: &Scene, body: usize) -> Reason {
        let mut nearest = (f64::INFINITY, 0);
        for (k, ground) in self.grounds.grounds.iter().enumerate() {
            for shape in scene.bodies[body].turns.iter() {
                let missing = (shape.size - V2::new(ground.bay.width, ground.bay.height)).max();
                if missing < nearest.0 {
                    nearest = (missing, k);
                }
            }
        }
        if nearest.0 > super::NARROW_MM {
            return Reason::TooLarge { container: self.containers[nearest.1].name().to_string(), by_mm: nearest.0 };
        }
        let mut empty = Scene::new(scene.bodies[..self.copies.len()].to_vec());
        let fits = (0..self.containers.len()).any(|kind| {
            let bay = self.grounds.open(&mut empty, kind);
            start::leftmost(&mut empty, &mut Look::default(), body, bay).is_some()
        });
        if fits { Reason::StockUsedUp } else { Reason::NoRoom }
    }
}
