//! The real program: machines, profiles, bad files, users' folders, pipes and exit codes.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// The program with `folder` as the user's config folder.
fn furbelow(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_furbelow"));
    command.args(arguments).env("FURBELOW_CONFIG_DIR", folder).env_remove("RUST_LOG").stdin(Stdio::null());
    command
}

fn run(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    told(furbelow(folder, arguments).output().expect("runs"))
}

fn told(output: Output) -> (i32, String, String) {
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code().expect("ended by itself"), text(output.stdout), text(output.stderr))
}

fn scratch() -> tempfile::TempDir {
    tempfile::tempdir().expect("a scratch folder")
}

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().expect("inside the folder")).expect("created");
    std::fs::write(&path, text).expect("written");
    path.display().to_string()
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).expect("one JSON object")
}

#[test]
fn lists_name_what_is_built_in_for_people_and_for_scripts() {
    let folder = scratch();
    let (code, out, err) = run(folder.path(), &["machine", "list"]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(out.lines().any(|l| l.starts_with("diode-400") && l.contains("400 x 400") && l.contains("diode laser")));
    assert!(out.lines().any(|l| l.starts_with("k40") && l.contains("40  built in")), "{out}");
    let machines = json(&run(folder.path(), &["machine", "list", "--json"]).1);
    assert_eq!(machines["machines"][0]["name"], "diode-400");
    let listed =
        |name: &str| machines["machines"].as_array().expect("a list").iter().find(|m| m["name"] == name).cloned();
    assert_eq!(listed("k40").expect("built in")["optical_power_w"], 40.0);
    assert!(listed("pen-a3").is_some() && listed("roll-610").is_some() && listed("diode-5w").is_some());
    let (code, out, _) = run(folder.path(), &["profile", "list", "--json"]);
    let profiles = json(&out);
    let names: Vec<_> = profiles["profiles"].as_array().expect("a list").iter().map(|p| p["name"].as_str()).collect();
    let wanted = ["felt-soft-1", "felt-stiff-1", "paper-160", "paper-80", "polyester-0.1"];
    assert_eq!((code, names), (0, wanted.map(Some).to_vec()));
    assert_eq!(profiles["profiles"][4]["allowed"]["diode"], "never");
}

#[test]
fn show_tells_values_with_their_source() {
    let folder = scratch();
    let (code, out, _) = run(folder.path(), &["profile", "show", "polyester-0.1"]);
    assert_eq!(code, 0);
    for words in ["from practice, uncalibrated", "never", "450 nm", "a slot 0.35 mm wide", "13 %", "2400", "40"] {
        assert!(out.contains(words), "{words} is missing in:\n{out}");
    }
    let machine = json(&run(folder.path(), &["machine", "show", "diode-400", "--json"]).1);
    assert_eq!(machine["controller"]["max_rate_mm_per_min"], serde_json::json!([10000.0, 10000.0, 3000.0]));
    assert_eq!(machine["tool"]["class"], "diode");
    assert!(run(folder.path(), &["machine", "show", "k40"]).1.contains("before every job"));
}

#[test]
fn what_show_prints_as_json_obeys_the_schema() {
    let folder = scratch();
    for kind in ["machine", "profile"] {
        let schema = json(&run(folder.path(), &[kind, "schema"]).1);
        let name = if kind == "machine" { "k40" } else { "paper-80" };
        let shown = json(&run(folder.path(), &[kind, "show", name, "--json"]).1);
        let keys = shown.as_object().expect("an object").keys();
        assert!(schema["properties"].as_object().is_some_and(|p| keys.clone().all(|k| p.contains_key(k))), "{kind}");
        let required = schema["then"]["required"].as_array().expect("required keys").iter();
        assert!(
            required.clone().count() > 5
                && required.into_iter().all(|k| shown[k.as_str().unwrap_or("")] != serde_json::Value::Null)
        );
    }
}

#[test]
fn a_good_file_is_ok_and_a_bad_one_tells_everything_with_its_place() {
    let folder = scratch();
    let good = write(folder.path(), "good.toml", "schema = 1\nname = 'good'\ninherits = 'k40'\n");
    assert_eq!(run(folder.path(), &["machine", "check", &good]), (0, "OK: machine good\n".into(), String::new()));
    let text = "schema = 1\nname = 'bad'\ninherits = 'k40'\n[tool]\noptical_powr_w = 35\npower_floor = 1.5\n";
    let bad = write(folder.path(), "bad.toml", text);
    let (code, out, err) = run(folder.path(), &["machine", "check", &bad]);
    assert_eq!((code, out.as_str()), (2, ""));
    assert!(err.starts_with(&format!("furbelow: {bad}:5:1: unknown key `optical_powr_w` in tool")), "{err}");
    assert!(err.contains("did you mean `optical_power_w`?"), "{err}");
    assert!(err.contains(" 5 | optical_powr_w = 35\n   | ^^^^^^^^^^^^^^"), "{err}");
    assert!(err.contains("bad.toml:6:15: `power_floor` is 1.5"), "{err}");
    let (code, _, err) = run(folder.path(), &["profile", "check", &write(folder.path(), "x.toml", "schema = \n")]);
    assert!(code == 2 && err.contains("x.toml:1:10"), "{err}");
}

#[test]
fn stdin_is_checked_for_a_dash() {
    let folder = scratch();
    let mut child = furbelow(folder.path(), &["profile", "check", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("runs");
    let text = b"schema = 1\nname = 'x'\ninherits = 'paper-80'\nspacing_mm = -1\n";
    child.stdin.take().expect("piped").write_all(text).expect("written");
    let (code, _, err) = told(child.wait_with_output().expect("ends"));
    assert!(code == 2 && err.contains("<stdin>:4:14: `spacing_mm` is -1"), "{err}");
}

#[test]
fn users_own_files_are_found_and_a_broken_one_hides_no_other() {
    let folder = scratch();
    let mine =
        "schema = 1\nname = 'mine'\ninherits = 'diode-400'\ntitle = 'The one upstairs'\n[tool]\noptical_power_w = 5\n";
    let path = write(folder.path(), "machines/mine.toml", mine);
    write(folder.path(), "machines/broken.toml", "schema = 1\nname = 3\n");
    let (code, out, _) = run(folder.path(), &["machine", "list"]);
    assert_eq!(code, 0);
    assert!(out.lines().any(|l| l.contains("The one upstairs") && l.contains(&path)), "{out}");
    assert!(out.lines().any(|l| l.starts_with("broken") && l.contains("machine check broken")), "{out}");
    assert!(out.contains("k40"));
    assert!(run(folder.path(), &["machine", "show", "mine"]).1.contains("5 W"));
    assert_eq!(run(folder.path(), &["machine", "check", "broken"]).0, 2);
}

#[test]
fn usage_errors_and_unknown_names_end_with_two_and_a_suggestion() {
    let folder = scratch();
    let (code, out, err) = run(folder.path(), &["machine", "show", "diode-40"]);
    assert_eq!((code, out.as_str()), (2, ""));
    assert!(err.contains("did you mean \"diode-400\"?"), "{err}");
    let (code, _, err) = run(folder.path(), &["machine", "check", "./missing.toml"]);
    assert!(code == 2 && err.starts_with("furbelow: cannot read ./missing.toml: "), "{err}");
    assert_eq!(run(folder.path(), &["machin", "list"]).0, 2);
    assert_eq!(run(folder.path(), &[]).0, 2);
    assert_eq!(run(folder.path(), &["--help"]).0, 0);
}

#[test]
fn completions_are_made_for_every_shell() {
    let folder = scratch();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let (code, out, _) = run(folder.path(), &["completions", shell]);
        assert!(code == 0 && out.contains("furbelow") && out.contains("profile"), "{shell}");
    }
}

#[test]
fn a_reader_that_has_seen_enough_is_no_failure() {
    let folder = scratch();
    for arguments in
        [&["machine", "list"][..], &["profile", "show", "paper-160"], &["completions", "bash"], &["--help"]]
    {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        // Nobody reads, from the first byte on: what `| head -0` comes to.
        drop(reader);
        let output = furbelow(folder.path(), arguments).stdout(writer).stderr(Stdio::piped()).output().expect("runs");
        assert_eq!(told(output), (0, String::new(), String::new()), "{arguments:?}");
    }
}

#[test]
fn diagnostics_come_only_when_asked_for_and_without_colour_in_a_file() {
    let folder = scratch();
    let output =
        furbelow(folder.path(), &["machine", "list"]).env("RUST_LOG", "furbelow=debug").output().expect("runs");
    let (code, out, err) = told(output);
    assert_eq!(code, 0);
    assert!(err.contains("DEBUG") && !err.contains('\u{1b}') && !out.contains("DEBUG"), "{err}");
}
