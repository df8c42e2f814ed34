//! Fills an outline with a ruffle: draws clean stacks, lets them settle, finds the section lengths that fill most, and keeps what fills best.

mod descent;
mod edits;
mod empty;
mod faces;
mod field;
mod forest;
mod gaps;
mod given;
mod loads;
mod merit;
mod paper;
mod report;
mod score;
mod search;
mod shape;
mod starts;
#[cfg(test)]
mod tests;
mod warnings;

pub use edits::Edits;
pub use forest::{Body, Forest, Lean, Meeting, forest};
pub use gaps::{Gap, Neck, largest_gap, neck};
pub use given::{own_outline, rest};
pub use loads::settle_together;
pub use report::{FootUsed, Report};
pub use shape::Spent;
pub use warnings::warnings;

use crate::cut::{Outline, PlaneFrame};
use crate::extrude::{Extruder, Span};
use crate::geom::{P2, V2};
use crate::progress::{Observer, Quiet};
use crate::ruffle::{Direction, EditError, Node, Ruffle, StackError, StackSettings};
use crate::sim::{self, Equilibrium, Material, Solver, Supports};

/// What to fill.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    /// Name of the part, for errors and warnings.
    pub name: &'a str,
    /// Where the plane lies.
    pub frame: &'a PlaneFrame,
    /// The region to fill, plane frame, mm.
    pub outline: &'a Outline,
    /// How wide the strip is where.
    pub extruder: &'a Extruder,
    /// The sheet, along the strip.
    pub material: &'a Material,
    /// Dead loads besides the strip's own weight, plane frame, N: parts that hang on this one. Nodes are those of the settled part or, while filling, of the drawing,
    /// after any edits: ask for a number of layers then, so that there is only one numbering.
    pub loads_n: &'a [(Node, V2)],
}

/// How the bottom rung stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Foot {
    /// Free if the stack stands by itself and fills as well, else pinned.
    #[default]
    Auto,
    /// Rests on the floor.
    Free,
    /// Both ends of the bottom rung are fixed to a base.
    Pinned,
}

/// How section lengths are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// By the slope of what is empty and what sticks out over every length, through the equilibrium.
    #[default]
    Adjoint,
    /// By the paper's rule (section 4.2): a yardstick.
    Paper,
}

/// How to fill.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// How stacks are drawn. Layering and direction are chosen by the search.
    pub stack: StackSettings,
    /// Which way layers lie on each other; chosen from the outline where it is not given.
    pub direction: Option<Direction>,
    /// How section lengths are found.
    pub method: Method,
    /// How the foot stands.
    pub foot: Foot,
    /// Changes of lengths tried per start, about. With none, drawings only come to rest.
    pub effort: usize,
    /// How much worse a protruding square millimetre is than an empty one.
    pub protrusion_weight: f64,
    /// How much worse filling may be when the foot stands free, as a share of the outline: glue is work.
    pub free_foot_bonus: f64,
    /// Accuracy of the solver. Its floor is set to the outline's lowest point.
    pub solver: sim::Settings,
    /// Tightest bend the material takes without creasing, mm.
    pub min_bend_radius_mm: f64,
    /// Smallest void a person can still reach into with tools, mm.
    pub min_void_mm: f64,
    /// Shortest section, mm: a flap at one end and a slit at the other.
    pub min_section_mm: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            stack: StackSettings::default(),
            direction: None,
            method: Method::Adjoint,
            foot: Foot::Auto,
            effort: 70,
            protrusion_weight: 3.0,
            free_foot_bonus: 0.03,
            solver: sim::Settings::default(),
            min_bend_radius_mm: 0.0,
            min_void_mm: 0.0,
            min_section_mm: 8.0,
        }
    }
}

/// One filled part; everything the rooms after this one need.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Name: "A".
    pub name: String,
    /// Where its plane lies in the mesh frame.
    pub frame: PlaneFrame,
    /// What was to be filled, plane frame, mm.
    pub outline: Outline,
    /// The strip.
    pub ruffle: Ruffle,
    /// The strip's extent along the plane's normal at every node.
    pub spans: Vec<Span>,
    /// Where the strip rests.
    pub equilibrium: Equilibrium,
    /// How well it fills and whether it can be made.
    pub report: Report,
    /// Forces on its nodes besides its own weight, plane frame, N: what the parts it bears weigh.
    pub loads_n: Vec<(Node, V2)>,
}

/// Why a part could not be filled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// No stack can be drawn.
    #[error("part {part}: {source}")]
    Stack {
        /// The part.
        part: String,
        /// Why.
        source: StackError,
    },
    /// An edit does not apply to any drawing.
    #[error("part {part}: {source}")]
    Edit {
        /// The part.
        part: String,
        /// Why.
        source: EditError,
    },
    /// The solver was given something impossible.
    #[error("part {part}: {source}")]
    Solve {
        /// The part.
        part: String,
        /// Why.
        source: sim::Error,
    },
    /// Nothing that was tried came to rest.
    #[error(
        "part {part}: no start settled ({tried} tried). Try another number of layers (layers = N in the design), a stiffer material, or foot = \"pinned\""
    )]
    Unsettled {
        /// The part.
        part: String,
        /// Starts tried.
        tried: usize,
    },
}

