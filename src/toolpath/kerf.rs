//! Moves a path to its waste side by half the kerf, keeping arcs as arcs.
//!
//! The offset itself is cavalier_contours' (positive to the left of the direction of travel, arcs as bulges like ours). Its result is not
//! trusted but measured: every point of the moved path must lie half a kerf from the nominal curve, and every point of the nominal curve must
//! be within reach of the moved path.

use super::{Error, curve, mitre};
use crate::drawing::{DrawnPath, KerfSide};
use crate::geom::{P2, Path, PathVertex, Segment, V2, tolerance};
use cavalier_contours::polyline::{PlineOffsetOptions, PlineSource, PlineSourceMut, Polyline};

/// Largest deviation from half the kerf: less than half a step of an axis at 80 steps/mm (0.0125 mm), and well below the 0.01 mm to which a
/// kerf is known.
const MAX_DEVIATION_MM: f64 = 0.005;

/// Nominal points may lie this much farther from the tool than half the kerf: in a concave corner of angle a, a round beam stays away by
/// half the kerf / sin(a / 2), which for 0.15 mm of kerf is this much at 15 degrees. Beyond it a detail is lost.
const MAX_HIDDEN_MM: f64 = 0.5;

/// Distance between checked points, mm: shorter than any flap's edge.
const SAMPLE_MM: f64 = 1.0;

/// A path after the kerf.
pub(super) struct Compensated {
    pub(super) path: Path,
    /// Greatest difference of its distance to the nominal curve from half the kerf, mm.
    pub(super) deviation_mm: f64,
}

/// Moves a drawn path by half the kerf to its waste side; paths to be followed as they are come back without repeated corners.
pub(super) fn compensate(drawn: &DrawnPath, piece: &str, kerf_mm: f64) -> Result<Compensated, Error> {
    let role = drawn.role.class();
    let flawed = |flaw| Error::Path { piece: piece.to_string(), role, flaw };
    if !drawn.path.vertices.iter().all(|v| v.point.x.is_finite() && v.point.y.is_finite() && v.bulge.is_finite()) {
        return Err(flawed("it has a coordinate or bulge that is not a finite number"));
    }
    let nominal = without_long_arcs(drawn.path.clone().deduplicated());
    if nominal.vertices.len() < 2 || nominal.length() < tolerance::SAME_POINT_MM {
        return Err(flawed("it has no length"));
    }
    let to_left_mm = match (drawn.kerf, nominal.closed) {
        (KerfSide::On, _) => 0.0,
        (KerfSide::Left, _) => 0.5 * kerf_mm,
        (KerfSide::Right, _) => -0.5 * kerf_mm,
        (KerfSide::Outside | KerfSide::Inside, false) => {
            return Err(flawed("it is open, but its kerf side is outside or inside; close it"));
        }
        (KerfSide::Outside | KerfSide::Inside, true) => {
            let area = nominal.signed_area();
            if area == 0.0 {
                return Err(flawed("it encloses no area, so it has no outside"));
            }
            let outward = if area > 0.0 { -0.5 * kerf_mm } else { 0.5 * kerf_mm };
            if drawn.kerf == KerfSide::Outside { outward } else { -outward }
        }
    };
    if to_left_mm == 0.0 {
        return Ok(Compensated { path: nominal, deviation_mm: 0.0 });
    }

    let mut moved = offset(&nominal, to_left_mm);
    let parts = moved.len();
    let path = match moved.pop() {
        Some(path) if parts == 1 && path.closed == nominal.closed => mitre::sharpen(path),
        _ => return Err(Error::Split { piece: piece.to_string(), role, parts, kerf_mm }),
    };
    let deviation_mm = deviation(&nominal, &path, 0.5 * kerf_mm);
    if deviation_mm > MAX_DEVIATION_MM {
        let piece = piece.to_string();
        return Err(Error::Deviation { piece, role, deviation_mm, limit_mm: MAX_DEVIATION_MM });
    }
    if let Some((at, distance_mm)) = hidden(&nominal, &path, to_left_mm) {
        let piece = piece.to_string();
        return Err(Error::Hidden { piece, role, kerf_mm, x_mm: at.x, y_mm: at.y, distance_mm });
    }
    Ok(Compensated { path, deviation_mm })
}

