use super::*;
use crate::geom::{V2, signed_area};
use crate::progress::Quiet;
use crate::ruffle::{Drawn, Node, Role, Ruffle, Section, uniform_stack};
use crate::sim::{Contact, Equilibrium, Outcome, Settings, Solver, Supports};
use proptest::prelude::*;

fn paper(flexural_rigidity_n_mm: f64) -> Material {
    Material {
        flexural_rigidity_n_mm,
        membrane_stiffness_n_per_mm: 600.0,
        grammage_g_per_m2: 160.0,
        thickness_mm: 0.19,
    }
}

/// The air round `drawn`, and the segments it must hold.
fn air(drawn: &Drawn) -> (AirMesh, Vec<[usize; 2]>) {
    let mut air = AirMesh::new(drawn.ruffle.segments());
    let widths = vec![80.0; drawn.ruffle.node_count];
    air.measure(&drawn.ruffle.rest_lengths, &widths, &paper(2.1), 0.06);
    assert!(air.admit(&drawn.positions));
    (air, drawn.ruffle.segments().map(|(i, j)| [i, j]).collect())
}

/// Every node pushed aside by up to `by`, a different way for every `seed`.
fn shaken(x: &[P2], by: f64, seed: f64) -> Vec<P2> {
    let push = |i: f64| V2::new((1.7 * i + seed).sin(), (2.3 * i + 0.4 * seed).cos()) * by;
    x.iter().enumerate().map(|(i, p)| p + push(i as f64)).collect()
}

fn nudged(x: &[P2], unknown: usize, by: f64) -> Vec<P2> {
    let mut x = x.to_vec();
    x[unknown / 2].coords[unknown % 2] += by;
    x
}

#[test]
fn gradient_and_hessian_of_the_sum_match_finite_differences() {
    let drawn = uniform_stack(2, 30.0, 52.8, 8.0);
    let (air, _) = air(&drawn);
    // Shaken as far as this, many triangles are inside out, and none is about to turn.
    let x = shaken(&drawn.positions, 6.0, 0.3);
    assert!(air.inverted(&x).count() > 10);
    assert!(air.finite().all(|[a, b, c]| triangle::area(x[a], x[b], x[c]).abs() > 1e-3));
    let n = 2 * x.len();
    let elements: Vec<[usize; 6]> = air.elements(&x).collect();
    let pattern = Pattern::new(n, elements.iter().map(<[usize; 6]>::as_slice)).unwrap();
    assert!(air.fits(&x, &pattern));
    let gradient = |x: &[P2]| {
        let mut g = vec![0.0; n];
        air.add_gradient(x, &mut g);
        g
    };
    let mut values = vec![0.0; pattern.slots()];
    air.add_hessian(&x, false, &pattern, &mut values);
    let (g, h) = (gradient(&x), 1e-5);
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    for (i, exact) in g.iter().enumerate() {
        let slope = (air.energy(&nudged(&x, i, h)) - air.energy(&nudged(&x, i, -h))) / (2.0 * h);
        assert!((slope - exact).abs() < 1e-5 * largest, "unknown {i}: {slope} against {exact}");
        let (up, down) = (gradient(&nudged(&x, i, h)), gradient(&nudged(&x, i, -h)));
        for j in 0..n {
            let exact = pattern.slot(i, j).map_or(0.0, |slot| values[slot]);
            let slope = (up[j] - down[j]) / (2.0 * h);
            assert!((slope - exact).abs() < 1e-6 * largest, "({i}, {j}): {slope} against {exact}");
        }
    }
}

proptest! {
    #[test]
    fn flips_keep_it_a_triangulation_and_the_energy(
        layers in 1usize..4, by in 0.1..8.0f64, seed in 0.0..100.0f64, turns in -2.0..2.0f64,
    ) {
        let drawn = uniform_stack(layers, 30.0, 52.8, 9.0);
        let (mut air, segments) = air(&drawn);
        air.mesh.as_ref().unwrap().check(&segments);
        // Sheared, turned and shaken, a little farther each time.
        for step in 1..=6 {
            let share = f64::from(step) / 6.0;
            let turn = nalgebra::Rotation2::new(share * turns);
            let sheared: Vec<P2> = drawn.positions.iter().map(|p| turn * P2::new(p.x + share * turns * p.y, p.y)).collect();
            let x = shaken(&sheared, share * by, seed);
            let before = air.energy(&x);
            let mesh = air.mesh.as_mut().unwrap();
            mesh.improve(&x);
            mesh.check(&segments);
            prop_assert_eq!(mesh.improve(&x), 0, "nothing is left to improve");
            prop_assert!((air.energy(&x) - before).abs() <= 1e-12 * before);
        }
    }
}

#[test]
fn a_sheared_void_is_flipped_into_fat_triangles() {
    let drawn = uniform_stack(2, 30.0, 52.8, 5.0);
    let (mut air, _) = air(&drawn);
    let x: Vec<P2> = drawn.positions.iter().map(|p| P2::new(p.x + 1.5 * p.y, p.y)).collect();
    let flips = air.mesh.as_mut().unwrap().improve(&x);
    assert!(flips > 20, "{flips}");
}

