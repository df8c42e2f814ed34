//! A strip at rest whose lengths are being changed: every change is predicted, solved and judged before it is kept.

use super::field::Field;
use super::merit::{Judge, Pull, Slopes};
use super::{Error, FootUsed, MAX_STRAIN, Settings, Target, faces::Faces, floor_mm, solver, widths};
use crate::extrude::Span;
use crate::geom::P2;
use crate::progress::Observer;
use crate::ruffle::{Drawn, Node, Ruffle};
use crate::sim::{self, Outcome, Solver};
use nalgebra::DMatrix;
use std::rc::Rc;

/// Newton steps that a change of lengths may take to come to rest; one that takes more has thrown the strip over.
const WARM_STEPS: usize = 30;
/// Newton steps that a drawing may take.
const COLD_STEPS: usize = 150;
/// Unbalanced force at which a shape is judged, N: a tenth of a percent of the weight of a short section. The shape that is kept is solved to the end.
const JUDGED_RESIDUAL_N: f64 = 1e-5;

/// What moving a node inside counts against moving one on the border, when shapes are compared.
const INSIDE_WEIGHT: f64 = 0.1;

/// A strip at rest.
pub(super) struct Shape<'a> {
    target: &'a Target<'a>,
    pub foot: FootUsed,
    solver: Solver,
    pub ruffle: Ruffle,
    pub spans: Vec<Span>,
    pub x: Vec<P2>,
    pub judge: Judge,
    pub pull: Pull,
    pub cost: f64,
    pub slopes: Slopes,
    pub spent: Spent,
}

/// Work done, to compare ways of searching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Spent {
    /// Solves.
    pub solves: usize,
    /// Newton steps of all of them.
    pub steps: usize,
}

