//! Membrane energy of one segment.

use crate::geom::{P2, V2};
use nalgebra::Matrix2;

/// Energy (N mm), gradient at the segment's end (the start's is its negative, N) and Hessian block at the end (N/mm; the start's is equal, the
/// mixed ones its negative) of a segment of rest length `rest` (mm) and stiffness `k` = E t w / rest (N/mm): E = k/2 (|ab| - rest)².
///
/// With `convex`, the Hessian's transverse part is clamped to be positive: compressed segments otherwise make it indefinite.
pub fn stretch(a: P2, b: P2, rest: f64, k: f64, convex: bool) -> (f64, V2, Matrix2<f64>) {
    let d = b - a;
    let length = d.norm().max(f64::MIN_POSITIVE);
    let n = d / length;
    let excess = length - rest;
    let transverse = 1.0 - rest / length;
    let transverse = if convex { transverse.max(0.0) } else { transverse };
    let along = n * n.transpose();
    let hessian = (along + (Matrix2::identity() - along) * transverse) * k;
    (0.5 * k * excess * excess, n * (k * excess), hessian)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradient_and_hessian_match_finite_differences() {
        let (a, b, rest, k) = (P2::new(0.3, -0.2), P2::new(2.1, 1.7), 2.2, 350.0);
        let (_, gradient, hessian) = stretch(a, b, rest, k, false);
        let h = 1e-5;
        for axis in 0..2 {
            let mut step = V2::zeros();
            step[axis] = h;
            let (up, down) = (stretch(a, b + step, rest, k, false), stretch(a, b - step, rest, k, false));
            let slope = (up.0 - down.0) / (2.0 * h);
            assert!((slope - gradient[axis]).abs() < 1e-5 * gradient.norm());
            let column = (up.1 - down.1) / (2.0 * h);
            assert!((column - hessian.column(axis)).norm() < 1e-6 * hessian.norm());
        }
    }

    #[test]
    fn the_convex_hessian_has_no_negative_direction_in_compression() {
        let (_, _, hessian) = stretch(P2::origin(), P2::new(1.0, 0.5), 2.0, 10.0, true);
        assert!(hessian.symmetric_eigenvalues().min() >= -1e-12);
    }
}
