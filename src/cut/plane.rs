//! Cutting planes and the two-way map between space and the plane.

use crate::geom::{P2, P3, V3};

/// A cutting plane in the mesh frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// A point on the plane, mm.
    pub origin: P3,
    /// Unit normal: the direction the ruffle is extruded along.
    pub normal: V3,
}

/// Axes of a cutting plane. Right-handed: `u` x `v` = `normal`; `v` points up and the floor lies at v = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneFrame {
    /// Where (u, v) = (0, 0) lies in the mesh frame, mm.
    pub origin: P3,
    /// Unit vector to the right.
    pub u: V3,
    /// Unit vector up.
    pub v: V3,
    /// Unit normal, the extrusion direction.
    pub normal: V3,
}

/// Planes whose normal is this close to up (1 degree) count as horizontal: up seen in the plane then has no dependable direction.
const HORIZONTAL_RAD: f64 = std::f64::consts::PI / 180.0;

/// The side of a body that faces the viewer when up is as given: +z of a body with y up, -y of one with z up (as modelling programs show
/// them), +z of one with x up. Unit vector, horizontal.
pub(super) fn front(up: V3) -> V3 {
    let toward = if up.z.abs() > 0.9 { -V3::y() } else { V3::z() };
    (toward - up * toward.dot(&up)).normalize()
}

impl PlaneFrame {
    /// Axes for `plane`: v is up as seen in the plane; for a plane within 1 degree of horizontal v points away from the viewer (a plan view,
    /// `u` then is to the right). (u, v) = (0, 0) lies at the plane's origin.
    pub fn new(plane: &Plane, up: V3) -> PlaneFrame {
        let normal = plane.normal;
        let upward = up - normal * up.dot(&normal);
        let upward = if upward.norm() > HORIZONTAL_RAD.sin() {
            upward
        } else {
            let back = -front(up);
            back - normal * back.dot(&normal)
        };
        let v = upward.normalize();
        PlaneFrame { origin: plane.origin, u: v.cross(&normal), v, normal }
    }

    /// Plane coordinates of the foot of `p` on the plane.
    pub fn to_plane(&self, p: P3) -> P2 {
        let d = p - self.origin;
        P2::new(d.dot(&self.u), d.dot(&self.v))
    }

    /// Signed distance of `p` from the plane along the normal.
    pub fn height_of(&self, p: P3) -> f64 {
        (p - self.origin).dot(&self.normal)
    }

    /// The point at plane coordinates `p`, `height` above the plane.
    pub fn to_space(&self, p: P2, height: f64) -> P3 {
        self.origin + self.u * p.x + self.v * p.y + self.normal * height
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn frames_are_right_handed_and_go_both_ways(
            n in prop::array::uniform3(-1.0..1.0f64), p in prop::array::uniform3(-99.0..99.0f64), axis in 0usize..3,
        ) {
            let mut up = V3::zeros();
            up[axis] = 1.0;
            prop_assume!(V3::from(n).norm() > 0.1);
            let plane = Plane { origin: P3::new(1.0, 2.0, 3.0), normal: V3::from(n).normalize() };
            let frame = PlaneFrame::new(&plane, up);
            prop_assert!((frame.u.cross(&frame.v) - frame.normal).norm() < 1e-12);
            prop_assert!(frame.v.dot(&up) >= -HORIZONTAL_RAD.sin());
            let p = P3::from(p);
            prop_assert!((frame.to_space(frame.to_plane(p), frame.height_of(p)) - p).norm() < 1e-9);
        }
    }

    #[test]
    fn a_front_view_has_x_to_the_right_and_so_has_a_plan() {
        let frame = |normal, up| PlaneFrame::new(&Plane { origin: P3::origin(), normal }, up);
        assert_eq!((frame(V3::z(), V3::y()).u, frame(V3::z(), V3::y()).v), (V3::x(), V3::y()));
        assert_eq!(frame(-V3::y(), V3::z()).u, V3::x());
        assert_eq!((frame(V3::y(), V3::y()).u, frame(V3::y(), V3::y()).v), (V3::x(), -V3::z()));
        assert_eq!((frame(V3::z(), V3::z()).u, frame(V3::z(), V3::z()).v), (V3::x(), V3::y()));
    }
}
