//! A ruffle as a mechanical system: which segments stretch, which pairs of segments bend against each other, what every node weighs.

use super::{Error, Material, Pattern, hinge, stretch::stretch};
use crate::geom::{P2, V2};
use crate::ruffle::Ruffle;

/// Two segments that bend against each other at a node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hinge {
    pub nodes: [usize; 3],
    pub segments: [usize; 2],
}

/// Energy terms of one ruffle. Unknown 2 i is the u of node i, unknown 2 i + 1 its v.
#[derive(Debug, Clone)]
pub(super) struct Model {
    pub(super) segments: Vec<[usize; 2]>,
    pub(super) hinges: Vec<Hinge>,
    pub(super) rest_mm: Vec<f64>,
    /// Stretching stiffness of each segment, N/mm.
    pub(super) stretch_n_per_mm: Vec<f64>,
    /// Bending stiffness of each hinge, N mm.
    pub(super) bend_n_mm: Vec<f64>,
    /// Weight carried by each node, N.
    weight_n: Vec<f64>,
    /// Weight of each segment, N/mm of its rest length.
    pub(super) weight_n_per_mm: Vec<f64>,
    /// Other force on each node, N.
    load_n: Vec<V2>,
    /// Slots of each segment's 4 x 4 and each hinge's 6 x 6 block, upper triangles by rows.
    slots: Vec<usize>,
    /// Share of the membrane stiffness in force.
    stretch_share: f64,
    /// Moment of each hinge, N mm, where the gradient was taken last.
    moment_n_mm: Vec<f64>,
}

impl Model {
    /// The terms of `ruffle`. Lengths and widths come with [`Model::measure`], a pattern with [`Model::pattern`].
    pub fn new(ruffle: &Ruffle) -> Model {
        let segments: Vec<[usize; 2]> = ruffle.segments().map(|(i, j)| [i, j]).collect();
        let hinges = hinges(ruffle);
        Model {
            rest_mm: vec![0.0; segments.len()],
            stretch_n_per_mm: vec![0.0; segments.len()],
            bend_n_mm: vec![0.0; hinges.len()],
            moment_n_mm: vec![0.0; hinges.len()],
            weight_n: vec![0.0; ruffle.node_count],
            weight_n_per_mm: vec![0.0; segments.len()],
            load_n: vec![V2::zeros(); ruffle.node_count],
            segments,
            hinges,
            slots: Vec::new(),
            stretch_share: 1.0,
        }
    }

    /// The pattern of the Hessian, with room for `more` elements (unknowns that other terms couple). The model's own Hessian is written for this pattern from
    /// now on.
    pub fn pattern(&mut self, more: impl Iterator<Item = [usize; 6]>) -> Result<Pattern, Error> {
        let unknowns = |nodes: &[usize]| nodes.iter().flat_map(|i| [2 * i, 2 * i + 1]).collect::<Vec<usize>>();
        let own: Vec<Vec<usize>> =
            self.segments.iter().map(|s| unknowns(s)).chain(self.hinges.iter().map(|h| unknowns(&h.nodes))).collect();
        let more: Vec<[usize; 6]> = more.collect();
        let elements = own.iter().map(Vec::as_slice).chain(more.iter().map(<[usize; 6]>::as_slice));
        let pattern = Pattern::new(2 * self.weight_n.len(), elements)?;
        self.slots.clear();
        for element in &own {
            for (a, i) in element.iter().enumerate() {
                for j in &element[a..] {
                    self.slots.push(pattern.slot(*i, *j).expect("the pattern was made from these elements"));
                }
            }
        }
        Ok(pattern)
    }

