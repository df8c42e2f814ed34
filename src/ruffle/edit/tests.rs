//! Every edit on its own, on drawings; `tests/edits.rs` solves in between.

use super::mesh::BOUND;
use super::*;
use crate::geom::{P2, V2};
use crate::ruffle::{Role, StackSettings, draw_stack, load_test, uniform_stack};

const FREE: EditSettings =
    EditSettings { segment_mm: 3.0, limits: Limits { min_bend_radius_mm: 0.0, min_void_mm: 0.0 } };

fn stack(layers: usize) -> Drawn {
    uniform_stack(layers, 30.0, 52.8, 3.0)
}

/// Knots of the walk, roles and lengths: what is left when the division into segments is not looked at.
fn topology(drawn: &Drawn) -> (Vec<usize>, Vec<Role>, Vec<f64>) {
    let ruffle = &drawn.ruffle;
    let mut names = Vec::new();
    let mut name = |node| {
        names.iter().position(|n| *n == node).unwrap_or_else(|| {
            names.push(node);
            names.len() - 1
        })
    };
    let ends = ruffle.sections.iter().map(|s| ruffle.walk[s.end_segment]);
    let knots = std::iter::once(ruffle.walk[0]).chain(ends).map(&mut name).collect();
    let lengths = (0..ruffle.sections.len()).map(|s| ruffle.section_length(s)).collect();
    (knots, ruffle.sections.iter().map(|s| s.role).collect(), lengths)
}

fn assert_same(a: &Drawn, b: &Drawn, what: &str) {
    let (a, b) = (topology(a), topology(b));
    assert_eq!((&a.0, &a.1), (&b.0, &b.1), "{what}");
    for (s, (x, y)) in a.2.iter().zip(&b.2).enumerate() {
        assert!((x / y - 1.0).abs() < 1e-12, "{what}: section {s} is {x} mm, was {y}");
    }
}

/// Consecutive passes run through every connection in opposite directions.
fn assert_alternating(drawn: &Drawn) {
    for c in drawn.ruffle.connection_points() {
        let along = |pass: usize| -> V2 {
            let at = |k: usize| drawn.positions[drawn.ruffle.at(k)];
            let last = drawn.ruffle.walk.len() - 1;
            (at((pass + 1).min(last)) - at(pass.saturating_sub(1))).normalize()
        };
        for pair in c.passes.windows(2) {
            let dot = along(pair[0]).dot(&along(pair[1]));
            assert!(dot < -0.5, "joint {}: passes {pair:?} at an angle of cosine {dot}", c.joint);
        }
    }
}

fn assert_divided_within_bounds(drawn: &Drawn, settings: &EditSettings) {
    let h = settings.segment_mm;
    for (s, section) in drawn.ruffle.sections.iter().enumerate() {
        let rest = &drawn.ruffle.rest_lengths[section.segments()];
        assert!(rest.len() >= MIN_SEGMENTS);
        for l in rest {
            assert!(*l <= BOUND * h * 1.0001, "section {s}: {l}");
            assert!(*l >= h / BOUND * 0.9999 || rest.len() == MIN_SEGMENTS, "section {s}: {l} of {}", rest.len());
        }
    }
}

#[test]
fn taking_a_ruffle_apart_and_together_changes_nothing() {
    let p = |(x, y)| P2::new(x, y);
    let outer = [(0.0, 0.0), (100.0, 0.0), (80.0, 100.0), (10.0, 90.0)].map(p).to_vec();
    let outline = crate::cut::Outline { outer, holes: Vec::new() };
    let dense = load_test(crate::ruffle::Strip::Dense, 3.0).unwrap();
    for drawn in [stack(3), draw_stack(&outline, &StackSettings::default()).unwrap(), dense] {
        assert_eq!(Draft::of(&drawn).unwrap().drawn().unwrap(), drawn);
    }
}

