//! Outlines filled from end to end.

use super::*;
use crate::geom::{P3, V3};
use crate::progress::{Progress, Warning};
use crate::ruffle::{Drawn, EditSettings, Limits, densify, set_length};
use crate::sim::Outcome;
use std::ops::ControlFlow;

pub(super) fn frame() -> PlaneFrame {
    PlaneFrame { origin: P3::origin(), u: V3::x(), v: V3::y(), normal: V3::z() }
}

pub(super) fn paper() -> Material {
    Material {
        flexural_rigidity_n_mm: 2.1,
        membrane_stiffness_n_per_mm: 600.0,
        grammage_g_per_m2: 160.0,
        thickness_mm: 0.19,
    }
}

pub(super) fn polygon(points: &[(f64, f64)]) -> Outline {
    Outline { outer: points.iter().map(|(x, y)| P2::new(*x, *y)).collect(), holes: Vec::new() }
}

fn rectangle(width: f64, height: f64) -> Outline {
    polygon(&[(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)])
}

/// Little work, on coarse segments.
fn quick(foot: Foot) -> Settings {
    let stack = StackSettings { segment_mm: 5.0, ..StackSettings::default() };
    Settings { stack, foot, effort: 10, ..Settings::default() }
}

/// `outline`, 40 mm thick.
pub(super) fn with_target<T>(outline: &Outline, work: impl FnOnce(&Target) -> T) -> T {
    let extruder = Extruder::constant(-20.0, 20.0).unwrap();
    let (frame, material) = (frame(), paper());
    work(&Target { name: "A", frame: &frame, outline, extruder: &extruder, material: &material, loads_n: &[] })
}

fn filled(outline: &Outline, settings: &Settings, observer: &mut dyn Observer) -> Result<(Part, Vec<Warning>), Error> {
    with_target(outline, |target| {
        let part = settle(target, settings, fit(target, settings, None, observer)?)?;
        let warnings = warnings(&part, settings);
        Ok((part, warnings))
    })
}

#[test]
fn a_square_is_filled_without_crossings_and_stands_free() {
    let settings = Settings { effort: 40, ..quick(Foot::Free) };
    let (part, _) = filled(&rectangle(100.0, 100.0), &settings, &mut Quiet).unwrap();
    part.ruffle.check().unwrap();
    assert_eq!(part.equilibrium.outcome, Outcome::Converged);
    assert_eq!(part.equilibrium.self_intersections, 0);
    let report = &part.report;
    assert!(report.stands && report.foot == FootUsed::Free && report.direction == Direction::Vertical);
    assert!(report.uncovered_fraction + report.protruding_fraction < 0.08, "{report:?}");
    assert!(report.thinnest_layer_mm > 8.0, "{report:?}");
    let mass = report.strip_length_mm * 40.0 * 160e-6;
    assert!((report.strip_mass_g - mass).abs() < 1e-9);
}

#[test]
fn lengths_found_through_the_equilibrium_fill_more_than_the_papers_rule() {
    let circle: Vec<(f64, f64)> = (0..40)
        .map(|i| std::f64::consts::TAU * f64::from(i) / 40.0)
        .map(|a| (45.0 + 45.0 * a.cos(), 45.0 + 45.0 * a.sin()))
        .collect();
    let sum = |method| {
        let settings = Settings { method, ..quick(Foot::Pinned) };
        let report = filled(&polygon(&circle), &settings, &mut Quiet).unwrap().0.report;
        report.uncovered_fraction + report.protruding_fraction
    };
    let (adjoint, paper) = (sum(Method::Adjoint), sum(Method::Paper));
    assert!(adjoint < 0.12 && adjoint < paper - 0.03, "{adjoint} against {paper}");
}

#[test]
fn a_tall_shape_is_pinned_and_says_so() {
    let (part, warnings) = filled(&rectangle(40.0, 160.0), &quick(Foot::Auto), &mut Quiet).unwrap();
    assert_eq!(part.report.foot, FootUsed::Pinned);
    assert!(warnings.iter().any(|w| w.code == "foot-pinned"), "{warnings:?}");
    let foot = part.ruffle.foot.map(|n| part.equilibrium.positions[n.index()].y);
    assert_eq!(foot, [0.0, 0.0]);
}

#[test]
fn a_wide_shape_is_stacked_sideways_unless_told_otherwise() {
    let settings = Settings { effort: 0, ..quick(Foot::Free) };
    let wide = rectangle(140.0, 50.0);
    let (part, _) = filled(&wide, &settings, &mut Quiet).unwrap();
    assert_eq!((part.report.direction, part.report.stands), (Direction::Horizontal, true));
    let settings = Settings { direction: Some(Direction::Vertical), ..settings };
    assert_eq!(filled(&wide, &settings, &mut Quiet).unwrap().0.report.direction, Direction::Vertical);
}

#[test]
fn tight_bends_and_thin_voids_are_named() {
    let settings = Settings { min_bend_radius_mm: 50.0, min_void_mm: 50.0, effort: 0, ..quick(Foot::Pinned) };
    let (part, warnings) = filled(&rectangle(60.0, 60.0), &settings, &mut Quiet).unwrap();
    assert!(part.report.min_radius_mm < 50.0 && part.report.min_void_mm < 50.0);
    let codes: Vec<&str> = warnings.iter().map(|w| w.code).collect();
    assert!(codes.contains(&"bend-tight") && codes.contains(&"void-small"), "{codes:?}");
}

