//! How well outlines are filled: `cargo bench --bench fill -- [--outlines FILE.json] [--only NAME,NAME] [--json] [--png DIR] [--paper] [--bare]`.
//!
//! FILE.json maps names to polygons, mm; without it, shapes of the bench's own. Prisms 40 mm thick of paper with 160 g/m², gravity on, segments of 3 mm, joints as a laser cuts
//! them. `halved` is the sum of uncovered and protruding again with segments half as long; `--paper` follows the paper's length rule instead; `--bare`
//! leaves out what joints, hands and the material ask for, to tell what that costs. Seconds are the processor's, on one core,
//! where the system tells them, else the clock's. `--png` draws every part.

use furbelow::cut::{Outline, PlaneFrame};
use furbelow::extrude::Extruder;
use furbelow::fit::{self, FootUsed, Method, Part, Settings, Target};
use furbelow::geom::{P2, P3, V3, signed_area};
use furbelow::preview::{PartView, part_canvas};
use furbelow::progress::Quiet;
use furbelow::ruffle::{Direction, StackSettings};
use furbelow::sim::{Material, Outcome};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

const PAPER_160: Material = Material {
    flexural_rigidity_n_mm: 2.1,
    membrane_stiffness_n_per_mm: 600.0,
    grammage_g_per_m2: 160.0,
    thickness_mm: 0.19,
};
const THICK_MM: f64 = 40.0;
const SEGMENT_MM: f64 = 3.0;
const PNG_PX: u32 = 900;

#[derive(Serialize)]
struct Row {
    outline: String,
    uncovered_percent: f64,
    protruding_percent: f64,
    sum_percent: f64,
    halved_sum_percent: Option<f64>,
    thinnest_layer_mm: f64,
    min_void_mm: f64,
    min_radius_mm: f64,
    foot: FootUsed,
    direction: Direction,
    layers: usize,
    nodes: usize,
    solves: usize,
    newton_steps: usize,
    crossings: usize,
    outcome: Outcome,
    seconds: f64,
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let has = |flag: &str| arguments.iter().any(|a| a == flag);
    let value = |flag: &str| arguments.windows(2).find(|w| w[0] == flag).map(|w| w[1].clone());
    let outlines = match value("--outlines") {
        Some(file) => read(&file),
        None => own(),
    };
    let only: Option<Vec<String>> = value("--only").map(|names| names.split(',').map(str::to_owned).collect());
    let method = if has("--paper") { Method::Paper } else { Method::Adjoint };
    for (name, outline) in outlines.iter().filter(|(name, _)| only.as_ref().is_none_or(|o| o.contains(name))) {
        let began = Began::now();
        let part = filled(name, outline, &settings(method, SEGMENT_MM, has("--bare")));
        let seconds = began.seconds();
        let part = match part {
            Ok(part) => part,
            Err(error) => {
                eprintln!("{name}: {error}");
                continue;
            }
        };
        let halved = filled(name, outline, &settings(method, 0.5 * SEGMENT_MM, has("--bare"))).ok();
        let sum = |part: &Part| 100.0 * (part.report.uncovered_fraction + part.report.protruding_fraction);
        let report = &part.report;
        let row = Row {
            outline: name.clone(),
            uncovered_percent: 100.0 * report.uncovered_fraction,
            protruding_percent: 100.0 * report.protruding_fraction,
            sum_percent: sum(&part),
            halved_sum_percent: halved.as_ref().map(sum),
            thinnest_layer_mm: report.thinnest_layer_mm,
            min_void_mm: report.min_void_mm,
            min_radius_mm: report.min_radius_mm,
            foot: report.foot,
            direction: report.direction,
            layers: report.layers,
            nodes: part.ruffle.node_count,
            solves: report.spent.solves,
            newton_steps: report.spent.steps,
            crossings: part.equilibrium.self_intersections,
            outcome: part.equilibrium.outcome,
            seconds,
        };
        if has("--json") {
            println!("{}", serde_json::to_string(&row).expect("a row holds nothing JSON cannot"));
        } else {
            print(&row);
        }
        if let Some(folder) = value("--png") {
            draw(&part, Path::new(&folder));
        }
    }
}

