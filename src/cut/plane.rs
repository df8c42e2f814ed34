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

impl PlaneFrame {
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
