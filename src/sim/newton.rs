//! Newton's method with a floor.

use super::contact_model::ContactModel;
use super::model::Model;
use super::plate::Plate;
use super::turn::Turner;
use super::untangle::untangle;
use super::walk::Walk;
use super::{Equilibrium, Error, Factorisation, LdlT, Material, Outcome, Settings, Supports, find_crossings};
use crate::geom::{P2, V2};
use crate::progress::{Observer, Progress};
use crate::ruffle::{Node, Ruffle};

/// Finds the equilibrium of one ruffle, again and again as its lengths and widths change.
#[derive(Debug, Clone)]
pub struct Solver {
    model: Model,
    walk: Walk,
    contacts: ContactModel,
    plate: Plate,
    turner: Turner,
    factorisation: LdlT,
    material: Material,
    settings: Settings,
    /// Unknowns that never move.
    held: Vec<bool>,
    /// Whether a solve has been made, so that the next starts near rest.
    warm: bool,
    /// Whether the next step tries the exact Hessian.
    exact: bool,
    scratch: Scratch,
}

#[derive(Debug, Clone)]
struct Scratch {
    gradient: Vec<f64>,
    direction: Vec<f64>,
    hessian: Vec<f64>,
    fixed: Vec<bool>,
    trial: Vec<P2>,
}

/// Share of the membrane stiffness with which a first solve begins: a hundredth takes up to 40 % fewer steps than all of it (`cargo bench --bench solve`).
const SOFT_SHARE: f64 = 1e-2;
/// Sufficient decrease of a step (Armijo 1966).
const ARMIJO: f64 = 1e-4;
/// A node pressed down this close to the floor, mm, lies on it, and the next step puts it there exactly: left a hair above, it would cut every step
/// short, and its force would be counted as unbalanced.
const FLOOR_REACH_MM: f64 = 1e-6;
/// Halvings of a step before descent is called exhausted.
const MAX_HALVINGS: usize = 40;
/// Energies closer than this fraction are equal to within the rounding of their sums.
const ENERGY_ROUNDING: f64 = 1e-13;

impl Solver {
    /// Prepares to solve `ruffle` with the strip `widths_mm` wide at each node.
    pub fn new(
        ruffle: &Ruffle,
        widths_mm: &[f64],
        material: &Material,
        supports: &Supports,
        settings: &Settings,
    ) -> Result<Solver, Error> {
        let mut model = Model::new(ruffle);
        let pattern = model.pattern(std::iter::empty())?;
        let contacts = ContactModel::new(settings.contact, ruffle);
        let turner = Turner::new(ruffle.node_count, ruffle.segments())?;
        let unknowns = pattern.unknowns();
        let supported = supports.pinned.iter().chain(&supports.upright).map(|node| node.index() + 1).max();
        if let Some(found) = supported.filter(|found| *found > ruffle.node_count) {
            return Err(Error::Count { what: "nodes up to the supported one", found, expected: ruffle.node_count });
        }
        let mut held = vec![false; unknowns];
        for node in &supports.pinned {
            held[2 * node.index()] = true;
            held[2 * node.index() + 1] = true;
        }
        for node in &supports.upright {
            held[2 * node.index()] = true;
        }
        let scratch = Scratch {
            gradient: vec![0.0; unknowns],
            direction: vec![0.0; unknowns],
            hessian: vec![0.0; pattern.slots()],
            fixed: vec![false; unknowns],
            trial: vec![P2::origin(); ruffle.node_count],
        };
        let factorisation = LdlT::new(pattern);
        let mut solver = Solver {
            turner,
            model,
            walk: Walk::new(ruffle),
            contacts,
            plate: Plate::new(ruffle.node_count),
            factorisation,
            material: *material,
            settings: *settings,
            held,
            warm: false,
            exact: true,
            scratch,
        };
        solver.measure(ruffle, widths_mm)?;
        Ok(solver)
    }

