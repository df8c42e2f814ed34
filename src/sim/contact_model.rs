//! What keeps the sheets of one ruffle apart, whichever the settings ask for.

use super::air::AirMesh;
use super::contact::Contacts;
use super::{Contact, Material, Pattern, find_crossings};
use crate::geom::P2;
use crate::ruffle::Ruffle;

/// Contact terms of one ruffle.
#[derive(Debug, Clone)]
pub(super) enum ContactModel {
    /// Sheets pass through each other.
    None,
    /// See [`Contacts`].
    Barrier(Contacts),
    /// See [`AirMesh`].
    AirMesh(AirMesh),
}

impl ContactModel {
    /// The terms of `ruffle` that `contact` asks for; lengths and widths come with [`ContactModel::measure`].
    pub fn new(contact: Contact, ruffle: &Ruffle) -> ContactModel {
        match contact {
            Contact::None => ContactModel::None,
            Contact::Barrier => ContactModel::Barrier(Contacts::new(ruffle)),
            Contact::AirMesh => ContactModel::AirMesh(AirMesh::new(ruffle.segments())),
        }
    }

    /// Takes rest lengths (mm), widths at the nodes (mm), the sheet, and the weight of the whole strip (N).
    pub fn measure(&mut self, rest_lengths_mm: &[f64], widths_mm: &[f64], material: &Material, weight_n: f64) {
        match self {
            ContactModel::None => {}
            ContactModel::Barrier(barrier) => barrier.measure(rest_lengths_mm, widths_mm, material, weight_n),
            ContactModel::AirMesh(air) => air.measure(rest_lengths_mm, widths_mm, material, weight_n),
        }
    }

    /// Gets ready to start at `x`; false when the strip (`segments`) lies there in a way that the terms can make nothing of.
    pub fn admit(&mut self, segments: impl Iterator<Item = (usize, usize)>, x: &[P2]) -> bool {
        match self {
            ContactModel::None => true,
            ContactModel::Barrier(barrier) => find_crossings(segments, x).is_empty() && barrier.admit(x),
            ContactModel::AirMesh(air) => air.admit(x),
        }
    }

    /// Shortens the step from `x` to `to` so that it ends before anything touches, and returns the share that is left. The terms are ready for any state up to
    /// there.
    pub fn advance(&mut self, x: &[P2], to: &mut [P2]) -> f64 {
        match self {
            ContactModel::Barrier(barrier) => barrier.advance(x, to),
            ContactModel::None | ContactModel::AirMesh(_) => 1.0,
        }
    }

    /// Adapts the terms to an accepted state without changing their energy there.
    pub fn adapt(&mut self, x: &[P2]) {
        if let ContactModel::AirMesh(air) = self {
            air.improve(x);
        }
    }

    /// Energy, N mm.
    pub fn energy(&self, x: &[P2]) -> f64 {
        match self {
            ContactModel::None => 0.0,
            ContactModel::Barrier(barrier) => barrier.energy(x),
            ContactModel::AirMesh(air) => air.energy(x),
        }
    }

    /// Adds the gradient of [`ContactModel::energy`], N.
    pub fn add_gradient(&self, x: &[P2], gradient: &mut [f64]) {
        match self {
            ContactModel::None => {}
            ContactModel::Barrier(barrier) => barrier.add_gradient(x, gradient),
            ContactModel::AirMesh(air) => air.add_gradient(x, gradient),
        }
    }

    /// Adds the Hessian of [`ContactModel::energy`], N/mm; with `convex`, the part of it that is never indefinite. The pattern must fit.
    pub fn add_hessian(&self, x: &[P2], convex: bool, pattern: &Pattern, values: &mut [f64]) {
        match self {
            ContactModel::None => {}
            ContactModel::Barrier(barrier) => barrier.add_hessian(x, convex, pattern, values),
            ContactModel::AirMesh(air) => air.add_hessian(x, convex, pattern, values),
        }
    }

    /// True when the pattern has room for every term active at `x`.
    pub fn fits(&self, x: &[P2], pattern: &Pattern) -> bool {
        match self {
            ContactModel::None => true,
            ContactModel::Barrier(barrier) => barrier.fits(x, pattern),
            ContactModel::AirMesh(air) => air.fits(x, pattern),
        }
    }

    /// Unknowns of every term that is active at `x` or soon may be.
    pub fn elements(&self, x: &[P2]) -> Vec<[usize; 6]> {
        match self {
            ContactModel::None => Vec::new(),
            ContactModel::Barrier(barrier) => barrier.elements(x).collect(),
            ContactModel::AirMesh(air) => air.elements(x).collect(),
        }
    }
}
