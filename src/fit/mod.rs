//! Fills an outline with a ruffle: draws clean stacks, lets them settle, adjusts section lengths, and keeps what fills best.

mod edits;
mod forest;
mod gaps;
mod loads;
mod report;
mod rule;

pub use edits::Edits;
pub use forest::{Body, Forest, Lean, Meeting, forest};
pub use gaps::{Gap, Neck, largest_gap, neck};
pub use loads::settle_together;
pub use report::{FootUsed, Report, warnings};

use crate::cut::{Outline, PlaneFrame};
use crate::extrude::{Extruder, Span};
use crate::geom::V2;
use crate::progress::{Observer, Progress, Quiet};
use crate::ruffle::{Drawn, EditError, Layering, Node, Ruffle, StackError, StackSettings, draw_stack};
use crate::sim::{self, Equilibrium, Material, Outcome, Solver, Supports};
use std::ops::ControlFlow;

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

/// How to fill.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// How stacks are drawn; its layering is the first that is tried.
    pub stack: StackSettings,
    /// Further layerings to try. Each costs a few dozen milliseconds; outlines differ in which they like.
    pub other_layerings: Vec<Layering>,
    /// How the foot stands.
    pub foot: Foot,
    /// Rounds of length updates per start.
    pub rounds: usize,
    /// eta of the paper's outer rule. The paper asks for less than 2; above 0.5 stacks of more than two layers oscillate.
    pub outer_gain: f64,
    /// Sections keep at least this share of the length they were drawn with, so that no layer collapses.
    pub min_length_ratio: f64,
    /// And at most this many times.
    pub max_length_ratio: f64,
    /// How much worse a protruding square millimetre is than an empty one.
    pub protrusion_weight: f64,
    /// How much worse filling may be when the foot stands free: glue is work.
    pub free_foot_bonus: f64,
    /// Accuracy of the solver. Its floor is set to the outline's lowest point.
    pub solver: sim::Settings,
    /// Tightest bend the material takes without creasing, mm.
    pub min_bend_radius_mm: f64,
    /// Smallest void a person can still reach into with tools, mm.
    pub min_void_mm: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            stack: StackSettings::default(),
            other_layerings: vec![
                Layering::Chords { aspect: 0.28 },
                Layering::Chords { aspect: 0.45 },
                Layering::Packed { min_aspect: 0.16 },
                Layering::Packed { min_aspect: 0.25 },
            ],
            foot: Foot::Auto,
            rounds: 8,
            outer_gain: 0.4,
            min_length_ratio: 0.6,
            max_length_ratio: 1.6,
            protrusion_weight: 3.0,
            free_foot_bonus: 0.03,
            solver: sim::Settings::default(),
            min_bend_radius_mm: 0.0,
            min_void_mm: 0.0,
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
        "part {part}: no start settled ({tried} tried; the best was still unbalanced by {residual_n:.1e} N). Try another number of layers (layers = N in the design), a stiffer material, or foot = \"pinned\""
    )]
    Unsettled {
        /// The part.
        part: String,
        /// Starts tried.
        tried: usize,
        /// Unbalanced force of the best, N.
        residual_n: f64,
    },
}

/// Fills `target` with a strip that has been edited as asked. Stopped early, it keeps the best so far. [`warnings`] says what the user should know about the result.
pub fn fit(
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
    let total = (starts.len() * feet.len() * (settings.rounds + 1)) as u64;
    let mut search = Search {
        target,
        settings,
        edits,
        observer,
        best: None,
        done: 0,
        total,
        stopped: false,
        residual_n: f64::INFINITY,
    };
    for foot in feet {
        for start in &starts {
            search.run(start, *foot)?;
        }
    }
    let Search { best, residual_n, .. } = search;
    let Some(best) = best else {
        return Err(Error::Unsettled { part: target.name.into(), tried: starts.len() * feet.len(), residual_n });
    };
    Ok(best.part)
}

/// Solves a part once more with the widths it was given. Filling weighs and bends a strip with the widths of the round before; after this, shape, widths and forces
/// belong together: whoever reads the part can work the balance out again. Never stopped: it takes milliseconds.
pub fn settle(target: &Target, settings: &Settings, filled: Part) -> Result<Part, Error> {
    let foot = filled.report.foot;
    let error = |source| Error::Solve { part: target.name.into(), source };
    let mut solver = solver(target, settings, &filled.ruffle, &filled.spans, foot).map_err(error)?;
    let equilibrium = solver.solve(&filled.equilibrium.positions, &mut Quiet).map_err(error)?;
    Ok(part(target, filled.ruffle, filled.spans, equilibrium, foot))
}