#[test]
fn a_densified_loop_is_three_loops_that_hold_on_to_the_middles_of_its_room() {
    let drawn = densify(&stack(2), &[1], 1, &FREE).unwrap();
    let ruffle = &drawn.ruffle;
    // Four more for the loop, one more for either side of its room.
    assert_eq!(ruffle.sections.len(), 9 + 4 + 2);
    assert_eq!(ruffle.connection_points().len(), 4 + 3);
    let roles: Vec<Role> = ruffle.sections[2..7].iter().map(|s| s.role).collect();
    assert_eq!(roles, [Role::Outer, Role::Densified, Role::Densified, Role::Densified, Role::Outer]);
    assert_eq!((ruffle.densified.made.len(), ruffle.densified.midpoints.len()), (1, 2));
    let place = |node: crate::ruffle::Node| drawn.positions[node.index()];
    let (a, b) = (place(ruffle.section_ends(4).0), place(ruffle.section_ends(4).1));
    assert!((a - P2::new(26.4, 0.0)).norm() < 1.6 && (b - P2::new(26.4, 15.0)).norm() < 1.6, "{a} {b}");
    assert_alternating(&drawn);
    assert_divided_within_bounds(&drawn, &FREE);
}

#[test]
fn any_section_can_be_densified_and_taken_back() {
    let plain = stack(3);
    for section in 0..plain.ruffle.sections.len() {
        let dense = densify(&plain, &[section], 1, &FREE).unwrap_or_else(|e| panic!("section {section}: {e}"));
        dense.ruffle.check().unwrap();
        assert_alternating(&dense);
        assert!(dense.ruffle.strip_length() > plain.ruffle.strip_length() + 20.0);
        let first = dense.ruffle.densified.made[0].first_section;
        for inside in first..first + 5 {
            let back = undensify(&dense, &[inside], &FREE).unwrap();
            assert_same(&back, &plain, &format!("section {section}, back from {inside}"));
            assert_eq!(back.ruffle.densified, plain.ruffle.densified);
        }
    }
}

#[test]
fn densifying_nests_and_outer_ones_take_inner_ones_back_with_them() {
    let fine = EditSettings { segment_mm: 1.5, ..FREE };
    let plain = uniform_stack(2, 30.0, 52.8, 1.5);
    let outer = densify(&plain, &[1], 1, &fine).unwrap();
    for inside in 2..7 {
        let nested = densify(&outer, &[inside], 1, &fine).unwrap_or_else(|e| panic!("section {inside}: {e}"));
        assert_alternating(&nested);
        assert_eq!(nested.ruffle.densified.made.len(), 2);
        let [big, little] = [0, 1].map(|m| nested.ruffle.densified.made[m].clone());
        assert!(big.sections().start <= little.sections().start && little.sections().end <= big.sections().end);
        assert_same(&undensify(&nested, &[little.first_section], &fine).unwrap(), &outer, "the little one");
        let of_big_only = big.sections().find(|s| !little.sections().contains(s)).unwrap();
        assert_same(&undensify(&nested, &[of_big_only], &fine).unwrap(), &plain, "the big one");
    }
}

#[test]
fn taking_back_leaves_what_else_was_changed() {
    let plain = stack(2);
    let neighbour = densify(&densify(&plain, &[3], 1, &FREE).unwrap(), &[1], 1, &FREE).unwrap();
    // Both hold on to the middle of the same diagonal.
    let shared = neighbour.ruffle.connection_points().iter().filter(|c| c.passes.len() == 3).count();
    assert_eq!(shared, 1);
    let last = neighbour.ruffle.sections.len() - 1;
    let longer = neighbour.ruffle.section_length(last) * 1.2;
    let changed = set_length(&neighbour, last, longer, &FREE).unwrap();
    let first = undensify(&changed, &[changed.ruffle.densified.made[0].first_section], &FREE).unwrap();
    let back = undensify(&first, &[first.ruffle.densified.made[0].first_section], &FREE).unwrap();
    assert_same(&back, &set_length(&plain, 8, longer, &FREE).unwrap(), "both taken back");
}

