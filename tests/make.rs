//! `furbelow make` as its users run it: the real binary on real meshes, judged by what it writes.

#[path = "kerf/mod.rs"]
mod kerf;

use kerf::{Meant, NOTHING, Sheet, compare, judge};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const MODELS: [&str; 5] = ["cuboid", "stool", "teddy", "lampshade", "shell"];

fn model(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models").join(format!("{name}.obj"))
}

fn furbelow(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_furbelow"))
        .args(args)
        .current_dir(folder)
        .env("FURBELOW_CONFIG_DIR", folder.join("config"))
        .output()
        .expect("the program starts")
}

fn make(folder: &Path, shape: &Path, extra: &[&str]) -> Output {
    let shape = shape.to_str().expect("plain path");
    let mut args = vec!["make", shape, "--machine", "diode-400", "--material", "paper-160", "--out", "out"];
    args.extend(extra);
    furbelow(folder, &args)
}

fn report(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("out/report.json")).expect("a report")).expect("JSON")
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("an exit code")
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Every file below a folder with its bytes, report.json without its timing.
fn snapshot(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let mut bytes = fs::read(&path).expect("a file");
            if path.ends_with("report.json") {
                let mut report: Value = serde_json::from_slice(&bytes).expect("JSON");
                report.as_object_mut().expect("an object").remove("timing").expect("timing is there");
                bytes = report.to_string().into_bytes();
            }
            files.push((path.strip_prefix(folder).expect("inside").to_path_buf(), bytes));
        }
    }
    files.sort();
    files
}

#[test]
fn every_model_is_made_its_report_adds_up_and_what_is_cut_is_true_to_size() {
    for name in MODELS {
        let folder = tempfile::tempdir().unwrap();
        let output = make(folder.path(), &model(name), &[]);
        assert_eq!(code(&output), 0, "{name}: {}", told(&output));
        let report = report(folder.path());
        let part = &report["parts"][0];
        assert_eq!(part["outcome"], "converged", "{name}");
        assert_eq!(part["self_intersections"], 0, "{name}");
        assert!(part["uncovered_fraction"].as_f64().unwrap() < 0.4, "{name}: {part}");
        let ruffle: Value = serde_json::from_slice(&fs::read(folder.path().join("out/ruffle.json")).unwrap()).unwrap();
        let equilibrium = &ruffle["parts"][0]["equilibrium"];
        assert!(equilibrium["max_strain"].as_f64().unwrap() < 1e-3, "{name}: paper does not stretch");
        assert!(equilibrium["residual_n"].as_f64().unwrap() < 1e-5, "{name}");
        let pieces = report["pieces"].as_array().unwrap();
        let sheets = report["sheets"].as_array().unwrap();
        assert_eq!(report["totals"]["sheets"], sheets.len());
        let placed: u64 = sheets.iter().map(|s| s["pieces"].as_u64().unwrap()).sum();
        assert_eq!(placed as usize, pieces.len(), "{name}: every piece lies on a sheet");
        assert!(pieces.iter().all(|p| p["sheet"].as_u64().unwrap() >= 1));
        assert!(report["totals"]["max_kerf_deviation_mm"].as_f64().unwrap() < 0.005);
        assert!(report["totals"]["max_mating_error_mm"].as_f64().unwrap() < 0.05);
        assert_eq!(report["totals"]["label_collisions"], 0, "{name}");
        assert!(!report["warnings"].to_string().contains("labels-left-out"), "{name}: {}", report["warnings"]);
        for sheet in sheets {
            assert!(sheet["travel_mm"].as_f64().unwrap() <= sheet["travel_unordered_mm"].as_f64().unwrap());
            let program = fs::read_to_string(folder.path().join("out").join(sheet["file"].as_str().unwrap())).unwrap();
            assert_eq!(program.lines().count() as u64, sheet["lines"].as_u64().unwrap());
            let label = furbelow::job::Label::read(program.as_bytes()).unwrap();
            assert_eq!([&label.machine, &label.material].map(Option::as_deref), [Some("diode-400"), Some("paper-160")]);
            assert_eq!((label.sheet.expect("a sheet").of, label.grain.as_deref()), (sheets.len(), Some("along X")));
            assert!(label.uncalibrated.is_some(), "{name}: nobody measured paper here");
        }
        for Sheet { nominal, runs, kerf_mm, pen } in kerf::sheets(&folder.path().join("out")) {
            assert!(kerf_mm == 0.15 && pen.is_empty());
            let found = compare::compared(&nominal, &runs, 0.5 * kerf_mm);
            judge(name, &nominal, &found, &Meant { bridge: (0.4, 100.0), ..NOTHING });
            for (outline, gaps) in nominal.iter().zip(&found.gaps).filter(|(n, _)| n.class == "outline") {
                assert!(gaps.len() >= 2, "{name}: {} hangs on {} bridges", outline.piece, gaps.len());
            }
        }
    }
}

