//! Where a strip at rest goes when its lengths change: the tangent of the equilibrium over the rest lengths.

use super::model::Model;
use super::stretch::stretch;
use super::{Error, Solver, hinge};
use crate::geom::{P2, V2};
use crate::ruffle::Ruffle;

impl Model {
    /// How the gradient changes (N) while every rest length grows by `by_mm` of its segment, to first order.
    fn gradient_by_lengths(&self, x: &[P2], by_mm: &[f64], change: &mut [f64]) {
        change.fill(0.0);
        self.each_length_change(x, |segment, unknown, slope| change[unknown] += by_mm[segment] * slope);
    }

    /// How `moves` (mm per unknown), taken against the gradient, add up when one rest length grows, for each segment (N mm per mm): the transpose of
    /// [`Model::gradient_by_lengths`].
    fn lengths_by_gradient(&self, x: &[P2], moves: &[f64], sums: &mut [f64]) {
        sums.fill(0.0);
        self.each_length_change(x, |segment, unknown, slope| sums[segment] += moves[unknown] * slope);
    }

    /// Names every change of an entry of the gradient by a rest length, N/mm: stretching stiffness E t w / l, bending stiffness D w / mean rest length and
    /// weights all hang on them.
    fn each_length_change(&self, x: &[P2], mut name: impl FnMut(usize, usize, f64)) {
        for (s, [i, j]) in self.segments.iter().copied().enumerate() {
            let (rest, k) = (self.rest_mm[s], self.stretch_n_per_mm[s]);
            let (_, pull, _) = stretch(x[i], x[j], rest, k, true);
            // d/dl of k (d - l) n with k = E t w / l.
            let along = (x[j] - x[i]).normalize();
            let pull = -pull / rest - along * k;
            for axis in 0..2 {
                name(s, 2 * i + axis, -pull[axis]);
                name(s, 2 * j + axis, pull[axis]);
            }
            let half = 0.5 * self.weight_n_per_mm[s];
            name(s, 2 * i + 1, half);
            name(s, 2 * j + 1, half);
        }
        for (h, c) in self.hinges.iter().zip(&self.bend_n_mm) {
            let [i, j, k] = h.nodes;
            let (moment, d_phi) = hinge::gradient(x[i], x[j], x[k], *c);
            let softer = -moment / (self.rest_mm[h.segments[0]] + self.rest_mm[h.segments[1]]);
            for segment in h.segments {
                for (corner, node) in h.nodes.iter().enumerate() {
                    for axis in 0..2 {
                        name(segment, 2 * node + axis, softer * d_phi[2 * corner + axis]);
                    }
                }
            }
        }
    }
}

impl Solver {
    /// How the nodes move (mm) when the rest length of every segment grows by `by_mm` of its own, to first order, from the state of rest `x` under the lengths the
    /// solver has now: dx/dl = -H⁻¹ dg/dl, with the distance that sheets keep taken as it is. Nothing where the state is not a stable one.
    ///
    /// # Errors
    /// Positions or lengths that do not match the ruffle, or a strip that passes through itself.
    pub fn tangent(&mut self, x: &[P2], by_mm: &[f64]) -> Result<Option<Vec<V2>>, Error> {
        let moves = self.tangents(x, &[by_mm.to_vec()])?;
        Ok(moves.and_then(|mut moves| moves.pop()))
    }

    /// As [`Solver::tangent`] for several changes of the lengths, with one factorisation.
    ///
    /// # Errors
    /// As [`Solver::tangent`].
    pub fn tangents(&mut self, x: &[P2], changes: &[Vec<f64>]) -> Result<Option<Vec<Vec<V2>>>, Error> {
        let expected = self.ruffle.rest_lengths.len();
        if let Some(by_mm) = changes.iter().find(|by_mm| by_mm.len() != expected) {
            return Err(Error::Count { what: "changes of rest lengths", found: by_mm.len(), expected });
        }
        self.residual_n(x)?;
        let by_lengths = |by_mm: &Vec<f64>| {
            let mut change = vec![0.0; 2 * x.len()];
            self.system.model.gradient_by_lengths(x, by_mm, &mut change);
            change
        };
        let changes: Vec<Vec<f64>> = changes.iter().map(by_lengths).collect();
        let moves = self.system.responses(x, &changes)?;
        let nodes = |d: &Vec<f64>| d.chunks_exact(2).map(|d| V2::new(d[0], d[1])).collect();
        Ok(moves.map(|moves| moves.iter().map(nodes).collect()))
    }

    /// How a figure of merit changes with the rest length of every segment (per mm), when the strip comes to rest again each time, to first order. `slopes` says how it
    /// changes with the place of every node (per mm) at the state of rest `x`. One solve with the Hessian's factor, however many lengths there are (the adjoint of
    /// [`Solver::tangent`]). Nothing where the state is not a stable one.
    ///
    /// # Errors
    /// As [`Solver::tangent`].
    pub fn slopes_by_lengths(&mut self, x: &[P2], slopes: &[V2]) -> Result<Option<Vec<f64>>, Error> {
        if slopes.len() != x.len() {
            return Err(Error::Count { what: "slopes", found: slopes.len(), expected: x.len() });
        }
        self.residual_n(x)?;
        let slopes: Vec<f64> = slopes.iter().flat_map(|s| [s.x, s.y]).collect();
        let moves = self.system.responses(x, &[slopes])?;
        Ok(moves.map(|moves| {
            let mut sums = vec![0.0; self.ruffle.rest_lengths.len()];
            self.system.model.lengths_by_gradient(x, &moves[0], &mut sums);
            sums
        }))
    }

