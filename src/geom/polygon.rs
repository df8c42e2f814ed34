//! Polygons and segments. A loop is a list of points, closed without repeating the first.

use super::{P2, V2, cross};

/// Area of a loop, positive when it runs counter-clockwise.
pub fn signed_area(points: &[P2]) -> f64 {
    let n = points.len();
    (0..n).map(|i| 0.5 * cross(points[i].coords, points[(i + 1) % n].coords)).sum()
}

/// True when `p` lies inside the loop (even-odd rule). Points on the border may fall on either side.
pub fn contains(points: &[P2], p: P2) -> bool {
    let n = points.len();
    let mut inside = false;
    for i in 0..n {
        let (a, b) = (points[i], points[(i + 1) % n]);
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    inside
}

/// The point of segment `a b` nearest to `p`, and its parameter in 0..=1.
pub fn closest_on_segment(p: P2, a: P2, b: P2) -> (P2, f64) {
    let ab = b - a;
    let length_squared = ab.norm_squared();
    let t = if length_squared > 0.0 { ((p - a).dot(&ab) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    (a + ab * t, t)
}

/// Distance from `p` to segment `a b`.
pub fn distance_to_segment(p: P2, a: P2, b: P2) -> f64 {
    (closest_on_segment(p, a, b).0 - p).norm()
}

/// Distance from `p` to the nearest border point of the loop; infinite for an empty loop.
pub fn distance_to_loop(points: &[P2], p: P2) -> f64 {
    let n = points.len();
    (0..n).map(|i| distance_to_segment(p, points[i], points[(i + 1) % n])).fold(f64::INFINITY, f64::min)
}

/// True when the open segments `a b` and `c d` pass through each other: touching ends and shared lines do not count.
pub fn segments_cross(a: P2, b: P2, c: P2, d: P2) -> bool {
    let (low, high) = (a.inf(&b).sup(&c.inf(&d)), a.sup(&b).inf(&c.sup(&d)));
    // Boxes first: on one common line, far apart, the signs below are round-off.
    if low.x > high.x || low.y > high.y {
        return false;
    }
    let side = |p: P2, q: P2, r: P2| cross(q - p, r - p);
    let (s1, s2) = (side(a, b, c), side(a, b, d));
    let (s3, s4) = (side(c, d, a), side(c, d, b));
    s1 * s2 < 0.0 && s3 * s4 < 0.0
}

/// Corners of the convex hull, counter-clockwise (Andrew's monotone chain).
pub fn convex_hull(points: &[P2]) -> Vec<P2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let chain = |points: &mut dyn Iterator<Item = &P2>| {
        let mut hull: Vec<P2> = Vec::new();
        for p in points {
            while let [.., a, b] = hull[..] {
                let (ab, ap): (V2, V2) = (b - a, p - a);
                if cross(ab, ap) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(*p);
        }
        hull.pop();
        hull
    };
    let mut hull = chain(&mut sorted.iter());
    hull.extend(chain(&mut sorted.iter().rev()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<P2> {
        [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(|(x, y)| P2::new(x, y)).to_vec()
    }

    #[test]
    fn a_square_knows_its_area_inside_and_distance() {
        assert_eq!(signed_area(&square()), 4.0);
        assert!(contains(&square(), P2::new(1.0, 1.9)));
        assert!(!contains(&square(), P2::new(-0.1, 1.0)));
        assert!((distance_to_loop(&square(), P2::new(1.0, 1.5)) - 0.5).abs() < 1e-12);
        assert!((distance_to_loop(&square(), P2::new(5.0, 6.0)) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn only_segments_that_pass_through_each_other_cross() {
        let p = |x, y| P2::new(x, y);
        assert!(segments_cross(p(0.0, 0.0), p(2.0, 2.0), p(0.0, 2.0), p(2.0, 0.0)));
        assert!(!segments_cross(p(0.0, 0.0), p(2.0, 2.0), p(2.0, 2.0), p(3.0, 0.0)));
        assert!(!segments_cross(p(0.0, 0.0), p(2.0, 0.0), p(1.0, 0.0), p(1.0, 1.0)));
        let line = |t: f64| p(0.3 * t, 0.1 * t);
        assert!(!segments_cross(line(1.1), line(2.3), line(7.7), line(9.1)));
    }

    #[test]
    fn the_hull_drops_inner_and_collinear_points() {
        let mut points = square();
        points.extend([P2::new(1.0, 1.0), P2::new(1.0, 0.0)]);
        let hull = convex_hull(&points);
        assert_eq!(hull.len(), 4);
        assert!(signed_area(&hull) > 0.0);
    }
}
