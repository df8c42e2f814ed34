//! Round joins too small to matter become corners.
//!
//! Where a polyline turns a few degrees, its offset joins the two lines by an arc of some thousandths of a millimetre. Sent to a machine, each
//! would be a block of its own and starve the planner's look-ahead. The corner in which the two lines meet is as good.

use crate::geom::{P2, Path, PathVertex, Segment, V2, cross};

/// A corner may reach this far beyond the arc it replaces: the last digit G-code carries.
const MAX_REACH_MM: f64 = 1e-3;

/// The neighbours of an arc are tangent to it when the corner lies this near to both lines, mm.
const TANGENT_MM: f64 = 1e-6;

/// Sharper turns than this, rad, are round on purpose; a corner there would reach out far.
const MAX_TURN_RAD: f64 = 2.5;

/// Replaces arcs between two tangent lines by the lines' common corner, where that corner lies within [`MAX_REACH_MM`] of the arc, and takes out what is
/// left of segments shorter than that.
pub(super) fn sharpen(path: Path) -> Path {
    let path = cornered(path, |radius_mm, turn_rad| {
        turn_rad < 1.0 && radius_mm / (0.5 * turn_rad).cos() - radius_mm <= MAX_REACH_MM
    });
    without_hairs(path)
}

/// Takes out segments too short to write; the ends of an open path stay where they are.
fn without_hairs(path: Path) -> Path {
    let last = path.vertices.len().saturating_sub(1);
    let mut vertices: Vec<PathVertex> = Vec::with_capacity(path.vertices.len());
    for (i, vertex) in path.vertices.iter().enumerate() {
        let next = path.vertices.get(i + 1).or(path.vertices.first().filter(|_| path.closed));
        let hair =
            next.is_some_and(|next| (next.point - vertex.point).norm() < MAX_REACH_MM && vertex.bulge.abs() < 1.0);
        let needed = !path.closed && (i == 0 || i == last);
        if needed || !hair {
            vertices.push(*vertex);
        }
    }
    if vertices.len() < 2 { path } else { Path { vertices, closed: path.closed } }
}

/// Replaces those arcs between two tangent lines by the lines' common corner that `unwanted` picks by radius, mm, and turn, rad above 0.
pub(super) fn cornered(path: Path, unwanted: impl Fn(f64, f64) -> bool) -> Path {
    let segments: Vec<Segment> = path.segments().collect();
    let n = segments.len();
    let corner = |i: usize| {
        let Segment::Arc { radius, sweep_rad, .. } = segments[i] else { return None };
        let at_end = !path.closed && (i == 0 || i + 1 >= n);
        if at_end || sweep_rad.abs() > MAX_TURN_RAD || !unwanted(radius, sweep_rad.abs()) {
            return None;
        }
        corner_of(&segments[(i + n - 1) % n], &segments[i], &segments[(i + 1) % n])
    };
    let mut vertices: Vec<PathVertex> = Vec::with_capacity(path.vertices.len());
    // The vertex after a replaced arc is the end of that arc, which the corner stands for too.
    let mut replaced = path.closed && n > 2 && corner(n - 1).is_some();
    for (i, vertex) in path.vertices.iter().enumerate() {
        let here = if i < n { corner(i) } else { None };
        match (here, replaced) {
            (Some(point), _) => vertices.push(PathVertex { point, bulge: 0.0 }),
            (None, true) => {}
            (None, false) => vertices.push(*vertex),
        }
        replaced = here.is_some();
    }
    Path { vertices, closed: path.closed }
}

/// Where the lines before and after an arc meet, if they are tangent to it.
fn corner_of(before: &Segment, arc: &Segment, after: &Segment) -> Option<P2> {
    let (Segment::Line { from: a, to: b }, Segment::Line { from: c, to: d }) = (*before, *after) else { return None };
    let Segment::Arc { from, center, radius, sweep_rad, .. } = *arc else { return None };
    let outward = nalgebra::Rotation2::new(0.5 * sweep_rad) * (from - center) / radius;
    let corner = center + outward * radius / (0.5 * sweep_rad).cos();
    let off_line = |p: P2, q: P2| {
        let along: V2 = (q - p).normalize();
        cross(along, corner - p).abs()
    };
    (off_line(a, b) < TANGENT_MM && off_line(c, d) < TANGENT_MM).then_some(corner)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line, a left turn of `turn_rad` on radius 0.1, a line.
    fn bend(turn_rad: f64) -> Path {
        let (sin, cos) = turn_rad.sin_cos();
        let end = P2::new(10.0 + 0.1 * sin, 0.1 - 0.1 * cos);
        let vertex = |point, bulge| PathVertex { point, bulge };
        let vertices = vec![
            vertex(P2::new(0.0, 0.0), 0.0),
            vertex(P2::new(10.0, 0.0), (0.25 * turn_rad).tan()),
            vertex(end, 0.0),
            vertex(end + V2::new(cos, sin) * 10.0, 0.0),
        ];
        Path { vertices, closed: false }
    }

    #[test]
    fn a_slight_turn_becomes_one_corner_and_a_sharp_one_stays_round() {
        let slight = sharpen(bend(0.2));
        assert_eq!(slight.vertices.len(), 3);
        let tangent = 0.1 * 0.1_f64.tan();
        assert!((slight.vertices[1].point - P2::new(10.0 + tangent, 0.0)).norm() < 1e-12);
        assert_eq!(sharpen(bend(0.5)), bend(0.5));
    }

    #[test]
    fn a_closed_path_is_sharpened_across_its_seam_whichever_corner_it_starts_at() {
        let mut closed = bend(0.2);
        closed.vertices.push(PathVertex { point: P2::new(0.0, 10.0), bulge: 0.0 });
        closed.closed = true;
        for first in 0..5 {
            let sharp = sharpen(closed.starting_at(first));
            assert_eq!(sharp.vertices.len(), 4, "starting at {first}");
            assert!(sharp.vertices.iter().all(|v| v.bulge == 0.0));
            assert!((sharp.length() - closed.length()).abs() < 1e-4);
        }
    }

    #[test]
    fn segments_of_less_than_a_micron_are_taken_out_and_ends_stay() {
        let points = [(0.0, 0.0), (0.0, 0.0004), (5.0, 0.0), (5.0003, 0.0003), (5.0, 5.0), (5.0, 5.0002)];
        let path = Path::open(points.map(|(x, y)| P2::new(x, y)));
        let sharp = sharpen(path.clone());
        assert_eq!((sharp.start(), sharp.end()), (path.start(), path.end()));
        assert_eq!(sharp.vertices.len(), 4);
        assert_eq!(sharpen(Path { closed: true, ..path }).vertices.len(), 3);
    }

    #[test]
    fn an_arc_that_is_not_tangent_to_its_lines_is_kept() {
        let mut kinked = bend(0.2);
        kinked.vertices[0].point.y = 1.0;
        assert_eq!(sharpen(kinked.clone()), kinked);
    }
}
