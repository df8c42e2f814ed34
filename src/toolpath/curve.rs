//! Points along lines and arcs, and distances to them.

use crate::geom::{P2, Path, Segment, V2, cross, distance_to_segment};

/// Unit direction of travel at the start of a segment that has length.
pub(super) fn start_direction(segment: &Segment) -> V2 {
    match *segment {
        Segment::Line { from, to } => (to - from).normalize(),
        Segment::Arc { from, center, sweep_rad, .. } => {
            let radial = (from - center).normalize();
            V2::new(-radial.y, radial.x) * sweep_rad.signum()
        }
    }
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
    fn points_and_directions_follow_the_sweep() {
        assert!((point_at(&half_circle(1.0), 0.5) - P2::new(0.0, 1.0)).norm() < 1e-12);
        assert!((point_at(&half_circle(-1.0), 0.5) - P2::new(0.0, -1.0)).norm() < 1e-12);
        assert!((start_direction(&half_circle(-1.0)) - V2::new(0.0, -1.0)).norm() < 1e-12);
    }
}
