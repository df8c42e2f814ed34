//! The solver against the elastica: shapes of a thin sheet that are known in closed form or from its differential equation. The distance to them falls with the
//! square of the segment.

use super::tests::{cantilever, paper};
use super::*;
use crate::geom::{V2, cross};
use crate::progress::Quiet;
use crate::ruffle::{Node, Role, Ruffle, Section};
use std::f64::consts::PI;

const WIDTH_MM: f64 = 40.0;
const LENGTH_MM: f64 = 100.0;
/// Flexural rigidity, N mm, and bending stiffness of the strip, N mm², where weight is to play no part: a strip that weighs a ten-millionth of the loads that bend
/// it and stretches by a millionth.
const RIGIDITY_N_MM: f64 = 1000.0;
const BENDING_N_MM2: f64 = RIGIDITY_N_MM * WIDTH_MM;

fn weightless() -> Material {
    Material {
        flexural_rigidity_n_mm: RIGIDITY_N_MM,
        membrane_stiffness_n_per_mm: 1e6,
        grammage_g_per_m2: 0.01,
        thickness_mm: 0.1,
    }
}

/// No floor and no contact; forces balanced to a millionth of those that bend the strip.
fn afloat() -> Settings {
    Settings { floor_mm: f64::NEG_INFINITY, contact: Contact::None, residual_n: 1e-6, ..Settings::default() }
}

fn solver(ruffle: &Ruffle, material: &Material, supports: &Supports, settings: &Settings) -> Solver {
    Solver::new(ruffle, &vec![WIDTH_MM; ruffle.node_count], material, supports, settings).unwrap()
}

fn chain(walk: Vec<u32>, rest_lengths: Vec<f64>) -> Ruffle {
    let node_count = walk.iter().max().map_or(0, |last| *last as usize + 1);
    let sections =
        vec![Section { role: Role::Outer, first_segment: 0, end_segment: rest_lengths.len(), pinned: false }];
    Ruffle {
        node_count,
        walk: walk.into_iter().map(Node).collect(),
        rest_lengths,
        sections,
        foot: [Node(0), Node(1)],
        densified: Default::default(),
    }
}

/// Converged, or the test has nothing to compare.
fn at_rest(mut solver: Solver, start: &[P2]) -> Equilibrium {
    let e = solver.solve(start, &mut Quiet).unwrap();
    assert_eq!(e.outcome, Outcome::Converged, "{} steps, {} N", e.iterations, e.residual_n);
    e
}

/// Tip of a horizontal cantilever of `n` segments with a = P L² / EI at its end: drop and reach by its length, and its slope there in degrees.
fn tip(n: usize, a: f64) -> (f64, f64, f64) {
    let (ruffle, start, supports) = cantilever(n, LENGTH_MM);
    let mut solver = solver(&ruffle, &weightless(), &supports, &afloat());
    let load_n = a * BENDING_N_MM2 / LENGTH_MM.powi(2);
    solver.load(&[(Node(n as u32 + 1), V2::new(0.0, -load_n))]).unwrap();
    let e = at_rest(solver, &start);
    let (tip, last) = (e.positions[n + 1], e.positions[n + 1] - e.positions[n]);
    (-tip.y / LENGTH_MM, tip.x / LENGTH_MM, (-last.y).atan2(last.x).to_degrees())
}

#[test]
fn a_cantilever_with_a_load_at_its_tip_bends_as_bisshopp_and_drucker_have_it() {
    // P L² / EI, slope (deg), drop / L, reach / L: elliptic integrals of Bisshopp and Drucker 1945.
    for (a, slope, drop, reach) in [
        (0.25, 7.1214, 0.082746, 0.995882),
        (0.5, 14.0107, 0.162144, 0.984081),
        (1.0, 26.4335, 0.301721, 0.943567),
        (2.0, 44.7910, 0.493457, 0.839358),
        (3.0, 56.4946, 0.603253, 0.745580),
        (5.0, 69.6355, 0.713792, 0.612372),
        (10.0, 81.9493, 0.810609, 0.445004),
    ] {
        let (d, r, s) = tip(80, a);
        assert!((d - drop).abs() < 2e-4 && (r - reach).abs() < 2e-4, "a = {a}: {d} {r}");
        assert!((s - slope).abs() < 0.05, "a = {a}: {s} degrees");
    }
    let error = |n| (tip(n, 10.0).0 - 0.810609).abs();
    let ratio = error(20) / error(40);
    assert!((3.6..4.4).contains(&ratio), "ratio {ratio}");
}

