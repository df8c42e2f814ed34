//! Which of two filled parts is the better one.

use super::{FootUsed, Part, Settings};

/// How far a part is from full and easy to make, as a share of the outline.
pub(super) fn score(part: &Part, settings: &Settings) -> f64 {
    let report = &part.report;
    let glue = if report.foot == FootUsed::Pinned { settings.free_foot_bonus } else { 0.0 };
    let shortfall = |value: f64, least: f64| if value < least { 1.0 - value / least } else { 0.0 };
    report.uncovered_fraction
        + report.protruding_fraction
        + glue
        // Coverage does not see what is inside: a ruffle that passes through itself will fold otherwise, a layer that has collapsed cannot be assembled,
        // a crease is a hinge.
        + if report.stands { 0.0 } else { TIPPING_COST }
        + CROSSING_COST * part.equilibrium.self_intersections as f64
        + COLLAPSED_COST * shortfall(report.thinnest_layer_mm, THINNEST_LAYER_MM)
        + VOID_COST * shortfall(report.min_void_mm, settings.min_void_mm).powi(2)
        + CREASE_COST * shortfall(report.min_radius_mm, settings.min_bend_radius_mm)
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
const CREASE_COST: f64 = 0.5;
const VOID_COST: f64 = 0.5;
