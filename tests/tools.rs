//! Sheets for every tool, as users make them: laser, knife, pen and roll, judged by the files.

use furbelow::drawing::text_paths;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn furbelow(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_furbelow"))
        .args(args)
        .current_dir(folder)
        .env("FURBELOW_CONFIG_DIR", folder.join("config"))
        .output()
        .expect("the program starts")
}

fn make(folder: &Path, machine: &str, material: &str, extra: &[&str]) -> Output {
    let shape = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/stool.obj");
    let shape = shape.to_str().expect("plain path");
    let mut args = vec!["make", shape, "--machine", machine, "--material", material, "--out", "out"];
    args.extend(extra);
    furbelow(folder, &args)
}

fn made(machine: &str, material: &str, extra: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let output = make(folder.path(), machine, material, extra);
    assert!(output.status.success(), "{}", told(&output));
    folder
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn sheet(folder: &tempfile::TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join("out/sheets").join(name)).unwrap()
}

fn report(folder: &tempfile::TempDir) -> Value {
    serde_json::from_slice(&fs::read(folder.path().join("out/report.json")).unwrap()).unwrap()
}

fn warned(report: &Value, code: &str) -> bool {
    report["warnings"].as_array().unwrap().iter().any(|w| w["code"] == code)
}

/// Strokes of a program: from where to where, in the order they are drawn; arcs by their ends.
fn strokes(text: &str) -> Vec<[(f64, f64); 2]> {
    let (mut strokes, mut at, mut feeds) = (Vec::new(), (0.0, 0.0), false);
    for line in text.lines().filter(|l| !l.starts_with(';')) {
        let word = |letter: char| {
            let rest = &line[line.find(letter)? + 1..];
            rest[..rest.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(rest.len())].parse::<f64>().ok()
        };
        if let Some(g) = word('G').filter(|g| *g <= 3.0) {
            feeds = g > 0.0;
        }
        let to = (word('X').unwrap_or(at.0), word('Y').unwrap_or(at.1));
        if feeds && to != at {
            strokes.push([at, to]);
        }
        at = to;
    }
    strokes
}

#[test]
fn a_pen_draws_all_lines_lowers_itself_for_each_and_says_that_it_cuts_nothing() {
    let folder = made("pen-a3", "paper-160", &[]);
    let text = sheet(&folder, "sheet-01.nc");
    let (downs, ups) = (text.matches("M3S90\n").count(), text.matches("M3S40\n").count());
    assert!(downs > 50 && ups == downs + 1, "{downs} {ups}");
    assert!(!text.contains("M4") && text.matches("G4P0.2").count() == downs + ups);
    assert!(warned(&report(&folder), "drawn-only") && !warned(&report(&folder), "not-held"));
    let checked = furbelow(folder.path(), &["check", "out/sheets/sheet-01.nc", "--machine", "pen-a3"]);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
}

#[test]
fn a_roll_is_a_plot_that_check_and_preview_read_too() {
    let folder = made("roll-610", "paper-160", &["--roll", "600"]);
    let text = sheet(&folder, "sheet-01.plt");
    assert!(text.starts_with("IN;PA;SP1;\n") && text.ends_with("SP0;\n"));
    let report = report(&folder);
    let drawn = report["sheets"][0]["cut_mm"].as_f64().unwrap() + report["sheets"][0]["engrave_mm"].as_f64().unwrap();
    let checked = furbelow(folder.path(), &["check", "out/sheets/sheet-01.plt", "--machine", "roll-610", "--json"]);
    assert!(checked.status.success(), "{}", told(&checked));
    let checked: Value = serde_json::from_slice(&checked.stdout).unwrap();
    assert!((checked["cut_mm"].as_f64().unwrap() - drawn).abs() < 0.002 * drawn, "{checked} {drawn}");
    // 600 mm of media less two pinch margins.
    assert!(checked["bounds_mm"][3].as_f64().unwrap() < 560.0);
    let shown = furbelow(folder.path(), &["preview", "out/sheets/sheet-01.plt", "--out", "sheet.html"]);
    assert!(shown.status.success() && told(&shown).is_empty(), "{}", told(&shown));
    let refused = make(folder.path(), "roll-610", "paper-160", &["--stock", "A4", "--force"]);
    assert!(!refused.status.success() && told(&refused).contains("--roll"), "{}", told(&refused));
}