/// A horizontal cantilever that bends under its own weight, b = q L³ / EI: drop and reach of the tip by its length, and its slope there in degrees.
fn sagged(n: usize, b: f64) -> (f64, f64, f64) {
    let rigidity = paper(1.0).weight_n_per_mm2() * LENGTH_MM.powi(3) / b;
    let (ruffle, start, supports) = cantilever(n, LENGTH_MM);
    // The strip weighs 6 mN: its shape to five digits needs forces to a few nN.
    let e = at_rest(solver(&ruffle, &paper(rigidity), &supports, &Settings { residual_n: 2e-9, ..afloat() }), &start);
    let (tip, last) = (e.positions[n + 1], e.positions[n + 1] - e.positions[n]);
    (-tip.y / LENGTH_MM, tip.x / LENGTH_MM, (-last.y).atan2(last.x).to_degrees())
}

#[test]
fn a_heavy_cantilever_hangs_as_the_elastica_does() {
    // th'' = -b (1 - s) cos th: b, drop / L, reach / L, slope of the tip (deg).
    for (b, drop, reach, slope) in [
        (1.0, 0.123471, 0.991246, 9.4604),
        (2.0, 0.238507, 0.966893, 18.4260),
        (4.0, 0.425159, 0.890111, 33.7239),
        (8.0, 0.640631, 0.724425, 53.8650),
        (16.0, 0.797020, 0.509995, 72.2072),
        (64.0, 0.920113, 0.209201, 88.6021),
    ] {
        let (d, r, s) = sagged(80, b);
        assert!((d - drop).abs() < 2e-4 && (r - reach).abs() < 2e-4, "b = {b}: {d} {r}");
        assert!((s - slope).abs() < 0.05, "b = {b}: {s} degrees");
    }
    let error = |n| (sagged(n, 8.0).0 - 0.640631).abs();
    let ratio = error(20) / error(40);
    assert!((3.6..4.4).contains(&ratio), "ratio {ratio}");
}

#[test]
fn a_strip_of_paper_stands_upright_up_to_greenhills_length() {
    // q L³ / EI = 9/4 j², with j = 1.866351 the first zero of the Bessel function J of order -1/3 (Greenhill 1881).
    let leans = |share: f64| {
        let rigidity = paper(1.0).weight_n_per_mm2() * LENGTH_MM.powi(3) / (share * 7.837347);
        let (ruffle, mut start, supports) = cantilever(60, LENGTH_MM);
        // Upright, leaning a little.
        let height = |p: &P2| P2::new(2e-4 * p.x.max(0.0).powi(2), p.x);
        start = start.iter().map(height).collect();
        let e =
            at_rest(solver(&ruffle, &paper(rigidity), &supports, &Settings { residual_n: 2e-9, ..afloat() }), &start);
        e.positions[61].x / LENGTH_MM
    };
    let (below, above) = (leans(0.98), leans(1.02));
    assert!(below.abs() < 1e-3 && above > 0.1, "{below} and {above} of its length");
}

/// A strip of `n` segments that starts on `curve` (over 0 to 1), its ends clamped where that has them: level to the right at the first, along `last` at the last.
fn clamped(n: usize, last: V2, curve: impl Fn(f64) -> P2) -> Equilibrium {
    let h = LENGTH_MM / n as f64;
    // As in the cantilever: a clamp is a segment without length to speak of.
    let clamp = 1e-6 * h;
    let mut rest_lengths = vec![h; n + 2];
    (rest_lengths[0], rest_lengths[n + 1]) = (clamp, clamp);
    let nodes = n as u32 + 3;
    let ruffle = chain((0..nodes).collect(), rest_lengths);
    let mut start = vec![curve(0.0) - V2::new(clamp, 0.0)];
    start.extend((0..=n).map(|i| curve(i as f64 / n as f64)));
    start.push(curve(1.0) + last * clamp);
    let pinned = [0, 1, nodes - 2, nodes - 1].map(Node).to_vec();
    at_rest(solver(&ruffle, &weightless(), &Supports { pinned, upright: Vec::new() }, &afloat()), &start)
}

