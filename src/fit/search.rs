//! Tries starts, one after the other, and keeps what fills best.

use super::descent::{Limits, descend};
use super::paper::LengthRule;
use super::report::Origin;
use super::shape::{Shape, Spent};
use super::starts::{Start, starts};
use super::{Edits, Error, Foot, FootUsed, Method, Part, Settings, Target, agreed, part, solver};
use crate::progress::{Observer, Progress};
use crate::ruffle::Ruffle;
use crate::sim::Outcome;
use std::ops::ControlFlow;

/// Springs hold the joints near their drawing while lengths are first found, and are then let go in stages: stiffness against D w / R³, the force it takes to move a
/// typical loop. Straight from the drawing a free stack drops sideways.
const HOLDS: [f64; 4] = [2.0, 0.2, 0.04, 0.0];
/// Radius of a typical loop, as a share of the outline's size.
const LOOP_SHARE: f64 = 0.15;
/// What a joint's distance from its drawing costs while it is held, over all joints: 5 mm² a square millimetre.
const HOLD_COST: f64 = 5.0;
/// Share of the effort that goes into each stage that holds.
const HELD_SHARE: f64 = 0.12;
/// Sections keep at least this share of the length they were drawn with, and at most so many times that and 10 mm: no layer collapses, none takes over.
const SHORTEST: f64 = 0.45;
const LONGEST: f64 = 2.2;
const LONGER_MM: f64 = 10.0;

/// A filled part and how good it is.
struct Candidate {
    part: Part,
    /// Lower is better.
    score: f64,
}

pub(super) struct Search<'a> {
    target: &'a Target<'a>,
    settings: &'a Settings,
    observer: &'a mut dyn Observer,
    best: Option<Candidate>,
    done: u64,
    total: u64,
    stopped: bool,
    spent: Spent,
}

/// Fills `target`.
pub(super) fn search(
    target: &Target,
    settings: &Settings,
    edits: Option<&Edits>,
    observer: &mut dyn Observer,
) -> Result<Part, Error> {
    let starts = starts(target, settings, edits)?;
    let feet: &[FootUsed] = match settings.foot {
        Foot::Auto => &[FootUsed::Free, FootUsed::Pinned],
        Foot::Free => &[FootUsed::Free],
        Foot::Pinned => &[FootUsed::Pinned],
    };
    let total = (starts.len() * feet.len()) as u64;
    let spent = Spent::default();
    let mut search = Search { target, settings, observer, best: None, done: 0, total, stopped: false, spent };
    for foot in feet {
        for start in &starts {
            if !(search.stopped && search.best.is_some()) {
                search.run(start, *foot)?;
            }
            search.done += 1;
        }
    }
    let Search { best, spent, .. } = search;
    let Some(Candidate { mut part, .. }) = best else {
        return Err(Error::Unsettled { part: target.name.into(), tried: starts.len() * feet.len() });
    };
    part.report.spent = spent;
    Ok(part)
}