/// Fills `target` with a strip that has been edited as asked. Stopped early, it keeps the best so far. [`warnings`] says what the user should know about the result.
pub fn fit(
    target: &Target,
    settings: &Settings,
    edits: Option<&Edits>,
    observer: &mut dyn Observer,
) -> Result<Part, Error> {
    search::search(target, settings, edits, observer)
}

/// Solves a part again under the loads of `target`, with widths that belong to where it then lies, so that shape, widths and forces agree and whoever reads the part can work
/// the balance out again. Never stopped: it takes milliseconds.
pub fn settle(target: &Target, settings: &Settings, filled: Part) -> Result<Part, Error> {
    let Part { ruffle, spans, equilibrium, report, .. } = filled;
    let mut solver =
        solver(target, settings, &ruffle, &spans, report.foot).map_err(|source| target.solve_error(source))?;
    let (spans, equilibrium) = agreed(target, &mut solver, &ruffle, spans, &equilibrium.positions, &mut Quiet)?;
    Ok(part(target, ruffle, spans, equilibrium, report.origin()))
}

/// Widths that differ by less than this share on average are the same. At the silhouette of a round body the width has no limit: nodes there never agree all.
const SAME_WIDTH: f64 = 0.01;
/// Rounds of solving with the widths of the round before; from the second one on, half way between those and the new ones, because nodes at the silhouette go to and fro.
const WIDTH_ROUNDS: usize = 8;

/// Solves until the strip is as wide as the mesh is where it comes to rest. The widths given back are those it was solved with.
fn agreed(
    target: &Target,
    solver: &mut Solver,
    ruffle: &Ruffle,
    mut spans: Vec<Span>,
    start: &[P2],
    observer: &mut dyn Observer,
) -> Result<(Vec<Span>, Equilibrium), Error> {
    let error = |source| target.solve_error(source);
    let mut equilibrium = solver.solve(start, observer).map_err(error)?;
    for round in 1..WIDTH_ROUNDS {
        let next = target.extruder.spans(ruffle, &equilibrium.positions);
        if width_difference(&next, &spans) <= SAME_WIDTH {
            break;
        }
        let share = if round == 1 { 1.0 } else { 0.5 };
        spans = spans.iter().zip(&next).map(|(old, new)| old.toward(*new, share)).collect();
        solver.measure(ruffle, &widths(&spans)).map_err(error)?;
        equilibrium = solver.solve(&equilibrium.positions, observer).map_err(error)?;
    }
    Ok((spans, equilibrium))
}

/// Mean difference of widths over their mean.
fn width_difference(a: &[Span], b: &[Span]) -> f64 {
    let difference: f64 = a.iter().zip(b).map(|(a, b)| (a.width() - b.width()).abs()).sum();
    difference / b.iter().map(Span::width).sum::<f64>()
}

impl Target<'_> {
    fn solve_error(&self, source: sim::Error) -> Error {
        Error::Solve { part: self.name.into(), source }
    }
}

/// Measures a settled ruffle and makes a part of it.
fn part(target: &Target, ruffle: Ruffle, spans: Vec<Span>, equilibrium: Equilibrium, origin: report::Origin) -> Part {
    let report = report::measure(target, &ruffle, &spans, &equilibrium, origin);
    Part {
        name: target.name.into(),
        frame: *target.frame,
        outline: target.outline.clone(),
        ruffle,
        spans,
        equilibrium,
        report,
        loads_n: target.loads_n.to_vec(),
    }
}

fn solver(
    target: &Target,
    settings: &Settings,
    ruffle: &Ruffle,
    spans: &[Span],
    foot: FootUsed,
) -> Result<Solver, sim::Error> {
    let supports = match foot {
        FootUsed::Pinned | FootUsed::Tied => Supports { pinned: ruffle.foot.to_vec(), upright: Vec::new() },
        FootUsed::Free => Supports { pinned: Vec::new(), upright: vec![ruffle.foot[0]] },
    };
    let settings = sim::Settings { floor_mm: floor_mm(target.outline), ..settings.solver };
    let mut solver = Solver::new(ruffle, &widths(spans), target.material, &supports, &settings)?;
    solver.load(target.loads_n)?;
    Ok(solver)
}

/// Paper does not stretch: a strip that is strained more than this is held apart by something that should not hold it.
const MAX_STRAIN: f64 = 1e-3;

/// The floor under an outline, plane frame, mm: the object's floor v = 0 where the outline comes down to it but for the rounding of its underside, else (a part
/// that rests on another) the outline's lowest point.
fn floor_mm(outline: &Outline) -> f64 {
    let bounds = outline.bounds();
    let rounding = FOOT_ROUNDING * bounds.height();
    if (0.0..rounding).contains(&bounds.min.y) { 0.0 } else { bounds.min.y }
}

/// An outline stands on the floor if it comes down to it within this share of its height.
const FOOT_ROUNDING: f64 = 0.05;

fn widths(spans: &[Span]) -> Vec<f64> {
    spans.iter().map(Span::width).collect()
}