/// Halves arcs of more than a half circle, which the offset does not take.
fn without_long_arcs(path: Path) -> Path {
    let mut vertices = Vec::with_capacity(path.vertices.len());
    let ends = path.segments().map(Some).chain([None]);
    for (vertex, segment) in path.vertices.iter().zip(ends) {
        match segment {
            Some(segment) if vertex.bulge.abs() > 1.0 => {
                let bulge = (0.5 * vertex.bulge.atan()).tan();
                vertices.push(PathVertex { point: vertex.point, bulge });
                vertices.push(PathVertex { point: curve::point_at(&segment, 0.5), bulge });
            }
            _ => vertices.push(*vertex),
        }
    }
    Path { vertices, closed: path.closed }
}

fn offset(path: &Path, to_left_mm: f64) -> Vec<Path> {
    let mut source = if path.closed { Polyline::new_closed() } else { Polyline::new() };
    for vertex in &path.vertices {
        source.add(vertex.point.x, vertex.point.y, vertex.bulge);
    }
    let options = PlineOffsetOptions { handle_self_intersects: true, ..PlineOffsetOptions::default() };
    let results = source.parallel_offset_opt(to_left_mm, &options);
    let back = |result: &Polyline<f64>| {
        let vertices = result.iter_vertexes().map(|v| PathVertex { point: P2::new(v.x, v.y), bulge: v.bulge });
        Path { vertices: vertices.collect(), closed: result.is_closed() }.deduplicated()
    };
    results.iter().map(back).collect()
}

/// Greatest | distance from the moved path to the nominal curve - half the kerf |, mm.
fn deviation(nominal: &Path, moved: &Path, half_kerf_mm: f64) -> f64 {
    let segments: Vec<Segment> = nominal.segments().collect();
    curve::samples(moved, SAMPLE_MM).map(|p| (curve::distance(&segments, p) - half_kerf_mm).abs()).fold(0.0, f64::max)
}

