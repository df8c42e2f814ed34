//! Pulls a start apart that passes through itself: a run of strip about a crossing is laid straight, the shortest run first, and kept so where that leaves fewer crossings than
//! before. So this ends, and what it returns has no crossings; where nothing helps, the start is refused.
//!
//! It mends what pokes through a neighbour: of random bumps of 1 to 10 segments' height, 19 of 20. It does not sort out a drawing whose layers lie in each other.

use super::walk::Walk;
use crate::geom::P2;

/// More crossings than this are a wrong drawing, not a tangle.
const MOST_CROSSINGS: usize = 60;
/// Segments before and after a crossing that are laid straight, the fewest first.
const REACHES: [usize; 6] = [2, 3, 5, 8, 13, 21];

/// Positions without crossings near `x`, the unknowns in `held` where they were and nothing below the floor; nothing if that did not succeed.
pub(super) fn untangle(walk: &Walk, x: &[P2], held: &[bool], floor_mm: f64) -> Option<Vec<P2>> {
    let mut x = x.to_vec();
    let mut crossings = walk.crossings(&x);
    while !crossings.is_empty() {
        if crossings.len() > MOST_CROSSINGS {
            return None;
        }
        let runs = REACHES.iter().flat_map(|reach| crossings.iter().flat_map(|c| c.at.map(|at| (at, *reach))));
        let mut mended = runs.filter_map(|(at, reach)| {
            let straight = straightened(walk, at, reach, &x, held, floor_mm);
            let left = walk.crossings(&straight);
            (left.len() < crossings.len()).then_some((straight, left))
        });
        (x, crossings) = mended.next()?;
    }
    Some(x)
}

/// The nodes up to `reach` segments from a position along the strip laid on the straight line between the nodes there.
fn straightened(walk: &Walk, at: f64, reach: usize, x: &[P2], held: &[bool], floor_mm: f64) -> Vec<P2> {
    let first = (at as usize + 1).saturating_sub(reach);
    let last = (at as usize + reach).min(walk.nodes.len() - 1);
    let (a, b) = (x[walk.nodes[first]], x[walk.nodes[last]]);
    let mut to = x.to_vec();
    for k in first + 1..last {
        let node = walk.nodes[k];
        let on_line = a + (b - a) * ((k - first) as f64 / (last - first) as f64);
        if !held[2 * node] {
            to[node].x = on_line.x;
        }
        if !held[2 * node + 1] {
            to[node].y = on_line.y.max(floor_mm);
        }
    }
    to
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::V2;
    use crate::progress::Quiet;
    use crate::ruffle::{Drawn, uniform_stack};
    use crate::sim::{Equilibrium, Error, Material, Outcome, Settings, Solver, Supports};

    const FREE: f64 = f64::NEG_INFINITY;

    fn stack() -> (Drawn, Walk) {
        let drawn = uniform_stack(2, 30.0, 52.8, 3.0);
        let walk = Walk::new(&drawn.ruffle);
        (drawn, walk)
    }

    /// The strip pushed aside by up to `by` about position `at`, along `width` nodes either way.
    fn bumped(drawn: &Drawn, at: f64, width: f64, by: V2) -> Vec<P2> {
        let mut x = drawn.positions.clone();
        for (k, node) in drawn.ruffle.walk.iter().enumerate() {
            let s = (k as f64 - at) / width;
            x[node.index()] = drawn.positions[node.index()] + by * (-s * s).exp();
        }
        x
    }

    fn solved(drawn: &Drawn, start: &[P2], thickness_mm: f64) -> Result<Equilibrium, Error> {
        let material = Material {
            flexural_rigidity_n_mm: 2.1,
            membrane_stiffness_n_per_mm: 600.0,
            grammage_g_per_m2: 160.0,
            thickness_mm,
        };
        let supports = Supports { pinned: drawn.ruffle.foot.to_vec(), upright: Vec::new() };
        let widths = vec![80.0; drawn.ruffle.node_count];
        let mut solver = Solver::new(&drawn.ruffle, &widths, &material, &supports, &Settings::default())?;
        solver.solve(start, &mut Quiet)
    }

    #[test]
    fn bumps_that_poke_through_a_neighbour_are_pulled_out() {
        let (drawn, walk) = stack();
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut tangled, mut mended) = (0, 0);
        while tangled < 60 {
            let at = random() * drawn.ruffle.walk.len() as f64;
            let by = V2::new(random() - 0.5, random() - 0.5) * (4.0 + 40.0 * random());
            let x = bumped(&drawn, at, 2.0 + 6.0 * random(), by);
            if walk.crossings(&x).is_empty() {
                continue;
            }
            tangled += 1;
            if let Some(y) = untangle(&walk, &x, &vec![false; 2 * x.len()], FREE) {
                assert_eq!(walk.crossings(&y), []);
                mended += 1;
            }
        }
        assert!(mended >= 54, "{mended} of {tangled}");
    }

    #[test]
    fn held_nodes_and_the_floor_stay() {
        let (drawn, walk) = stack();
        let x = bumped(&drawn, 9.0, 3.0, V2::new(0.0, 40.0));
        assert!(!walk.crossings(&x).is_empty());
        let held = vec![true; 2 * x.len()];
        assert_eq!(untangle(&walk, &x, &held, FREE), None);
        let y = untangle(&walk, &x, &vec![false; 2 * x.len()], 0.5).unwrap();
        let moved = y.iter().zip(&x).filter(|(y, x)| y != x);
        assert!({ moved }.all(|(y, _)| y.y >= 0.5));
    }

    #[test]
    fn a_start_that_crosses_is_pulled_apart_and_rests_where_the_clean_drawing_does() {
        let (drawn, walk) = stack();
        // The first rung drawn through what lies above it.
        let x = bumped(&drawn, 9.0, 3.0, V2::new(0.0, 40.0));
        assert!(walk.crossings(&x).len() >= 2);
        let clean = solved(&drawn, &drawn.positions, 0.19).unwrap();
        let mended = solved(&drawn, &x, 0.19).unwrap();
        assert_eq!((mended.outcome, mended.self_intersections), (Outcome::Converged, 0));
        let apart = mended.positions.iter().zip(&clean.positions).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(apart < 0.1, "{apart} mm from where the clean drawing rests");
    }

    #[test]
    fn layers_that_lie_in_each_other_are_refused_with_both_places() {
        let (mut drawn, walk) = stack();
        let top = drawn.positions.iter().map(|p| p.y).fold(0.0, f64::max);
        drawn.positions.iter_mut().filter(|p| p.y > 0.9 * top).for_each(|p| p.y -= 40.0);
        let refused = solved(&drawn, &drawn.positions, 0.19).unwrap_err();
        let Error::Crossed { crossings, first, second, u_mm, v_mm } = refused else { panic!("{refused}") };
        assert_eq!(crossings, walk.crossings(&drawn.positions).len());
        assert!(first.section < second.section && first.along_mm < second.along_mm);
        let said = refused.to_string();
        for part in [
            format!("section {} ({:.1} mm", first.section, first.along_mm),
            format!("section {} ({:.1} mm", second.section, second.along_mm),
            format!("u {u_mm:.1}, v {v_mm:.1}"),
        ] {
            assert!(said.contains(&part), "{said}");
        }
    }
}