impl Search<'_> {
    /// Lets one drawing settle and finds its lengths.
    fn run(&mut self, start: &Start, foot: FootUsed) -> Result<(), Error> {
        let (target, settings) = (self.target, self.settings);
        let size_mm = target.outline.area().sqrt();
        let stiff =
            |shape_width: f64| target.material.flexural_rigidity_n_mm * shape_width / (LOOP_SHARE * size_mm).powi(3);
        let spans = target.extruder.spans(&start.drawn.ruffle, &start.drawn.positions);
        let mean_width = spans.iter().map(|s| s.width()).sum::<f64>() / spans.len() as f64;
        let unit = stiff(mean_width);
        let holds = HOLDS.map(|h| h * unit);
        let settled = Shape::settled(target, settings, &start.drawn, foot, holds[0], &mut Inner(self))?;
        let Some(mut shape) = settled else { return Ok(()) };
        let joints = shape.pull.targets.len().max(1) as f64;
        let bounds_mm = self.bounds_mm(&start.drawn.ruffle);
        let held_steps = (HELD_SHARE * settings.effort as f64).round() as usize;
        let mut good = true;
        for (i, hold) in holds.iter().enumerate() {
            if i > 0 && !shape.hold(*hold, &mut Inner(self))? {
                good = false;
                break;
            }
            let last = *hold == 0.0;
            shape.pull.cost = if last { 0.0 } else { HOLD_COST / joints };
            shape.look();
            let steps = if last { settings.effort.saturating_sub(held_steps * (holds.len() - 1)) } else { held_steps };
            if settings.method == Method::Adjoint && !self.stopped {
                let limits = Limits { bounds_mm: bounds_mm.clone(), shift: last, steps };
                descend(&mut shape, &limits, &mut Inner(self))?;
            }
        }
        self.spent.solves += shape.spent.solves;
        self.spent.steps += shape.spent.steps;
        if std::env::var("FITLOG").is_ok() {
            let f = shape.judge.filling(&shape.x);
            let a = shape.judge.area_mm2();
            eprintln!(
                "  {:?} n{} good {good} unc {:.1} prot {:.2} solves {} steps {} nodes {}",
                foot,
                start.drawn.ruffle.sections.len() / 4,
                100.0 * (1.0 - f.covered_mm2 / a),
                100.0 * (f.enclosed_mm2 - f.covered_mm2) / a,
                shape.spent.solves,
                shape.spent.steps,
                shape.x.len()
            );
        }
        if !good {
            return Ok(());
        }
        if settings.method == Method::Paper {
            self.follow_paper(&mut shape, start)?;
        }
        self.consider(&shape, start)
    }

    /// Shortest and longest length of every section.
    fn bounds_mm(&self, drawn: &Ruffle) -> Vec<[f64; 2]> {
        let bounds = |s: usize| {
            let length = drawn.section_length(s);
            if drawn.sections[s].pinned || drawn.sections[s].role == crate::ruffle::Role::Densified {
                return [length; 2];
            }
            let least = self.settings.min_section_mm;
            [least.max(SHORTEST * length), (LONGEST * length + LONGER_MM).max(least)]
        };
        (0..drawn.sections.len()).map(bounds).collect()
    }

    /// Rounds of the paper's length updates; every shape on the way is a candidate.
    fn follow_paper(&mut self, shape: &mut Shape, start: &Start) -> Result<(), Error> {
        let rule = LengthRule::new(&start.drawn, self.target.outline);
        for _ in 0..self.settings.effort {
            self.consider(shape, start)?;
            let mut lengths = rule.lengths(&shape.ruffle, &shape.x);
            for (section, length) in lengths.iter_mut().enumerate() {
                if shape.ruffle.sections[section].pinned {
                    *length = shape.ruffle.section_length(section);
                }
            }
            if self.stopped || !shape.take(&lengths, 0.0, f64::INFINITY, &mut Inner(self))? {
                break;
            }
        }
        Ok(())
    }

    /// Solves a shape to the end, and keeps it if it is the best so far.
    fn consider(&mut self, shape: &Shape, start: &Start) -> Result<(), Error> {
        let (target, settings) = (self.target, self.settings);
        let mut solver = solver(target, settings, &shape.ruffle, &shape.spans, shape.foot)
            .map_err(|source| target.solve_error(source))?;
        let (spans, equilibrium) =
            agreed(target, &mut solver, &shape.ruffle, shape.spans.clone(), &shape.x, &mut Inner(self))?;
        if equilibrium.outcome != Outcome::Converged || equilibrium.max_strain > super::MAX_STRAIN {
            return Ok(());
        }
        let origin = Origin { foot: shape.foot, direction: start.direction, spent: self.spent };
        let part = part(target, shape.ruffle.clone(), spans, equilibrium, origin);
        let score = score(&part, settings);
        if std::env::var("FITLOG").is_ok() {
            eprintln!(
                "     score {:.3} unc {:.1} prot {:.2} thin {:.1} void {:.1} radius {:.1} stands {}",
                score,
                100.0 * part.report.uncovered_fraction,
                100.0 * part.report.protruding_fraction,
                part.report.thinnest_layer_mm,
                part.report.min_void_mm,
                part.report.min_radius_mm,
                part.report.stands
            );
        }
        if self.best.as_ref().is_none_or(|b| score < b.score) {
            self.best = Some(Candidate { part, score });
        }
        Ok(())
    }

    fn report_progress(&mut self) -> ControlFlow<()> {
        let filled = |b: &Candidate| format!("{:.0} % filled", 100.0 * (1.0 - b.part.report.uncovered_fraction));
        let note = self.best.as_ref().map_or(String::new(), filled);
        self.observer.step(Progress { stage: "filling", done: self.done, total: self.total, note })
    }
}

/// How far a part is from full and easy to make, as a share of the outline.
fn score(part: &Part, settings: &Settings) -> f64 {
    let report = &part.report;
    let glue = if report.foot == FootUsed::Pinned { settings.free_foot_bonus } else { 0.0 };
    let shortfall = |value: f64, least: f64| if value < least { 1.0 - value / least } else { 0.0 };
    report.uncovered_fraction
        + settings.protrusion_weight * report.protruding_fraction
        + glue
        // Coverage does not see what is inside: a ruffle that passes through itself will fold otherwise, a layer that has collapsed cannot be assembled,
        // a crease is a hinge.
        + if report.stands { 0.0 } else { TIPPING_COST }
        + CROSSING_COST * part.equilibrium.self_intersections as f64
        + COLLAPSED_COST * shortfall(report.thinnest_layer_mm, THINNEST_LAYER_MM)
        + MAKEABLE_COST * shortfall(report.min_void_mm, settings.min_void_mm)
        + MAKEABLE_COST * shortfall(report.min_radius_mm, settings.min_bend_radius_mm)
}

/// Outline share that falling over outweighs: whatever stands is better.
const TIPPING_COST: f64 = 1.0;
/// Outline share that one crossing outweighs.
const CROSSING_COST: f64 = 0.1;
/// A layer thinner than this, mm, has collapsed.
const THINNEST_LAYER_MM: f64 = 8.0;
/// Outline share that a layer of no thickness outweighs.
const COLLAPSED_COST: f64 = 1.0;
/// Outline share that a void or a bend radius of nothing outweighs.
const MAKEABLE_COST: f64 = 0.15;

/// Passes a solve's progress on as the search's own. A stop ends the search once something has settled; before that, the solve goes on, since there would be
/// nothing to keep.
struct Inner<'s, 'a>(&'s mut Search<'a>);

impl Observer for Inner<'_, '_> {
    fn step(&mut self, progress: Progress) -> ControlFlow<()> {
        if progress.done == 0 && self.0.report_progress().is_break() {
            self.0.stopped = true;
        }
        if self.0.stopped && self.0.best.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
