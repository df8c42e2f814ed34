//! The real program nesting outlines and instances: what it prints and writes, judged from that alone.

use furbelow::geom::{P2, contains, segments_cross};
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Stdio};

fn run(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_furbelow"));
    let output = command.current_dir(folder).arg("nest").args(arguments).stdin(Stdio::null()).output().expect("runs");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code().expect("ended by itself"), text(output.stdout), text(output.stderr))
}

fn scratch() -> tempfile::TempDir {
    tempfile::tempdir().expect("a scratch folder")
}

/// A band 20 wide around a bump, as a list of corners.
fn band(length: f64, bump: f64) -> Vec<[f64; 2]> {
    let lower = [[0.0, 0.0], [0.3 * length, 0.0], [0.5 * length, bump], [0.7 * length, 0.0], [length, 0.0]];
    lower.into_iter().chain(lower.into_iter().rev().map(|[x, y]| [x, y + 20.0])).collect()
}

/// The same bands in the 1.x form of the format, and in the 0.x form.
fn instance(folder: &Path, name: &str, old: bool) {
    let item = |(id, (length, bump, demand)): (usize, &(f64, f64, u32))| {
        let shape = json!({"type": "simple_polygon", "data": band(*length, *bump)});
        match old {
            true => json!({"id": 7 + id, "demand": demand, "allowed_orientations": [0.0, 180.0], "shape": shape}),
            false => json!({"id": 7 + id, "demand": demand, "shape": shape,
                "orientation": {"rotation": {"mode": "discrete", "angles": [0.0, 180.0]}}}),
        }
    };
    let bands = [(180.0, 15.0, 3), (140.0, 25.0, 2), (90.0, 5.0, 4)];
    let items: Vec<Value> = bands.iter().enumerate().map(item).collect();
    let text = json!({"name": "bands", "strip_height": 100.0, "items": items}).to_string();
    std::fs::write(folder.join(name), text).expect("written");
}

/// Outlines as the placements say they lie, by container.
fn placed(answer: &Value) -> Vec<(usize, Vec<P2>)> {
    let shapes = [band(180.0, 15.0), band(140.0, 25.0), band(90.0, 5.0)];
    let number = |v: &Value| v.as_f64().expect("a number");
    let one = |p: &Value| {
        let shape = &shapes[p["item"].as_u64().expect("an id") as usize - 7];
        let (sin, cos) = number(&p["rotation_deg"]).to_radians().sin_cos();
        let (dx, dy) = (number(&p["x_mm"]), number(&p["y_mm"]));
        let points = shape.iter().map(|[x, y]| P2::new(x * cos - y * sin + dx, x * sin + y * cos + dy)).collect();
        (p["container"].as_u64().expect("a number") as usize, points)
    };
    answer["placements"].as_array().expect("a list").iter().map(one).collect()
}

fn overlap(a: &[P2], b: &[P2]) -> bool {
    // Pulled in by a hair, so that borders that touch do not count.
    let middle = |p: &[P2]| p.iter().fold(P2::origin(), |m, q| m + q.coords / p.len() as f64);
    let pulled = |p: &[P2]| p.iter().map(|q| q + (middle(p) - q) * 1e-6).collect::<Vec<P2>>();
    let (a, b) = (pulled(a), pulled(b));
    let edge = |p: &[P2], i: usize| (p[i], p[(i + 1) % p.len()]);
    let crosses = |i: usize| {
        let (p, q) = edge(&a, i);
        (0..b.len()).map(|j| edge(&b, j)).any(|(c, d)| segments_cross(p, q, c, d))
    };
    contains(&a, b[0]) || contains(&b, a[0]) || (0..a.len()).any(crosses)
}

#[test]
fn an_instance_is_nested_without_overlaps_and_the_same_way_twice() {
    let folder = scratch();
    instance(folder.path(), "new.json", false);
    instance(folder.path(), "old.json", true);
    let answer = |file: &str| {
        let (code, out, err) = run(folder.path(), &[file, "--json", "--effort", "4000", "--seed", "5"]);
        assert_eq!((code, err.as_str()), (0, ""));
        let mut answer: Value = serde_json::from_str(&out).expect("one JSON object");
        answer.as_object_mut().expect("an object").remove("seconds").expect("seconds are told");
        answer
    };
    let first = answer("new.json");
    assert_eq!(first, answer("new.json"));
    assert_eq!(first, answer("old.json"));
    assert_eq!((&first["sheets"], &first["stopped_early"], &first["unplaced"]), (&json!(1), &json!(false), &json!([])));
    let outlines = placed(&first);
    assert_eq!(outlines.len(), 9);
    let length = first["length_mm"].as_f64().expect("a number");
    let area = 20.0 * (3.0 * 180.0 + 2.0 * 140.0 + 4.0 * 90.0);
    assert!((first["density"].as_f64().expect("a number") - area / (100.0 * length)).abs() < 1e-9);
    // Two of the long bands in a row; boxes around them would need three.
    assert!(length < 360.0 + 1e-6, "{length}");
    for (i, (_, a)) in outlines.iter().enumerate() {
        let inside = |p: &P2| p.x > -1e-6 && p.x < length + 1e-6 && p.y > -1e-6 && p.y < 100.0 + 1e-6;
        assert!(a.iter().all(inside));
        assert!(outlines[..i].iter().all(|(_, b)| !overlap(a, b)));
    }
}

