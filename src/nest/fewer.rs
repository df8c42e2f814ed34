//! Getting by with less stock.

use super::scene::{Bay, Scene};
use super::search::Job;
use super::separate::Separator;
use super::squeeze::squeeze;
use super::watch::Watch;

/// Nothing gets denser than this.
const DENSEST: f64 = 0.995;
/// One of several ways to save stock may take this share of the effort that is left.
const SHARE: f64 = 0.6;

/// A kind of stock, and the kind that replaces it, if one does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Saving {
    container: usize,
    instead: Option<usize>,
}

impl Job<'_> {
    /// Makes room for what found no place.
    pub(super) fn house_all(&self, scene: &mut Scene, separator: &mut Separator, watch: &mut Watch, until: u64) {
        let homeless = scene.homeless();
        let room: f64 = scene.bays.iter().map(|b| self.grounds.grounds[b.container].area).sum();
        let holds = |body: usize| {
            let fits = |bay: &Bay| scene.bodies[body].turns.iter().any(|t| bay.reach(t).is_some());
            scene.bays.iter().any(fits)
        };
        if !homeless.is_empty() && homeless.into_iter().all(holds) && self.takes() < DENSEST * room {
            squeeze(scene, separator, watch, until);
        }
    }

    /// Gets by with less stock: without a bay, or with a cheaper one in its place, the greatest saving first.
    pub(super) fn fewer(&self, scene: &mut Scene, separator: &mut Separator, watch: &mut Watch, until: u64) {
        let mut tried: Vec<Saving> = Vec::new();
        while scene.homeless().is_empty() && !watch.is_over(scene, until) {
            let savings = self.savings(scene, &tried);
            let Some((bay, saving)) = savings.first().copied() else { break };
            let left = until - scene.looked;
            let share = if savings.len() > 1 { (left as f64 * SHARE) as u64 } else { left };
            let before = scene.clone();
            scene.close(bay);
            if let Some(kind) = saving.instead {
                self.grounds.open(scene, kind);
            }
            if squeeze(scene, separator, watch, before.looked + share) {
                watch.tell(self.note(scene));
            } else {
                let looked = scene.looked;
                *scene = before;
                scene.looked = looked;
                tried.push(saving);
            }
        }
    }

    /// Every bay whose loss or exchange saves something and leaves enough area, the greatest saving first, then the bay with the least on it.
    fn savings(&self, scene: &Scene, tried: &[Saving]) -> Vec<(usize, Saving)> {
        let ground = |k: usize| &self.grounds.grounds[k];
        let room: f64 = scene.bays.iter().map(|b| ground(b.container).area).sum();
        let needed = self.takes() / DENSEST;
        let mut savings: Vec<([f64; 3], (usize, Saving))> = Vec::new();
        for bay in 0..scene.bays.len() {
            let Some(container) = self.closable(scene, bay) else { continue };
            let filled: f64 = scene.movable(bay).map(|b| self.ready[self.copies[b].0].area).sum();
            for instead in [None].into_iter().chain((0..self.containers.len()).map(Some)) {
                let saving = Saving { container, instead };
                let (area, cost) = instead.map_or((0.0, 0.0), |k| (ground(k).area, ground(k).cost));
                let gain = ground(container).cost - cost;
                // At the same cost the stock named first is preferred, and no sheet to any.
                let saves = gain > 0.0 || (gain == 0.0 && instead.is_none_or(|k| k < container));
                let there = instead.is_none_or(|k| k != container && self.grounds.has_more(scene, k));
                if saves && there && room - ground(container).area + area >= needed && !tried.contains(&saving) {
                    let rank = instead.map_or(0.0, |k| k as f64 + 1.0);
                    savings.push(([-gain, rank, filled], (bay, saving)));
                }
            }
        }
        savings.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal));
        savings.into_iter().map(|(_, saving)| saving).collect()
    }

    /// Area all items take up with the spacing around them, mm2.
    fn takes(&self) -> f64 {
        self.copies.iter().map(|(item, _)| self.ready[*item].takes).sum()
    }

    /// The container of a bay that nothing is fixed in.
    fn closable(&self, scene: &Scene, bay: usize) -> Option<usize> {
        let fixed = (0..self.copies.len()).any(|b| scene.bodies[b].fixed && scene.poses[b].bay == bay);
        (!fixed).then(|| scene.bays[bay].container)
    }
}
