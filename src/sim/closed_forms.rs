//! The solver against the elastica: shapes of a thin sheet that are known in closed form or from its differential equation.

use super::tests::{cantilever, paper};
use super::*;
use crate::progress::Quiet;

fn sagged(n: usize, load: f64) -> (f64, f64, Equilibrium) {
    let length: f64 = 100.0;
    let q = paper(1.0).weight_n_per_mm2();
    let material = paper(q * length.powi(3) / load);
    let (ruffle, start, supports) = cantilever(n, length);
    // The strip weighs 6 mN: its shape to five digits needs forces to a few nN.
    let settings = Settings { floor_mm: f64::NEG_INFINITY, residual_n: 2e-9, ..Settings::default() };
    let mut solver = Solver::new(&ruffle, &vec![40.0; n + 2], &material, &supports, &settings).unwrap();
    let e = solver.solve(&start, &mut Quiet).unwrap();
    let tip = e.positions[n + 1];
    (-tip.y / length, tip.x / length, e)
}

#[test]
fn a_heavy_cantilever_hangs_as_the_elastica_does() {
    // th'' = -b (1 - s) cos th, b = q L^3 / EI: drop / L and reach / L of its numerical solution.
    for (b, drop, reach) in [(1.0, 0.123471, 0.991246), (4.0, 0.425159, 0.890111), (8.0, 0.640631, 0.724425)] {
        let (d, r, e) = sagged(80, b);
        assert_eq!(e.outcome, Outcome::Converged, "b = {b}: {e:?}");
        assert!((d - drop).abs() < 1.5e-3 && (r - reach).abs() < 2e-3, "b = {b}: {d} {r}");
    }
}

#[test]
fn the_error_falls_with_the_square_of_the_segment() {
    let error = |n| (sagged(n, 8.0).0 - 0.640631_f64).abs();
    let ratio = error(20) / error(40);
    assert!((3.0..5.5).contains(&ratio), "ratio {ratio}");
}