impl<'a> Shape<'a> {
    /// Lets a drawing come to rest, its joints held near where they are drawn by springs of `hold_n_per_mm`. Nothing where it does not.
    pub fn settled(
        target: &'a Target<'a>,
        settings: &Settings,
        drawn: &Drawn,
        foot: FootUsed,
        field: &Rc<Field>,
        hold_n_per_mm: f64,
        observer: &mut dyn Observer,
    ) -> Result<Option<Shape<'a>>, Error> {
        let error = |source| Error::Solve { part: target.name.into(), source };
        let spans = target.extruder.spans(&drawn.ruffle, &drawn.positions);
        let search = Settings {
            solver: sim::Settings {
                residual_n: settings.solver.residual_n.max(JUDGED_RESIDUAL_N),
                max_iterations: COLD_STEPS.min(settings.solver.max_iterations),
                ..settings.solver
            },
            ..settings.clone()
        };
        let mut solver = solver(target, &search, &drawn.ruffle, &spans, foot).map_err(error)?;
        let mut start = drawn.positions.clone();
        if foot == FootUsed::Pinned {
            // The base is the floor; wherever on it the second end of the foot comes to lie, it can be glued.
            drawn.ruffle.foot.iter().for_each(|node| start[node.index()].y = floor_mm(target.outline));
            solver.let_slide(drawn.ruffle.foot[1]).map_err(error)?;
        }
        let targets: Vec<(Node, P2)> =
            drawn.ruffle.connection_points().iter().map(|c| (c.node, drawn.positions[c.node.index()])).collect();
        solver.anchor(&targets, hold_n_per_mm).map_err(error)?;
        let e = match solver.solve(&start, observer) {
            // A drawing that crosses itself is no start; another may be.
            Err(sim::Error::Crossed { .. }) => return Ok(None),
            solved => solved.map_err(error)?,
        };
        if e.outcome != Outcome::Converged || e.max_strain > MAX_STRAIN {
            return Ok(None);
        }
        let faces = Faces::of(&drawn.ruffle, &e.positions);
        let judge = Judge::new(Rc::clone(field), faces, settings);
        let spent = Spent { solves: 1, steps: e.iterations };
        let slopes = Slopes::default();
        let ruffle = drawn.ruffle.clone();
        let pull = Pull { targets, cost: 0.0 };
        let mut shape =
            Shape { target, foot, solver, ruffle, spans, x: e.positions, judge, pull, cost: 0.0, slopes, spent };
        shape.look();
        Ok(Some(shape))
    }

    /// Judges the shape as it is.
    pub fn look(&mut self) {
        self.cost = self.judge.cost(&self.ruffle, &self.x, &self.pull, &mut self.slopes);
    }

    fn error(&self, source: sim::Error) -> Error {
        Error::Solve { part: self.target.name.into(), source }
    }

    /// Weighs and bends the strip as wide as the mesh is where it lies now, holds its joints by springs of `hold_n_per_mm`, and lets it come to rest again. False, with the
    /// shape as it was, where it does not.
    pub fn hold(&mut self, hold_n_per_mm: f64, observer: &mut dyn Observer) -> Result<bool, Error> {
        let targets = if hold_n_per_mm > 0.0 { self.pull.targets.as_slice() } else { &[] };
        self.solver.anchor(targets, hold_n_per_mm).map_err(|e| self.error(e))?;
        let spans = self.target.extruder.spans(&self.ruffle, &self.x);
        self.solver.measure(&self.ruffle, &widths(&spans)).map_err(|e| self.error(e))?;
        let start = self.x.clone();
        let Some(x) = self.rest(&start, COLD_STEPS, observer)? else { return Ok(false) };
        (self.x, self.spans) = (x, spans);
        self.look();
        Ok(true)
    }

    fn rest(&mut self, start: &[P2], steps: usize, observer: &mut dyn Observer) -> Result<Option<Vec<P2>>, Error> {
        let e = match self.solver.solve(start, &mut Limited { observer, left: steps }) {
            Err(sim::Error::Crossed { .. }) => return Ok(None),
            solved => solved.map_err(|e| self.error(e))?,
        };
        self.spent.solves += 1;
        self.spent.steps += e.iterations;
        let good = e.outcome == Outcome::Converged && e.max_strain <= MAX_STRAIN && e.self_intersections == 0;
        Ok(good.then_some(e.positions))
    }

    /// How the cost changes with the length of every section, and with a shift of the whole to the right, per mm. Nothing where the shape is not stable.
    pub fn slopes(&mut self) -> Result<Option<(Vec<f64>, f64)>, Error> {
        let by_segment = self.solver.slopes_by_lengths(&self.x, &self.slopes.nodes).map_err(|e| self.error(e))?;
        let Some(by_segment) = by_segment else { return Ok(None) };
        let section = |s: usize| {
            let long = self.ruffle.section_length(s);
            let segments = self.ruffle.sections[s].segments();
            let slope = |k: usize| by_segment[k] + self.slopes.rests[k];
            segments.map(|k| slope(k) * self.ruffle.rest_lengths[k]).sum::<f64>() / long
        };
        let lengths = (0..self.ruffle.sections.len()).map(section).collect();
        Ok(Some((lengths, self.slopes.nodes.iter().map(|s| s.x).sum())))
    }

    /// How far the nodes move when the length of every section changes, or the whole shifts to the right, as the sums over nodes of the products of any two such moves
    /// (mm² per mm²): by how much a step in lengths changes the shape. Nodes on the border count whole, those inside a little.
    pub fn metric(&mut self) -> Result<Option<DMatrix<f64>>, Error> {
        let count = self.ruffle.sections.len();
        let by_section = |s: usize| {
            let long = self.ruffle.section_length(s);
            let mut by_mm = vec![0.0; self.ruffle.rest_lengths.len()];
            self.ruffle.sections[s].segments().for_each(|k| by_mm[k] = self.ruffle.rest_lengths[k] / long);
            by_mm
        };
        let changes: Vec<Vec<f64>> = (0..count).map(by_section).collect();
        let moves = self.solver.tangents(&self.x, &changes).map_err(|e| self.error(e))?;
        let Some(moves) = moves else { return Ok(None) };
        let mut weights = vec![INSIDE_WEIGHT; self.x.len()];
        self.judge.faces.border.iter().for_each(|node| weights[*node] = 1.0);
        let moves = DMatrix::from_fn(2 * self.x.len(), count + 1, |row, column| {
            let weight = weights[row / 2].sqrt();
            let shifted = if row % 2 == 0 { 1.0 } else { 0.0 };
            weight * moves.get(column).map_or(shifted, |m| m[row / 2][row % 2])
        });
        Ok(Some(moves.tr_mul(&moves)))
    }

    /// Tries other section lengths (mm) and a shift to the right. Where the strip comes to rest at a cost of at most `limit`, the shape becomes that one.
    pub fn take(
        &mut self,
        lengths: &[f64],
        shift_mm: f64,
        limit: f64,
        observer: &mut dyn Observer,
    ) -> Result<bool, Error> {
        let mut ruffle = self.ruffle.clone();
        for (section, length) in lengths.iter().enumerate() {
            ruffle.set_section_length(section, *length);
        }
        let widths = widths(&self.spans);
        let mut start = match self.solver.predict(&self.x, &ruffle, &widths) {
            Err(sim::Error::Crossed { .. }) => return Ok(false),
            predicted => predicted.map_err(|e| self.error(e))?,
        };
        start.iter_mut().for_each(|p| p.x += shift_mm);
        if let Some(x) = self.rest(&start, WARM_STEPS, observer)? {
            let before = std::mem::replace(&mut self.x, x);
            let ruffle_before = std::mem::replace(&mut self.ruffle, ruffle);
            let slopes_before = self.slopes.clone();
            let cost_before = self.cost;
            self.look();
            if self.cost <= limit {
                return Ok(true);
            }
            (self.x, self.ruffle, self.slopes, self.cost) = (before, ruffle_before, slopes_before, cost_before);
        }
        self.solver.measure(&self.ruffle, &widths).map_err(|e| self.error(e))?;
        Ok(false)
    }
}