    /// Takes the ruffle's current rest lengths, and the strip's width at each node. The topology must be the one the solver was made for.
    pub fn measure(&mut self, ruffle: &Ruffle, widths_mm: &[f64]) -> Result<(), Error> {
        let expected = self.scratch.trial.len();
        if widths_mm.len() != expected {
            return Err(Error::Count { what: "strip widths", found: widths_mm.len(), expected });
        }
        let (found, expected) = (ruffle.rest_lengths.len(), self.model.stretch_n_per_mm().len());
        if found != expected {
            return Err(Error::Count { what: "rest lengths of another topology", found, expected });
        }
        for (what, values) in [("strip width", widths_mm), ("rest length", &ruffle.rest_lengths)] {
            if let Some(index) = values.iter().position(|v| !(*v > 0.0 && v.is_finite())) {
                return Err(Error::NotPositive { what, index, value: values[index] });
            }
        }
        self.model.measure(&ruffle.rest_lengths, widths_mm, &self.material);
        let weight_n = self.model.weight_n();
        self.walk.measure(&ruffle.rest_lengths);
        self.contacts.measure(&ruffle.rest_lengths, widths_mm, &self.material, weight_n);
        self.plate.measure(widths_mm, &self.material, weight_n);
        Ok(())
    }

    /// Takes forces on nodes besides their weight (plane frame, N), in place of any they had: extra masses, hands, the part above. They stay until replaced.
    ///
    /// # Errors
    /// A node that the ruffle does not have, or a force that is not a number.
    pub fn load(&mut self, loads_n: &[(Node, V2)]) -> Result<(), Error> {
        let nodes = self.scratch.trial.len();
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
        self.model.load(loads_n.iter().map(|(node, force)| (node.index(), *force)));
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
        self.plate.press(load_n);
        Ok(())
    }

    /// Finds the rest position near `start` (plane frame, mm, one position per node). Held nodes stay where `start` has them, on the floor if that was below it.
    ///
    /// The first solve starts from a drawing, far from rest. There the directions ask for turns that do not fit together, and
    /// a stiff membrane cuts the steps short. So the first solve lets the strip settle with a soft membrane before it does so with the real one.
    pub fn solve(&mut self, start: &[P2], observer: &mut dyn Observer) -> Result<Equilibrium, Error> {
        self.check_start(start)?;
        let floor = self.settings.floor_mm;
        let mut x: Vec<P2> = start.iter().map(|p| P2::new(p.x, p.y.max(floor))).collect();
        let untangled = self.enter(&mut x)?;
        let mut iterations = 0;
        if !std::mem::replace(&mut self.warm, true) || untangled {
            self.model.set_stretch_share(SOFT_SHARE);
            let tolerance_n = self.model.weight_n() / x.len() as f64;
            self.settle(&mut x, tolerance_n, &mut iterations, observer)?;
            self.model.set_stretch_share(1.0);
        }
        if untangled {
            // Sheets laid close to each other have parted, and now keep their full distance.
            self.admit(&x)?;
        }
        let outcome = self.settle(&mut x, self.settings.residual_n, &mut iterations, observer)?;
        Ok(Equilibrium {
            outcome,
            iterations,
            residual_n: self.balance(&x),
            energy_n_mm: self.energy(&x),
            plate_mm: self.plate.height_mm(&x),
            max_strain: self.model.max_strain(&x),
            self_intersections: find_crossings(self.model.segments(), &x).len(),
            positions: x,
        })
    }

    /// Newton steps until no free node is unbalanced by more than `tolerance_n`.
    fn settle(
        &mut self,
        x: &mut Vec<P2>,
        tolerance_n: f64,
        iterations: &mut usize,
        observer: &mut dyn Observer,
    ) -> Result<Outcome, Error> {
        let mut energy = self.energy(x);
        self.exact = true;
        loop {
            let residual = self.balance(x);
            if residual <= tolerance_n {
                return Ok(Outcome::Converged);
            }
            if *iterations >= self.settings.max_iterations {
                return Ok(Outcome::Failed);
            }
            let progress = Progress { stage: "folding", done: *iterations as u64, total: 0, note: String::new() };
            if observer.step(progress).is_break() {
                return Ok(Outcome::Stopped);
            }
            *iterations += 1;
            self.make_room(x)?;
            match self.descend(x, energy, residual) {
                Some(lower) => energy = lower,
                None => return Ok(Outcome::Failed),
            }
        }
    }