#[test]
fn a_roll_fed_along_y_is_turned_and_reads_the_right_way_round() {
    let folder = tempfile::tempdir().unwrap();
    let machines = folder.path().join("config/machines");
    fs::create_dir_all(&machines).unwrap();
    let roll = "schema = 1\nname = \"laser-roll\"\ninherits = \"roll-610\"\n[controller]\ndialect = \"grbl\"\nlaser_mode = true\n\
                [roll]\nfeed_axis = \"y\"\n[tool]\nclass = \"diode\"\noptical_power_w = 10\nspot_mm = 0.1\npower_floor = 0.03\n";
    fs::write(machines.join("laser-roll.toml"), roll).unwrap();
    let output = make(folder.path(), "laser-roll", "paper-160", &["--roll", "300"]);
    assert!(output.status.success(), "{}", told(&output));
    let text = sheet(&folder, "sheet-01.nc");
    assert!(text.contains("; sheet lies: X260.000 Y0.000 turned 90"), "{text}");
    let points: Vec<(f64, f64)> = strokes(text.split("; cut-inner").next().unwrap()).into_iter().flatten().collect();
    // The sheet lies a quarter turn round, and a piece on it may lie either way.
    assert!(reads(&points, "PIECE A1", &[90.0, 270.0], false), "no label reads PIECE A1");
    assert!(!reads(&points, "PIECE A1", &[0.0, 90.0, 180.0, 270.0], true), "a label is mirrored");
}

/// True when the ends of all strokes of a text, turned by one of some angles and moved somewhere, or mirrored before, are among the points.
fn reads(points: &[(f64, f64)], text: &str, angles_deg: &[f64], mirrored: bool) -> bool {
    let paths = text_paths(text, 3.0);
    let ends = paths.iter().flat_map(|path| [path.start(), path.end()]).flatten();
    let ends: Vec<(f64, f64)> = ends.map(|p| (if mirrored { -p.x } else { p.x }, p.y)).collect();
    let near = |x: f64, y: f64| points.iter().any(|p| (p.0 - x).abs() < 0.02 && (p.1 - y).abs() < 0.02);
    angles_deg.iter().any(|angle| {
        let (sin, cos) = angle.to_radians().sin_cos();
        let turned: Vec<(f64, f64)> = ends.iter().map(|(x, y)| (cos * x - sin * y, sin * x + cos * y)).collect();
        points.iter().any(|(px, py)| {
            let (dx, dy) = (px - turned[0].0, py - turned[0].1);
            turned.iter().all(|(x, y)| near(x + dx, y + dy))
        })
    })
}

#[test]
fn only_cuts_what_was_torn_and_copies_carry_their_names() {
    let folder = made("diode-400", "paper-160", &["--only", "a2"]);
    let report = report(&folder);
    assert_eq!(report["pieces"].as_array().unwrap().len(), 1);
    assert_eq!(report["pieces"][0]["name"], "A2");
    let unknown = make(folder.path(), "diode-400", "paper-160", &["--only", "Z9", "--force"]);
    assert!(!unknown.status.success() && told(&unknown).contains("A1"), "{}", told(&unknown));

    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("class.txt"), "Anna\n\nBo\n").unwrap();
    let output = make(folder.path(), "diode-400", "paper-160", &["--only", "A1", "--names", "class.txt"]);
    assert!(output.status.success(), "{}", told(&output));
    let [anna, bo] = ["sheet-01.nc", "sheet-02.nc"].map(|name| sheet(&folder, name));
    assert!(anna.contains("; set: Anna") && bo.contains("; set: Bo") && anna.contains("; sheet: 1/2 "));
    let cuts = |text: &str| text.split_once("; cut-inner").unwrap().1.to_owned();
    assert_eq!(cuts(&anna), cuts(&bo), "the sets are alike");
    assert_ne!(anna.split("; cut-inner").next(), bo.split("; cut-inner").next(), "but for their names");
}

