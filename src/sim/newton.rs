//! Newton's method with a floor, among sheets that may not pass through each other.

use super::anchors::Anchors;
use super::contact_model::ContactModel;
use super::model::Model;
use super::plate::Plate;
use super::turn::Turner;
use super::{Error, Factorisation, Failure, LdlT, Outcome, Settings};
use crate::geom::{P2, V2};
use crate::progress::{Observer, Progress};
use crate::ruffle::Ruffle;

/// The terms of one ruffle's energy, and the room to find where it is least.
#[derive(Debug, Clone)]
pub(super) struct System {
    pub model: Model,
    pub contacts: ContactModel,
    pub plate: Plate,
    pub anchors: Anchors,
    pub settings: Settings,
    /// Unknowns that never move.
    pub held: Vec<bool>,
    /// Why the last solve failed, if it did.
    pub failure: Option<Failure>,
    turner: Turner,
    factorisation: LdlT,
    /// Whether the next step tries the exact Hessian.
    exact: bool,
    /// Damping of the next step, N/mm.
    damping_n_per_mm: f64,
    scratch: Scratch,
}

#[derive(Debug, Clone)]
struct Scratch {
    gradient: Vec<f64>,
    direction: Vec<f64>,
    hessian: Vec<f64>,
    fixed: Vec<bool>,
    trial: Vec<P2>,
    farther: Vec<P2>,
}

/// How a walk along a direction ended.
enum Walked {
    /// At a lower energy, N mm; `whole` when all of the step was taken.
    Lower { energy: f64, whole: bool },
    /// Before sheets that lie in the way.
    Blocked,
    /// Nothing on the way was lower.
    Nowhere,
}

/// Sufficient decrease of a step (Armijo 1966).
const ARMIJO: f64 = 1e-4;
/// A node pressed down this close to the floor, mm, lies on it, and the next step puts it there exactly: left a hair above, it would cut every step
/// short, and its force would be counted as unbalanced.
const FLOOR_REACH_MM: f64 = 1e-6;
/// A strip that nothing holds falls this far in a damped step, mm.
const FALL_MM: f64 = 20.0;
/// A step that sheets in the way would cut to less than this share is damped instead. Cut, it would end before the nearest pair again and again, each time
/// closer; damped, it turns and slides less, and the pair still moves apart by as much as its force asks for.
const LEAST_SHARE: f64 = 0.25;
/// How much stronger damping gets from one attempt to the next, and how much weaker after a step taken whole.
const MORE_DAMPING: f64 = 16.0;
const LESS_DAMPING: f64 = 0.25;
/// Damping below this share of the curvature along the step no longer changes it.
const LEAST_DAMPING_SHARE: f64 = 0.01;
/// Directions tried from one place. With the last, any step will do.
const MAX_ATTEMPTS: usize = 12;
/// Halvings of a step before descent is called exhausted.
const MAX_HALVINGS: usize = 40;
/// Where the energy curves down along the direction, a step this many times as long is tried too: near a balance that is unstable the convex part of the Hessian
/// would lead away from it by small steps.
const FARTHER: f64 = 4.0;
/// Energies closer than this fraction are equal to within the rounding of their sums.
const ENERGY_ROUNDING: f64 = 1e-13;

impl System {
    /// The terms of `ruffle`; lengths and widths are yet to be measured.
    pub fn new(ruffle: &Ruffle, held: Vec<bool>, settings: &Settings) -> Result<System, Error> {
        let mut model = Model::new(ruffle);
        let pattern = model.pattern(std::iter::empty())?;
        let unknowns = pattern.unknowns();
        let scratch = Scratch {
            gradient: vec![0.0; unknowns],
            direction: vec![0.0; unknowns],
            hessian: vec![0.0; pattern.slots()],
            fixed: vec![false; unknowns],
            trial: vec![P2::origin(); ruffle.node_count],
            farther: vec![P2::origin(); ruffle.node_count],
        };
        Ok(System {
            model,
            contacts: ContactModel::new(settings.contact, ruffle),
            plate: Plate::new(ruffle.node_count),
            anchors: Anchors::default(),
            settings: *settings,
            held,
            failure: None,
            turner: Turner::new(ruffle.node_count, ruffle.segments())?,
            factorisation: LdlT::new(pattern),
            exact: true,
            damping_n_per_mm: 0.0,
            scratch,
        })
    }

    /// Newton steps until no free node is unbalanced by more than `tolerance_n`.
    pub fn settle(
        &mut self,
        x: &mut Vec<P2>,
        tolerance_n: f64,
        iterations: &mut usize,
        observer: &mut dyn Observer,
    ) -> Result<Outcome, Error> {
        let mut energy = self.energy(x);
        self.exact = true;
        self.damping_n_per_mm = 0.0;
        self.failure = None;
        loop {
            let residual = self.balance(x);
            if residual <= tolerance_n {
                return Ok(Outcome::Converged);
            }
            if *iterations >= self.settings.max_iterations {
                self.failure = Some(Failure::Steps(*iterations));
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
                None => {
                    self.failure = Some(Failure::NoDescent);
                    return Ok(Outcome::Failed);
                }
            }
        }
    }