/// Measures a settled ruffle and makes a part of it.
fn part(target: &Target, ruffle: Ruffle, spans: Vec<Span>, equilibrium: Equilibrium, foot: FootUsed) -> Part {
    let report = report::measure(target, &ruffle, &spans, &equilibrium, foot);
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
        FootUsed::Pinned => Supports { pinned: ruffle.foot.to_vec(), upright: Vec::new() },
        FootUsed::Free => Supports { pinned: Vec::new(), upright: vec![ruffle.foot[0]] },
    };
    let settings = sim::Settings { floor_mm: floor_mm(target.outline), ..settings.solver };
    let mut solver = Solver::new(ruffle, &widths(spans), target.material, &supports, &settings)?;
    solver.load(target.loads_n)?;
    Ok(solver)
}

/// Drawings to start from. A layering that finds no place, or that the edits do not apply to, is passed over as long as another does.
fn starts(target: &Target, settings: &Settings, edits: Option<&Edits>) -> Result<Vec<Drawn>, Error> {
    let mut starts: Vec<Drawn> = Vec::new();
    let mut refused: Option<Error> = None;
    let mut layers = settings.stack.layers;
    for layering in std::iter::once(settings.stack.layering).chain(settings.other_layerings.iter().copied()) {
        match start(target, &StackSettings { layering, layers, ..settings.stack }, edits) {
            Ok((drawn, drawn_layers)) => {
                layers = layers.or(edits.map(|_| drawn_layers));
                if !starts.contains(&drawn) {
                    starts.push(drawn);
                }
            }
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    match refused {
        Some(error) if starts.is_empty() => Err(error),
        _ => Ok(starts),
    }
}

/// One drawing with its edits, on the floor, and its number of layers before them.
fn start(target: &Target, settings: &StackSettings, edits: Option<&Edits>) -> Result<(Drawn, usize), Error> {
    // Large shapes are folded in larger segments: as many as a shape of the usual size has.
    let segment_mm = settings.segment_mm * (target.outline.bounds().height() / FULL_DETAIL_MM).max(1.0);
    let drawn = draw_stack(target.outline, &StackSettings { segment_mm, ..*settings })
        .map_err(|source| Error::Stack { part: target.name.into(), source })?;
    let layers = drawn.ruffle.sections.len() / 4;
    let mut drawn = match edits {
        Some(edits) => edits.edited(&drawn).map_err(|source| Error::Edit { part: target.name.into(), source })?,
        None => drawn,
    };
    let drop = target.outline.bounds().min.y - floor_mm(target.outline);
    drawn.positions.iter_mut().for_each(|p| p.y -= drop);
    Ok((drawn, layers))
}

/// Outlines up to this high, mm, are folded in segments of the length asked for.
const FULL_DETAIL_MM: f64 = 300.0;

/// A filled part and how good it is.
struct Candidate {
    part: Part,
    /// Lower is better.
    score: f64,
}

struct Search<'a> {
    target: &'a Target<'a>,
    settings: &'a Settings,
    edits: Option<&'a Edits<'a>>,
    observer: &'a mut dyn Observer,
    best: Option<Candidate>,
    done: u64,
    total: u64,
    stopped: bool,
    /// Least unbalanced force of anything that did not settle, N.
    residual_n: f64,
}

impl Search<'_> {
    /// Lets one drawing settle and improves it round by round.
    fn run(&mut self, start: &Drawn, foot: FootUsed) -> Result<(), Error> {
        let (target, settings) = (self.target, self.settings);
        let error = |source| Error::Solve { part: target.name.into(), source };
        let rule = rule::LengthRule::new(start, target.outline, settings);
        let mut ruffle = start.ruffle.clone();
        let mut positions = start.positions.clone();
        let mut spans = target.extruder.spans(&ruffle, &positions);
        let mut solver = solver(target, settings, &ruffle, &spans, foot).map_err(error)?;
        for _ in 0..=settings.rounds {
            self.done += 1;
            if self.stopped && self.best.is_some() {
                return Ok(());
            }
            solver.measure(&ruffle, &widths(&spans)).map_err(error)?;
            let equilibrium = match solver.solve(&positions, &mut Inner(self)) {
                // A drawing that crosses itself is no start; another may be.
                Err(sim::Error::Crossed { .. }) => return Ok(()),
                solved => solved.map_err(error)?,
            };
            if equilibrium.outcome != Outcome::Converged || equilibrium.max_strain > MAX_STRAIN {
                self.residual_n = self.residual_n.min(equilibrium.residual_n);
                return Ok(());
            }
            positions.clone_from(&equilibrium.positions);
            // The next round bends and weighs the strip as wide as the mesh is where it lies now.
            spans = target.extruder.spans(&ruffle, &positions);
            self.consider(&ruffle, &spans, equilibrium, foot);
            for (section, length) in rule.lengths(&ruffle, &positions).into_iter().enumerate() {
                let held = foot == FootUsed::Pinned && between_pins(&ruffle, section);
                if !held && !self.edits.is_some_and(|e| e.pins(section)) {
                    ruffle.set_section_length(section, length);
                }
            }
        }
        Ok(())
    }

    fn consider(&mut self, ruffle: &Ruffle, spans: &[Span], equilibrium: Equilibrium, foot: FootUsed) {
        let part = part(self.target, ruffle.clone(), spans.to_vec(), equilibrium, foot);
        let score = self.score(&part);
        if self.best.as_ref().is_none_or(|b| score < b.score) {
            self.best = Some(Candidate { part, score });
        }
    }

    /// How far a part is from full and easy to make, as a share of the outline.
    fn score(&self, part: &Part) -> f64 {
        let (report, settings) = (&part.report, self.settings);
        let glue = if report.foot == FootUsed::Pinned { settings.free_foot_bonus } else { 0.0 };
        let shortfall = |value: f64, least: f64| if value < least { 1.0 - value / least } else { 0.0 };
        report.uncovered_fraction
            + settings.protrusion_weight * report.protruding_fraction
            + glue
            // Coverage does not see what is inside: a ruffle that passes through itself will fold otherwise, a layer that has collapsed cannot be assembled,
            // a crease is a hinge.
            + if report.stands { 0.0 } else { TIPPING_COST }
            + CROSSING_COST * part.equilibrium.self_intersections as f64
            + MAKEABLE_COST * shortfall(report.min_void_mm, settings.min_void_mm)
            + MAKEABLE_COST * shortfall(report.min_radius_mm, settings.min_bend_radius_mm)
    }

    fn report_progress(&mut self) -> ControlFlow<()> {
        let filled = |b: &Candidate| format!("{:.0} % filled", 100.0 * (1.0 - b.part.report.uncovered_fraction));
        let note = self.best.as_ref().map_or(String::new(), filled);
        self.observer.step(Progress { stage: "filling", done: self.done, total: self.total, note })
    }
}

