//! Threads the strip through a stack of slabs: rungs, loops and diagonals.

use super::curve::{Curve, segments_for};
use super::{Densified, Drawn, Node, Role, Ruffle, Section};
use crate::geom::{P2, V2};

/// How far a rung's ends draw back from the outline, in layer heights: the room its loops bulge into.
const LOOP_REACH: f64 = 0.4;
/// Layers higher than this share of their width draw back as if they were no higher.
const DRAWN_BACK_ASPECT: f64 = 0.6;

/// The part of the outline that one layer fills, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slab {
    pub bottom: f64,
    pub top: f64,
    pub left: f64,
    pub right: f64,
}

/// One rung of the ladder, plane frame, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rung {
    left: P2,
    right: P2,
    /// How far the loops above this rung reach beyond its ends, mm: left, right.
    reach: [f64; 2],
}

impl Rung {
    /// The direction from its left end to its right.
    fn along(&self) -> V2 {
        (self.right - self.left).normalize()
    }
}

/// How finely and how short the strip is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Drawing {
    /// Length of a segment, mm, about.
    pub segment_mm: f64,
    /// Shortest rung, mm.
    pub min_rung_mm: f64,
}

/// Draws the strip through `slabs`, lowest first; `place` takes every point from where the slabs are to where they are drawn.
pub(super) fn thread_slabs(slabs: &[Slab], drawing: Drawing, place: &dyn Fn(P2) -> P2) -> Drawn {
    let mut rungs = rungs(slabs, drawing.min_rung_mm);
    for rung in &mut rungs {
        (rung.left, rung.right) = (place(rung.left), place(rung.right));
    }
    let mut drawn = thread(&rungs, drawing.segment_mm, Curve::loop_beyond);
    drawn.ruffle.foot = foot(&drawn);
    drawn
}

/// The two connection points that a stack stands on: the ends of its lowest rung, or, where layers stand side by side, the lower ends of the first and the last.
fn foot(drawn: &Drawn) -> [Node; 2] {
    let ends = |section: usize| {
        let (a, b) = drawn.ruffle.section_ends(section);
        (a, b, drawn.positions[a.index()], drawn.positions[b.index()])
    };
    let (left, right, from, to) = ends(0);
    if (to.y - from.y).abs() <= (to.x - from.x).abs() {
        return [left, right];
    }
    let lower = |(a, b, from, to): (Node, Node, P2, P2)| if from.y <= to.y { a } else { b };
    [lower(ends(0)), lower(ends(drawn.ruffle.sections.len() - 1))]
}

/// A stack of equal layers, as the paper's load tests fold it (figure 21): rungs `inner_mm` long, `layer_mm` apart, joined by half circles. The first rung
/// starts at the origin.
pub fn uniform_stack(layers: usize, layer_mm: f64, inner_mm: f64, segment_mm: f64) -> Drawn {
    let rung = |i: usize| {
        let v = i as f64 * layer_mm;
        Rung { left: P2::new(0.0, v), right: P2::new(inner_mm, v), reach: [0.5 * layer_mm; 2] }
    };
    let rungs: Vec<Rung> = (0..=layers.max(1)).map(rung).collect();
    thread(&rungs, segment_mm, |[from, to], [out, _], _| Curve::half_circle(from, to, out))
}

/// Rungs between slabs, drawn back from the outline so that the loops have room.
fn rungs(slabs: &[Slab], min_rung_mm: f64) -> Vec<Rung> {
    let draw_back = |s: &Slab| LOOP_REACH * (s.top - s.bottom).min(DRAWN_BACK_ASPECT * (s.right - s.left));
    let n = slabs.len();
    let mut rungs: Vec<Rung> = (0..=n)
        .map(|i| {
            let below = &slabs[i.saturating_sub(1)];
            let above = &slabs[i.min(n - 1)];
            let left = (below.left + draw_back(below)).max(above.left + draw_back(above));
            let right = (below.right - draw_back(below)).min(above.right - draw_back(above));
            let middle = 0.5 * (below.left.max(above.left) + below.right.min(above.right));
            let level = if i == n { slabs[n - 1].top } else { slabs[i].bottom };
            let (left, right) = if right - left >= min_rung_mm {
                (left, right)
            } else {
                (middle - 0.5 * min_rung_mm, middle + 0.5 * min_rung_mm)
            };
            Rung { left: P2::new(left, level), right: P2::new(right, level), reach: [0.0; 2] }
        })
        .collect();
    for (i, slab) in slabs.iter().enumerate() {
        let least = 0.25 * (slab.top - slab.bottom);
        let (low, high) = (rungs[i], rungs[i + 1]);
        rungs[i].reach = [
            (0.5 * (low.left.x + high.left.x) - slab.left).max(least),
            (slab.right - 0.5 * (low.right.x + high.right.x)).max(least),
        ];
    }
    rungs
}

