//! `furbelow check` on files of many programs: the real binary, its exit codes and its JSON.

use std::f64::consts::{PI, TAU};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn dialects() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/gcode_dialects")
}

/// Exit code, stdout and stderr.
fn check(folder: &Path, job: &str, machine: &str, more: &[&str], stdin: &str) -> (i32, String, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_furbelow"))
        .args(["check", job, "--machine", machine])
        .args(more)
        .env("FURBELOW_CONFIG_DIR", folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("runs");
    // A usage error may close the pipe before it is read.
    let _ = child.stdin.take().expect("piped").write_all(stdin.as_bytes());
    let output = child.wait_with_output().expect("ends");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code().expect("ended by itself"), text(output.stdout), text(output.stderr))
}

fn json(folder: &Path, job: &str, machine: &str, stdin: &str) -> (i32, serde_json::Value) {
    let (code, stdout, stderr) = check(folder, job, machine, &["--json"], stdin);
    (code, serde_json::from_str(&stdout).unwrap_or_else(|e| panic!("{e}: {stdout}{stderr}")))
}

fn codes(findings: &serde_json::Value) -> Vec<&str> {
    findings.as_array().expect("a list").iter().map(|f| f["code"].as_str().expect("a word")).collect()
}

#[test]
fn files_of_other_programs_raise_no_false_alarms() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let pen = folder.path().join("pen.toml");
    let lines = [
        "schema = 1",
        "name = \"pen\"",
        "inherits = \"diode-400\"",
        "[controller]",
        "laser_mode = false",
        "[tool]",
        "class = \"pen\"",
        "servo = { down_s = 90, up_s = 30, dwell_s = 0.2 }",
    ];
    std::fs::write(&pen, lines.join("\n")).expect("written");
    let pen = pen.display().to_string();
    // What is said is true of each: their travels rely on laser mode, their modes or places on what the machine happens to hold.
    let expected: [(&str, &str, &[&str], f64); 8] = [
        ("lightburn-grbl.nc", "diode-400", &["laser-on-travel"], 200.0 + 20.0 * PI),
        ("lasergrbl-vector.nc", "diode-400", &["no-units"], 160.0 + 10.0 * PI),
        ("lasergrbl-raster.nc", "diode-400", &["no-units"], 0.8),
        ("inkscape-laser.nc", "diode-400", &[], 17.8 + TAU + 7.75),
        ("fusion-grbl.nc", "diode-400", &["place-unknown"], 0.2 * PI + 9.8 + 0.2 * PI + 10.2),
        ("cambam-inch.nc", "diode-400", &[], 25.4 * (0.75 + 0.5 + 0.9014)),
        ("vcarve-style.nc", "diode-400", &[], 40.0 + 5.0 * PI + 30.0),
        ("servo-pen.nc", &pen, &[], 80.0),
    ];
    assert_eq!(std::fs::read_dir(dialects()).expect("there").count(), expected.len());
    for (file, machine, warnings, cut_mm) in expected {
        let (code, report) = json(folder.path(), &dialects().join(file).display().to_string(), machine, "");
        assert_eq!((code, codes(&report["errors"])), (0, vec![]), "{file}: {report:#}");
        assert_eq!(codes(&report["warnings"]), warnings, "{file}: {report:#}");
        let ours = report["cut_mm"].as_f64().expect("a number");
        assert!((ours - cut_mm).abs() < 0.02, "{file}: {ours} mm instead of {cut_mm} mm");
        assert!(report["time_s"].as_f64().expect("a number") > 0.2);
    }
}

#[test]
fn faults_end_with_1_and_say_where() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let text = "G21 G90\nM4 S0\nG0 X10 Y10\nG1 X20 S2000 F1200\nG1 X500\nM6\nM5\n";
    let (code, report) = json(folder.path(), "-", "diode-400", text);
    assert_eq!(code, 1);
    let found: Vec<(&str, u64, u64)> = report["errors"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|f| (f["code"].as_str().unwrap(), f["line"].as_u64().unwrap(), f["column"].as_u64().unwrap()))
        .collect();
    assert_eq!(found, [("power-above-max", 4, 1), ("outside-work-area", 5, 1), ("error:20", 6, 1)]);
    assert_eq!(report["bounds_mm"], serde_json::json!([10.0, 10.0, 500.0, 10.0]));
    assert_eq!((report["cut_mm"].as_f64(), report["lines"].as_u64()), (Some(490.0), Some(7)));
    let (code, stdout, stderr) = check(folder.path(), "-", "diode-400", &[], text);
    assert_eq!(code, 1);
    assert!(
        stdout.contains("<stdin>:5:1: error: the move leaves the work area by 100.000 mm on its right side"),
        "{stdout}"
    );
    assert!(stderr.contains("3 errors on diode-400"), "{stderr}");
}

#[test]
fn material_and_usage_are_checked_too() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let hot = "G21G90\nM4S0\nG1X100S1000F300\nM5\n";
    let (code, stdout, _) = check(folder.path(), "-", "diode-400", &["--material", "paper-160"], hot);
    assert!(code == 0 && stdout.contains("scorch"), "{stdout}");
    let faint = "G21G90\nM4S0\nG1X100S120F9000\nM5\n";
    let (code, stdout, _) = check(folder.path(), "-", "k40", &[], faint);
    assert!(code == 0 && stdout.contains("tube strikes"), "{stdout}");
    assert_eq!(check(folder.path(), "-", "nothing", &[], "").0, 2);
    assert_eq!(check(folder.path(), "not-there.nc", "diode-400", &[], "").0, 2);
    assert_eq!(check(folder.path(), "-", "diode-400", &["--material", "polyester-0.1"], hot).0, 1, "never");
    let (code, stdout, _) = check(folder.path(), "-", "diode-400", &[], "");
    assert!(code == 0 && stdout.contains("OK"), "an empty file is no fault: {stdout}");
}
