//! Edits followed by warm contact solves, through the public rooms only: what a user does who clicks around in a ruffle.

use furbelow::geom::V2;
use furbelow::progress::Quiet;
use furbelow::ruffle::{
    Drawn, EditError, EditSettings, Limits, Node, Role, Strip, densify, insert_layer, layer_count, load_test,
    merge_segments, remove_layer, set_length, split_segments, undensify, uniform_stack,
};
use furbelow::sim::{Contact, Equilibrium, Material, Outcome, Settings, Solver, Supports};

const WIDTH_MM: f64 = 80.0;
const PAPER: Material = Material {
    flexural_rigidity_n_mm: 2.1,
    membrane_stiffness_n_per_mm: 600.0,
    grammage_g_per_m2: 160.0,
    thickness_mm: 0.19,
};

fn solver(drawn: &Drawn, supports: &Supports) -> Solver {
    let widths = vec![WIDTH_MM; drawn.ruffle.node_count];
    Solver::new(&drawn.ruffle, &widths, &PAPER, supports, &Settings::default()).unwrap()
}

fn settled(drawn: Drawn, equilibrium: Equilibrium) -> Drawn {
    Drawn { positions: equilibrium.positions, ..drawn }
}

/// xorshift64* (Vigna 2016).
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) as usize) % n
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.below(1 << 20) as f64 / (1 << 20) as f64
    }
}

const LAYER_MM: f64 = 30.0;
const SETTINGS: EditSettings =
    EditSettings { segment_mm: 4.0, limits: Limits { min_bend_radius_mm: 5.0, min_void_mm: 9.0 } };
const KINDS: [&str; 7] = ["length", "densify", "undensify", "split", "merge", "insert", "remove"];

/// A random edit of kind `kind`.
fn edit(drawn: &Drawn, kind: usize, dice: &mut Dice) -> Result<Drawn, EditError> {
    let section = dice.below(drawn.ruffle.sections.len());
    let made = &drawn.ruffle.densified.made;
    let layers = layer_count(drawn)?;
    match KINDS[kind] {
        "length" => {
            let length_mm = drawn.ruffle.section_length(section) * dice.between(0.85, 1.2);
            set_length(drawn, section, length_mm, &SETTINGS)
        }
        // A few at a time keep the test quick.
        "densify" if made.len() < 4 => densify(drawn, &[section], 1, &SETTINGS),
        "undensify" if !made.is_empty() => undensify(drawn, &[made[dice.below(made.len())].first_section], &SETTINGS),
        "split" if drawn.ruffle.sections[section].segments().len() < 24 => split_segments(drawn, section, &SETTINGS),
        "insert" if layers < 4 => insert_layer(drawn, dice.below(layers + 1), LAYER_MM, &SETTINGS),
        "remove" => remove_layer(drawn, dice.below(layers), &SETTINGS),
        "merge" => {
            let segments = |s: &usize| drawn.ruffle.sections[*s].segments().len();
            let finest = (0..drawn.ruffle.sections.len()).max_by_key(segments).unwrap_or(0);
            merge_segments(drawn, finest, &SETTINGS)
        }
        _ => densify(drawn, &[section], 1, &SETTINGS),
    }
}

/// Weight of the strip as the solver sees it, N: what its energy gains when it is lifted.
fn weight_n(drawn: &Drawn) -> f64 {
    const LIFT_MM: f64 = 1000.0;
    let afloat =
        Settings { max_iterations: 0, contact: Contact::None, floor_mm: f64::NEG_INFINITY, ..Settings::default() };
    let widths = vec![WIDTH_MM; drawn.ruffle.node_count];
    let energy = |lift_mm: f64| {
        let lifted: Vec<_> = drawn.positions.iter().map(|p| p + V2::new(0.0, lift_mm)).collect();
        let mut solver = Solver::new(&drawn.ruffle, &widths, &PAPER, &Supports::default(), &afloat).unwrap();
        solver.solve(&lifted, &mut Quiet).unwrap().energy_n_mm
    };
    (energy(LIFT_MM) - energy(0.0)) / LIFT_MM
}

/// Settles a step at a time, so that every accepted state can be looked at.
fn watched(drawn: &Drawn, supports: &Supports, place: &str) -> Equilibrium {
    let widths = vec![WIDTH_MM; drawn.ruffle.node_count];
    let settings = Settings { max_iterations: 1, ..Settings::default() };
    let mut solver = Solver::new(&drawn.ruffle, &widths, &PAPER, supports, &settings).unwrap();
    let mut x = drawn.positions.clone();
    for step in 0..400 {
        let e = solver.solve(&x, &mut Quiet).unwrap_or_else(|error| panic!("{place}: {error}"));
        assert_eq!(e.self_intersections, 0, "{place}, step {step} of the solve");
        if e.outcome == Outcome::Converged {
            return e;
        }
        x = e.positions;
    }
    panic!("{place}: {} N left", solver.residual_n(&x).unwrap());
}

