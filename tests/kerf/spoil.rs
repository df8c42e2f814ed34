//! Runs spoilt on purpose.

use crate::kerf::plane::{Point, at, foot};
use crate::kerf::program::Run;
use crate::kerf::sheet::Nominal;

/// A run with every point somewhere else.
pub fn mapped(run: &Run, f: impl Fn(Point) -> Point) -> Run {
    Run { operation: run.operation.clone(), points: run.points.iter().map(|p| f(*p)).collect() }
}

/// True for a run that keeps about half a kerf from this path all along.
pub fn follows(run: &Run, path: &Nominal, kerf_mm: f64) -> bool {
    let operation = match path.class.as_str() {
        "outline" => "cut-outline",
        "mark" | "label" => "engrave",
        _ => "cut-inner",
    };
    run.operation == operation && run.points.iter().all(|p| (path.distance(*p) - 0.5 * kerf_mm).abs() < 0.05)
}

/// The point as far on the other side of a path.
pub fn mirrored(p: Point, path: &Nominal) -> Point {
    let feet = path.points.windows(2).map(|w| foot(p, w[0], w[1]));
    let near = feet.min_by(|a, b| a.to(p).total_cmp(&b.to(p))).expect("a path has points");
    at(2.0 * near.x - p.x, 2.0 * near.y - p.y)
}
