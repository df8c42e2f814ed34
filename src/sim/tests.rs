//! The solver as a whole: the floor, contact, what it refuses. The helpers also serve its neighbours.

use super::*;
use crate::cut::Outline;
use crate::geom::{V2, distance_to_segment};
use crate::progress::{Observer, Progress, Quiet};
use crate::ruffle::{Drawn, Node, Role, Ruffle, Section, StackSettings, draw_stack};

/// A straight strip of `n` segments behind a clamp: a first segment without length to speak of, both its nodes pinned, which gives the hinge at the
/// clamp half a cell.
pub(super) fn cantilever(n: usize, length_mm: f64) -> (Ruffle, Vec<P2>, Supports) {
    let h = length_mm / n as f64;
    let clamp = 1e-6 * h;
    let mut rest_lengths = vec![clamp];
    rest_lengths.extend(std::iter::repeat_n(h, n));
    let walk: Vec<Node> = (0..n as u32 + 2).map(Node).collect();
    let positions: Vec<P2> =
        std::iter::once(-clamp).chain((0..=n).map(|i| i as f64 * h)).map(|x| P2::new(x, 0.0)).collect();
    let sections = vec![Section { role: Role::Outer, first_segment: 0, end_segment: n + 1, pinned: false }];
    let ruffle = Ruffle {
        node_count: n + 2,
        walk,
        rest_lengths,
        sections,
        foot: [Node(0), Node(1)],
        densified: Default::default(),
    };
    (ruffle, positions, Supports { pinned: vec![Node(0), Node(1)], upright: Vec::new() })
}

pub(super) fn paper(flexural_rigidity_n_mm: f64) -> Material {
    Material {
        flexural_rigidity_n_mm,
        membrane_stiffness_n_per_mm: 600.0,
        grammage_g_per_m2: 160.0,
        thickness_mm: 0.19,
    }
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
    let beyond = Supports { pinned: vec![Node(99)], upright: Vec::new() };
    let refused = Solver::new(&ruffle, &[10.0; 7], &paper(1.0), &beyond, &Settings::default());
    assert!(matches!(refused, Err(Error::Count { found: 100, .. })));
    let other = cantilever(6, 50.0).0;
    assert!(matches!(solver(&[10.0; 7]).unwrap().measure(&other, &[10.0; 7]), Err(Error::Count { .. })));
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
pub(super) fn watched(solver: &mut Solver, start: &[P2]) -> Equilibrium {
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

/// A stack on a pinned foot, 60 mm wide, to be solved a step at a time.
fn standing(drawn: &Drawn, material: &Material) -> Solver {
    let supports = Supports { pinned: drawn.ruffle.foot.to_vec(), upright: Vec::new() };
    let widths = vec![60.0; drawn.ruffle.node_count];
    let settings = Settings { max_iterations: 1, ..Settings::default() };
    Solver::new(&drawn.ruffle, &widths, material, &supports, &settings).unwrap()
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
        for s in (0..drawn.ruffle.rest_lengths.len()).filter(|s| far(*s) && (stations[*s] - stations[k]).abs() > 20.0) {
            let (i, j) = drawn.ruffle.ends(s);
            closest = closest.min(distance_to_segment(x[drawn.ruffle.at(k)], x[i], x[j]));
        }
    }
    assert!((1.0..1.3).contains(&closest), "sheets touch at {closest} mm");
}

#[test]
fn a_sheet_dropped_from_far_above_its_reach_lands_on_the_one_below() {
    // A strip folded once: the lower run is held, the upper one hangs over it, far outside the barrier, and is pressed down hard. Its first Newton steps are
    // centimetres long and end below.
    let n = 20;
    let lower = (0..=n).map(|i| P2::new(3.0 * f64::from(i), 10.0));
    let bend = [P2::new(62.0, 12.0), P2::new(62.0, 15.0), P2::new(60.0, 17.0)];
    let upper = (0..n).rev().map(|i| P2::new(3.0 * f64::from(i), 17.0));
    let start: Vec<P2> = lower.chain(bend).chain(upper).collect();
    let walk: Vec<Node> = (0..start.len() as u32).map(Node).collect();
    let rest_lengths: Vec<f64> = start.windows(2).map(|w| (w[1] - w[0]).norm()).collect();
    let sections =
        vec![Section { role: Role::Outer, first_segment: 0, end_segment: rest_lengths.len(), pinned: false }];
    let ruffle = Ruffle {
        node_count: start.len(),
        walk,
        rest_lengths,
        sections,
        foot: [Node(0), Node(1)],
        densified: Default::default(),
    };
    let supports = Supports { pinned: (0..=n as u32).map(Node).collect(), upright: Vec::new() };
    let settings = Settings { floor_mm: f64::NEG_INFINITY, ..Settings::default() };
    let widths = vec![40.0; start.len()];
    let mut solver = Solver::new(&ruffle, &widths, &paper(0.05), &supports, &settings).unwrap();
    let end = start.len() as u32 - 10..start.len() as u32;
    solver.load(&end.map(|i| (Node(i), V2::new(0.0, -0.05))).collect::<Vec<_>>()).unwrap();
    let e = solver.solve(&start, &mut Quiet).unwrap();
    assert_eq!(e.self_intersections, 0);
    for p in &e.positions[n as usize + 4..] {
        assert!(p.y > 10.0 || p.x < 0.0, "{p} lies below the sheet at 10 mm");
    }
}

#[test]
fn a_changed_ruffle_is_solved_warm_with_its_plate() {
    let drawn = square_stack();
    let widths = |drawn: &Drawn| vec![60.0; drawn.ruffle.node_count];
    let supports = |drawn: &Drawn| Supports { pinned: drawn.ruffle.foot.to_vec(), upright: Vec::new() };
    let mut solver =
        Solver::new(&drawn.ruffle, &widths(&drawn), &paper(2.1), &supports(&drawn), &Settings::default()).unwrap();
    solver.press(Some(0.3)).unwrap();
    let before = solver.solve(&drawn.positions, &mut Quiet).unwrap();
    let settings = crate::ruffle::EditSettings { segment_mm: 3.0, limits: Default::default() };
    let settled = Drawn { ruffle: drawn.ruffle.clone(), positions: before.positions.clone() };
    let denser = crate::ruffle::densify(&settled, &[3], 1, &settings).unwrap();
    let refused = solver.change(&denser.ruffle, &[60.0; 3], &supports(&denser));
    assert!(matches!(refused, Err(Error::Count { .. })) && solver.residual_n(&before.positions).unwrap() <= 1e-6);
    solver.change(&denser.ruffle, &widths(&denser), &supports(&denser)).unwrap();
    let after = solver.solve(&denser.positions, &mut Quiet).unwrap();
    assert_eq!((after.outcome, after.self_intersections), (Outcome::Converged, 0));
    assert!(after.plate_mm.unwrap() > before.plate_mm.unwrap(), "stiffer here");
}