/// Twenty edits of a three-layer stack, each settled before the next; counts those done by kind.
fn session(seed: u64, foot: fn(&Drawn) -> Supports, done: &mut [usize; 7]) {
    let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let mut drawn = uniform_stack(3, LAYER_MM, 52.8, SETTINGS.segment_mm);
    for step in 0..20 {
        let kind = dice.below(KINDS.len());
        let place = format!("seed {seed}, step {step}, {}", KINDS[kind]);
        let edited = match edit(&drawn, kind, &mut dice) {
            Ok(edited) => edited,
            Err(EditError::Flaw(flaw)) => panic!("{place}: {flaw}"),
            Err(_) => continue,
        };
        edited.ruffle.check().unwrap();
        let e = watched(&edited, &foot(&edited), &place);
        assert!(e.max_strain < 1e-3, "{place}: strain {}", e.max_strain);
        done[kind] += 1;
        drawn = settled(edited, e);
        let sheet_n = drawn.ruffle.strip_length() * WIDTH_MM * PAPER.weight_n_per_mm2();
        assert!((weight_n(&drawn) / sheet_n - 1.0).abs() < 1e-9, "{place}: {} N", weight_n(&drawn));
    }
}

fn sessions(seeds: std::ops::Range<u64>, foot: fn(&Drawn) -> Supports) {
    let mut done = [0; 7];
    seeds.for_each(|seed| session(seed, foot, &mut done));
    for (kind, n) in KINDS.iter().zip(done) {
        assert!(n >= 10, "only {n} edits of kind {kind} went through");
    }
}

#[test]
fn random_edits_of_a_pinned_stack_settle_without_crossings() {
    sessions(0..25, |drawn| Supports { pinned: vec![drawn.ruffle.foot[0]], upright: Vec::new() });
}

#[test]
fn random_edits_of_a_free_stack_settle_without_crossings() {
    sessions(25..50, |drawn| Supports { pinned: Vec::new(), upright: vec![drawn.ruffle.foot[0]] });
}

/// Height of the strip's top rung under `load_n` spread over its nodes, mm: the mean of those nodes.
fn height_mm(drawn: &Drawn, load_n: f64) -> f64 {
    let ruffle = &drawn.ruffle;
    let last = ruffle.sections.len() - 1;
    // The top rung of the dense strip is two sections, of the others one.
    let first = if ruffle.densified.made.is_empty() { last } else { last - 1 };
    let rung = ruffle.sections[first].first_segment..=ruffle.sections[last].end_segment;
    let nodes: Vec<Node> = rung.map(|k| ruffle.walk[k]).collect();
    let each = V2::new(0.0, -load_n / nodes.len() as f64);
    let mut solver = solver(drawn, &Supports { pinned: ruffle.foot.to_vec(), upright: Vec::new() });
    solver.load(&nodes.iter().map(|n| (*n, each)).collect::<Vec<_>>()).unwrap();
    let e = solver.solve(&drawn.positions, &mut Quiet).unwrap();
    assert_eq!((e.outcome, e.self_intersections), (Outcome::Converged, 0), "{load_n} N: {} N left", e.residual_n);
    assert!(e.max_strain < 1e-3, "strain {}", e.max_strain);
    nodes.iter().map(|n| e.positions[n.index()].y).sum::<f64>() / nodes.len() as f64
}

#[test]
fn the_load_test_strips_have_the_papers_lengths_and_the_dense_one_is_the_stiffest() {
    // Without end tabs: 486, 749 and 797 mm in the paper, less 18.5.
    for (strip, length_mm, within) in
        [(Strip::Default, 468.35, 0.01), (Strip::Wide, 730.27, 0.01), (Strip::Dense, 778.5, 0.03 * 778.5)]
    {
        for segment_mm in [2.0, 3.0, 4.0] {
            let drawn = load_test(strip, segment_mm).unwrap();
            let length = drawn.ruffle.strip_length();
            assert!((length - length_mm).abs() < within, "{}: {length}", strip.name());
        }
    }
    let dense = load_test(Strip::Dense, 2.0).unwrap();
    let count = |role| dense.ruffle.sections.iter().filter(|s| s.role == role).count();
    assert_eq!((count(Role::Densified), dense.ruffle.connection_points().len()), (12, 13));
    // The plate, and 200 g on it.
    let load_n = (0.114 + 0.2) * 9.80665;
    let compression = |strip| {
        let drawn = load_test(strip, 2.0).unwrap();
        1.0 - height_mm(&drawn, load_n) / height_mm(&drawn, 0.0)
    };
    let (default, dense) = (compression(Strip::Default), compression(Strip::Dense));
    assert!(default > 0.5 && (0.02..0.25).contains(&dense), "{default} and {dense}");
}