    /// Takes rest lengths (mm) and the strip's width at every node (mm), and works out stiffnesses and weights.
    pub fn measure(&mut self, rest_lengths_mm: &[f64], widths_mm: &[f64], material: &Material) {
        self.stretch_share = 1.0;
        self.rest_mm.copy_from_slice(rest_lengths_mm);
        self.weight_n.fill(0.0);
        for (k, [i, j]) in self.segments.iter().copied().enumerate() {
            let rest = rest_lengths_mm[k];
            let width = 0.5 * (widths_mm[i] + widths_mm[j]);
            self.stretch_n_per_mm[k] = material.membrane_stiffness_n_per_mm * width / rest;
            self.weight_n_per_mm[k] = width * material.weight_n_per_mm2();
            let half = 0.5 * rest * self.weight_n_per_mm[k];
            self.weight_n[i] += half;
            self.weight_n[j] += half;
        }
        for (c, h) in self.bend_n_mm.iter_mut().zip(&self.hinges) {
            let mean_rest = 0.5 * (rest_lengths_mm[h.segments[0]] + rest_lengths_mm[h.segments[1]]);
            *c = material.flexural_rigidity_n_mm * widths_mm[h.nodes[1]] / mean_rest;
        }
    }

    /// Takes a share of the membrane stiffness, until it is measured again or given another.
    pub fn set_stretch_share(&mut self, share: f64) {
        let by = share / self.stretch_share;
        self.stretch_share = share;
        self.stretch_n_per_mm.iter_mut().for_each(|k| *k *= by);
    }

    /// Whether only a share of the membrane stiffness is in force.
    pub fn is_soft(&self) -> bool {
        self.stretch_share < 1.0
    }

    /// Takes forces on nodes besides their weight, N; each replaces the one the node had.
    pub fn load(&mut self, loads_n: impl IntoIterator<Item = (usize, V2)>) {
        for (node, force) in loads_n {
            self.load_n[node] = force;
        }
    }

    /// Adds to the force on a node, N.
    pub fn add_load(&mut self, node: usize, load_n: V2) {
        self.load_n[node] += load_n;
    }

    /// Forces on the nodes besides their weight, N.
    pub fn loads_n(&self) -> &[V2] {
        &self.load_n
    }

    /// Total energy, N mm.
    pub fn energy(&self, x: &[P2]) -> f64 {
        let stretching: f64 = self
            .segments
            .iter()
            .zip(self.rest_mm.iter().zip(&self.stretch_n_per_mm))
            .map(|([i, j], (rest, k))| 0.5 * k * ((x[*j] - x[*i]).norm() - rest).powi(2))
            .sum();
        let bending: f64 = self
            .hinges
            .iter()
            .zip(&self.bend_n_mm)
            .map(|(h, c)| hinge::energy(x[h.nodes[0]], x[h.nodes[1]], x[h.nodes[2]], *c))
            .sum();
        let gravity: f64 = x.iter().zip(&self.weight_n).map(|(p, w)| w * p.y).sum();
        let loads: f64 = x.iter().zip(&self.load_n).map(|(p, f)| f.dot(&p.coords)).sum();
        stretching + bending + gravity - loads
    }

    /// Gradient of [`Model::energy`], N, one entry per unknown.
    pub fn gradient(&mut self, x: &[P2], gradient: &mut [f64]) {
        for (i, (w, load)) in self.weight_n.iter().zip(&self.load_n).enumerate() {
            gradient[2 * i] = -load.x;
            gradient[2 * i + 1] = w - load.y;
        }
        for (s, [i, j]) in self.segments.iter().copied().enumerate() {
            let (_, g, _) = stretch(x[i], x[j], self.rest_mm[s], self.stretch_n_per_mm[s], true);
            for axis in 0..2 {
                gradient[2 * i + axis] -= g[axis];
                gradient[2 * j + axis] += g[axis];
            }
        }
        for ((h, c), kept) in self.hinges.iter().zip(&self.bend_n_mm).zip(&mut self.moment_n_mm) {
            let [i, j, k] = h.nodes;
            let (moment, d_phi) = hinge::gradient(x[i], x[j], x[k], *c);
            *kept = moment;
            for (corner, node) in h.nodes.iter().enumerate() {
                for axis in 0..2 {
                    gradient[2 * node + axis] += moment * d_phi[2 * corner + axis];
                }
            }
        }
    }