    fn check_start(&self, start: &[P2]) -> Result<(), Error> {
        if start.len() != self.scratch.trial.len() {
            let expected = self.scratch.trial.len();
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
        Ok(self.balance(x))
    }

    /// Factors the Hessian of the last step again, false when it is not positive definite: what a step costs at least.
    pub fn factorise(&mut self) -> bool {
        self.factorisation.factor(&self.scratch.hessian)
    }

    /// Works out the gradient and which unknowns are fixed at `x`; returns the largest unbalanced force component, N. A node that lies on the
    /// floor and is pressed onto it is balanced by the floor.
    fn balance(&mut self, x: &[P2]) -> f64 {
        let Scratch { gradient, fixed, .. } = &mut self.scratch;
        self.model.gradient(x, gradient);
        self.contacts.add_gradient(x, gradient);
        self.plate.add_gradient(x, gradient);
        let mut residual = 0.0_f64;
        for (unknown, g) in gradient.iter().enumerate() {
            let on_floor = unknown % 2 == 1 && x[unknown / 2].y <= self.settings.floor_mm + FLOOR_REACH_MM && *g > 0.0;
            fixed[unknown] = self.held[unknown] || on_floor;
            if !fixed[unknown] {
                residual = residual.max(g.abs());
            }
        }
        residual
    }

    /// One projected Newton step (two-metric projection, Bertsekas 1982, doi:10.1137/0320018): exact Hessian where it is positive definite, its convex part
    /// elsewhere, damped as a last resort: a strip that touches nothing falls freely, and its Hessian is singular. Returns the lower energy, or nothing when no step descends.
    fn descend(&mut self, x: &mut Vec<P2>, energy: f64, residual: f64) -> Option<f64> {
        let fall_n_per_mm = self.model.weight_n() / self.settings.max_step_mm;
        for (convex, damping) in [(false, 0.0), (true, 0.0), (true, fall_n_per_mm)] {
            if !convex && !std::mem::replace(&mut self.exact, true) {
                continue;
            }
            if !self.newton_direction(x, convex, damping) {
                // While the membrane is soft, an indefinite Hessian mostly stays so for some steps: trying every other time is enough.
                self.exact = convex || !self.model.is_soft();
                continue;
            }
            if let Some(lower) = self.search(x, energy, residual) {
                return Some(lower);
            }
        }
        None
    }

    fn newton_direction(&mut self, x: &[P2], convex: bool, damping_n_per_mm: f64) -> bool {
        let Scratch { gradient, direction, hessian, fixed, .. } = &mut self.scratch;
        self.model.hessian(x, convex, hessian);
        self.contacts.add_hessian(x, convex, self.factorisation.pattern(), hessian);
        self.plate.add_hessian(x, self.factorisation.pattern(), hessian);
        self.factorisation.pattern().damp(hessian, damping_n_per_mm);
        self.factorisation.pattern().fix(hessian, fixed);
        if !self.factorisation.factor(hessian) {
            return false;
        }
        for (unknown, d) in direction.iter_mut().enumerate() {
            *d = if fixed[unknown] { 0.0 } else { -gradient[unknown] };
        }
        self.factorisation.solve(direction);
        if !self.plate.follow(x, fixed, &mut self.factorisation, direction) {
            return false;
        }
        let farthest = direction.chunks_exact(2).map(|d| d[0].hypot(d[1])).fold(0.0, f64::max);
        let by = |i: usize| V2::new(direction[2 * i], direction[2 * i + 1]);
        let most_turned =
            self.model.segments().map(|(i, j)| (by(j) - by(i)).norm() / (x[j] - x[i]).norm()).fold(0.0, f64::max);
        let share = (self.settings.max_step_mm / farthest).min(self.settings.max_turn_rad / most_turned);
        if share < 1.0 {
            direction.iter_mut().for_each(|d| *d *= share);
        }
        self.turner.prepare(self.model.stretch_n_per_mm(), fixed);
        farthest.is_finite()
    }

    /// Walks along the direction: projected onto the floor, no farther than the first touch, halved until the energy falls.
    fn search(&mut self, x: &mut Vec<P2>, energy: f64, residual: f64) -> Option<f64> {
        let rounding = ENERGY_ROUNDING * energy.abs();
        let mut t = 1.0;
        for _ in 0..MAX_HALVINGS {
            self.project(x, t);
            self.contacts.advance(x, &mut self.scratch.trial);
            let Scratch { gradient, trial, .. } = &self.scratch;
            let steps = trial.iter().zip(x.iter()).zip(gradient.chunks_exact(2));
            let decrease: f64 = steps.map(|((to, from), g)| g[0] * (from.x - to.x) + g[1] * (from.y - to.y)).sum();
            let lower = self.energy(trial);
            if lower <= energy - ARMIJO * decrease && lower < energy {
                std::mem::swap(x, &mut self.scratch.trial);
                return Some(lower);
            }
            // Close to rest the energy no longer resolves the step, but the force still does.
            if decrease.abs() <= rounding && lower <= energy + rounding {
                std::mem::swap(x, &mut self.scratch.trial);
                if self.balance(x) < residual {
                    return Some(lower);
                }
                std::mem::swap(x, &mut self.scratch.trial);
                self.balance(x);
            }
            t *= 0.5;
        }
        None
    }

    /// Follows the direction for a share `t` into the trial positions, nothing below the floor, what lies on it exactly on it.
    fn project(&mut self, x: &[P2], t: f64) {
        let floor = self.settings.floor_mm;
        let Scratch { direction, fixed, trial, .. } = &mut self.scratch;
        for (i, to) in trial.iter_mut().enumerate() {
            *to = P2::new(x[i].x + t * direction[2 * i], x[i].y + t * direction[2 * i + 1]);
        }
        self.turner.correct(x, trial);
        for (i, to) in trial.iter_mut().enumerate() {
            let lies_on_floor = fixed[2 * i + 1] && !self.held[2 * i + 1];
            to.y = if lies_on_floor { floor } else { to.y.max(floor) };
        }
    }

    fn energy(&self, x: &[P2]) -> f64 {
        self.model.energy(x) + self.contacts.energy(x) + self.plate.energy(x)
    }

    /// Refuses a state that the contact terms can make nothing of.
    fn admit(&mut self, x: &[P2]) -> Result<(), Error> {
        if self.contacts.admit(self.model.segments(), x) { Ok(()) } else { Err(self.walk.crossed(x)) }
    }

    /// Pulls a start that passes through itself apart, or refuses it; returns whether it had to.
    fn enter(&mut self, x: &mut Vec<P2>) -> Result<bool, Error> {
        let Err(refused) = self.admit(x) else { return Ok(false) };
        *x = untangle(&self.walk, x, &self.held, self.settings.floor_mm).ok_or(refused)?;
        self.admit(x).map(|()| true)
    }

    /// Analyses the system anew when sheets have come close that it has no room for.
    fn make_room(&mut self, x: &[P2]) -> Result<(), Error> {
        self.contacts.adapt(x);
        if !self.contacts.fits(x, self.factorisation.pattern()) {
            let pattern = self.model.pattern(self.contacts.elements(x).into_iter())?;
            self.scratch.hessian.resize(pattern.slots(), 0.0);
            self.factorisation = LdlT::new(pattern);
        }
        Ok(())
    }
}