/// Draws a loop between two points, outward along a direction at each, reaching so far.
type Side = fn([P2; 2], [V2; 2], f64) -> Curve;

/// Threads the strip through the ladder.
fn thread(rungs: &[Rung], segment_mm: f64, side: Side) -> Drawn {
    let mut weaver = Weaver { segment_mm, ..Weaver::default() };
    let rung = |r: &Rung| Curve::line(r.left, r.right);
    let mut left_node = weaver.start(rungs[0].left);
    let mut right_node = weaver.section(&rung(&rungs[0]), Role::Inner, None);
    let foot = [left_node, right_node];
    let last = rungs.len() - 2;
    for (i, pair) in rungs.windows(2).enumerate() {
        let (low, high) = (&pair[0], &pair[1]);
        let out = [low.along(), high.along()];
        let right = side([low.right, high.right], out, low.reach[1]);
        let next_right = weaver.section(&right, Role::Outer, None);
        weaver.section(&Curve::line(high.right, low.left), Role::Inner, Some(left_node));
        let left = side([low.left, high.left], out.map(|o| -o), low.reach[0]);
        left_node = weaver.section(&left, Role::Outer, None);
        let role = if i == last { Role::Outer } else { Role::Inner };
        right_node = weaver.section(&rung(high), role, Some(next_right));
    }
    debug_assert_eq!(right_node, weaver.walk[weaver.walk.len() - 1]);
    weaver.drawn(foot)
}

/// Collects sections into a ruffle.
#[derive(Default)]
struct Weaver {
    segment_mm: f64,
    positions: Vec<P2>,
    walk: Vec<Node>,
    rest_lengths: Vec<f64>,
    sections: Vec<Section>,
}

impl Weaver {
    fn new_node(&mut self, at: P2) -> Node {
        self.positions.push(at);
        Node(self.positions.len() as u32 - 1)
    }

    fn start(&mut self, at: P2) -> Node {
        let node = self.new_node(at);
        self.walk.push(node);
        node
    }

    /// Adds a section that ends on `end`, or on a new node; returns that node.
    fn section(&mut self, curve: &Curve, role: Role, end: Option<Node>) -> Node {
        let length = curve.length();
        let n = segments_for(length, self.segment_mm);
        let points = curve.divide(n);
        for p in &points[1..n] {
            let node = self.new_node(*p);
            self.walk.push(node);
        }
        let end = end.unwrap_or_else(|| self.new_node(points[n]));
        self.walk.push(end);
        let first_segment = self.rest_lengths.len();
        self.rest_lengths.extend(std::iter::repeat_n(length / n as f64, n));
        self.sections.push(Section { role, first_segment, end_segment: self.rest_lengths.len(), pinned: false });
        end
    }

    fn drawn(self, foot: [Node; 2]) -> Drawn {
        let ruffle = Ruffle {
            node_count: self.positions.len(),
            walk: self.walk,
            rest_lengths: self.rest_lengths,
            sections: self.sections,
            foot,
            densified: Densified::default(),
        };
        Drawn { ruffle, positions: self.positions }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_load_test_strips_have_their_length() {
        // Without end tabs.
        for (inner, strip) in [(52.8, 468.35), (106.7, 730.27)] {
            let drawn = uniform_stack(2, 30.0, inner, 5.0);
            drawn.ruffle.check().unwrap();
            let length = drawn.ruffle.strip_length();
            assert!((length - strip).abs() < 0.01, "{length} against {strip}");
        }
        assert_eq!(uniform_stack(2, 30.0, 52.8, 5.0).ruffle.node_count, 90);
        assert_eq!(uniform_stack(7, 30.0, 52.8, 5.0).ruffle.node_count, 285);
    }
}
