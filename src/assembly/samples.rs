//! Parts for tests, folded by hand.

use crate::cut::{Outline, PlaneFrame};
use crate::extrude::Span;
use crate::fit::{FootUsed, Part, Report, Spent};
use crate::geom::{P2, P3, Rect, V3};
use crate::ruffle::{Direction, Node, Role, Ruffle, Section};
use crate::sim::{Equilibrium, Outcome};

/// A part that lies where it was drawn.
pub(super) fn part_of(ruffle: Ruffle, positions: Vec<P2>) -> Part {
    let bounds = Rect::around(&positions);
    let (a, b) = (bounds.min, bounds.max);
    let outer = vec![a, P2::new(b.x, a.y), b, P2::new(a.x, b.y)];
    Part {
        name: "A".into(),
        frame: PlaneFrame { origin: P3::origin(), u: V3::x(), v: V3::y(), normal: V3::z() },
        outline: Outline { outer, holes: Vec::new() },
        spans: vec![Span { lo: -15.0, hi: 15.0 }; ruffle.node_count],
        report: Report {
            uncovered_fraction: 0.0,
            protruding_fraction: 0.0,
            covered: Vec::new(),
            foot: FootUsed::Free,
            stands: true,
            strip_length_mm: ruffle.strip_length(),
            strip_mass_g: 1.0,
            min_radius_mm: 10.0,
            tightest_section: 0,
            thinnest_layer_mm: 10.0,
            layers: 1,
            direction: Direction::Vertical,
            spent: Spent::default(),
            min_void_mm: 10.0,
            thinnest_void: P2::origin(),
        },
        loads_n: Vec::new(),
        ruffle,
        equilibrium: equilibrium(positions),
    }
}

fn equilibrium(positions: Vec<P2>) -> Equilibrium {
    Equilibrium {
        positions,
        outcome: Outcome::Converged,
        failure: None,
        iterations: 0,
        residual_n: 0.0,
        energy_n_mm: 0.0,
        plate_mm: None,
        max_strain: 0.0,
        self_intersections: 0,
    }
}

/// A strip straight from corner to corner; corners in the same place are one node.
pub(super) fn rect_part(corners: &[P2]) -> Part {
    let mut nodes: Vec<P2> = Vec::new();
    let walk: Vec<Node> = corners
        .iter()
        .map(|c| {
            let known = nodes.iter().position(|n| n == c).unwrap_or_else(|| {
                nodes.push(*c);
                nodes.len() - 1
            });
            Node(known as u32)
        })
        .collect();
    let rest_lengths: Vec<f64> = corners.windows(2).map(|w| (w[1] - w[0]).norm()).collect();
    let sections =
        vec![Section { role: Role::Outer, first_segment: 0, end_segment: rest_lengths.len(), pinned: false }];
    let foot = [walk[0], walk[1]];
    let ruffle = Ruffle { node_count: nodes.len(), walk, rest_lengths, sections, foot, densified: Default::default() };
    part_of(ruffle, nodes)
}
