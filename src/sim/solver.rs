//! The solver as the rest of the house sees it.

use super::newton::System;
use super::untangle::untangle;
use super::walk::Walk;
use super::{Equilibrium, Error, Material, Settings, Supports, find_crossings};
use crate::geom::{P2, V2};
use crate::progress::Observer;
use crate::ruffle::{Node, Ruffle};

/// Finds the equilibrium of one ruffle, again and again as its lengths, widths and loads change.
#[derive(Debug, Clone)]
pub struct Solver {
    pub(super) system: System,
    walk: Walk,
    pub(super) ruffle: Ruffle,
    pub(super) widths_mm: Vec<f64>,
    pub(super) material: Material,
    pub(super) supports: Supports,
    /// Whether a solve has been made, so that the next starts near rest.
    warm: bool,
}

/// Share of the membrane stiffness with which a first solve begins: far from rest the whole of it cuts most steps short.
const SOFT_SHARE: f64 = 1e-2;
/// A start strained more than this is far from rest too: with its real stiffness the membrane would drive sheets into each other with hundreds of newtons.
const FAR_STRAIN: f64 = 0.01;

impl Solver {
    /// Prepares to solve `ruffle` with the strip `widths_mm` wide at each node.
    ///
    /// # Errors
    /// Widths or lengths that do not match the ruffle or are not positive, and supports on nodes that it does not have.
    pub fn new(
        ruffle: &Ruffle,
        widths_mm: &[f64],
        material: &Material,
        supports: &Supports,
        settings: &Settings,
    ) -> Result<Solver, Error> {
        let supported = supports.pinned.iter().chain(&supports.upright).map(|node| node.index() + 1).max();
        if let Some(found) = supported.filter(|found| *found > ruffle.node_count) {
            return Err(Error::Count { what: "nodes up to the supported one", found, expected: ruffle.node_count });
        }
        let mut held = vec![false; 2 * ruffle.node_count];
        for node in &supports.pinned {
            held[2 * node.index()] = true;
            held[2 * node.index() + 1] = true;
        }
        for node in &supports.upright {
            held[2 * node.index()] = true;
        }
        let system = System::new(ruffle, held, settings)?;
        let mut solver = Solver {
            system,
            walk: Walk::new(ruffle),
            ruffle: ruffle.clone(),
            widths_mm: widths_mm.to_vec(),
            material: *material,
            supports: supports.clone(),
            warm: false,
        };
        solver.measure(ruffle, widths_mm)?;
        Ok(solver)
    }

    /// Takes the ruffle's current rest lengths, and the strip's width at each node. The topology must be the one the solver was made for.
    pub fn measure(&mut self, ruffle: &Ruffle, widths_mm: &[f64]) -> Result<(), Error> {
        let expected = self.system.held.len() / 2;
        if widths_mm.len() != expected {
            return Err(Error::Count { what: "strip widths", found: widths_mm.len(), expected });
        }
        let (found, expected) = (ruffle.rest_lengths.len(), self.system.model.stretch_n_per_mm().len());
        if found != expected {
            return Err(Error::Count { what: "rest lengths of another topology", found, expected });
        }
        for (what, values) in [("strip width", widths_mm), ("rest length", &ruffle.rest_lengths)] {
            if let Some(index) = values.iter().position(|v| !(*v > 0.0 && v.is_finite())) {
                return Err(Error::NotPositive { what, index, value: values[index] });
            }
        }
        self.system.model.measure(&ruffle.rest_lengths, widths_mm, &self.material);
        let weight_n = self.system.model.weight_n();
        self.walk.measure(&ruffle.rest_lengths);
        self.system.contacts.measure(&ruffle.rest_lengths, widths_mm, &self.material, weight_n);
        self.system.plate.measure(widths_mm, &self.material, weight_n);
        self.ruffle.rest_lengths.copy_from_slice(&ruffle.rest_lengths);
        self.widths_mm.copy_from_slice(widths_mm);
        Ok(())
    }

    /// Takes a ruffle of another topology, after an edit, with its widths and supports. The next solve starts near rest, from the positions the edit gave. A plate
    /// stays; loads on nodes go, because the nodes have other numbers now.
    ///
    /// # Errors
    /// As [`Solver::new`]; the solver then stays as it was.
    pub fn change(&mut self, ruffle: &Ruffle, widths_mm: &[f64], supports: &Supports) -> Result<(), Error> {
        let mut changed = Solver::new(ruffle, widths_mm, &self.material, supports, &self.system.settings)?;
        changed.press(self.system.plate.load_n())?;
        changed.warm = self.warm;
        *self = changed;
        Ok(())
    }

    /// Takes forces on nodes besides their weight (plane frame, N), in place of any they had: extra masses, hands, the part above. They stay until replaced.
    ///
    /// # Errors
    /// A node that the ruffle does not have, or a force that is not a number.
    pub fn load(&mut self, loads_n: &[(Node, V2)]) -> Result<(), Error> {
        let nodes = self.system.held.len() / 2;
        for (node, force) in loads_n {
            if node.index() >= nodes {
                return Err(Error::Count {
                    what: "nodes up to the loaded one",
                    found: node.index() + 1,
                    expected: nodes,
                });
            }
            if !(force.x.is_finite() && force.y.is_finite()) {
                return Err(Error::NotFinite { node: node.index() });
            }
        }
        self.system.model.load(loads_n.iter().map(|(node, force)| (node.index(), *force)));
        Ok(())
    }

