//! What a lap is held by: two rows of flaps of its own, or holes for thread.

use super::edge::Edges;
use super::fold::Face;
use super::joint::{Fastening, Joint};
use super::passage::{Half, Passage, Seat};
use super::seats;
use super::splice::{SpliceSettings, Spot};

/// Distance between a lap's holes for thread, mm.
const STITCH_MM: f64 = 8.0;

/// The passages that hold one lap: those of the earlier piece, then those of the later one, which lies on the front of the earlier. `name` numbers their joints.
///
/// Flaps point away from the lap's middle: pulled apart, each sheet hooks onto the hinge of the other's flaps, which is stronger than barbs.
pub(super) fn passages(
    spot: &Spot,
    edges: &Edges,
    joint: &Joint,
    splice: &SpliceSettings,
    mut name: impl FnMut() -> String,
) -> [Vec<Passage>; 2] {
    let [mut earlier, mut later] = [Vec::new(), Vec::new()];
    for direction in [-1.0, 1.0] {
        let station_mm = spot.at_mm + direction * 0.5 * splice.rows_mm;
        let joint_name = name();
        let passage = |half: Half, face: Face, seats: &[Seat]| Passage {
            joint: joint_name.clone(),
            station_mm,
            half,
            face,
            depth: usize::from(half == Half::Slit),
            sheets: 1,
            seats: seats.to_vec(),
        };
        let clear = joint.edge_distance_mm;
        let loose = match (splice.thread_hole_mm, joint.fastening) {
            (Some(diameter_mm), _) | (None, Fastening::Holes { diameter_mm }) => Some(Half::Holes { diameter_mm }),
            (None, Fastening::Mark) => Some(Half::Mark),
            (None, Fastening::Flap) => None,
        };
        if let Some(half) = loose {
            let (lo, hi) = edges.band(station_mm - clear..station_mm + clear);
            let across = match splice.thread_hole_mm {
                Some(_) => stitches(lo, hi, clear),
                None => seats::middles(lo, hi, joint, false),
            };
            let seats: Vec<Seat> = across.into_iter().map(|across_mm| Seat { across_mm, direction }).collect();
            earlier.push(passage(half, Face::Front, &seats));
            later.push(passage(half, Face::Back, &seats));
            continue;
        }
        let (behind, ahead) = joint.reach_both_ways_mm(1);
        let ends = [station_mm - direction * behind, station_mm + direction * ahead];
        let (lo, hi) = edges.band(ends[0].min(ends[1]) - clear..ends[0].max(ends[1]) + clear);
        let middles = seats::middles(lo, hi, joint, false);
        let seats: Vec<Seat> = middles.into_iter().map(|across_mm| Seat { across_mm, direction }).collect();
        // The row nearer to a piece's body carries its flaps.
        let (own, other) = if direction < 0.0 { (&mut earlier, &mut later) } else { (&mut later, &mut earlier) };
        let (out, into) = if direction < 0.0 { (Face::Front, Face::Back) } else { (Face::Back, Face::Front) };
        own.push(passage(Half::Flap, out, &seats));
        other.push(passage(Half::Slit, into, &seats));
    }
    [earlier, later]
}

/// Holes for thread across the strip, `clear` from its edges.
fn stitches(lo: f64, hi: f64, clear: f64) -> Vec<f64> {
    let count = ((hi - lo - 2.0 * clear).max(0.0) / STITCH_MM) as usize + 1;
    let first = 0.5 * (lo + hi) - 0.5 * STITCH_MM * (count - 1) as f64;
    (0..count).map(|i| first + i as f64 * STITCH_MM).collect()
}
