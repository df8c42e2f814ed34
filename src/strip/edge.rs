//! The two long edges of a strip.

use super::dovetail;
use crate::fit::Part;
use crate::geom::{P2, Path, V2, closest_on_segment, cross};
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

    /// The contour of the strip between two stations, counter-clockwise from its lower left corner. Where an end meets the next piece side by side, it follows that line
    /// (lower edge to upper) instead of running straight across. Notches are cut into its edges.
    pub fn contour(&self, range: Range<f64>, lines: [Option<&[P2]>; 2], notches: &[Notch]) -> Path {
        let [start_line, end_line] = lines;
        let start = start_line.map_or(range.start, |l| l[0].x);
        let end = end_line.map_or(range.end, |l| l[0].x);
        let lower = self.rim(start..end, |s| self.at(s).0);
        let upper = self.rim(start..end, |s| self.at(s).1);
        let cut_into = |rim: Vec<P2>, upper: bool| {
            // With its place along the edge: on a slope a notch's tip lies beyond its mouth.
            let mut corners: Vec<(f64, Corner)> = rim.into_iter().map(|p| (p.x, Corner::Rim(p))).collect();
            for notch in notches.iter().filter(|n| n.upper == upper) {
                let [from, to] = [notch.at_mm - 0.5 * notch.width_mm, notch.at_mm + 0.5 * notch.width_mm];
                corners.retain(|(s, _)| *s <= from || *s >= to);
                let edge = |s: f64| if upper { self.at(s).1 } else { self.at(s).0 };
                let [a, b] = [P2::new(from, edge(from)), P2::new(to, edge(to))];
                // Square to the edge, into the strip: on a slope a notch straight across would be a step.
                let along = (b - a).normalize();
                let inward = if upper { V2::new(along.y, -along.x) } else { V2::new(-along.y, along.x) };
                let own = [a, nalgebra::center(&a, &b) + inward * notch.depth_mm, b].map(Corner::Notch);
                let place = corners.partition_point(|(s, _)| *s <= from);
                corners.splice(place..place, [from, notch.at_mm, to].into_iter().zip(own));
            }
            corners.into_iter().map(|(_, corner)| corner).collect::<Vec<Corner>>()
        };
        let tails = |line: Option<&[P2]>| {
            let inner = line.map_or(&[] as &[P2], |l| &l[1..l.len() - 1]);
            inner.iter().copied().map(Corner::Tail).collect::<Vec<Corner>>()
        };
        let mut corners = cut_into(lower, false);
        corners.extend(tails(end_line));
        corners.extend(cut_into(upper, true).into_iter().rev());
        corners.extend(tails(start_line).into_iter().rev());
        let n = corners.len();
        let radius = |i: usize| {
            let [before, at, after] = [(i + n - 1) % n, i, (i + 1) % n].map(|k| corners[k].point());
            match corners[i] {
                Corner::Rim(_) if cross(at - before, after - at) < 0.0 => INNER_RADIUS_MM,
                Corner::Tail(_) => dovetail::RADIUS_MM,
                Corner::Rim(_) | Corner::Notch(_) => 0.0,
            }
        };
        let rounded: Vec<(P2, f64)> = (0..n).map(|i| (corners[i].point(), radius(i))).collect();
        Path::rounded(&rounded, true).deduplicated()
    }

    /// One edge between two stations, ascending, without corners that do not show.
    fn rim(&self, range: Range<f64>, across: impl Fn(f64) -> f64) -> Vec<P2> {
        let inside = |s: &f64| *s > range.start + SIMPLIFY_MM && *s < range.end - SIMPLIFY_MM;
        let stations =
            std::iter::once(range.start).chain(self.stations.iter().copied().filter(inside)).chain([range.end]);
        let points: Vec<P2> = stations.map(|s| P2::new(s, across(s))).collect();
        simplified(&points)
    }
}

/// A V cut into an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Notch {
    /// Its middle along the strip, mm.
    pub at_mm: f64,
    /// At the edge, mm.
    pub width_mm: f64,
    /// Into the strip, mm.
    pub depth_mm: f64,
    /// In the upper edge, or in the lower.
    pub upper: bool,
}

/// A corner of a contour, by what it belongs to: that decides how it is rounded.
enum Corner {
    Rim(P2),
    Tail(P2),
    Notch(P2),
}

impl Corner {
    fn point(&self) -> P2 {
        match self {
            Corner::Rim(p) | Corner::Tail(p) | Corner::Notch(p) => *p,
        }
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