    /// Hessian of [`Model::energy`] at `x`, where the gradient was taken last, N/mm, one entry per slot of the pattern; with `convex`, the part of it that is never
    /// indefinite.
    pub fn hessian(&self, x: &[P2], convex: bool, values: &mut [f64]) {
        values.fill(0.0);
        let mut slots = self.slots.iter();
        let mut add = |value: f64| {
            if let Some(slot) = slots.next() {
                values[*slot] += value;
            }
        };
        for (s, [i, j]) in self.segments.iter().copied().enumerate() {
            let (_, _, block) = stretch(x[i], x[j], self.rest_mm[s], self.stretch_n_per_mm[s], convex);
            for a in 0..4 {
                for b in a..4 {
                    let sign = if a / 2 == b / 2 { 1.0 } else { -1.0 };
                    add(sign * block[(a % 2, b % 2)]);
                }
            }
        }
        for ((h, c), moment) in self.hinges.iter().zip(&self.bend_n_mm).zip(&self.moment_n_mm) {
            let [i, j, k] = h.nodes;
            let block = hinge::hessian(x[i], x[j], x[k], *c, (!convex).then_some(*moment));
            for a in 0..6 {
                for b in a..6 {
                    add(block[(a, b)]);
                }
            }
        }
    }

    /// Stretching stiffness of every segment, N/mm.
    pub fn stretch_n_per_mm(&self) -> &[f64] {
        &self.stretch_n_per_mm
    }

    /// Weight of the strip, N.
    pub fn weight_n(&self) -> f64 {
        self.weight_n.iter().sum()
    }

    /// Largest relative change of a segment's length.
    pub fn max_strain(&self, x: &[P2]) -> f64 {
        self.segments
            .iter()
            .zip(&self.rest_mm)
            .map(|([i, j], rest)| ((x[*j] - x[*i]).norm() / rest - 1.0).abs())
            .fold(0.0, f64::max)
    }

    /// Segments as pairs of node indices.
    pub fn segments(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.segments.iter().map(|[i, j]| (*i, *j))
    }
}

