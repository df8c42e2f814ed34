//! Where two meshes lie against each other: lids of one cut, faces of bodies set side by side.

use super::TriMesh;
use super::trimesh::area_vector;
use crate::geom::{P2, P3, V3, clip, signed_area};

/// The area in which two meshes touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Middle of the area, mesh frame, mm.
    pub center: P3,
    /// Area, mm^2.
    pub area_mm2: f64,
    /// Convex polygons that tile it, mesh frame, mm.
    pub pieces: Vec<Vec<P3>>,
}

/// Faces this close, mm, touch: less than the thinnest sheet. Lids of one cut lie at no distance at all.
const TOUCHING_MM: f64 = 0.05;
/// And this nearly opposite (1 degree).
const OPPOSITE: f64 = 0.999_847_695;

/// Where faces of `a` lie against opposite faces of `b`; nothing where they meet in lines or points only.
pub fn contact(a: &TriMesh, b: &TriMesh) -> Option<Contact> {
    let (a_box, b_box) = (a.bounds(), b.bounds());
    let reach = V3::repeat(TOUCHING_MM);
    let (lo, hi) = (a_box.0.sup(&b_box.0) - reach, a_box.1.inf(&b_box.1) + reach);
    let faces = |mesh: &TriMesh| -> Vec<Face> {
        (0..mesh.triangles.len()).filter_map(|t| Face::new(mesh.corners(t))).filter(|f| f.meets(&lo, &hi)).collect()
    };
    let (own, mut others) = (faces(a), faces(b));
    others.sort_by(|s, t| s.lo.x.total_cmp(&t.lo.x));
    let widest = others.iter().map(|f| f.hi.x - f.lo.x).fold(0.0, f64::max);
    let mut pieces = Vec::new();
    let (mut area_mm2, mut moment) = (0.0, V3::zeros());
    for face in &own {
        let first = others.partition_point(|o| o.lo.x < face.lo.x - widest - TOUCHING_MM);
        let near = others[first..].iter().take_while(|o| o.lo.x <= face.hi.x + TOUCHING_MM);
        for shared in near.filter_map(|other| face.shared_with(other)) {
            let fan: Vec<[P3; 3]> = shared.windows(2).skip(1).map(|w| [shared[0], w[0], w[1]]).collect();
            for triangle in &fan {
                let area = area_vector(triangle).norm();
                area_mm2 += area;
                moment += triangle.iter().map(|p| p.coords).sum::<V3>() * (area / 3.0);
            }
            pieces.push(shared);
        }
    }
    (area_mm2 > 0.0).then(|| Contact { center: P3::from(moment / area_mm2), area_mm2, pieces })
}

impl Contact {
    /// The line in which the plane through `origin` across `normal` meets the area: its two ends, mesh frame, mm. Nothing where the plane passes the area by.
    pub fn chord(&self, origin: P3, normal: V3) -> Option<[P3; 2]> {
        let mut points = Vec::new();
        for piece in &self.pieces {
            for (i, p) in piece.iter().enumerate() {
                let q = piece[(i + 1) % piece.len()];
                let (hp, hq) = ((p - origin).dot(&normal), (q - origin).dot(&normal));
                if (hp >= 0.0) != (hq >= 0.0) {
                    points.push(p + (q - p) * (hp / (hp - hq)));
                }
            }
        }
        let first = *points.first()?;
        let farthest = |from: P3| {
            points.iter().copied().max_by(|s, t| (s - from).norm().total_cmp(&(t - from).norm())).unwrap_or(from)
        };
        let end = farthest(first);
        Some([farthest(end), end])
    }
}

/// A triangle with its box and unit normal.
struct Face {
    corners: [P3; 3],
    normal: V3,
    lo: P3,
    hi: P3,
}

impl Face {
    fn new(corners: [P3; 3]) -> Option<Face> {
        let normal = area_vector(&corners).try_normalize(0.0)?;
        let [a, b, c] = corners;
        Some(Face { corners, normal, lo: a.inf(&b).inf(&c), hi: a.sup(&b).sup(&c) })
    }

    fn meets(&self, lo: &P3, hi: &P3) -> bool {
        (0..3).all(|k| self.lo[k] <= hi[k] && self.hi[k] >= lo[k])
    }

    /// The polygon that this face and one lying against it have in common.
    fn shared_with(&self, other: &Face) -> Option<Vec<P3>> {
        let reach = V3::repeat(TOUCHING_MM);
        if self.normal.dot(&other.normal) > -OPPOSITE || !other.meets(&(self.lo - reach), &(self.hi + reach)) {
            return None;
        }
        let origin = self.corners[0];
        if other.corners.iter().any(|p| (p - origin).dot(&self.normal).abs() > TOUCHING_MM) {
            return None;
        }
        let u = (self.corners[1] - origin).normalize();
        let v = self.normal.cross(&u);
        let flat = |p: P3| P2::new((p - origin).dot(&u), (p - origin).dot(&v));
        let [a, b, c] = other.corners.map(flat);
        // Seen from here the other one runs clockwise.
        let shared = clip(&[a, c, b], &self.corners.map(flat));
        (signed_area(&shared) > 0.0).then(|| shared.iter().map(|p| origin + u * p.x + v * p.y).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::{cuboid, sphere};
    use super::super::split;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn boxes_side_by_side_touch_in_the_rectangle_they_share() {
        let a = cuboid(P3::origin(), V3::repeat(10.0));
        let contact_with = |corner: P3| contact(&a, &cuboid(corner, V3::repeat(10.0)));
        let shared = contact_with(P3::new(10.01, 4.0, -2.0)).unwrap();
        assert!((shared.area_mm2 - 48.0).abs() < 1e-9);
        assert!((shared.center - P3::new(10.0, 7.0, 4.0)).norm() < 0.02);
        let [p, q] = shared.chord(P3::new(0.0, 0.0, 3.0), V3::z()).unwrap();
        assert!(((p - q).norm() - 6.0).abs() < 1e-9 && (p.z - 3.0).abs() < 1e-9);
        assert_eq!(shared.chord(P3::new(0.0, 0.0, 9.0), V3::z()), None);
        for apart in [P3::new(10.2, 0.0, 0.0), P3::new(10.0, 10.0, 0.0), P3::new(9.0, 0.0, 0.0)] {
            assert_eq!(contact_with(apart), None, "{apart}");
        }
    }

    proptest! {
        #[test]
        fn halves_touch_in_their_whole_lid(n in prop::array::uniform3(-1.0..1.0f64), offset in -12.0..12.0f64) {
            prop_assume!(V3::from(n).norm() > 0.1);
            let n = V3::from(n).normalize();
            let ball = sphere(P3::new(1.0, 2.0, 3.0), 20.0, 48);
            let at = P3::new(1.0, 2.0, 3.0) + n * offset;
            let halves = split(&ball, at, n);
            let lid = 0.5 * (halves.behind.area() + halves.ahead.area() - ball.area());
            let shared = contact(&halves.behind, &halves.ahead).unwrap();
            prop_assert!((shared.area_mm2 / lid - 1.0).abs() < 1e-6, "{} {lid}", shared.area_mm2);
            prop_assert!((shared.center - at).norm() < 0.3);
        }
    }
}
