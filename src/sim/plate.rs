//! A rigid, horizontal plate that lies on the ruffle and carries a dead load: weights on a book, true load control.
//!
//! The plate slides up and down without friction and does not tilt. Its one unknown is the height Y of its underside, and with the nodes it shares the energy
//! F Y + sum of kappa reach b((Y - y - least) / reach), b the contact barrier. For given nodes this is convex in Y and grows without bound both ways, so there is
//! exactly one Y at which the load is borne, and the plate is always there: the ruffle feels the least of that energy over Y. What this takes from Newton's
//! system of nodes and Y is the row of Y, which is eliminated last; so the pattern never changes however the nodes come and go, no node is ever above the
//! plate, and no step has to be shortened for it.

use super::barrier::{Gap, barrier};
use super::contact::{REACH_MM, kappa_n};
use super::{Factorisation, Material, Pattern};
use crate::geom::P2;

/// The plate above one ruffle, and the room for its row of Newton's system.
#[derive(Debug, Clone)]
pub(super) struct Plate {
    /// What it weighs with all that stands on it, N; nothing when there is none.
    load_n: Option<f64>,
    /// Barrier stiffness at each node, N.
    kappa_n: Vec<f64>,
    gap: Gap,
    /// How the plate's force changes with each unknown, N/mm.
    row: Vec<f64>,
    /// The nodes' system solved for that row.
    solved: Vec<f64>,
}

/// Newton steps towards the height, at most. The first few double the gap (the force falls as its inverse), which starts out too narrow by no more than the number of
/// nodes that share the load; then the digits double.
const MAX_HEIGHT_STEPS: usize = 100;
/// The height is found when a step is below this share of the reach: the height's own rounding.
const HEIGHT_ROUNDING: f64 = 1e-15;
/// A stiffness below this fraction of the barrier's own is what cancellation left: the ruffle does not resist the plate.
const LEAST_STIFFNESS_FRACTION: f64 = 1e-14;

impl Plate {
    /// No plate yet, above a ruffle of `nodes` nodes.
    pub fn new(nodes: usize) -> Plate {
        Plate {
            load_n: None,
            kappa_n: vec![0.0; nodes],
            gap: Gap { least_mm: 0.0, reach_mm: REACH_MM },
            row: vec![0.0; 2 * nodes],
            solved: vec![0.0; 2 * nodes],
        }
    }

    /// Takes widths at the nodes (mm), the sheet, and the weight of the whole strip (N). The nodes are the sheet's middle, so its top is half a thickness above.
    pub fn measure(&mut self, widths_mm: &[f64], material: &Material, weight_n: f64) {
        self.gap.least_mm = 0.5 * material.thickness_mm;
        for (kappa, width) in self.kappa_n.iter_mut().zip(widths_mm) {
            *kappa = kappa_n(material, *width, weight_n);
        }
    }

    /// Puts a load on the plate, N, finite and not negative; `None` takes the plate away.
    pub fn press(&mut self, load_n: Option<f64>) {
        self.load_n = load_n;
    }

    /// What the plate weighs, N, if there is one.
    pub fn load_n(&self) -> Option<f64> {
        self.load_n
    }

