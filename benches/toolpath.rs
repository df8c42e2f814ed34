//! What tool paths cost the machine: `cargo bench --bench toolpath -- --json`.
//!
//! `arcs`: planned time as drawn and in lines and arcs within 0.02 mm, at F6000 on a diode-400, from the first cut to the last. A circle of 50 mm radius and
//! a sheet of ribbons with wavy rims, both in steps of 0.3 mm as curves come out of drawing programs; and the teddy's sheets, whose rims come in steps of
//! some 3 mm. `travel`: way between cuts on the teddy's sheets, as drawn and ordered.

use std::f64::consts::TAU;

use furbelow::config::Library;
use furbelow::drawing::{Drawing, DrawnPath, KerfSide, Operation, Role, read_svg};
use furbelow::gcode::{Dialect, Header, Move, ToolWords, emit, estimate, trace};
use furbelow::geom::{P2, Path, Rect};
use furbelow::job::{self, Order, Overrides, limits};
use furbelow::progress::Quiet;
use furbelow::toolpath::{Air, Frame, Pass, Process, Settings, Share, Tool, plan};
use serde::Serialize;

#[derive(Serialize)]
struct Row {
    name: &'static str,
    case: String,
    /// s for arcs, mm for travel.
    before: f64,
    after: f64,
    /// Share saved, %.
    saved: f64,
    lines_before: usize,
    lines_after: usize,
}

fn main() {
    let json = std::env::args().any(|a| a == "--json");
    let folder = tempfile::tempdir().expect("a scratch folder");
    let teddy = teddy(folder.path());
    let mut rows = vec![arcs("circle".into(), &[circle()]), arcs("ribbon sheet".into(), &ribbons())];
    for sheet in &teddy.report.sheets {
        let svg = std::fs::read_to_string(folder.path().join(&sheet.file).with_extension("svg")).expect("a sheet");
        let drawn = read_svg(&svg).expect("our own");
        let cut: Vec<Drawing> = drawn.iter().map(|d| d.without(Operation::Engrave)).collect();
        rows.push(arcs(format!("teddy {}", sheet.file), &cut));
    }
    rows.extend(teddy.report.sheets.iter().map(travel));
    for row in rows {
        if json {
            println!("{}", serde_json::to_string(&row).expect("a row holds nothing JSON cannot"));
        } else {
            let Row { name, case, before, after, saved, lines_before, lines_after } = &row;
            println!(
                "{name}, {case}: {before:.1} before, {after:.1} after, {saved:.0} % less ({lines_before} lines, {lines_after})"
            );
        }
    }
}

fn settings(curve_tolerance_mm: f64) -> Settings {
    let process = Process {
        feed_mm_per_min: 6000.0,
        passes: vec![Pass { power: 0.5, depth_mm: 0.0 }],
        air: Air::Off,
        dashes: None,
    };
    Settings {
        tool: Tool::Laser { strike: None },
        share: Share::All,
        kerf_mm: 0.15,
        engrave: None,
        cut_inner: process.clone(),
        cut_outline: process,
        curve_tolerance_mm,
        trials: Vec::new(),
        bridges: None,
        held: true,
        lead_mm: 0.0,
        overcut_mm: 0.0,
        cool_mm: 0.0,
        common_edges: false,
        crosses: false,
        window_mm: None,
        cross_cut: false,
        frame: Frame::PLAIN,
        work_area: Rect::from_size(400.0, 400.0),
        keep_outs: Vec::new(),
        park: P2::origin(),
    }
}

fn arcs(case: String, sheet: &[Drawing]) -> Row {
    let machine = Library::built_in().machine("diode-400").expect("built in");
    let dialect =
        Dialect { max_s: 1000.0, tool: ToolWords::Laser { constant_power: false }, from_here: false, air: None };
    let planned = |tolerance_mm: f64| {
        let path = plan(sheet, 400.0, 400.0, &settings(tolerance_mm)).expect("a path");
        let program = emit(&path, &Header::default(), &dialect).expect("a program");
        let moves = trace(&program).expect("moves");
        let (first, last) = (moves.iter().position(Move::burns), moves.iter().rposition(Move::burns));
        let cut = &moves[first.expect("cuts")..=last.expect("cuts")];
        (estimate(cut, &limits(&machine)).total_s, cut.iter().filter(|m| m.burns()).count())
    };
    let (before, lines_before) = planned(0.0);
    let (after, lines_after) = planned(0.02);
    let saved = 100.0 * (1.0 - after / before);
    Row { name: "arcs", case, before, after, saved, lines_before, lines_after }
}

fn outline(name: String, points: impl IntoIterator<Item = P2>) -> Drawing {
    let path = DrawnPath { path: Path::closed(points), role: Role::Outline, kerf: KerfSide::Outside, joint: None };
    Drawing { name, paths: vec![path] }
}

fn circle() -> Drawing {
    let steps = (TAU * 50.0 / 0.3) as u32;
    let at = |k: u32| {
        let angle = TAU * f64::from(k) / f64::from(steps);
        P2::new(200.0 + 50.0 * angle.cos(), 200.0 + 50.0 * angle.sin())
    };
    outline("A1".into(), (0..steps).map(at))
}

fn ribbons() -> Vec<Drawing> {
    let steps = (280.0 / 0.3) as u32;
    let ribbon = |k: u32| {
        let rim = move |i: u32, up: f64| {
            let x = 280.0 * f64::from(i) / f64::from(steps);
            P2::new(20.0 + x, 25.0 + 55.0 * f64::from(k) + up + 6.0 * (x / 70.0 * TAU + f64::from(k)).sin())
        };
        outline(
            format!("A{}", k + 1),
            (0..=steps).map(move |i| rim(i, 0.0)).chain((0..=steps).rev().map(move |i| rim(i, 35.0))),
        )
    };
    (0..6).map(ribbon).collect()
}

fn teddy(folder: &std::path::Path) -> job::Made {
    let shape = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/teddy.obj");
    let overrides =
        Overrides { machine: Some("diode-400".into()), material: Some("paper-160".into()), ..Overrides::default() };
    let order = Order::from_mesh(&shape, &overrides).expect("a mesh");
    job::make(&order, &Library::built_in(), folder, &mut Quiet).expect("a job")
}

fn travel(sheet: &job::SheetReport) -> Row {
    let (before, after) = (sheet.travel_unordered_mm, sheet.travel_mm);
    let saved = 100.0 * (1.0 - after / before);
    let case = format!("teddy {}", sheet.file);
    Row { name: "travel", case, before, after, saved, lines_before: sheet.lines, lines_after: sheet.lines }
}
