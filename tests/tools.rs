//! Sheets for every tool, as users make them: laser, knife, pen and roll, judged by the files.

use furbelow::config::Library;
use furbelow::drawing::{Drawing, DrawnPath, KerfSide, Role, text_paths};
use furbelow::gcode::{Action, Beam, CheckSettings, Dialect, Header, ToolWords, check, emit, trace};
use furbelow::geom::{P2, Path as Path2, Rect};
use furbelow::job::check_settings;
use furbelow::toolpath::{Air, Bridges, Frame, Pass, Process, Settings, Share, Tool, plan};
use proptest::prelude::*;
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
    let shape = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/cuboid.obj");
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
    let again = make(folder.path(), "roll-610", "paper-160", &["--roll", "600"]);
    assert!(String::from_utf8_lossy(&again.stdout).contains("sheets/*.plt to the cutter"));
    let text = sheet(&folder, "sheet-01.plt");
    assert!(text.starts_with("IN;PA;SP1;\n") && text.ends_with("SP0;\n"));
    let report = report(&folder);
    let drawn = report["sheets"][0]["cut_mm"].as_f64().unwrap() + report["sheets"][0]["engrave_mm"].as_f64().unwrap();
    let checked = furbelow(folder.path(), &["check", "out/sheets/sheet-01.plt", "--machine", "roll-610", "--json"]);
    assert!(checked.status.success(), "{}", told(&checked));
    let checked: Value = serde_json::from_slice(&checked.stdout).unwrap();
    assert!((checked["cut_mm"].as_f64().unwrap() - drawn).abs() < 0.002 * drawn, "{checked} {drawn}");
    // Labels are drawn by a pen in the knife's place, from the same zero and past the same crosses.
    let pen = fs::read_to_string(folder.path().join("out/pen/sheet-01.plt")).unwrap();
    assert!(warned(&report, "pen-first") && pen.len() > 1000);
    let first_cross = |text: &str| text.lines().find(|l| l.starts_with("PU")).unwrap().to_owned();
    assert_eq!(
        (first_cross(&pen).as_str(), first_cross(&text).as_str()),
        ("PU40,120;", "PU50,120;"),
        "the blade leads by its trail"
    );
    // 600 mm of media less two pinch margins.
    assert!(checked["bounds_mm"][3].as_f64().unwrap() < 560.0);
    let shown = furbelow(folder.path(), &["preview", "out/sheets/sheet-01.plt", "--out", "sheet.html"]);
    assert!(shown.status.success() && told(&shown).is_empty(), "{}", told(&shown));
    let sent = furbelow(folder.path(), &["send", "out", "--machine", "roll-610", "--port", "emulator"]);
    assert!(sent.status.code() == Some(2) && told(&sent).contains("driver"), "{}", told(&sent));
    let refused = make(folder.path(), "roll-610", "paper-160", &["--stock", "A4", "--force"]);
    assert!(!refused.status.success() && told(&refused).contains("--roll"), "{}", told(&refused));
}

#[test]
fn a_roll_fed_along_y_is_turned_and_reads_the_right_way_round() {
    let folder = tempfile::tempdir().unwrap();
    let machines = folder.path().join("config/machines");
    fs::create_dir_all(&machines).unwrap();
    let roll = "schema = 1\nname = \"laser-roll\"\ninherits = \"roll-610\"\n[controller]\ndialect = \"grbl\"\nlaser_mode = true\n\
                [roll]\nfeed_axis = \"y\"\n[pen]\nlift = { down_mm = 0, up_mm = 3, feed_mm_per_min = 600 }\n[tool]\nclass = \"diode\"\noptical_power_w = 10\nspot_mm = 0.1\npower_floor = 0.03\n";
    fs::write(machines.join("laser-roll.toml"), roll).unwrap();
    let output = make(folder.path(), "laser-roll", "paper-160", &["--roll", "300"]);
    assert!(output.status.success(), "{}", told(&output));
    let text = sheet(&folder, "sheet-01.nc");
    assert!(text.contains("; sheet lies: X260.000 Y0.000 turned 90"), "{text}");
    let points: Vec<(f64, f64)> = strokes(text.split("; cut-inner").next().unwrap()).into_iter().flatten().collect();
    // The sheet lies a quarter turn round, and a piece on it may lie either way.
    assert!(reads(&points, "PIECE A1", 3.0, &[90.0, 270.0], false), "no label reads PIECE A1");
    assert!(!reads(&points, "PIECE A1", 3.0, &[0.0, 90.0, 180.0, 270.0], true), "a label is mirrored");
}

