//! The rooms of a folded strip and the border round them, as walks over its nodes.
//!
//! A strip that never passes through itself is a planar graph, and stays the same one however it moves: worked out once, its faces hold for every shape it takes.

use crate::geom::{P2, V2, cross};
use crate::ruffle::Ruffle;

/// Faces of the strip's graph, counter-clockwise.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Faces {
    /// Nodes along the outer border.
    pub border: Vec<usize>,
    /// Nodes round each room.
    pub rooms: Vec<Vec<usize>>,
}

impl Faces {
    /// Faces of `ruffle` as it lies at `x`, where it must not pass through itself.
    pub fn of(ruffle: &Ruffle, x: &[P2]) -> Faces {
        // Half-edge 2 k runs along segment k, 2 k + 1 against it.
        let ends: Vec<(usize, usize)> = ruffle.segments().flat_map(|(i, j)| [(i, j), (j, i)]).collect();
        let mut leaving: Vec<Vec<usize>> = vec![Vec::new(); ruffle.node_count];
        for (h, (from, _)) in ends.iter().enumerate() {
            leaving[*from].push(h);
        }
        let angle = |h: usize| {
            let d = x[ends[h].1] - x[ends[h].0];
            d.y.atan2(d.x)
        };
        for halves in &mut leaving {
            halves.sort_by(|a, b| angle(*a).total_cmp(&angle(*b)));
        }
        // The face on the left goes on with the next half-edge clockwise from the way back.
        let next = |h: usize| {
            let around = &leaving[ends[h].1];
            let back = around.iter().position(|other| *other == h ^ 1).unwrap_or(0);
            around[(back + around.len() - 1) % around.len()]
        };
        let mut walked = vec![false; ends.len()];
        let mut faces = Faces::default();
        for start in 0..ends.len() {
            let mut nodes = Vec::new();
            let mut h = start;
            while !std::mem::replace(&mut walked[h], true) {
                nodes.push(ends[h].0);
                h = next(h);
            }
            if nodes.is_empty() {
                continue;
            }
            if doubled_area(&nodes, x) > 0.0 {
                faces.rooms.push(nodes);
            } else {
                nodes.reverse();
                faces.border = nodes;
            }
        }
        faces
    }
}

/// Twice the area that a closed walk goes round counter-clockwise, mm².
pub(super) fn doubled_area(nodes: &[usize], x: &[P2]) -> f64 {
    let Some(origin) = nodes.first().map(|n| x[*n]) else { return 0.0 };
    sides(nodes).map(|(i, j)| cross(x[i] - origin, x[j] - origin)).sum()
}

/// Adds `by` times the change of that doubled area with the place of every node.
pub(super) fn add_doubled_area_slope(nodes: &[usize], x: &[P2], by: f64, slopes: &mut [V2]) {
    for (i, j) in sides(nodes) {
        // cross(a, b) = a.x b.y - a.y b.x
        slopes[i] += V2::new(x[j].y, -x[j].x) * by;
        slopes[j] += V2::new(-x[i].y, x[i].x) * by;
    }
}

/// Consecutive nodes of a closed walk.
pub(super) fn sides(nodes: &[usize]) -> impl Iterator<Item = (usize, usize)> + '_ {
    nodes.iter().copied().zip(nodes.iter().copied().cycle().skip(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::enclosed;
    use crate::ruffle::{EditSettings, Limits, densify, uniform_stack};

    #[test]
    fn the_border_goes_round_what_the_strip_encloses_and_a_layer_has_two_rooms() {
        let plain = uniform_stack(3, 25.0, 50.0, 4.0);
        let settings = EditSettings { segment_mm: 4.0, limits: Limits::default() };
        let dense = densify(&plain, &[5], 1, &settings).unwrap();
        for drawn in [&plain, &dense] {
            let x = &drawn.positions;
            let faces = Faces::of(&drawn.ruffle, x);
            let segments: Vec<(P2, P2)> = drawn.ruffle.segments().map(|(i, j)| (x[i], x[j])).collect();
            let region = enclosed(&segments);
            assert_eq!(faces.rooms.len(), region.rooms.len());
            let area: f64 = region.loops.iter().map(|l| crate::geom::signed_area(l)).sum();
            assert!((0.5 * doubled_area(&faces.border, x) - area).abs() < 1e-3);
        }
        assert_eq!(Faces::of(&plain.ruffle, &plain.positions).rooms.len(), 6);
    }
}