/// True for a section whose two ends are pinned: its length cannot change.
fn between_pins(ruffle: &Ruffle, section: usize) -> bool {
    let (start, end) = ruffle.section_ends(section);
    ruffle.foot.contains(&start) && ruffle.foot.contains(&end)
}

/// Paper does not stretch: a strip that is strained more than this is held apart by something that should not hold it.
const MAX_STRAIN: f64 = 1e-3;

/// Outline share that falling over outweighs: whatever stands is better.
const TIPPING_COST: f64 = 1.0;
/// Outline share that one crossing outweighs.
const CROSSING_COST: f64 = 0.1;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{P2, P3, V3};
    use crate::progress::Warning;
    use crate::ruffle::{EditSettings, Limits, densify};

    fn frame() -> PlaneFrame {
        PlaneFrame { origin: P3::origin(), u: V3::x(), v: V3::y(), normal: V3::z() }
    }

    fn paper() -> Material {
        Material {
            flexural_rigidity_n_mm: 2.1,
            membrane_stiffness_n_per_mm: 600.0,
            grammage_g_per_m2: 160.0,
            thickness_mm: 0.19,
        }
    }

    fn polygon(points: &[(f64, f64)]) -> Outline {
        Outline { outer: points.iter().map(|(x, y)| P2::new(*x, *y)).collect(), holes: Vec::new() }
    }

    fn filled(
        outline: &Outline,
        settings: &Settings,
        observer: &mut dyn Observer,
    ) -> Result<(Part, Vec<Warning>), Error> {
        let extruder = Extruder::constant(-20.0, 20.0).unwrap();
        let target =
            Target { name: "A", frame: &frame(), outline, extruder: &extruder, material: &paper(), loads_n: &[] };
        let part = settle(&target, settings, fit(&target, settings, None, observer)?)?;
        let warnings = warnings(&part, settings);
        Ok((part, warnings))
    }

    #[test]
    fn a_square_is_filled_without_crossings_and_settles() {
        let square = polygon(&[(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)]);
        let (part, _) = filled(&square, &Settings::default(), &mut Quiet).unwrap();
        part.ruffle.check().unwrap();
        assert_eq!(part.equilibrium.outcome, Outcome::Converged);
        assert_eq!(part.equilibrium.self_intersections, 0);
        assert!(part.report.uncovered_fraction < 0.12, "{:?}", part.report);
        assert!(part.report.protruding_fraction < 0.02, "{:?}", part.report);
        let mass = part.report.strip_length_mm * 40.0 * 160e-6;
        assert!((part.report.strip_mass_g - mass).abs() < 1e-9);
    }

    #[test]
    fn a_tall_shape_is_pinned_and_says_so() {
        let tall = polygon(&[(0.0, 0.0), (40.0, 0.0), (40.0, 160.0), (0.0, 160.0)]);
        let (part, warnings) = filled(&tall, &Settings::default(), &mut Quiet).unwrap();
        assert_eq!(part.report.foot, FootUsed::Pinned);
        assert!(warnings.iter().any(|w| w.code == "foot-pinned"), "{warnings:?}");
        let foot = part.ruffle.foot.map(|n| part.equilibrium.positions[n.index()].y);
        assert_eq!(foot, [0.0, 0.0]);
    }

    #[test]
    fn tight_bends_and_thin_voids_are_named() {
        let square = polygon(&[(0.0, 0.0), (60.0, 0.0), (60.0, 60.0), (0.0, 60.0)]);
        let settings = Settings { min_bend_radius_mm: 50.0, min_void_mm: 50.0, ..Settings::default() };
        let (part, warnings) = filled(&square, &settings, &mut Quiet).unwrap();
        let codes: Vec<&str> = warnings.iter().map(|w| w.code).collect();
        assert!(codes.contains(&"bend-tight") && codes.contains(&"void-small"), "{codes:?}");
        assert!(part.report.min_radius_mm < 50.0 && part.report.min_void_mm < 50.0);
    }

    #[test]
    fn edits_shape_every_start_and_pinned_lengths_stay() {
        let square = polygon(&[(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)]);
        let (extruder, frame, material) = (Extruder::constant(-20.0, 20.0).unwrap(), frame(), paper());
        let target = Target {
            name: "A",
            frame: &frame,
            outline: &square,
            extruder: &extruder,
            material: &material,
            loads_n: &[],
        };
        let edit_settings = EditSettings { segment_mm: 3.0, limits: Limits::default() };
        let dense = |drawn: &Drawn| densify(drawn, 1, &edit_settings);
        let edits = Edits { apply: &dense, lengths_mm: &[(0, 66.0)] };
        let part = fit(&target, &Settings::default(), Some(&edits), &mut Quiet).unwrap();
        assert_eq!(part.ruffle.densified.made.len(), 1);
        assert!((part.ruffle.section_length(0) - 66.0).abs() < 1e-9);
        let gone = Edits { apply: &|drawn| densify(drawn, 99, &edit_settings), lengths_mm: &[] };
        let error = fit(&target, &Settings::default(), Some(&gone), &mut Quiet).unwrap_err();
        assert!(error.to_string().starts_with("part A: there is no section 99"), "{error}");
    }

    #[test]
    fn a_load_on_a_node_is_borne_by_the_settled_part() {
        let square = polygon(&[(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)]);
        let (extruder, frame, material) = (Extruder::constant(-20.0, 20.0).unwrap(), frame(), paper());
        let plain = Target {
            name: "A",
            frame: &frame,
            outline: &square,
            extruder: &extruder,
            material: &material,
            loads_n: &[],
        };
        let settings = Settings { rounds: 0, foot: Foot::Pinned, ..Settings::default() };
        let part = fit(&plain, &settings, None, &mut Quiet).unwrap();
        let highest = |part: &Part| part.equilibrium.positions.iter().map(|p| p.y).fold(0.0, f64::max);
        let before = highest(&part);
        let top = *part.ruffle.walk.last().unwrap();
        let loaded = Target { loads_n: &[(top, V2::new(0.0, -0.1))], ..plain };
        let part = settle(&loaded, &settings, part).unwrap();
        assert_eq!(part.equilibrium.outcome, Outcome::Converged);
        assert!(highest(&part) < before - 0.3, "{} against {before} mm", highest(&part));
    }

    #[test]
    fn stopping_at_once_still_gives_a_settled_part() {
        struct Stop(u32);
        impl Observer for Stop {
            fn step(&mut self, _: Progress) -> ControlFlow<()> {
                self.0 += 1;
                ControlFlow::Break(())
            }
        }
        let square = polygon(&[(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)]);
        let mut stop = Stop(0);
        let (part, _) = filled(&square, &Settings::default(), &mut stop).unwrap();
        assert_eq!(part.equilibrium.outcome, Outcome::Converged);
        assert!(stop.0 < 4, "asked {} times", stop.0);
    }

    #[test]
    fn an_outline_too_small_is_refused_by_part() {
        let tiny = polygon(&[(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)]);
        let error = filled(&tiny, &Settings::default(), &mut Quiet).unwrap_err();
        assert!(error.to_string().starts_with("part A: the outline, 8.0 x 8.0 mm"), "{error}");
    }
}
