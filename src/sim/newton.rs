//! Newton's method with a floor.

use super::contact::Contacts;
use super::model::Model;
use super::turn::Turner;
use super::{Equilibrium, Factorisation, LdlT, Material, Outcome, find_crossings};
use crate::geom::{P2, V2};
use crate::progress::{Observer, Progress};
use crate::ruffle::{Node, Ruffle};

/// Accuracy and limits of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Unbalanced force at which a solve has converged, N. A millionth of a newton is a thousandth of the weight of one node of a paper strip.
    pub residual_n: f64,
    /// Newton steps after which it gives up.
    pub max_iterations: usize,
    /// Farthest a node may move in one step, mm: beyond it the quadratic model means nothing.
    pub max_step_mm: f64,
    /// Height of the floor, plane frame, mm; minus infinity for none.
    pub floor_mm: f64,
    /// Whether sheets keep each other out. Without it strips may pass through themselves.
    pub contact: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { residual_n: 1e-6, max_iterations: 400, max_step_mm: 20.0, floor_mm: 0.0, contact: true }
    }
}

/// What holds the ruffle, besides the floor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Supports {
    /// Nodes that do not move at all.
    pub pinned: Vec<Node>,
    /// Nodes that move up and down only.
    pub upright: Vec<Node>,
}

/// Why a solve could not start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// An array does not match the ruffle.
    #[error("{what}: {found} values for {expected} nodes")]
    Count {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Nodes of the ruffle.
        expected: usize,
    },
    /// A width, length or stiffness that is not a positive number.
    #[error("{what} {index} is {value}; it must be a positive number")]
    NotPositive {
        /// Which quantity.
        what: &'static str,
        /// Which one.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A start position or a force that is not a number.
    #[error("the position or force given for node {node} is not finite")]
    NotFinite {
        /// The node.
        node: usize,
    },
    /// A start in which the strip passes through itself, or sheets lie on each other.
    #[error(
        "the strip starts out passing through itself in {crossings} places, first where segments {first} and {second} meet near u {u_mm:.1}, v {v_mm:.1} mm; draw it with other layers"
    )]
    Crossed {
        /// Pairs of segments that cross; 0 when sheets only lie on each other.
        crossings: usize,
        /// A segment, in strip order.
        first: usize,
        /// Another.
        second: usize,
        /// Where they meet.
        u_mm: f64,
        /// Where they meet.
        v_mm: f64,
    },
    /// The ordering of unknowns failed.
    #[error("could not order {unknowns} unknowns: {status}")]
    Ordering {
        /// Number of unknowns.
        unknowns: usize,
        /// What the ordering said.
        status: String,
    },
}

/// Finds the equilibrium of one ruffle, again and again as its lengths and widths change.
#[derive(Debug, Clone)]
pub struct Solver {
    model: Model,
    contacts: Option<Contacts>,
    turner: Turner,
    factorisation: LdlT,
    material: Material,
    settings: Settings,
    /// Unknowns that never move.
    held: Vec<bool>,
    /// Whether a solve has been made, so that the next starts near rest.
    warm: bool,
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
        let contacts = settings.contact.then(|| Contacts::new(ruffle));
        let turner = Turner::new(ruffle.node_count, ruffle.segments())?;
        let unknowns = pattern.unknowns();
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
            contacts,
            factorisation,
            material: *material,
            settings: *settings,
            held,
            warm: false,
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
        for (what, values) in [("strip width", widths_mm), ("rest length", &ruffle.rest_lengths)] {
            if let Some(index) = values.iter().position(|v| !(*v > 0.0 && v.is_finite())) {
                return Err(Error::NotPositive { what, index, value: values[index] });
            }
        }
        self.model.measure(&ruffle.rest_lengths, widths_mm, &self.material);
        if let Some(contacts) = &mut self.contacts {
            contacts.measure(&ruffle.rest_lengths, widths_mm, &self.material, self.model.weight_n());
        }
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

