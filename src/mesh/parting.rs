//! Bodies that pass through each other, and the plane that parts them.

use super::{TriMesh, edges};
use crate::geom::{P3, V3};
use nalgebra::{Matrix3, SymmetricEigen};

/// How two meshes lie to each other.
#[derive(Debug, Clone, PartialEq)]
pub enum Parting {
    /// Their surfaces do not cross.
    Apart,
    /// Their surfaces cross about along this plane, and the middles of the two lie on its two sides.
    Plane {
        /// A point on it, mesh frame, mm.
        origin: P3,
        /// Its unit normal, from the first mesh to the second.
        normal: V3,
    },
    /// Their surfaces cross, but no plane parts them.
    Entangled,
}

/// Surfaces that cross within this share of the crossing's own size about a plane are parted by it. A cylinder half sunk in another of its size crosses it within 0.3.
const FLAT: f64 = 0.4;

/// The plane in which the surfaces of `a` and `b` cross, if they do: least squares over the points in which the edges of one meet the triangles of the other.
pub fn parting_plane(a: &TriMesh, b: &TriMesh) -> Parting {
    let mut points = crossings(a, b);
    points.extend(crossings(b, a));
    if points.len() < 3 {
        return Parting::Apart;
    }
    let middle = P3::from(points.iter().map(|p| p.coords).sum::<V3>() / points.len() as f64);
    let spread: Matrix3<f64> = points.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
    let eigen = SymmetricEigen::new(spread);
    let least = eigen.eigenvalues.imin();
    let normal: V3 = eigen.eigenvectors.column(least).into_owned();
    let side = |mesh: &TriMesh| (mesh.centroid() - middle).dot(&normal);
    let (from, to) = (side(a), side(b));
    let size = (eigen.eigenvalues.sum() / points.len() as f64).sqrt();
    let off = (eigen.eigenvalues[least].max(0.0) / points.len() as f64).sqrt();
    if off > FLAT * size || from * to >= 0.0 {
        return Parting::Entangled;
    }
    Parting::Plane { origin: middle, normal: if to > 0.0 { normal } else { -normal } }
}

/// Points in which edges of `a` meet triangles of `b`.
fn crossings(a: &TriMesh, b: &TriMesh) -> Vec<P3> {
    let (a_box, b_box) = (a.bounds(), b.bounds());
    let (lo, hi) = (a_box.0.sup(&b_box.0), a_box.1.inf(&b_box.1));
    let meets = |from: &P3, to: &P3| (0..3).all(|k| from[k] <= hi[k] && to[k] >= lo[k]);
    let mut triangles: Vec<(P3, P3, [P3; 3])> = (0..b.triangles.len())
        .map(|t| b.corners(t))
        .map(|c| (c[0].inf(&c[1]).inf(&c[2]), c[0].sup(&c[1]).sup(&c[2]), c))
        .filter(|(from, to, _)| meets(from, to))
        .collect();
    triangles.sort_by(|s, t| s.0.x.total_cmp(&t.0.x));
    let widest = triangles.iter().map(|(from, to, _)| to.x - from.x).fold(0.0, f64::max);
    let mut points = Vec::new();
    for edge in edges::of(&a.triangles).chunk_by(|s, t| s.key == t.key) {
        let (p, q) = (a.vertices[edge[0].key.0 as usize], a.vertices[edge[0].key.1 as usize]);
        let (from, to) = (p.inf(&q), p.sup(&q));
        if !meets(&from, &to) {
            continue;
        }
        let first = triangles.partition_point(|t| t.0.x < from.x - widest);
        let near = triangles[first..].iter().take_while(|t| t.0.x <= to.x);
        points.extend(near.filter_map(|(_, _, corners)| through(p, q, corners)));
    }
    points
}

/// Where the segment from `p` to `q` passes through a triangle (Moeller and Trumbore 1997, doi:10.1080/10867651.1997.10487468).
fn through(p: P3, q: P3, [a, b, c]: &[P3; 3]) -> Option<P3> {
    let (ab, ac, d) = (b - a, c - a, q - p);
    let h = d.cross(&ac);
    let det = ab.dot(&h);
    if det == 0.0 {
        return None;
    }
    let s = p - a;
    let u = s.dot(&h) / det;
    let k = s.cross(&ab);
    let v = d.dot(&k) / det;
    let t = ac.dot(&k) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&t)).then(|| p + d * t)
}

#[cfg(test)]
mod tests {
    use super::super::samples::{cuboid, sphere};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn bodies_apart_or_one_in_the_other_have_no_plane() {
        let ball = |x: f64, r: f64| sphere(P3::new(x, 0.0, 0.0), r, 16);
        assert_eq!(parting_plane(&ball(0.0, 10.0), &ball(25.0, 10.0)), Parting::Apart);
        assert_eq!(parting_plane(&ball(0.0, 10.0), &ball(1.0, 5.0)), Parting::Apart);
        // A rod right through a ball crosses it twice.
        let rod = cuboid(P3::new(-30.0, -2.0, -2.0), V3::new(60.0, 4.0, 4.0));
        assert_eq!(parting_plane(&ball(0.0, 10.0), &rod), Parting::Entangled);
    }

    proptest! {
        #[test]
        fn two_balls_are_parted_by_their_radical_plane(
            n in prop::array::uniform3(-1.0..1.0f64), distance in 12.0..26.0f64, radius in 9.0..14.0f64,
        ) {
            prop_assume!(V3::from(n).norm() > 0.1 && distance < radius + 13.0 && distance > 15.0 - radius + 6.0);
            let n = V3::from(n).normalize();
            let (a, b) = (sphere(P3::origin(), 15.0, 40), sphere(P3::from(n * distance), radius, 40));
            let Parting::Plane { origin, normal } = parting_plane(&a, &b) else { return Err(TestCaseError::fail("no plane")) };
            let offset = (distance * distance + 225.0 - radius * radius) / (2.0 * distance);
            prop_assert!(normal.dot(&n) > 0.99, "{normal} {n}");
            prop_assert!((origin.coords.dot(&n) - offset).abs() < 0.4, "{} {offset}", origin.coords.dot(&n));
        }
    }
}