/// Reads only the G-code, by rules of its own: a word is modal until it is said again.
#[test]
fn no_program_burns_on_a_travel_or_leaves_the_bed() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(code(&make(folder.path(), &model("teddy"), &[])), 0);
    let program = fs::read_to_string(folder.path().join("out/sheets/sheet-01.nc")).unwrap();
    let (mut g, mut s, mut beam, mut burnt_lines) = (0, 0.0, false, 0);
    for line in program.lines().map(|l| l.split(';').next().unwrap_or("")).filter(|l| !l.is_empty()) {
        assert!(line.len() < 80, "{line}");
        let mut words: Vec<(char, f64)> = Vec::new();
        let starts: Vec<usize> = line.char_indices().filter(|(_, c)| c.is_ascii_alphabetic()).map(|(i, _)| i).collect();
        for (k, at) in starts.iter().enumerate() {
            let end = starts.get(k + 1).copied().unwrap_or(line.len());
            words.push((line.as_bytes()[*at] as char, line[at + 1..end].parse().unwrap()));
        }
        for (letter, value) in &words {
            match (letter, *value as i32) {
                ('G', n @ 0..=3) => g = n,
                ('M', 3 | 4) => beam = true,
                ('M', 5) => beam = false,
                ('S', _) => s = *value,
                ('X' | 'Y', _) => assert!((0.0..=400.0).contains(value), "{line}"),
                _ => {}
            }
        }
        if words.iter().any(|(letter, _)| matches!(letter, 'X' | 'Y')) {
            let burns = beam && s > 0.0;
            assert!(!(g == 0 && burns), "burns on a travel: {line}");
            burnt_lines += i32::from(burns);
        }
    }
    assert!(burnt_lines > 100 && !beam, "the program cuts and ends with the beam off");
}

#[test]
fn the_same_design_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(code(&make(folder.path(), &model("stool"), &[])), 0);
    let first = snapshot(&folder.path().join("out"));
    assert_eq!(code(&make(folder.path(), &model("stool"), &[])), 0);
    assert!(snapshot(&folder.path().join("out")) == first, "a second run differs");
    let again = furbelow(folder.path(), &["make", "out/design.toml"]);
    assert_eq!(code(&again), 0, "{}", told(&again));
    assert!(snapshot(&folder.path().join("out")) == first, "making the design differs");
    assert!(first.iter().any(|(path, _)| path.ends_with("sheets/sheet-01.nc")));
}

#[test]
fn the_drawings_are_true_size_and_name_every_joint_twice() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(code(&make(folder.path(), &model("stool"), &[])), 0);
    let report = report(folder.path());
    let mut flaps: Vec<String> = Vec::new();
    let mut slits: Vec<String> = Vec::new();
    for piece in report["pieces"].as_array().unwrap() {
        let file = format!("out/strips/{}.svg", piece["name"].as_str().unwrap());
        let text = fs::read_to_string(folder.path().join(file)).unwrap();
        let svg = roxmltree::Document::parse(&text).unwrap();
        assert!(svg.root_element().attribute("width").unwrap().ends_with("mm"));
        for path in svg.descendants().filter(|n| n.has_tag_name("path")) {
            let joint = || path.attribute("data-joint").expect("a joint").to_owned();
            match path.attribute("class") {
                Some("flap") => flaps.push(joint()),
                Some("slit") => slits.push(joint()),
                Some("outline") => assert_eq!(path.attribute("stroke"), Some("#FF0000")),
                _ => {}
            }
        }
    }
    for joints in [&mut flaps, &mut slits] {
        joints.sort();
        joints.dedup();
    }
    let connections = report["parts"][0]["connection_points"].as_u64().unwrap() as usize;
    assert_eq!(flaps.len(), connections);
    assert_eq!(flaps, slits, "every flap has a slit of the same number");
}

#[test]
fn clear_film_on_a_diode_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let shape = model("cuboid");
    let args = ["make", shape.to_str().unwrap(), "-m", "diode-400", "-p", "polyester-0.1", "--out", "out"];
    let output = furbelow(folder.path(), &args);
    assert_eq!(code(&output), 1);
    assert!(told(&output).contains("clear"), "{}", told(&output));
    assert!(!folder.path().join("out").exists(), "nothing is written");
}

#[test]
fn where_nothing_can_be_engraved_nothing_but_cuts_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let shape = model("cuboid");
    let args = ["make", shape.to_str().unwrap(), "-m", "k40", "-p", "paper-80", "--stock", "A4", "--out", "out"];
    let output = furbelow(folder.path(), &args);
    assert_eq!(code(&output), 0, "{}", told(&output));
    let report = report(folder.path());
    assert!(report["pieces"].as_array().unwrap().len() > 1, "the strip is spliced");
    for sheet in report["sheets"].as_array().unwrap() {
        assert_eq!(sheet["engrave_mm"], 0.0);
    }
    let svg = fs::read_to_string(folder.path().join("out/sheets/sheet-01.svg")).unwrap();
    assert!(!svg.contains("class=\"mark\"") && !svg.contains("class=\"label\""));
}