    /// Lays a rigid, horizontal plate on the ruffle that weighs `load_n` (N) with all that stands on it, in place of any that lay there; `None` takes it away. It slides
    /// up and down without friction, does not tilt, and always lies on the ruffle: the next solve starts with it on the highest nodes of its start.
    ///
    /// # Errors
    /// A load that is negative or not a number.
    pub fn press(&mut self, load_n: Option<f64>) -> Result<(), Error> {
        if let Some(load_n) = load_n
            && !(load_n >= 0.0 && load_n.is_finite())
        {
            return Err(Error::PlateLoad { load_n });
        }
        self.system.plate.press(load_n);
        Ok(())
    }

    /// Finds the rest position near `start` (plane frame, mm, one position per node). Held nodes stay where `start` has them, on the floor if that was below it.
    ///
    /// The first solve starts from a drawing, far from rest. There the directions ask for turns that do not fit together, and
    /// a stiff membrane cuts the steps short. So the first solve lets the strip settle with a soft membrane before it does so with the real one.
    pub fn solve(&mut self, start: &[P2], observer: &mut dyn Observer) -> Result<Equilibrium, Error> {
        self.check_start(start)?;
        let floor = self.system.settings.floor_mm;
        let mut x: Vec<P2> = start.iter().map(|p| P2::new(p.x, p.y.max(floor))).collect();
        let untangled = self.enter(&mut x)?;
        let (mut iterations, mut coarse_iterations) = (0, 0);
        let far = self.system.model.max_strain(&x) > FAR_STRAIN;
        if !std::mem::replace(&mut self.warm, true) || untangled || far {
            match self.nested_start(&x, &mut coarse_iterations, observer)? {
                Some(near_rest) => x = near_rest,
                None => self.soften(&mut x, &mut iterations, observer)?,
            }
        }
        if untangled {
            // Sheets laid close to each other have parted, and now keep their full distance.
            self.admit(&x)?;
        }
        let outcome = self.system.settle(&mut x, self.system.settings.residual_n, &mut iterations, observer)?;
        Ok(Equilibrium {
            outcome,
            failure: self.system.failure,
            iterations: coarse_iterations + iterations,
            residual_n: self.system.balance(&x),
            energy_n_mm: self.system.energy(&x),
            plate_mm: self.system.plate.height_mm(&x),
            max_strain: self.system.model.max_strain(&x),
            self_intersections: find_crossings(self.system.model.segments(), &x).len(),
            positions: x,
        })
    }

    /// Lets the strip settle roughly with a soft membrane.
    fn soften(&mut self, x: &mut Vec<P2>, iterations: &mut usize, observer: &mut dyn Observer) -> Result<(), Error> {
        let system = &mut self.system;
        let tolerance_n = system.settings.residual_n.max(system.model.weight_n() / x.len() as f64);
        system.model.set_stretch_share(SOFT_SHARE);
        let settled = system.settle(x, tolerance_n, iterations, observer);
        system.model.set_stretch_share(1.0);
        settled.map(|_| ())
    }

    fn check_start(&self, start: &[P2]) -> Result<(), Error> {
        if start.len() != self.system.held.len() / 2 {
            let expected = self.system.held.len() / 2;
            return Err(Error::Count { what: "start positions", found: start.len(), expected });
        }
        if let Some(node) = start.iter().position(|p| !(p.x.is_finite() && p.y.is_finite())) {
            return Err(Error::NotFinite { node });
        }
        Ok(())
    }

    /// Largest unbalanced force at `x`, N: how far a state is from rest.
    ///
    /// # Errors
    /// Positions that do not match the ruffle, or in which the strip passes through itself.
    pub fn residual_n(&mut self, x: &[P2]) -> Result<f64, Error> {
        self.check_start(x)?;
        self.admit(x)?;
        Ok(self.system.balance(x))
    }

    /// Factors the Hessian of the last step again, false when it is not positive definite: what a step costs at least.
    pub fn factorise(&mut self) -> bool {
        self.system.factorise()
    }

    /// Refuses a state that the contact terms can make nothing of.
    pub(super) fn admit(&mut self, x: &[P2]) -> Result<(), Error> {
        let System { contacts, model, .. } = &mut self.system;
        if contacts.admit(model.segments(), x) { Ok(()) } else { Err(self.walk.crossed(x)) }
    }

    /// Pulls a start that passes through itself apart, or refuses it; returns whether it had to.
    fn enter(&mut self, x: &mut Vec<P2>) -> Result<bool, Error> {
        let Err(refused) = self.admit(x) else { return Ok(false) };
        *x = untangle(&self.walk, x, &self.system.held, self.system.settings.floor_mm).ok_or(refused)?;
        self.admit(x).map(|()| true)
    }
}
