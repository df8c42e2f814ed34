//! Springs that hold nodes near where they were drawn: a crutch for starts far from rest, taken away in stages.

use super::{Error, Pattern, Solver};
use crate::geom::P2;
use crate::ruffle::Node;

/// Springs of one ruffle, all of the same stiffness. Energy k/2 |x - target|² each.
#[derive(Debug, Clone, Default)]
pub(super) struct Anchors {
    pub stiffness_n_per_mm: f64,
    pub targets: Vec<(usize, P2)>,
}

impl Anchors {
    /// Energy, N mm.
    pub fn energy(&self, x: &[P2]) -> f64 {
        let stretch = |(node, target): &(usize, P2)| (x[*node] - target).norm_squared();
        0.5 * self.stiffness_n_per_mm * self.targets.iter().map(stretch).sum::<f64>()
    }

    /// Adds the gradient of [`Anchors::energy`], N.
    pub fn add_gradient(&self, x: &[P2], gradient: &mut [f64]) {
        for (node, target) in &self.targets {
            let pull = (x[*node] - target) * self.stiffness_n_per_mm;
            gradient[2 * node] += pull.x;
            gradient[2 * node + 1] += pull.y;
        }
    }

    /// Adds the Hessian of [`Anchors::energy`], N/mm.
    pub fn add_hessian(&self, pattern: &Pattern, values: &mut [f64]) {
        for unknown in self.targets.iter().flat_map(|(node, _)| [2 * node, 2 * node + 1]) {
            if let Some(slot) = pattern.slot(unknown, unknown) {
                values[slot] += self.stiffness_n_per_mm;
            }
        }
    }
}

impl Solver {
    /// Holds nodes to points (plane frame, mm) by springs of `stiffness_n_per_mm`, in place of any there were; none of them, or a stiffness of 0, lets go.
    ///
    /// # Errors
    /// A node that the ruffle does not have, a point that is not finite, or a stiffness that is not zero or more.
    pub fn anchor(&mut self, targets: &[(Node, P2)], stiffness_n_per_mm: f64) -> Result<(), Error> {
        let nodes = self.system.held.len() / 2;
        for (node, target) in targets {
            if node.index() >= nodes {
                let found = node.index() + 1;
                return Err(Error::Count { what: "nodes up to the anchored one", found, expected: nodes });
            }
            if !(target.x.is_finite() && target.y.is_finite()) {
                return Err(Error::NotFinite { node: node.index() });
            }
        }
        if !(stiffness_n_per_mm >= 0.0 && stiffness_n_per_mm.is_finite()) {
            let what = "stiffness of the anchor spring";
            return Err(Error::NotPositive { what, index: 0, value: stiffness_n_per_mm });
        }
        let targets = targets.iter().map(|(node, target)| (node.index(), *target)).collect();
        self.system.anchors = Anchors { stiffness_n_per_mm, targets };
        Ok(())
    }

    /// Lets a pinned node slide along the floor: it then stays at its height only.
    ///
    /// # Errors
    /// A node that the ruffle does not have.
    pub fn let_slide(&mut self, node: Node) -> Result<(), Error> {
        let expected = self.system.held.len() / 2;
        if node.index() >= expected {
            let found = node.index() + 1;
            return Err(Error::Count { what: "nodes up to the sliding one", found, expected });
        }
        self.system.held[2 * node.index()] = false;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::paper;
    use crate::geom::P2;
    use crate::progress::Quiet;
    use crate::ruffle::uniform_stack;
    use crate::sim::{Outcome, Settings, Solver, Supports};

    #[test]
    fn anchors_hold_joints_where_they_were_drawn_until_they_are_let_go() {
        let drawn = uniform_stack(3, 25.0, 50.0, 4.0);
        let supports = Supports { pinned: drawn.ruffle.foot.to_vec(), upright: Vec::new() };
        let widths = vec![40.0; drawn.ruffle.node_count];
        let mut solver = Solver::new(&drawn.ruffle, &widths, &paper(2.1), &supports, &Settings::default()).unwrap();
        let joints: Vec<_> =
            drawn.ruffle.connection_points().iter().map(|c| (c.node, drawn.positions[c.node.index()])).collect();
        let away = |x: &[P2]| joints.iter().map(|(n, at)| (x[n.index()] - at).norm()).fold(0.0, f64::max);
        let mut rest = |stiffness| {
            solver.anchor(&joints, stiffness).unwrap();
            let e = solver.solve(&drawn.positions, &mut Quiet).unwrap();
            assert_eq!(e.outcome, Outcome::Converged);
            away(&e.positions)
        };
        let (free, loosely, firmly) = (rest(0.0), rest(0.003), rest(10.0));
        assert!(firmly < 0.3 && firmly < loosely && loosely < free, "{firmly} {loosely} {free}");
    }

    #[test]
    fn a_pinned_node_that_may_slide_stays_at_its_height() {
        let drawn = uniform_stack(2, 30.0, 50.0, 4.0);
        let [left, right] = drawn.ruffle.foot;
        let supports = Supports { pinned: vec![left, right], upright: Vec::new() };
        let widths = vec![40.0; drawn.ruffle.node_count];
        let mut solver = Solver::new(&drawn.ruffle, &widths, &paper(2.1), &supports, &Settings::default()).unwrap();
        let mut longer = drawn.ruffle.clone();
        longer.set_section_length(0, 54.0);
        solver.let_slide(right).unwrap();
        solver.measure(&longer, &widths).unwrap();
        let e = solver.solve(&drawn.positions, &mut Quiet).unwrap();
        assert_eq!(e.outcome, Outcome::Converged);
        let [a, b] = [left, right].map(|n| e.positions[n.index()]);
        assert!(a.y == 0.0 && b.y == 0.0 && a.x == 0.0 && (b.x - 54.0).abs() < 1.0, "{a} {b}");
    }
}
