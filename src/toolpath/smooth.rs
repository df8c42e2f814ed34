//! Fewer, longer lines and arcs within a tolerance.
//!
//! A controller looks ahead some fifteen blocks: where a rim comes in steps of half a millimetre it can never go fast. Between corners a path is
//! therefore covered by as few arcs and lines as stay within the tolerance of it, the longest first (greedily, as in the min-# problem of
//! polygonal approximation). Corners stay where they are.

use super::curve;
use crate::geom::{P2, Path, PathVertex, Segment, V2, cross};

/// Two segments that meet at more than this, rad (15 degrees), meet in a corner that is kept.
const CORNER_RAD: f64 = 0.26;

/// The path is looked at in points at most this far apart, mm: between them an arc of 5 mm radius leaves it by less than 2 um more.
const SAMPLE_MM: f64 = 0.25;

/// Arcs turn by less than this, rad: beyond, their ends come near each other.
const MAX_SWEEP_RAD: f64 = 2.8;

/// No line or arc is made shorter than this, mm: the last digit G-code carries. A way round and back to where it began is none either.
const SHORTEST_MM: f64 = 1e-3;

/// Arcs of larger radius, mm, are no arcs to a controller that computes in 32-bit floats: they would be written in chords after all.
const MAX_RADIUS_MM: f64 = 1000.0;

/// An arc within this of its chord, mm, is written as the chord: a quarter of a motor step.
const FLAT_MM: f64 = 0.003;

/// The path in lines and arcs that stay within `tolerance_mm` of it, and how far they leave it, mm. Never more segments than before.
pub(super) fn smooth(path: &Path, tolerance_mm: f64) -> (Path, f64) {
    let segments: Vec<Segment> = path.segments().filter(|s| s.length() > 0.0).collect();
    let n = segments.len();
    if tolerance_mm <= 0.0 || n < 3 {
        return (path.clone(), 0.0);
    }
    let turns = |i: usize| {
        let (before, after) = (&segments[(i + n - 1) % n], &segments[i]);
        let (u, v) = (curve::direction_at(before, 1.0), curve::start_direction(after));
        cross(u, v).atan2(u.dot(&v)).abs() > CORNER_RAD
    };
    // A closed path is walked from a corner, or from where it starts when it has none.
    let first = if path.closed { (0..n).find(|i| turns(*i)).unwrap_or(0) } else { 0 };
    let mut vertices: Vec<PathVertex> = Vec::new();
    let mut worst = 0.0_f64;
    let mut begin = 0;
    while begin < n {
        let mut end = begin + 1;
        while end < n && !turns((first + end) % n) {
            end += 1;
        }
        let run: Vec<Segment> = (begin..end).map(|i| segments[(first + i) % n]).collect();
        let (covered, off) = cover(&run, tolerance_mm);
        vertices.extend(covered);
        worst = worst.max(off);
        begin = end;
    }
    if !path.closed {
        vertices.push(PathVertex { point: segments[n - 1].to(), bulge: 0.0 });
    }
    (Path { vertices, closed: path.closed }, worst)
}

/// Covers a run without corners; gives the start of every new segment, and how far it leaves the run.
fn cover(run: &[Segment], tolerance_mm: f64) -> (Vec<PathVertex>, f64) {
    let (points, ends) = samples(run);
    let (mut vertices, mut worst) = (Vec::new(), 0.0_f64);
    let mut from = 0;
    while from < run.len() {
        let fit = |to: usize| fitted(&points[ends[from]..=ends[to]], tolerance_mm);
        // The longest stretch is sought by doubling and halving; one segment alone is always itself.
        let (mut best, mut step) = ((from + 1, own(&run[from]), 0.0), 1);
        while best.0 < run.len() {
            let to = (best.0 + step).min(run.len());
            match fit(to) {
                Some((bulge, off)) => {
                    best = (to, bulge, off);
                    step *= 2;
                }
                None if step == 1 => break,
                None => step = 1,
            }
        }
        let (to, bulge, off) = best;
        vertices.push(PathVertex { point: points[ends[from]], bulge });
        worst = worst.max(off);
        from = to;
    }
    (vertices, worst)
}