fn print(row: &Row) {
    println!(
        "{:<12} uncovered {:>5.2} % + protruding {:>5.2} % = {:>5.2} % (halved {:>5.2}), thinnest layer {:>4.1} mm, void {:>4.1}, bend {:>4.1}, {:?}, {:?}, {:>2} layers, {:>3} nodes, {:>4} solves, {:>5} steps, {} crossings, {:?}, {:.2} s",
        row.outline,
        row.uncovered_percent,
        row.protruding_percent,
        row.sum_percent,
        row.halved_sum_percent.unwrap_or(f64::NAN),
        row.thinnest_layer_mm,
        row.min_void_mm,
        row.min_radius_mm,
        row.foot,
        row.direction,
        row.layers,
        row.nodes,
        row.solves,
        row.newton_steps,
        row.crossings,
        row.outcome,
        row.seconds
    );
}

/// What a laser's joint and paper of 160 g/m² ask for, unless `bare`.
fn settings(method: Method, segment_mm: f64, bare: bool) -> Settings {
    if bare {
        let stack = StackSettings { segment_mm, ..StackSettings::default() };
        return Settings { stack, method, ..Settings::default() };
    }
    let stack = StackSettings { segment_mm, min_layer_mm: 14.85, ..StackSettings::default() };
    Settings { stack, method, min_bend_radius_mm: 5.0, min_void_mm: 9.0, min_section_mm: 17.1, ..Settings::default() }
}

fn filled(name: &str, outline: &Outline, settings: &Settings) -> Result<Part, fit::Error> {
    let frame = PlaneFrame { origin: P3::origin(), u: V3::x(), v: V3::y(), normal: V3::z() };
    let extruder = Extruder::constant(-0.5 * THICK_MM, 0.5 * THICK_MM).expect("the ends are in order");
    let target = Target { name, frame: &frame, outline, extruder: &extruder, material: &PAPER_160, loads_n: &[] };
    let part = fit::fit(&target, settings, None, &mut Quiet)?;
    fit::settle(&target, settings, part)
}

fn draw(part: &Part, folder: &Path) {
    let x = &part.equilibrium.positions;
    let joints = part.ruffle.connection_points();
    let report = &part.report;
    let canvas = part_canvas(&PartView {
        name: &part.name,
        outline: &part.outline,
        ruffle: &part.ruffle,
        positions: x,
        joints: joints.iter().map(|c| (x[c.node.index()], c.joint.to_string())).collect(),
        caption: vec![format!(
            "{:.1} % empty, {:.1} % sticks out, thinnest layer {:.0} mm, {:?}",
            100.0 * report.uncovered_fraction,
            100.0 * report.protruding_fraction,
            report.thinnest_layer_mm,
            report.foot
        )],
    });
    std::fs::create_dir_all(folder).expect("the folder can be made");
    let png = canvas.to_png(PNG_PX).expect("a part's picture fits into memory");
    std::fs::write(folder.join(format!("{}.png", part.name)), png).expect("the picture can be written");
}

/// Polygons by name, mm.
fn read(file: &str) -> BTreeMap<String, Outline> {
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{file}: {e}"));
    let loops: BTreeMap<String, Vec<[f64; 2]>> =
        serde_json::from_str(&text).unwrap_or_else(|e| panic!("{file}: {e}; it should map names to [[x, y], ...]"));
    loops.into_iter().map(|(name, points)| (name, outline(&points))).collect()
}

fn outline(points: &[[f64; 2]]) -> Outline {
    let mut outer: Vec<P2> = points.iter().map(|[x, y]| P2::new(*x, *y)).collect();
    if signed_area(&outer) < 0.0 {
        outer.reverse();
    }
    Outline { outer, holes: Vec::new() }
}

