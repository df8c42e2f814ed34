//! Shift, turn and scale from two places.

use super::{P2, Similarity, V2, cross, tolerance};

/// The one similarity, never a mirror, that carries two places to two others; `None` when either two are the same place.
pub fn similarity(from: [P2; 2], to: [P2; 2]) -> Option<Similarity> {
    let (a, b): (V2, V2) = (from[1] - from[0], to[1] - to[0]);
    if a.norm() < tolerance::SAME_POINT_MM || b.norm() < tolerance::SAME_POINT_MM {
        return None;
    }
    let (turn_rad, scale) = (cross(a, b).atan2(a.dot(&b)), b.norm() / a.norm());
    let about_origin = Similarity::new(V2::zeros(), turn_rad, scale);
    Some(Similarity::new(to[0] - about_origin * from[0], turn_rad, scale))
}
