//! The layers of a stack, found again in its sections.

use super::Ruffle;
use std::ops::Range;

/// Sections of a layer: right loop, diagonal, left loop, rung.
const PER_LAYER: usize = 4;

/// One layer of a stack: the sections that stand for each of its sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// The rung it stands on.
    pub bottom: Range<usize>,
    /// The right loop.
    pub right: Range<usize>,
    /// The diagonal.
    pub diagonal: Range<usize>,
    /// The left loop.
    pub left: Range<usize>,
    /// The rung above it.
    pub top: Range<usize>,
}

impl Ruffle {
    /// The sections that stand for each section of the plain stack: densified and divided ones together.
    pub fn plain_sections(&self) -> Vec<Range<usize>> {
        let count = self.sections.len();
        let goes_on = |s: usize| {
            let inside = self.densified.made.iter().any(|m| m.first_section < s && s < m.end_section);
            inside || self.densified.midpoints.contains(&self.section_ends(s).0)
        };
        let starts: Vec<usize> = (0..count).filter(|s| *s == 0 || !goes_on(*s)).collect();
        let ends = starts.iter().skip(1).copied().chain([count]);
        starts.iter().copied().zip(ends).map(|(a, b)| a..b).collect()
    }

    /// The layers of a stack, the first at its foot; none where the ruffle is no stack.
    pub fn layers(&self) -> Vec<Layer> {
        let plain = self.plain_sections();
        if plain.len() % PER_LAYER != 1 {
            return Vec::new();
        }
        let layer = |w: &[Range<usize>]| Layer {
            bottom: w[0].clone(),
            right: w[1].clone(),
            diagonal: w[2].clone(),
            left: w[3].clone(),
            top: w[4].clone(),
        };
        plain.windows(PER_LAYER + 1).step_by(PER_LAYER).map(layer).collect()
    }

    /// Nodes around a layer; nothing where one of its sides is densified.
    pub fn layer_border(&self, layer: &Layer) -> Option<Vec<usize>> {
        let sides = [&layer.bottom, &layer.right, &layer.top, &layer.left];
        let densified = |side: &&Range<usize>| {
            self.densified.made.iter().any(|m| m.first_section < side.end && side.start < m.end_section)
        };
        if sides.iter().any(densified) {
            return None;
        }
        let nodes = |side: &Range<usize>| {
            let last = self.sections[side.end - 1].end_segment;
            (self.sections[side.start].first_segment..last).map(|k| (self.at(k), self.at(k + 1))).collect::<Vec<_>>()
        };
        // Bottom and right run with the border, top and left against it.
        let with = [&layer.bottom, &layer.right].into_iter().flat_map(|side| nodes(side).into_iter().map(|(i, _)| i));
        let against =
            [&layer.top, &layer.left].into_iter().flat_map(|side| nodes(side).into_iter().rev().map(|(_, j)| j));
        Some(with.chain(against).collect())
    }
}

#[cfg(test)]
mod tests {
    use crate::geom::signed_area;
    use crate::ruffle::{EditSettings, Limits, densify, uniform_stack};

    #[test]
    fn layers_are_found_and_bordered_whatever_was_densified() {
        let plain = uniform_stack(3, 20.0, 60.0, 2.0);
        let settings = EditSettings { segment_mm: 2.0, limits: Limits::default() };
        let dense = densify(&plain, &[5], 1, &settings).unwrap();
        assert_eq!((plain.ruffle.layers().len(), dense.ruffle.layers().len()), (3, 3));
        let border = |i: usize| dense.ruffle.layer_border(&dense.ruffle.layers()[i]);
        assert_eq!(border(1), None);
        let corners: Vec<_> = border(0).unwrap().iter().map(|n| dense.positions[*n]).collect();
        let exact = 20.0 * 60.0 + std::f64::consts::PI * 100.0;
        assert!((signed_area(&corners) / exact - 1.0).abs() < 0.01, "{}", signed_area(&corners));
    }
}
