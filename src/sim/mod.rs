//! What a folded strip does under its own weight: positions of static equilibrium in physical units.
//!
//! The strip is a chain of segments (discrete shells reduced to a plane curve, paper section 4.1): bending at every node, stretch in every
//! segment, the tangency of connection points as bending between the sheets that meet, gravity, and a floor. Newton's method finds the
//! minimum of the energy; every term has an exact gradient and Hessian. A plate with a dead load may lie on top.

mod air;
mod anchors;
mod barrier;
mod ccd;
#[cfg(test)]
mod closed_forms;
mod contact;
mod contact_model;
mod crossings;
mod hinge;
mod ldl;
mod model;
mod nested;
mod newton;
mod plate;
#[cfg(test)]
mod press_tests;
mod settings;
mod solver;
mod stretch;
mod tangent;
#[cfg(test)]
mod tests;
mod turn;
mod untangle;
mod walk;

pub use crossings::find_crossings;
pub use ldl::{Factorisation, LdlT, Pattern};
pub use settings::{Contact, Error, Settings, StripPlace, Supports};
pub use solver::Solver;

use crate::geom::P2;
use serde::Serialize;

/// A sheet as the solver sees it, in the direction the strip runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Material {
    /// Bending stiffness per width, N mm.
    pub flexural_rigidity_n_mm: f64,
    /// Stretching stiffness per width (Young's modulus times thickness), N/mm.
    pub membrane_stiffness_n_per_mm: f64,
    /// Mass per area, g/m².
    pub grammage_g_per_m2: f64,
    /// Sheet thickness, mm.
    pub thickness_mm: f64,
}

/// Standard gravity, mm/s² (ISO 80000-3 gives 9.80665 m/s²).
pub const GRAVITY_MM_PER_S2: f64 = 9806.65;

impl Material {
    /// Weight per area, N/mm²: 1 g/m² is 1e-9 kg/mm², and 1 kg mm/s² is 1e-3 N.
    pub fn weight_n_per_mm2(&self) -> f64 {
        self.grammage_g_per_m2 * 1e-9 * GRAVITY_MM_PER_S2 * 1e-3
    }
}

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// Forces balance to the tolerance.
    Converged,
    /// The observer asked to stop; positions are the best so far.
    Stopped,
    /// No further descent, or the iteration limit; positions are the best so far.
    Failed,
}

/// Why a solve failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    /// The iteration limit of the settings.
    #[error(
        "not at rest after {0} steps: a shape that is close to tipping or folding over, or a start too far from rest"
    )]
    Steps(usize),
    /// No step lowers the energy any more, and forces do not balance: sheets are jammed, or rounding is reached.
    #[error(
        "no step leads nearer to rest: sheets are jammed, or forces are asked for more exactly than they can be worked out"
    )]
    NoDescent,
}

/// Where a strip came to rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Position of every node, plane frame, mm.
    pub positions: Vec<P2>,
    /// How the solve ended.
    pub outcome: Outcome,
    /// Why, where it failed.
    pub failure: Option<Failure>,
    /// Newton steps taken.
    pub iterations: usize,
    /// Largest unbalanced force component on a free node, N.
    pub residual_n: f64,
    /// Total energy, N mm.
    pub energy_n_mm: f64,
    /// Height of the plate's underside, plane frame, mm; nothing without one.
    pub plate_mm: Option<f64>,
    /// Largest relative change of a segment's length.
    pub max_strain: f64,
    /// Pairs of segments that pass through each other.
    pub self_intersections: usize,
}
