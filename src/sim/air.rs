//! The paper's air mesh (section 4.1.3): sheets keep apart because the void between them, cut into triangles, may not turn inside out.
//!
//! It is a penalty: sheets that press on each other overlap a little, and where triangles are slivers they may pass through each other; the result says how often. Sheets have no thickness to it.
//! The barrier is what keeps them strictly apart.

mod build;
mod triangle;
mod triangulation;

use super::{Material, Pattern};
use crate::geom::P2;
use build::triangulate;
use triangulation::{INFINITE_QUALITY, Triangulation};

/// How far a node presses through a segment of mean length, mm, under the force it takes to fold a typical loop: a tenth of the barrier's reach.
const YIELD_MM: f64 = 0.03;
/// The force it takes to fold a typical loop is D w / R² with this radius, mm.
const TYPICAL_RADIUS_MM: f64 = 15.0;
/// And a share of the strip's weight: a sheet too soft to stand lies down, and then a few nodes carry all of it.
const WEIGHT_SHARE: f64 = 0.1;

/// The void round one ruffle.
#[derive(Debug, Clone)]
pub(super) struct AirMesh {
    segments: Vec<[usize; 2]>,
    /// Nothing before the first start was admitted.
    mesh: Option<Triangulation>,
    stiffness_n_per_mm3: f64,
}

impl AirMesh {
    /// For a ruffle of `segments`; lengths and widths come with [`AirMesh::measure`], the triangles with [`AirMesh::admit`].
    pub fn new(segments: impl Iterator<Item = (usize, usize)>) -> AirMesh {
        AirMesh { segments: segments.map(|(i, j)| [i, j]).collect(), mesh: None, stiffness_n_per_mm3: 0.0 }
    }

    /// Takes rest lengths (mm), widths at the nodes (mm), the sheet, and the weight of the whole strip (N).
    ///
    /// A node that has passed a segment of length h by depth d makes a triangle of area h d / 2 and is pushed back by k h² d / 4.
    pub fn measure(&mut self, rest_lengths_mm: &[f64], widths_mm: &[f64], material: &Material, weight_n: f64) {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let (h, width) = (mean(rest_lengths_mm), mean(widths_mm));
        let force_n = material.flexural_rigidity_n_mm * width / TYPICAL_RADIUS_MM.powi(2) + WEIGHT_SHARE * weight_n;
        self.stiffness_n_per_mm3 = 4.0 * force_n / (h * h * YIELD_MM);
    }

    /// Triangulates the void round a start. A start that cannot be triangulated keeps the triangles of the state before: what has passed through something is pushed
    /// back. False when there was none.
    pub fn admit(&mut self, x: &[P2]) -> bool {
        if let Some(mesh) = triangulate(&self.segments, x) {
            self.mesh = Some(mesh);
        }
        self.improve(x);
        self.mesh.is_some()
    }

    /// Flips sides where that makes triangles better; the energy at `x` stays the same.
    pub fn improve(&mut self, x: &[P2]) {
        if let Some(mesh) = &mut self.mesh {
            mesh.improve(x);
        }
    }

    /// Energy of the triangles that are inside out, N mm.
    pub fn energy(&self, x: &[P2]) -> f64 {
        self.finite().map(|[a, b, c]| triangle::energy(x[a], x[b], x[c], self.stiffness_n_per_mm3)).sum()
    }

    /// Adds the gradient of [`AirMesh::energy`], N.
    pub fn add_gradient(&self, x: &[P2], gradient: &mut [f64]) {
        for corners in self.inverted(x) {
            let [a, b, c] = corners.map(|node| x[node]);
            let g = triangle::gradient(a, b, c, self.stiffness_n_per_mm3);
            for (k, unknown) in unknowns(corners).into_iter().enumerate() {
                gradient[unknown] += g[k];
            }
        }
    }

    /// Adds the Hessian of [`AirMesh::energy`], N/mm; with `convex`, the part of it that is never indefinite. Every inverted triangle must be in the pattern.
    pub fn add_hessian(&self, x: &[P2], convex: bool, pattern: &Pattern, values: &mut [f64]) {
        for corners in self.inverted(x) {
            let [a, b, c] = corners.map(|node| x[node]);
            let block = triangle::hessian(a, b, c, self.stiffness_n_per_mm3, convex);
            let unknowns = unknowns(corners);
            for (i, row) in unknowns.iter().enumerate() {
                for (j, column) in unknowns.iter().enumerate().skip(i) {
                    if let Some(slot) = pattern.slot(*row, *column) {
                        values[slot] += block[(i, j)];
                    }
                }
            }
        }
    }

    /// True when the pattern has room for every inverted triangle.
    pub fn fits(&self, x: &[P2], pattern: &Pattern) -> bool {
        self.inverted(x).all(|[a, b, c]| {
            [(a, b), (b, c), (c, a)].into_iter().all(|(i, j)| pattern.slot(2 * i, 2 * j + 1).is_some())
        })
    }

    /// Unknowns of every triangle that is inverted or soon may be: as flat as those that the hull gives up.
    pub fn elements(&self, x: &[P2]) -> impl Iterator<Item = [usize; 6]> + '_ {
        let flat = |[a, b, c]: &[usize; 3]| triangle::quality(x[*a], x[*b], x[*c]) < INFINITE_QUALITY;
        let found: Vec<[usize; 6]> = self.finite().filter(flat).map(unknowns).collect();
        found.into_iter()
    }

    fn finite(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.mesh.iter().flat_map(Triangulation::finite)
    }

    fn inverted<'a>(&'a self, x: &'a [P2]) -> impl Iterator<Item = [usize; 3]> + 'a {
        self.finite().filter(|[a, b, c]| triangle::area(x[*a], x[*b], x[*c]) < 0.0)
    }
}

fn unknowns([a, b, c]: [usize; 3]) -> [usize; 6] {
    [2 * a, 2 * a + 1, 2 * b, 2 * b + 1, 2 * c, 2 * c + 1]
}

#[cfg(test)]
mod tests;
