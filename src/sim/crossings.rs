//! Where a strip passes through itself.

use crate::geom::{P2, segments_cross};

/// Pairs of segments, by their place in `segments`, that pass through each other. Segments that share a node do not count: they are joined there.
pub fn find_crossings(segments: impl IntoIterator<Item = (usize, usize)>, positions: &[P2]) -> Vec<(usize, usize)> {
    let mut sorted: Vec<(usize, (usize, usize))> = segments.into_iter().enumerate().collect();
    let low = |s: &(usize, usize)| positions[s.0].x.min(positions[s.1].x);
    let high = |s: &(usize, usize)| positions[s.0].x.max(positions[s.1].x);
    sorted.sort_by(|a, b| low(&a.1).total_cmp(&low(&b.1)));
    let mut found = Vec::new();
    for (k, (i, s)) in sorted.iter().enumerate() {
        for (j, t) in sorted[k + 1..].iter().take_while(|(_, t)| low(t) <= high(s)) {
            let joined = s.0 == t.0 || s.0 == t.1 || s.1 == t.0 || s.1 == t.1;
            if !joined && segments_cross(positions[s.0], positions[s.1], positions[t.0], positions[t.1]) {
                found.push((*i.min(j), *i.max(j)));
            }
        }
    }
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_of_eight_crosses_once_and_a_joined_one_never() {
        let p = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)].map(|(x, y)| P2::new(x, y));
        assert_eq!(find_crossings([(0, 1), (1, 2), (2, 3)], &p), [(0, 2)]);
        let mut joined = p.to_vec();
        joined.push(P2::new(1.0, 1.0));
        assert!(find_crossings([(0, 4), (4, 1), (1, 2), (2, 4), (4, 3)], &joined).is_empty());
    }
}
