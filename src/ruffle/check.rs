//! What must hold for a ruffle after every change of its topology.

use super::{Densification, Ruffle};

/// A broken rule, naming the place.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Flaw {
    /// The walk and the rest lengths do not match.
    #[error("the strip visits {nodes} nodes over {segments} segments; it must visit one more than it has segments")]
    WalkLength {
        /// Positions of the walk.
        nodes: usize,
        /// Rest lengths.
        segments: usize,
    },
    /// A node id beyond the node count.
    #[error("position {position} of the strip names node {node}, but there are {count}")]
    NoSuchNode {
        /// Position in the walk.
        position: usize,
        /// The id found.
        node: u32,
        /// Number of nodes.
        count: usize,
    },
    /// A node that the strip never visits.
    #[error("node {node} is not on the strip")]
    Orphan {
        /// The node.
        node: usize,
    },
    /// A segment without length or from a node to itself.
    #[error("segment {segment} has length {length_mm} mm and joins nodes {from} and {to}")]
    BadSegment {
        /// Segment index.
        segment: usize,
        /// Its rest length.
        length_mm: f64,
        /// Start node.
        from: usize,
        /// End node.
        to: usize,
    },
    /// Sections that leave a gap or overlap.
    #[error("section {section} starts at segment {found}, expected {expected}")]
    SectionGap {
        /// Section index.
        section: usize,
        /// Where it starts.
        found: usize,
        /// Where it should.
        expected: usize,
    },
    /// A connection in the middle of a section.
    #[error(
        "the strip meets itself at position {position}, inside section {section}; connections lie between sections"
    )]
    ConnectionInside {
        /// Section index.
        section: usize,
        /// Position in the walk.
        position: usize,
    },
    /// A densification that names sections it cannot have made.
    #[error(
        "densification {index} names sections {first} to {end} of {count}; densifications lie inside each other or apart, outer ones first"
    )]
    Densification {
        /// Index of the densification.
        index: usize,
        /// First section named.
        first: usize,
        /// One past the last.
        end: usize,
        /// Number of sections.
        count: usize,
    },
    /// A midpoint that does not lie between two sections.
    #[error("node {node} is named as a midpoint, but no section ends there")]
    Midpoint {
        /// The node.
        node: usize,
    },
}

impl Ruffle {
    /// Checks every rule and reports the first that is broken.
    pub fn check(&self) -> Result<(), Flaw> {
        let segments = self.rest_lengths.len();
        if self.walk.len() != segments + 1 {
            return Err(Flaw::WalkLength { nodes: self.walk.len(), segments });
        }
        let mut visits = vec![0u32; self.node_count];
        for (position, node) in self.walk.iter().enumerate() {
            *visits.get_mut(node.index()).ok_or(Flaw::NoSuchNode {
                position,
                node: node.0,
                count: self.node_count,
            })? += 1;
        }
        if let Some(node) = visits.iter().position(|v| *v == 0) {
            return Err(Flaw::Orphan { node });
        }
        for (segment, length_mm) in self.rest_lengths.iter().copied().enumerate() {
            let (from, to) = self.ends(segment);
            if !(length_mm > 0.0 && length_mm.is_finite()) || from == to {
                return Err(Flaw::BadSegment { segment, length_mm, from, to });
            }
        }
        let mut expected = 0;
        for (section, s) in self.sections.iter().enumerate() {
            if s.first_segment != expected || s.end_segment <= s.first_segment {
                return Err(Flaw::SectionGap { section, found: s.first_segment, expected });
            }
            expected = s.end_segment;
            if let Some(position) = (s.first_segment + 1..s.end_segment).find(|k| visits[self.walk[*k].index()] > 1) {
                return Err(Flaw::ConnectionInside { section, position });
            }
        }
        if expected != segments {
            return Err(Flaw::SectionGap { section: self.sections.len(), found: segments, expected });
        }
        self.check_densified()
    }

    fn check_densified(&self) -> Result<(), Flaw> {
        let count = self.sections.len();
        let made = &self.densified.made;
        for (index, m) in made.iter().enumerate() {
            let (first, end) = (m.first_section, m.end_section);
            let fits = |before: &Densification| {
                let apart = before.end_section <= first;
                let inside = before.first_section <= first && end <= before.end_section;
                apart || inside
            };
            let length = m.length_mm > 0.0 && m.length_mm.is_finite();
            if first + 2 > end || end > count || !length || !made[..index].iter().all(fits) {
                return Err(Flaw::Densification { index, first, end, count });
            }
        }
        let inner_ends = || self.sections.iter().skip(1).map(|s| self.walk[s.first_segment]);
        let loose = self.densified.midpoints.iter().find(|node| !inner_ends().any(|end| end == **node));
        loose.map_or(Ok(()), |node| Err(Flaw::Midpoint { node: node.index() }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ruffle::{Node, Role, uniform_stack};

    #[test]
    fn every_way_to_break_a_ruffle_is_noticed() {
        let good = uniform_stack(2, 30.0, 50.0, 5.0).ruffle;
        assert_eq!(good.check(), Ok(()));
        let flaw = |spoil: &dyn Fn(&mut Ruffle)| {
            let mut ruffle = good.clone();
            spoil(&mut ruffle);
            ruffle.check().unwrap_err()
        };
        assert!(matches!(
            flaw(&|r| {
                r.walk.pop();
            }),
            Flaw::WalkLength { .. }
        ));
        assert!(matches!(flaw(&|r| r.walk[3] = Node(9999)), Flaw::NoSuchNode { position: 3, .. }));
        assert!(matches!(flaw(&|r| r.node_count += 1), Flaw::Orphan { .. }));
        assert!(matches!(flaw(&|r| r.rest_lengths[4] = 0.0), Flaw::BadSegment { segment: 4, .. }));
        assert!(matches!(flaw(&|r| r.rest_lengths[4] = f64::NAN), Flaw::BadSegment { segment: 4, .. }));
        assert!(matches!(flaw(&|r| r.sections[1].first_segment += 1), Flaw::SectionGap { section: 1, .. }));
        assert!(matches!(
            flaw(&|r| {
                r.sections.pop();
            }),
            Flaw::SectionGap { .. }
        ));
        assert!(matches!(
            flaw(&|r| {
                let end = r.sections[1].end_segment;
                r.sections[0].end_segment = end;
                r.sections.remove(1);
                // The walk now meets the first connection inside the first section.
                let first = r.sections[0].first_segment + 2;
                let joint = r.walk[r.walk.len() - 1];
                let orphan = r.walk[first];
                r.walk[first] = joint;
                let last = r.walk.len() - 1;
                r.walk[last - 1] = orphan;
            }),
            Flaw::ConnectionInside { .. } | Flaw::Orphan { .. }
        ));
        let made = |first_section, end_section| Densification {
            first_section,
            end_section,
            role: Role::Outer,
            length_mm: 40.0,
        };
        for runs in [vec![made(7, 12)], vec![made(3, 4)], vec![made(0, 4), made(2, 6)], vec![made(2, 4), made(0, 5)]] {
            let refused = flaw(&|r| r.densified.made = runs.clone());
            assert!(matches!(refused, Flaw::Densification { .. }), "{runs:?}");
        }
        let inside = good.walk[good.sections[2].first_segment + 1];
        assert!(matches!(flaw(&|r| r.densified.midpoints = vec![inside]), Flaw::Midpoint { .. }));
    }
}
