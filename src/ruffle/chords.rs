//! Layers whose height follows the outline's width.

use super::ladder::Slab;
use super::stack::{MIN_CHORD_MM, StackError, StackSettings, layer_count, too_small};
use crate::cut::Outline;

/// Step of the scan over heights, mm.
const SCAN_MM: f64 = 0.5;
/// A way on that keeps less than this share of the width is a horn.
const HORN_SHARE: f64 = 0.6;

/// Widths of the outline over height: one chord per scan line, following the widest first and then whatever overlaps it most.
fn chords(outline: &Outline) -> Vec<(f64, f64, f64)> {
    let bounds = outline.bounds();
    let lines = ((bounds.height() / SCAN_MM) as usize).max(1);
    let mut chords: Vec<(f64, f64, f64)> = Vec::new();
    let overlap = |a: (f64, f64), b: (f64, f64)| a.1.min(b.1) - a.0.max(b.0);
    for i in 0..lines {
        let v = bounds.min.y + (i as f64 + 0.5) * bounds.height() / lines as f64;
        let previous = chords.last().map(|(_, l, r)| (*l, *r));
        let all = outline.chords(v);
        let reached = |c: &&(f64, f64)| previous.is_none_or(|p| overlap(p, **c) > 0.0);
        let score = |c: &(f64, f64)| previous.map_or(c.1 - c.0, |p| overlap(*c, p));
        let Some(best) = all.iter().filter(reached).max_by(|a, b| score(a).total_cmp(&score(b))) else { continue };
        // Where the outline parts into horns of which none goes on as wide, the stack ends: one strip does not follow two ways.
        let parted = all.iter().filter(reached).count() > 1;
        if parted && previous.is_some_and(|p| best.1 - best.0 < HORN_SHARE * (p.1 - p.0)) {
            break;
        }
        chords.push((v, best.0, best.1));
    }
    let wide_enough = |c: &(f64, f64, f64)| c.2 - c.1 >= MIN_CHORD_MM;
    let Some(from) = chords.iter().position(wide_enough) else { return Vec::new() };
    let to = chords.iter().rposition(wide_enough).map_or(from, |i| i + 1);
    // Below the first wide chord the foot still stands on the floor, so the lowest slab reaches down to it.
    chords[..from].iter_mut().for_each(|c| *c = (c.0, f64::NAN, f64::NAN));
    chords.truncate(to);
    chords
}

/// Cuts the outline into layers whose height follows its width.
pub(super) fn slabs(outline: &Outline, aspect: f64, settings: &StackSettings) -> Result<Vec<Slab>, StackError> {
    let chords = chords(outline);
    let too_small = || too_small(outline, settings);
    let (Some(first), Some(last)) = (chords.first(), chords.last()) else { return Err(too_small()) };
    let step = outline.bounds().height() / ((outline.bounds().height() / SCAN_MM) as usize).max(1) as f64;
    let (bottom, top) = (first.0 - step / 2.0, last.0 + step / 2.0);
    if top - bottom < settings.min_layer_mm {
        return Err(too_small());
    }
    let ideal = |c: &(f64, f64, f64)| {
        let width = if c.1.is_nan() { MIN_CHORD_MM } else { c.2 - c.1 };
        (aspect * width).clamp(settings.min_layer_mm, settings.max_layer_mm)
    };
    let density: Vec<f64> = chords.iter().map(|c| step / ideal(c)).collect();
    let total: f64 = density.iter().sum();
    let most = (((top - bottom) / settings.min_layer_mm) as usize).max(1);
    let n = match settings.layers {
        None => (total.round() as usize).clamp(1, most),
        Some(layers) if layers >= 1 && layers <= most => layers,
        Some(layers) => {
            return Err(layer_count(layers, most, top - bottom, settings));
        }
    };

    let mut levels = vec![bottom];
    let mut sum = 0.0;
    for (chord, d) in chords.iter().zip(&density) {
        while levels.len() < n && sum + d >= total * levels.len() as f64 / n as f64 {
            let part = (total * levels.len() as f64 / n as f64 - sum) / d;
            levels.push(chord.0 - step / 2.0 + part * step);
        }
        sum += d;
    }
    levels.push(top);

    let slab = |(bottom, top): (f64, f64)| {
        let inside = || chords.iter().filter(|c| c.0 > bottom && c.0 < top && !c.1.is_nan());
        let quantile = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 4).copied()
        };
        // The conservative quarter of the chord ends: loops touch the outline where it is narrow and do not pierce it.
        let right = quantile(inside().map(|c| c.2).collect())?;
        let left = -quantile(inside().map(|c| -c.1).collect())?;
        Some(Slab { bottom, top, left, right })
    };
    levels.windows(2).map(|w| slab((w[0], w[1])).ok_or_else(too_small)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::P2;

    fn top(points: &[(f64, f64)]) -> f64 {
        let outline = Outline { outer: points.iter().map(|(x, y)| P2::new(*x, *y)).collect(), holes: Vec::new() };
        let slabs = slabs(&outline, 0.35, &StackSettings::default()).unwrap();
        slabs.last().unwrap().top
    }

    #[test]
    fn a_stack_ends_between_horns_and_follows_a_shoulder() {
        let horns = [(0.0, 0.0), (100.0, 0.0), (100.0, 90.0), (50.0, 60.0), (0.0, 90.0)];
        assert!((top(&horns) - 60.0).abs() < 1.0);
        let shoulder = [(0.0, 0.0), (100.0, 0.0), (100.0, 40.0), (40.0, 40.0), (40.0, 100.0), (0.0, 100.0)];
        assert!((top(&shoulder) - 100.0).abs() < 1.0);
    }
}
