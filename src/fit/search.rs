//! Tries starts, one after the other, and keeps what fills best.

use super::descent::{Limits, descend};
use super::empty::emptiest_layer;
use super::field::Field;
use super::paper::LengthRule;
use super::report::Origin;
use super::score::score;
use super::shape::{Shape, Spent};
use super::starts::{Start, starts};
use super::{Edits, Error, Foot, FootUsed, Method, Part, Settings, Target, agreed, part, solver};
use crate::progress::{Observer, Progress};
use crate::ruffle::{Drawn, EditSettings, Role, Ruffle, split_layer};
use crate::sim::Outcome;
use std::ops::ControlFlow;
use std::rc::Rc;

/// Springs hold the joints near their drawing while lengths are first found, and are then let go in stages: stiffness against D w / R³, the force it takes to move a
/// typical loop. Straight from the drawing a free stack drops sideways.
const HOLDS: [f64; 3] = [2.0, 0.2, 0.04];
/// What a strip that stands free is not tried pinned for: the outline's share that is empty or sticks out.
const WELL_FILLED: f64 = 0.08;
/// Layers are split at most so often.
const MOST_SPLITS: usize = 3;
/// A layer is split where either half would be at least this share of the thinnest layer drawn: the descent thickens it.
const SPLIT_THICKNESS: f64 = 0.85;
/// Splitting goes on while it wins this share of the outline.
const LEAST_GROWTH: f64 = 0.003;
/// A descent ends when a step wins less than this share of the outline; once one strip is chosen, it and what grows out of it go on for longer.
const LEAST_GAIN: f64 = 2e-4;
const LAST_GAIN: f64 = 5e-5;
/// And take so many times the steps.
const LAST_EFFORT: f64 = 2.0;
/// Springs on the way to none, with the lengths as they are: let go at once, a strip that would stand swings over.
const LETTING_GO: [f64; 3] = [0.01, 0.0025, 0.0];
/// Radius of a typical loop, as a share of the outline's size.
const LOOP_SHARE: f64 = 0.15;
/// What a joint's distance from its drawing costs while it is held, over all joints: 5 mm² a square millimetre.
const HOLD_COST: f64 = 5.0;
/// Share of the effort that goes into each stage that holds.
const HELD_SHARE: f64 = 0.12;
/// Held strips that are held less and less, and those of them that are let go, the most promising first.
const LOOSENED: usize = 5;
const RELEASED: usize = 3;
/// Effort that a round of the paper's rule takes: it works out a shape to the end, where a step of a descent does not.
const EFFORT_OF_ROUND: usize = 5;
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
    /// Whether one strip has been chosen, and only it is worked on.
    chosen: bool,
    spent: Spent,
    field: Rc<Field>,
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
    let most = |count: usize| count.min(starts.len());
    let total = ((starts.len() + most(LOOSENED) + most(RELEASED)) * feet.len()) as u64;
    let spent = Spent::default();
    let field = Rc::new(Field::new(target.outline, settings.protrusion_weight));
    let mut search =
        Search { field, target, settings, observer, best: None, done: 0, total, stopped: false, chosen: false, spent };
    for foot in feet {
        // Pinned strips fill a point or two more than free ones, which is not worth the glue where those fill well.
        if search.best.as_ref().is_none_or(|b| b.score > WELL_FILLED) {
            search.stand(&starts, *foot)?;
        }
    }
    search.chosen = true;
    search.polish()?;
    // Edits name sections by number, which a split layer would shift.
    if edits.is_none() {
        search.grow()?;
    }
    let Search { best, spent, .. } = search;
    let Some(Candidate { mut part, .. }) = best else {
        return Err(Error::Unsettled { part: target.name.into(), tried: starts.len() * feet.len() });
    };
    part.report.spent = spent;
    Ok(part)
}

impl<'a> Search<'a> {
    /// Lets every drawing come to rest on `foot` while it is held, and goes on with the most promising ones.
    fn stand(&mut self, starts: &[Start], foot: FootUsed) -> Result<(), Error> {
        let mut held: Vec<(Shape, &Start)> = Vec::new();
        for start in starts {
            if self.is_over() {
                return Ok(());
            }
            held.extend(self.held(start, foot)?.map(|shape| (shape, start)));
            self.done += 1;
            if self.stopped && !held.is_empty() {
                break;
            }
        }
        best_first(&mut held, LOOSENED);
        for (shape, start) in &mut held {
            self.loosen(shape, start)?;
            self.done += 1;
        }
        best_first(&mut held, LOOSENED);
        let mut released = 0;
        for (shape, start) in held {
            if self.is_over() || released >= RELEASED {
                return Ok(());
            }
            released += usize::from(self.release(shape, start)?);
            self.done += 1;
        }
        Ok(())
    }

