//! Dividing a strip that is longer than the stock. Neighbouring pieces overlap by a lap, which is glued or taped.

use super::edge::Edges;
use super::fasten::Fastening;
use super::{Error, Settings, line};
use crate::drawing::{DrawnPath, Role};
use crate::fit::Part;
use crate::geom::{P2, Path};
use crate::ruffle;
use std::ops::Range;

/// Splices are looked for at stations this far apart, mm.
const SCAN_MM: f64 = 0.5;

/// Stretches of the strip, one per piece, each at most `max_piece_mm` long; neighbours share the overlap.
pub(super) fn divide(
    part: &Part,
    edges: &Edges,
    fastenings: &[Fastening],
    settings: &Settings,
) -> Result<Vec<Range<f64>>, Error> {
    let whole = edges.range();
    let (overlap, max) = (settings.splice_overlap_mm, settings.max_piece_mm);
    if edges.length_mm() <= max {
        return Ok(vec![whole]);
    }
    let least_mm = 3.0 * overlap;
    if max < least_mm {
        return Err(Error::StockTooShort { part: part.name.clone(), max_piece_mm: max, least_mm });
    }
    let fewest = ((edges.length_mm() - overlap) / (max - overlap)).ceil() as usize;
    let mut refused = None;
    // Even pieces first; where joints leave no gap at an even spacing, more and shorter pieces have more places to choose from.
    for care in Care::ALL {
        let keep_out = keep_out(part, fastenings, settings, care);
        for count in fewest..=2 * fewest {
            match cuts(part, edges, &keep_out, settings, count) {
                Ok(cuts) => return Ok(ranges(&cuts, whole, overlap)),
                Err(error) => refused = refused.or(Some(error)),
            }
        }
    }
    Err(refused.expect("at least one count was tried"))
}

/// Overlapping stretches between the middles of splices.
fn ranges(cuts: &[f64], whole: Range<f64>, overlap_mm: f64) -> Vec<Range<f64>> {
    let starts = std::iter::once(whole.start).chain(cuts.iter().map(|cut| cut - overlap_mm / 2.0));
    let ends = cuts.iter().map(|cut| cut + overlap_mm / 2.0).chain(std::iter::once(whole.end));
    starts.zip(ends).map(|(start, end)| start..end).collect()
}

/// What a splice keeps clear of, most careful first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Care {
    /// Joints with their distance, and the crowns of loops, where a doubled sheet would flatten the bend.
    JointsAndCrowns,
    /// Joints with their distance.
    Joints,
    /// Only the cuts of joints themselves.
    Cuts,
}

impl Care {
    const ALL: [Care; 3] = [Care::JointsAndCrowns, Care::Joints, Care::Cuts];
}

/// Middles of the splices of `count` pieces.
fn cuts(
    part: &Part,
    edges: &Edges,
    keep_out: &[Range<f64>],
    settings: &Settings,
    count: usize,
) -> Result<Vec<f64>, Error> {
    let whole = edges.range();
    let (overlap, max) = (settings.splice_overlap_mm, settings.max_piece_mm);
    let mut start = whole.start;
    let mut cuts = Vec::new();
    for i in 1..count {
        let pieces_left = (count - i + 1) as f64;
        let ideal = start + (whole.end - start + (pieces_left - 1.0) * overlap) / pieces_left - overlap / 2.0;
        let (from, to) = (start + 2.0 * overlap, start + max - overlap / 2.0);
        let free = |cut: f64| {
            let lap = cut - overlap / 2.0..cut + overlap / 2.0;
            cut >= from && cut <= to && !keep_out.iter().any(|k| k.start < lap.end && k.end > lap.start)
        };
        let steps = ((to - from) / SCAN_MM) as usize;
        let cut = (0..=steps)
            .flat_map(|n| [ideal - n as f64 * SCAN_MM, ideal + n as f64 * SCAN_MM])
            .find(|cut| free(*cut))
            .ok_or_else(|| Error::NoRoomForSplice {
                part: part.name.clone(),
                from_mm: from,
                to_mm: to,
                need_mm: overlap,
                max_piece_mm: max,
            })?;
        cuts.push(cut);
        start = cut - overlap / 2.0;
    }
    if whole.end - start > max {
        let (from_mm, to_mm) = (start, whole.end);
        return Err(Error::NoRoomForSplice {
            part: part.name.clone(),
            from_mm,
            to_mm,
            need_mm: overlap,
            max_piece_mm: max,
        });
    }
    Ok(cuts)
}

/// Stretches where no splice may lie.
fn keep_out(part: &Part, fastenings: &[Fastening], settings: &Settings, care: Care) -> Vec<Range<f64>> {
    let clear = if care == Care::Cuts { 1.0 } else { settings.joint.cut_distance_mm / 2.0 };
    let mut keep_out: Vec<Range<f64>> = fastenings
        .iter()
        .map(|f| f.bounds(&settings.joint).grown(clear))
        .map(|bounds| bounds.min.x..bounds.max.x)
        .collect();
    if care == Care::JointsAndCrowns {
        let stations = part.ruffle.stations();
        let loops = part.ruffle.sections.iter().filter(|s| s.role == ruffle::Role::Outer);
        keep_out.extend(loops.map(|s| {
            let (from, to) = (stations[s.first_segment], stations[s.end_segment]);
            let (middle, sixth) = (0.5 * (from + to), (to - from) / 6.0);
            middle - sixth..middle + sixth
        }));
    }
    keep_out
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
