//! Points and distances, with a grid so that a sheet of them is searched quickly.

use std::collections::{BTreeSet, HashMap};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    pub x: f64,
    pub y: f64,
}

pub fn at(x: f64, y: f64) -> Point {
    Point { x, y }
}

impl Point {
    pub fn to(self, other: Point) -> f64 {
        (other.x - self.x).hypot(other.y - self.y)
    }

    pub fn between(self, other: Point, t: f64) -> Point {
        at(self.x + (other.x - self.x) * t, self.y + (other.y - self.y) * t)
    }
}

/// The point of segment `a b` nearest to `p`.
pub fn foot(p: Point, a: Point, b: Point) -> Point {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let square = dx * dx + dy * dy;
    let t = if square > 0.0 { (((p.x - a.x) * dx + (p.y - a.y) * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
    a.between(b, t)
}

/// Points of a circular arc within 2 um of it, without its start. `sweep` in rad, positive counter-clockwise.
pub fn arc(from: Point, center: Point, sweep: f64) -> Vec<Point> {
    let radius = from.to(center);
    let step = (8.0 * 0.002 / radius.max(0.01)).sqrt();
    let count = (sweep.abs() / step).ceil().max(1.0) as u32;
    let start = (from.y - center.y).atan2(from.x - center.x);
    let point = |k: u32| {
        let angle = start + sweep * f64::from(k) / f64::from(count);
        at(center.x + radius * angle.cos(), center.y + radius * angle.sin())
    };
    (1..=count).map(point).collect()
}

/// Points of a polyline at most `step` apart, with the unit normal on the left of each.
pub fn walk(points: &[Point], step: f64) -> Vec<(Point, Point)> {
    let mut walked = Vec::new();
    for pair in points.windows(2) {
        let length = pair[0].to(pair[1]);
        if length == 0.0 {
            continue;
        }
        let normal = at((pair[0].y - pair[1].y) / length, (pair[1].x - pair[0].x) / length);
        let count = (length / step).ceil().max(1.0) as u32;
        walked.extend((0..=count).map(|k| (pair[0].between(pair[1], f64::from(k) / f64::from(count)), normal)));
    }
    walked
}

/// A stretch of a segment and the index of its line.
type Piece = (Point, Point, usize);

/// Segments in cells, for distances up to `REACH`.
pub struct Grid {
    cells: HashMap<(i64, i64), Vec<Piece>>,
}

const REACH: f64 = 1.0;

impl Grid {
    /// All segments of some polylines; each keeps the index of its line.
    pub fn of<'a>(lines: impl Iterator<Item = &'a [Point]>) -> Grid {
        let mut cells: HashMap<(i64, i64), Vec<Piece>> = HashMap::new();
        for (index, line) in lines.enumerate() {
            for pair in line.windows(2) {
                // Long segments are cut up, so that each lies in few cells.
                let parts = (pair[0].to(pair[1]) / REACH).ceil().max(1.0) as u32;
                for k in 0..parts {
                    let end = |k: u32| pair[0].between(pair[1], f64::from(k) / f64::from(parts));
                    let (a, b) = (end(k), end(k + 1));
                    let middle = a.between(b, 0.5);
                    cells.entry(cell(middle)).or_default().push((a, b, index));
                }
            }
        }
        Grid { cells }
    }

    fn near(&self, p: Point) -> impl Iterator<Item = &Piece> {
        let (i, j) = cell(p);
        let cells = (-2..=2).flat_map(move |di| (-2..=2).map(move |dj| (i + di, j + dj)));
        cells.filter_map(|c| self.cells.get(&c)).flatten()
    }

    /// Distance to the nearest segment within reach.
    pub fn distance(&self, p: Point) -> f64 {
        self.near(p).map(|(a, b, _)| foot(p, *a, *b).to(p)).fold(f64::INFINITY, f64::min)
    }

    /// Indices of the lines within reach.
    pub fn lines(&self, p: Point) -> BTreeSet<usize> {
        self.near(p).map(|(_, _, index)| *index).collect()
    }
}

fn cell(p: Point) -> (i64, i64) {
    ((p.x / REACH).floor() as i64, (p.y / REACH).floor() as i64)
}