    /// Finds the rest position near `start` (plane frame, mm, one position per node) to rest. Held nodes stay where `start` has them, on the floor if that was below it.
    ///
    /// The first solve starts from a drawing, far from rest. There the directions ask for turns that do not fit together, and
    /// a stiff membrane cuts the steps short. So the first solve lets the strip settle with a soft membrane before it does so with the real one.
    pub fn solve(&mut self, start: &[P2], observer: &mut dyn Observer) -> Result<Equilibrium, Error> {
        self.check_start(start)?;
        let floor = self.settings.floor_mm;
        let mut x: Vec<P2> = start.iter().map(|p| P2::new(p.x, p.y.max(floor))).collect();
        self.admit(&x)?;
        let mut iterations = 0;
        if !std::mem::replace(&mut self.warm, true) {
            self.model.set_stretch_share(SOFT_SHARE);
            let tolerance_n = self.model.weight_n() / x.len() as f64;
            self.settle(&mut x, tolerance_n, &mut iterations, observer)?;
            self.model.set_stretch_share(1.0);
        }
        let outcome = self.settle(&mut x, self.settings.residual_n, &mut iterations, observer)?;
        Ok(Equilibrium {
            outcome,
            iterations,
            residual_n: self.balance(&x),
            energy_n_mm: self.energy(&x),
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
        loop {
            let residual = self.balance(x);
            if residual <= tolerance_n {
                return Ok(Outcome::Converged);
            }
            if *iterations >= self.settings.max_iterations {
                return Ok(Outcome::Failed);
            }
            let progress = Progress {
                stage: "folding",
                done: *iterations as u64,
                total: 0,
                note: format!("unbalanced force {residual:.1e} N"),
            };
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
        if let Some(contacts) = &self.contacts {
            contacts.add_gradient(x, gradient);
        }
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
            if !self.newton_direction(x, convex, damping) {
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
        if let Some(contacts) = &self.contacts {
            contacts.add_hessian(x, convex, self.factorisation.pattern(), hessian);
        }
        self.factorisation.pattern().damp(hessian, damping_n_per_mm);
        self.factorisation.pattern().fix(hessian, fixed);
        if !self.factorisation.factor(hessian) {
            return false;
        }
        for (unknown, d) in direction.iter_mut().enumerate() {
            *d = if fixed[unknown] { 0.0 } else { -gradient[unknown] };
        }
        self.factorisation.solve(direction);
        let farthest = direction.chunks_exact(2).map(|d| d[0].hypot(d[1])).fold(0.0, f64::max);
        if farthest > self.settings.max_step_mm {
            let scale = self.settings.max_step_mm / farthest;
            direction.iter_mut().for_each(|d| *d *= scale);
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
            if let Some(contacts) = &mut self.contacts {
                let trial = &mut self.scratch.trial;
                contacts.collect(x, trial);
                let open = contacts.open_share(x, trial);
                if open < 1.0 {
                    trial.iter_mut().zip(x.iter()).for_each(|(to, from)| *to = from + (*to - from) * open);
                }
            }
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
                let trial = self.scratch.trial.clone();
                if self.balance(&trial) < residual {
                    *x = trial;
                    return Some(lower);
                }
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
        self.model.energy(x) + self.contacts.as_ref().map_or(0.0, |contacts| contacts.energy(x))
    }

    /// Refuses a start that passes through itself.
    fn admit(&mut self, x: &[P2]) -> Result<(), Error> {
        let Some(contacts) = &mut self.contacts else { return Ok(()) };
        let crossings = find_crossings(self.model.segments(), x);
        if crossings.is_empty() && contacts.admit(x) {
            return Ok(());
        }
        let (first, second) = crossings.first().copied().unwrap_or((0, 0));
        let (i, _) = self.model.segments().nth(first).unwrap_or((0, 0));
        Err(Error::Crossed { crossings: crossings.len(), first, second, u_mm: x[i].x, v_mm: x[i].y })
    }

    /// Analyses the system anew when sheets have come close that it has no room for.
    fn make_room(&mut self, x: &[P2]) -> Result<(), Error> {
        if let Some(contacts) = &self.contacts
            && !contacts.fits(x, self.factorisation.pattern())
        {
            let pattern = self.model.pattern(contacts.elements(x))?;
            self.scratch.hessian.resize(pattern.slots(), 0.0);
            self.factorisation = LdlT::new(pattern);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut::Outline;
    use crate::progress::Quiet;
    use crate::ruffle::{Drawn, Role, Section, StackSettings, draw_stack};

    /// A straight strip of `n` segments behind a clamp: a first segment without length to speak of, both its nodes pinned, which gives the hinge at the
    /// clamp half a cell.
    fn cantilever(n: usize, length_mm: f64) -> (Ruffle, Vec<P2>, Supports) {
        let h = length_mm / n as f64;
        let clamp = 1e-6 * h;
        let mut rest_lengths = vec![clamp];
        rest_lengths.extend(std::iter::repeat_n(h, n));
        let walk: Vec<Node> = (0..n as u32 + 2).map(Node).collect();
        let positions: Vec<P2> =
            std::iter::once(-clamp).chain((0..=n).map(|i| i as f64 * h)).map(|x| P2::new(x, 0.0)).collect();
        let sections = vec![Section { role: Role::Outer, first_segment: 0, end_segment: n + 1 }];
        let ruffle = Ruffle { node_count: n + 2, walk, rest_lengths, sections, foot: [Node(0), Node(1)] };
        (ruffle, positions, Supports { pinned: vec![Node(0), Node(1)], upright: Vec::new() })
    }

    fn paper(flexural_rigidity_n_mm: f64) -> Material {
        Material {
            flexural_rigidity_n_mm,
            membrane_stiffness_n_per_mm: 600.0,
            grammage_g_per_m2: 160.0,
            thickness_mm: 0.19,
        }
    }

    fn sagged(n: usize, load: f64) -> (f64, f64, Equilibrium) {
        let length: f64 = 100.0;
        let q = paper(1.0).weight_n_per_mm2();
        let material = paper(q * length.powi(3) / load);
        let (ruffle, start, supports) = cantilever(n, length);
        // The strip weighs 6 mN: its shape to five digits needs forces to a few nN.
        let settings = Settings { floor_mm: f64::NEG_INFINITY, residual_n: 2e-9, ..Settings::default() };
        let mut solver = Solver::new(&ruffle, &vec![40.0; n + 2], &material, &supports, &settings).unwrap();
        let e = solver.solve(&start, &mut Quiet).unwrap();
        let tip = e.positions[n + 1];
        (-tip.y / length, tip.x / length, e)
    }

    #[test]
    fn a_heavy_cantilever_hangs_as_the_elastica_does() {
        // th'' = -b (1 - s) cos th, b = q L^3 / EI: drop / L and reach / L of its numerical solution.
        for (b, drop, reach) in [(1.0, 0.123471, 0.991246), (4.0, 0.425159, 0.890111), (8.0, 0.640631, 0.724425)] {
            let (d, r, e) = sagged(80, b);
            assert_eq!(e.outcome, Outcome::Converged, "b = {b}: {e:?}");
            assert!((d - drop).abs() < 1.5e-3 && (r - reach).abs() < 2e-3, "b = {b}: {d} {r}");
        }
    }

    #[test]
    fn the_error_falls_with_the_square_of_the_segment() {
        let error = |n| (sagged(n, 8.0).0 - 0.640631_f64).abs();
        let ratio = error(20) / error(40);
        assert!((3.0..5.5).contains(&ratio), "ratio {ratio}");
    }

    #[test]
    fn nothing_passes_through_the_floor_and_the_force_still_balances() {
        let (ruffle, mut start, supports) = cantilever(60, 150.0);
        start.iter_mut().for_each(|p| p.y = 20.0);
        let mut solver = Solver::new(&ruffle, &vec![40.0; 62], &paper(0.3), &supports, &Settings::default()).unwrap();
        let e = solver.solve(&start, &mut Quiet).unwrap();
        assert_eq!(e.outcome, Outcome::Converged, "{e:?}");
        assert!(e.positions.iter().all(|p| p.y >= 0.0));
        assert!(e.positions.iter().filter(|p| p.y == 0.0).count() > 5);
        assert!(e.residual_n <= 1e-6 && e.max_strain < 1e-3);
    }

    #[test]
    fn bad_input_is_refused_by_name() {
        let (ruffle, start, supports) = cantilever(5, 50.0);
        let solver = |widths: &[f64]| Solver::new(&ruffle, widths, &paper(1.0), &supports, &Settings::default());
        assert!(matches!(solver(&[1.0; 3]), Err(Error::Count { .. })));
        assert!(matches!(solver(&[0.0; 7]), Err(Error::NotPositive { .. })));
        let mut broken = start;
        broken[3].x = f64::NAN;
        let refused = solver(&[10.0; 7]).unwrap().solve(&broken, &mut Quiet);
        assert_eq!(refused, Err(Error::NotFinite { node: 3 }));
    }

    #[test]
    fn an_observer_can_stop_a_solve() {
        struct Stop;
        impl Observer for Stop {
            fn step(&mut self, _: Progress) -> std::ops::ControlFlow<()> {
                std::ops::ControlFlow::Break(())
            }
        }
        let (ruffle, mut start, supports) = cantilever(20, 100.0);
        start.iter_mut().for_each(|p| p.y = 20.0);
        let mut solver = Solver::new(&ruffle, &[40.0; 22], &paper(1.0), &supports, &Settings::default()).unwrap();
        assert_eq!(solver.solve(&start, &mut Stop).unwrap().outcome, Outcome::Stopped);
    }

    /// Solves one step at a time, so that every accepted state can be looked at; returns the last.
    fn watched(solver: &mut Solver, start: &[P2]) -> Equilibrium {
        solver.settings.max_iterations = 1;
        let mut x = start.to_vec();
        let mut energy = f64::INFINITY;
        for step in 0..300 {
            let e = solver.solve(&x, &mut Quiet).unwrap();
            assert_eq!(e.self_intersections, 0, "step {step}");
            // The first step is made with the soft membrane.
            let rounding = 1e-13 * energy.abs();
            assert!(step < 2 || e.energy_n_mm <= energy + rounding, "step {step}: {} after {energy}", e.energy_n_mm);
            if e.outcome == Outcome::Converged {
                return e;
            }
            energy = e.energy_n_mm;
            x = e.positions;
        }
        panic!("did not come to rest: {} N", solver.residual_n(&x).unwrap());
    }

    /// A stack on a pinned foot, 60 mm wide.
    fn standing(drawn: &Drawn, material: &Material) -> Solver {
        let supports = Supports { pinned: drawn.ruffle.foot.to_vec(), upright: Vec::new() };
        let widths = vec![60.0; drawn.ruffle.node_count];
        Solver::new(&drawn.ruffle, &widths, material, &supports, &Settings::default()).unwrap()
    }

    /// Forces that press the top section down, `total_n` in all.
    fn pressed(drawn: &Drawn, total_n: f64) -> Vec<(Node, V2)> {
        let top = drawn.ruffle.sections[drawn.ruffle.sections.len() - 1].segments();
        let each = V2::new(0.0, -total_n / top.len() as f64);
        top.map(|k| (drawn.ruffle.walk[k], each)).collect()
    }

    fn square_stack() -> Drawn {
        let outer = [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)].map(|(x, y)| P2::new(x, y)).to_vec();
        let settings = StackSettings { layers: Some(4), ..StackSettings::default() };
        draw_stack(&Outline { outer, holes: Vec::new() }, &settings).unwrap()
    }

    #[test]
    fn a_stack_pressed_flat_lies_on_itself_and_never_passes_through() {
        let drawn = square_stack();
        let mut solver = standing(&drawn, &paper(2.1));
        let mut x = drawn.positions.clone();
        let mut height = f64::INFINITY;
        for grams in [0.0, 100.0, 200.0, 400.0, 700.0, 1000.0] {
            solver.load(&pressed(&drawn, grams * 9.80665e-3)).unwrap();
            let e = watched(&mut solver, &x);
            let top = e.positions.iter().map(|p| p.y).fold(0.0, f64::max);
            assert!(top < height, "{grams} g: {top} mm high after {height}");
            assert!(e.max_strain < 1e-3);
            (x, height) = (e.positions, top);
        }
        assert!(height < 60.0, "{height} mm high under 1 kg");
    }

    #[test]
    fn thick_sheets_keep_their_thickness_apart_away_from_joints() {
        let drawn = square_stack();
        let felt = Material { thickness_mm: 1.0, grammage_g_per_m2: 220.0, ..paper(0.8) };
        let mut solver = standing(&drawn, &felt);
        let mut x = drawn.positions.clone();
        for grams in [0.0, 100.0, 200.0, 300.0] {
            solver.load(&pressed(&drawn, grams * 9.80665e-3)).unwrap();
            x = watched(&mut solver, &x).positions;
        }
        // Node by segment, leaving out what is within 20 mm along the strip of a joint, where sheets part from one another.
        let stations = drawn.ruffle.stations();
        let joints: Vec<f64> = drawn
            .ruffle
            .connection_points()
            .iter()
            .flat_map(|c| c.passes.iter().map(|k| stations[*k]).collect::<Vec<f64>>())
            .collect();
        let far = |k: usize| joints.iter().all(|j| (stations[k] - j).abs() > 20.0);
        let mut closest = f64::INFINITY;
        for k in (0..drawn.ruffle.walk.len()).filter(|k| far(*k)) {
            for s in
                (0..drawn.ruffle.rest_lengths.len()).filter(|s| far(*s) && (stations[*s] - stations[k]).abs() > 20.0)
            {
                let (i, j) = drawn.ruffle.ends(s);
                closest = closest.min(crate::geom::distance_to_segment(x[drawn.ruffle.at(k)], x[i], x[j]));
            }
        }
        assert!((1.0..1.3).contains(&closest), "sheets touch at {closest} mm");
    }

    #[test]
    fn a_start_that_crosses_is_refused_with_the_place() {
        let mut drawn = square_stack();
        let top = drawn.positions.iter().map(|p| p.y).fold(0.0, f64::max);
        drawn.positions.iter_mut().filter(|p| p.y > 0.9 * top).for_each(|p| p.y -= 40.0);
        let widths = vec![60.0; drawn.ruffle.node_count];
        let mut solver =
            Solver::new(&drawn.ruffle, &widths, &paper(2.1), &Supports::default(), &Settings::default()).unwrap();
        let refused = solver.solve(&drawn.positions, &mut Quiet).unwrap_err();
        assert!(matches!(refused, Error::Crossed { crossings: 1.., .. }), "{refused}");
    }
}
