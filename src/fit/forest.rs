//! Which part stands on which (paper section 4.3): a graph of the places where parts touch, and in it, from the parts on the ground upward, what everything leans on.

use crate::geom::{P3, V3};
use nalgebra::{DMatrix, DVector};

/// A part as far as standing is concerned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Middle of its volume, mesh frame, mm.
    pub center: P3,
    /// How far its lowest point lies above the ground, mm.
    pub above_ground_mm: f64,
    /// Its own height, mm.
    pub height_mm: f64,
}

/// A place where two parts touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// The two, by number, the smaller first.
    pub parts: [usize; 2],
    /// Middle of the place, mesh frame, mm.
    pub at: P3,
}

/// One of the parts that bear a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lean {
    /// The part underneath.
    pub on: usize,
    /// Where the two touch, mesh frame, mm.
    pub at: P3,
    /// Share of the weight that goes this way, 0..=1.
    pub share: f64,
}

/// Who bears whom.
#[derive(Debug, Clone, PartialEq)]
pub struct Forest {
    /// For each part what it leans on; nothing for those on the ground.
    pub leans: Vec<Vec<Lean>>,
    /// All parts, each before those it leans on.
    pub from_the_top: Vec<usize>,
    /// Parts that touch nothing that leads to the ground; each is taken to be held as if it stood there.
    pub afloat: Vec<usize>,
}

/// A part stands on the ground if it comes down to it but for the rounding of its underside: within this share of its height.
const ROUNDING: f64 = 0.05;

/// Even shares are given up as far as the balance of a part asks: how little evenness weighs against it.
const EVENNESS: f64 = 1e-6;

/// Works out who bears whom. Parts on the ground are roots; of a group that reaches no ground, the lowest part is. Every other part leans on those neighbours that are
/// one step nearer to a root; between several, its weight is shared as a beam on them would share it. `up` is the unit vector up, mesh frame.
///
/// The paper gives every part one parent. A body on two legs would then crush one of them, so all neighbours of that step bear here; with one neighbour the two
/// are the same.
pub fn forest(bodies: &[Body], meetings: &[Meeting], up: V3) -> Forest {
    let mut steps: Vec<Option<usize>> =
        bodies.iter().map(|b| (b.above_ground_mm <= ROUNDING * b.height_mm).then_some(0)).collect();
    let mut afloat = Vec::new();
    loop {
        spread(&mut steps, meetings);
        let left = (0..bodies.len()).filter(|i| steps[*i].is_none());
        let lowest = left.min_by(|a, b| bodies[*a].above_ground_mm.total_cmp(&bodies[*b].above_ground_mm));
        let Some(root) = lowest else { break };
        steps[root] = Some(0);
        afloat.push(root);
    }
    let leans = (0..bodies.len())
        .map(|i| {
            let places: Vec<(usize, P3)> = meetings
                .iter()
                .filter_map(|m| {
                    let other = if m.parts[0] == i { m.parts[1] } else { m.parts[0] };
                    let below = m.parts.contains(&i) && steps[other] < steps[i];
                    below.then_some((other, m.at))
                })
                .collect();
            let shares = shares(bodies[i].center, &places, up);
            places.iter().zip(shares).map(|((on, at), share)| Lean { on: *on, at: *at, share }).collect()
        })
        .collect();
    let mut from_the_top: Vec<usize> = (0..bodies.len()).collect();
    from_the_top.sort_by_key(|i| std::cmp::Reverse(steps[*i]));
    Forest { leans, from_the_top, afloat }
}

/// Gives every part that a numbered one leads to the least number of steps.
fn spread(steps: &mut [Option<usize>], meetings: &[Meeting]) {
    let mut step = 0;
    while steps.contains(&Some(step)) || step == 0 {
        for [a, b] in meetings.iter().map(|m| m.parts) {
            for (from, to) in [(a, b), (b, a)] {
                if steps[from] == Some(step) && steps[to].is_none() {
                    steps[to] = Some(step + 1);
                }
            }
        }
        step += 1;
    }
}