    /// Height of the plate's underside above nodes at `x`, mm: where the barrier's force is the load. One that weighs nothing touches the highest node without
    /// force.
    pub fn height_mm(&self, x: &[P2]) -> Option<f64> {
        let load_n = self.load_n?;
        let (highest, kappa_n) = x.iter().zip(&self.kappa_n).max_by(|(p, _), (q, _)| p.y.total_cmp(&q.y))?;
        // The force of the highest node alone is more than kappa (1 - s)² / s, so where this is the load the plate is still too low (or just touches, when there is no
        // load). The force grows ever faster towards the nodes, and Newton's method from below comes up to the root without passing it.
        let share = load_n / kappa_n;
        let s = 2.0 / (2.0 + share + ((2.0 + share).powi(2) - 4.0).sqrt());
        let mut height_mm = highest.y + self.gap.least_mm + s * self.gap.reach_mm;
        for _ in 0..MAX_HEIGHT_STEPS {
            let (mut excess_n, mut stiffness_n_per_mm) = (-load_n, 0.0);
            for (_, kappa, [_, slope, curvature]) in self.touching(x, height_mm) {
                excess_n -= kappa * slope;
                stiffness_n_per_mm += kappa * curvature / self.gap.reach_mm;
            }
            if excess_n <= 0.0 || stiffness_n_per_mm == 0.0 {
                break;
            }
            let step_mm = excess_n / stiffness_n_per_mm;
            height_mm += step_mm;
            if step_mm <= HEIGHT_ROUNDING * self.gap.reach_mm {
                break;
            }
        }
        Some(height_mm)
    }

    /// Nodes within reach of a plate at `height_mm`: which, how stiff (N), and the barrier there.
    fn touching(&self, x: &[P2], height_mm: f64) -> impl Iterator<Item = (usize, f64, [f64; 3])> {
        x.iter().zip(&self.kappa_n).enumerate().filter_map(move |(node, (p, kappa))| {
            let s = (height_mm - p.y - self.gap.least_mm) / self.gap.reach_mm;
            (s < 1.0).then(|| (node, *kappa, barrier(s)))
        })
    }

    /// Energy of the plate above nodes at `x`, N mm: its height times its load, and the barrier's.
    pub fn energy(&self, x: &[P2]) -> f64 {
        let (Some(load_n), Some(height_mm)) = (self.load_n, self.height_mm(x)) else { return 0.0 };
        let pressed: f64 = self.touching(x, height_mm).map(|(_, kappa, [b, ..])| kappa * self.gap.reach_mm * b).sum();
        load_n * height_mm + pressed
    }

    /// Adds the gradient of [`Plate::energy`] over the nodes, N. The height is where the energy is least, so that its own change does not count.
    pub fn add_gradient(&self, x: &[P2], gradient: &mut [f64]) {
        let Some(height_mm) = self.height_mm(x) else { return };
        for (node, kappa, [_, slope, _]) in self.touching(x, height_mm) {
            gradient[2 * node + 1] -= kappa * slope;
        }
    }

    /// Adds the Hessian of the plate's energy at a fixed height, N/mm, which is diagonal and never indefinite. What the plate's own motion takes away again comes
    /// with [`Plate::follow`].
    pub fn add_hessian(&self, x: &[P2], pattern: &Pattern, values: &mut [f64]) {
        let Some(height_mm) = self.height_mm(x) else { return };
        for (node, kappa, [_, _, curvature]) in self.touching(x, height_mm) {
            let unknown = 2 * node + 1;
            let slot = pattern.slot(unknown, unknown).expect("every diagonal entry has a slot");
            values[slot] += kappa * curvature / self.gap.reach_mm;
        }
    }

