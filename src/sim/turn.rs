//! Steps that turn the strip instead of stretching it.
//!
//! A Newton direction turns segments; followed along straight lines it lengthens them by the square of the step, and the stiff membrane cuts every step short (the Maratos
//! effect). So a step is followed along a curve with the same tangent: every segment turns by its angle and changes its length by what the direction says, and the
//! nodes are put where they satisfy all segments best in the least squares (the global step of Sorkine and Alexa 2007, *As-rigid-as-possible surface modeling*,
//! doi:10.2312/SGP/SGP07/109-116, with the membrane's stiffness as weights). That is a Laplace system over the nodes, small beside Newton's.

use super::{Error, Factorisation, LdlT, Pattern};
use crate::geom::{P2, V2};

/// Follows directions of one ruffle.
#[derive(Debug, Clone)]
pub(super) struct Turner {
    segments: Vec<[usize; 2]>,
    /// One system for u and one for v: different nodes are fixed in them.
    axes: [Axis; 2],
}

#[derive(Debug, Clone)]
struct Axis {
    system: LdlT,
    values: Vec<f64>,
    fixed: Vec<bool>,
    weights: Vec<f64>,
    correction: Vec<f64>,
    ready: bool,
}

impl Turner {
    /// For a ruffle of `nodes` nodes joined by `segments`.
    pub fn new(nodes: usize, segments: impl Iterator<Item = (usize, usize)>) -> Result<Turner, Error> {
        let segments: Vec<[usize; 2]> = segments.map(|(i, j)| [i, j]).collect();
        let pattern = Pattern::new(nodes, segments.iter().map(<[usize; 2]>::as_slice))?;
        let axis = Axis {
            values: vec![0.0; pattern.slots()],
            fixed: vec![false; nodes],
            weights: Vec::new(),
            correction: vec![0.0; nodes],
            ready: false,
            system: LdlT::new(pattern),
        };
        Ok(Turner { segments, axes: [axis.clone(), axis] })
    }

    /// Takes each segment's weight and which unknowns (u and v of every node) are fixed; factors what changed.
    pub fn prepare(&mut self, weights: &[f64], fixed: &[bool]) {
        for (k, axis) in self.axes.iter_mut().enumerate() {
            let held = fixed.iter().skip(k).step_by(2).copied();
            if axis.weights == weights && axis.fixed.iter().copied().eq(held.clone()) {
                continue;
            }
            axis.weights.clear();
            axis.weights.extend_from_slice(weights);
            axis.fixed.clear();
            axis.fixed.extend(held);
            axis.values.fill(0.0);
            let pattern = axis.system.pattern();
            for ([i, j], w) in self.segments.iter().zip(weights) {
                for (a, b, value) in [(i, i, *w), (j, j, *w), (i, j, -w)] {
                    let slot = pattern.slot(*a, *b).expect("the pattern was made from these segments");
                    axis.values[slot] += value;
                }
            }
            pattern.fix(&mut axis.values, &axis.fixed);
            axis.ready = axis.system.factor(&axis.values);
        }
    }

    /// Corrects `to`, reached from `x` along a straight line, to lie on the curve. Where nothing is fixed along an axis there is nothing to hold on to, and it is left as
    /// it is.
    pub fn correct(&mut self, x: &[P2], to: &mut [P2]) {
        if !self.axes.iter().all(|axis| axis.ready) {
            return;
        }
        self.axes.iter_mut().for_each(|axis| axis.correction.fill(0.0));
        for (s, [i, j]) in self.segments.iter().copied().enumerate() {
            let (e, straight) = (x[j] - x[i], to[j] - to[i]);
            let missing = turned(e, straight - e) - straight;
            for (k, axis) in self.axes.iter_mut().enumerate() {
                let pull = axis.weights[s] * missing[k];
                axis.correction[i] -= pull;
                axis.correction[j] += pull;
            }
        }
        for (k, axis) in self.axes.iter_mut().enumerate() {
            for (pull, fixed) in axis.correction.iter_mut().zip(&axis.fixed) {
                *pull = if *fixed { 0.0 } else { *pull };
            }
            axis.system.solve(&mut axis.correction);
            for (p, c) in to.iter_mut().zip(&axis.correction) {
                p.coords[k] += c;
            }
        }
    }
}

/// A segment `e` after a step `by` of its end against its start: longer by the part along it, turned by the part across it.
fn turned(e: V2, by: V2) -> V2 {
    let length = e.norm();
    let along = e / length;
    let (longer, angle) = (by.dot(&along), (along.x * by.y - along.y * by.x) / length);
    nalgebra::Rotation2::new(angle) * along * (length + longer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_swung_about_its_end_keeps_its_length() {
        let x: Vec<P2> = (0..6).map(|i| P2::new(f64::from(i), 0.0)).collect();
        let mut turner = Turner::new(6, (0..5).map(|i| (i, i + 1))).unwrap();
        let mut fixed = vec![false; 12];
        (fixed[0], fixed[1]) = (true, true);
        turner.prepare(&[3.0; 5], &fixed);
        let angle = 0.8;
        let mut to: Vec<P2> = x.iter().map(|p| P2::new(p.x, angle * p.x)).collect();
        turner.correct(&x, &mut to);
        for (k, p) in to.iter().enumerate() {
            let r = k as f64;
            assert!((p - P2::new(r * angle.cos(), r * angle.sin())).norm() < 1e-12, "{p}");
        }
    }

    #[test]
    fn the_curve_has_the_direction_as_its_tangent() {
        let x = [(0.0, 0.0), (1.0, 0.3), (2.0, -0.2), (2.5, 1.0)].map(|(u, v)| P2::new(u, v));
        let d = [(0.0, 0.0), (0.3, 0.5), (-0.4, 0.2), (0.1, -0.6)].map(|(u, v)| V2::new(u, v));
        let mut turner = Turner::new(4, [(0, 1), (1, 2), (2, 3), (3, 0)].into_iter()).unwrap();
        let mut fixed = vec![false; 8];
        (fixed[0], fixed[1]) = (true, true);
        turner.prepare(&[1.0, 2.0, 3.0, 4.0], &fixed);
        let away = |t: f64, turner: &mut Turner| {
            let straight: Vec<P2> = x.iter().zip(&d).map(|(p, d)| p + d * t).collect();
            let mut to = straight.clone();
            turner.correct(&x, &mut to);
            to.iter().zip(&straight).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
        };
        let ratio = away(1e-2, &mut turner) / away(1e-3, &mut turner);
        assert!((80.0..120.0).contains(&ratio), "the correction is of second order: {ratio}");
    }
}