/// Shapes of the bench's own: plain ones and such as make trouble.
fn own() -> BTreeMap<String, Outline> {
    let arc = |center: [f64; 2], radius: f64, from_deg: f64, to_deg: f64| {
        (0..=40).map(move |i| {
            let angle = (from_deg + (to_deg - from_deg) * f64::from(i) / 40.0).to_radians();
            [center[0] + radius * angle.cos(), center[1] + radius * angle.sin()]
        })
    };
    let polygons: Vec<(&str, Vec<[f64; 2]>)> = vec![
        ("square", vec![[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]]),
        ("circle", arc([50.0, 50.0], 50.0, 0.0, 351.0).collect()),
        ("triangle", vec![[0.0, 0.0], [111.0, 0.0], [55.5, 100.0]]),
        ("L", vec![[0.0, 0.0], [100.0, 0.0], [100.0, 42.0], [42.0, 42.0], [42.0, 100.0], [0.0, 100.0]]),
        ("hourglass", vec![[0.0, 0.0], [84.0, 0.0], [62.0, 50.0], [84.0, 100.0], [0.0, 100.0], [22.0, 50.0]]),
        (
            "steps",
            vec![
                [0.0, 0.0],
                [120.0, 0.0],
                [120.0, 30.0],
                [90.0, 30.0],
                [90.0, 60.0],
                [60.0, 60.0],
                [60.0, 90.0],
                [30.0, 90.0],
                [30.0, 110.0],
                [0.0, 110.0],
            ],
        ),
        (
            "neck",
            vec![
                [0.0, 0.0],
                [80.0, 0.0],
                [80.0, 40.0],
                [52.0, 50.0],
                [52.0, 65.0],
                [80.0, 75.0],
                [80.0, 110.0],
                [0.0, 110.0],
                [0.0, 75.0],
                [28.0, 65.0],
                [28.0, 50.0],
                [0.0, 40.0],
            ],
        ),
        (
            "two-feet",
            vec![
                [0.0, 0.0],
                [40.0, 0.0],
                [40.0, 35.0],
                [70.0, 35.0],
                [70.0, 0.0],
                [110.0, 0.0],
                [110.0, 100.0],
                [0.0, 100.0],
            ],
        ),
        (
            "ears",
            vec![
                [10.0, 0.0],
                [90.0, 0.0],
                [100.0, 60.0],
                [95.0, 110.0],
                [75.0, 80.0],
                [25.0, 80.0],
                [5.0, 110.0],
                [0.0, 60.0],
            ],
        ),
        (
            "thin-neck",
            vec![
                [0.0, 0.0],
                [90.0, 0.0],
                [90.0, 45.0],
                [51.0, 45.0],
                [51.0, 75.0],
                [90.0, 75.0],
                [90.0, 120.0],
                [0.0, 120.0],
                [0.0, 75.0],
                [39.0, 75.0],
                [39.0, 45.0],
                [0.0, 45.0],
            ],
        ),
        (
            "star",
            (0..10)
                .map(|i| {
                    let (angle, radius) =
                        (std::f64::consts::TAU * (f64::from(i) / 10.0 + 0.25), [60.0, 30.0][i as usize % 2]);
                    [60.0 + radius * angle.cos(), 60.0 + radius * angle.sin()]
                })
                .collect(),
        ),
        ("arch", arc([100.0, 0.0], 100.0, 0.0, 180.0).chain(arc([100.0, 0.0], 55.0, 180.0, 0.0)).collect()),
        ("bow", arc([60.0, 60.0], 60.0, 45.0, 315.0).chain(arc([60.0, 60.0], 25.0, 315.0, 45.0)).collect()),
    ];
    let mut outlines: BTreeMap<String, Outline> =
        polygons.into_iter().map(|(name, points)| (name.to_owned(), outline(&points))).collect();
    let hole = arc([50.0, 55.0], 22.0, 0.0, -351.0).map(|[x, y]| P2::new(x, y)).collect();
    let around: Vec<[f64; 2]> = arc([50.0, 50.0], 50.0, 0.0, 351.0).collect();
    outlines.insert("ring".to_owned(), Outline { holes: vec![hole], ..outline(&around) });
    outlines
}

/// The start of a measurement.
struct Began {
    clock: Instant,
    processor_s: Option<f64>,
}

impl Began {
    fn now() -> Began {
        Began { clock: Instant::now(), processor_s: processor_s() }
    }

    fn seconds(&self) -> f64 {
        match (self.processor_s, processor_s()) {
            (Some(before), Some(now)) => now - before,
            _ => self.clock.elapsed().as_secs_f64(),
        }
    }
}

/// Processor time of this thread so far, where Linux tells it.
fn processor_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split(' ').next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}
