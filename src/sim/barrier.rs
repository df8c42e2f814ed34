//! Contact energy of one node and one segment: a logarithmic barrier on their distance (Li et al. 2020, *Incremental Potential Contact*,
//! doi:10.1145/3386569.3392425, in the plane).

use super::hinge::{Gradient, Hessian};
use crate::geom::{P2, V2, closest_on_segment};
use nalgebra::Matrix2;

/// How near a node and a segment may come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Distance that is never reached, mm: the sheet's thickness.
    pub least_mm: f64,
    /// Reach of the force beyond that, mm.
    pub reach_mm: f64,
}

impl Gap {
    /// Distance from which there is no force, mm.
    pub fn outer_mm(&self) -> f64 {
        self.least_mm + self.reach_mm
    }
}

/// Value and slopes of the dimensionless barrier b(s) = -(s - 1)² ln s on 0 < s < 1; zero beyond, with zero slope and curvature at 1.
pub(super) fn barrier(s: f64) -> [f64; 3] {
    if s >= 1.0 {
        return [0.0; 3];
    }
    if s <= 0.0 {
        return [f64::INFINITY; 3];
    }
    let (ln, m) = (s.ln(), s - 1.0);
    [-m * m * ln, -2.0 * m * ln - m * m / s, -2.0 * ln - 4.0 * m / s + m * m / (s * s)]
}

/// Distance of `p` from segment `a b` with its gradient over (p, a, b), and whether the nearest point is an end (0: a, 1: b) or between.
struct Distance {
    mm: f64,
    gradient: Gradient,
    nearest: Nearest,
    /// Unit vector from the nearest point to `p`.
    away: V2,
}

#[derive(Clone, Copy)]
enum Nearest {
    Start,
    Between(f64),
    End,
}

fn distance(p: P2, a: P2, b: P2) -> Distance {
    let (foot, t) = closest_on_segment(p, a, b);
    let d = p - foot;
    let mm = d.norm();
    let away = if mm > 0.0 { d / mm } else { V2::zeros() };
    let nearest = match t {
        0.0 => Nearest::Start,
        1.0 => Nearest::End,
        t => Nearest::Between(t),
    };
    let gradient = Gradient::new(away.x, away.y, -(1.0 - t) * away.x, -(1.0 - t) * away.y, -t * away.x, -t * away.y);
    Distance { mm, gradient, nearest, away }
}

/// Energy (N mm) of node `p` before segment `a b`, stiffness `kappa` in N: E = kappa reach b((distance - least) / reach). Infinite where the gap is closed.
pub fn energy(p: P2, a: P2, b: P2, gap: Gap, kappa: f64) -> f64 {
    let mm = (closest_on_segment(p, a, b).0 - p).norm();
    if mm >= gap.outer_mm() {
        return 0.0;
    }
    kappa * gap.reach_mm * barrier((mm - gap.least_mm) / gap.reach_mm)[0]
}

/// Gradient (N) of [`energy`] over p, a, b. The gap must be open.
pub fn gradient(p: P2, a: P2, b: P2, gap: Gap, kappa: f64) -> Gradient {
    let d = distance(p, a, b);
    d.gradient * (kappa * barrier((d.mm - gap.least_mm) / gap.reach_mm)[1])
}

/// Hessian (N/mm) of [`energy`] over p, a, b: exact, or with `convex` the part along the distance's gradient, which is never indefinite.
pub fn hessian(p: P2, a: P2, b: P2, gap: Gap, kappa: f64, convex: bool) -> Hessian {
    let d = distance(p, a, b);
    let [_, slope, curvature] = barrier((d.mm - gap.least_mm) / gap.reach_mm);
    let mut h = d.gradient * d.gradient.transpose() * (kappa * curvature / gap.reach_mm);
    if !convex && d.mm > 0.0 {
        h += second_derivative(&d, a, b) * (kappa * slope);
    }
    h
}

