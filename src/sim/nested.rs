//! Nested meshes: a fine strip starts from where a coarse one came to rest.
//!
//! The finer the segments, the more steps a first solve takes, each of which costs more. On segments twice or three times as long the large motions are done in
//! few cheap steps, and the fine solve only has to smooth what it is given (cascade: Bornemann and Deuflhard 1996, doi:10.1007/s002110050234).

use super::{Error, Outcome, Settings, Solver, Supports};
use crate::geom::P2;
use crate::progress::Observer;
use crate::ruffle::{Coarser, Node};

/// Strips of more nodes are first solved on longer segments.
const MOST_NODES: usize = 1000;
/// How much longer.
const FACTOR: usize = 3;
/// A coarse ruffle must have fewer than this share of the nodes, or nothing is won: sections of few segments cannot be made coarser.
const WORTHWHILE: f64 = 0.6;
/// Unbalanced force left on the coarse strip, against its mean weight per node: interpolation disturbs the fine one more.
const ROUGHLY: f64 = 0.1;

impl Solver {
    /// A start near rest for a strip of many nodes, from a coarse one let go at `start`; nothing where none is needed or to be had. Counts the coarse strip's steps in
    /// `iterations`.
    pub(super) fn nested_start(
        &self,
        start: &[P2],
        iterations: &mut usize,
        observer: &mut dyn Observer,
    ) -> Result<Option<Vec<P2>>, Error> {
        if start.len() <= MOST_NODES {
            return Ok(None);
        }
        let supported: Vec<Node> = self.supports.pinned.iter().chain(&self.supports.upright).copied().collect();
        let coarser = self.ruffle.coarser(FACTOR, &supported);
        if coarser.ruffle.node_count as f64 > WORTHWHILE * start.len() as f64 {
            return Ok(None);
        }
        let mut solver = self.coarse_solver(&coarser)?;
        let coarse_start: Vec<P2> = coarser.nodes.iter().map(|n| start[n.index()]).collect();
        let coarse = match solver.solve(&coarse_start, observer) {
            // Chords may cross where the curve does not.
            Err(Error::Crossed { .. }) => return Ok(None),
            solved => solved?,
        };
        *iterations += coarse.iterations;
        if coarse.outcome != Outcome::Converged {
            return Ok(None);
        }
        let mut fine = self.clone();
        for straight in [false, true] {
            let floor_mm = self.system.settings.floor_mm;
            let mut x = coarser.refine(&self.ruffle, &coarse.positions, straight);
            x.iter_mut().for_each(|p| p.y = p.y.max(floor_mm));
            for node in &supported {
                x[node.index()] = coarse.positions[coarser.nodes.iter().position(|n| n == node).unwrap_or(0)];
            }
            if fine.admit(&x).is_ok() {
                return Ok(Some(x));
            }
        }
        Ok(None)
    }

    /// The same strip, held and loaded in the same way, on a coarse mesh.
    fn coarse_solver(&self, coarser: &Coarser) -> Result<Solver, Error> {
        let nearest = coarser.nearest(&self.ruffle);
        let coarse = |nodes: &[Node]| -> Vec<Node> { nodes.iter().map(|n| nearest[n.index()]).collect() };
        let supports = Supports { pinned: coarse(&self.supports.pinned), upright: coarse(&self.supports.upright) };
        let widths_mm: Vec<f64> = coarser.nodes.iter().map(|n| self.widths_mm[n.index()]).collect();
        let per_node_n = self.system.model.weight_n() / coarser.ruffle.node_count as f64;
        let residual_n = self.system.settings.residual_n.max(ROUGHLY * per_node_n);
        let settings = Settings { residual_n, ..self.system.settings };
        let mut solver = Solver::new(&coarser.ruffle, &widths_mm, &self.material, &supports, &settings)?;
        for (node, load_n) in self.system.model.loads_n().iter().enumerate() {
            solver.system.model.add_load(nearest[node].index(), *load_n);
        }
        let anchors = &self.system.anchors;
        let held: Vec<_> = anchors.targets.iter().map(|(node, target)| (nearest[*node], *target)).collect();
        solver.anchor(&held, anchors.stiffness_n_per_mm)?;
        solver.press(self.system.plate.load_n())?;
        Ok(solver)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::paper;
    use super::*;
    use crate::progress::Quiet;
    use crate::ruffle::uniform_stack;

    #[test]
    fn a_fine_mesh_starts_near_rest_after_a_coarse_one() {
        let drawn = uniform_stack(4, 25.0, 50.0, 0.4);
        let supports = Supports { pinned: Vec::new(), upright: vec![drawn.ruffle.foot[0]] };
        let widths = vec![80.0; drawn.ruffle.node_count];
        assert!(widths.len() > 3 * MOST_NODES / 2, "{} nodes", widths.len());
        let mut solver = Solver::new(&drawn.ruffle, &widths, &paper(2.1), &supports, &Settings::default()).unwrap();
        let mut coarse_steps = 0;
        let start = solver.nested_start(&drawn.positions, &mut coarse_steps, &mut Quiet).unwrap().expect("a start");
        let e = solver.solve(&drawn.positions, &mut Quiet).unwrap();
        assert_eq!((e.outcome, e.self_intersections), (Outcome::Converged, 0));
        let away = start.iter().zip(&e.positions).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(away < 1.0, "{away} mm");
        assert!(
            coarse_steps > 0 && e.iterations < 3 * coarse_steps / 2,
            "{} steps, {coarse_steps} coarse",
            e.iterations
        );
    }

    #[test]
    fn a_coarse_solver_bears_the_same_loads() {
        let drawn = uniform_stack(2, 30.0, 50.0, 1.0);
        let widths = vec![80.0; drawn.ruffle.node_count];
        let mut solver =
            Solver::new(&drawn.ruffle, &widths, &paper(2.1), &Supports::default(), &Settings::default()).unwrap();
        let force = crate::geom::V2::new(0.2, -0.1);
        solver.load(&drawn.ruffle.walk[10..20].iter().map(|n| (*n, force)).collect::<Vec<_>>()).unwrap();
        solver.press(Some(3.0)).unwrap();
        let coarse = solver.coarse_solver(&drawn.ruffle.coarser(3, &[])).unwrap();
        let total: crate::geom::V2 = coarse.system.model.loads_n().iter().sum();
        assert!((total - force * 10.0).norm() < 1e-12 && coarse.system.plate.load_n() == Some(3.0));
        assert!((coarse.system.model.weight_n() / solver.system.model.weight_n() - 1.0).abs() < 1e-9);
    }
}