/// Shares, 0..=1 with sum 1, that put the middle of the support under `center` as nearly as they can, and beyond that are as even as they can be.
fn shares(center: P3, places: &[(usize, P3)], up: V3) -> Vec<f64> {
    let n = places.len();
    if n < 2 {
        return vec![1.0; n];
    }
    let level = |v: V3| v - up * v.dot(&up);
    let arms: Vec<V3> = places.iter().map(|(_, at)| level(at - center)).collect();
    let size = arms.iter().map(|a| a.norm_squared()).fold(f64::MIN_POSITIVE, f64::max);
    // Least |sum of share * arm|^2 + evenness |shares|^2 under sum of shares = 1 (Lagrange).
    let matrix = DMatrix::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
        (true, true) => arms[i].dot(&arms[j]) / size + if i == j { EVENNESS } else { 0.0 },
        (false, false) => 0.0,
        _ => 1.0,
    });
    let wanted = DVector::from_fn(n + 1, |i, _| if i == n { 1.0 } else { 0.0 });
    let even = || DVector::repeat(n + 1, 1.0);
    // Nothing pulls: a support beyond the middle would have to, and bears nothing instead.
    let bearing: Vec<f64> =
        matrix.lu().solve(&wanted).unwrap_or_else(even).iter().take(n).map(|s| s.max(0.0)).collect();
    let sum: f64 = bearing.iter().sum();
    bearing.into_iter().map(|s| s / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(x: f64, lowest: f64) -> Body {
        Body { center: P3::new(x, lowest + 5.0, 0.0), above_ground_mm: lowest, height_mm: 10.0 }
    }

    fn meeting(a: usize, b: usize, x: f64, y: f64) -> Meeting {
        Meeting { parts: [a, b], at: P3::new(x, y, 0.0) }
    }

    #[test]
    fn a_tower_leans_on_what_is_below_and_the_top_comes_first() {
        let bodies = [body(0.0, 20.0), body(0.0, 0.3), body(0.0, 10.0)];
        let forest = forest(&bodies, &[meeting(0, 2, 0.0, 20.0), meeting(1, 2, 0.0, 10.0)], V3::y());
        assert_eq!(forest.from_the_top, [0, 2, 1]);
        assert_eq!(forest.leans[0], [Lean { on: 2, at: P3::new(0.0, 20.0, 0.0), share: 1.0 }]);
        assert_eq!(forest.leans[2][0].on, 1);
        assert!(forest.leans[1].is_empty() && forest.afloat.is_empty());
    }

    #[test]
    fn a_bridge_shares_its_weight_as_a_beam_does() {
        // The body's middle lies at a quarter of the way from one leg to the other.
        let bodies = [body(-30.0, 0.0), body(10.0, 0.0), body(-20.0, 10.0)];
        let forest = forest(&bodies, &[meeting(0, 2, -30.0, 10.0), meeting(1, 2, 10.0, 10.0)], V3::y());
        let shares: Vec<f64> = forest.leans[2].iter().map(|l| l.share).collect();
        assert!((shares[0] - 0.75).abs() < 1e-3 && (shares[1] - 0.25).abs() < 1e-3, "{shares:?}");
        // Beyond both legs only the nearer one bears.
        let out = super::shares(
            P3::new(40.0, 0.0, 0.0),
            &[(0, P3::new(0.0, 0.0, 0.0)), (1, P3::new(10.0, 0.0, 0.0))],
            V3::y(),
        );
        assert_eq!(out, [0.0, 1.0]);
        let stacked = super::shares(P3::origin(), &[(0, P3::origin()), (1, P3::origin())], V3::y());
        assert!((stacked[0] - 0.5).abs() < 1e-9);
    }

    #[test]
    fn what_reaches_no_ground_hangs_on_its_lowest_part() {
        let bodies = [body(0.0, 0.0), body(50.0, 30.0), body(50.0, 20.0)];
        let forest = forest(&bodies, &[meeting(1, 2, 50.0, 30.0)], V3::y());
        assert_eq!(forest.afloat, [2]);
        assert_eq!(forest.leans[1][0].on, 2);
    }
}