#[test]
fn anyones_outlines_are_placed_on_sheets_and_offcuts_and_drawn() {
    let folder = scratch();
    let svg = |width: u32, height: u32, shapes: &str| {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {width} {height}\">{shapes}</svg>"
        )
    };
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).expect("written");
    write("tag.svg", svg(60, 30, "<rect width=\"60\" height=\"30\"/><circle cx=\"10\" cy=\"10\" r=\"3\"/>"));
    write(
        "two.svg",
        svg(99, 60, "<path d=\"M0 0 H90 V20 H20 V50 H0 Z\"/><rect x=\"40\" y=\"30\" width=\"50\" height=\"20\"/>"),
    );
    // An offcut whose upper left is gone, with a hole.
    write("rest.svg", svg(120, 80, "<path d=\"M40 0 H120 V80 H0 V40 Z\"/><circle cx=\"100\" cy=\"60\" r=\"8\"/>"));
    let arguments =
        ["tag.svg", "two.svg", "--offcut", "rest.svg", "--sheet", "200x150", "--copies", "2", "--effort", "2000"];
    let with = |more: &[&'static str]| [&arguments[..], more].concat();
    let (code, out, err) = run(folder.path(), &with(&["--json", "--out", "nested"]));
    assert_eq!((code, err.as_str()), (0, ""));
    let answer: Value = serde_json::from_str(&out).expect("one JSON object");
    let names: Vec<&str> =
        answer["placements"].as_array().expect("a list").iter().map(|p| p["item"].as_str().expect("a name")).collect();
    for name in ["tag", "two-1", "two-2"] {
        assert_eq!(names.iter().filter(|n| **n == name).count(), 2, "{names:?}");
    }
    let sheets = answer["sheets"].as_u64().expect("a number");
    for k in 1..=sheets {
        let sheet = std::fs::read_to_string(folder.path().join(format!("nested/sheet-0{k}.svg"))).expect("written");
        assert!(sheet.contains("class=\"outline\""));
    }
    // What the program writes for others it can read itself.
    let again = run(folder.path(), &["nested/instance.json", "--json", "--effort", "0"]);
    assert_eq!(again.0, 0, "{}", again.2);
    let solution = std::fs::read_to_string(folder.path().join("nested/solution.json")).expect("written");
    assert!(solution.contains("placed_items"));
    let (code, out, _) = run(folder.path(), &arguments);
    assert_eq!(code, 0);
    assert!(out.contains("rest") || out.contains("200x150"), "{out}");
}

#[test]
fn what_finds_no_place_is_named_and_time_runs_out_without_harm() {
    let folder = scratch();
    instance(folder.path(), "bands.json", false);
    let (code, out, err) = run(folder.path(), &["bands.json", "--sheet", "150x60@2", "--json", "--effort", "500"]);
    assert_eq!(code, 1);
    assert!(err.contains("too large"), "{err}");
    let answer: Value = serde_json::from_str(&out).expect("one JSON object");
    let unplaced = answer["unplaced"].as_array().expect("a list");
    assert!(unplaced.iter().any(|u| u["item"] == 7 && u["reason"].as_str().expect("text").contains("too large")));
    let (code, out, _) = run(folder.path(), &["bands.json", "--time-s", "0", "--json"]);
    let answer: Value = serde_json::from_str(&out).expect("one JSON object");
    assert_eq!((code, &answer["stopped_early"]), (0, &json!(true)));
    assert_eq!(answer["placements"].as_array().expect("a list").len(), 9);
}

#[test]
fn wrong_usage_and_broken_files_say_what_to_do() {
    let folder = scratch();
    instance(folder.path(), "bands.json", false);
    std::fs::write(folder.path().join("broken.json"), "{\"items\": 3}").expect("written");
    let flat = "{\"name\":\"f\",\"strip_height\":9,\"items\":[{\"id\":4,\"demand\":1,\"shape\":{\"type\":\"simple_polygon\",\"data\":[[0,0],[1,0],[2,0]]}}]}";
    std::fs::write(folder.path().join("flat.json"), flat).expect("written");
    std::fs::write(folder.path().join("a.svg"), "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9mm\" height=\"9mm\" viewBox=\"0 0 9 9\"><rect width=\"9\" height=\"9\"/></svg>")
        .expect("written");
    let cases: [(&[&str], &str); 6] = [
        (&["broken.json"], "jagua-rs JSON"),
        (&["flat.json"], "item \"4\" cannot be nested: its outline encloses no area"),
        (&["a.svg"], "--sheet WxH, --roll MM or --offcut FILE"),
        (&["a.svg", "--sheet", "9"], "width x height"),
        (&["a.svg", "bands.json", "--roll", "100"], "give it alone"),
        (&["bands.json", "--spacing-mm=-1"], "spacing is -1 mm"),
    ];
    for (arguments, says) in cases {
        let (code, _, err) = run(folder.path(), arguments);
        assert_eq!(code, 2, "{arguments:?}: {err}");
        assert!(err.contains(says), "{arguments:?}: {err}");
    }
}
