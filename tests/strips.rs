//! What `make` says and writes about strips: lengths, labels, joints, for every material and tool.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn furbelow(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_furbelow"))
        .args(args)
        .current_dir(folder)
        .env("FURBELOW_CONFIG_DIR", folder.join("config"))
        .output()
        .expect("the program starts")
}

fn model(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/models/{name}.obj")).display().to_string()
}

fn make(folder: &Path, shape: &str, machine: &str, material: &str, more: &[&str]) -> Value {
    let mut args = vec!["make", shape, "-m", machine, "-p", material, "--out", "out"];
    args.extend(more);
    let output = furbelow(folder, &args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    report(folder)
}

fn report(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("out/report.json")).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn codes(report: &Value) -> Vec<&str> {
    report["warnings"].as_array().unwrap().iter().map(|w| w["code"].as_str().unwrap()).collect()
}

/// Paths of a class in all strips, without those that hold the kerf.
fn drawn(folder: &Path, class: &str) -> Vec<String> {
    let mut found = Vec::new();
    for file in fs::read_dir(folder.join("out/strips")).unwrap().map(|f| f.unwrap().path()) {
        if file.extension().is_some_and(|e| e == "svg") && !file.to_str().unwrap().contains("-kerf") {
            let text = fs::read_to_string(file).unwrap();
            let class = format!("class=\"{class}\"");
            found.extend(text.lines().filter(|l| l.contains(&class)).map(str::to_owned));
        }
    }
    found
}

/// Width of the page of an SVG, mm.
fn page_mm(file: PathBuf) -> f64 {
    let text = fs::read_to_string(file).unwrap();
    let svg = roxmltree::Document::parse(&text).unwrap();
    svg.root_element().attribute("width").unwrap().trim_end_matches("mm").parse().unwrap()
}

#[test]
fn pieces_add_up_and_every_label_has_its_place() {
    for name in ["cuboid", "lampshade"] {
        let folder = tempfile::tempdir().unwrap();
        let report = make(folder.path(), &model(name), "diode-400", "paper-160", &["--stock", "A4"]);
        assert_eq!(report["totals"]["label_collisions"], 0, "{name}");
        assert!(!codes(&report).contains(&"labels-left-out"), "{name}: {}", report["warnings"]);
        let pieces = report["pieces"].as_array().unwrap();
        let sum: f64 = pieces.iter().map(|p| number(&p["length_mm"])).sum();
        let strip = number(&report["parts"][0]["strip_length_mm"]) + 18.0;
        let splices = (pieces.len() - 1) as f64;
        // Splices overlap by 14 mm at joints and by 20 mm in laps.
        let overlap = sum - strip;
        let laps = ((overlap - 14.0 * splices) / 6.0).round();
        assert!(
            (overlap - 14.0 * splices - 6.0 * laps).abs() < 0.01 && laps >= 0.0,
            "{name}: {overlap} over {splices}"
        );
        assert!(pieces.iter().all(|p| number(&p["length_mm"]) <= 277.0), "{name}");
    }
}

/// A strip of two metres, as its design says without a mesh.
const TWO_METRES: &str = r#"schema = 1
machine = "diode-400"
material = "paper-160"
stock = ["400x400"]

[[part]]
name = "A"
stack = { layers = 8, inner_mm = 66, outer_mm = 55 }
width_mm = 60
foot = "pinned"
"#;

#[test]
fn a_strip_of_two_metres_is_divided_for_a_sheet_of_400_mm_and_every_piece_is_placed_on_one() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("two.toml"), TWO_METRES).unwrap();
    let output = furbelow(folder.path(), &["make", "two.toml", "--out", "out"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report = report(folder.path());
    assert!(number(&report["parts"][0]["strip_length_mm"]) > 2000.0);
    let pieces = report["pieces"].as_array().unwrap();
    assert!(pieces.len() >= 6);
    // 400 mm less a margin of 6 on both sides.
    assert!(pieces.iter().all(|p| number(&p["length_mm"]) <= 388.0 && p["sheet"].as_u64().is_some_and(|s| s > 0)));
    for sheet in 1..=report["sheets"].as_array().unwrap().len() {
        let text = fs::read_to_string(folder.path().join(format!("out/sheets/sheet-{sheet:02}.svg"))).unwrap();
        let svg = roxmltree::Document::parse(&text).unwrap();
        let group = |n: &roxmltree::Node| n.attribute("class") == Some("piece");
        let mut named: Vec<&str> = svg.descendants().filter(group).filter_map(|n| n.attribute("data-name")).collect();
        named.sort_unstable();
        named.dedup();
        let own = pieces.iter().filter(|p| p["sheet"].as_u64() == Some(sheet as u64)).count();
        assert_eq!(named.len(), own, "sheet {sheet}");
    }
}

#[test]
fn the_report_tells_play_and_hold_at_their_worst() {
    let folder = tempfile::tempdir().unwrap();
    let totals = make(folder.path(), &model("cuboid"), "diode-400", "paper-160", &[])["totals"].clone();
    // Slit 8.8 in a neck of 8, kerf 0.05 off on both; drops end the slit, so that it does not grow by the kerf.
    assert!((number(&totals["joint_play_mm"]) - 0.9).abs() < 1e-6);
    assert!((number(&totals["joint_retention_mm"]) - 1.05).abs() < 1e-6);
    assert!((number(&totals["joint_slack_mm"]) - (1.6 - 0.38 * 0.9)).abs() < 1e-6);
}

#[test]
fn film_is_labelled_by_dashes_cut_through_and_its_slots_end_in_drops() {
    let folder = tempfile::tempdir().unwrap();
    let report = make(folder.path(), &model("cuboid"), "k40", "polyester-0.1", &[]);
    assert_eq!(report["totals"]["label_collisions"], 0);
    assert!((number(&report["totals"]["joint_retention_mm"]) - 0.6).abs() < 1e-6);
    assert!(!codes(&report).contains(&"no-labels"));
    assert!(drawn(folder.path(), "label").is_empty() && drawn(folder.path(), "mark").is_empty());
    let slits = drawn(folder.path(), "slit");
    assert!(!slits.is_empty() && slits.iter().all(|s| s.contains(" A0.5 0.5 ") && s.contains(" Z\"")), "{slits:?}");
    let holes = drawn(folder.path(), "hole");
    assert!(holes.len() > 20 * slits.len() && holes.iter().all(|h| h.contains("stroke=\"#0000FF\"")));
}

#[test]
fn felt_is_labelled_by_notches_and_sewn() {
    let folder = tempfile::tempdir().unwrap();
    let report = make(folder.path(), &model("teddy"), "diode-400", "felt-stiff-1", &["--height-mm", "220"]);
    assert!(drawn(folder.path(), "label").is_empty());
    assert!(codes(&report).contains(&"no-labels"));
    let outline = &drawn(folder.path(), "outline")[0];
    assert!(outline.matches('L').count() > 10, "{outline}");
    assert!(report["pieces"].as_array().unwrap().len() > 1);
    assert!(drawn(folder.path(), "hole").iter().any(|h| h.contains(" A0.75 0.75 ")), "holes for thread");
}

#[test]
fn a_design_decides_on_joints_splices_and_labels() {
    let folder = tempfile::tempdir().unwrap();
    make(folder.path(), &model("cuboid"), "diode-400", "paper-160", &["--stock", "A4"]);
    let file = folder.path().join("out/design.toml");
    let design = fs::read_to_string(&file).unwrap();
    let remade = |making: &str| {
        fs::write(&file, design.replacen("[mesh]", &format!("[making]\n{making}\n\n[mesh]"), 1)).unwrap();
        let output = furbelow(folder.path(), &["make", "out/design.toml"]);
        assert!(output.status.success(), "{making}: {}", String::from_utf8_lossy(&output.stderr));
        report(folder.path())
    };
    let held = remade("joint = \"holes\"\nsplice = \"dovetail-tape\"");
    assert!(drawn(folder.path(), "flap").is_empty() && !drawn(folder.path(), "hole").is_empty());
    assert!(held["warnings"].to_string().contains("dovetails"));
    let penned = remade("label = \"pen\"");
    assert!(!drawn(folder.path(), "label").is_empty());
    assert!(penned["sheets"].as_array().unwrap().iter().all(|s| s["engrave_mm"] == 0.0), "{penned}");
    let clean = remade("visible_face = \"clean\"");
    assert_eq!(clean["totals"]["label_collisions"], 0);
    fs::write(&file, design.replacen("[mesh]", "[making]\nsplice = \"glue\"\n\n[mesh]", 1)).unwrap();
    let refused = furbelow(folder.path(), &["make", "out/design.toml"]);
    let told = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && told.contains("'glue'; did you mean 'lap'"), "{told}");
}

#[test]
fn drawings_with_the_kerf_in_them_are_larger_by_it_and_say_no_kerf_side() {
    let folder = tempfile::tempdir().unwrap();
    let report = make(folder.path(), &model("cuboid"), "diode-400", "paper-160", &["--svg-kerf"]);
    let name = report["pieces"][0]["name"].as_str().unwrap();
    let file = |ending: &str| folder.path().join(format!("out/strips/{name}{ending}.svg"));
    assert!((page_mm(file("-kerf")) - page_mm(file("")) - 0.15).abs() < 1e-3);
    let text = fs::read_to_string(file("-kerf")).unwrap();
    assert!(text.contains("class=\"outline\" data-kerf=\"on\""));
    assert!(folder.path().join("out/sheets/sheet-01-kerf.svg").exists());
}