/// A strip of its own, not joined anywhere.
fn strip(x: &[P2]) -> Ruffle {
    let walk: Vec<Node> = (0..x.len() as u32).map(Node).collect();
    let rest_lengths: Vec<f64> = x.windows(2).map(|w| (w[1] - w[0]).norm()).collect();
    let sections =
        vec![Section { role: Role::Outer, first_segment: 0, end_segment: rest_lengths.len(), pinned: false }];
    Ruffle {
        node_count: x.len(),
        walk,
        rest_lengths,
        sections,
        foot: [Node(0), Node(1)],
        densified: Default::default(),
    }
}

#[test]
fn a_straight_strip_that_bends_encloses_air() {
    // A straight strip has no void but the outside; bent into most of an octagon, the octagon is full of triangles.
    let bent = |share: f64| -> Vec<P2> {
        let mut x = vec![P2::origin()];
        for i in 0..7 {
            let turn = nalgebra::Rotation2::new(share * std::f64::consts::FRAC_PI_4 * f64::from(i));
            x.push(x[x.len() - 1] + turn * V2::new(16.0, 0.0));
        }
        x
    };
    let drawn = Drawn { ruffle: strip(&bent(0.0)), positions: bent(0.0) };
    let (mut air, segments) = air(&drawn);
    let void = |air: &AirMesh, x: &[P2]| air.finite().map(|[a, b, c]| triangle::area(x[a], x[b], x[c])).sum::<f64>();
    assert_eq!(void(&air, &drawn.positions), 0.0);
    (1..=100).for_each(|step| air.improve(&bent(0.01 * f64::from(step))));
    let x = bent(1.0);
    air.mesh.as_ref().unwrap().check(&segments);
    let octagon = signed_area(&x);
    assert!((void(&air, &x) / octagon - 1.0).abs() < 1e-9, "{} of {octagon} mm²", void(&air, &x));
    // Straightened again, it ends as slivers that push nothing.
    (0..=100).rev().for_each(|step| air.improve(&bent(0.01 * f64::from(step))));
    air.mesh.as_ref().unwrap().check(&segments);
    assert!(air.energy(&bent(0.0)) < 1e-20 && void(&air, &bent(0.0)) < 1e-9);
}

#[test]
fn air_between_sheets_that_close_in_is_not_given_up_from_the_open_end() {
    // A strip folded once, open on the left, where its ends turn away up and down.
    let folded = |gap: f64| -> Vec<P2> {
        let before = (1..4).rev().map(|i| P2::new(0.0, -3.0 * f64::from(i)));
        let lower = (0..=20).map(|i| P2::new(3.0 * f64::from(i), 0.0));
        let upper = (0..20).rev().map(|i| P2::new(3.0 * f64::from(i) + 1.0, gap));
        let after = (0..4).map(|i| P2::new(0.0, gap + 3.0 * f64::from(i)));
        before.chain(lower).chain([P2::new(63.0, 0.5 * gap)]).chain(upper).chain(after).collect()
    };
    let drawn = Drawn { ruffle: strip(&folded(8.0)), positions: folded(8.0) };
    let (mut air, _) = air(&drawn);
    (1..=79).for_each(|step| air.improve(&folded(8.0 - 0.1 * f64::from(step))));
    for node in 25..45 {
        let mut x = folded(0.1);
        x[node].y = -0.1;
        assert!(air.energy(&x) > 0.0, "node {node} passes freely");
    }
}

#[test]
fn what_cannot_be_triangulated_is_not_admitted_unless_there_was_a_state_before() {
    let p = |u, v| P2::new(u, v);
    let clear = [p(0.0, 0.0), p(10.0, 0.0), p(10.0, 5.0), p(4.0, 5.0), p(4.0, 1.0)];
    let touching = [clear[0], clear[1], clear[2], clear[3], p(4.0, 0.0)];
    let crossing = [clear[0], clear[1], clear[2], clear[3], p(4.0, -1.0)];
    let doubled = [clear[0], clear[1], clear[2], clear[3], clear[0]];
    let ruffle = strip(&clear);
    for start in [touching, crossing, doubled] {
        let mut air = AirMesh::new(ruffle.segments());
        assert!(!air.admit(&start));
        assert!(air.admit(&clear));
        assert!(air.admit(&start));
    }
    // The end that has passed the first segment is pushed back.
    let mut air = AirMesh::new(ruffle.segments());
    air.measure(&ruffle.rest_lengths, &[40.0; 5], &paper(2.1), 0.01);
    assert!(air.admit(&clear) && air.admit(&crossing));
    let mut g = vec![0.0; 10];
    air.add_gradient(&crossing, &mut g);
    assert!(g[9] < 0.0, "{g:?}");
}