    /// Splits the layer that leaves most empty, as long as that fills more.
    fn grow(&mut self) -> Result<(), Error> {
        let settings = self.settings;
        let fixed = settings.stack.layers.is_some() || settings.method == Method::Paper;
        for _ in 0..MOST_SPLITS {
            let Some(Candidate { part, score }) = &self.best else { return Ok(()) };
            if fixed || settings.effort == 0 || self.stopped {
                return Ok(());
            }
            let before = *score;
            let (foot, direction) = (part.report.foot, part.report.direction);
            let filled = Drawn { ruffle: part.ruffle.clone(), positions: part.equilibrium.positions.clone() };
            let segment_mm = filled.ruffle.strip_length() / filled.ruffle.rest_lengths.len() as f64;
            let edit = EditSettings { segment_mm, limits: Default::default() };
            let thickness_mm = SPLIT_THICKNESS * settings.stack.min_layer_mm;
            let split = emptiest_layer(part, thickness_mm).map(|layer| split_layer(&filled, layer, &edit));
            let Some(Ok(drawn)) = split else { return Ok(()) };
            let start = Start { drawn, direction };
            if let Some(mut shape) = self.held(&start, foot)? {
                self.loosen(&mut shape, &start)?;
                self.release(shape, &start)?;
            }
            if self.best.as_ref().is_none_or(|b| b.score > before - LEAST_GROWTH) {
                return Ok(());
            }
            self.polish()?;
        }
        Ok(())
    }

    /// Goes on where the best strip so far was left.
    fn polish(&mut self) -> Result<(), Error> {
        let (target, settings) = (self.target, self.settings);
        let Some(Candidate { part, .. }) = &self.best else { return Ok(()) };
        if self.stopped || settings.effort == 0 || settings.method == Method::Paper {
            return Ok(());
        }
        let (foot, direction) = (part.report.foot, part.report.direction);
        let drawn = Drawn { ruffle: part.ruffle.clone(), positions: part.equilibrium.positions.clone() };
        let start = Start { drawn, direction };
        let field = Rc::clone(&self.field);
        let Some(mut shape) = Shape::settled(target, settings, &start.drawn, foot, &field, 0.0, &mut Inner(self))?
        else {
            return Ok(());
        };
        self.descend(&mut shape, &start, 1.0, true)?;
        self.count(&mut shape);
        self.consider(&shape, &start)?;
        Ok(())
    }

    /// Whether there is no more to be done: the observer asked to stop, and something has settled.
    fn is_over(&self) -> bool {
        self.stopped && self.best.is_some()
    }