/// Hessian of the distance over p, a, b.
fn second_derivative(d: &Distance, a: P2, b: P2) -> Hessian {
    let across = (Matrix2::identity() - d.away * d.away.transpose()) / d.mm;
    let mut h = Hessian::zeros();
    let mut at_end = |corner: usize| {
        for (i, j, sign) in [(0, 0, 1.0), (corner, corner, 1.0), (0, corner, -1.0), (corner, 0, -1.0)] {
            h.fixed_view_mut::<2, 2>(2 * i, 2 * j).copy_from(&(across * sign));
        }
    };
    match d.nearest {
        Nearest::Start => at_end(1),
        Nearest::End => at_end(2),
        Nearest::Between(t) => {
            let length = (b - a).norm();
            let (tau, n) = ((b - a) / length, d.away);
            let six = |p: V2, a: V2, b: V2| Gradient::new(p.x, p.y, a.x, a.y, b.x, b.y);
            let u = six(tau, -(1.0 - t) * tau, -t * tau);
            let v = six(V2::zeros(), -n, n);
            h = -(u * v.transpose() + v * u.transpose()) / length - v * v.transpose() * (d.mm / (length * length));
        }
    }
    h
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GAP: Gap = Gap { least_mm: 0.2, reach_mm: 0.9 };

    fn split(x: &Gradient) -> (P2, P2, P2) {
        (P2::new(x[0], x[1]), P2::new(x[2], x[3]), P2::new(x[4], x[5]))
    }

    proptest! {
        #[test]
        fn gradient_and_hessian_match_finite_differences(
            along in -1.0..4.0f64, above in 0.35..1.0f64, turn in -3.0..3.0f64, below in any::<bool>(),
        ) {
            let side = if below { -1.0 } else { 1.0 };
            let place = |x: f64, y: f64| nalgebra::Rotation2::new(turn) * P2::new(x, y) + V2::new(0.3, -0.8);
            let (p, a, b) = (place(along, side * above), place(0.0, 0.0), place(3.0, 0.0));
            // Second derivatives jump where the nearest point becomes an end.
            prop_assume!(along.abs() > 0.01 && (along - 3.0).abs() > 0.01);
            let x = Gradient::new(p.x, p.y, a.x, a.y, b.x, b.y);
            let e = |x: Gradient| { let (p, a, b) = split(&x); energy(p, a, b, GAP, 5.0) };
            let g = |x: Gradient| { let (p, a, b) = split(&x); gradient(p, a, b, GAP, 5.0) };
            let exact = hessian(p, a, b, GAP, 5.0, false);
            let h = 1e-5;
            for axis in 0..6 {
                let mut step = Gradient::zeros();
                step[axis] = h;
                let slope = (e(x + step) - e(x - step)) / (2.0 * h);
                prop_assert!((slope - g(x)[axis]).abs() < 1e-5 * (1.0 + g(x).norm()));
                let column = (g(x + step) - g(x - step)) / (2.0 * h);
                prop_assert!((column - exact.column(axis)).norm() < 1e-4 * (1.0 + exact.norm()), "{column} {exact}");
            }
            let convex = hessian(p, a, b, GAP, 5.0, true);
            prop_assert!(convex.symmetric_eigenvalues().min() > -1e-9 * (1.0 + convex.norm()));
        }
    }

    #[test]
    fn the_force_grows_without_bound_as_the_gap_closes_and_ends_at_its_reach() {
        let push = |mm: f64| -gradient(P2::new(1.0, mm), P2::origin(), P2::new(2.0, 0.0), GAP, 1.0)[1];
        assert!(push(0.2001) > 100.0 * push(0.3) && push(0.3) > push(0.6));
        assert_eq!(push(GAP.outer_mm()), 0.0);
        assert_eq!(energy(P2::new(1.0, 0.2), P2::origin(), P2::new(2.0, 0.0), GAP, 1.0), f64::INFINITY);
    }
}
