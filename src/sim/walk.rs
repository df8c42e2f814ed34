//! The strip as a way over nodes: where along it something is, and where it meets itself.

use super::{Error, StripPlace, find_crossings};
use crate::geom::{P2, closest_on_segment, cross};
use crate::ruffle::Ruffle;

/// The way of one strip.
#[derive(Debug, Clone)]
pub(super) struct Walk {
    /// Nodes in strip order.
    pub nodes: Vec<usize>,
    /// Rest length of each segment, mm.
    rest_mm: Vec<f64>,
    /// One past the last segment of each section.
    section_ends: Vec<usize>,
}

/// Where the strip passes through itself. A position along the strip is the number of a segment and the share of it before the place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    /// The two positions, ascending.
    pub at: [f64; 2],
    /// Where they meet.
    pub point: P2,
}

impl Walk {
    /// The way of `ruffle`; lengths come with [`Walk::measure`].
    pub fn new(ruffle: &Ruffle) -> Walk {
        Walk {
            nodes: ruffle.walk.iter().map(|node| node.index()).collect(),
            rest_mm: ruffle.rest_lengths.clone(),
            section_ends: ruffle.sections.iter().map(|s| s.end_segment).collect(),
        }
    }

    /// Takes rest lengths, mm.
    pub fn measure(&mut self, rest_lengths_mm: &[f64]) {
        self.rest_mm.copy_from_slice(rest_lengths_mm);
    }

    fn ends(&self, segment: usize, x: &[P2]) -> [P2; 2] {
        [x[self.nodes[segment]], x[self.nodes[segment + 1]]]
    }

    /// Everywhere the strip passes through itself.
    pub fn crossings(&self, x: &[P2]) -> Vec<Crossing> {
        let segments = self.nodes.windows(2).map(|w| (w[0], w[1]));
        let pairs = find_crossings(segments, x);
        pairs.into_iter().map(|(s, t)| self.crossing(s, t, x)).collect()
    }

    fn crossing(&self, s: usize, t: usize, x: &[P2]) -> Crossing {
        let ([a, b], [c, d]) = (self.ends(s, x), self.ends(t, x));
        let whole = cross(b - a, d - c);
        // Segments that cross are not parallel; those that only just do may be so to rounding.
        let share = |numerator: f64| if whole == 0.0 { 0.5 } else { (numerator / whole).clamp(0.0, 1.0) };
        let (along_s, along_t) = (share(cross(c - a, d - c)), share(cross(c - a, b - a)));
        Crossing { at: [s as f64 + along_s, t as f64 + along_t], point: a + (b - a) * along_s }
    }

    /// The place at a position along the strip.
    fn place(&self, position: f64) -> StripPlace {
        let segment = (position as usize).min(self.rest_mm.len() - 1);
        let before: f64 = self.rest_mm[..segment].iter().sum();
        StripPlace {
            section: self.section_ends.partition_point(|end| *end <= segment),
            along_mm: before + self.rest_mm[segment] * (position - segment as f64),
        }
    }

    /// The refusal of a start, with the first place where the strip passes through itself; where it nowhere does, with the one where it comes closest to that.
    pub fn crossed(&self, x: &[P2]) -> Error {
        let crossings = self.crossings(x);
        let Crossing { at: [first, second], point } = crossings.first().copied().unwrap_or_else(|| self.touch(x));
        Error::Crossed {
            crossings: crossings.len(),
            first: self.place(first),
            second: self.place(second),
            u_mm: point.x,
            v_mm: point.y,
        }
    }

    /// Where a node comes closest to a segment that it is no end of.
    fn touch(&self, x: &[P2]) -> Crossing {
        let mut closest = (f64::INFINITY, Crossing { at: [0.0; 2], point: P2::origin() });
        for (k, node) in self.nodes.iter().enumerate() {
            for s in (0..self.rest_mm.len()).filter(|s| self.nodes[*s] != *node && self.nodes[*s + 1] != *node) {
                let [a, b] = self.ends(s, x);
                let (foot, share) = closest_on_segment(x[*node], a, b);
                let gap = (foot - x[*node]).norm();
                if gap < closest.0 {
                    let (on_node, on_segment) = (k as f64, s as f64 + share);
                    let at = [on_node.min(on_segment), on_node.max(on_segment)];
                    closest = (gap, Crossing { at, point: foot });
                }
            }
        }
        closest.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ruffle::{Node, Role, Section};

    /// A strip of three sections over nodes that lie wherever the test puts them.
    fn strip() -> Walk {
        let section =
            |first_segment, end_segment| Section { role: Role::Outer, first_segment, end_segment, pinned: false };
        Walk::new(&Ruffle {
            node_count: 5,
            walk: (0..5).map(Node).collect(),
            rest_lengths: vec![10.0, 10.0, 10.0, 20.0],
            sections: vec![section(0, 1), section(1, 2), section(2, 4)],
            foot: [Node(0), Node(1)],
            densified: Default::default(),
        })
    }

    #[test]
    fn a_refusal_names_both_places_along_the_strip_and_the_point() {
        let x = [(0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (4.0, 5.0), (4.0, -15.0)].map(|(u, v)| P2::new(u, v));
        let refused = strip().crossed(&x);
        let Error::Crossed { crossings: 1, first, second, u_mm, v_mm } = refused else { panic!("{refused}") };
        assert_eq!((first.section, second.section), (0, 2));
        assert!((first.along_mm - 4.0).abs() < 1e-9 && (second.along_mm - 35.0).abs() < 1e-9, "{refused}");
        assert!((u_mm - 4.0).abs() < 1e-9 && v_mm.abs() < 1e-9);
    }

    #[test]
    fn sheets_that_only_touch_are_named_where_they_do() {
        let x = [(0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (4.0, 5.0), (4.0, 0.0)].map(|(u, v)| P2::new(u, v));
        let Error::Crossed { crossings: 0, first, second, .. } = strip().crossed(&x) else { panic!("crossed") };
        assert!((first.along_mm - 4.0).abs() < 1e-9 && (second.along_mm - 50.0).abs() < 1e-9);
        assert_eq!((first.section, second.section), (0, 2));
    }
}
