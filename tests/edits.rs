//! Edits followed by warm contact solves, through the public rooms only: what a user does who clicks around in a ruffle.

use furbelow::geom::V2;
use furbelow::progress::Quiet;
use furbelow::ruffle::{
    Drawn, EditError, EditSettings, Limits, Node, Role, Strip, densify, insert_layer, layer_count, load_test,
    merge_segments, remove_layer, set_length, split_segments, undensify, uniform_stack,
};
use furbelow::sim::{Equilibrium, Material, Outcome, Settings, Solver, Supports};

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
    EditSettings { segment_mm: 6.0, limits: Limits { min_bend_radius_mm: 5.0, min_void_mm: 9.0 } };
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
        "densify" if made.len() < 4 => densify(drawn, section, &SETTINGS),
        "undensify" if !made.is_empty() => undensify(drawn, made[dice.below(made.len())].first_section, &SETTINGS),
        "split" if drawn.ruffle.sections[section].segments().len() < 16 => split_segments(drawn, section, &SETTINGS),
        "insert" if layers < 4 => insert_layer(drawn, dice.below(layers + 1), LAYER_MM, &SETTINGS),
        "remove" => remove_layer(drawn, dice.below(layers), &SETTINGS),
        _ => merge_segments(drawn, section, &SETTINGS),
    }
}

/// Twenty edits of a three-layer stack, each settled before the next; counts those done by kind.
fn session(seed: u64, done: &mut [usize; 7]) {
    let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let mut drawn = uniform_stack(3, LAYER_MM, 52.8, SETTINGS.segment_mm);
    for step in 0..20 {
        let kind = dice.below(KINDS.len());
        let place = format!("seed {seed}, step {step}, {}", KINDS[kind]);
        let edited = match edit(&drawn, kind, &mut dice) {
            Ok(edited) => edited,
            Err(EditError::Flaw(flaw)) => panic!("{place}: {flaw}"),
            Err(e) => {
                println!("{place}: {e}");
                continue;
            }
        };
        edited.ruffle.check().unwrap();
        let supports = Supports { pinned: vec![edited.ruffle.foot[0]], upright: Vec::new() };
        let mut solver = solver(&edited, &supports);
        let e = solver.solve(&edited.positions, &mut Quiet).unwrap_or_else(|error| panic!("{place}: {error}"));
        assert_eq!(e.self_intersections, 0, "{place}");
        assert_eq!(e.outcome, Outcome::Converged, "{place}: {} N left after {}", e.residual_n, e.iterations);
        assert!(e.max_strain < 1e-3, "{place}: strain {}", e.max_strain);
        done[kind] += 1;
        drawn = settled(edited, e);
    }
}

fn sessions(seeds: std::ops::Range<u64>) {
    let mut done = [0; 7];
    seeds.for_each(|seed| session(seed, &mut done));
    for (kind, n) in KINDS.iter().zip(done) {
        println!("{kind} {n}");
    }
    for (kind, n) in KINDS.iter().zip(done) {
        assert!(n >= 10, "only {n} edits of kind {kind} went through");
    }
}

#[test]
fn random_edits_settle_without_crossings_first_half() {
    sessions(0..25);
}

#[test]
fn random_edits_settle_without_crossings_second_half() {
    sessions(25..50);
}