fn own(segment: &Segment) -> f64 {
    match *segment {
        Segment::Line { .. } => 0.0,
        Segment::Arc { sweep_rad, .. } => (0.25 * sweep_rad).tan(),
    }
}

/// Points along a run, and where among them its corners lie.
fn samples(run: &[Segment]) -> (Vec<P2>, Vec<usize>) {
    let (mut points, mut ends) = (vec![run[0].from()], vec![0]);
    for segment in run {
        let count = (segment.length() / SAMPLE_MM).ceil().clamp(2.0, 64.0) as u32;
        points.extend((1..=count).map(|k| curve::point_at(segment, f64::from(k) / f64::from(count))));
        ends.push(points.len() - 1);
    }
    (points, ends)
}

/// The bulge of a line or an arc from the first to the last point that passes all others within the tolerance, and how far it leaves them.
fn fitted(points: &[P2], tolerance_mm: f64) -> Option<(f64, f64)> {
    let (a, b) = (points[0], points[points.len() - 1]);
    let chord = b - a;
    let length = chord.norm();
    if length < SHORTEST_MM {
        return None;
    }
    let up = V2::new(-chord.y, chord.x) / length;
    // Of all arcs through both ends, those that pass a point within the tolerance have bulges in an interval.
    let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
    for p in &points[1..points.len() - 1] {
        let through = |q: P2| bulge_through(a, q, b);
        let (u, v) = (through(p + up * tolerance_mm), through(p - up * tolerance_mm));
        // Near the ends of an arc of more than a half turn the chord's normal says nothing.
        let (Some(u), Some(v)) = (u, v) else { continue };
        least = least.max(u.min(v));
        most = most.min(u.max(v));
    }
    let bulge = if least <= most { 0.5 * (least + most) } else { return None };
    let radius_mm = |bulge: f64| 0.25 * length * (bulge + 1.0 / bulge).abs();
    let flat = bulge.abs() * 0.5 * length < FLAT_MM || radius_mm(bulge) > MAX_RADIUS_MM;
    let bulge = if least <= 0.0 && most >= 0.0 && flat { 0.0 } else { bulge };
    if 4.0 * bulge.atan().abs() > MAX_SWEEP_RAD || bulge != 0.0 && radius_mm(bulge) > MAX_RADIUS_MM {
        return None;
    }
    let vertices = vec![PathVertex { point: a, bulge }, PathVertex { point: b, bulge: 0.0 }];
    let candidate: Vec<Segment> = Path { vertices, closed: false }.segments().collect();
    let off = points.iter().map(|p| curve::distance(&candidate, *p)).fold(0.0, f64::max);
    (off <= tolerance_mm).then_some((bulge, off))
}