#[test]
fn a_densified_half_is_taken_back_before_the_halves_are_joined() {
    let dense = densify(&stack(2), &[1], 1, &FREE).unwrap();
    // The far half of the diagonal, beyond the middle that the little loops hold on to.
    let half = densify(&dense, &[8], 1, &FREE).unwrap();
    assert_eq!(half.ruffle.densified.made.len(), 2);
    assert_same(&undensify(&half, &[3], &FREE).unwrap(), &stack(2), "all of it");
}

#[test]
fn segments_stay_within_bounds_at_any_length_and_growing_moves_no_node() {
    let plain = stack(2);
    for section in [1, 2, 8] {
        for factor in [0.2, 0.4, 0.7, 1.3, 1.7, 3.1, 7.0] {
            let length_mm = factor * plain.ruffle.section_length(section);
            let edited = set_length(&plain, section, length_mm, &FREE).unwrap();
            assert_divided_within_bounds(&edited, &FREE);
            assert!((edited.ruffle.section_length(section) / length_mm - 1.0).abs() < 1e-12);
            if factor > 1.0 {
                assert!(plain.positions.iter().all(|p| edited.positions.contains(p)));
            }
        }
    }
}

#[test]
fn splitting_and_merging_segments_are_inverse() {
    let plain = stack(2);
    let split = split_segments(&plain, 2, &FREE).unwrap();
    assert_eq!(split.ruffle.sections[2].segments().len(), 2 * plain.ruffle.sections[2].segments().len());
    let merged = merge_segments(&split, 2, &FREE).unwrap();
    assert_eq!(merged.ruffle.walk, plain.ruffle.walk);
    let far = merged.positions.iter().zip(&plain.positions).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(far < 1e-9, "{far}");
    let short = uniform_stack(1, 30.0, 20.0, 3.0);
    assert_eq!(
        merge_segments(&short, 0, &FREE),
        Err(EditError::TooCoarse { section: 0, segments: 8, least: MIN_SEGMENTS })
    );
}

#[test]
fn a_layer_goes_in_at_any_height_and_comes_out_again() {
    let plain = stack(3);
    for at in 0..=3 {
        let more = insert_layer(&plain, at, 30.0, &FREE).unwrap();
        assert_eq!(layer_count(&more), Ok(4));
        assert_alternating(&more);
        let top = |d: &Drawn| d.positions.iter().map(|p| p.y).fold(0.0, f64::max);
        assert!((top(&more) - 120.0).abs() < 1e-9, "{}", top(&more));
        let roles = |d: &Drawn| topology(d).1;
        assert_eq!(roles(&more), roles(&stack(4)));
        assert_eq!(topology(&more).0, topology(&stack(4)).0);
        assert_same(&remove_layer(&more, at, &FREE).unwrap(), &plain, &format!("layer {at}"));
    }
    assert_eq!(insert_layer(&plain, 4, 30.0, &FREE), Err(EditError::NoSuchLayer { layer: 4, count: 3 }));
    assert_eq!(remove_layer(&plain, 3, &FREE), Err(EditError::NoSuchLayer { layer: 3, count: 3 }));
    assert_eq!(remove_layer(&stack(1), 0, &FREE), Err(EditError::LastLayer));
}

#[test]
fn layers_carry_their_little_loops_along() {
    // The loop above the second rung holds on to that rung's middle, and so does the one below it.
    let dense = densify(&densify(&stack(3), &[9], 1, &FREE).unwrap(), &[3], 1, &FREE).unwrap();
    for at in 0..=3 {
        let more = insert_layer(&dense, at, 30.0, &FREE).unwrap();
        assert_eq!((layer_count(&more), more.ruffle.densified.made.len()), (Ok(4), 2), "at {at}");
        assert_same(&remove_layer(&more, at, &FREE).unwrap(), &dense, &format!("layer {at}"));
    }
    let kept = [(0, 1), (1, 2), (2, 1)];
    for (layer, left) in kept {
        let less = remove_layer(&dense, layer, &FREE).unwrap();
        assert_eq!((layer_count(&less), less.ruffle.densified.made.len()), (Ok(2), left), "layer {layer}");
        assert_alternating(&less);
    }
    let rung = densify(&stack(2), &[4], 1, &FREE).unwrap();
    assert_eq!(insert_layer(&rung, 1, 30.0, &FREE), Err(EditError::RungDensified { section: 4 }));
}