fn solver(drawn: &Drawn, contact: Contact, max_iterations: usize) -> Solver {
    let supports = Supports { pinned: Vec::new(), upright: vec![drawn.ruffle.foot[0]] };
    let widths = vec![80.0; drawn.ruffle.node_count];
    let settings = Settings { contact, max_iterations, ..Settings::default() };
    Solver::new(&drawn.ruffle, &widths, &paper(2.1), &supports, &settings).unwrap()
}

#[test]
fn a_stack_under_its_own_weight_rests_with_no_triangle_inside_out() {
    for layers in [2, 7] {
        let drawn = uniform_stack(layers, 30.0, 52.8, 5.0);
        let e = solver(&drawn, Contact::AirMesh, 400).solve(&drawn.positions, &mut Quiet).unwrap();
        assert_eq!((e.outcome, e.self_intersections), (Outcome::Converged, 0));
        // Without a step, a solver without contact gives the energy of the strip alone.
        let alone = solver(&drawn, Contact::None, 0).solve(&e.positions, &mut Quiet).unwrap();
        assert_eq!(e.energy_n_mm, alone.energy_n_mm);
    }
}

#[test]
fn a_stack_pressed_flat_is_as_high_as_with_the_barrier() {
    let drawn = uniform_stack(2, 30.0, 52.8, 5.0);
    let top = drawn.ruffle.sections[drawn.ruffle.sections.len() - 1].segments();
    let pressed = |contact: Contact| -> Vec<Equilibrium> {
        let mut solver = solver(&drawn, contact, 400);
        let mut x = drawn.positions.clone();
        let mut states = Vec::new();
        for grams in [0.0, 114.0, 200.0, 300.0, 400.0, 600.0, 1000.0] {
            let each = V2::new(0.0, -grams * 9.80665e-3 / top.len() as f64);
            solver.load(&top.clone().map(|k| (drawn.ruffle.walk[k], each)).collect::<Vec<_>>()).unwrap();
            let e = solver.solve(&x, &mut Quiet).unwrap();
            assert_eq!(e.outcome, Outcome::Converged, "{contact:?} under {grams} g");
            x.clone_from(&e.positions);
            states.push(e);
        }
        states
    };
    let height = |e: &Equilibrium| e.positions.iter().map(|p| p.y).fold(0.0, f64::max);
    let middle =
        |e: &Equilibrium| top.clone().map(|k| e.positions[drawn.ruffle.at(k)].y).sum::<f64>() / top.len() as f64;
    let (air, barrier) = (pressed(Contact::AirMesh), pressed(Contact::Barrier));
    for (k, (air, barrier)) in air.iter().zip(&barrier).enumerate() {
        let share = height(air) / height(barrier);
        assert!((share - 1.0).abs() < 0.05, "load {k}: {share} of the height with the barrier");
        // Five sheets on each other, each 0.19 mm thick and kept 0.3 mm from the next, lie higher than sheets without either.
        let lower = middle(barrier) - middle(air);
        assert!((-0.1..2.5).contains(&lower), "load {k}: {lower} mm lower than with the barrier");
    }
    let bare = pressed(Contact::None);
    let heights: Vec<[f64; 2]> = bare.iter().zip(&air).map(|(bare, air)| [bare, air].map(middle)).collect();
    assert!(heights[3][0] < 0.7 * heights[3][1], "without contact and with air, mm: {heights:?}");
}

#[test]
fn a_sheet_dropped_from_outside_lands_on_the_one_below() {
    // A strip folded once, open on the left: the lower run is held, the upper one pressed down. Between them lies a pocket of the outside.
    let n = 20;
    let lower = (0..=n).map(|i| P2::new(3.0 * f64::from(i), 10.0));
    let bend = [P2::new(62.0, 12.0), P2::new(62.0, 15.0), P2::new(60.0, 17.0)];
    let upper = (0..n).rev().map(|i| P2::new(3.0 * f64::from(i) + 1.0, 17.0));
    let x: Vec<P2> = lower.chain(bend).chain(upper).collect();
    let ruffle = strip(&x);
    let supports = Supports { pinned: (0..=n as u32).map(Node).collect(), upright: Vec::new() };
    let settings = Settings { floor_mm: f64::NEG_INFINITY, contact: Contact::AirMesh, ..Settings::default() };
    let mut solver = Solver::new(&ruffle, &vec![40.0; x.len()], &paper(0.5), &supports, &settings).unwrap();
    let end = x.len() as u32 - 10..x.len() as u32;
    solver.load(&end.map(|i| (Node(i), V2::new(0.0, -0.005))).collect::<Vec<_>>()).unwrap();
    let e = solver.solve(&x, &mut Quiet).unwrap();
    assert_eq!(e.outcome, Outcome::Converged);
    for p in &e.positions[n as usize + 4..] {
        assert!(p.y > 9.9 || !(0.0..60.0).contains(&p.x), "{p} lies below the sheet at 10 mm");
    }
}
