//! How thick a region is.

use super::{P2, V2, convex_hull};

/// Thickness of a region of that area with these corners: the area over the long side of the smallest rectangle around them. What lies between two sheets is as
/// thick as it would be if it were a rectangle, however it is turned or bent.
pub fn thickness(area: f64, corners: &[P2]) -> f64 {
    area / long_side(corners)
}

/// Long side of the smallest rectangle around points; 1 where they span none.
pub fn long_side(points: &[P2]) -> f64 {
    let hull = convex_hull(points);
    let n = hull.len();
    let sides = (0..n).filter_map(|i| (hull[(i + 1) % n] - hull[i]).try_normalize(1e-12));
    let boxes = sides.map(|u| {
        let extent = |axis: V2| {
            let along = hull.iter().map(|p| p.coords.dot(&axis));
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            high - low
        };
        let (a, b) = (extent(u), extent(V2::new(-u.y, u.x)));
        (a * b, a.max(b))
    });
    boxes.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(1.0, |(_, long)| long)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_is_as_thick_as_its_short_side_however_it_is_turned() {
        for angle in [0.0, 0.3, 1.1, 2.0] {
            let turn = nalgebra::Rotation2::new(angle);
            let corners = [(0.0, 0.0), (40.0, 0.0), (40.0, 9.0), (0.0, 9.0)].map(|(x, y)| turn * P2::new(x, y));
            assert!((long_side(&corners) - 40.0).abs() < 1e-9);
            assert!((thickness(360.0, &corners) - 9.0).abs() < 1e-9);
        }
    }
}
