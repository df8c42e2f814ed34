//! Where flaps lie side by side across a strip.

use super::joint::Joint;

/// One flap below this width of strip, mm; two up to [`TWO_UP_TO_MM`], then one every [`EVERY_MM`] (materials practice).
const ONE_BELOW_MM: f64 = 45.0;
const TWO_UP_TO_MM: f64 = 100.0;
const EVERY_MM: f64 = 50.0;
/// Fingers reach this deep into the folded strip from an open edge, mm (materials practice).
pub(super) const REACH_MM: f64 = 60.0;
/// Cuts take at most this share of the strip's width at any one station (materials practice), as far as a single flap allows.
pub(super) const CUT_OUT_SHARE: f64 = 0.35;

/// Number of flaps that a strip `width_mm` wide is meant to have.
fn wanted(width_mm: f64) -> usize {
    match width_mm {
        w if w < ONE_BELOW_MM => 1,
        w if w <= TWO_UP_TO_MM => 2,
        w => (w / EVERY_MM).ceil() as usize,
    }
}

/// Middles of the flaps in a bed from `lo` to `hi`, mm, ascending, at least one. `alternating` flaps point ahead and back by turns, so that only every other one cuts
/// into the same station.
///
/// Flaps lie in the middles of equal lanes, those deeper than a hand reaches are moved out to where it does. There are fewer where they would come too close to
/// the edges or to each other, or take too much out of the strip. In a bed that is upside down the one flap lies in the middle of it.
pub(super) fn middles(lo: f64, hi: f64, joint: &Joint, alternating: bool) -> Vec<f64> {
    let width = hi - lo;
    if width <= 0.0 {
        return vec![0.5 * (lo + hi)];
    }
    let flap = joint.cut_out_mm();
    let abreast = ((CUT_OUT_SHARE * width / flap) as usize).max(1);
    let most = if alternating { 2 * abreast } else { abreast };
    let lane = (flap + joint.cut_distance_mm).max(flap + 2.0 * joint.edge_distance_mm);
    let count = wanted(width).min(most).min((width / lane) as usize).max(1);
    let mut middles: Vec<f64> = Vec::with_capacity(count);
    for i in 0..count {
        let even = lo + width * (2 * i + 1) as f64 / (2 * count) as f64;
        let at = match (even - lo, hi - even) {
            (below, above) if below.min(above) <= REACH_MM => even,
            (below, above) if below <= above => lo + REACH_MM,
            _ => hi - REACH_MM,
        };
        if middles.last().is_none_or(|last| at - last >= flap + joint.cut_distance_mm) {
            middles.push(at);
        }
    }
    middles
}

/// Narrowest bed in which one flap takes no more than its share out of the strip, mm.
pub(super) fn strong_width_mm(joint: &Joint) -> f64 {
    joint.cut_out_mm() / CUT_OUT_SHARE
}

#[cfg(test)]
mod tests {
    use super::super::joint::paper;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn wide_strips_get_more_flaps() {
        let counts =
            [30.0, 44.9, 45.0, 64.0, 100.0, 110.0, 160.0, 240.0].map(|w| middles(0.0, w, &paper(), true).len());
        assert_eq!(counts, [1, 1, 2, 2, 2, 3, 4, 4]);
        // All pointing one way, two must not take more than their share of the width.
        let one_way = [45.0, 63.0, 65.0, 160.0].map(|w| middles(0.0, w, &paper(), false).len());
        assert_eq!(one_way, [1, 1, 2, 4]);
        // A felt joint is wide: two do not fit side by side where two of paper do.
        let felt = Joint {
            neck_mm: 13.0,
            barb_mm: 3.0,
            hook_radius_mm: 0.0,
            edge_distance_mm: 8.0,
            cut_distance_mm: 12.0,
            ..paper()
        };
        assert_eq!((middles(0.0, 46.0, &felt, true).len(), middles(0.0, 80.0, &felt, true).len()), (1, 2));
    }

    proptest! {
        #[test]
        fn flaps_keep_off_the_edges_and_each_other_and_within_reach(
            lo in -200.0..0.0f64, width in 20.0..400.0f64, alternating in any::<bool>(),
        ) {
            let joint = paper();
            let hi = lo + width;
            let at = middles(lo, hi, &joint, alternating);
            let half = 0.5 * joint.cut_out_mm();
            prop_assert!(!at.is_empty() && at.len() <= wanted(width));
            for (i, w) in at.iter().enumerate() {
                prop_assert!(w - half - lo >= joint.edge_distance_mm && hi - w - half >= joint.edge_distance_mm);
                prop_assert!((w - lo).min(hi - w) <= REACH_MM + 1e-9);
                prop_assert!(i == 0 || w - at[i - 1] >= 2.0 * half + joint.cut_distance_mm - 1e-9);
            }
            let abreast = if alternating { at.len().div_ceil(2) } else { at.len() };
            prop_assert!(abreast == 1 || abreast as f64 * joint.cut_out_mm() <= CUT_OUT_SHARE * width);
        }
    }
}