/// The bulge of the arc from `a` to `b` through `q`: by the inscribed angle its sweep is 2 (pi - angle a q b). `None` where q lies on an end.
fn bulge_through(a: P2, q: P2, b: P2) -> Option<f64> {
    let (u, v) = (a - q, b - q);
    if u.norm() < 1e-9 || v.norm() < 1e-9 {
        return None;
    }
    // A counter-clockwise arc has q on the right of its chord.
    let turn = cross(-u, v).atan2((-u).dot(&v));
    Some((0.5 * turn).tan())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn polygon(n: u32, radius: f64) -> Path {
        Path::closed((0..n).map(|k| {
            let angle = TAU * f64::from(k) / f64::from(n);
            P2::new(100.0 + radius * angle.cos(), 100.0 + radius * angle.sin())
        }))
    }

    #[test]
    fn a_circle_in_chords_becomes_a_few_arcs_of_its_radius() {
        let (path, off) = smooth(&polygon(1000, 50.0), 0.02);
        assert!(path.closed && path.vertices.len() <= 4, "{}", path.vertices.len());
        assert!(off <= 0.02);
        for segment in path.segments() {
            assert!(matches!(segment, Segment::Arc { radius, .. } if (radius - 50.0).abs() < 0.03), "{segment:?}");
        }
    }

    #[test]
    fn steps_of_microns_between_longer_ones_do_not_stop_an_arc() {
        // As an offset leaves them: every corner of the circle cut off by a hair.
        let steps = 1000;
        let points = (0..steps).flat_map(|k| {
            [0.0, 1e-5].map(|hair| {
                let angle = TAU * (f64::from(k) / f64::from(steps) + hair);
                P2::new(100.0 + 50.0 * angle.cos(), 100.0 + 50.0 * angle.sin())
            })
        });
        let (path, _) = smooth(&Path::closed(points), 0.02);
        assert!(path.vertices.len() <= 4, "{}", path.vertices.len());
    }

    #[test]
    fn an_arc_too_flat_for_a_controller_becomes_lines_within_the_tolerance() {
        let rim = |x: f64| P2::new(x, 3000.0 - (9e6 - x * x).sqrt());
        let (path, off) = smooth(&Path::open((0..=100).map(|k| rim(f64::from(k)))), 0.02);
        assert!(path.vertices.iter().all(|v| v.bulge == 0.0) && off <= 0.02);
        // Chords of 2 sqrt(2 r t) = 22 mm.
        assert!(path.vertices.len() <= 7, "{}", path.vertices.len());
    }

    #[test]
    fn corners_stay_and_straight_runs_become_one_line() {
        let mut points: Vec<P2> = (0..=40).map(|k| P2::new(f64::from(k), 0.0)).collect();
        points.extend((1..=20).map(|k| P2::new(40.0, f64::from(k))));
        points.push(P2::new(0.0, 20.0));
        let (path, off) = smooth(&Path::closed(points), 0.02);
        assert_eq!(path.vertices.len(), 4);
        assert!(path.vertices.iter().all(|v| v.bulge == 0.0) && off < 1e-9);
        assert!((path.length() - 120.0).abs() < 1e-9);
    }

    #[test]
    fn arcs_that_were_arcs_stay_what_they_are() {
        let slot = Path {
            vertices: [(0.0, 0.0, 0.0), (30.0, 0.0, 1.0), (30.0, 6.0, 0.0), (0.0, 6.0, 1.0)]
                .map(|(x, y, bulge)| PathVertex { point: P2::new(x, y), bulge })
                .to_vec(),
            closed: true,
        };
        let (path, _) = smooth(&slot, 0.02);
        assert_eq!(path.vertices.len(), 4);
        assert!((path.length() - slot.length()).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn a_wavy_rim_keeps_within_the_tolerance_both_ways_and_gets_shorter_to_write(
            wave in 0.5..8.0f64, turns in 0.5..4.0f64, step in 0.3..3.0f64, closed in any::<bool>(),
        ) {
            let n = (200.0 / step) as u32;
            let rim = (0..=n).map(|k| {
                let x = 200.0 * f64::from(k) / f64::from(n);
                P2::new(x, wave * (x / 200.0 * turns * TAU).sin())
            });
            let ends = if closed { vec![P2::new(200.0, 40.0), P2::new(0.0, 40.0)] } else { Vec::new() };
            let path = Path { closed, ..Path::open(rim.chain(ends)) };
            let (smoothed, off) = smooth(&path, 0.02);
            prop_assert!(off <= 0.02);
            prop_assert!(smoothed.vertices.len() <= path.vertices.len());
            let (old, new): (Vec<Segment>, Vec<Segment>) = (path.segments().collect(), smoothed.segments().collect());
            let apart = |a: &Path, b: &[Segment]| curve::samples(a, 0.1).map(|p| curve::distance(b, p)).fold(0.0, f64::max);
            prop_assert!(apart(&path, &new) <= 0.021, "{}", apart(&path, &new));
            prop_assert!(apart(&smoothed, &old) <= 0.021, "{}", apart(&smoothed, &old));
            if step < 1.0 {
                prop_assert!(4 * smoothed.vertices.len() < path.vertices.len(), "{} of {}", smoothed.vertices.len(), path.vertices.len());
            }
        }
    }
}
