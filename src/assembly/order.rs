//! In which order joints are closed: from the core out, so that no later flap is out of reach.
//!
//! Found backwards, by taking the finished part apart. A hand comes from outside, through rooms that are thick enough for it and through joints that are already
//! open again. Of the joints it reaches, the one that the strip comes to last is opened next; read the other way round, the part grows along the strip, except
//! where that would wall a joint in.

use super::rooms::Rooms;
use crate::fit::Part;
use crate::ruffle::ConnectionPoint;

/// Narrowest room for two fingers, mm.
pub(super) const FINGERS_MM: f64 = 18.0;
/// Narrowest room for a pair of blunt tweezers, mm.
pub(super) const TWEEZERS_MM: f64 = 9.0;

/// One joint to close.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// Index into the part's connection points.
    pub joint: usize,
    /// Narrowest place on the widest way from outside to one of the rooms at the joint, mm; infinite for a joint that can be seen from outside.
    pub way_mm: f64,
    /// Thickest of the rooms in which the flap can be pulled through, mm.
    pub room_mm: f64,
}

/// The joints of a part in the order they are closed.
pub(super) fn order(part: &Part) -> Vec<Step> {
    let joints = part.ruffle.connection_points();
    let rooms = Rooms::of(part, &joints);
    taken_apart(&rooms, &joints).into_iter().rev().collect()
}

fn taken_apart(rooms: &Rooms, joints: &[ConnectionPoint]) -> Vec<Step> {
    let mut closed: Vec<usize> = (0..joints.len()).collect();
    let mut open: Vec<usize> = Vec::new();
    let mut steps = Vec::with_capacity(joints.len());
    while !closed.is_empty() {
        let reach = reach_mm(rooms, &open);
        let way = |j: &usize| rooms.around[*j].iter().map(|sector| reach[sector.room]).fold(0.0, f64::max);
        // Ways are as good as the hand or tool that fits through.
        let ease = |way: f64| if way >= FINGERS_MM { 2.0 } else { (way / TWEEZERS_MM).min(1.0) };
        let last_pass = |j: &usize| joints[*j].passes.last().copied().unwrap_or(0);
        let best = (0..closed.len()).max_by(|a, b| {
            let (a, b) = (&closed[*a], &closed[*b]);
            ease(way(a)).total_cmp(&ease(way(b))).then(last_pass(a).cmp(&last_pass(b)))
        });
        let Some(best) = best else { break };
        let joint = closed.remove(best);
        let own = rooms.around[joint].iter().filter(|s| s.passes[0] == s.passes[1]);
        let room_mm = own.map(|sector| rooms.thickness_mm[sector.room]).fold(0.0, f64::max);
        steps.push(Step { joint, way_mm: way(&joint), room_mm });
        open.push(joint);
    }
    steps
}

/// For every room the narrowest place of the widest way to it from outside, through joints that are open, mm; 0 where there is none.
fn reach_mm(rooms: &Rooms, open: &[usize]) -> Vec<f64> {
    let mut reach: Vec<f64> =
        rooms.thickness_mm.iter().map(|t| if t.is_infinite() { f64::INFINITY } else { 0.0 }).collect();
    // Few rooms and few joints: relaxed until nothing changes.
    loop {
        let mut changed = false;
        for joint in open {
            for (a, b) in through(rooms, *joint) {
                for (from, to) in [(a, b), (b, a)] {
                    let way = reach[from].min(rooms.thickness_mm[to]);
                    if way > reach[to] {
                        reach[to] = way;
                        changed = true;
                    }
                }
            }
        }
        if !changed {
            return reach;
        }
    }
}

/// Rooms that are one while a joint is open: those on the two sides of a contact between two passes.
fn through(rooms: &Rooms, joint: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
    let around = &rooms.around[joint];
    around.iter().enumerate().flat_map(move |(i, a)| {
        around[..i].iter().filter(move |b| a.passes == b.passes && a.passes[0] != a.passes[1]).map(|b| (a.room, b.room))
    })
}

#[cfg(test)]
mod tests {
    use super::super::samples::{part_of, rect_part};
    use super::*;
    use crate::geom::P2;
    use crate::ruffle::uniform_stack;
    use proptest::prelude::*;

    /// Joint numbers in closing order.
    fn numbers(part: &Part) -> Vec<u32> {
        let joints = part.ruffle.connection_points();
        order(part).iter().map(|step| joints[step.joint].joint).collect()
    }

