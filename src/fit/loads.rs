//! Weight handed on from part to part (paper section 4.3), and the shapes that go with it.

use super::forest::Forest;
use super::{Error, Part, Settings, Target, settle};
use crate::geom::{P2, P3, V2};
use crate::ruffle::Node;
use crate::sim::GRAVITY_MM_PER_S2;

/// Forces agree when none changes by more than this from round to round, N: a hundredth of a gram, a thousandth of a small part's weight.
const AGREED_N: f64 = 1e-4;
/// Widths follow shapes and weights follow widths by less each round; two or three rounds are usual.
const MAX_ROUNDS: usize = 8;
/// A load stays on its node until another lies nearer by more than this, mm: between two equally near ones it would jump to and fro.
const STAY_MM: f64 = 1.0;

/// Lets filled parts settle under their own weight and that of all they bear, until shapes, widths and forces agree. `targets`, `settings` and `parts` go by the
/// numbers of the forest. A part's whole weight, with what it bears, rests on the node of each part below that lies nearest to where the two touch.
///
/// # Errors
/// As [`settle`].
pub fn settle_together(
    targets: &[Target],
    settings: &[Settings],
    mut parts: Vec<Part>,
    forest: &Forest,
) -> Result<Vec<Part>, Error> {
    for round in 0..MAX_ROUNDS {
        let mut borne: Vec<Vec<(P3, f64)>> = vec![Vec::new(); parts.len()];
        let mut worst_n: f64 = 0.0;
        for i in forest.from_the_top.iter().copied() {
            let loads_n = on_nodes(&parts[i], &borne[i]);
            let change_n = difference_n(&loads_n, &parts[i].loads_n);
            worst_n = worst_n.max(change_n);
            if round == 0 || change_n > AGREED_N {
                let mut part = parts[i].clone();
                if !loads_n.is_empty() {
                    // The load has moved the strip, or will: it is as wide as the shape is where it lies now.
                    part.spans = targets[i].extruder.spans(&part.ruffle, &part.equilibrium.positions);
                }
                parts[i] = settle(&Target { loads_n: &loads_n, ..targets[i] }, &settings[i], part)?;
            }
            let whole_n = weight_n(&parts[i]) + borne[i].iter().map(|(_, weight_n)| weight_n).sum::<f64>();
            for lean in &forest.leans[i] {
                borne[lean.on].push((lean.at, lean.share * whole_n));
            }
        }
        if worst_n <= AGREED_N {
            break;
        }
    }
    Ok(parts)
}

/// Weight of a part's strip, N.
fn weight_n(part: &Part) -> f64 {
    part.report.strip_mass_g * 1e-3 * GRAVITY_MM_PER_S2 * 1e-3
}

/// Weights at points of space as forces on the part's nodes, each node once, by number. Down is the plane's own: the solver bends a strip under its full weight
/// however its plane leans.
fn on_nodes(part: &Part, borne: &[(P3, f64)]) -> Vec<(Node, V2)> {
    let positions = &part.equilibrium.positions;
    let mut loads: Vec<(Node, V2)> = Vec::new();
    for (at, weight_n) in borne {
        let node = nearest(positions, part.frame.to_plane(*at), &part.loads_n);
        let force = V2::new(0.0, -weight_n);
        match loads.iter_mut().find(|(n, _)| *n == node) {
            Some((_, sum)) => *sum += force,
            None => loads.push((node, force)),
        }
    }
    loads.sort_by_key(|(node, _)| *node);
    loads
}

/// The node nearest to `at`; one that bears a load already is preferred.
fn nearest(positions: &[P2], at: P2, loaded: &[(Node, V2)]) -> Node {
    let distance = |i: usize| {
        let node = Node(i as u32);
        let favour = if loaded.iter().any(|(n, _)| *n == node) { STAY_MM } else { 0.0 };
        (positions[i] - at).norm() - favour
    };
    let best = (0..positions.len()).min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    Node(best.unwrap_or(0) as u32)
}

