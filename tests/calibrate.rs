//! Test cards by the real binary: they can be cut, they try what they say, and what is answered ends in the user's profile.

use std::path::Path;
use std::process::{Command, Output, Stdio};

const PAIRS: [(&str, &str); 6] = [
    ("diode-400", "paper-80"),
    ("diode-400", "paper-160"),
    ("diode-400", "felt-stiff-1"),
    ("k40", "paper-160"),
    ("k40", "polyester-0.1"),
    ("roll-610", "paper-160"),
];

fn furbelow(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_furbelow"));
    command.current_dir(folder).env("FURBELOW_CONFIG_DIR", folder.join("config")).args(arguments);
    command
}

fn text(output: &Output) -> (String, String) {
    let read = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("text");
    (read(&output.stdout), read(&output.stderr))
}

fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = furbelow(folder, arguments).output().expect("the binary runs");
    let (out, err) = text(&output);
    assert!(output.status.success(), "{arguments:?}: {out}{err}");
    out
}

fn refused(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let output = furbelow(folder, arguments).output().expect("the binary runs");
    let (_, err) = text(&output);
    (output.status.code().expect("it ends by itself"), err)
}

fn object(text: &str) -> serde_json::Value {
    serde_json::from_str(text).expect("JSON")
}

#[test]
fn the_first_card_takes_less_than_five_minutes_and_every_machine_can_cut_it() {
    let folder = tempfile::tempdir().expect("a folder");
    for (machine, material) in PAIRS {
        let out = format!("{machine}-{material}");
        let arguments = ["calibrate", "start", "-m", machine, "-p", material, "-o", &out, "--json"];
        let told = object(&done(folder.path(), &arguments));
        assert!(told["time_s"].as_f64().expect("a time") < 300.0, "{machine} {material}: {told}");
        let program = told["files"][0].as_str().expect("a name");
        done(folder.path(), &["check", program, "-m", machine]);
        let svg = std::fs::read_to_string(folder.path().join(told["files"][1].as_str().expect("a name"))).expect("svg");
        assert!(svg.contains("width=\"210mm\"") && svg.contains("data-name=\"along\""));
    }
}

/// Feeds and S words under which lines of a program burn.
fn settings(program: &str) -> Vec<(f64, f64)> {
    let (mut feed, mut power, mut found) = (0.0, 0.0, Vec::new());
    for line in program.lines().filter(|line| !line.starts_with(';')) {
        let word = |letter: char| {
            let at = line.find(letter)? + 1;
            let end = line[at..].find(|c: char| !"0123456789.-".contains(c)).map_or(line.len(), |n| at + n);
            line[at..end].parse::<f64>().ok()
        };
        feed = word('F').unwrap_or(feed);
        power = word('S').unwrap_or(power);
        if power > 0.0 && !found.contains(&(feed, power)) {
            found.push((feed, power));
        }
    }
    found
}

#[test]
fn the_power_card_burns_every_pair_of_its_five_feeds_and_powers() {
    let folder = tempfile::tempdir().expect("a folder");
    done(folder.path(), &["calibrate", "power", "-m", "diode-400", "-p", "paper-160"]);
    let program = std::fs::read_to_string(folder.path().join("calibrate/calibrate-power.nc")).expect("a program");
    let burnt = settings(&program);
    for feed in [600.0, 852.0, 1200.0, 1692.0, 2400.0] {
        for power in [250.0, 355.0, 500.0, 705.0, 1000.0] {
            assert!(burnt.contains(&(feed, power)), "F{feed} S{power} in {burnt:?}");
        }
    }
}

