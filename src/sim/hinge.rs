//! Bending energy at one node: the angle between two segments that meet there.

use crate::geom::{P2, V2, cross};
use nalgebra::{Matrix2, SMatrix, SVector};

/// Gradient over the six coordinates of a hinge: i, j, k.
pub type Gradient = SVector<f64, 6>;
/// Hessian over the six coordinates of a hinge.
pub type Hessian = SMatrix<f64, 6, 6>;

/// Signed turn (rad) from segment `i j` to segment `j k`: 0 when straight.
fn turn(e1: V2, e2: V2) -> f64 {
    cross(e1, e2).atan2(e1.dot(&e2))
}

/// Energy (N mm) alone of the hinge i-j-k with stiffness `c` = D w / mean rest length (N mm): E = c/2 turn².
/// This is the paper's flexure term (section 4.1.1) with the physical factor 1/2; D is flexural rigidity per width.
pub fn energy(i: P2, j: P2, k: P2, c: f64) -> f64 {
    let phi = turn(j - i, k - j);
    0.5 * c * phi * phi
}

/// Moment of the hinge (N mm) and the gradient of its turn (rad/mm): their product is the gradient of [`energy`] (N).
pub fn gradient(i: P2, j: P2, k: P2, c: f64) -> (f64, Gradient) {
    let (e1, e2) = (j - i, k - j);
    (c * turn(e1, e2), d_turn(e1, e2))
}

/// Gradient of [`turn`] over i, j, k, rad/mm.
fn d_turn(e1: V2, e2: V2) -> Gradient {
    let (u, v) = (rotated(e2) / e2.norm_squared(), rotated(e1) / e1.norm_squared());
    Gradient::new(v.x, v.y, -u.x - v.x, -u.y - v.y, u.x, u.y)
}

/// Hessian (N/mm) of [`energy`]: the exact one, given the hinge's moment (N mm, from [`gradient`]), or without it the Gauss-Newton part, which is never indefinite.
pub fn hessian(i: P2, j: P2, k: P2, c: f64, moment: Option<f64>) -> Hessian {
    let d_phi = d_turn(j - i, k - j);
    let mut h = d_phi * d_phi.transpose() * c;
    if let Some(moment) = moment {
        let mut add = |block: Matrix2<f64>, from: usize, to: usize| {
            for (a, b, sign) in [(from, from, 1.0), (to, to, 1.0), (from, to, -1.0), (to, from, -1.0)] {
                let mut view = h.fixed_view_mut::<2, 2>(2 * a, 2 * b);
                view += block * (sign * moment);
            }
        };
        add(-second_derivative_of_direction(j - i), 0, 1);
        add(second_derivative_of_direction(k - j), 1, 2);
    }
    h
}

fn rotated(e: V2) -> V2 {
    V2::new(-e.y, e.x)
}

/// Hessian of the direction angle atan2(y, x) of `e`.
fn second_derivative_of_direction(e: V2) -> Matrix2<f64> {
    let (diagonal, off) = (2.0 * e.x * e.y, e.y * e.y - e.x * e.x);
    Matrix2::new(diagonal, off, off, -diagonal) / e.norm_squared().powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn split(x: &Gradient) -> (P2, P2, P2) {
        (P2::new(x[0], x[1]), P2::new(x[2], x[3]), P2::new(x[4], x[5]))
    }

    fn force(x: &Gradient, c: f64) -> Gradient {
        let (i, j, k) = split(x);
        let (moment, d_phi) = gradient(i, j, k, c);
        d_phi * moment
    }

    proptest! {
        #[test]
        fn gradient_and_hessian_match_finite_differences(
            a in -3.0..3.0f64, phi in -2.8..2.8f64, l1 in 0.5..3.0f64, l2 in 0.5..3.0f64,
        ) {
            let i = P2::new(0.4, -0.7);
            let j = i + V2::new(a.cos(), a.sin()) * l1;
            let k = j + V2::new((a + phi).cos(), (a + phi).sin()) * l2;
            let x = Gradient::new(i.x, i.y, j.x, j.y, k.x, k.y);
            let (c, h) = (7.0, 1e-5);
            let exact = hessian(i, j, k, c, Some(gradient(i, j, k, c).0));
            for axis in 0..6 {
                let mut step = Gradient::zeros();
                step[axis] = h;
                let at = |x: Gradient| { let (i, j, k) = split(&x); energy(i, j, k, c) };
                let slope = (at(x + step) - at(x - step)) / (2.0 * h);
                prop_assert!((slope - force(&x, c)[axis]).abs() < 1e-5 * (1.0 + c * phi.abs() / l1.min(l2)));
                let column = (force(&(x + step), c) - force(&(x - step), c)) / (2.0 * h);
                prop_assert!((column - exact.column(axis)).norm() < 1e-5 * exact.norm());
            }
        }

        #[test]
        fn the_convex_hessian_has_no_negative_direction(phi in -3.0..3.0f64) {
            let k = P2::new(1.0 + phi.cos(), phi.sin());
            let h = hessian(P2::origin(), P2::new(1.0, 0.0), k, 2.0, None);
            prop_assert!(h.symmetric_eigenvalues().min() > -1e-9);
        }
    }
}