/// Passes a solve's progress on, and ends it after some steps.
struct Limited<'a> {
    observer: &'a mut dyn Observer,
    left: usize,
}

impl Observer for Limited<'_> {
    fn step(&mut self, progress: crate::progress::Progress) -> std::ops::ControlFlow<()> {
        if self.left == 0 {
            return std::ops::ControlFlow::Break(());
        }
        self.left -= 1;
        self.observer.step(progress)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{polygon, with_target};
    use super::*;
    use crate::progress::Quiet;
    use crate::ruffle::{StackSettings, draw_stack};

    #[test]
    fn slopes_over_lengths_are_the_change_of_cost_by_finite_differences() {
        let outline = polygon(&[(0.0, 0.0), (80.0, 3.0), (74.0, 66.0), (5.0, 60.0)]);
        let stack = StackSettings { layers: Some(3), segment_mm: 4.0, ..StackSettings::default() };
        let drawn = draw_stack(&outline, &stack).unwrap();
        let settings = Settings {
            solver: sim::Settings { residual_n: 1e-8, ..sim::Settings::default() },
            min_bend_radius_mm: 9.0,
            ..Settings::default()
        };
        with_target(&outline, |target| {
            let field = Rc::new(Field::new(&outline, 3.0));
            let settled = Shape::settled(target, &settings, &drawn, FootUsed::Pinned, &field, 0.0, &mut Quiet);
            let mut shape = settled.unwrap().expect("a strip at rest");
            shape.pull.cost = 0.5;
            shape.look();
            let (slopes, by_shift) = shape.slopes().unwrap().expect("a stable state");
            let lengths: Vec<f64> = (0..slopes.len()).map(|s| shape.ruffle.section_length(s)).collect();
            let mut cost = |section: Option<usize>, by: f64| {
                let mut to = lengths.clone();
                section.into_iter().for_each(|s| to[s] += by);
                let shift = if section.is_none() { by } else { 0.0 };
                assert!(shape.take(&to, shift, f64::INFINITY, &mut Quiet).unwrap());
                let cost = shape.cost;
                assert!(shape.take(&lengths, -shift, f64::INFINITY, &mut Quiet).unwrap());
                cost
            };
            let largest = slopes.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
            for (section, slope) in slopes.iter().enumerate() {
                let found = (cost(Some(section), 0.05) - cost(Some(section), -0.05)) / 0.1;
                assert!((found - slope).abs() < 0.02 * largest, "section {section}: {found} against {slope}");
            }
            let found = (cost(None, 0.05) - cost(None, -0.05)) / 0.1;
            assert!((found - by_shift).abs() < 0.03 * largest, "shift: {found} against {by_shift}");
        });
    }
}