/// The largest change of a force on any node, N.
fn difference_n(a: &[(Node, V2)], b: &[(Node, V2)]) -> f64 {
    let on = |loads: &[(Node, V2)], node: Node| {
        loads.iter().find(|(n, _)| *n == node).map_or(V2::zeros(), |(_, force)| *force)
    };
    a.iter().chain(b).map(|(node, _)| (on(a, *node) - on(b, *node)).norm()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::forest::{Body, Meeting, forest};
    use super::super::{Foot, fit};
    use super::*;
    use crate::cut::{Outline, PlaneFrame};
    use crate::extrude::Extruder;
    use crate::geom::V3;
    use crate::progress::{Observer, Progress};
    use crate::sim::{Material, Outcome};
    use std::ops::ControlFlow;

    /// Takes the first filling that stands.
    struct Hurried;

    impl Observer for Hurried {
        fn step(&mut self, _: Progress) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }

    /// Boxes 80 wide and 60 high, one on the other or side by side, filled and settled together.
    fn settled(corners: &[(f64, f64)], meetings: &[Meeting]) -> (Vec<Part>, Forest) {
        let material = Material {
            flexural_rigidity_n_mm: 2.1,
            membrane_stiffness_n_per_mm: 600.0,
            grammage_g_per_m2: 160.0,
            thickness_mm: 0.19,
        };
        let frame = PlaneFrame { origin: P3::origin(), u: V3::x(), v: V3::y(), normal: V3::z() };
        let extruder = Extruder::constant(-20.0, 20.0).unwrap();
        let outlines: Vec<Outline> = corners
            .iter()
            .map(|(x, y)| {
                let corner = |(dx, dy)| P2::new(x + dx, y + dy);
                Outline {
                    outer: [(0.0, 0.0), (80.0, 0.0), (80.0, 60.0), (0.0, 60.0)].map(corner).to_vec(),
                    holes: Vec::new(),
                }
            })
            .collect();
        let targets: Vec<Target> = outlines
            .iter()
            .map(|outline| Target {
                name: "A",
                frame: &frame,
                outline,
                extruder: &extruder,
                material: &material,
                loads_n: &[],
            })
            .collect();
        let settings = Settings { foot: Foot::Pinned, ..Settings::default() };
        let filled = targets.iter().map(|t| fit(t, &settings, None, &mut Hurried).unwrap()).collect();
        let bodies: Vec<Body> = corners
            .iter()
            .map(|(x, y)| Body { center: P3::new(x + 40.0, y + 30.0, 0.0), above_ground_mm: *y, height_mm: 60.0 })
            .collect();
        let forest = forest(&bodies, meetings, V3::y());
        let settings = vec![settings; corners.len()];
        (settle_together(&targets, &settings, filled, &forest).unwrap(), forest)
    }

    fn borne_n(part: &Part) -> f64 {
        -part.loads_n.iter().map(|(_, force)| force.y).sum::<f64>()
    }

    #[test]
    fn in_a_tower_of_three_every_part_bears_the_weight_of_all_above() {
        let meeting = |a, b, y| Meeting { parts: [a, b], at: P3::new(40.0, y, 0.0) };
        let corners = [(0.0, 0.0), (0.0, 60.0), (0.0, 120.0)];
        let (parts, _) = settled(&corners, &[meeting(0, 1, 60.0), meeting(1, 2, 120.0)]);
        let weights: Vec<f64> = parts.iter().map(weight_n).collect();
        assert_eq!(borne_n(&parts[2]), 0.0);
        assert!((borne_n(&parts[1]) - weights[2]).abs() < 2.0 * AGREED_N);
        assert!((borne_n(&parts[0]) - weights[1] - weights[2]).abs() < 2.0 * AGREED_N);
        for part in &parts {
            assert_eq!(part.equilibrium.outcome, Outcome::Converged);
            assert!(part.loads_n.iter().all(|(_, force)| force.x == 0.0));
        }
        let top = |part: &Part| part.equilibrium.positions.iter().map(|p| p.y).fold(0.0, f64::max);
        assert!(
            top(&parts[0]) < top(&parts[1]) - 60.0 && top(&parts[1]) < top(&parts[2]) - 60.0,
            "what bears more sags more"
        );
        let (loaded, force) = parts[0].loads_n[0];
        let at = parts[0].equilibrium.positions[loaded.index()];
        assert!(force.y < 0.0 && (at.x - 40.0).abs() < 25.0, "{at}");
    }

    #[test]
    fn two_legs_bear_half_each_and_their_forces_sum_to_the_weight() {
        let meeting = |a, x| Meeting { parts: [a, 2], at: P3::new(x, 60.0, 0.0) };
        let (parts, _) = settled(&[(-45.0, 0.0), (45.0, 0.0), (0.0, 60.0)], &[meeting(0, 10.0), meeting(1, 70.0)]);
        let (left, right) = (borne_n(&parts[0]), borne_n(&parts[1]));
        assert!((left + right - weight_n(&parts[2])).abs() < 2.0 * AGREED_N);
        assert!((left - right).abs() < 1e-3 * left, "{left} {right}");
    }
}
