//! Whether stacks come to rest under load: `cargo bench --bench press [-- --json]`.
//!
//! Stacks of the paper's load test (30 mm layers, 52.8 mm inner, paper of 160 g/m², 80 mm wide, foot free) with 2 and 4 layers, segments of 1 to 5 mm and sheets
//! 0 to 1 mm thick are let settle and then pressed in one go, by a plate and by forces on the top section. A row a thickness: how many did not come to rest, and the
//! Newton steps of all.

use furbelow::geom::V2;
use furbelow::progress::Quiet;
use furbelow::ruffle::{Node, uniform_stack};
use furbelow::sim::{Equilibrium, Material, Outcome, Settings, Solver, Supports};
use serde::Serialize;

const NEWTON_PER_GRAM: f64 = 9.80665e-3;

#[derive(Serialize)]
struct Row {
    thickness_mm: f64,
    solves: usize,
    not_at_rest: usize,
    crossings: usize,
    iterations: usize,
}

fn main() {
    let json = std::env::args().any(|a| a == "--json");
    for thickness_mm in [0.0, 0.05, 0.19, 1.0] {
        let mut row = Row { thickness_mm, solves: 0, not_at_rest: 0, crossings: 0, iterations: 0 };
        for layers in [2, 4] {
            for segment_mm in [1.0, 1.6, 2.0, 3.0, 5.0] {
                for load_g in [114.0, 400.0, 1000.0] {
                    for plate in [false, true] {
                        let e = pressed(layers, segment_mm, thickness_mm, load_g * NEWTON_PER_GRAM, plate);
                        row.solves += 1;
                        row.not_at_rest += usize::from(e.outcome != Outcome::Converged);
                        row.crossings += e.self_intersections;
                        row.iterations += e.iterations;
                    }
                }
            }
        }
        if json {
            println!("{}", serde_json::to_string(&row).expect("a row holds nothing JSON cannot"));
        } else {
            let Row { solves, not_at_rest, crossings, iterations, .. } = row;
            println!(
                "{thickness_mm:>5} mm  {not_at_rest} of {solves} not at rest, {crossings} crossings, {iterations} steps"
            );
        }
    }
}

/// A stack at rest, then pressed at once.
fn pressed(layers: usize, segment_mm: f64, thickness_mm: f64, load_n: f64, plate: bool) -> Equilibrium {
    let drawn = uniform_stack(layers, 30.0, 52.8, segment_mm);
    let ruffle = &drawn.ruffle;
    let material = Material {
        flexural_rigidity_n_mm: 2.1,
        membrane_stiffness_n_per_mm: 600.0,
        grammage_g_per_m2: 160.0,
        thickness_mm,
    };
    let supports = Supports { pinned: Vec::new(), upright: vec![ruffle.foot[0]] };
    let widths = vec![80.0; ruffle.node_count];
    let mut solver = Solver::new(ruffle, &widths, &material, &supports, &Settings::default()).expect("a solver");
    let rest = solver.solve(&drawn.positions, &mut Quiet).expect("a solve");
    if plate {
        solver.press(Some(load_n)).expect("a load");
    } else {
        let top = ruffle.sections[ruffle.sections.len() - 1].segments();
        let nodes: Vec<Node> = (top.start..=top.end).map(|k| ruffle.walk[k]).collect();
        let each = V2::new(0.0, -load_n / nodes.len() as f64);
        solver.load(&nodes.iter().map(|n| (*n, each)).collect::<Vec<_>>()).expect("loads on nodes");
    }
    solver.solve(&rest.positions, &mut Quiet).expect("a solve")
}