#[test]
fn loops_that_crease_or_close_too_far_are_refused_with_radius_and_limit() {
    let paper = EditSettings { limits: Limits { min_bend_radius_mm: 5.0, min_void_mm: 9.0 }, ..FREE };
    let small = uniform_stack(2, 18.0, 26.0, 1.5);
    let Err(EditError::Crease { section, radius_mm, limit_mm }) = densify(&small, &[1], 1, &paper) else {
        panic!("densified")
    };
    let dense = densify(&small, &[1], 1, &FREE).unwrap().ruffle;
    // The room between c, a and b: two stretches and the loop that faces the apex.
    let around_mm: f64 = (3..6).map(|s| dense.section_length(s)).sum();
    assert!(section == 1 && limit_mm == 5.0);
    assert!(radius_mm <= around_mm / 10.76 && radius_mm > 0.5 * around_mm / 10.77, "{radius_mm} of {around_mm}");
    let soft = EditSettings { limits: Limits { min_bend_radius_mm: 0.0, min_void_mm: 18.0 }, ..FREE };
    assert!(matches!(densify(&stack(2), &[1], 1, &soft), Err(EditError::OutOfReach { limit_mm: 18.0, .. })));
    assert!(densify(&stack(2), &[1], 1, &paper).is_ok());
    // What is too tight already may be eased.
    let length_mm = small.ruffle.section_length(1) * 1.1;
    let tight = EditSettings { limits: Limits { min_bend_radius_mm: 50.0, min_void_mm: 50.0 }, ..FREE };
    assert!(set_length(&small, 1, length_mm, &tight).is_ok());
    assert!(matches!(set_length(&small, 1, 0.5 * length_mm, &tight), Err(EditError::Crease { .. })));
}

#[test]
fn what_is_not_there_is_refused_by_name() {
    let plain = stack(2);
    assert_eq!(densify(&plain, &[9], 1, &FREE), Err(EditError::NoSuchSection { section: 9, count: 9 }));
    assert_eq!(undensify(&plain, &[1], &FREE), Err(EditError::NotDensified { section: 1 }));
    assert_eq!(set_length(&plain, 1, 0.0, &FREE), Err(EditError::Length { section: 1, length_mm: 0.0 }));
    let none = EditSettings { segment_mm: f64::NAN, ..FREE };
    assert!(matches!(densify(&plain, &[1], 1, &none), Err(EditError::Size { .. })));
    let mut short = plain.clone();
    short.positions.pop();
    assert!(matches!(densify(&short, &[1], 1, &FREE), Err(EditError::Positions { .. })));
    let mut torn = plain;
    torn.ruffle.rest_lengths[3] = f64::NAN;
    assert!(matches!(densify(&torn, &[1], 1, &FREE), Err(EditError::Flaw(_))));
}

#[test]
fn sections_of_one_edit_are_named_as_before_it() {
    let plain = stack(3);
    let together = densify(&plain, &[5, 1, 5], 1, &FREE).unwrap();
    let apart = densify(&densify(&plain, &[5], 1, &FREE).unwrap(), &[1], 1, &FREE).unwrap();
    assert_eq!(together, apart);
    // The loop divides the diagonal beside it; then both halves are folded, or the one that has room.
    let both = densify(&plain, &[2, 3], 1, &FREE).unwrap();
    assert!(both.ruffle.densified.made.len() >= 2);
    assert_alternating(&both);
    let made: Vec<usize> = together.ruffle.densified.made.iter().map(|m| m.first_section).collect();
    assert_same(&undensify(&together, &made, &FREE).unwrap(), &plain, "both taken back");
    let first = together.ruffle.densified.made[0].first_section;
    assert_same(
        &undensify(&together, &[first, first + 3, first + 4], &FREE).unwrap(),
        &densify(&plain, &[5], 1, &FREE).unwrap(),
        "one taken back, though named three times",
    );
}

