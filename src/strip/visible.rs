//! Which face of the strip is seen from outside, once it is folded.

use super::fold::Face;
use super::passage::Passage;
use crate::fit::Part;
use crate::geom::{P2, V2, contains};
use std::ops::Range;

/// What lies this far from the sheet, mm, is inside the ruffle or outside of it.
const PROBE_MM: f64 = 1.0;
/// Sheets cover each other this far on both sides of a joint, mm.
const COVERED_MM: f64 = 10.0;

/// Stretches of the strip, mm, in which `face` looks outward and is not covered by a partner at a joint.
pub(super) fn outward(part: &Part, passages: &[Passage], face: Face) -> Vec<Range<f64>> {
    let stations = part.ruffle.stations();
    let x = &part.equilibrium.positions;
    let sees_outside = |k: usize| {
        let (i, j) = part.ruffle.ends(k);
        let along = (x[j] - x[i]).normalize();
        let right = V2::new(along.y, -along.x);
        let side = if face == Face::Front { right } else { -right };
        let probe: P2 = nalgebra::center(&x[i], &x[j]) + side * PROBE_MM;
        part.report.covered.iter().filter(|l| contains(l, probe)).count() % 2 == 0
    };
    let covered = |k: usize| {
        let middle = 0.5 * (stations[k] + stations[k + 1]);
        passages.iter().any(|p| p.face == face && (p.station_mm - middle).abs() < COVERED_MM)
    };
    let mut stretches: Vec<Range<f64>> = Vec::new();
    for k in (0..part.ruffle.rest_lengths.len()).filter(|k| sees_outside(*k) && !covered(*k)) {
        match stretches.last_mut() {
            Some(last) if last.end == stations[k] => last.end = stations[k + 1],
            _ => stretches.push(stations[k]..stations[k + 1]),
        }
    }
    stretches
}
