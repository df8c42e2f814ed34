//! Polygons in space cut into triangles: faces with many corners, and lids over holes.

use crate::geom::{P2, P3, V3, cross, segments_cross};

/// Polygons with more corners are cut as a fan: finding ears takes quadratic time, and such faces come from broken files.
const MAX_EARS: usize = 2000;

/// Triangles with the polygon's corners (indices into `vertices`), walked in the same direction. Ears are cut in the plane of the polygon's
/// area vector (Meisters 1975, doi:10.2307/2319703); where a bent or crossed polygon has no ear left, the rest becomes a fan. Fewer than
/// three corners give nothing.
pub(super) fn triangulate(vertices: &[P3], corners: &[u32]) -> Vec<[u32; 3]> {
    let mut rest = corners.to_vec();
    let mut triangles = Vec::with_capacity(rest.len().saturating_sub(2));
    if rest.len() > 3 && rest.len() <= MAX_EARS {
        let flat = flattened(vertices, corners);
        let mut left: Vec<usize> = (0..corners.len()).collect();
        while left.len() > 3 {
            let Some(ear) = (0..left.len()).find(|k| is_ear(&flat, &left, *k)) else { break };
            let n = left.len();
            triangles.push([left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]].map(|i| corners[i]));
            left.remove(ear);
        }
        rest = left.into_iter().map(|i| corners[i]).collect();
    }
    triangles.extend(rest.windows(2).skip(1).map(|pair| [rest[0], pair[0], pair[1]]));
    triangles
}

/// The corners seen along the polygon's area vector (Newell), so that the polygon runs counter-clockwise.
fn flattened(vertices: &[P3], corners: &[u32]) -> Vec<P2> {
    let points: Vec<P3> = corners.iter().map(|i| vertices[*i as usize]).collect();
    let about = points[0];
    let normal: V3 =
        (0..points.len()).map(|i| (points[i] - about).cross(&(points[(i + 1) % points.len()] - about))).sum();
    let smallest = normal.iamin();
    let mut axis = V3::zeros();
    axis[smallest] = 1.0;
    let u = axis.cross(&normal).try_normalize(0.0).unwrap_or_else(V3::x);
    let v = normal.cross(&u).try_normalize(0.0).unwrap_or_else(V3::y);
    points.iter().map(|p| P2::new((p - about).dot(&u), (p - about).dot(&v))).collect()
}

/// True when corner `k` of the remaining polygon is convex and no other corner lies in its triangle.
fn is_ear(flat: &[P2], left: &[usize], k: usize) -> bool {
    let n = left.len();
    let (before, here, after) = (left[(k + n - 1) % n], left[k], left[(k + 1) % n]);
    let (a, b, c) = (flat[before], flat[here], flat[after]);
    let side = |p: P2, q: P2, r: P2| cross(q - p, r - p);
    side(a, b, c) > 0.0
        && left.iter().filter(|i| ![before, here, after].contains(i)).all(|i| {
            let p = flat[*i];
            // A corner visited twice (a slit to a hole in the face) does not block itself.
            p == a || p == b || p == c || side(a, b, p) < 0.0 || side(b, c, p) < 0.0 || side(c, a, p) < 0.0
        })
        // But a side that leaves from there may.
        && (0..n).all(|i| !segments_cross(a, c, flat[left[i]], flat[left[(i + 1) % n]]))
}

#[cfg(test)]
mod tests {
    use super::super::trimesh::area_vector;
    use super::*;
    use proptest::prelude::*;

    fn area(vertices: &[P3], triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|t| area_vector(&t.map(|i| vertices[i as usize])).norm()).sum()
    }

    #[test]
    fn a_concave_polygon_is_covered_once() {
        // An L of area 3 in a tilted plane; a fan from its first corner would cover 4.
        let flat = [(2.0, 2.0), (1.0, 2.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0), (2.0, 0.0)];
        let vertices = flat.map(|(x, y)| P3::new(x, y, y)).to_vec();
        let triangles = triangulate(&vertices, &[0, 1, 2, 3, 4, 5]);
        assert_eq!(triangles.len(), 4);
        assert!((area(&vertices, &triangles) - 3.0 * 2.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn less_than_a_triangle_is_nothing() {
        let vertices = [P3::origin(), P3::new(1.0, 0.0, 0.0)];
        assert!(triangulate(&vertices, &[]).is_empty());
        assert!(triangulate(&vertices, &[0, 1]).is_empty());
    }

    proptest! {
        #[test]
        fn a_star_keeps_its_area_and_its_corner_count(radii in prop::collection::vec(0.2..1.0f64, 3..40)) {
            let n = radii.len();
            let turn = |i: usize| std::f64::consts::TAU * i as f64 / n as f64;
            let vertices: Vec<P3> =
                radii.iter().enumerate().map(|(i, r)| P3::new(r * turn(i).cos(), 3.0, -r * turn(i).sin())).collect();
            let corners: Vec<u32> = (0..n as u32).collect();
            let triangles = triangulate(&vertices, &corners);
            let whole: f64 = (0..n).map(|i| 0.5 * radii[i] * radii[(i + 1) % n] * turn(1).sin()).sum();
            prop_assert_eq!(triangles.len(), n - 2);
            prop_assert!((area(&vertices, &triangles) - whole).abs() < 1e-9);
        }
    }
}