#[test]
fn answers_end_in_the_users_profile_and_the_pair_is_calibrated_from_then_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let ask = ["calibrate", "start", "-m", "diode-400", "-p", "paper-160", "--ask"];
    let mut child = furbelow(folder.path(), &ask)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    let answers = b"4\n1.54\n4\n\n36 40\n20\n";
    std::io::Write::write_all(&mut child.stdin.take().expect("a pipe"), answers).expect("it reads");
    let (out, err) = text(&child.wait_with_output().expect("it ends"));
    assert!(out.contains("kerf 0.14 mm") && out.contains("the grain runs along"), "{out}{err}");

    let shown = object(&done(folder.path(), &["profile", "show", "paper-160", "--json"]));
    let rows = shown["process"].as_array().expect("rows");
    let own: Vec<_> = rows.iter().filter(|row| row["measured_on"] == "diode-400").collect();
    assert_eq!(own.len(), 1, "nothing was said of lettering");
    assert_eq!((own[0]["kerf_mm"].as_f64(), own[0]["feed_mm_per_min"].as_f64()), (Some(0.14), Some(960.0)));
    assert!(own[0]["source"].as_str().is_some_and(|s| s.starts_with("measured 20") && s.ends_with("diode-400")));
    assert_eq!(shown["joint"]["laser"]["slit_extra_mm"], 1.1);
    assert!(shown["flexural_rigidity_md_n_mm"].as_f64() > shown["flexural_rigidity_cd_n_mm"].as_f64());
    let written = std::fs::read_to_string(folder.path().join("config/profiles/paper-160.toml")).expect("a profile");
    let built_in = include_str!("../profiles/paper-160.toml");
    for comment in built_in.lines().filter_map(|line| line.split_once('#')).map(|(_, comment)| comment) {
        assert!(written.contains(comment), "{comment}");
    }
    let made = done(folder.path(), &["make", "paper-default", "-m", "diode-400", "-p", "paper-160", "--out", "strip"]);
    assert!(!made.contains("UNCALIBRATED"), "{made}");
}

#[test]
fn a_laser_too_strong_for_the_profile_is_measured_instead_of_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let machine = "schema = 1\nname = \"strong\"\ninherits = \"diode-400\"\n[tool]\noptical_power_w = 40\n";
    std::fs::write(folder.path().join("strong.toml"), machine).expect("written");
    let make = ["make", "paper-default", "-m", "strong.toml", "-p", "paper-160", "--out", "o"];
    let (code, told) = refused(folder.path(), &make);
    assert!(code == 1 && told.contains("calibrate power"), "{told}");
    let power = ["calibrate", "power", "-m", "strong.toml", "-p", "paper-160"];
    done(folder.path(), &power);
    done(folder.path(), &[&power[..], &["--answer", "cell=c3"]].concat());
    done(folder.path(), &make);
}

#[test]
fn what_cannot_be_measured_or_set_is_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let pair = ["-m", "diode-400", "-p", "paper-160"];
    let with = |card: &'static str, more: &[&'static str]| {
        refused(folder.path(), &[&["calibrate", card], &pair[..], more].concat())
    };
    assert_eq!(with("start", &["--answer", "square=9"]).0, 2);
    assert!(with("kerf", &["--answer", "slit=2"]).1.contains("asks for gap"));
    assert_eq!(with("start", &["--answer", "square=0"]).0, 1);
    assert_eq!(with("start", &["--answer", "square"]).0, 2);
    let (code, told) = refused(folder.path(), &["calibrate", "start", "-m", "pen-a3", "-p", "paper-160"]);
    assert!(code == 1 && told.contains("cuts nothing"), "{told}");
    let (code, told) = refused(folder.path(), &["calibrate", "start", "-m", "diode-400", "-p", "polyester-0.1"]);
    assert!(code == 1 && told.contains("450 nm"), "{told}");
    let (code, told) = refused(folder.path(), &["profile", "set", "paper-160", "thicknes_mm=0.2"]);
    assert!(code == 2 && told.contains("did you mean"), "{told}");
    assert_eq!(refused(folder.path(), &["profile", "set", "paper-160", "cut.power=0.2"]).0, 2);
    assert!(!folder.path().join("config").exists(), "a refused change leaves nothing");
    let set = ["profile", "set", "paper-160", "thickness_mm=0.21", "--source", "calliper"];
    done(folder.path(), &set);
    let shown = object(&done(folder.path(), &["profile", "show", "paper-160", "--json"]));
    assert_eq!(shown["thickness_mm"], 0.21);
    assert!(shown["source"].as_str().is_some_and(|s| s.ends_with("thickness_mm calliper")), "{shown}");
}