/// True when the ends of all strokes of a text, turned by one of some angles and moved somewhere, or mirrored before, are among the points.
fn reads(points: &[(f64, f64)], text: &str, height_mm: f64, angles_deg: &[f64], mirrored: bool) -> bool {
    let paths = text_paths(text, height_mm);
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
fn a_pen_beside_a_laser_draws_the_labels_from_the_same_zero() {
    let folder = tempfile::tempdir().unwrap();
    let machines = folder.path().join("config/machines");
    fs::create_dir_all(&machines).unwrap();
    let both = "schema = 1\nname = \"both\"\ninherits = \"diode-400\"\n[pen]\noffset_mm = [-25, -12.5]\n";
    fs::write(machines.join("both.toml"), both).unwrap();
    let refused = make(folder.path(), "both", "paper-160", &[]);
    assert!(!refused.status.success() && told(&refused).contains("`lift`"), "{}", told(&refused));
    let lift = "lift = { down_mm = -1, up_mm = 3, feed_mm_per_min = 600, dwell_s = 0.1 }\n";
    fs::write(machines.join("both.toml"), [both, lift].concat()).unwrap();
    let output = make(folder.path(), "both", "paper-160", &[]);
    assert!(output.status.success(), "{}", told(&output));
    assert!(!folder.path().join("out/pen").exists(), "paper is engraved unless the design wants a pen");
    let engraved = strokes(&sheet(&folder, "sheet-01.nc"));

    let design = folder.path().join("out/design.toml");
    let text = fs::read_to_string(&design).unwrap();
    fs::write(&design, text.replace("[[part]]", "[making]\nlabel = \"pen\"\n[[part]]")).unwrap();
    let output = furbelow(folder.path(), &["make", "out/design.toml"]);
    assert!(output.status.success(), "{}", told(&output));
    assert!(warned(&report(&folder), "pen-first"));
    let cut = sheet(&folder, "sheet-01.nc");
    assert!(cut.contains("M4S0") && !cut.contains("PIECE") && !cut.contains("G1Z"));
    let drawn = fs::read_to_string(folder.path().join("out/pen/sheet-01.nc")).unwrap();
    assert!(!drawn.contains("M3") && !drawn.contains("M4") && drawn.contains("G1Z-1F600") && drawn.contains("G0Z3"));
    // The beam marks its first cross where the pen drew its own: the head stood aside by the pen's offset.
    let (beam, pen) = (engraved[0][0], strokes(&drawn).into_iter().find(|s| s[0] != s[1] && s[0].0 > 0.0).unwrap()[0]);
    assert!((pen.0 - beam.0 - 25.0).abs() < 1e-6 && (pen.1 - beam.1 - 12.5).abs() < 1e-6, "{beam:?} {pen:?}");
    let points: Vec<(f64, f64)> = strokes(&drawn).into_iter().flatten().collect();
    assert!(reads(&points, "PIECE A1", 5.0, &[0.0, 180.0], false), "no label reads PIECE A1");
    for file in ["out/pen/sheet-01.nc", "out/sheets/sheet-01.nc"] {
        let checked = furbelow(folder.path(), &["check", file, "--machine", "both"]);
        assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
    }
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
    // In which order and from which end a cut is made depends on where the name ended.
    let cuts = |text: &str| {
        let cut = strokes(text).into_iter().skip(strokes(text.split("; cut-inner").next().unwrap()).len());
        let mut cuts: Vec<[String; 2]> = cut.map(|ends| ends.map(|(x, y)| format!("{x:.2} {y:.2}"))).collect();
        cuts.iter_mut().for_each(|ends| ends.sort());
        cuts.sort();
        cuts
    };
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
    let corner = "schema = 1\nname = \"mine\"\ninherits = \"diode-400\"\norigin = \"back-right\"\n[tool]\nclearance_mm = 2\nhead_radius_mm = 1\n\
                  [[keep_outs]]\nname = \"magnet\"\nx_mm = -8\ny_mm = -100\nwidth_mm = 6\nheight_mm = 40\nrise_mm = 10\n\
                  [[keep_outs]]\nname = \"tape\"\nx_mm = -150\ny_mm = -150\nwidth_mm = 6\nheight_mm = 40\nrise_mm = 1\n";
    // A sheet under one great magnet: nothing is made rather than run into it.
    let great = corner.replace(
        "x_mm = -8\ny_mm = -100\nwidth_mm = 6\nheight_mm = 40",
        "x_mm = -290\ny_mm = -200\nwidth_mm = 280\nheight_mm = 190",
    );
    fs::write(machines.join("mine.toml"), great).unwrap();
    let output = make(folder.path(), "mine", "paper-160", &[]);
    let text = told(&output);
    assert!(!output.status.success() && text.contains("move the clamps"), "{text}");
    fs::write(machines.join("mine.toml"), corner).unwrap();
    let output = make(folder.path(), "mine", "paper-160", &[]);
    assert!(output.status.success(), "{}", told(&output));
    let text = sheet(&folder, "sheet-01.nc");
    let all: Vec<(f64, f64)> = strokes(&text).into_iter().flatten().collect();
    assert!(all.iter().all(|p| p.0 < 0.0 && p.1 < 0.0), "the sheet lies left of and before its zero");
    let checked = furbelow(folder.path(), &["check", "out/sheets/sheet-01.nc", "--machine", "mine"]);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
}

#[test]
fn pieces_are_laid_round_the_clamps_on_a_sheet_and_a_sheet_placed_by_hand_knows_of_none() {
    let folder = tempfile::tempdir().unwrap();
    let machines = folder.path().join("config/machines");
    fs::create_dir_all(&machines).unwrap();
    let clamp = Rect { min: P2::new(60.0, 40.0), max: P2::new(110.0, 70.0) };
    let clamped = "schema = 1\nname = \"clamped\"\ninherits = \"diode-400\"\n[tool]\nclearance_mm = 2\nhead_radius_mm = 3\n\
                   [[keep_outs]]\nname = \"clamp\"\nx_mm = 60\ny_mm = 40\nwidth_mm = 50\nheight_mm = 30\nrise_mm = 10\n";
    fs::write(machines.join("clamped.toml"), clamped).unwrap();
    let programs = |model: &str, extra: &[&str]| {
        let shape = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models").join(model);
        let args = ["make", shape.to_str().unwrap(), "-m", "clamped", "-p", "paper-160", "--out", model];
        let output = furbelow(folder.path(), &[&args, extra].concat());
        assert!(output.status.success(), "{}", told(&output));
        let sheets = fs::read_dir(folder.path().join(model).join("sheets")).unwrap().map(|entry| entry.unwrap().path());
        let mut programs: Vec<_> = sheets.filter(|path| path.extension().is_some_and(|e| e == "nc")).collect();
        programs.sort();
        programs
    };
    let enters = |path: &Path| {
        let head = clamp.grown(3.0 - 1e-3);
        let within = |(x, y): (f64, f64)| Rect::EMPTY.with(P2::new(x, y)).grown(1e-6).overlaps(&head);
        let along = |[a, b]: [(f64, f64); 2]| {
            (0..=100).map(move |k| f64::from(k) / 100.0).any(|s| within((a.0 + s * (b.0 - a.0), a.1 + s * (b.1 - a.1))))
        };
        strokes(&fs::read_to_string(path).unwrap()).into_iter().any(along)
    };
    for program in programs("stool.obj", &[]) {
        assert!(!enters(&program), "{}", program.display());
        let checked = furbelow(folder.path(), &["check", program.to_str().unwrap(), "--machine", "clamped"]);
        assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
    }
    // Nobody knows where the clamp lies from there.
    let by_hand = programs("cuboid.obj", &["--start-from", "origin"]);
    assert!(by_hand.iter().any(|program| enters(program)));
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

/// Pieces in rows, some of them left out, with a slit, a mark and a flap each.
fn pieces(taken: &[bool]) -> Vec<Drawing> {
    let mut drawings = Vec::new();
    for (k, _) in taken.iter().enumerate().filter(|(_, taken)| **taken) {
        let (x, y) = (15.0 + 75.0 * (k % 5) as f64, 15.0 + 55.0 * (k / 5) as f64);
        let p = |dx: f64, dy: f64| P2::new(x + dx, y + dy);
        let drawn = |path, role, kerf| DrawnPath { path, role, kerf, joint: None };
        let outline = Path2::rounded(&[p(0.0, 0.0), p(60.0, 0.0), p(60.0, 40.0), p(0.0, 40.0)].map(|c| (c, 2.0)), true);
        let paths = vec![
            drawn(outline, Role::Outline, KerfSide::Outside),
            drawn(Path2::open([p(20.0, 10.0), p(20.0, 30.0)]), Role::Slit, KerfSide::On),
            drawn(
                Path2::open([p(40.0, 10.0), p(48.0, 10.0), p(48.0, 20.0), p(40.0, 20.0)]),
                Role::Flap,
                KerfSide::Right,
            ),
            drawn(Path2::open([p(10.0, 10.0), p(10.0, 30.0)]), Role::Mark, KerfSide::On),
        ];
        drawings.push(Drawing { name: format!("A{}", k + 1), paths });
    }
    drawings
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Whatever lies on the bed and however it is cut: the program keeps off the clamps, inside the bed, and its beam off on travels.
    #[test]
    fn no_program_travels_lit_leaves_the_bed_or_runs_into_a_clamp(
        taken in prop::collection::vec(any::<bool>(), 25), clamps in prop::collection::vec((0usize..4, 0usize..5), 0..4),
        blade in any::<bool>(), constant in any::<bool>(), bridged in any::<bool>(), lead_mm in 0.0..1.5f64,
    ) {
        let library = Library::built_in();
        let machine = library.machine("diode-400").unwrap();
        let process = Process { feed_mm_per_min: 1200.0, passes: vec![Pass { power: 0.5, depth_mm: 0.0 }; 2], air: Air::Off, dashes: None };
        // Clamps stand in the lanes of 15 mm between the pieces.
        let clamp = |(column, row): (usize, usize)| {
            let min = P2::new(78.0 + 75.0 * column as f64, 20.0 + 55.0 * row as f64);
            ("clamp".to_owned(), Rect { min, max: P2::new(min.x + 9.0, min.y + 30.0) })
        };
        let keep_outs: Vec<(String, Rect)> = clamps.into_iter().map(clamp).collect();
        let settings = Settings {
            tool: if blade { Tool::Knife { offset_mm: 0.25 } } else { Tool::Laser { strike: None } },
            share: Share::All,
            kerf_mm: if blade { 0.0 } else { 0.15 },
            engrave: Some(process.clone()),
            cut_inner: process.clone(),
            cut_outline: process,
            curve_tolerance_mm: 0.02,
            trials: Vec::new(),
            bridges: bridged.then_some(Bridges { width_mm: 0.4, pitch_mm: 60.0, everywhere: false }),
            held: true,
            lead_mm: if blade { 0.0 } else { lead_mm },
            overcut_mm: if blade { 0.5 } else { 0.0 },
            cool_mm: 0.0,
            common_edges: false,
            crosses: true,
            window_mm: None,
            cross_cut: false,
            frame: Frame::PLAIN,
            work_area: Rect::from_size(400.0, 400.0),
            keep_outs: keep_outs.clone(),
            park: P2::origin(),
        };
        let path = plan(&pieces(&taken), 400.0, 300.0, &settings).unwrap();
        let tool = if blade {
            ToolWords::Lift { down_mm: 0.0, up_mm: 3.0, feed_mm_per_min: 600.0, dwell_s: 0.1 }
        } else {
            ToolWords::Laser { constant_power: constant }
        };
        let program = emit(&path, &Header::default(), &Dialect { max_s: 1000.0, tool, from_here: false, air: None }).unwrap();
        let settings = CheckSettings { keep_outs, laser: !blade, laser_mode: !blade, ..check_settings(&machine, None) };
        let report = check(&program, &settings);
        prop_assert!(report.errors.is_empty(), "{:?}", report.errors);
        let moves = trace(&program).unwrap();
        prop_assert!(moves.iter().all(|m| m.action != Action::Rapid || m.power_s == 0.0 || m.beam == Beam::Off));
        let sums: f64 = path.contours.iter().map(|c| c.path.length()).sum();
        // A blade's way down is fed too.
        let lowered = if blade { 3.0 * path.contours.len() as f64 } else { 0.0 };
        prop_assert!(report.cut_mm > 0.99 * sums && report.cut_mm < 1.01 * sums + lowered, "{} for {}", report.cut_mm, sums);
    }
}