    /// Turns the Newton direction under a plate that stands still, from `system` factored with [`Plate::add_hessian`], into the one under a plate that follows: the
    /// last row of the factorisation of nodes and plate together. False when that row's pivot is not positive, and the whole not positive definite.
    pub fn follow(&mut self, x: &[P2], fixed: &[bool], system: &mut impl Factorisation, direction: &mut [f64]) -> bool {
        let Some(height_mm) = self.height_mm(x) else { return true };
        let mut row = std::mem::take(&mut self.row);
        row.fill(0.0);
        let mut own_n_per_mm = 0.0;
        for (node, kappa, [_, _, curvature]) in self.touching(x, height_mm) {
            let stiffness = kappa * curvature / self.gap.reach_mm;
            own_n_per_mm += stiffness;
            if !fixed[2 * node + 1] {
                row[2 * node + 1] = -stiffness;
            }
        }
        self.row = row;
        if own_n_per_mm == 0.0 {
            return true;
        }
        self.solved.copy_from_slice(&self.row);
        system.solve(&mut self.solved);
        let along = |v: &[f64]| self.row.iter().zip(v).map(|(r, v)| r * v).sum::<f64>();
        let pivot = own_n_per_mm - along(&self.solved);
        if pivot.is_nan() || pivot <= LEAST_STIFFNESS_FRACTION * own_n_per_mm {
            return false;
        }
        let rise_mm = -along(direction) / pivot;
        direction.iter_mut().zip(&self.solved).for_each(|(d, z)| *d -= z * rise_mm);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ruffle::uniform_stack;
    use crate::sim::LdlT;
    use crate::sim::model::Model;
    use proptest::prelude::*;

    const PAPER: Material = Material {
        flexural_rigidity_n_mm: 2.1,
        membrane_stiffness_n_per_mm: 600.0,
        grammage_g_per_m2: 160.0,
        thickness_mm: 0.19,
    };

    fn pressed(nodes: usize, load_n: f64) -> Plate {
        let widths: Vec<f64> = (0..nodes).map(|i| 60.0 + 20.0 * (i as f64).sin()).collect();
        let mut plate = Plate::new(nodes);
        plate.measure(&widths, &PAPER, 0.06);
        plate.press(Some(load_n));
        plate
    }

    fn row_of_nodes(heights_mm: &[f64]) -> Vec<P2> {
        heights_mm.iter().enumerate().map(|(i, y)| P2::new(i as f64, *y)).collect()
    }

    proptest! {
        #[test]
        fn the_nodes_bear_the_load_and_all_of_them_are_below_the_plate(
            heights in prop::collection::vec(69.0..70.0f64, 1..30), log_load in -9.0..3.0f64,
        ) {
            let (x, load_n) = (row_of_nodes(&heights), 10f64.powf(log_load));
            let plate = pressed(x.len(), load_n);
            let height = plate.height_mm(&x).unwrap();
            prop_assert!(x.iter().all(|p| p.y < height - plate.gap.least_mm));
            let mut g = vec![0.0; 2 * x.len()];
            plate.add_gradient(&x, &mut g);
            // A height of 70 mm is known to 1.4e-14 mm, which at a gap of s times the reach is that over s of the force.
            prop_assert!((g.iter().sum::<f64>() / load_n - 1.0).abs() < 1e-7, "{} of {load_n} N", g.iter().sum::<f64>());
            prop_assert!(g.iter().all(|f| *f >= 0.0));
        }

        #[test]
        fn the_gradient_matches_finite_differences(
            heights in prop::collection::vec(69.7..70.0f64, 2..8), load_n in 0.01..5.0f64,
        ) {
            let x = row_of_nodes(&heights);
            let plate = pressed(x.len(), load_n);
            let mut g = vec![0.0; 2 * x.len()];
            plate.add_gradient(&x, &mut g);
            for (node, force) in g.iter().skip(1).step_by(2).enumerate() {
                let at = |by: f64| {
                    let mut x = x.clone();
                    x[node].y += by;
                    plate.energy(&x)
                };
                let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
                prop_assert!((slope - force).abs() < 1e-5 * load_n, "{slope} against {force}");
            }
        }
    }

    #[test]
    fn a_plate_without_load_touches_the_highest_node_without_force() {
        let x = row_of_nodes(&[3.0, 5.0, 4.0]);
        let plate = pressed(3, 0.0);
        assert!((plate.height_mm(&x).unwrap() - 5.0 - plate.gap.outer_mm()).abs() < 1e-12);
        let mut g = vec![0.0; 6];
        plate.add_gradient(&x, &mut g);
        assert!(plate.energy(&x).abs() < 1e-30 && g.iter().all(|f| f.abs() < 1e-20));
        let mut none = plate;
        none.press(None);
        assert_eq!((none.height_mm(&x), none.energy(&x)), (None, 0.0));
    }

    #[test]
    fn the_direction_solves_newtons_system_of_the_sum_by_finite_differences() {
        let drawn = uniform_stack(2, 30.0, 52.8, 8.0);
        let (nodes, n) = (drawn.ruffle.node_count, 2 * drawn.ruffle.node_count);
        let mut model = Model::new(&drawn.ruffle);
        let pattern = model.pattern(std::iter::empty()).unwrap();
        model.measure(&drawn.ruffle.rest_lengths, &vec![80.0; nodes], &PAPER);
        let wobble =
            |(i, p): (usize, &P2)| P2::new(p.x + 0.1 * (1.7 * i as f64).sin(), p.y + 0.1 * (2.3 * i as f64).cos());
        let x: Vec<P2> = drawn.positions.iter().enumerate().map(wobble).collect();
        let mut plate = pressed(nodes, 2.0);
        let mut gradient = |x: &[P2]| {
            let mut g = vec![0.0; n];
            model.gradient(x, &mut g);
            plate.add_gradient(x, &mut g);
            g
        };
        let nudged = |unknown: usize, by: f64| {
            let mut x = x.clone();
            x[unknown / 2].coords[unknown % 2] += by;
            x
        };
        // Some of the nodes that the plate touches are held.
        let height = plate.height_mm(&x).unwrap();
        let touching: Vec<usize> = plate.touching(&x, height).map(|(node, ..)| node).collect();
        assert!(touching.len() > 3, "{touching:?}");
        let mut fixed = vec![false; n];
        (fixed[0], fixed[1], fixed[2 * touching[1] + 1]) = (true, true, true);

        let g = gradient(&x);
        let mut values = vec![0.0; pattern.slots()];
        model.hessian(&x, true, &mut values);
        plate.add_hessian(&x, &pattern, &mut values);
        pattern.fix(&mut values, &fixed);
        let mut system = LdlT::new(pattern.clone());
        assert!(system.factor(&values));
        let mut direction: Vec<f64> = g.iter().zip(&fixed).map(|(g, f)| if *f { 0.0 } else { -g }).collect();
        system.solve(&mut direction);
        // The model's part of the Hessian is the convex one, taken as it is; the plate's is differenced.
        let mut of_model = vec![0.0; pattern.slots()];
        model.hessian(&x, true, &mut of_model);
        assert!(plate.follow(&x, &fixed, &mut system, &mut direction));
        let h = 1e-6;
        let of_plate = |x: &[P2]| {
            let mut g = vec![0.0; n];
            plate.add_gradient(x, &mut g);
            g
        };
        let mut left = vec![0.0; n];
        for (j, d) in direction.iter().enumerate() {
            let (up, down) = (of_plate(&nudged(j, h)), of_plate(&nudged(j, -h)));
            for (i, l) in left.iter_mut().enumerate() {
                let of_model = pattern.slot(i, j).map_or(0.0, |slot| of_model[slot]);
                *l += (of_model + (up[i] - down[i]) / (2.0 * h)) * d;
            }
        }
        let largest = g.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for i in (0..n).filter(|i| !fixed[*i]) {
            assert!((left[i] + g[i]).abs() < 1e-5 * largest, "unknown {i}: {} against {}", left[i], -g[i]);
        }
    }

    #[test]
    fn a_ruffle_that_does_not_resist_is_reported() {
        let mut plate = pressed(1, 1.0);
        let x = row_of_nodes(&[2.0]);
        let pattern = Pattern::new(2, [[0usize].as_slice()]).unwrap();
        let mut values = vec![0.0; pattern.slots()];
        pattern.damp(&mut values, -1e-3);
        plate.add_hessian(&x, &pattern, &mut values);
        pattern.fix(&mut values, &[true, false]);
        let mut system = LdlT::new(pattern);
        assert!(system.factor(&values), "under a plate that stands still the node stands still");
        assert!(!plate.follow(&x, &[true, false], &mut system, &mut [0.0, -1.0]));
    }
}
