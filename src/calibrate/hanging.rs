//! Stiffness of a strip from how it hangs over an edge (Peirce's cantilever test, J. Textile Inst. 21, 1930, without its small-angle fit: the heavy elastica is
//! integrated).

/// Standard gravity, mm/s².
const GRAVITY_MM_PER_S2: f64 = 9806.65;

/// Flexural rigidity per width of a sheet of `grammage_g_per_m2` whose strip reaches `overhang_mm` over a level edge and hangs `drop_mm` below it at its tip, N mm.
/// `None` where the drop is less than a hundredth of the overhang or nearly all of it: then it says nothing about the stiffness.
///
/// With s from the clamp, theta below the horizon and b = w L³ / D: theta'' = -b (1 - s) cos theta, theta(0) = 0, theta'(1) = 0.
pub fn flexural_rigidity_n_mm(grammage_g_per_m2: f64, overhang_mm: f64, drop_mm: f64) -> Option<f64> {
    let share = drop_mm / overhang_mm;
    if !(0.01..=0.9).contains(&share) {
        return None;
    }
    // Weight per area, N/mm²: g/m² is 1e-9 kg/mm², mm/s² is 1e-3 m/s².
    let weight = grammage_g_per_m2 * 1e-9 * GRAVITY_MM_PER_S2 * 1e-3;
    let tip = tip_angle_for(share);
    let (b, _) = hang(tip);
    Some(weight * overhang_mm.powi(3) / b)
}

/// The angle of the tip of the strip whose drop is this share of its length, rad: the drop grows with the angle.
fn tip_angle_for(share: f64) -> f64 {
    let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if hang(middle).1 < share { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Steps of the integration over a unit of length in which the strip bends by about its own stiffness.
const STEP: f64 = 0.005;

/// The strip whose tip hangs at `tip` below the horizon: its b = w L³ / D and its drop as a share of its length.
///
/// Walked from the tip, where bending vanishes: with v = b^(1/3) (1 - s) the equation is theta'' = -v cos theta whatever b is, and the strip is clamped where theta
/// reaches 0.
fn hang(tip: f64) -> (f64, f64) {
    let rates = |v: f64, [theta, turn, _]: [f64; 3]| [turn, -v * theta.cos(), theta.sin()];
    let (mut v, mut state) = (0.0, [tip, 0.0, 0.0]);
    loop {
        let next = runge_kutta(v, state, rates);
        if next[0] <= 0.0 {
            // The last step ends on the clamp: linear in theta, which turns fastest there.
            let part = state[0] / (state[0] - next[0]);
            let drop = state[2] + part * (next[2] - state[2]);
            let length = v + part * STEP;
            return (length.powi(3), drop / length);
        }
        (v, state) = (v + STEP, next);
    }
}

fn runge_kutta(v: f64, state: [f64; 3], rates: impl Fn(f64, [f64; 3]) -> [f64; 3]) -> [f64; 3] {
    let along = |rate: [f64; 3], step: f64| std::array::from_fn(|i| state[i] + step * rate[i]);
    let first = rates(v, state);
    let second = rates(v + 0.5 * STEP, along(first, 0.5 * STEP));
    let third = rates(v + 0.5 * STEP, along(second, 0.5 * STEP));
    let fourth = rates(v + STEP, along(third, STEP));
    std::array::from_fn(|i| state[i] + STEP / 6.0 * (first[i] + 2.0 * second[i] + 2.0 * third[i] + fourth[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weight per area of 160 g/m², N/mm².
    const WEIGHT: f64 = 160.0 * 1e-9 * 9.80665;

    #[test]
    fn a_stiff_strip_drops_by_the_eighth_of_its_load() {
        // w L^4 / 8 D, for small angles.
        let rigidity = flexural_rigidity_n_mm(160.0, 60.0, 0.9).expect("in range");
        let small = WEIGHT * 60f64.powi(4) / (8.0 * 0.9);
        assert!((rigidity / small - 1.0).abs() < 2e-3, "{rigidity} {small}");
    }

    #[test]
    fn the_tip_drops_as_the_heavy_elastica_says() {
        // b = 8: tip deflection 0.640652 L (tabulated by an independent boundary value solver).
        let rigidity = flexural_rigidity_n_mm(160.0, 100.0, 64.0652).expect("in range");
        let b = WEIGHT * 100f64.powi(3) / rigidity;
        assert!((b - 8.0).abs() < 2e-3, "{b}");
    }

    #[test]
    fn what_hangs_straight_down_or_hardly_at_all_says_nothing() {
        assert_eq!(flexural_rigidity_n_mm(160.0, 100.0, 95.0), None);
        assert_eq!(flexural_rigidity_n_mm(160.0, 100.0, 0.5), None);
        assert_eq!(flexural_rigidity_n_mm(160.0, 0.0, 0.0), None);
        assert_eq!(flexural_rigidity_n_mm(160.0, 100.0, -3.0), None);
    }

    #[test]
    fn a_strip_that_hangs_lower_is_softer() {
        let at = |drop| flexural_rigidity_n_mm(160.0, 120.0, drop).expect("in range");
        assert!([10.0, 30.0, 60.0, 90.0, 105.0].windows(2).all(|w| at(w[0]) > at(w[1])));
    }
}