    /// Takes new rest lengths and widths as [`Solver::measure`] does, and predicts where the strip, at rest at `x` before, will come to rest: along the tangent, turning instead of
    /// stretching, and through nothing. A start for [`Solver::solve`] that saves it steps.
    ///
    /// # Errors
    /// As [`Solver::measure`] and [`Solver::tangent`].
    pub fn predict(&mut self, x: &[P2], ruffle: &Ruffle, widths_mm: &[f64]) -> Result<Vec<P2>, Error> {
        let by_mm: Vec<f64> =
            ruffle.rest_lengths.iter().zip(&self.ruffle.rest_lengths).map(|(to, from)| to - from).collect();
        let moves = self.tangent(x, &by_mm)?;
        self.measure(ruffle, widths_mm)?;
        self.admit(x)?;
        Ok(match moves {
            Some(moves) => self.system.walk_along(x, &moves),
            None => x.to_vec(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::paper;
    use super::*;
    use crate::progress::Quiet;
    use crate::ruffle::{Drawn, uniform_stack};
    use crate::sim::{Outcome, Settings, Supports};

    fn at_rest(drawn: &Drawn) -> (Solver, Vec<P2>) {
        let supports = Supports { pinned: Vec::new(), upright: vec![drawn.ruffle.foot[0]] };
        let settings = Settings { residual_n: 1e-8, ..Settings::default() };
        let widths = vec![80.0; drawn.ruffle.node_count];
        let mut solver = Solver::new(&drawn.ruffle, &widths, &paper(2.1), &supports, &settings).unwrap();
        let e = solver.solve(&drawn.positions, &mut Quiet).unwrap();
        assert_eq!(e.outcome, Outcome::Converged);
        (solver, e.positions)
    }

    #[test]
    fn the_tangent_is_the_change_of_equilibrium_by_finite_differences() {
        let drawn = uniform_stack(2, 30.0, 52.8, 4.0);
        let (mut solver, x) = at_rest(&drawn);
        let widths = vec![80.0; x.len()];
        for section in [1, 2, 3] {
            let long = drawn.ruffle.section_length(section);
            let mut by_mm = vec![0.0; drawn.ruffle.rest_lengths.len()];
            for k in drawn.ruffle.sections[section].segments() {
                by_mm[k] = drawn.ruffle.rest_lengths[k] / long;
            }
            let tangent = solver.tangent(&x, &by_mm).unwrap().expect("a stable state");
            let h = 1e-3;
            let mut moved = |by: f64| {
                let mut ruffle = drawn.ruffle.clone();
                ruffle.set_section_length(section, long + by);
                solver.measure(&ruffle, &widths).unwrap();
                let e = solver.solve(&x, &mut Quiet).unwrap();
                assert_eq!(e.outcome, Outcome::Converged);
                e.positions
            };
            let (up, down) = (moved(h), moved(-h));
            solver.measure(&drawn.ruffle, &widths).unwrap();
            let largest = tangent.iter().map(|t| t.norm()).fold(0.0, f64::max);
            for (i, t) in tangent.iter().enumerate() {
                let slope = (up[i] - down[i]) / (2.0 * h);
                assert!((slope - t).norm() < 2e-3 * largest, "section {section}, node {i}: {slope} against {t}");
            }
        }
    }

    #[test]
    fn slopes_by_lengths_are_the_tangent_seen_from_the_other_side() {
        let drawn = uniform_stack(2, 30.0, 52.8, 4.0);
        let (mut solver, x) = at_rest(&drawn);
        let slopes: Vec<V2> = (0..x.len()).map(|i| V2::new((i as f64).sin(), (1.3 * i as f64).cos())).collect();
        let by_lengths = solver.slopes_by_lengths(&x, &slopes).unwrap().expect("a stable state");
        for segment in [0, 7, 31] {
            let mut by_mm = vec![0.0; by_lengths.len()];
            by_mm[segment] = 1.0;
            let tangent = solver.tangent(&x, &by_mm).unwrap().expect("a stable state");
            let slope: f64 = tangent.iter().zip(&slopes).map(|(t, s)| t.dot(s)).sum();
            assert!((slope - by_lengths[segment]).abs() < 1e-8 * slope.abs().max(1.0), "segment {segment}");
        }
    }

    #[test]
    fn a_predicted_start_is_much_nearer_to_rest_than_the_old_state() {
        let drawn = uniform_stack(3, 30.0, 52.8, 4.0);
        let (mut solver, x) = at_rest(&drawn);
        let widths = vec![80.0; x.len()];
        let mut longer = drawn.ruffle.clone();
        longer.set_section_length(3, 1.02 * longer.section_length(3));
        let predicted = solver.predict(&x, &longer, &widths).unwrap();
        let rest = solver.solve(&predicted, &mut Quiet).unwrap();
        assert_eq!((rest.outcome, rest.self_intersections), (Outcome::Converged, 0));
        let away = |from: &[P2]| from.iter().zip(&rest.positions).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(away(&predicted) < 0.3 * away(&x), "{} against {} mm", away(&predicted), away(&x));
        let from_old = solver.solve(&x, &mut Quiet).unwrap();
        assert!(rest.iterations < from_old.iterations, "{} against {} steps", rest.iterations, from_old.iterations);
    }
}