#[test]
fn the_second_level_densifies_the_loops_of_the_first() {
    let fine = EditSettings { segment_mm: 1.5, ..FREE };
    let plain = uniform_stack(2, 30.0, 52.8, 1.5);
    let twice = densify(&plain, &[1], 2, &fine).unwrap();
    let made = &twice.ruffle.densified.made;
    assert_eq!(made.len(), 4, "the loop, and three in it: {made:?}");
    assert!(made[1..].iter().all(|m| made[0].first_section <= m.first_section && m.end_section <= made[0].end_section));
    assert_alternating(&twice);
    let little: Vec<usize> = made[1..].iter().map(|m| m.first_section).collect();
    let once = densify(&plain, &[1], 1, &fine).unwrap();
    assert_same(&undensify(&twice, &little, &fine).unwrap(), &once, "the little ones taken back");
}

#[test]
fn loops_are_told_from_rungs_and_diagonals() {
    assert_eq!(loops(&stack(2)).unwrap(), [1, 3, 5, 7]);
}

#[test]
fn a_joint_moves_with_the_sections_that_hold_it_and_nothing_else() {
    let plain = stack(2);
    // Joint 2 is the right end of rung 1, joint 3 its left end.
    let joint = |drawn: &Drawn, n: usize| drawn.positions[drawn.ruffle.connection_points()[n - 1].node.index()];
    let from = joint(&plain, 2);
    let to = from + V2::new(-12.0, 2.0);
    let moved = move_joint(&plain, 2, to, &FREE).unwrap();
    assert!((joint(&moved, 2) - to).norm() < 1e-12);
    for n in [1, 3, 4] {
        assert_eq!(joint(&moved, n), joint(&plain, n));
    }
    let length = |drawn: &Drawn, s: usize| drawn.ruffle.section_length(s);
    // The rung and the diagonal that end there are shorter for good, its two loops are drawn anew, the rest is as it was.
    let rung = (to - joint(&plain, 3)).norm();
    assert!((length(&moved, 4) - rung).abs() < 0.5, "{} against {rung}", length(&moved, 4));
    let pinned: Vec<usize> = (0..9).filter(|s| moved.ruffle.sections[*s].pinned).collect();
    assert_eq!(pinned, [2, 4]);
    assert!([0, 3, 6, 7, 8].iter().all(|s| (length(&moved, *s) - length(&plain, *s)).abs() < 1e-9));
    assert!([1, 5].iter().all(|s| (length(&moved, *s) - length(&plain, *s)).abs() > 1e-3));
    assert_divided_within_bounds(&moved, &FREE);

    assert_eq!(move_joint(&plain, 9, to, &FREE), Err(EditError::NoSuchJoint { joint: 9, count: 4 }));
    let far = from - V2::new(90.0, 0.0);
    assert!(matches!(move_joint(&plain, 2, far, &FREE), Err(EditError::JointBlocked { joint: 2, .. })));
}

#[test]
fn lengths_given_by_hand_stay_given_through_other_edits() {
    let plain = set_length(&stack(2), 4, 60.0, &FREE).unwrap();
    assert!(plain.ruffle.sections[4].pinned);
    // The loop's room divides the rung in two: both halves keep their lengths.
    let dense = densify(&plain, &[3], 1, &FREE).unwrap();
    let halves: Vec<usize> = (0..dense.ruffle.sections.len()).filter(|s| dense.ruffle.sections[*s].pinned).collect();
    assert_eq!(halves.len(), 2);
    let made = dense.ruffle.densified.made[0].first_section;
    let back = undensify(&dense, &[made], &FREE).unwrap();
    assert!(back.ruffle.sections[4].pinned && (back.ruffle.section_length(4) - 60.0).abs() < 1e-9);
}

#[test]
fn a_foot_of_another_length_is_drawn_that_long() {
    let shorter = set_length(&stack(2), 0, 40.0, &FREE).unwrap();
    let foot = shorter.ruffle.foot.map(|n| shorter.positions[n.index()]);
    assert!((foot[1] - foot[0]).norm() - 40.0 < 1e-9);
    assert_eq!(foot[0], stack(2).positions[0]);
}