/// The nominal point the moved path leaves out worst, and how far away it stays; `None` when all is within reach.
fn hidden(nominal: &Path, moved: &Path, to_left_mm: f64) -> Option<(P2, f64)> {
    let segments: Vec<Segment> = moved.segments().collect();
    if !nominal.closed {
        // An open cut keeps its ends: each moves square to the curve, or the flap's root would move.
        let backwards = nominal.reversed();
        let expected = |path: &Path, to_left_mm: f64| {
            let first = path.segments().next()?;
            let ahead = curve::start_direction(&first);
            Some(first.from() + V2::new(-ahead.y, ahead.x) * to_left_mm)
        };
        let wanted = [expected(nominal, to_left_mm), expected(&backwards, -to_left_mm)];
        let found = [moved.start(), moved.end()];
        for (wanted, found) in wanted.into_iter().flatten().zip(found.into_iter().flatten()) {
            if (wanted - found).norm() > MAX_DEVIATION_MM {
                return Some((wanted, (wanted - found).norm()));
            }
        }
    }
    let limit = to_left_mm.abs() + MAX_HIDDEN_MM;
    curve::samples(nominal, SAMPLE_MM)
        .map(|p| (p, curve::distance(&segments, p)))
        .filter(|(_, distance)| *distance > limit)
        .max_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Role;
    use crate::geom::contains;
    use proptest::prelude::*;
    use std::f64::consts::{PI, TAU};

    fn run(path: Path, kerf: KerfSide, kerf_mm: f64) -> Result<Compensated, Error> {
        let role = if path.closed { Role::Outline } else { Role::Flap };
        compensate(&DrawnPath { path, role, kerf, joint: None }, "A1", kerf_mm)
    }

    fn points<const N: usize>(points: [(f64, f64); N]) -> [P2; N] {
        points.map(|(x, y)| P2::new(x, y))
    }

    #[test]
    fn an_outline_is_cut_on_its_outside_and_a_hole_on_its_inside_whichever_way_they_run() {
        let square = Path::closed(points([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]));
        for path in [square.clone(), square.reversed()] {
            // Outside, corners are rounded by the beam: sides of 10 and a circle of half the kerf.
            let outline = run(path.clone(), KerfSide::Outside, 0.2).unwrap();
            assert!((outline.path.signed_area().abs() - (100.0 + 4.0 + PI * 0.01)).abs() < 1e-6);
            assert!(outline.path.vertices.iter().any(|v| v.bulge != 0.0), "corners are arcs");
            let hole = run(path, KerfSide::Inside, 0.2).unwrap();
            assert!((hole.path.signed_area().abs() - 9.8 * 9.8).abs() < 1e-6);
        }
    }

    #[test]
    fn a_circle_stays_two_arcs_of_the_smaller_radius() {
        let hole = run(Path::circle(P2::new(5.0, 5.0), 3.0), KerfSide::Inside, 0.3).unwrap();
        assert_eq!(hole.path.vertices.len(), 2);
        assert!((hole.path.length() - TAU * 2.85).abs() < 1e-9);
    }

    #[test]
    fn an_open_flap_cut_moves_to_its_waste_side_with_its_ends_square() {
        let flap = || Path::open(points([(0.0, 0.0), (0.0, 8.0), (6.0, 8.0), (6.0, 0.0)]));
        // Up, right, down: the waste of a flap inside lies on the left.
        let left = run(flap(), KerfSide::Left, 0.2).unwrap().path;
        assert!((left.start().unwrap() - P2::new(-0.1, 0.0)).norm() < 1e-9);
        assert!((left.end().unwrap() - P2::new(6.1, 0.0)).norm() < 1e-9);
        assert!((left.bounds().max.y - 8.1).abs() < 1e-9);
        let right = run(flap(), KerfSide::Right, 0.2).unwrap().path;
        assert!((right.start().unwrap() - P2::new(0.1, 0.0)).norm() < 1e-9);
        assert!((right.end().unwrap() - P2::new(5.9, 0.0)).norm() < 1e-9);
        assert!((right.bounds().max.y - 7.9).abs() < 1e-9);
    }

    #[test]
    fn a_slit_is_followed_as_it_is() {
        let slit = Path::open(points([(0.0, 0.0), (0.0, 8.0)]));
        assert_eq!(run(slit.clone(), KerfSide::On, 0.2).unwrap().path, slit);
        assert_eq!(run(slit.clone(), KerfSide::Left, 0.0).unwrap().path, slit);
    }

    #[test]
    fn an_arc_beyond_a_half_circle_is_offset_too() {
        let vertices = vec![
            PathVertex { point: P2::new(1.0, 0.0), bulge: (1.5 * PI / 4.0).tan() },
            PathVertex { point: P2::new(0.0, -1.0), bulge: 0.0 },
        ];
        let moved = run(Path { vertices, closed: false }, KerfSide::Right, 0.2).unwrap();
        assert!((moved.path.length() - 1.5 * PI * 1.1).abs() < 1e-9);
    }

    #[test]
    fn what_the_kerf_eats_breaks_or_hides_is_an_error_with_the_piece() {
        let tiny = Path::circle(P2::origin(), 0.05);
        assert!(matches!(run(tiny, KerfSide::Inside, 0.2), Err(Error::Split { parts: 0, .. })));
        // Two chambers with a neck of 0.1 mm between them.
        let dumbbell = Path::closed(points([
            (0.0, 0.0),
            (5.0, 0.0),
            (5.0, 2.0),
            (8.0, 2.0),
            (8.0, 0.0),
            (13.0, 0.0),
            (13.0, 4.0),
            (8.0, 4.0),
            (8.0, 2.1),
            (5.0, 2.1),
            (5.0, 4.0),
            (0.0, 4.0),
        ]));
        let error = run(dumbbell, KerfSide::Inside, 0.2).err().expect("split");
        assert!(matches!(error, Error::Split { parts: 2, .. }));
        assert!(error.to_string().contains("A1"));
        // A notch of 0.1 mm that the beam cannot enter from outside.
        let notched = Path::closed(points([
            (0.0, 0.0),
            (10.0, 0.0),
            (10.0, 5.0),
            (5.1, 5.0),
            (5.1, 2.0),
            (5.0, 2.0),
            (5.0, 5.0),
            (0.0, 5.0),
        ]));
        assert!(matches!(run(notched, KerfSide::Outside, 0.2), Err(Error::Hidden { .. })));
        let open = Path::open(points([(0.0, 0.0), (1.0, 0.0)]));
        assert!(matches!(run(open, KerfSide::Outside, 0.2), Err(Error::Path { .. })));
        let dot = Path::open(points([(1.0, 1.0), (1.0, 1.0)]));
        assert!(matches!(run(dot, KerfSide::On, 0.2), Err(Error::Path { .. })));
    }

    prop_compose! {
        /// A ribbon's contour: a wavy band, its waves no steeper than a strip's, whose rims are sampled at 1 to 3 mm.
        fn ribbon()(
            length in 30.0..300.0f64, width in 10.0..60.0f64, steep in 0.0..0.15f64, turns in 0.5..5.0f64, step in 1.0..3.0f64,
        ) -> Path {
            let n = (length / step) as u32;
            let wave = (steep * length / turns).min(0.4 * width);
            let rim = |k: u32, up: f64| {
                let s = f64::from(k) / f64::from(n);
                P2::new(s * length, up * width + wave * (s * turns * TAU + up).sin())
            };
            Path::closed((0..=n).map(|k| rim(k, 0.0)).chain((0..=n).rev().map(|k| rim(k, 1.0))))
        }
    }

    prop_compose! {
        /// A flap's cut as strip draws it: up one side, a barbed head with round corners, down the other.
        fn flap()(neck in 6.0..12.0f64, barb in 0.8..3.0f64, r in 0.3..1.0f64, long in 4.0..10.0f64, turn in 0.0..TAU) -> Path {
            let corner = (PI / 8.0).tan();
            let at = |x, y, bulge| PathVertex { point: P2::new(x, y), bulge };
            let vertices = vec![
                at(0.0, 0.0, 0.0), at(0.0, 1.5, 0.0), at(-barb, 1.5, 0.0), at(-barb, long, -corner), at(-barb + r, long + r, 0.0),
                at(neck + barb - r, long + r, -corner), at(neck + barb, long, 0.0), at(neck + barb, 1.5, 0.0),
                at(neck, 1.5, 0.0), at(neck, 0.0, 0.0),
            ];
            Path { vertices, closed: false }.moved(&crate::geom::Motion::new(V2::new(50.0, 20.0), turn))
        }
    }

    proptest! {
        #[test]
        fn a_ribbon_keeps_half_the_kerf_outside_everywhere(path in ribbon(), kerf_mm in 0.05..0.6f64, back in any::<bool>()) {
            let path = if back { path.reversed() } else { path };
            let moved = run(path.clone(), KerfSide::Outside, kerf_mm).unwrap();
            prop_assert!(moved.deviation_mm < MAX_DEVIATION_MM);
            let corners = path.flatten(0.01);
            for p in curve::samples(&moved.path, 0.7) {
                prop_assert!(!contains(&corners, p));
            }
            // Outward growth by Steiner: perimeter x kerf / 2 + pi (kerf / 2)^2, less what concave corners lose to second order.
            let d = 0.5 * kerf_mm;
            let grown = moved.path.signed_area().abs() - path.signed_area().abs();
            prop_assert!((grown - path.length() * d).abs() < 0.05 * path.length() * d + PI * d * d);
            prop_assert_eq!(path.signed_area() > 0.0, moved.path.signed_area() > 0.0);
        }

        #[test]
        fn a_flap_keeps_half_the_kerf_and_both_ends(path in flap(), kerf_mm in 0.05..0.5f64, left in any::<bool>()) {
            let side = if left { KerfSide::Left } else { KerfSide::Right };
            let moved = run(path.clone(), side, kerf_mm).unwrap();
            prop_assert!(moved.deviation_mm < MAX_DEVIATION_MM);
            prop_assert!(((moved.path.start().unwrap() - path.start().unwrap()).norm() - 0.5 * kerf_mm).abs() < 1e-6);
            prop_assert!(((moved.path.end().unwrap() - path.end().unwrap()).norm() - 0.5 * kerf_mm).abs() < 1e-6);
            // Closed along its root the flap runs clockwise: cut on the left it stays larger, on the right it comes out smaller.
            let closed_area = |p: &Path| Path { closed: true, ..p.clone() }.signed_area().abs();
            prop_assert_eq!(left, closed_area(&moved.path) > closed_area(&path));
        }
    }
}