#[test]
fn a_design_with_a_machine_of_its_own_can_be_made_from_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let machine =
        "schema = 1\nname = \"mine\"\ninherits = \"diode-400\"\n[work_area]\nwidth_mm = 350\nheight_mm = 350\n";
    fs::create_dir(folder.path().join("machines")).unwrap();
    fs::create_dir(folder.path().join("elsewhere")).unwrap();
    fs::write(folder.path().join("machines/mine.toml"), machine).unwrap();
    let shape = model("cuboid");
    let args = ["make", shape.to_str().unwrap(), "-m", "machines/mine.toml", "-p", "paper-160", "--out", "out"];
    assert_eq!(code(&furbelow(folder.path(), &args)), 0);
    let first = snapshot(&folder.path().join("out"));
    let again = furbelow(&folder.path().join("elsewhere"), &["make", "../out/design.toml"]);
    assert_eq!(code(&again), 0, "{}", told(&again));
    assert!(snapshot(&folder.path().join("out")) == first);
}

#[test]
fn wrong_input_is_exit_2_with_a_way_out_and_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    };
    let tiny = write("tiny.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    for (shape, word) in [
        (write("empty.obj", b""), "empty.obj"),
        (write("words.stl", b"these are not triangles"), "words.stl"),
        (write("broken.obj", b"v 0 0 0\nv 1 0 nan\nf 1 2 9\n"), "broken.obj"),
        (tiny.clone(), "--height-mm"),
        (folder.path().join("missing.obj"), "missing.obj"),
        (write("shape.3mf", b"PK"), "shape.3mf"),
    ] {
        let output = make(folder.path(), &shape, &[]);
        assert_eq!(code(&output), 2, "{}: {}", shape.display(), told(&output));
        assert!(told(&output).contains(word), "{}: {}", shape.display(), told(&output));
        assert!(!folder.path().join("out").exists());
    }
    for (extra, word) in [
        (&["--stock", "A9"][..], "A9"),
        (&["--height-mm", "-3"], "positive"),
        (&["--machine", "dioed-400"], "diode-400"),
        (&["--layers", "0"], "layers"),
    ] {
        let shape = model("cuboid");
        let mut args = vec!["make", shape.to_str().unwrap(), "--material", "paper-160", "--out", "out"];
        if extra[0] != "--machine" {
            args.extend(["--machine", "diode-400"]);
        }
        args.extend(extra);
        let output = furbelow(folder.path(), &args);
        assert_eq!(code(&output), 2, "{extra:?}: {}", told(&output));
        assert!(told(&output).contains(word), "{extra:?}: {}", told(&output));
    }
}

#[test]
fn a_changed_design_is_not_written_over_and_a_failure_keeps_the_old_files() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(code(&make(folder.path(), &model("cuboid"), &[])), 0);
    let design = folder.path().join("out/design.toml");
    let edited = format!("{}\n# the client wants it soft\n", fs::read_to_string(&design).unwrap());
    fs::write(&design, &edited).unwrap();
    let before = snapshot(&folder.path().join("out"));

    let refused = make(folder.path(), &model("cuboid"), &["--layers", "2"]);
    assert_eq!(code(&refused), 2);
    assert!(told(&refused).contains("--force"), "{}", told(&refused));
    assert!(snapshot(&folder.path().join("out")) == before);

    // More layers than fit: the job cannot be made, and what was there stays.
    let impossible = furbelow(folder.path(), &["make", "out/design.toml", "--layers", "40"]);
    assert_eq!(code(&impossible), 1, "{}", told(&impossible));
    assert!(told(&impossible).contains("At most"), "{}", told(&impossible));
    assert!(snapshot(&folder.path().join("out")) == before);

    let again = furbelow(folder.path(), &["make", "out/design.toml"]);
    assert_eq!(code(&again), 0, "{}", told(&again));
    assert_eq!(fs::read_to_string(&design).unwrap(), edited, "comments stay");
}

#[test]
fn stock_decides_where_a_strip_is_divided() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(code(&make(folder.path(), &model("cuboid"), &["--stock", "A4"])), 0);
    let a4 = report(folder.path());
    let longest = |report: &Value| {
        let lengths = report["pieces"].as_array().unwrap().iter().map(|p| p["length_mm"].as_f64().unwrap());
        lengths.fold(0.0, f64::max)
    };
    assert!(longest(&a4) <= 297.0 - 20.0);
    assert_eq!(code(&make(folder.path(), &model("cuboid"), &["--stock", "400x300@2", "--force"])), 0);
    assert!(longest(&report(folder.path())) > longest(&a4));
    let few = make(folder.path(), &model("teddy"), &["--stock", "A4@1", "--force"]);
    assert_eq!(code(&few), 1, "{}", told(&few));
    assert!(told(&few).contains("A5"), "pieces without a place are named: {}", told(&few));
}

#[test]
fn json_is_one_object_on_stdout() {
    let folder = tempfile::tempdir().unwrap();
    let output = make(folder.path(), &model("cuboid"), &["--json"]);
    let printed: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    assert_eq!(printed["pieces"], report(folder.path())["pieces"]);
    assert!(printed["timing"]["wall_s"].as_f64().unwrap() > 0.0);
}