#[test]
fn a_job_may_start_anywhere_with_any_of_its_points() {
    let bounds = |text: &str| {
        let all: Vec<(f64, f64)> = strokes(text).into_iter().flatten().collect();
        let least = all.iter().fold((f64::INFINITY, f64::INFINITY), |m, p| (m.0.min(p.0), m.1.min(p.1)));
        let most = all.iter().fold((f64::NEG_INFINITY, f64::NEG_INFINITY), |m, p| (m.0.max(p.0), m.1.max(p.1)));
        (least, most)
    };
    let folder = made("diode-400", "paper-160", &["--only", "A1", "--start-from", "current", "--anchor", "center"]);
    let text = sheet(&folder, "sheet-01.nc");
    assert!(text.contains("\nG92X0Y0\n") && text.contains("\nG92.1\n"));
    let (least, most) = bounds(&text);
    assert!((least.0 + most.0).abs() < 0.2 && (least.1 + most.1).abs() < 0.2, "{least:?} {most:?}");
    let folder = made("diode-400", "paper-160", &["--only", "A1", "--start-from", "origin", "--anchor", "back-right"]);
    let text = sheet(&folder, "sheet-01.nc");
    assert!(!text.contains("G92"));
    let (_, most) = bounds(&text);
    assert!(most.0.abs() < 0.1 && most.1.abs() < 0.1, "{most:?}");
    let refused = make(folder.path(), "diode-400", "paper-160", &["--anchor", "center", "--force"]);
    assert!(!refused.status.success() && told(&refused).contains("--start-from"), "{}", told(&refused));
}

#[test]
fn a_zero_in_another_corner_moves_the_sheet_there_and_travel_goes_round_clamps() {
    let folder = tempfile::tempdir().unwrap();
    let machines = folder.path().join("config/machines");
    fs::create_dir_all(&machines).unwrap();
    let corner = "schema = 1\nname = \"mine\"\ninherits = \"diode-400\"\norigin = \"back-right\"\n[tool]\nclearance_mm = 2\nhead_radius_mm = 5\n\
                  [[keep_outs]]\nname = \"magnet\"\nx_mm = -8\ny_mm = -100\nwidth_mm = 6\nheight_mm = 40\nrise_mm = 10\n\
                  [[keep_outs]]\nname = \"tape\"\nx_mm = -150\ny_mm = -150\nwidth_mm = 6\nheight_mm = 40\nrise_mm = 1\n";
    fs::write(machines.join("mine.toml"), corner).unwrap();
    let output = make(folder.path(), "mine", "paper-160", &[]);
    let text = told(&output);
    // The margin of 10 mm is narrower than magnet and head: the job says so rather than run into it.
    assert!(!output.status.success() && text.contains("magnet"), "{text}");
    fs::write(machines.join("mine.toml"), corner.replace("head_radius_mm = 5", "head_radius_mm = 1")).unwrap();
    let output = make(folder.path(), "mine", "paper-160", &[]);
    assert!(output.status.success(), "{}", told(&output));
    let text = sheet(&folder, "sheet-01.nc");
    let all: Vec<(f64, f64)> = strokes(&text).into_iter().flatten().collect();
    assert!(all.iter().all(|p| p.0 < 0.0 && p.1 < 0.0), "the sheet lies left of and before its zero");
    let checked = furbelow(folder.path(), &["check", "out/sheets/sheet-01.nc", "--machine", "mine"]);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
}

#[test]
fn a_tube_cuts_thin_film_at_constant_power_and_never_travels_lit() {
    let folder = made("k40", "polyester-0.1", &[]);
    let text = sheet(&folder, "sheet-01.nc");
    assert!(text.contains("\nM3S0\n") && !text.contains("M4"));
    assert!(!warned(&report(&folder), "power-floor"));
    for line in text.lines().filter(|l| l.starts_with("G0X") || l.starts_with("G0Y")) {
        assert!(line.ends_with("S0") || line == "G0X0Y0", "{line}");
    }
    let checked = furbelow(
        folder.path(),
        &["check", "out/sheets/sheet-01.nc", "--machine", "k40", "--material", "polyester-0.1", "--json"],
    );
    let checked: Value = serde_json::from_slice(&checked.stdout).unwrap();
    let codes: Vec<&str> =
        checked["warnings"].as_array().unwrap().iter().map(|w| w["code"].as_str().unwrap()).collect();
    assert!(!codes.contains(&"unlit") && checked["errors"].as_array().unwrap().is_empty(), "{codes:?}");
}
