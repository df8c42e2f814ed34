//! The two long edges of a strip.

use crate::fit::Part;
use crate::geom::{P2, Path, closest_on_segment, cross};
use std::ops::Range;

/// How far the strip reaches across at every station, end tabs included.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Edges {
    /// Stations, mm, ascending; the first connection point is at 0.
    stations: Vec<f64>,
    /// Lower edge at each station, mm.
    lo: Vec<f64>,
    /// Upper edge at each station, mm.
    hi: Vec<f64>,
}

/// Corners that lie this close to the line of their neighbours are left out, mm: far below a kerf, and every corner costs a controller a block.
const SIMPLIFY_MM: f64 = 0.005;

/// Corners that turn into the strip are rounded by this radius, mm, as far as their neighbours allow: a sharp one starts a tear.
const INNER_RADIUS_MM: f64 = 2.0;

impl Edges {
    /// Edges of the strip of `part`, with `end_tab_mm` of strip beyond each end.
    pub fn new(part: &Part, end_tab_mm: f64) -> Edges {
        let spans = || part.ruffle.walk.iter().map(|n| part.spans[n.index()]);
        let mut edges = Edges {
            stations: part.ruffle.stations(),
            lo: spans().map(|s| s.lo).collect(),
            hi: spans().map(|s| s.hi).collect(),
        };
        let last = edges.stations.len() - 1;
        let (end, lo, hi) = (edges.stations[last] + end_tab_mm, edges.lo[last], edges.hi[last]);
        edges.stations.push(end);
        edges.lo.push(lo);
        edges.hi.push(hi);
        edges.stations.insert(0, -end_tab_mm);
        edges.lo.insert(0, edges.lo[0]);
        edges.hi.insert(0, edges.hi[0]);
        edges
    }

    /// First and last station, mm.
    pub fn range(&self) -> Range<f64> {
        self.stations[0]..self.stations[self.stations.len() - 1]
    }

    /// Length over all, end tabs included, mm.
    pub fn length_mm(&self) -> f64 {
        self.range().end - self.range().start
    }

    /// Lower and upper edge at station `s`.
    pub fn at(&self, s: f64) -> (f64, f64) {
        let k = self.stations.partition_point(|t| *t <= s).clamp(1, self.stations.len() - 1);
        let (a, b) = (self.stations[k - 1], self.stations[k]);
        let t = ((s - a) / (b - a)).clamp(0.0, 1.0);
        (self.lo[k - 1] + (self.lo[k] - self.lo[k - 1]) * t, self.hi[k - 1] + (self.hi[k] - self.hi[k - 1]) * t)
    }

    /// The widest band across that lies in the strip all the way from `range.start` to `range.end`: its lower and upper edge. Upside down when there is none.
    pub fn band(&self, range: Range<f64>) -> (f64, f64) {
        let inner = (0..self.stations.len()).filter(|k| range.contains(&self.stations[*k]));
        let ends = [self.at(range.start), self.at(range.end)];
        inner
            .map(|k| (self.lo[k], self.hi[k]))
            .chain(ends)
            .fold((f64::NEG_INFINITY, f64::INFINITY), |(lo, hi), (l, h)| (lo.max(l), hi.min(h)))
    }

    /// The contour of the strip between two stations, counter-clockwise from its lower left corner.
    pub fn contour(&self, range: Range<f64>) -> Path {
        let inner = (0..self.stations.len())
            .filter(|k| self.stations[*k] > range.start + SIMPLIFY_MM && self.stations[*k] < range.end - SIMPLIFY_MM);
        let mut stations = vec![range.start];
        stations.extend(inner.map(|k| self.stations[k]));
        stations.push(range.end);
        let lower: Vec<P2> = stations.iter().map(|s| P2::new(*s, self.at(*s).0)).collect();
        let upper: Vec<P2> = stations.iter().rev().map(|s| P2::new(*s, self.at(*s).1)).collect();
        let corners: Vec<P2> = simplified(&lower).into_iter().chain(simplified(&upper)).collect();
        let n = corners.len();
        let radius = |i: usize| {
            let (before, at, after) = (corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]);
            if cross(at - before, after - at) < 0.0 { INNER_RADIUS_MM } else { 0.0 }
        };
        let rounded: Vec<(P2, f64)> = (0..n).map(|i| (corners[i], radius(i))).collect();
        Path::rounded(&rounded, true).deduplicated()
    }
}

/// Drops corners that the line through the kept ones passes within [`SIMPLIFY_MM`] (Douglas and Peucker 1973). Ends stay.
fn simplified(points: &[P2]) -> Vec<P2> {
    let (first, last) = (points[0], points[points.len() - 1]);
    let off = |p: &P2| (closest_on_segment(*p, first, last).0 - p).norm();
    let farthest = (1..points.len() - 1).max_by(|a, b| off(&points[*a]).total_cmp(&off(&points[*b])));
    match farthest {
        Some(k) if off(&points[k]) > SIMPLIFY_MM => {
            let mut kept = simplified(&points[..=k]);
            kept.pop();
            kept.extend(simplified(&points[k..]));
            kept
        }
        _ => vec![first, last],
    }
}
