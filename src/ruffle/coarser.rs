//! The same strip in longer segments: a mesh on which a solve finds the shape at large, and the way back to the fine one.

use super::{Node, Ruffle, Section};
use crate::geom::{P2, V2};

/// A section keeps at least this many segments: enough for its half turn.
const LEAST_SEGMENTS: usize = 4;

/// A ruffle in longer segments, whose nodes are some of the fine one's.
#[derive(Debug, Clone)]
pub struct Coarser {
    /// The coarse ruffle. Rest lengths are sums of the fine ones; sections, joints and the foot are the same.
    pub ruffle: Ruffle,
    /// The fine node that each coarse node is.
    pub nodes: Vec<Node>,
    /// Positions in the fine walk that were kept, one for each position in the coarse walk.
    kept: Vec<usize>,
}

impl Ruffle {
    /// The ruffle in segments about `factor` times as long. Ends of sections, and the nodes `keep`, stay.
    pub fn coarser(&self, factor: usize, keep: &[Node]) -> Coarser {
        let mut held = vec![false; self.node_count];
        keep.iter().for_each(|node| held[node.index()] = true);
        let (mut kept, mut sections) = (vec![0], Vec::new());
        for section in &self.sections {
            let first_segment = kept.len() - 1;
            let fine = section.segments().len();
            let coarse = (fine / factor.max(1)).max(LEAST_SEGMENTS).min(fine);
            let mut next = 1;
            for k in 1..=fine {
                let due = k * coarse >= next * fine;
                if due || held[self.at(section.first_segment + k)] {
                    kept.push(section.first_segment + k);
                    next += usize::from(due);
                }
            }
            sections.push(Section { first_segment, end_segment: kept.len() - 1, ..section.clone() });
        }
        let mut number = vec![None; self.node_count];
        let mut nodes = Vec::new();
        let mut coarse_of = |node: Node| {
            *number[node.index()].get_or_insert_with(|| {
                nodes.push(node);
                Node(nodes.len() as u32 - 1)
            })
        };
        let walk: Vec<Node> = kept.iter().map(|k| coarse_of(self.walk[*k])).collect();
        let foot = self.foot.map(&mut coarse_of);
        let rest_lengths = kept.windows(2).map(|w| self.rest_lengths[w[0]..w[1]].iter().sum()).collect();
        // What densifying left behind serves edits, and nothing edits a coarse ruffle.
        let ruffle =
            Ruffle { node_count: nodes.len(), walk, rest_lengths, sections, foot, densified: Default::default() };
        Coarser { ruffle, nodes, kept }
    }
}

impl Coarser {
    /// The coarse node nearest along the strip to each of the fine ruffle's nodes.
    pub fn nearest(&self, fine: &Ruffle) -> Vec<Node> {
        let mut nearest = vec![Node(0); fine.node_count];
        for (j, w) in self.kept.windows(2).enumerate() {
            let middle = (w[0] + w[1]) / 2;
            for k in w[0]..=w[1] {
                nearest[fine.at(k)] = self.ruffle.walk[if k <= middle { j } else { j + 1 }];
            }
        }
        nearest
    }

    /// Positions of the fine ruffle's nodes on a curve through the coarse ones (plane frame, mm): cubics with matching tangents, or with `straight` the chords.
    pub fn refine(&self, fine: &Ruffle, coarse: &[P2], straight: bool) -> Vec<P2> {
        let stations = fine.stations();
        let at = |j: usize| coarse[self.ruffle.at(j)];
        let s = |j: usize| stations[self.kept[j]];
        let last = self.kept.len() - 1;
        // Direction at a kept position: through its neighbours, the nearer one weighing more.
        let tangent = |j: usize| -> V2 {
            let slope = |a: usize, b: usize| (at(b) - at(a)) / (s(b) - s(a));
            match j {
                0 => slope(0, 1),
                j if j == last => slope(last - 1, last),
                j => {
                    let (before, after) = (s(j) - s(j - 1), s(j + 1) - s(j));
                    (slope(j - 1, j) * after + slope(j, j + 1) * before) / (before + after)
                }
            }
        };
        let mut x = vec![P2::origin(); fine.node_count];
        for (j, w) in self.kept.windows(2).enumerate() {
            let (from, to, long) = (at(j), at(j + 1), s(j + 1) - s(j));
            let (leave, arrive) = (tangent(j) * long, tangent(j + 1) * long);
            for k in w[0]..=w[1] {
                let t = (stations[k] - s(j)) / long;
                let chord = from + (to - from) * t;
                // What the cubic adds to the chord (Hermite's basis).
                let bulge =
                    (leave - (to - from)) * (t * (1.0 - t) * (1.0 - t)) - (arrive - (to - from)) * (t * t * (1.0 - t));
                x[fine.at(k)] = if straight { chord } else { chord + bulge };
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ruffle::uniform_stack;

    #[test]
    fn a_coarser_ruffle_is_the_same_strip_in_fewer_segments() {
        let fine = uniform_stack(3, 30.0, 50.0, 1.0);
        let keep = fine.ruffle.walk[7];
        let coarser = fine.ruffle.coarser(4, &[keep]);
        let coarse = &coarser.ruffle;
        coarse.check().unwrap();
        assert!(3 * coarse.node_count < fine.ruffle.node_count && coarser.nodes.contains(&keep));
        assert!((coarse.strip_length() - fine.ruffle.strip_length()).abs() < 1e-9);
        assert_eq!(coarse.connection_points().len(), fine.ruffle.connection_points().len());
        assert_eq!(coarse.foot.map(|n| coarser.nodes[n.index()]), fine.ruffle.foot);
        for (s, section) in coarse.sections.iter().enumerate() {
            assert_eq!(section.role, fine.ruffle.sections[s].role);
            assert!((coarse.section_length(s) - fine.ruffle.section_length(s)).abs() < 1e-9);
        }
        let nearest = coarser.nearest(&fine.ruffle);
        for (c, node) in coarser.nodes.iter().enumerate() {
            assert_eq!(nearest[node.index()], Node(c as u32));
        }
    }

    #[test]
    fn cubics_follow_the_fine_curve_closer_than_chords_and_meet_it_where_it_was_kept() {
        let fine = uniform_stack(2, 30.0, 50.0, 1.0);
        let coarser = fine.ruffle.coarser(4, &[]);
        let coarse: Vec<P2> = coarser.nodes.iter().map(|n| fine.positions[n.index()]).collect();
        let away = |straight| {
            let x = coarser.refine(&fine.ruffle, &coarse, straight);
            assert!(coarser.nodes.iter().all(|n| (x[n.index()] - fine.positions[n.index()]).norm() < 1e-12));
            x.iter().zip(&fine.positions).map(|(a, b)| (a - b).norm()).sum::<f64>() / x.len() as f64
        };
        let (cubic, chord) = (away(false), away(true));
        assert!(chord > 0.02 && cubic < 0.5 * chord, "{cubic} against {chord}");
    }
}
