//! One air triangle: its signed area, what it costs to turn it inside out, and how good it is.

use crate::geom::{P2, V2, cross};
use crate::sim::hinge::{Gradient, Hessian};

/// Signed area of `a b c`, mm²: positive when they run counter-clockwise.
pub fn area(a: P2, b: P2, c: P2) -> f64 {
    0.5 * cross(b - a, c - a)
}

/// Gradient of [`area`] over a, b, c, mm: half of the opposite side, turned by a quarter.
fn area_gradient(a: P2, b: P2, c: P2) -> Gradient {
    let quarter = |side: V2| V2::new(-side.y, side.x) * 0.5;
    let (da, db, dc) = (quarter(c - b), quarter(a - c), quarter(b - a));
    Gradient::new(da.x, da.y, db.x, db.y, dc.x, dc.y)
}

/// Energy (N mm) of a triangle with stiffness `k` (N/mm³): E = k/2 area² where it is inside out, nothing where it is not. The paper's penalty (section 4.1.3) is the area
/// itself, whose force jumps where the triangle inverts; squared, the force is continuous and Newton's method applies.
pub fn energy(a: P2, b: P2, c: P2, k: f64) -> f64 {
    0.5 * k * area(a, b, c).min(0.0).powi(2)
}

/// Gradient (N) of [`energy`] over a, b, c.
pub fn gradient(a: P2, b: P2, c: P2, k: f64) -> Gradient {
    area_gradient(a, b, c) * (k * area(a, b, c).min(0.0))
}

/// Hessian (N/mm) of [`energy`] over a, b, c: exact, or with `convex` its Gauss-Newton part, which is never indefinite. Zero where the triangle is not inside out.
pub fn hessian(a: P2, b: P2, c: P2, k: f64, convex: bool) -> Hessian {
    let inverted = area(a, b, c);
    if inverted >= 0.0 {
        return Hessian::zeros();
    }
    let g = area_gradient(a, b, c);
    let mut h = g * g.transpose() * k;
    if !convex {
        // The area is bilinear: u of each corner with v of the next, plus a half; with v of the one before, minus a half.
        for corner in 0..3 {
            let (next, before) = ((corner + 1) % 3, (corner + 2) % 3);
            for (other, half) in [(next, 0.5), (before, -0.5)] {
                h[(2 * corner, 2 * other + 1)] += k * inverted * half;
                h[(2 * other + 1, 2 * corner)] += k * inverted * half;
            }
        }
    }
    h
}

/// Quality of a triangle (paper section 4.1.3): signed area over the sum of its squared sides. 0.144 for equal sides, 0 for a sliver, negative when inside out.
pub fn quality(a: P2, b: P2, c: P2) -> f64 {
    let sides = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    if sides > 0.0 { area(a, b, c) / sides } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn corners(x: &Gradient) -> [P2; 3] {
        [P2::new(x[0], x[1]), P2::new(x[2], x[3]), P2::new(x[4], x[5])]
    }

    proptest! {
        #[test]
        fn gradient_and_hessian_match_finite_differences(x in prop::array::uniform6(-3.0..3.0f64)) {
            let x = Gradient::from_row_slice(&x);
            let at = |x: Gradient| { let [a, b, c] = corners(&x); energy(a, b, c, 5.0) };
            let force = |x: Gradient| { let [a, b, c] = corners(&x); gradient(a, b, c, 5.0) };
            let [a, b, c] = corners(&x);
            // The Hessian jumps where the triangle inverts.
            prop_assume!(area(a, b, c).abs() > 1e-3);
            let exact = hessian(a, b, c, 5.0, false);
            let h = 1e-5;
            for axis in 0..6 {
                let mut step = Gradient::zeros();
                step[axis] = h;
                let slope = (at(x + step) - at(x - step)) / (2.0 * h);
                prop_assert!((slope - force(x)[axis]).abs() < 1e-6 * (1.0 + force(x).norm()));
                let column = (force(x + step) - force(x - step)) / (2.0 * h);
                prop_assert!((column - exact.column(axis)).norm() < 1e-6 * (1.0 + exact.norm()));
            }
            let convex = hessian(a, b, c, 5.0, true);
            prop_assert!(convex.symmetric_eigenvalues().min() > -1e-9 * (1.0 + convex.norm()));
        }
    }

    #[test]
    fn an_inverted_triangle_is_pushed_open_and_an_open_one_left_alone() {
        let (a, b) = (P2::origin(), P2::new(2.0, 0.0));
        assert_eq!(energy(a, b, P2::new(1.0, 0.1), 3.0), 0.0);
        // Area -0.1: 3/2 x 0.01, and a force of 3 x 0.1 x half the base on its tip.
        let tip = P2::new(1.0, -0.1);
        assert!((energy(a, b, tip, 3.0) - 0.015).abs() < 1e-12);
        assert!((gradient(a, b, tip, 3.0)[5] + 0.3).abs() < 1e-12);
    }

    #[test]
    fn equal_sides_are_best_and_a_flat_triangle_beside_the_hull_is_worth_less_than_infinity() {
        let apex = |height: f64| quality(P2::origin(), P2::new(1.0, 0.0), P2::new(0.5, height));
        assert!((apex(0.75_f64.sqrt()) - 3.0_f64.sqrt() / 12.0).abs() < 1e-12);
        assert!(apex(0.7) < apex(0.75_f64.sqrt()) && apex(1.0) < apex(0.75_f64.sqrt()));
        assert!(apex(0.1) < 0.05 && apex(0.2) > 0.05 && apex(-0.2) < 0.0);
    }
}
