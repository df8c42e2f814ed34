//! Rounding the corners of a polyline.

use super::{P2, Path, PathVertex, cross};

impl Path {
    /// Straight lines through `corners`, each corner rounded by an arc of its radius (0 keeps it sharp). Where the neighbouring lines are too short for a
    /// radius, the arc is made as large as half of them allows.
    pub fn rounded(corners: &[(P2, f64)], closed: bool) -> Path {
        let n = corners.len();
        let mut vertices = Vec::with_capacity(2 * n);
        for (i, (corner, radius)) in corners.iter().copied().enumerate() {
            let at_end = !closed && (i == 0 || i + 1 == n);
            let back = corners[(i + n - 1) % n].0 - corner;
            let on = corners[(i + 1) % n].0 - corner;
            let turn = cross(-back, on).atan2((-back).dot(&on));
            let room = 0.5 * back.norm().min(on.norm());
            // Tangent length of a fillet: r tan(turn / 2).
            let tangent = (radius * (turn / 2.0).tan().abs()).min(room);
            if at_end || tangent < super::tolerance::SAME_POINT_MM {
                vertices.push(PathVertex { point: corner, bulge: 0.0 });
            } else {
                vertices.push(PathVertex { point: corner + back.normalize() * tangent, bulge: (turn / 4.0).tan() });
                vertices.push(PathVertex { point: corner + on.normalize() * tangent, bulge: 0.0 });
            }
        }
        Path { vertices, closed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_rounded_square_loses_the_corners_of_the_closed_form() {
        let corners = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|(x, y)| (P2::new(x, y), 2.0));
        let path = Path::rounded(&corners, true);
        assert!((path.signed_area() - (100.0 - (4.0 - PI) * 4.0)).abs() < 1e-9);
        assert!((path.length() - (40.0 - 16.0 + 4.0 * PI)).abs() < 1e-9);
    }

    #[test]
    fn an_open_path_keeps_its_ends_and_short_lines_get_smaller_arcs() {
        let corners = [(0.0, 0.0), (10.0, 0.0), (10.0, 1.0)].map(|(x, y)| (P2::new(x, y), 5.0));
        let path = Path::rounded(&corners, false);
        assert_eq!((path.start(), path.end()), (Some(P2::new(0.0, 0.0)), Some(P2::new(10.0, 1.0))));
        assert!(path.vertices.iter().any(|v| (v.point - P2::new(9.5, 0.0)).norm() < 1e-9));
    }
}
