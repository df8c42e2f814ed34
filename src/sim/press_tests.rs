//! The default stack of the paper's load tests under a plate, as every accepted state shows it.

use super::tests::paper;
use super::*;
use crate::geom::P2;
use crate::progress::Quiet;
use crate::ruffle::uniform_stack;

const NEWTON_PER_GRAM: f64 = 9.80665e-3;

/// The stack of the load tests (two layers of 30 mm, 52.8 mm inner) on a free foot, 80 mm wide, in segments of `segment_mm`; and where it was drawn.
fn stack(segment_mm: f64, max_iterations: usize) -> (Solver, Vec<P2>) {
    let drawn = uniform_stack(2, 30.0, 52.8, segment_mm);
    let supports = Supports { pinned: Vec::new(), upright: vec![drawn.ruffle.foot[0]] };
    let settings = Settings { max_iterations, ..Settings::default() };
    let widths = vec![80.0; drawn.ruffle.node_count];
    let solver = Solver::new(&drawn.ruffle, &widths, &paper(2.1), &supports, &settings).unwrap();
    (solver, drawn.positions)
}

fn top_mm(x: &[P2]) -> f64 {
    x.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max)
}

/// Loads the stack step by step, each solved one Newton step at a time, and looks at every accepted state. Returns the plate's height at rest under each load.
fn pressed(segment_mm: f64, grams: &[f64]) -> Vec<f64> {
    let (mut solver, mut x) = stack(segment_mm, 1);
    let mut heights = Vec::new();
    for load_g in grams {
        solver.press(Some(load_g * NEWTON_PER_GRAM)).unwrap();
        let mut energy = f64::INFINITY;
        for step in 0.. {
            assert!(step < 300, "{load_g} g: {} N", solver.residual_n(&x).unwrap());
            let e = solver.solve(&x, &mut Quiet).unwrap();
            assert_eq!(e.self_intersections, 0, "{load_g} g, step {step}");
            let plate_mm = e.plate_mm.expect("a plate");
            let clear_mm = plate_mm - top_mm(&e.positions);
            assert!(
                clear_mm > 0.5 * 0.19,
                "{load_g} g, step {step}: the sheet's middle is {clear_mm} mm below the plate"
            );
            // The very first step is made with the soft membrane.
            let first = heights.is_empty() && step < 2;
            let rounding = 1e-13 * energy.abs();
            assert!(first || e.energy_n_mm <= energy + rounding, "{load_g} g, step {step}: {}", e.energy_n_mm - energy);
            (x, energy) = (e.positions, e.energy_n_mm);
            if e.outcome == Outcome::Converged {
                assert!(e.max_strain < 1e-3 && e.residual_n <= 1e-6, "{load_g} g: strain {}", e.max_strain);
                assert!(heights.last().is_none_or(|above| plate_mm < *above), "{load_g} g: {plate_mm} mm, {heights:?}");
                heights.push(plate_mm);
                break;
            }
        }
    }
    heights
}

#[test]
fn the_plate_sinks_as_the_reference_does_and_nothing_crosses_at_300_nodes() {
    // Heights of an independent solver at h = 2 mm: at rest, under the plate of 114 g, and with 10, 20, 50, 100, 150 and 200 g on it. Its sheets have no thickness and
    // come closer under load: more room in every layer.
    let reference_mm = [70.0, 50.8, 49.7, 48.5, 45.4, 40.9, 37.1, 33.9];
    let grams = [0.0, 114.0, 124.0, 134.0, 164.0, 214.0, 264.0, 314.0, 500.0, 700.0, 1000.0];
    let heights = pressed(1.53, &grams);
    for ((height, reference), load_g) in heights.iter().zip(reference_mm).zip(grams) {
        assert!((height - reference).abs() < 1.5, "{load_g} g: {height} mm against {reference} mm");
    }
    // The same solver under 1 kg: 22.5 % of the height at rest.
    let share = heights[10] / heights[0];
    assert!((share - 0.225).abs() < 0.015, "{share} of the height at rest");
}

#[test]
fn nothing_crosses_under_a_kilogram_at_1000_nodes() {
    let heights = pressed(0.467, &[0.0, 114.0, 314.0, 600.0, 1000.0]);
    let share = heights[4] / heights[0];
    assert!((share - 0.230).abs() < 0.015, "{share} of the height at rest");
}

#[test]
fn a_kilogram_at_once_ends_where_it_does_step_by_step() {
    let (mut solver, start) = stack(2.0, 400);
    let rest = solver.solve(&start, &mut Quiet).unwrap();
    assert_eq!(rest.plate_mm, None);
    solver.press(Some(1000.0 * NEWTON_PER_GRAM)).unwrap();
    let at_once = solver.solve(&rest.positions, &mut Quiet).unwrap();
    let steps = pressed(2.0, &[0.0, 114.0, 314.0, 600.0, 1000.0]);
    let height = at_once.plate_mm.unwrap();
    assert_eq!((at_once.outcome, at_once.self_intersections), (Outcome::Converged, 0));
    assert!((height - steps[4]).abs() < 0.5, "{height} mm against {} mm", steps[4]);
}

#[test]
fn taking_the_plate_away_lets_the_stack_spring_back() {
    let (mut solver, start) = stack(3.0, 400);
    let rest = solver.solve(&start, &mut Quiet).unwrap();
    solver.press(Some(100.0 * NEWTON_PER_GRAM)).unwrap();
    let under = solver.solve(&rest.positions, &mut Quiet).unwrap();
    assert!(under.plate_mm.unwrap() < top_mm(&rest.positions) - 5.0);
    solver.press(None).unwrap();
    let back = solver.solve(&under.positions, &mut Quiet).unwrap();
    assert_eq!((back.outcome, back.plate_mm), (Outcome::Converged, None));
    assert!((top_mm(&back.positions) - top_mm(&rest.positions)).abs() < 1e-3);
}

#[test]
fn a_solve_that_fails_says_why() {
    let (mut solver, start) = stack(3.0, 2);
    let early = solver.solve(&start, &mut Quiet).unwrap();
    assert_eq!((early.outcome, early.failure), (Outcome::Failed, Some(Failure::Steps(2))));
    let (mut solver, start) = stack(3.0, 400);
    assert_eq!(solver.solve(&start, &mut Quiet).unwrap().failure, None);
}

#[test]
fn a_plate_that_would_pull_is_refused() {
    let (mut solver, _) = stack(5.0, 1);
    assert_eq!(solver.press(Some(-1.0)), Err(Error::PlateLoad { load_n: -1.0 }));
    assert!(solver.press(Some(f64::NAN)).is_err() && solver.press(Some(f64::INFINITY)).is_err());
}

#[test]
fn the_same_input_gives_the_same_bits_cold_and_warm() {
    let run = || {
        let (mut solver, start) = stack(2.0, 400);
        let cold = solver.solve(&start, &mut Quiet).unwrap();
        solver.press(Some(200.0 * NEWTON_PER_GRAM)).unwrap();
        let warm = solver.solve(&cold.positions, &mut Quiet).unwrap();
        let bits = |e: &Equilibrium| -> Vec<u64> {
            e.positions.iter().flat_map(|p| [p.x.to_bits(), p.y.to_bits()]).chain([e.energy_n_mm.to_bits()]).collect()
        };
        (bits(&cold), bits(&warm), cold.iterations, warm.iterations)
    };
    assert_eq!(run(), run());
}
