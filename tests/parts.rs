//! Objects of several parts, as their users make them: the real binary on real designs, judged by the files it writes.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models")
}

fn make(folder: &Path, design: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_furbelow"))
        .args(["make", design.to_str().expect("plain path"), "--out", "out"])
        .current_dir(folder)
        .env("FURBELOW_CONFIG_DIR", folder.join("config"))
        .output()
        .expect("the program starts")
}

/// A design of the cuboid (100 x 100 x 60 mm) with `body` below its head.
fn cuboid(folder: &Path, body: &str) -> PathBuf {
    let mesh = models().join("cuboid.obj");
    let head = format!("schema = 1\nmachine = \"diode-400\"\nmaterial = \"paper-160\"\n\n[mesh]\nfile = {mesh:?}\n\n");
    let path = folder.join("design.toml");
    fs::write(&path, head + body).unwrap();
    path
}

const HALVES: &str = "[[split]]\norigin_mm = [0, 50, 0]\nnormal = [0, 1, 0]\ninto = [\"A\", \"B\"]\n\n[[part]]\nname = \"A\"\n\n[[part]]\nname = \"B\"\n\n";

fn json(folder: &Path, name: &str) -> Value {
    serde_json::from_slice(&fs::read(folder.join("out").join(name)).expect(name)).expect("JSON")
}

/// Weight of every part's strip and the sum of the forces on it, N, by name.
fn forces(folder: &Path) -> BTreeMap<String, (f64, f64)> {
    let report = json(folder, "report.json");
    let ruffle = json(folder, "ruffle.json");
    let parts = report["parts"].as_array().unwrap().iter().zip(ruffle["parts"].as_array().unwrap());
    parts
        .map(|(reported, part)| {
            assert_eq!(reported["name"], part["name"]);
            assert_eq!(part["equilibrium"]["outcome"], "converged", "{}", part["name"]);
            assert_eq!(part["equilibrium"]["self_intersections"], 0, "{}", part["name"]);
            let loads = part["loads_n"].as_array().unwrap();
            let borne: f64 = loads.iter().map(|l| -l[2].as_f64().unwrap()).sum();
            assert!(loads.iter().all(|l| l[1] == 0.0 && l[0].as_u64().unwrap() < 100_000));
            let weight = reported["strip_mass_g"].as_f64().unwrap() * 9.80665e-3;
            (part["name"].as_str().unwrap().to_owned(), (weight, borne))
        })
        .collect()
}

/// Every file below a folder with its bytes, report.json without its timing.
fn snapshot(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for path in fs::read_dir(next).expect("a folder").flatten().map(|entry| entry.path()) {
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
            files.insert(path.strip_prefix(folder).expect("inside").to_path_buf(), bytes);
        }
    }
    files
}

#[test]
fn the_teddy_in_six_parts_carries_its_forces_and_makes_all_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let output = make(folder.path(), &models().join("teddy-six.toml"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let forces = forces(folder.path());
    let (weight, borne) = (|name: &str| forces[name].0, |name: &str| forces[name].1);
    let above = weight("H") + weight("AL") + weight("AR");
    assert!((borne("B") - above).abs() < 5e-4, "{} for {above} N", borne("B"));
    let legs = borne("LL") + borne("LR");
    assert!((legs - above - weight("B")).abs() < 5e-4, "{legs}");
    assert!((borne("LL") / legs - 0.5).abs() < 0.05, "the body stands in the middle of its legs");
    assert_eq!((borne("H"), borne("AL"), borne("AR")), (0.0, 0.0, 0.0));

    let report = json(folder.path(), "report.json");
    let pieces: Vec<&str> = report["pieces"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    let mut tied: Vec<[String; 2]> = Vec::new();
    for connector in report["connectors"].as_array().unwrap() {
        let [from, to, piece] = ["from", "to", "piece"].map(|k| connector[k].as_str().unwrap());
        assert!(pieces.contains(&piece));
        let drawing = fs::read_to_string(folder.path().join(format!("out/strips/{piece}.svg"))).unwrap();
        for joint in [from, to] {
            assert!(drawing.contains(&format!("class=\"slit\" data-joint=\"{joint}\"")), "{piece}: {joint}");
        }
        let part = |joint: &str| joint.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
        tied.push([part(from), part(to)]);
    }
    for other in ["H", "AL", "AR", "LL", "LR"] {
        assert!(tied.contains(&["B".into(), other.into()]), "B and {other}: {tied:?}");
    }
    let sheets = fs::read(folder.path().join("out/assembly.pdf")).unwrap();
    let sheets = String::from_utf8_lossy(&sheets);
    let at = |words: &str| sheets.find(words).unwrap_or_else(|| panic!("no {words} in the assembly sheets"));
    assert!(at("(Connectors)") < at("(step 1 of "), "connectors are shown before the first step asks for one");
    for leg in ["LL-base", "LR-base"] {
        assert!(pieces.contains(&leg), "{leg}");
    }
    assert!(!pieces.contains(&"B-base"), "what stands on legs needs no card");
    let files = snapshot(&folder.path().join("out"));
    for part in ["B", "H", "AL", "AR", "LL", "LR"] {
        assert!(files.contains_key(&PathBuf::from(format!("parts/{part}.svg"))));
    }
    assert!(make(folder.path(), &folder.path().join("out/design.toml")).status.success());
    let again = snapshot(&folder.path().join("out"));
    assert!(files.keys().eq(again.keys()));
    for (name, bytes) in &files {
        assert!(again[name] == *bytes, "{} differs", name.display());
    }
}

#[test]
fn a_split_makes_two_parts_the_upper_one_resting_on_the_lower() {
    let folder = tempfile::tempdir().unwrap();
    let by_hand = format!("{HALVES}[[connector]]\nfrom = \"B1\"\nto = \"A2\"\n");
    let output = make(folder.path(), &cuboid(folder.path(), &by_hand));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let forces = forces(folder.path());
    assert!((forces["A"].1 - forces["B"].0).abs() < 5e-4 && forces["B"].1 == 0.0, "{forces:?}");
    let ruffle = json(folder.path(), "ruffle.json");
    let lowest = |part: usize| {
        let points = ruffle["parts"][part]["outline"][0].as_array().unwrap();
        points.iter().map(|p| p[1].as_f64().unwrap()).fold(f64::INFINITY, f64::min)
    };
    assert!(lowest(0).abs() < 1e-6 && (lowest(1) - 50.0).abs() < 1e-6, "parts keep their height in the object");
    let connectors = json(folder.path(), "report.json")["connectors"].clone();
    assert_eq!(connectors, serde_json::json!([{"from": "B1", "to": "A2", "piece": "B1-A2"}]));
}

#[test]
fn designs_that_cannot_be_taken_apart_or_tied_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for (body, code, words) in [
        (HALVES.replace("50", "150"), 1, "split 1 passes the shape by"),
        (format!("{HALVES}[[connector]]\nfrom = \"A1\"\nto = \"B99\"\n"), 1, "joint B99, but part B has joints B1 to"),
        ("[[part]]\nname = \"A\"\nbodies = [4]\n".into(), 1, "part A: body 4"),
        (HALVES.replacen("into", "part = \"Q\"\ninto", 1), 2, "split 1: part 'Q' is neither"),
    ] {
        let output = make(folder.path(), &cuboid(folder.path(), &body));
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{told}");
        assert!(told.contains(words), "{told}");
        assert!(!folder.path().join("out/report.json").exists());
    }
}
