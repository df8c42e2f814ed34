//! Open chains become loops.

use super::section::Chain;
use crate::geom::P2;
use crate::progress::Warning;

/// More open chains than this come from a mesh in shreds; the longest are joined, the rest is left out (pairs are compared with each other).
const MAX_OPEN: usize = 1000;
/// So many gaps are named one by one.
const NAMED: usize = 5;

/// One end of an open chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct End {
    chain: usize,
    tail: bool,
}

/// What became of the chains.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Closed {
    /// Closed loops.
    pub(super) loops: Vec<Vec<P2>>,
    /// Straight lines that were needed, widest first.
    pub(super) gaps: Vec<Gap>,
    /// Open chains left out because there were too many.
    pub(super) left_out: usize,
}

/// A straight line where the mesh is open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gap {
    /// Its length, mm.
    pub(super) width: f64,
    /// Its middle.
    pub(super) middle: P2,
}

/// Closed loops: the closed chains as they are, the open ones joined, nearest ends first, by straight lines.
pub(super) fn close(chains: Vec<Chain>) -> Closed {
    let (closed, mut open): (Vec<Chain>, Vec<Chain>) = chains.into_iter().partition(|chain| chain.closed);
    let mut loops: Vec<Vec<P2>> = closed.into_iter().map(|chain| chain.points).collect();
    open.sort_by(|a, b| length(b).total_cmp(&length(a)));
    let left_out = open.len().saturating_sub(MAX_OPEN);
    open.truncate(MAX_OPEN);

    let ends: Vec<End> = (0..open.len()).flat_map(|chain| [false, true].map(|tail| End { chain, tail })).collect();
    let at = |end: End| {
        let points = &open[end.chain].points;
        points[if end.tail { points.len() - 1 } else { 0 }]
    };
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for i in 0..ends.len() {
        for j in i + 1..ends.len() {
            pairs.push(((at(ends[i]) - at(ends[j])).norm(), i, j));
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut partner: Vec<Option<usize>> = vec![None; ends.len()];
    let mut gaps = Vec::new();
    for (width, i, j) in pairs {
        if partner[i].is_none() && partner[j].is_none() {
            (partner[i], partner[j]) = (Some(j), Some(i));
            gaps.push(Gap { width, middle: nalgebra::center(&at(ends[i]), &at(ends[j])) });
        }
    }
    // Ends 2k and 2k + 1 belong to chain k: walk it, hop to the partner, until back.
    let mut used = vec![false; open.len()];
    for first in 0..open.len() {
        let (mut points, mut runs_along) = (Vec::new(), 0.0);
        let mut end = 2 * first;
        while !used[end / 2] {
            let chain = &open[end / 2];
            used[end / 2] = true;
            let reversed = end % 2 == 1;
            runs_along += if reversed { -length(chain) } else { length(chain) };
            if reversed {
                points.extend(chain.points.iter().rev());
            } else {
                points.extend(&chain.points);
            }
            match partner[end ^ 1] {
                Some(next) => end = next,
                None => break,
            }
        }
        if runs_along < 0.0 {
            points.reverse();
        }
        if points.len() > 2 {
            loops.push(points);
        }
    }
    gaps.reverse();
    Closed { loops, gaps, left_out }
}

impl Closed {
    /// What the user should know, in the frame whose origin lies at `zero`.
    pub(super) fn warnings(&self, zero: P2) -> Vec<Warning> {
        let mut warnings: Vec<Warning> = self
            .gaps
            .iter()
            .take(NAMED)
            .map(|gap| {
                let at = gap.middle - zero;
                let message = format!(
                    "the mesh is open: a gap of {:.2} mm in the outline was closed by a straight line",
                    gap.width
                );
                Warning::new("cut-gap", message).at(format!("u {:.1}, v {:.1} mm", at.x, at.y))
            })
            .collect();
        if let Some(next) = self.gaps.get(NAMED) {
            let more = self.gaps.len() - NAMED;
            let message = format!("{more} more gaps in the outline, up to {:.2} mm, were closed", next.width);
            warnings.push(Warning::new("cut-gap", message));
        }
        if self.left_out > 0 {
            let message = format!(
                "the cut falls into more than {MAX_OPEN} open pieces; the {} shortest were left out. Repair the mesh if the outline looks wrong",
                self.left_out
            );
            warnings.push(Warning::new("cut-shredded", message));
        }
        warnings
    }
}

fn length(chain: &Chain) -> f64 {
    chain.points.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::signed_area;

    fn open(points: &[(f64, f64)]) -> Chain {
        Chain { points: points.iter().map(|(x, y)| P2::new(*x, *y)).collect(), closed: false }
    }

    #[test]
    fn one_open_chain_is_closed_and_its_gap_named() {
        let closed = close(vec![open(&[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)])]);
        assert_eq!(closed.loops.len(), 1);
        assert_eq!(signed_area(&closed.loops[0]), 12.0);
        let warnings = closed.warnings(P2::new(-2.0, 0.5));
        assert_eq!(warnings.len(), 1);
        assert!(warnings[0].message.contains("3.00 mm"));
        assert_eq!(warnings[0].place.as_deref(), Some("u 2.0, v 1.0 mm"));
    }

    #[test]
    fn pieces_join_at_their_nearest_ends_whichever_way_they_run() {
        let right = open(&[(2.0, 0.0), (4.0, 0.0), (4.0, 3.0), (2.2, 3.0)]);
        let left = open(&[(1.8, 0.0), (0.0, 0.0), (0.0, 3.0), (1.9, 3.0)]);
        let closed = close(vec![right, left]);
        assert_eq!(closed.loops.len(), 1);
        assert!((signed_area(&closed.loops[0]) - 12.0).abs() < 1e-9);
        let widths: Vec<f64> = closed.gaps.iter().map(|gap| (gap.width * 1e6).round() / 1e6).collect();
        assert_eq!(widths, [0.3, 0.2]);
    }

    #[test]
    fn closed_chains_pass_through_in_silence() {
        let square = Chain { closed: true, ..open(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]) };
        let closed = close(vec![square.clone()]);
        assert_eq!(closed, Closed { loops: vec![square.points], ..Closed::default() });
        assert!(closed.warnings(P2::origin()).is_empty());
    }
}