    /// Factors the Hessian of the last step again, false when it is not positive definite.
    pub fn factorise(&mut self) -> bool {
        self.factorisation.factor(&self.scratch.hessian)
    }

    /// Works out the gradient and which unknowns are fixed at `x`; returns the largest unbalanced force component, N. A node that lies on the
    /// floor and is pressed onto it is balanced by the floor.
    pub fn balance(&mut self, x: &[P2]) -> f64 {
        let Scratch { gradient, fixed, .. } = &mut self.scratch;
        self.model.gradient(x, gradient);
        self.contacts.add_gradient(x, gradient);
        self.plate.add_gradient(x, gradient);
        self.anchors.add_gradient(x, gradient);
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

    /// Total energy, N mm.
    pub fn energy(&self, x: &[P2]) -> f64 {
        self.model.energy(x) + self.contacts.energy(x) + self.plate.energy(x) + self.anchors.energy(x)
    }

    /// One projected Newton step (two-metric projection, Bertsekas 1982, doi:10.1137/0320018): exact Hessian where it is positive definite, its convex part
    /// elsewhere. It is damped (Levenberg 1944, Marquardt 1963) where sheets lie in the way, and where a strip that touches nothing falls freely and its Hessian is
    /// singular. Returns the lower energy, or nothing when no step descends.
    fn descend(&mut self, x: &mut Vec<P2>, energy: f64, residual: f64) -> Option<f64> {
        let fall_n_per_mm = self.model.weight_n() / FALL_MM;
        let mut convex = !std::mem::replace(&mut self.exact, true);
        let mut damping = self.damping_n_per_mm;
        for attempt in 1..=MAX_ATTEMPTS {
            let Some(room) = self.newton_direction(x, convex, damping).then(|| self.limit(x)) else {
                if convex {
                    damping = (MORE_DAMPING * damping).max(fall_n_per_mm);
                } else {
                    // While the membrane is soft, an indefinite Hessian mostly stays so for some steps: trying every other time is enough.
                    self.exact = !self.model.is_soft();
                    convex = true;
                }
                continue;
            };
            let least_share = if attempt < MAX_ATTEMPTS { LEAST_SHARE } else { 0.0 };
            match self.search(x, energy, residual, least_share, room) {
                Walked::Lower { energy, whole } => {
                    let next = if whole { LESS_DAMPING * damping } else { damping };
                    self.damping_n_per_mm = if next < LEAST_DAMPING_SHARE * self.curvature() { 0.0 } else { next };
                    return Some(energy);
                }
                Walked::Blocked => {
                    damping = MORE_DAMPING * damping.max(self.curvature());
                    convex = true;
                }
                Walked::Nowhere if convex => damping = (MORE_DAMPING * damping).max(fall_n_per_mm),
                Walked::Nowhere => convex = true,
            }
        }
        None
    }

    /// Works out the direction of a step from `x`; false when the Hessian is not positive definite.
    fn newton_direction(&mut self, x: &[P2], convex: bool, damping_n_per_mm: f64) -> bool {
        let Scratch { hessian, fixed, .. } = &mut self.scratch;
        self.model.hessian(x, convex, hessian);
        self.contacts.add_hessian(x, convex, self.factorisation.pattern(), hessian);
        self.plate.add_hessian(x, self.factorisation.pattern(), hessian);
        self.anchors.add_hessian(self.factorisation.pattern(), hessian);
        self.factorisation.pattern().damp(hessian, damping_n_per_mm);
        self.factorisation.pattern().fix(hessian, fixed);
        self.factorisation.factor(hessian) && self.solve_direction(x)
    }

    /// Works out the direction against the gradient with the factor there is; false where it is not finite.
    fn solve_direction(&mut self, x: &[P2]) -> bool {
        let Scratch { gradient, direction, fixed, .. } = &mut self.scratch;
        for (unknown, d) in direction.iter_mut().enumerate() {
            *d = if fixed[unknown] { 0.0 } else { -gradient[unknown] };
        }
        self.factorisation.solve(direction);
        self.plate.follow(x, fixed, &mut self.factorisation, direction) && direction.iter().all(|d| d.is_finite())
    }

    /// Shortens the direction to what a step from `x` may be; returns how many times its length it may be followed at most.
    fn limit(&mut self, x: &[P2]) -> f64 {
        let Scratch { direction, fixed, .. } = &mut self.scratch;
        let squared = |d: &[f64]| d[0] * d[0] + d[1] * d[1];
        let farthest = direction.chunks_exact(2).map(squared).fold(0.0, f64::max).sqrt();
        let by = |i: usize| V2::new(direction[2 * i], direction[2 * i + 1]);
        let turned = self.model.segments().map(|(i, j)| (by(j) - by(i)).norm_squared() / (x[j] - x[i]).norm_squared());
        let most_turned = turned.fold(0.0, f64::max).sqrt();
        let room = (self.settings.max_step_mm / farthest).min(self.settings.max_turn_rad / most_turned);
        if room < 1.0 {
            direction.iter_mut().for_each(|d| *d *= room);
        }
        self.turner.prepare(self.model.stretch_n_per_mm(), fixed);
        room.max(1.0)
    }

    /// How the state of rest `x` answers changes of its gradient (N per unknown): minus the inverse of the exact Hessian, mm per unknown, for each of them. Nothing where that
    /// is not positive definite.
    pub fn responses(&mut self, x: &[P2], changes: &[Vec<f64>]) -> Result<Option<Vec<Vec<f64>>>, Error> {
        self.make_room(x)?;
        self.balance(x);
        let mut responses = Vec::with_capacity(changes.len());
        for change in changes {
            self.scratch.gradient.copy_from_slice(change);
            let solved =
                if responses.is_empty() { self.newton_direction(x, false, 0.0) } else { self.solve_direction(x) };
            if !solved {
                return Ok(None);
            }
            responses.push(self.scratch.direction.clone());
        }
        Ok(Some(responses))
    }

    /// Follows `moves` (mm per node) from `x`, turning instead of stretching, and through nothing.
    pub fn walk_along(&mut self, x: &[P2], moves: &[V2]) -> Vec<P2> {
        self.balance(x);
        for (d, m) in self.scratch.direction.chunks_exact_mut(2).zip(moves) {
            d.copy_from_slice(&[m.x, m.y]);
        }
        self.limit(x);
        self.follow(x, 1.0);
        self.scratch.trial.clone()
    }

    /// Curvature of the energy along the direction, as the last Hessian has it, N/mm.
    fn curvature(&self) -> f64 {
        let Scratch { gradient, direction, .. } = &self.scratch;
        let slope: f64 = gradient.iter().zip(direction).map(|(g, d)| -g * d).sum();
        slope / direction.iter().map(|d| d * d).sum::<f64>()
    }

    /// Walks along the direction: projected onto the floor, no farther than the first touch, halved until the energy falls. Where sheets in the way leave less than
    /// `least_share` of it, nothing is done.
    fn search(&mut self, x: &mut Vec<P2>, energy: f64, residual: f64, least_share: f64, room: f64) -> Walked {
        let rounding = ENERGY_ROUNDING * energy.abs();
        let mut t = 1.0;
        let mut blocked = false;
        for _ in 0..MAX_HALVINGS {
            let open = self.follow(x, t);
            let lower = self.energy(&self.scratch.trial);
            blocked |= open < 1.0 || lower.is_infinite();
            if blocked && t * open < least_share {
                return Walked::Blocked;
            }
            let whole = t * open == 1.0;
            let decrease = self.decrease(x);
            if lower <= energy - ARMIJO * decrease && lower < energy {
                let curves_down = energy - lower > decrease + rounding;
                let lowest = if whole && curves_down && room > 1.0 { self.farther(x, room, lower) } else { lower };
                std::mem::swap(x, &mut self.scratch.trial);
                return Walked::Lower { energy: lowest, whole };
            }
            // Close to rest the energy no longer resolves the step, but the force still does.
            if decrease.abs() <= rounding && lower <= energy + rounding {
                std::mem::swap(x, &mut self.scratch.trial);
                if self.balance(x) < residual {
                    return Walked::Lower { energy: lower, whole };
                }
                std::mem::swap(x, &mut self.scratch.trial);
                self.balance(x);
            }
            t *= 0.5;
        }
        Walked::Nowhere
    }

    /// Decrease of the energy from `x` to the trial positions, if it were a plane, N mm.
    fn decrease(&self, x: &[P2]) -> f64 {
        let Scratch { gradient, trial, .. } = &self.scratch;
        let steps = trial.iter().zip(x).zip(gradient.chunks_exact(2));
        steps.map(|((to, from), g)| g[0] * (from.x - to.x) + g[1] * (from.y - to.y)).sum()
    }

    /// Tries a longer step where the trial positions, of energy `lower`, are on a slope that steepens. The better of the two is left in the trial positions; returns
    /// its energy.
    fn farther(&mut self, x: &[P2], room: f64, lower: f64) -> f64 {
        std::mem::swap(&mut self.scratch.trial, &mut self.scratch.farther);
        self.follow(x, FARTHER.min(room));
        let lowest = self.energy(&self.scratch.trial);
        if lowest < lower {
            return lowest;
        }
        std::mem::swap(&mut self.scratch.trial, &mut self.scratch.farther);
        self.contacts.advance(x, &mut self.scratch.trial);
        lower
    }

    /// Follows the direction for a share `t` into the trial positions, but not through anything; returns the share of that way that was open.
    fn follow(&mut self, x: &[P2], t: f64) -> f64 {
        self.project(x, t);
        self.contacts.advance(x, &mut self.scratch.trial)
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
