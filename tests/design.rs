//! `furbelow design ...` as its users run it: the real binary on files, judged by what it writes and tells.

use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A folder with design files in it, and the program run there.
struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Desk {
        Desk(tempfile::tempdir().unwrap())
    }

    /// A desk with `design.toml` on it.
    fn with(text: &str) -> Desk {
        let desk = Desk::new();
        fs::write(desk.path("design.toml"), text).unwrap();
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.text(name)).unwrap()
    }

    fn command(&self, args: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_furbelow"));
        command.args(args.split(' ')).current_dir(self.0.path()).env("FURBELOW_CONFIG_DIR", self.path("config"));
        command
    }

    /// Exit code, stdout, stderr.
    fn run(&self, args: &str) -> (i32, String, String) {
        told(self.command(args).output().unwrap())
    }

    /// Stdout of a run that goes well.
    fn done(&self, args: &str) -> String {
        let (code, out, err) = self.run(args);
        assert_eq!(code, 0, "{args}: {err}");
        out
    }

    fn show(&self, file: &str) -> Value {
        serde_json::from_str(&self.done(&format!("design show {file} --json"))).unwrap()
    }
}

fn told(output: Output) -> (i32, String, String) {
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

const HEAD: &str = "# mine\nschema = 1\nmachine = \"diode-400\"\nmaterial = \"paper-160\" # the thick one\n\n";

/// A stack with lengths of its own: nothing is searched, so it is quick.
fn stack() -> String {
    format!(
        "{HEAD}[[part]]\nname = \"A\" # the only one\nstack = {{ layers = 2, inner_mm = 70, outer_mm = 60 }}\nwidth_mm = 40\n"
    )
}

#[test]
fn a_stack_is_densified_softened_again_and_every_step_can_be_undone() {
    let desk = Desk::with(&stack());
    let mut texts = vec![desk.text("design.toml")];
    let count = |value: &Value| value["parts"][0]["sections"].as_array().unwrap().len();
    assert_eq!(count(&desk.show("design.toml")), 9);
    for (command, sections) in [
        ("densify design.toml A 1 7", 21),
        ("stiffer design.toml A A1-A6", 26),
        ("softer design.toml A 2 3", 21),
        ("length design.toml A 0 x1.05", 21),
        ("layers design.toml A +1", 25),
        ("move-point design.toml A A1 2 0", 25),
    ] {
        let out = desk.done(&format!("design {command}"));
        assert!(out.contains("is now edit") && out.contains("strip"), "{out}");
        texts.push(desk.text("design.toml"));
        assert!(texts[texts.len() - 1].starts_with(&texts[0]), "comments stay: {}", texts[texts.len() - 1]);
        assert_eq!(count(&desk.show("design.toml")), sections, "{command}");
    }
    while texts.len() > 1 {
        texts.pop();
        assert!(desk.done("design undo design.toml").contains("took back"));
        assert_eq!(desk.text("design.toml"), texts[texts.len() - 1]);
    }
    let (code, _, err) = desk.run("design undo design.toml");
    assert!(code == 1 && err.contains("no edit to take back"), "{err}");
}

#[test]
fn an_edit_that_does_not_apply_leaves_the_file_as_it_was_and_says_why() {
    let desk = Desk::with(&stack());
    for (command, words) in [
        ("densify design.toml A 99", "there is no section 99; it has 0 to 8"),
        ("densify design.toml Q 1", "parts are A"),
        ("densify design.toml A A1-A9", "no joint 'A9'"),
        ("densify design.toml A 1 --level 4", "densify A 1, 4 levels cannot be done, and nothing was changed"),
        ("densify design.toml A --box 500 500 600 600", "no loops lie"),
        ("undensify design.toml A 1", "was not made by densifying"),
        ("move-point design.toml A 2 -300 0", "joint 2 cannot go to u -300.0, v 0.0 mm"),
        ("layers design.toml A -2", "at least one"),
    ] {
        let (code, _, err) = desk.run(&format!("design {command}"));
        assert!(code == 1 && err.contains(words), "{command}: {code} {err}");
        assert_eq!(desk.text("design.toml"), stack(), "{command}");
    }
    for command in ["plane design.toml A --offset 3", "length design.toml A 1 long", "layers design.toml A many"] {
        let (code, _, err) = desk.run(&format!("design {command}"));
        assert_eq!(code, 2, "{command}: {err}");
        assert_eq!(desk.text("design.toml"), stack());
    }
    assert!(desk.done("design densify design.toml A 1 --dry-run").contains("would be"));
    assert_eq!(desk.text("design.toml"), stack());
}

#[test]
fn an_edit_that_applies_no_more_is_named_with_its_line() {
    let edit = "\n[[edit]]\ndo = \"densify\"\npart = \"A\"\nsections = [7]\n";
    let desk = Desk::with(&format!("{}{edit}", stack()));
    desk.done("make design.toml --out good");
    fs::write(desk.path("design.toml"), desk.text("design.toml").replace("layers = 2", "layers = 1")).unwrap();
    let line = 1 + desk.text("design.toml").lines().position(|l| l == "[[edit]]").unwrap();
    let (code, _, err) = desk.run("make design.toml --out bad");
    assert_eq!(code, 1, "{err}");
    assert!(
        err.contains(&format!("design.toml:{line}: edit 1 (densify A 7) does not apply: there is no section 7")),
        "{err}"
    );
    assert!(err.contains("undo") && !desk.path("bad").exists());
}

#[test]
fn an_outline_keeps_its_layers_with_the_first_edit_and_gives_the_same_bytes_each_time() {
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"90mm\" height=\"60mm\" viewBox=\"0 0 90 60\"><path d=\"M0 0H90V60H0Z\"/></svg>";
    let text = format!(
        "{HEAD}[[part]]\nname = \"seat\"\noutline = \"seat.svg\"\nwidth_mm = 40\nlayers = 2\nfoot = \"pinned\"\n"
    );
    let desk = Desk::with(&text.replace("layers = 2\n", ""));
    fs::write(desk.path("seat.svg"), svg).unwrap();
    let plain = desk.show("design.toml");
    let layers = plain["parts"][0]["layers"].as_u64().unwrap();
    desk.done("design densify design.toml seat --box 45 0 100 60 --picture seat.svg.png");
    assert!(desk.text("design.toml").contains(&format!("on = {{ layers = {layers}, stack = \"vertical\" }}")));
    assert!(fs::read(desk.path("seat.svg.png")).unwrap().starts_with(b"\x89PNG"));
    let dense = desk.show("design.toml");
    // What the box held is what stands on the right.
    let sections = dense["parts"][0]["sections"].as_array().unwrap();
    let tinted: Vec<f64> =
        sections.iter().filter(|s| s["level"] == 1).map(|s| s["middle_mm"][0].as_f64().unwrap()).collect();
    assert!(tinted.len() >= 5 && tinted.iter().all(|u| *u > 30.0), "{tinted:?}");
    for out in ["one", "two"] {
        desk.done(&format!("make design.toml --out {out}"));
    }
    for file in ["ruffle.json", "design.toml", "parts/seat.svg", "sheets/sheet-01.nc"] {
        assert_eq!(desk.text(&format!("one/{file}")), desk.text(&format!("two/{file}")), "{file}");
    }
    assert_eq!(desk.json("one/report.json")["parts"][0]["sections"], sections.len());
    assert!(desk.text("one/parts/seat.svg").contains("#f2a460"), "the band of sections densified once");
    // The design that was written gives the same again.
    desk.done("make one/design.toml --out again");
    assert_eq!(desk.text("again/ruffle.json"), desk.text("one/ruffle.json"));
}

#[test]
fn the_papers_strips_are_built_in_and_as_long_as_its_table_says() {
    let desk = Desk::new();
    // The table's lengths (486, 749, 797 mm) and masses, with 9 mm of end tab at both ends and 80 mm wide.
    for (name, length_mm, mass_g) in
        [("paper-default", 486.0, 6.0), ("paper-wide", 749.0, 10.0), ("paper-dense", 797.0, 10.0)]
    {
        let out = desk.done(&format!("make {name} -m diode-400 -p paper-160"));
        assert!(out.contains(&format!("out/{name}")), "{out}");
        let report = desk.json(&format!("out/{name}/report.json"));
        let length = report["parts"][0]["strip_length_mm"].as_f64().unwrap() + 18.0;
        assert!((length - length_mm).abs() <= 2.0, "{name}: {length}");
        let mass = length * 80.0 * 160e-6;
        assert!((mass - mass_g).abs() <= 0.5, "{name}: {mass}");
        assert_eq!(report["parts"][0]["outcome"], "converged");
        desk.done(&format!("make out/{name}/design.toml --out again"));
        assert_eq!(desk.text("again/ruffle.json"), desk.text(&format!("out/{name}/ruffle.json")));
        fs::remove_dir_all(desk.path("again")).unwrap();
    }
    let (code, _, err) = desk.run("make paper-default -m diode-400");
    assert!(code == 2 && err.contains("--material"), "{err}");
}

#[test]
fn designs_come_on_stdin_and_changed_ones_leave_on_stdout() {
    let desk = Desk::new();
    let piped = |args: &str| {
        let mut command = desk.command(args);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        child.stdin.take().unwrap().write_all(stack().as_bytes()).unwrap();
        told(child.wait_with_output().unwrap())
    };
    let (code, text, err) = piped("design densify - A 1");
    assert_eq!(code, 0, "{err}");
    assert_eq!(text, stack() + "\n[[edit]]\ndo = \"densify\"\npart = \"A\"\nsections = [1]\n");
    let (code, _, err) = piped("make - --out out");
    assert_eq!(code, 0, "{err}");
    assert_eq!(desk.json("out/report.json")["parts"][0]["sections"], 9);
}

#[test]
fn a_new_design_is_shown_before_it_is_changed_and_not_overwritten() {
    let desk = Desk::new();
    let cuboid = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/cuboid.obj");
    fs::copy(cuboid, desk.path("box.obj")).unwrap();
    let out = desk.done("design new box.obj -m diode-400 -p paper-160 --height-mm 60 --foot pinned");
    assert!(out.contains("wrote design.toml") && out.contains("PART"), "{out}");
    let text = desk.text("design.toml");
    let (code, _, err) = desk.run("design new box.obj -m diode-400 -p paper-160");
    assert!(code == 2 && err.contains("--force") && desk.text("design.toml") == text, "{err}");
    desk.done("design plane design.toml A --offset 4");
    let moved = desk.show("design.toml");
    let planes = |value: &Value| value["parts"][0]["plane"]["origin_mm"].clone();
    desk.done("design undo design.toml");
    assert_eq!(desk.text("design.toml"), text);
    assert_ne!(planes(&moved), planes(&desk.show("design.toml")));
}

#[test]
fn a_part_is_split_by_a_command_and_made_whole_again() {
    let desk = Desk::new();
    let cuboid = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/cuboid.obj");
    fs::copy(cuboid, desk.path("box.obj")).unwrap();
    desk.done("design new box.obj -m diode-400 -p paper-160 --height-mm 90 --foot pinned");
    let whole = desk.text("design.toml");
    let out = desk.done("design split design.toml A --above 50");
    assert!(out.contains("split A through") && out.contains("PART B"), "{out}");
    assert_eq!(desk.text("design.toml").matches("[[edit]]").count(), 1);
    desk.done("make design.toml --out out");
    let report = desk.json("out/report.json");
    assert_eq!(report["parts"].as_array().unwrap().len(), 2);
    assert!(!report["connectors"].as_array().unwrap().is_empty());
    let lower = &desk.json("out/ruffle.json")["parts"][0];
    assert!(!lower["loads_n"].as_array().unwrap().is_empty(), "the lower part bears the upper one");
    let (code, _, err) = desk.run("design split design.toml A --origin 0 10 0");
    assert!(code == 2 && err.contains("--normal"), "{err}");
    assert!(desk.done("design undo design.toml").contains("took back split A"));
    assert_eq!(desk.text("design.toml"), whole);
}
