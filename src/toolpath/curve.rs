//! Points, directions and stretches along lines and arcs, and distances to them.

use crate::geom::{P2, Path, PathVertex, Segment, V2, cross, distance_to_segment};

/// Unit direction of travel at the start of a segment that has length.
pub(super) fn start_direction(segment: &Segment) -> V2 {
    direction_at(segment, 0.0)
}

/// Unit direction of travel a fraction `t` of the length along a segment that has length.
pub(super) fn direction_at(segment: &Segment, t: f64) -> V2 {
    match *segment {
        Segment::Line { from, to } => (to - from).normalize(),
        Segment::Arc { center, sweep_rad, .. } => {
            let radial = (point_at(segment, t) - center).normalize();
            V2::new(-radial.y, radial.x) * sweep_rad.signum()
        }
    }
}

/// Place and unit direction after `along_mm` of a path; a closed one is walked round and round, an open one ends at its ends.
pub(super) fn at(path: &Path, along_mm: f64) -> Option<(P2, V2)> {
    let total = path.length();
    let mut left = if path.closed { along_mm.rem_euclid(total) } else { along_mm.clamp(0.0, total) };
    let mut last = None;
    for segment in path.segments() {
        let length = segment.length();
        if length <= 0.0 {
            continue;
        }
        if left <= length {
            return Some((point_at(&segment, left / length), direction_at(&segment, left / length)));
        }
        left -= length;
        last = Some(segment);
    }
    last.map(|s| (s.to(), direction_at(&s, 1.0)))
}

/// The open path from `from_mm` to `to_mm` along a path; on a closed one both may lie beyond its seam, on an open one they are kept inside.
pub(super) fn stretch(path: &Path, from_mm: f64, to_mm: f64) -> Path {
    let total = path.length();
    let (from, to) = if path.closed {
        let from = from_mm.rem_euclid(total);
        (from, from + (to_mm - from_mm))
    } else {
        (from_mm.clamp(0.0, total), to_mm.clamp(0.0, total))
    };
    let mut vertices: Vec<PathVertex> = Vec::new();
    let mut end = None;
    let segments: Vec<Segment> = path.segments().collect();
    let rounds = if path.closed && total > 0.0 { (to / total).ceil().max(1.0) as usize } else { 1 };
    let mut at = 0.0;
    for segment in segments.iter().cycle().take(rounds * segments.len()) {
        let length = segment.length();
        let (begin, finish) = (from.max(at), to.min(at + length));
        if finish > begin && length > 0.0 {
            let (t0, t1) = ((begin - at) / length, (finish - at) / length);
            let bulge = match *segment {
                Segment::Line { .. } => 0.0,
                Segment::Arc { sweep_rad, .. } => (0.25 * sweep_rad * (t1 - t0)).tan(),
            };
            vertices.push(PathVertex { point: point_at(segment, t0), bulge });
            end = Some(point_at(segment, t1));
        }
        at += length;
    }
    vertices.extend(end.map(|point| PathVertex { point, bulge: 0.0 }));
    Path { vertices, closed: false }.deduplicated()
}

/// The point a fraction `t` of the length along a segment.
pub(super) fn point_at(segment: &Segment, t: f64) -> P2 {
    match *segment {
        Segment::Line { from, to } => from + (to - from) * t,
        Segment::Arc { from, center, sweep_rad, .. } => {
            center + nalgebra::Rotation2::new(sweep_rad * t) * (from - center)
        }
    }
}

/// Points along a path at most `step_mm` apart, corners and the middle of every segment included.
pub(super) fn samples(path: &Path, step_mm: f64) -> impl Iterator<Item = P2> + '_ {
    path.end().into_iter().chain(path.segments().flat_map(move |segment| {
        let half = (segment.length() / (2.0 * step_mm)).ceil().max(1.0);
        let count = 2 * half as u32;
        (0..count).map(move |k| point_at(&segment, f64::from(k) / f64::from(count)))
    }))
}

/// Distance from a point to the nearest of some segments; infinite for none.
pub(super) fn distance(segments: &[Segment], p: P2) -> f64 {
    segments.iter().map(|s| distance_to_one(s, p)).fold(f64::INFINITY, f64::min)
}

fn distance_to_one(segment: &Segment, p: P2) -> f64 {
    match *segment {
        Segment::Line { from, to } => distance_to_segment(p, from, to),
        Segment::Arc { from, to, center, radius, sweep_rad } => {
            let (start, v) = (from - center, p - center);
            let turn = cross(start, v).atan2(start.dot(&v)) * sweep_rad.signum();
            if turn.rem_euclid(std::f64::consts::TAU) <= sweep_rad.abs() {
                (v.norm() - radius).abs()
            } else {
                (p - from).norm().min((p - to).norm())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::PathVertex;

    fn half_circle(bulge: f64) -> Segment {
        let vertices =
            vec![PathVertex { point: P2::new(1.0, 0.0), bulge }, PathVertex { point: P2::new(-1.0, 0.0), bulge: 0.0 }];
        Path { vertices, closed: false }.segments().next().unwrap()
    }

    #[test]
    fn distance_to_an_arc_counts_its_swept_side_only() {
        let upper = half_circle(1.0);
        assert!((distance(&[upper], P2::new(0.0, 3.0)) - 2.0).abs() < 1e-12);
        assert!((distance(&[upper], P2::new(0.0, -3.0)) - 10.0_f64.sqrt()).abs() < 1e-12);
        let lower = half_circle(-1.0);
        assert!((distance(&[lower], P2::new(0.0, -3.0)) - 2.0).abs() < 1e-12);
        assert!((distance(&[lower, upper], P2::new(0.0, 3.0)) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn stretches_add_up_and_run_over_the_seam() {
        let circle = Path::circle(P2::origin(), 10.0);
        let total = circle.length();
        let part = stretch(&circle, 0.9 * total, 1.2 * total);
        assert!(!part.closed && (part.length() - 0.3 * total).abs() < 1e-9);
        let (from, _) = at(&circle, 0.9 * total).unwrap();
        let (to, heading) = at(&circle, 0.2 * total).unwrap();
        assert!((part.start().unwrap() - from).norm() < 1e-9 && (part.end().unwrap() - to).norm() < 1e-9);
        assert!(heading.dot(&to.coords).abs() < 1e-9);
        let line = Path::open([P2::new(0.0, 0.0), P2::new(4.0, 0.0), P2::new(4.0, 3.0)]);
        assert_eq!(stretch(&line, 3.0, 99.0).vertices.len(), 3);
    }

    #[test]
    fn points_and_directions_follow_the_sweep() {
        assert!((point_at(&half_circle(1.0), 0.5) - P2::new(0.0, 1.0)).norm() < 1e-12);
        assert!((point_at(&half_circle(-1.0), 0.5) - P2::new(0.0, -1.0)).norm() < 1e-12);
        assert!((start_direction(&half_circle(-1.0)) - V2::new(0.0, -1.0)).norm() < 1e-12);
    }
}
