//! Makes the used length of one bay shorter: exploration with bold cuts and new starts, then compression with small cuts (the two phases of
//! arXiv:2509.13329).

use super::scene::{Pose, Scene};
use super::separate::{Patience, Separator};
use super::watch::Watch;

/// Share of the effort for exploration.
const EXPLORE_SHARE: f64 = 0.8;
const EXPLORE: Patience = Patience { rounds: 15, strikes: 2 };
const COMPRESS: Patience = Patience { rounds: 40, strikes: 2 };
/// Exploration cuts this share of the length off, less after every failure, and new starts are made at the last.
const BOLD_CUT: f64 = 0.02;
const FINE_CUT: f64 = 0.001;
/// Compression begins and ends with these shares.
const FIRST_CUT: f64 = 5e-4;
const LAST_CUT: f64 = 1e-5;
/// New starts are drawn from failed layouts, the least overlapping of which come first: the deviation of the rank as a share of all.
const PICK: f64 = 0.25;
/// Bodies that hold this share of all area are large enough for an exchange to matter.
const LARGE_SHARE: f64 = 0.75;

/// The shortest complete layout so far.
struct Best {
    poses: Vec<Pose>,
    width: f64,
}

/// Shortens one bay.
pub(super) struct Shorten<'a, 'b> {
    pub(super) scene: &'a mut Scene,
    pub(super) separator: &'a mut Separator,
    pub(super) watch: &'a mut Watch<'b>,
    /// The bay, and the number of bodies that are items.
    pub(super) bay: usize,
    pub(super) items: usize,
    /// Nothing is gained below this length.
    pub(super) least: f64,
}

impl Shorten<'_, '_> {
    /// Shortens the bay until so many lines are looked along. The scene must be complete and without overlaps, and stays so; its bay becomes as wide as
    /// what lies in it.
    pub(super) fn run(mut self, until: u64, tell: impl Fn(&Scene) -> String) {
        let from = self.scene.looked;
        let explore_until = from + ((until.saturating_sub(from)) as f64 * EXPLORE_SHARE) as u64;
        let mut best = Best { poses: Vec::new(), width: f64::INFINITY };
        self.keep(&mut best);
        self.watch.tell(tell(self.scene));
        let mut cut = BOLD_CUT;
        let mut failed: Vec<(f64, Vec<Pose>)> = Vec::new();
        while self.is_longer(&best) && !self.watch.is_over(self.scene, explore_until) {
            if failed.is_empty() {
                self.cut(&best, cut);
            }
            if self.separator.separate(self.scene, EXPLORE, self.watch, explore_until) {
                self.keep(&mut best);
                self.watch.tell(tell(self.scene));
                failed.clear();
            } else if cut > FINE_CUT {
                cut = (0.5 * cut).max(FINE_CUT);
            } else {
                let overlap = self.separator.overlap();
                let rank = failed.partition_point(|f| f.0 < overlap);
                failed.insert(rank, (overlap, self.scene.poses.clone()));
                let rank = (self.separator.random.half_normal(PICK) * failed.len() as f64) as usize;
                self.scene.poses.clone_from(&failed[rank.min(failed.len() - 1)].1);
                exchange(self.scene, self.separator);
            }
        }
        let from = self.scene.looked;
        while self.is_longer(&best) && !self.watch.is_over(self.scene, until) {
            let share = (self.scene.looked - from) as f64 / (until - from) as f64;
            self.cut(&best, FIRST_CUT * (LAST_CUT / FIRST_CUT).powf(share));
            if self.separator.separate(self.scene, COMPRESS, self.watch, until) {
                self.keep(&mut best);
                self.watch.tell(tell(self.scene));
            }
        }
        self.scene.poses = best.poses;
        self.scene.bays[self.bay].width = best.width;
    }

    /// True while something is left to gain: places and lengths do not add up to the least length to the last digit.
    fn is_longer(&self, best: &Best) -> bool {
        best.width > self.least + super::NARROW_MM
    }

    /// Takes the layout as it lies for the best.
    fn keep(&mut self, best: &mut Best) {
        best.width = self.scene.used(self.bay, self.items);
        self.scene.bays[self.bay].width = best.width;
        best.poses.clone_from(&self.scene.poses);
    }

    /// The best layout, shorter by a share: what lies beyond a random place comes closer.
    fn cut(&mut self, best: &Best, share: f64) {
        let width = (best.width * (1.0 - share)).max(self.least);
        let place = self.separator.random.between(0.0, best.width);
        self.scene.poses.clone_from(&best.poses);
        self.scene.bays[self.bay].width = width;
        let movable: Vec<usize> = self.scene.movable(self.bay).collect();
        for body in movable {
            let length = self.scene.lying(body).size.x;
            let pose = &mut self.scene.poses[body];
            if pose.x + 0.5 * length > place {
                pose.x -= best.width - width;
            }
            pose.x = pose.x.min(width - length).max(0.0);
        }
    }
}

/// Two large bodies change places.
pub(super) fn exchange(scene: &mut Scene, separator: &mut Separator) {
    let mut large: Vec<usize> =
        (0..scene.bodies.len()).filter(|b| !scene.bodies[*b].fixed && !scene.poses[*b].is_none()).collect();
    large.sort_by(|a, b| scene.box_area(*b).total_cmp(&scene.box_area(*a)));
    let mut room: f64 = LARGE_SHARE * large.iter().map(|b| scene.box_area(*b)).sum::<f64>();
    let count = large.iter().take_while(|b| (room > 0.0, room -= scene.box_area(**b)).0).count();
    // Equal bodies in each other's places change nothing: a few tries to find two that differ and fit.
    for _ in 0..2 * count {
        let (a, b) = (large[separator.random.below(count)], large[separator.random.below(count)]);
        if (scene.shape(a, 0).size - scene.shape(b, 0).size).norm() < super::NARROW_MM {
            continue;
        }
        if let (Some(p), Some(q)) = (in_place_of(scene, a, b), in_place_of(scene, b, a)) {
            scene.poses[a] = p;
            scene.poses[b] = q;
            return;
        }
    }
}

/// `body` with its middle where `other` has it, as far as the bay allows.
fn in_place_of(scene: &Scene, body: usize, other: usize) -> Option<Pose> {
    let there = scene.poses[other];
    let size = scene.lying(body).size;
    let (right, top) = scene.bays[there.bay].reach(scene.lying(body))?;
    let shift = 0.5 * (scene.lying(other).size - size);
    let (x, y) = ((there.x + shift.x).clamp(0.0, right), (there.y + shift.y).clamp(0.0, top));
    Some(Pose { turn: scene.poses[body].turn, bay: there.bay, x, y })
}
