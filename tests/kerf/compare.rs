//! Wanted against made.

use super::plane::{Grid, Point, at, walk};
use super::program::Run;
use super::sheet::Nominal;

/// What is left may differ from what the tool can leave by this much, mm.
pub const TOLERANCE_MM: f64 = 0.05;

/// Distance between looked-at points, mm.
const STEP_MM: f64 = 0.1;

/// Length of the alignment crosses' strokes, mm: the only runs that belong to no path.
const CROSS_MM: f64 = 4.0;

/// What came of it.
pub struct Found {
    /// Farthest from where it should be, mm.
    pub worst_mm: f64,
    pub where_worst: String,
    /// For every nominal path the lengths left uncut.
    pub gaps: Vec<Vec<f64>>,
}

impl Found {
    fn note(&mut self, off_mm: f64, place: impl Fn() -> String) {
        if off_mm > self.worst_mm {
            (self.worst_mm, self.where_worst) = (off_mm, place());
        }
    }
}

fn operation(nominal: &Nominal) -> &'static str {
    match nominal.class.as_str() {
        "outline" => "cut-outline",
        "mark" | "label" => "engrave",
        _ => "cut-inner",
    }
}

/// What is wanted against what a disc of this radius makes on its runs; a blade's tip has none.
pub fn compared(nominal: &[Nominal], runs: &[Run], half_kerf_mm: f64) -> Found {
    let mut found = Found { worst_mm: 0.0, where_worst: String::new(), gaps: Vec::new() };
    nothing_lost(nominal, runs, half_kerf_mm, &mut found);
    for path in nominal {
        let gaps = left_uncut(path, nominal, runs, half_kerf_mm);
        found.gaps.push(gaps);
    }
    found
}

/// Every point the tool was at keeps half a kerf from what is to stay.
fn nothing_lost(nominal: &[Nominal], runs: &[Run], half_kerf_mm: f64, found: &mut Found) {
    let outlines: Vec<&Nominal> = nominal.iter().filter(|n| n.class == "outline").collect();
    let rims = Grid::of(outlines.iter().map(|n| n.points.as_slice()));
    let inner: Vec<&Nominal> = nominal.iter().filter(|n| operation(n) == "cut-inner").collect();
    let cuts = Grid::of(inner.iter().map(|n| n.points.as_slice()));
    let marks: Vec<&Nominal> = nominal.iter().filter(|n| operation(n) == "engrave").collect();
    let lines = Grid::of(marks.iter().map(|n| n.points.as_slice()));
    for run in runs {
        // An alignment cross: a short stroke on scrap, made before everything else.
        let length: f64 = run.points.windows(2).map(|w| w[0].to(w[1])).sum();
        let on_scrap = |p: &Point| !outlines.iter().any(|o| o.holds(*p));
        if run.operation != "cut-outline" && (length - CROSS_MM).abs() < 0.5 && run.points.iter().all(on_scrap) {
            continue;
        }
        for (p, _) in walk(&run.points, STEP_MM) {
            let place = || format!("{} at X{:.2} Y{:.2}", run.operation, p.x, p.y);
            match run.operation.as_str() {
                "cut-outline" => {
                    let into = if outlines.iter().any(|o| o.holds(p)) { -1.0 } else { 1.0 };
                    let off = half_kerf_mm - into * rims.distance(p).min(1.0);
                    // A blade removes nothing: on the rim both sides of it are right.
                    found.note(if half_kerf_mm > 0.0 { off } else { off.abs() }, place);
                }
                "cut-inner" => {
                    // A slit runs into the hole at its end: a place that is right for one of the cuts it touches is right.
                    let near = cuts.lines(p).into_iter().map(|index| astray(inner[index], p, half_kerf_mm));
                    found.note(near.fold(f64::INFINITY, f64::min), place);
                }
                _ => found.note(lines.distance(p), place),
            }
        }
    }
}

/// How far the middle of the tool at `p` is from where it may be for this cut, mm.
fn astray(path: &Nominal, p: Point, half_kerf_mm: f64) -> f64 {
    let distance = path.distance(p);
    let wanted = if path.kerf == "on" { 0.0 } else { half_kerf_mm };
    if wanted > 0.0 && side(path, p) * path.waste_side() < 0.0 {
        return distance + wanted;
    }
    // A lead may lie anywhere in what falls out.
    let waste = path.closed && path.kerf == "inside" && path.holds(p);
    if waste { wanted - distance } else { (distance - wanted).abs() }
}

/// +1 on the left of the stretch of a path nearest to `p`, -1 on its right; 0 where a corner or an end is nearest.
fn side(path: &Nominal, p: Point) -> f64 {
    let mut best = (f64::INFINITY, 0.0);
    for w in path.points.windows(2) {
        let (dx, dy) = (w[1].x - w[0].x, w[1].y - w[0].y);
        let t = ((p.x - w[0].x) * dx + (p.y - w[0].y) * dy) / (dx * dx + dy * dy);
        let near = super::plane::foot(p, w[0], w[1]).to(p);
        if near < best.0 - 1e-9 {
            let turn = dx * (p.y - w[0].y) - dy * (p.x - w[0].x);
            best = (near, if (0.01..=0.99).contains(&t) { turn.signum() } else { 0.0 });
        }
    }
    best.1
}

/// Lengths of a path that the tool could have reached and did not.
fn left_uncut(path: &Nominal, nominal: &[Nominal], runs: &[Run], half_kerf_mm: f64) -> Vec<f64> {
    let side = path.waste_side();
    let of_kind = || runs.iter().filter(|r| r.operation == operation(path));
    let made = Grid::of(of_kind().map(|r| r.points.as_slice()));
    let staying =
        Grid::of(nominal.iter().filter(|n| n.kerf != "on" && n.piece == path.piece).map(|n| n.points.as_slice()));
    let mut gaps: Vec<f64> = Vec::new();
    let mut open: Option<(Point, f64)> = None;
    let walked = walk(&path.points, STEP_MM);
    let missed = |(q, normal): &(Point, Point)| {
        let centre = at(q.x + side * half_kerf_mm * normal.x, q.y + side * half_kerf_mm * normal.y);
        // In corners tighter than the beam its middle would come nearer to what stays than half the kerf.
        let reachable = side == 0.0 || staying.distance(centre) > half_kerf_mm - 1e-3;
        reachable && made.distance(centre) > TOLERANCE_MM
    };
    let flags: Vec<bool> = walked.iter().map(missed).collect();
    // A gap over the seam of a closed path is one gap: begin where nothing is missed.
    let begin = if path.closed { flags.iter().position(|m| !m).unwrap_or(0) } else { 0 };
    for k in 0..walked.len() {
        let index = (begin + k) % walked.len();
        let q = walked[index].0;
        match (&mut open, flags[index]) {
            (None, true) => open = Some((q, STEP_MM)),
            (Some((last, length)), true) => {
                *length += last.to(q);
                *last = q;
            }
            (Some((_, length)), false) => {
                gaps.push(*length);
                open = None;
            }
            (None, false) => {}
        }
    }
    gaps.extend(open.map(|(_, length)| length));
    gaps
}