#[test]
fn a_strip_pushed_together_between_clamps_rises_as_eulers_elastica_does() {
    // Largest slope a, k = sin(a / 2): force by Euler's (2 K / pi)², shortening 2 - 2 E / K, rise k / K.
    for (slope, force, shortening, rise) in [
        (20.0, 1.015397, 0.030269, 0.109707),
        (40.0, 1.063663, 0.118796, 0.211120),
        (60.0, 1.151720, 0.258980, 0.296604),
        (80.0, 1.293889, 0.440604, 0.359749),
        (90.0, 1.393204, 0.543053, 0.381380),
    ] {
        let n = 80;
        let at = |shortening: f64| {
            let bulge = |t: f64| 0.5 * rise * (1.0 - (2.0 * PI * t).cos());
            clamped(n, V2::x(), |t| P2::new((1.0 - shortening) * t, bulge(t)) * LENGTH_MM)
        };
        let e = at(shortening);
        let steepest = e.positions[1..].windows(2).map(|w| (w[1].y - w[0].y).atan2(w[1].x - w[0].x).to_degrees());
        let steepest = steepest.fold(0.0, f64::max);
        let height = e.positions[n / 2 + 1].y / LENGTH_MM;
        // The force is what the energy grows by.
        let d = 1e-3;
        let work = (at(shortening + d).energy_n_mm - at(shortening - d).energy_n_mm) / (2.0 * d * LENGTH_MM);
        let euler_n = 4.0 * PI.powi(2) * BENDING_N_MM2 / LENGTH_MM.powi(2);
        assert!((height - rise).abs() < 5e-4, "{slope} degrees: {height}");
        assert!((steepest - slope).abs() < 0.1, "{slope} degrees: {steepest}");
        assert!((work / euler_n / force - 1.0).abs() < 2e-3, "{slope} degrees: {work}");
    }
}

#[test]
fn a_strip_clamped_end_to_end_is_a_circle() {
    // From an oval of about the right length, its lowest point at the origin.
    let oval = |t: f64| P2::new(19.0 * (2.0 * PI * t).sin(), 12.0 * (1.0 - (2.0 * PI * t).cos()));
    let e = clamped(60, V2::x(), oval);
    let radius = LENGTH_MM / (2.0 * PI);
    let energy = PI * BENDING_N_MM2 / radius;
    assert!((e.energy_n_mm / energy - 1.0).abs() < 1e-4, "{} against {energy} N mm", e.energy_n_mm);
    let centre = P2::new(0.0, radius);
    for p in &e.positions {
        assert!(((p - centre).norm() / radius - 1.0).abs() < 1e-3, "{p}");
    }
}

/// Half of a ring, between its two loaded points, squeezed by `squeeze_mm`; the ring's radius is L / pi.
fn half_ring_energy(n: usize, squeeze_mm: f64) -> f64 {
    let radius = LENGTH_MM / PI;
    let half = |t: f64| P2::new(radius * (PI * t).sin(), (radius - 0.5 * squeeze_mm) * (1.0 - (PI * t).cos()));
    clamped(n, -V2::x(), half).energy_n_mm
}

#[test]
fn a_pinched_ring_gives_way_as_it_should() {
    // delta = (pi / 4 - 2 / pi) F R³ / EI. Two halves bear F, each as the second difference of its energy says.
    let radius = LENGTH_MM / PI;
    let d = 0.05;
    let [minus, none, plus] = [-d, 0.0, d].map(|squeeze| half_ring_energy(80, squeeze));
    let stiffness = 2.0 * (minus - 2.0 * none + plus) / (d * d);
    let expected = BENDING_N_MM2 / radius.powi(3) / (PI / 4.0 - 2.0 / PI);
    assert!((stiffness / expected - 1.0).abs() < 5e-3, "{stiffness} against {expected} N/mm");
}

/// Upright loops start as a leaf of about their length, pointed below: the place at a share of its contour.
fn leaf(t: f64) -> P2 {
    P2::new(0.13 * LENGTH_MM * (2.0 * PI * t).sin() * (PI * t).sin(), 0.42 * LENGTH_MM * (PI * t).sin())
}

/// A closed loop of `n` segments, pinned where it starts and ends and free to turn there, its crown straight above.
fn free_loop(n: usize) -> Equilibrium {
    let ruffle = chain((0..n as u32).chain([0]).collect(), vec![LENGTH_MM / n as f64; n]);
    let start: Vec<P2> = (0..n).map(|i| leaf(i as f64 / n as f64)).collect();
    let supports = Supports { pinned: vec![Node(0)], upright: vec![Node(n as u32 / 2)] };
    at_rest(solver(&ruffle, &weightless(), &supports, &afloat()), &start)
}

