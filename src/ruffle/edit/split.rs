//! One layer made two.

use super::draft::{Draft, Part};
use super::layers::{END_SHARE, PER_LAYER, count, plain_rung, plain_sections};
use super::{EditError, EditSettings, close, open};
use crate::geom::{P2, V2};
use crate::ruffle::curve::{Curve, smooth};
use crate::ruffle::{Drawn, Role};

/// Divides layer `layer`, 0 the lowest, in two by a rung half way up. Everything else keeps its lengths and its place.
///
/// # Errors
/// A ruffle that is no stack, a layer it does not have, one with a densified side, no room.
pub fn split_layer(drawn: &Drawn, layer: usize, settings: &EditSettings) -> Result<Drawn, EditError> {
    let (mut draft, before) = open(drawn, settings)?;
    let sections = plain_sections(&draft);
    let layers = count(&sections)?;
    if layer >= layers {
        return Err(EditError::NoSuchLayer { layer, count: layers });
    }
    let first = PER_LAYER * layer;
    for side in &sections[first..=first + PER_LAYER] {
        plain_rung(&draft, side)?;
    }
    let (bottom, top) = (draft.joined(sections[first].clone()), draft.joined(sections[first + PER_LAYER].clone()));
    let loops = [1, 3].map(|side| sections[first + side].clone());
    let ends = loops.clone().map(|l| (draft.parts[l.start].from, draft.parts[l.end - 1].to));
    let reaches = [1.0, -1.0].into_iter().zip(&loops).map(|(sign, l)| {
        let out = (along(&bottom, sign > 0.0) + along(&top, sign > 0.0)) * sign;
        beyond(&draft.joined(l.clone()), out)
    });
    let reaches: Vec<f64> = reaches.collect();

    // Between the two rungs, both followed from left to right.
    let between = |up: &dyn Fn(f64) -> f64| {
        Curve::traced(|s| {
            let (low, high) = (bottom.at(s), top.at(s));
            low + (high - low) * up(s)
        })
    };
    let rung = between(&|_| 0.5);
    let [right, left] = [1.0, 0.0].map(|s| draft.new_knot(rung.at(s)));
    let [(low_right, high_right), (low_left, high_left)] = ends;
    let segment_mm = settings.segment_mm;
    let part =
        |draft: &mut Draft, role, knots, curve: &Curve| draft.part(role, knots, curve, curve.length(), segment_mm);
    let side = |draft: &mut Draft, [from, to]: [usize; 2], [low, high]: [&Curve; 2], is_right: bool| {
        let sign = if is_right { 1.0 } else { -1.0 };
        let out = [low, high].map(|rung| along(rung, is_right) * sign);
        let reach = reaches[usize::from(!is_right)];
        let drawn = Curve::loop_beyond([draft.knots[from], draft.knots[to]], out, reach);
        part(draft, Role::Outer, [from, to], &drawn)
    };
    // From the upper rung's right end down to the lower one's left end.
    let low_diagonal = between(&|s| 0.5 * smooth(s)).part(1.0, 0.0);
    let high_diagonal = between(&|s| 0.5 + 0.5 * smooth(s)).part(1.0, 0.0);
    let new: Vec<Part> = vec![
        side(&mut draft, [low_right, right], [&bottom, &rung], true),
        part(&mut draft, Role::Inner, [right, low_left], &low_diagonal),
        side(&mut draft, [low_left, left], [&bottom, &rung], false),
        part(&mut draft, Role::Inner, [left, right], &rung),
        side(&mut draft, [right, high_right], [&rung, &top], true),
        part(&mut draft, Role::Inner, [high_right, left], &high_diagonal),
        side(&mut draft, [left, high_left], [&rung, &top], false),
    ];
    draft.replace(loops[0].start..loops[1].end, new);
    close(draft, loops[0].start, before, settings)?.drawn()
}

/// Direction of a rung, from left to right, at one of its ends.
fn along(rung: &Curve, at_right: bool) -> V2 {
    let (from, to) = if at_right { (1.0 - END_SHARE, 1.0) } else { (0.0, END_SHARE) };
    (rung.at(to) - rung.at(from)).normalize()
}

/// How far a loop reaches out beyond the middle of its ends.
fn beyond(side: &Curve, out: V2) -> f64 {
    let out = out.normalize();
    let middle: P2 = nalgebra::center(&side.at(0.0), &side.at(1.0));
    side.points().iter().map(|p| (p - middle).dot(&out)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ruffle::{Limits, densify, uniform_stack};

    const SETTINGS: EditSettings =
        EditSettings { segment_mm: 3.0, limits: Limits { min_bend_radius_mm: 0.0, min_void_mm: 0.0 } };

    #[test]
    fn a_split_layer_is_two_and_the_others_stay() {
        let stack = uniform_stack(3, 36.0, 60.0, 3.0);
        for layer in 0..3 {
            let split = split_layer(&stack, layer, &SETTINGS).unwrap();
            assert_eq!(split.ruffle.layers().len(), 4);
            let joints = split.ruffle.connection_points();
            let heights: Vec<f64> = joints.iter().map(|c| split.positions[c.node.index()].y).collect();
            assert!(heights.iter().any(|v| (v - 36.0 * (layer as f64 + 0.5)).abs() < 1e-6), "{heights:?}");
            let kept = if layer == 0 { 10 } else { 2 };
            let at = if layer == 0 { 6 } else { 2 };
            assert!((split.ruffle.section_length(kept) - stack.ruffle.section_length(at)).abs() < 1e-9);
        }
    }

    #[test]
    fn a_layer_that_is_not_there_or_densified_is_refused() {
        let stack = uniform_stack(2, 30.0, 60.0, 3.0);
        assert_eq!(split_layer(&stack, 2, &SETTINGS).unwrap_err(), EditError::NoSuchLayer { layer: 2, count: 2 });
        let dense = densify(&stack, &[1], 1, &SETTINGS).unwrap();
        assert!(matches!(split_layer(&dense, 0, &SETTINGS).unwrap_err(), EditError::RungDensified { .. }));
    }
}
