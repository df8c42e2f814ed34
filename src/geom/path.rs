//! Curves of lines and circular arcs.

use super::{Motion, P2, Rect, V2, cross, tolerance};
use lyon::geom::{Angle, Arc, point, vector};

/// A corner of a [`Path`] and the shape of the way to the next corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathVertex {
    /// Where the corner is.
    pub point: P2,
    /// tan(sweep / 4) of the arc to the next corner: 0 is straight, positive turns counter-clockwise, 1 is a half circle (the DXF convention).
    pub bulge: f64,
}

/// An open or closed curve of lines and arcs. A closed path runs from its last vertex back to its first without repeating it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Path {
    /// Corners in order.
    pub vertices: Vec<PathVertex>,
    /// Whether the last corner joins the first.
    pub closed: bool,
}

/// One piece of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// A straight line.
    Line {
        /// Start.
        from: P2,
        /// End.
        to: P2,
    },
    /// A circular arc.
    Arc {
        /// Start.
        from: P2,
        /// End.
        to: P2,
        /// Centre of the circle.
        center: P2,
        /// Radius, positive.
        radius: f64,
        /// Signed turn in rad, positive counter-clockwise.
        sweep_rad: f64,
    },
}

impl Segment {
    fn new(from: PathVertex, to: P2) -> Segment {
        let chord = to - from.point;
        let bulge = from.bulge;
        // The sagitta is |bulge| * chord / 2: below a nanometre the arc is its chord.
        if bulge.abs() * chord.norm() < 1e-6 {
            return Segment::Line { from: from.point, to };
        }
        let sweep_rad = 4.0 * bulge.atan();
        let left = V2::new(-chord.y, chord.x);
        let center = from.point + chord * 0.5 + left * ((1.0 - bulge * bulge) / (4.0 * bulge));
        let radius = chord.norm() * (1.0 + bulge * bulge) / (4.0 * bulge.abs());
        Segment::Arc { from: from.point, to, center, radius, sweep_rad }
    }

    /// Start point.
    pub fn from(&self) -> P2 {
        match *self {
            Segment::Line { from, .. } | Segment::Arc { from, .. } => from,
        }
    }

    /// End point.
    pub fn to(&self) -> P2 {
        match *self {
            Segment::Line { to, .. } | Segment::Arc { to, .. } => to,
        }
    }

    /// Length along the curve.
    pub fn length(&self) -> f64 {
        match *self {
            Segment::Line { from, to } => (to - from).norm(),
            Segment::Arc { radius, sweep_rad, .. } => radius * sweep_rad.abs(),
        }
    }

    fn lyon_arc(&self) -> Option<Arc<f64>> {
        match *self {
            Segment::Line { .. } => None,
            Segment::Arc { from, center, radius, sweep_rad, .. } => Some(Arc {
                center: point(center.x, center.y),
                radii: vector(radius, radius),
                start_angle: Angle::radians((from.y - center.y).atan2(from.x - center.x)),
                sweep_angle: Angle::radians(sweep_rad),
                x_rotation: Angle::zero(),
            }),
        }
    }

    /// The smallest box around the curve, arcs bulging as far as they do.
    pub fn bounds(&self) -> Rect {
        let ends = Rect::EMPTY.with(self.from()).with(self.to());
        match self.lyon_arc() {
            None => ends,
            Some(arc) => {
                let b = arc.bounding_box();
                ends.union(Rect { min: P2::new(b.min.x, b.min.y), max: P2::new(b.max.x, b.max.y) })
            }
        }
    }

    /// Appends chords within `tolerance` of the curve, without the start point.
    fn flatten_into(&self, tolerance: f64, points: &mut Vec<P2>) {
        if let Some(arc) = self.lyon_arc() {
            arc.for_each_flattened(tolerance, &mut |line| points.push(P2::new(line.to.x, line.to.y)));
            points.pop();
        }
        points.push(self.to());
    }
}

impl Path {
    /// An open path of straight lines.
    pub fn open(points: impl IntoIterator<Item = P2>) -> Path {
        Path { vertices: straight(points), closed: false }
    }

    /// A closed path of straight lines; the first point is not repeated.
    pub fn closed(points: impl IntoIterator<Item = P2>) -> Path {
        Path { vertices: straight(points), closed: true }
    }

    /// A full circle, counter-clockwise, as two half circles.
    pub fn circle(center: P2, radius: f64) -> Path {
        let side = V2::new(radius, 0.0);
        let half = |point| PathVertex { point, bulge: 1.0 };
        Path { vertices: vec![half(center - side), half(center + side)], closed: true }
    }

