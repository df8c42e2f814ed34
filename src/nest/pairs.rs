//! How deep bodies lie in each other, and how much that matters by now.

use super::look::Weights;

/// Weights of lasting overlaps grow by these factors a round, the deepest most; weights of others fade (the paper's values).
const LEAST_GROWTH: f64 = 1.2;
const MOST_GROWTH: f64 = 2.0;
const DECAY: f64 = 0.95;

/// Depth and weight of every pair.
#[derive(Debug, Clone)]
pub(super) struct Pairs {
    n: usize,
    weight: Vec<f64>,
    depth: Vec<f64>,
}

impl Weights for Pairs {
    fn weight(&self, a: usize, b: usize) -> f64 {
        self.weight[a * self.n + b]
    }
}

impl Pairs {
    /// Of `n` bodies that overlap nowhere.
    pub(super) fn new(n: usize) -> Pairs {
        Pairs { n, weight: vec![1.0; n * n], depth: vec![0.0; n * n] }
    }

    pub(super) fn set_depth(&mut self, a: usize, b: usize, depth: f64) {
        self.depth[a * self.n + b] = depth;
        self.depth[b * self.n + a] = depth;
    }

    /// True when a body overlaps another.
    pub(super) fn overlaps(&self, a: usize) -> bool {
        self.depth[a * self.n..(a + 1) * self.n].iter().any(|d| *d > 0.0)
    }

    /// What a body's overlaps cost.
    pub(super) fn cost(&self, a: usize) -> f64 {
        let row = a * self.n..(a + 1) * self.n;
        self.depth[row.clone()].iter().zip(&self.weight[row]).map(|(d, w)| d * w).sum()
    }

    /// Sum of all depths.
    pub(super) fn total(&self) -> f64 {
        0.5 * self.depth.iter().sum::<f64>()
    }

    /// Overlaps that last weigh more, the deepest most; others are slowly forgotten.
    pub(super) fn learn(&mut self) {
        let deepest = self.depth.iter().copied().fold(0.0, f64::max);
        for (weight, depth) in self.weight.iter_mut().zip(&self.depth) {
            *weight = match *depth > 0.0 {
                true => *weight * (LEAST_GROWTH + (MOST_GROWTH - LEAST_GROWTH) * depth / deepest),
                false => (*weight * DECAY).max(1.0),
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lasts_weighs_more_and_what_is_over_is_forgotten() {
        let mut pairs = Pairs::new(3);
        pairs.set_depth(0, 1, 4.0);
        pairs.set_depth(1, 2, 2.0);
        pairs.learn();
        assert_eq!([pairs.weight(1, 0), pairs.weight(2, 1), pairs.weight(0, 2)], [2.0, 1.6, 1.0]);
        assert_eq!((pairs.total(), pairs.cost(1)), (6.0, 8.0 + 3.2));
        pairs.set_depth(0, 1, 0.0);
        assert!(!pairs.overlaps(0) && pairs.overlaps(2));
        for _ in 0..20 {
            pairs.learn();
        }
        assert_eq!(pairs.weight(0, 1), 1.0);
    }
}
