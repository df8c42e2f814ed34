//! The topology of one strip folded in one outline: which nodes it visits, in which order, how long it is in between.
//!
//! A ruffle holds no positions; those live in an equilibrium. It is a walk over node ids: wherever the walk meets a node it has met
//! before (or ends on one), the strip touches itself there, and that node is a connection point.

mod centreline;
mod check;
mod chords;
mod coarser;
mod curve;
mod densified;
mod direction;
mod edit;
mod ladder;
mod layers;
mod load_test;
mod packed;
mod stack;

pub use check::Flaw;
pub use coarser::Coarser;
pub use densified::{Densification, Densified};
pub use direction::{Direction, suited_direction};
pub use edit::{
    EditError, EditSettings, Limits, densify, insert_layer, layer_count, loops, merge_segments, move_joint,
    remove_layer, set_length, split_layer, split_segments, undensify,
};
pub use ladder::uniform_stack;
pub use layers::Layer;
pub use load_test::{Strip, load_test};
pub use stack::{Drawn, Layering, StackError, StackSettings, draw_stack};

use serde::{Deserialize, Serialize};

/// A point of the folded strip; an index into position arrays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Node(pub u32);

impl Node {
    /// The node as an array index.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// What a section does for the shape; decides how fitting changes its length (paper section 4.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Bounds the ruffle: should touch the outline.
    Outer,
    /// Runs across the inside: a rung or a diagonal.
    Inner,
    /// Made by densifying; keeps the length it was given.
    Densified,
}

/// The strip between two consecutive landmarks of the walk.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// What the section does.
    pub role: Role,
    /// First segment, an index into [`Ruffle::rest_lengths`].
    pub first_segment: usize,
    /// One past the last segment.
    pub end_segment: usize,
    /// Its length was given by hand: filling leaves it alone.
    pub pinned: bool,
}

impl Section {
    /// The section's segments.
    pub fn segments(&self) -> std::ops::Range<usize> {
        self.first_segment..self.end_segment
    }
}

/// A node where the strip meets itself.
#[derive(Debug, Clone, PartialEq)]
pub struct ConnectionPoint {
    /// Where.
    pub node: Node,
    /// Joint number, from 1, in the order the strip first reaches them.
    pub joint: u32,
    /// Positions in [`Ruffle::walk`] at which the strip passes, ascending; two or more.
    pub passes: Vec<usize>,
}

/// The folded strip: topology and rest lengths (mm) only.
#[derive(Debug, Clone, PartialEq)]
pub struct Ruffle {
    /// Number of distinct nodes.
    pub node_count: usize,
    /// Nodes in strip order; one more than there are segments.
    pub walk: Vec<Node>,
    /// Rest length of the segment from `walk[k]` to `walk[k + 1]`, mm.
    pub rest_lengths: Vec<f64>,
    /// Sections in strip order; together they cover every segment once.
    pub sections: Vec<Section>,
    /// Nodes that hold the foot when it is glued to a base: the ends of the bottom rung.
    pub foot: [Node; 2],
    /// What densifying made of it.
    pub densified: Densified,
}

impl Ruffle {
    /// The node at position `k` of the walk, as an index.
    pub fn at(&self, k: usize) -> usize {
        self.walk[k].index()
    }

    /// The two ends of segment `k`, as indices.
    pub fn ends(&self, k: usize) -> (usize, usize) {
        (self.at(k), self.at(k + 1))
    }

    /// Segments in strip order as node index pairs.
    pub fn segments(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..self.rest_lengths.len()).map(|k| self.ends(k))
    }

    /// Rest length of section `section`, mm.
    pub fn section_length(&self, section: usize) -> f64 {
        self.rest_lengths[self.sections[section].segments()].iter().sum()
    }

    /// First and last node of section `section`.
    pub fn section_ends(&self, section: usize) -> (Node, Node) {
        let s = &self.sections[section];
        (self.walk[s.first_segment], self.walk[s.end_segment])
    }

    /// Changes a section's rest length by scaling its segments.
    pub fn set_section_length(&mut self, section: usize, length_mm: f64) {
        let scale = length_mm / self.section_length(section);
        let segments = self.sections[section].segments();
        self.rest_lengths[segments].iter_mut().for_each(|l| *l *= scale);
    }

    /// Length of the whole strip without end tabs, mm.
    pub fn strip_length(&self) -> f64 {
        self.rest_lengths.iter().sum()
    }

    /// Distance along the strip of every position of the walk, starting at 0, mm.
    pub fn stations(&self) -> Vec<f64> {
        let mut s = 0.0;
        std::iter::once(0.0)
            .chain(self.rest_lengths.iter().map(move |l| {
                s += l;
                s
            }))
            .collect()
    }

    /// Nodes the walk visits more than once, numbered in the order the strip first reaches them.
    pub fn connection_points(&self) -> Vec<ConnectionPoint> {
        let mut passes: Vec<Vec<usize>> = vec![Vec::new(); self.node_count];
        for (k, node) in self.walk.iter().enumerate() {
            passes[node.index()].push(k);
        }
        let mut met: Vec<(Node, Vec<usize>)> =
            passes.into_iter().enumerate().filter(|(_, p)| p.len() > 1).map(|(i, p)| (Node(i as u32), p)).collect();
        met.sort_by_key(|(_, p)| p[0]);
        met.into_iter()
            .enumerate()
            .map(|(i, (node, passes))| ConnectionPoint { node, joint: i as u32 + 1, passes })
            .collect()
    }
}