    /// The curve's pieces in order; none for fewer than two corners.
    pub fn segments(&self) -> impl Iterator<Item = Segment> + '_ {
        let n = self.vertices.len();
        let count = if n < 2 { 0 } else { n - usize::from(!self.closed) };
        (0..count).map(move |i| Segment::new(self.vertices[i], self.vertices[(i + 1) % n].point))
    }

    /// First point, if there is one.
    pub fn start(&self) -> Option<P2> {
        self.vertices.first().map(|v| v.point)
    }

    /// Where a tool that follows the path ends: the last corner, or the first again when closed.
    pub fn end(&self) -> Option<P2> {
        if self.closed { self.start() } else { self.vertices.last().map(|v| v.point) }
    }

    /// Length along the curve.
    pub fn length(&self) -> f64 {
        self.segments().map(|s| s.length()).sum()
    }

    /// The smallest box around the curve.
    pub fn bounds(&self) -> Rect {
        let corners = Rect::around(self.vertices.iter().map(|v| &v.point));
        self.segments().fold(corners, |rect, s| rect.union(s.bounds()))
    }

    /// Points of a polyline within `tolerance` of the curve. A closed path's first point is not repeated.
    pub fn flatten(&self, tolerance: f64) -> Vec<P2> {
        let mut points: Vec<P2> = self.start().into_iter().collect();
        for segment in self.segments() {
            segment.flatten_into(tolerance, &mut points);
        }
        if self.closed && points.len() > 1 {
            points.pop();
        }
        points
    }

    /// Area to the left of a closed path: positive when it runs counter-clockwise. Exact for arcs; 0 for an open path.
    pub fn signed_area(&self) -> f64 {
        if !self.closed {
            return 0.0;
        }
        self.segments()
            .map(|s| {
                let chord = 0.5 * cross(s.from().coords, s.to().coords);
                match s {
                    Segment::Line { .. } => chord,
                    Segment::Arc { radius, sweep_rad, .. } => {
                        chord + 0.5 * radius * radius * (sweep_rad - sweep_rad.sin())
                    }
                }
            })
            .sum()
    }

    /// The same curve run backwards. A closed path keeps its first corner.
    pub fn reversed(&self) -> Path {
        let n = self.vertices.len();
        let vertices = (0..n)
            .map(|k| {
                let (i, into_i) =
                    if self.closed { ((n - k) % n, (2 * n - k - 1) % n) } else { (n - 1 - k, (2 * n - k - 2) % n) };
                PathVertex { point: self.vertices[i].point, bulge: -self.vertices[into_i].bulge }
            })
            .collect();
        Path { vertices, closed: self.closed }
    }

    /// A closed path that starts at corner `first` instead; open paths are returned as they are.
    pub fn starting_at(&self, first: usize) -> Path {
        let mut path = self.clone();
        if self.closed && !path.vertices.is_empty() {
            let n = path.vertices.len();
            path.vertices.rotate_left(first % n);
        }
        path
    }

    /// The curve after a turn and a shift.
    pub fn moved(&self, motion: &Motion) -> Path {
        let vertices = self.vertices.iter().map(|v| PathVertex { point: motion * v.point, bulge: v.bulge }).collect();
        Path { vertices, closed: self.closed }
    }

    /// The curve without corners that repeat their predecessor.
    pub fn deduplicated(mut self) -> Path {
        self.vertices.dedup_by(|next, kept| {
            let same = (next.point - kept.point).norm() < tolerance::SAME_POINT_MM;
            if same {
                kept.bulge = next.bulge;
            }
            same
        });
        while self.closed && self.vertices.len() > 1 {
            let (first, last) = (self.vertices[0], self.vertices[self.vertices.len() - 1]);
            if (first.point - last.point).norm() >= tolerance::SAME_POINT_MM {
                break;
            }
            self.vertices.pop();
        }
        self
    }
}

fn straight(points: impl IntoIterator<Item = P2>) -> Vec<PathVertex> {
    points.into_iter().map(|point| PathVertex { point, bulge: 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn half_disc() -> Path {
        Path {
            vertices: vec![
                PathVertex { point: P2::new(1.0, 0.0), bulge: 1.0 },
                PathVertex { point: P2::new(-1.0, 0.0), bulge: 0.0 },
            ],
            closed: true,
        }
    }

    #[test]
    fn a_half_disc_has_the_length_area_and_bounds_of_the_closed_form() {
        let path = half_disc();
        assert!((path.length() - (PI + 2.0)).abs() < 1e-12);
        assert!((path.signed_area() - PI / 2.0).abs() < 1e-12);
        let bounds = path.bounds();
        assert!((bounds.max.y - 1.0).abs() < 1e-9 && bounds.min.y.abs() < 1e-9);
    }

    #[test]
    fn running_a_path_backwards_negates_its_area_and_keeps_its_start() {
        let back = half_disc().reversed();
        assert!((back.signed_area() + PI / 2.0).abs() < 1e-12);
        assert_eq!(back.start(), half_disc().start());
        let open = Path { closed: false, ..half_disc() };
        assert_eq!(open.reversed().start(), open.end());
        assert!((open.reversed().length() - PI).abs() < 1e-12);
        assert_eq!(open.reversed().reversed().segments().next(), open.segments().next());
    }

    #[test]
    fn chords_stay_within_the_tolerance_of_a_circle() {
        let points = Path::circle(P2::new(3.0, 4.0), 50.0).flatten(0.01);
        let n = points.len();
        for i in 0..n {
            let middle = nalgebra::center(&points[i], &points[(i + 1) % n]);
            let sagitta = 50.0 - (middle - P2::new(3.0, 4.0)).norm();
            assert!((-1e-9..0.0101).contains(&sagitta), "sagitta {sagitta}");
        }
    }

    #[test]
    fn moving_a_path_keeps_length_and_area() {
        let motion = Motion::new(V2::new(5.0, -2.0), 0.7);
        let moved = half_disc().moved(&motion);
        assert!((moved.length() - half_disc().length()).abs() < 1e-12);
        assert!((moved.signed_area() - half_disc().signed_area()).abs() < 1e-12);
    }

    #[test]
    fn repeated_corners_are_dropped() {
        let p = |x| P2::new(x, 0.0);
        let path = Path::closed([p(0.0), p(0.0), p(1.0), P2::new(1.0, 1.0), p(0.0)]).deduplicated();
        assert_eq!(path.vertices.len(), 3);
    }
}
