//! How long a solve takes: `cargo bench --bench solve -- --json`.
//!
//! Families: `layers`, the paper's load-test stack (30 mm layers, 52.8 mm inner, h 5 mm) with 2 to 72 layers; `refined`, one stack (4 layers of 25 mm, 50 mm
//! inner) with ever shorter segments. Paper of 160 g/m², 80 mm wide, contact on, foot free. `warm` predicts and solves again after 5 % more length in the middle outer section.
//! With `--contact air` the same follows with the air mesh in place of the barrier: `layers-air` and `refined-air`.
//! Times are medians. `iteration_ms` is the median Newton step of the cold solve, all it takes (terms, contact, factorisations, search);
//! `iteration_per_factor` compares it with one numeric factorisation in the same run, so that it does not hang on the machine.

use furbelow::progress::{Observer, Progress, Quiet};
use furbelow::ruffle::{Drawn, Role, uniform_stack};
use furbelow::sim::{Contact, Equilibrium, Material, Outcome, Settings, Solver, Supports};
use serde::Serialize;
use std::ops::ControlFlow;
use std::time::Instant;

const PAPER_160: Material = Material {
    flexural_rigidity_n_mm: 2.1,
    membrane_stiffness_n_per_mm: 600.0,
    grammage_g_per_m2: 160.0,
    thickness_mm: 0.19,
};

#[derive(Serialize)]
struct Row {
    family: &'static str,
    nodes: usize,
    cold_ms: f64,
    warm_ms: f64,
    cold_iterations: usize,
    warm_iterations: usize,
    factor_ms: f64,
    iteration_ms: f64,
    iteration_per_factor: f64,
    residual_n: f64,
    residual_reduction: f64,
    max_strain: f64,
    crossings: usize,
    outcome: Outcome,
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let json = arguments.iter().any(|a| a == "--json");
    let with_air = arguments.windows(2).any(|a| a == ["--contact", "air"]);
    let mut runs = vec![("layers", "refined", Contact::Barrier)];
    if with_air {
        runs.push(("layers-air", "refined-air", Contact::AirMesh));
    }
    let families = runs.into_iter().flat_map(|(layers, refined, contact)| {
        let layers = [2, 7, 24, 72].map(|n| (layers, uniform_stack(n, 30.0, 52.8, 5.0), contact));
        let refined = [7.88, 2.63, 0.788].map(|h| (refined, uniform_stack(4, 25.0, 50.0, h), contact));
        layers.into_iter().chain(refined)
    });
    for (family, drawn, contact) in families {
        let row = measure(family, &drawn, contact);
        if json {
            println!("{}", serde_json::to_string(&row).expect("a row holds nothing JSON cannot"));
        } else {
            println!(
                "{:<11} {:>5} nodes  cold {:>8.2} ms in {:>3}  warm {:>7.2} ms in {:>3}  {:>4.1} factorisations a step  residual {:.1e} N  strain {:.1e}  {} crossings  {:?}",
                row.family,
                row.nodes,
                row.cold_ms,
                row.cold_iterations,
                row.warm_ms,
                row.warm_iterations,
                row.iteration_per_factor,
                row.residual_n,
                row.max_strain,
                row.crossings,
                row.outcome
            );
        }
    }
}

fn measure(family: &'static str, drawn: &Drawn, contact: Contact) -> Row {
    let repeats = if drawn.ruffle.node_count < 500 { 7 } else { 3 };
    let widths = vec![80.0; drawn.ruffle.node_count];
    let supports = Supports { pinned: Vec::new(), upright: vec![drawn.ruffle.foot[0]] };
    let settings = Settings { contact, ..Settings::default() };
    let new = || Solver::new(&drawn.ruffle, &widths, &PAPER_160, &supports, &settings).expect("a solver");

    let (mut times, mut steps) = (Vec::new(), Vec::new());
    let mut cold = None;
    for _ in 0..repeats {
        let began = Instant::now();
        let mut stopwatch = Stopwatch(Vec::new());
        cold = Some(new().solve(&drawn.positions, &mut stopwatch).expect("a solve"));
        times.push(began.elapsed().as_secs_f64() * 1e3);
        steps.extend(stopwatch.0.windows(2).map(|w| (w[1] - w[0]).as_secs_f64() * 1e3));
    }
    let cold: Equilibrium = cold.expect("at least one repeat");
    let (cold_ms, iteration_ms) = (median(times), median(steps));

    let mut longer = drawn.ruffle.clone();
    let outer: Vec<usize> = (0..longer.sections.len()).filter(|s| longer.sections[*s].role == Role::Outer).collect();
    let middle = outer[outer.len() / 2];
    longer.set_section_length(middle, 1.05 * longer.section_length(middle));
    let mut times = Vec::new();
    let mut warm = None;
    for _ in 0..repeats {
        let mut solver = new();
        solver.solve(&cold.positions, &mut Quiet).expect("a solve");
        let began = Instant::now();
        let start = solver.predict(&cold.positions, &longer, &widths).expect("the same topology");
        warm = Some(solver.solve(&start, &mut Quiet).expect("a solve"));
        times.push(began.elapsed().as_secs_f64() * 1e3);
    }
    let warm: Equilibrium = warm.expect("at least one repeat");

    let mut solver = new();
    let start = solver.residual_n(&drawn.positions).expect("a start that fits");
    solver.solve(&drawn.positions, &mut Quiet).expect("a solve");
    let factorisations = (0..20).map(|_| {
        let began = Instant::now();
        assert!(solver.factorise(), "the last step's Hessian is positive definite");
        began.elapsed().as_secs_f64() * 1e3
    });
    let factor_ms = median(factorisations.collect());
    Row {
        family,
        nodes: drawn.ruffle.node_count,
        cold_ms,
        warm_ms: median(times),
        cold_iterations: cold.iterations,
        warm_iterations: warm.iterations,
        factor_ms,
        iteration_ms,
        iteration_per_factor: iteration_ms / factor_ms,
        residual_n: cold.residual_n,
        residual_reduction: start / cold.residual_n,
        max_strain: cold.max_strain.max(warm.max_strain),
        crossings: cold.self_intersections + warm.self_intersections,
        outcome: if warm.outcome == Outcome::Converged { cold.outcome } else { warm.outcome },
    }
}

/// When each Newton step began.
struct Stopwatch(Vec<Instant>);

impl Observer for Stopwatch {
    fn step(&mut self, _: Progress) -> ControlFlow<()> {
        self.0.push(Instant::now());
        ControlFlow::Continue(())
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