    /// Lets one drawing settle and finds its lengths while springs hold its joints firmly.
    fn held(&mut self, start: &Start, foot: FootUsed) -> Result<Option<Shape<'a>>, Error> {
        let (target, settings) = (self.target, self.settings);
        let hold_n_per_mm = self.hold_n_per_mm(start) * HOLDS[0];
        let field = Rc::clone(&self.field);
        let settled = Shape::settled(target, settings, &start.drawn, foot, &field, hold_n_per_mm, &mut Inner(self))?;
        let Some(mut shape) = settled else { return Ok(None) };
        shape.pull.cost = HOLD_COST / shape.pull.targets.len().max(1) as f64;
        shape.look();
        self.descend(&mut shape, start, HELD_SHARE, false)?;
        Ok(Some(shape))
    }

    /// Holds the joints less and less, finding lengths each time, until only what the shape itself is worth counts.
    fn loosen(&mut self, shape: &mut Shape<'a>, start: &Start) -> Result<(), Error> {
        for hold in &HOLDS[1..] {
            if self.stopped || !shape.hold(hold * self.hold_n_per_mm(start), &mut Inner(self))? {
                break;
            }
            self.descend(shape, start, HELD_SHARE, false)?;
        }
        shape.pull.cost = 0.0;
        shape.look();
        self.count(shape);
        Ok(())
    }

    /// The force that moves a typical loop of a start by its own size, over that, N/mm.
    fn hold_n_per_mm(&self, start: &Start) -> f64 {
        let target = self.target;
        let spans = target.extruder.spans(&start.drawn.ruffle, &start.drawn.positions);
        let mean_width_mm = spans.iter().map(|s| s.width()).sum::<f64>() / spans.len() as f64;
        let loop_mm = LOOP_SHARE * target.outline.area().sqrt();
        target.material.flexural_rigidity_n_mm * mean_width_mm / loop_mm.powi(3)
    }

    /// Lets go of a held strip and finds its lengths; false where it falls.
    fn release(&mut self, mut shape: Shape<'a>, start: &Start) -> Result<bool, Error> {
        for hold in LETTING_GO {
            if !shape.hold(hold * self.hold_n_per_mm(start), &mut Inner(self))? {
                return Ok(false);
            }
        }
        match self.settings.method {
            Method::Adjoint => self.descend(&mut shape, start, 1.0 - HELD_SHARE * HOLDS.len() as f64, true)?,
            Method::Paper => self.follow_paper(&mut shape, start)?,
        }
        self.count(&mut shape);
        self.consider(&shape, start)
    }

    /// Descends with a share of the effort.
    fn descend(&mut self, shape: &mut Shape<'a>, start: &Start, share: f64, shift: bool) -> Result<(), Error> {
        if self.settings.method == Method::Paper || self.stopped {
            return Ok(());
        }
        let (least_gain, times) = if self.chosen { (LAST_GAIN, LAST_EFFORT) } else { (LEAST_GAIN, 1.0) };
        let steps = (share * times * self.settings.effort as f64).round() as usize;
        let limits = Limits { bounds_mm: self.bounds_mm(&start.drawn.ruffle), shift, steps, least_gain };
        descend(shape, &limits, &mut Inner(self))
    }

    /// Adds what a shape has cost so far to the whole.
    fn count(&mut self, shape: &mut Shape) {
        let Spent { solves, steps } = std::mem::take(&mut shape.spent);
        self.spent.solves += solves;
        self.spent.steps += steps;
    }

    /// Shortest and longest length of every section.
    fn bounds_mm(&self, drawn: &Ruffle) -> Vec<[f64; 2]> {
        let bounds = |s: usize| {
            let length = drawn.section_length(s);
            if drawn.sections[s].pinned || drawn.sections[s].role == Role::Densified {
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
        for _ in 0..self.settings.effort.div_ceil(EFFORT_OF_ROUND) {
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

    /// Solves a shape to the end, and keeps it if it is the best so far; false where it does not come to rest.
    fn consider(&mut self, shape: &Shape, start: &Start) -> Result<bool, Error> {
        let (target, settings) = (self.target, self.settings);
        let mut solver = solver(target, settings, &shape.ruffle, &shape.spans, shape.foot)
            .map_err(|source| target.solve_error(source))?;
        let (spans, equilibrium) =
            agreed(target, &mut solver, &shape.ruffle, shape.spans.clone(), &shape.x, &mut Inner(self))?;
        if equilibrium.outcome != Outcome::Converged || equilibrium.max_strain > super::MAX_STRAIN {
            return Ok(false);
        }
        let origin = Origin { foot: shape.foot, direction: start.direction, spent: self.spent };
        let part = part(target, shape.ruffle.clone(), spans, equilibrium, origin);
        let score = score(&part, settings);
        if self.best.as_ref().is_none_or(|b| score < b.score) {
            self.best = Some(Candidate { part, score });
        }
        Ok(true)
    }

    fn report_progress(&mut self) -> ControlFlow<()> {
        let filled = |b: &Candidate| format!("{:.0} % filled", 100.0 * (1.0 - b.part.report.uncovered_fraction));
        let note = self.best.as_ref().map_or(String::new(), filled);
        self.observer.step(Progress { stage: "filling", done: self.done, total: self.total, note })
    }
}

/// Leaves the `count` cheapest shapes, the cheapest first.
fn best_first(shapes: &mut Vec<(Shape, &Start)>, count: usize) {
    shapes.sort_by(|(a, _), (b, _)| a.cost.total_cmp(&b.cost));
    shapes.truncate(count);
}

/// Passes a solve's progress on as the search's own. A stop ends the search once something has settled; before that, the solve goes on, since there would be
/// nothing to keep.
struct Inner<'s, 'a>(&'s mut Search<'a>);

impl Observer for Inner<'_, '_> {
    fn step(&mut self, progress: Progress) -> ControlFlow<()> {
        if progress.done == 0 && !self.0.stopped && self.0.report_progress().is_break() {
            self.0.stopped = true;
        }
        if self.0.stopped && self.0.best.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
