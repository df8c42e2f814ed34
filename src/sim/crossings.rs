//! Counting where a strip passes through itself.

use crate::geom::{P2, segments_cross};

/// Pairs of segments that pass through each other. Segments that share a node do not count: they are joined there.
pub fn count_crossings(segments: impl IntoIterator<Item = (usize, usize)>, positions: &[P2]) -> usize {
    let mut sorted: Vec<(usize, usize)> = segments.into_iter().collect();
    let low = |s: &(usize, usize)| positions[s.0].x.min(positions[s.1].x);
    let high = |s: &(usize, usize)| positions[s.0].x.max(positions[s.1].x);
    sorted.sort_by(|a, b| low(a).total_cmp(&low(b)));
    let mut count = 0;
    for (k, s) in sorted.iter().enumerate() {
        for t in sorted[k + 1..].iter().take_while(|t| low(t) <= high(s)) {
            let joined = s.0 == t.0 || s.0 == t.1 || s.1 == t.0 || s.1 == t.1;
            if !joined && segments_cross(positions[s.0], positions[s.1], positions[t.0], positions[t.1]) {
                count += 1;
            }
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_of_eight_crosses_once_and_a_joined_one_never() {
        let p = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)].map(|(x, y)| P2::new(x, y));
        assert_eq!(count_crossings([(0, 1), (1, 2), (2, 3)], &p), 1);
        let mut joined = p.to_vec();
        joined.push(P2::new(1.0, 1.0));
        assert_eq!(count_crossings([(0, 4), (4, 1), (1, 2), (2, 4), (4, 3)], &joined), 0);
    }
}