#[test]
fn a_loop_whose_ends_are_pinned_together_and_turn_freely_has_its_height_and_slope() {
    // 2 E(k) = K(k): k = 0.908909, the ends 180 - 130.7099 degrees from level, height 0.391594 L.
    let e = free_loop(80);
    let first = e.positions[1] - e.positions[0];
    let slope = first.y.atan2(first.x).to_degrees();
    assert!((slope - 49.2901).abs() < 0.05, "{slope} degrees");
    let error = |n: usize| (free_loop(n).positions[n / 2].y / LENGTH_MM - 0.391594).abs();
    assert!(error(80) < 2e-4, "{}", error(80));
    let ratio = error(40) / error(80);
    assert!((3.6..4.4).contains(&ratio), "ratio {ratio}");
}

/// The loop of a ruffle's connection: two passes through node 0 in opposite directions, each with a straight tail below. Energy by D w / L, height and width by
/// L, curvature at the crown times L.
fn teardrop(n: usize) -> [f64; 4] {
    let h = LENGTH_MM / n as f64;
    let (tail_in, tail_out) = (n as u32, n as u32 + 1);
    let walk = [tail_in].into_iter().chain(0..n as u32).chain([0, tail_out]).collect();
    let ruffle = chain(walk, vec![h; n + 2]);
    let mut start: Vec<P2> = (0..n).map(|i| leaf(i as f64 / n as f64)).collect();
    start.extend([P2::new(0.0, -h); 2]);
    let pinned = vec![Node(0), Node(tail_in), Node(tail_out)];
    let e = at_rest(solver(&ruffle, &weightless(), &Supports { pinned, upright: Vec::new() }, &afloat()), &start);
    let x = &e.positions[..n];
    let height = x.iter().map(|p| p.y).fold(0.0, f64::max);
    let width = 2.0 * x.iter().map(|p| p.x.abs()).fold(0.0, f64::max);
    let (a, b) = (x[n / 2] - x[n / 2 - 1], x[n / 2 + 1] - x[n / 2]);
    let crown = cross(a, b).atan2(a.dot(&b)).abs() / h;
    [e.energy_n_mm * LENGTH_MM / BENDING_N_MM2, height / LENGTH_MM, width / LENGTH_MM, crown * LENGTH_MM]
}

#[test]
fn the_loop_of_a_connection_is_the_tangent_teardrop() {
    // Boundary value problem of the elastica.
    let exact = [18.33311, 0.424308, 0.204214, 10.76882];
    let error = |n: usize| {
        let found = teardrop(n);
        [0, 1, 2, 3].map(|k| (found[k] / exact[k] - 1.0).abs())
    };
    let (coarse, fine) = (error(40), error(80));
    for k in 0..4 {
        assert!(fine[k] < 1e-3, "{k}: {fine:?}");
        let ratio = coarse[k] / fine[k];
        assert!((3.6..4.4).contains(&ratio), "{k}: {coarse:?} {fine:?}");
    }
}

#[test]
fn a_sheet_held_above_the_floor_touches_down_where_it_should() {
    // Clamped level at height H; ell = (D / q)^(1/3): H / ell, free length / ell.
    let (n, ell) = (200, 40.0);
    for (height, free) in [(0.1, 1.639645), (0.5, 2.476280), (1.0, 3.006511)] {
        let length = (free + 1.5) * ell;
        let rigidity = paper(1.0).weight_n_per_mm2() * f64::powi(ell, 3);
        let (ruffle, mut start, supports) = cantilever(n, length);
        start.iter_mut().for_each(|p| p.y = height * ell);
        let settings = Settings { contact: Contact::None, residual_n: 1e-8, ..Settings::default() };
        let e = at_rest(solver(&ruffle, &paper(rigidity), &supports, &settings), &start);
        let first = e.positions.iter().position(|p| p.y == 0.0).expect("it lies on the floor");
        let segment = length / n as f64;
        let touchdown = (first - 1) as f64 * segment;
        assert!((touchdown - free * ell).abs() < segment, "H / ell = {height}: {touchdown} mm");
        assert!(e.positions[first..].iter().all(|p| p.y == 0.0), "H / ell = {height}: it does not lie flat");
    }
}