/// Bending along the strip, and between the sheets that meet at a connection point.
///
/// Consecutive passes run through a connection in opposite directions (paper section 4.1.2, t_i = -t_j). So the first pass comes in on one side and leaves on the
/// other, the second the other way round, and every segment on one side should continue straight into every segment on the other.
fn hinges(ruffle: &Ruffle) -> Vec<Hinge> {
    let segments = ruffle.rest_lengths.len();
    let along = (1..segments)
        .map(|k| Hinge { nodes: [ruffle.at(k - 1), ruffle.at(k), ruffle.at(k + 1)], segments: [k - 1, k] });
    let mut hinges: Vec<Hinge> = along.collect();
    for connection in ruffle.connection_points() {
        let mut sides: [Vec<usize>; 2] = Default::default();
        for (n, pass) in connection.passes.iter().enumerate() {
            if *pass > 0 {
                sides[n % 2].push(pass - 1);
            }
            if *pass < segments {
                sides[1 - n % 2].push(*pass);
            }
        }
        let far_end = |segment: usize| {
            let (from, to) = ruffle.ends(segment);
            if from == connection.node.index() { to } else { from }
        };
        for a in &sides[0] {
            for b in &sides[1] {
                if a.abs_diff(*b) != 1 {
                    let nodes = [far_end(*a), connection.node.index(), far_end(*b)];
                    hinges.push(Hinge { nodes, segments: [*a, *b] });
                }
            }
        }
    }
    hinges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut::Outline;
    use crate::ruffle::{Drawn, StackSettings, draw_stack};

    fn paper() -> Material {
        Material {
            flexural_rigidity_n_mm: 2.1,
            membrane_stiffness_n_per_mm: 600.0,
            grammage_g_per_m2: 160.0,
            thickness_mm: 0.19,
        }
    }

    fn stack() -> Drawn {
        let p = |(x, y)| P2::new(x, y);
        let outer = [(0.0, 0.0), (80.0, 0.0), (80.0, 60.0), (0.0, 60.0)].map(p).to_vec();
        let settings = StackSettings { layers: Some(2), segment_mm: 8.0, ..StackSettings::default() };
        draw_stack(&Outline { outer, holes: Vec::new() }, &settings).unwrap()
    }

    /// The stack pushed out of shape, so that no term is at rest.
    fn disturbed() -> (Model, Pattern, Vec<P2>) {
        let drawn = stack();
        let mut model = Model::new(&drawn.ruffle);
        let pattern = model.pattern(std::iter::empty()).unwrap();
        let widths: Vec<f64> = (0..drawn.ruffle.node_count).map(|i| 60.0 + (i as f64).sin() * 20.0).collect();
        model.measure(&drawn.ruffle.rest_lengths, &widths, &paper());
        model.load([(3, V2::new(0.4, -0.9)), (20, V2::new(-0.1, 0.2))]);
        let wobble =
            |(i, p): (usize, &P2)| P2::new(p.x + 0.3 * (1.7 * i as f64).sin(), p.y + 0.3 * (2.3 * i as f64).cos());
        let x = drawn.positions.iter().enumerate().map(wobble).collect();
        (model, pattern, x)
    }

    fn nudged(x: &[P2], unknown: usize, by: f64) -> Vec<P2> {
        let mut x = x.to_vec();
        x[unknown / 2].coords[unknown % 2] += by;
        x
    }

    #[test]
    fn the_gradient_of_the_sum_matches_finite_differences() {
        let (mut model, _, x) = disturbed();
        let mut g = vec![0.0; 2 * x.len()];
        model.gradient(&x, &mut g);
        let largest = g.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (unknown, exact) in g.iter().enumerate() {
            let h = 1e-5;
            let slope = (model.energy(&nudged(&x, unknown, h)) - model.energy(&nudged(&x, unknown, -h))) / (2.0 * h);
            assert!((slope - exact).abs() < 1e-5 * largest, "unknown {unknown}: {slope} against {exact}");
        }
    }

    #[test]
    fn the_hessian_of_the_sum_matches_finite_differences() {
        let (mut model, pattern, x) = disturbed();
        let n = 2 * x.len();
        let mut values = vec![0.0; pattern.slots()];
        model.gradient(&x, &mut vec![0.0; n]);
        model.hessian(&x, false, &mut values);
        let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let (mut up, mut down) = (vec![0.0; n], vec![0.0; n]);
        for i in 0..n {
            let h = 1e-5;
            model.gradient(&nudged(&x, i, h), &mut up);
            model.gradient(&nudged(&x, i, -h), &mut down);
            for j in 0..n {
                let slope = (up[j] - down[j]) / (2.0 * h);
                let exact = pattern.slot(i, j).map_or(0.0, |slot| values[slot]);
                assert!((slope - exact).abs() < 1e-6 * largest, "({i}, {j}): {slope} against {exact}");
            }
        }
    }

    #[test]
    fn connections_add_two_hinges_each_and_one_at_the_strips_ends() {
        let drawn = stack();
        let model = Model::new(&drawn.ruffle);
        let along = drawn.ruffle.rest_lengths.len() - 1;
        assert_eq!(model.hinges.len() - along, 1 + 2 * 2 + 1);
    }

    #[test]
    fn the_nodes_carry_the_weight_of_the_sheet() {
        let drawn = stack();
        let mut model = Model::new(&drawn.ruffle);
        model.measure(&drawn.ruffle.rest_lengths, &vec![80.0; drawn.ruffle.node_count], &paper());
        let area_m2 = drawn.ruffle.strip_length() * 80.0 * 1e-6;
        let expected = area_m2 * 0.160 * 9.80665;
        let total = model.weight_n();
        assert!((total / expected - 1.0).abs() < 1e-12, "{total} N against {expected} N");
    }
}