#[test]
fn edits_shape_every_start_and_pinned_lengths_stay() {
    let edit_settings = EditSettings { segment_mm: 5.0, limits: Limits::default() };
    let dense = |drawn: &Drawn| set_length(&densify(drawn, &[1], 1, &edit_settings)?, 0, 66.0, &edit_settings);
    let edits = Edits { apply: &dense };
    let gone = Edits { apply: &|drawn| densify(drawn, &[99], 1, &edit_settings) };
    with_target(&rectangle(100.0, 100.0), |target| {
        let part = fit(target, &quick(Foot::Pinned), Some(&edits), &mut Quiet).unwrap();
        assert_eq!(part.ruffle.densified.made.len(), 1);
        assert!((part.ruffle.section_length(0) - 66.0).abs() < 1e-9);
        let error = fit(target, &quick(Foot::Pinned), Some(&gone), &mut Quiet).unwrap_err();
        assert!(error.to_string().starts_with("part A: there is no section 99"), "{error}");
    });
}

#[test]
fn a_load_on_a_node_is_borne_by_the_settled_part() {
    let settings = Settings { effort: 0, ..quick(Foot::Pinned) };
    with_target(&rectangle(100.0, 100.0), |plain| {
        let part = fit(plain, &settings, None, &mut Quiet).unwrap();
        let highest = |part: &Part| part.equilibrium.positions.iter().map(|p| p.y).fold(0.0, f64::max);
        let before = highest(&part);
        let top = *part.ruffle.walk.last().unwrap();
        let loaded = Target { loads_n: &[(top, V2::new(0.0, -0.1))], ..*plain };
        let part = settle(&loaded, &settings, part).unwrap();
        assert_eq!(part.equilibrium.outcome, Outcome::Converged);
        assert!(highest(&part) < before - 0.2, "{} against {before} mm", highest(&part));
    });
}

#[test]
fn what_a_part_bears_counts_when_it_is_asked_whether_it_stands() {
    let settings = Settings { effort: 0, ..quick(Foot::Free) };
    with_target(&rectangle(100.0, 60.0), |plain| {
        let part = fit(plain, &settings, None, &mut Quiet).unwrap();
        assert!(part.report.stands);
        let x = &part.equilibrium.positions;
        let top = x.iter().map(|p| p.y).fold(0.0, f64::max);
        let touching: Vec<f64> = x.iter().filter(|p| p.y < 0.05).map(|p| p.x).collect();
        let (left, right) = touching.iter().fold((f64::INFINITY, 0.0_f64), |(l, r), u| (l.min(*u), r.max(*u)));
        // Twice its own weight, low down where it stands, and high up at its right end.
        let nearest = |at: P2| (0..x.len()).min_by(|a, b| (x[*a] - at).norm().total_cmp(&(x[*b] - at).norm())).unwrap();
        let loaded = |at: P2| {
            let load = [(Node(nearest(at) as u32), V2::new(0.0, -2.0 * part.report.strip_mass_g * 9.8e-3))];
            let target = Target { loads_n: &load, ..*plain };
            report::measure(&target, &part.ruffle, &part.spans, &part.equilibrium, part.report.origin()).stands
        };
        assert!(loaded(P2::new(0.5 * (left + right), 0.0)) && !loaded(P2::new(100.0, top)));
    });
}

#[test]
fn widths_belong_to_where_the_strip_comes_to_rest() {
    let ball = crate::mesh::samples::sphere(P3::new(0.0, 45.0, 0.0), 45.0, 24);
    let frame = frame();
    let circle: Vec<(f64, f64)> = (0..40)
        .map(|i| std::f64::consts::TAU * f64::from(i) / 40.0)
        .map(|a| (45.0 * a.cos(), 45.0 + 45.0 * a.sin()))
        .collect();
    let (outline, material) = (polygon(&circle), paper());
    let extruder = Extruder::from_mesh(&ball, &frame, 20.0).unwrap();
    let target =
        Target { name: "A", frame: &frame, outline: &outline, extruder: &extruder, material: &material, loads_n: &[] };
    let part = fit(&target, &quick(Foot::Pinned), None, &mut Quiet).unwrap();
    let there = extruder.spans(&part.ruffle, &part.equilibrium.positions);
    let off = width_difference(&there, &part.spans);
    assert!(off <= SAME_WIDTH, "{off}");
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
    let mut stop = Stop(0);
    let (part, _) = filled(&rectangle(100.0, 100.0), &quick(Foot::Auto), &mut stop).unwrap();
    assert_eq!(part.equilibrium.outcome, Outcome::Converged);
    assert_eq!(stop.0, 1);
}

#[test]
fn an_outline_too_small_is_refused_by_part() {
    let error = filled(&rectangle(8.0, 8.0), &quick(Foot::Auto), &mut Quiet).unwrap_err();
    assert!(error.to_string().starts_with("part A: the outline, 8.0 x 8.0 mm"), "{error}");
}
