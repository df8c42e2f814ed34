//! Outlines filled from end to end.

use super::*;
use crate::geom::{P2, P3, V3};
use crate::progress::{Progress, Warning};
use crate::ruffle::{Drawn, EditSettings, Limits, densify, set_length};
use crate::sim::Outcome;
use std::ops::ControlFlow;

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

fn filled(outline: &Outline, settings: &Settings, observer: &mut dyn Observer) -> Result<(Part, Vec<Warning>), Error> {
    let extruder = Extruder::constant(-20.0, 20.0).unwrap();
    let target = Target { name: "A", frame: &frame(), outline, extruder: &extruder, material: &paper(), loads_n: &[] };
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
    let target =
        Target { name: "A", frame: &frame, outline: &square, extruder: &extruder, material: &material, loads_n: &[] };
    let edit_settings = EditSettings { segment_mm: 3.0, limits: Limits::default() };
    let dense = |drawn: &Drawn| set_length(&densify(drawn, &[1], 1, &edit_settings)?, 0, 66.0, &edit_settings);
    let edits = Edits { apply: &dense };
    let part = fit(&target, &Settings::default(), Some(&edits), &mut Quiet).unwrap();
    assert_eq!(part.ruffle.densified.made.len(), 1);
    assert!((part.ruffle.section_length(0) - 66.0).abs() < 1e-9);
    let gone = Edits { apply: &|drawn| densify(drawn, &[99], 1, &edit_settings) };
    let error = fit(&target, &Settings::default(), Some(&gone), &mut Quiet).unwrap_err();
    assert!(error.to_string().starts_with("part A: there is no section 99"), "{error}");
}

#[test]
fn a_load_on_a_node_is_borne_by_the_settled_part() {
    let square = polygon(&[(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)]);
    let (extruder, frame, material) = (Extruder::constant(-20.0, 20.0).unwrap(), frame(), paper());
    let plain =
        Target { name: "A", frame: &frame, outline: &square, extruder: &extruder, material: &material, loads_n: &[] };
    let settings = Settings { effort: 0, foot: Foot::Pinned, ..Settings::default() };
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
