//! Dividing a strip that is longer than the stock. Neighbouring pieces overlap by a lap, which is glued or taped.

use super::edge::Edges;
use super::passage::Passage;
use super::{Error, Settings, line};
use crate::drawing::{DrawnPath, Role};
use crate::fit::Part;
use crate::geom::{P2, Path};
use crate::ruffle;
use std::ops::Range;

/// How two pieces of one strip are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SpliceKind {
    /// Both ends overlap at a connection point, whose own flaps go through both.
    Connection,
    /// Both ends overlap between two connection points and are held by flaps, holes or glue of their own.
    Lap,
    /// Dovetails side by side, taped over.
    DovetailTape,
    /// Fingers side by side, glued or taped.
    Finger,
}

/// Where two pieces of one strip are joined. The later piece lies on the front of the earlier one.
#[derive(Debug, Clone, PartialEq)]
pub struct Splice {
    /// How.
    pub kind: SpliceKind,
    /// The earlier piece and the later one.
    pub pieces: [String; 2],
    /// Where both are, mm along the strip.
    pub stations_mm: Range<f64>,
    /// Joints that hold it: that of the connection point, or the lap's own.
    pub joints: Vec<String>,
}

/// Splices may lie at stations this far apart, mm.
const STEP_MM: f64 = 0.5;
/// A lap keeps this much from the cuts of a joint, mm, whatever else.
const LEAST_CLEAR_MM: f64 = 1.0;
/// What a lap costs, in pieces, where it lies on the crown of a loop: the doubled sheet flattens the bend.
const CROWN_COST: f64 = 0.3;
/// And where it comes closer to a joint than joints may to each other.
const CROWDED_COST: f64 = 0.3;
/// Pieces of equal length are easier to handle and to place: what a piece of the full length costs beyond one.
const LENGTH_COST: f64 = 0.05;

/// Stretches of the strip, one per piece, each at most `max_piece_mm` long; neighbours share the overlap. Fewest pieces first, then laps where they disturb
/// least, then even lengths, by dynamic programming over the stations.
pub(super) fn divide(
    part: &Part,
    edges: &Edges,
    passages: &[Passage],
    settings: &Settings,
) -> Result<Vec<Range<f64>>, Error> {
    let whole = edges.range();
    let (overlap, max) = (settings.splice_overlap_mm, settings.max_piece_mm);
    if edges.length_mm() <= max {
        return Ok(vec![whole]);
    }
    let least_mm = 2.0 * overlap + STEP_MM;
    if max < least_mm {
        return Err(Error::StockTooShort { part: part.name.clone(), max_piece_mm: max, least_mm });
    }
    let laps = lap_costs(part, edges, passages, settings);
    let cuts = cheapest(&laps, whole.clone(), overlap, max).map_err(|(from_mm, to_mm)| Error::NoRoomForSplice {
        part: part.name.clone(),
        from_mm,
        to_mm,
        need_mm: overlap,
        max_piece_mm: max,
    })?;
    let starts = std::iter::once(whole.start).chain(cuts.iter().map(|cut| cut - overlap / 2.0));
    let ends = cuts.iter().map(|cut| cut + overlap / 2.0).chain(std::iter::once(whole.end));
    Ok(starts.zip(ends).map(|(start, end)| start..end).collect())
}

/// Middles of the laps that divide `whole` most cheaply. Where there is no way, the stretch in which a lap would have to lie.
fn cheapest(laps: &[(f64, f64)], whole: Range<f64>, overlap_mm: f64, max_mm: f64) -> Result<Vec<f64>, (f64, f64)> {
    let half = overlap_mm / 2.0;
    // A piece from one lap's middle to the next's; the strip's own ends have no lap.
    let piece = |from: f64, to: f64| {
        let start = if from == whole.start { from } else { from - half };
        let end = if to == whole.end { to } else { to + half };
        let length = end - start;
        let fits = length <= max_mm && to - from > overlap_mm;
        fits.then(|| 1.0 + LENGTH_COST * (length / max_mm).powi(2))
    };
    // best[k]: cost of everything before lap k, and the lap before it.
    let mut best: Vec<Option<(f64, Option<usize>)>> = Vec::with_capacity(laps.len());
    let before = |best: &[Option<(f64, Option<usize>)>], to: f64| {
        let from_start = piece(whole.start, to).map(|cost| (cost, None));
        let near = laps.partition_point(|lap| lap.0 < to - max_mm);
        let from_laps = (near..best.len()).filter_map(|k| {
            let (cost, _) = best[k]?;
            Some((cost + laps[k].1 + piece(laps[k].0, to)?, Some(k)))
        });
        from_start.into_iter().chain(from_laps).min_by(|a, b| a.0.total_cmp(&b.0))
    };
    for (at, _) in laps {
        let way = before(&best, *at);
        best.push(way);
    }
    let Some((_, mut lap)) = before(&best, whole.end) else {
        let reached = (0..laps.len()).rev().find(|k| best[*k].is_some()).map_or(whole.start, |k| laps[k].0);
        return Err((reached, (reached + max_mm).min(whole.end)));
    };
    let mut cuts = Vec::new();
    while let Some(k) = lap {
        cuts.push(laps[k].0);
        lap = best[k].and_then(|(_, previous)| previous);
    }
    cuts.reverse();
    Ok(cuts)
}

