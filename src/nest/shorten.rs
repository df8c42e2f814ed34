//! Makes the used length of one bay shorter: exploration with bold steps and new starts, then compression with small ones (algorithms 11 to 13 of
//! arXiv:2509.13329).

use super::scene::{Pose, Scene};
use super::separate::{Patience, Separator};
use std::ops::ControlFlow;

/// Greatest x of a body in the bay, from its left border.
pub(super) fn used(scene: &Scene, bay: usize) -> f64 {
    let ends = (0..scene.bodies.len()).filter(|b| scene.poses[*b].bay == bay && !scene.bodies[*b].fixed);
    ends.map(|b| scene.right(b)).fold(scene.bays[bay].x, f64::max) - scene.bays[bay].x
}

/// Makes the bay `width` wide: what lies beyond `cut` comes closer.
fn shrink(scene: &mut Scene, bay: usize, width: f64, cut: f64) {
    let left = scene.bays[bay].x;
    let by = scene.bays[bay].width - width;
    scene.bays[bay].width = width;
    for body in 0..scene.bodies.len() {
        let pose = scene.poses[body];
        if pose.bay != bay || scene.bodies[body].fixed {
            continue;
        }
        let size = scene.lying(body).size.x;
        let x = if pose.x + 0.5 * size > cut { pose.x - by } else { pose.x };
        scene.poses[body].x = x.min(left + width - size).max(left);
    }
}

const EXPLORE: Patience = Patience { rounds: 60, strikes: 2 };
const COMPRESS: Patience = Patience { rounds: 60, strikes: 3 };
pub static mut TRACE: bool = false;

pub(super) fn shorten(
    scene: &mut Scene,
    bay: usize,
    separator: &mut Separator,
    least: f64,
    until: u64,
    keep_on: &mut dyn FnMut(&Scene) -> ControlFlow<()>,
) {
    let begin = scene.looked;
    let explore_until = begin + (until - begin) / 10 * 8;
    let mut stop = |scene: &Scene, until: u64| -> ControlFlow<()> {
        if scene.looked >= until { ControlFlow::Break(()) } else { keep_on(scene) }
    };
    scene.bays[bay].width = used(scene, bay);
    let mut best = scene.clone();
    let mut ratio = 0.02;
    let mut pool: Vec<(f64, Vec<Pose>)> = Vec::new();
    // Exploration.
    while scene.looked < explore_until && best.bays[bay].width > least {
        if pool.is_empty() {
            let width = best.bays[bay].width;
            let target = (width * (1.0 - ratio)).max(least);
            scene.poses.clone_from(&best.poses);
            scene.bays.clone_from(&best.bays);
            let cut = scene.bays[bay].x + separator.random.unit() * width;
            shrink(scene, bay, target, cut);
        }
        if separator.separate(scene, EXPLORE, &mut |s| stop(s, explore_until)) {
            scene.bays[bay].width = used(scene, bay);
            best.poses.clone_from(&scene.poses);
            best.bays.clone_from(&scene.bays);
            if unsafe { TRACE } { eprintln!("explore {} -> {:.2}", scene.looked, scene.bays[bay].width); }
            pool.clear();
        } else {
            if ratio > 0.001 { ratio = f64::max(ratio * 0.5, 0.001);
                pool.clear(); continue; }
            let overlap = separator.overlap();
            let at = pool.partition_point(|p| p.0 < overlap);
            pool.insert(at, (overlap, scene.poses.clone()));
            let pick = ((separator.random.half_normal(0.25) * pool.len() as f64) as usize).min(pool.len() - 1);
            scene.poses.clone_from(&pool[pick].1);
            disrupt(scene, bay, separator);
        }
    }
    // Compression.
    scene.looked = scene.looked.max(explore_until.min(scene.looked));
    let from = scene.looked;
    while scene.looked < until && best.bays[bay].width > least {
        let share = (scene.looked - from) as f64 / (until - from).max(1) as f64;
        let ratio = 0.0005 * (0.00001_f64 / 0.0005).powf(share);
        let width = best.bays[bay].width;
        scene.poses.clone_from(&best.poses);
        scene.bays.clone_from(&best.bays);
        let cut = scene.bays[bay].x + separator.random.unit() * width;
        shrink(scene, bay, (width * (1.0 - ratio)).max(least), cut);
        if separator.separate(scene, COMPRESS, &mut |s| stop(s, until)) {
            scene.bays[bay].width = used(scene, bay);
            best.poses.clone_from(&scene.poses);
            best.bays.clone_from(&scene.bays);
            if unsafe { TRACE } { eprintln!("compress {} -> {:.2}", scene.looked, scene.bays[bay].width); }
        } else if stop(scene, until).is_break() {
            break;
        }
    }
    scene.poses = best.poses;
    scene.bays = best.bays;
}

/// Two large bodies change places.
fn disrupt(scene: &mut Scene, bay: usize, separator: &mut Separator) {
    let area = |b: usize| scene.lying(b).size.x * scene.lying(b).size.y;
    let mut large: Vec<usize> =
        (0..scene.bodies.len()).filter(|b| scene.poses[*b].bay == bay && !scene.bodies[*b].fixed).collect();
    large.sort_by(|a, b| area(*b).total_cmp(&area(*a)));
    let total: f64 = large.iter().map(|b| area(*b)).sum();
    let mut sum = 0.0;
    let count = large.iter().take_while(|b| { sum += area(**b); sum < 0.75 * total }).count().max(2).min(large.len());
    if count < 2 { return; }
    let a = large[separator.random.below(count)];
    let mut b = a;
    for _ in 0..20 {
        b = large[separator.random.below(count)];
        if a != b && (scene.lying(a).size - scene.lying(b).size).norm() > 1e-6 { break; }
    }
    let (p, q) = (scene.poses[a], scene.poses[b]);
    let center = |s: &Scene, k: usize| s.poses[k].x + 0.5 * s.lying(k).size.x;
    let center_y = |s: &Scene, k: usize| s.poses[k].y + 0.5 * s.lying(k).size.y;
    let (ca, cb) = ((center(scene, a), center_y(scene, a)), (center(scene, b), center_y(scene, b)));
    for (body, to, pose) in [(a, cb, p), (b, ca, q)] {
        let size = scene.lying(body).size;
        let bay = &scene.bays[bay];
        scene.poses[body] = Pose {
            x: (to.0 - 0.5 * size.x).min(bay.x + bay.width - size.x).max(bay.x),
            y: (to.1 - 0.5 * size.y).min(bay.height - size.y).max(0.0),
            ..pose
        };
    }
}