    #[test]
    fn a_stack_is_closed_along_its_strip() {
        let drawn = uniform_stack(4, 25.0, 60.0, 3.0);
        let part = part_of(drawn.ruffle, drawn.positions);
        let numbers = numbers(&part);
        assert_eq!(numbers, (1..=numbers.len() as u32).collect::<Vec<u32>>());
    }

    #[test]
    fn a_joint_inside_a_closed_room_is_closed_before_the_room_is() {
        // Once round a box of 90 mm, closed at its corner; then inward, and once round a box of 30 mm.
        let corners = [
            (0.0, 0.0),
            (90.0, 0.0),
            (90.0, 90.0),
            (0.0, 90.0),
            (0.0, 0.0),
            (30.0, 30.0),
            (60.0, 30.0),
            (60.0, 60.0),
            (30.0, 60.0),
            (30.0, 30.0),
        ];
        let part = rect_part(&corners.map(|(x, y)| P2::new(x, y)));
        assert_eq!(part.ruffle.connection_points().len(), 2);
        assert_eq!(numbers(&part), [2, 1]);
    }

    #[test]
    fn a_room_is_as_thick_as_it_is_wide_and_the_outside_has_no_thickness() {
        let corners = [(0.0, 0.0), (80.0, 0.0), (80.0, 20.0), (0.0, 20.0), (0.0, 0.0)];
        let part = rect_part(&corners.map(|(x, y)| P2::new(x, y)));
        let rooms = Rooms::of(&part, &part.ruffle.connection_points());
        let finite: Vec<f64> = rooms.thickness_mm.iter().copied().filter(|t| t.is_finite()).collect();
        assert_eq!(rooms.thickness_mm.len(), 2);
        assert!((finite[0] - 20.0).abs() < 1e-9, "{finite:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        /// The promise on the sheet, checked by a search of its own: when a joint's turn comes, a hand comes from outside to a room at it through joints that are
        /// not closed yet, and wherever a way for fingers was told, all rooms on it are as thick as that.
        #[test]
        fn when_its_turn_comes_every_joint_can_be_reached(
            layers in 1usize..7, layer in 12.0..40.0f64, inner in 30.0..120.0f64, cut in 0usize..3,
        ) {
            let drawn = uniform_stack(layers, layer, inner, 3.0);
            let mut ruffle = drawn.ruffle;
            // A strip that ends early leaves other joints, some with loose ends.
            let keep = ruffle.sections.len() - cut.min(ruffle.sections.len() - 2);
            ruffle.sections.truncate(keep);
            let end = ruffle.sections[keep - 1].end_segment;
            ruffle.walk.truncate(end + 1);
            ruffle.rest_lengths.truncate(end);
            let part = part_of(ruffle, drawn.positions);
            let joints = part.ruffle.connection_points();
            let rooms = Rooms::of(&part, &joints);
            let steps = order(&part);
            let mut all: Vec<usize> = steps.iter().map(|s| s.joint).collect();
            all.sort_unstable();
            prop_assert_eq!(all, (0..joints.len()).collect::<Vec<usize>>());
            // Euler: faces = edges - nodes + 2, counted over joints and sections that start and end at joints.
            let bounded = rooms.thickness_mm.len();
            let passes: usize = joints.iter().map(|j| j.passes.len()).sum();
            prop_assert_eq!(bounded, passes - joints.len() + 1);
            for (k, step) in steps.iter().enumerate() {
                let later: Vec<usize> = steps[k + 1..].iter().map(|s| s.joint).collect();
                let mut seen: Vec<bool> = rooms.thickness_mm.iter().map(|t| t.is_infinite()).collect();
                for _ in 0..rooms.thickness_mm.len() {
                    for joint in &later {
                        for (a, b) in through(&rooms, *joint) {
                            let wide = |room: usize| rooms.thickness_mm[room] >= step.way_mm;
                            let (from_a, from_b) = (seen[a] && wide(b), seen[b] && wide(a));
                            seen[b] |= from_a;
                            seen[a] |= from_b;
                        }
                    }
                }
                prop_assert!(step.way_mm > 0.0);
                prop_assert!(rooms.around[step.joint].iter().any(|s| seen[s.room]));
            }
        }
    }
}