/// Stations where a lap may lie, ascending, with what it costs there.
fn lap_costs(part: &Part, edges: &Edges, passages: &[Passage], settings: &Settings) -> Vec<(f64, f64)> {
    let joints: Vec<Range<f64>> =
        passages.iter().map(|f| f.bounds(&settings.joint)).map(|b| b.min.x..b.max.x).collect();
    let stations = part.ruffle.stations();
    let loops = part.ruffle.sections.iter().filter(|s| s.role == ruffle::Role::Outer);
    let crowns: Vec<Range<f64>> = loops
        .map(|s| {
            let (from, to) = (stations[s.first_segment], stations[s.end_segment]);
            let (middle, sixth) = (0.5 * (from + to), (to - from) / 6.0);
            middle - sixth..middle + sixth
        })
        .collect();
    let half = settings.splice_overlap_mm / 2.0;
    let meets = |ranges: &[Range<f64>], at: f64, clear: f64| {
        ranges.iter().any(|r| r.start - clear < at + half && r.end + clear > at - half)
    };
    let whole = edges.range();
    let steps = (edges.length_mm() / STEP_MM) as usize;
    (1..steps)
        .map(|n| whole.start + n as f64 * STEP_MM)
        .filter(|at| at - half > whole.start && at + half < whole.end && !meets(&joints, *at, LEAST_CLEAR_MM))
        .map(|at| {
            let crowded = meets(&joints, at, settings.joint.cut_distance_mm / 2.0);
            let crown = meets(&crowns, at, 0.0);
            (at, if crowded { CROWDED_COST } else { 0.0 } + if crown { CROWN_COST } else { 0.0 })
        })
        .collect()
}

/// Engraved lines on piece `i` that show where its neighbours end.
pub(super) fn marks(edges: &Edges, ranges: &[Range<f64>], i: usize, overlap_mm: f64) -> Vec<DrawnPath> {
    let mut stations = Vec::new();
    if i > 0 {
        stations.push(ranges[i].start + overlap_mm);
    }
    if i + 1 < ranges.len() {
        stations.push(ranges[i].end - overlap_mm);
    }
    stations
        .into_iter()
        .map(|s| {
            let (lo, hi) = edges.at(s);
            line(Path::open([P2::new(s, lo), P2::new(s, hi)]), Role::Mark)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn fewer_pieces_beat_better_places_and_better_places_beat_even_lengths() {
        let free = |stations: &[(f64, f64)]| cheapest(stations, 0.0..100.0, 10.0, 60.0);
        // Both in one lap: the dear place at 50 still saves a piece.
        assert_eq!(free(&[(20.0, 0.0), (50.0, 0.3), (80.0, 0.0)]), Ok(vec![50.0]));
        assert_eq!(free(&[(46.0, 0.3), (53.0, 0.0), (55.0, 0.0)]), Ok(vec![53.0]));
        assert_eq!(free(&[(20.0, 0.0)]), Err((20.0, 80.0)));
    }

    proptest! {
        #[test]
        fn pieces_cover_the_strip_fit_the_stock_and_overlap_by_the_lap(
            length in 60.0..900.0f64, max in 60.0..300.0f64, holes in prop::collection::vec((0.0..1.0f64, 1.0..25.0f64), 0..12),
        ) {
            let whole = -9.0..length - 9.0;
            prop_assume!(length > max);
            let blocked = |at: f64| holes.iter().any(|(h, w)| (at - (whole.start + h * length)).abs() < w + 10.0);
            let laps: Vec<(f64, f64)> = (1..(length / 0.5) as usize)
                .map(|n| whole.start + n as f64 * 0.5)
                .filter(|at| at - 10.0 > whole.start && at + 10.0 < whole.end && !blocked(*at))
                .map(|at| (at, 0.0))
                .collect();
            if let Ok(cuts) = cheapest(&laps, whole.clone(), 20.0, max) {
                let mut start = whole.start;
                for cut in &cuts {
                    prop_assert!(!blocked(*cut) && cut + 10.0 - start <= max + 1e-9);
                    prop_assert!(cut - 10.0 > start, "laps do not meet");
                    start = cut - 10.0;
                }
                prop_assert!(whole.end - start <= max + 1e-9 && whole.end - start > 20.0);
            }
        }
    }
}
