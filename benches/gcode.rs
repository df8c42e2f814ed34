//! Checking long files: `cargo bench --bench gcode -- --json`.
//!
//! A file of 1,000,000 lines (short segments, arcs, changes of power and feed, travels; from a seed) is written to a scratch folder and checked as
//! `furbelow check` does it, one line at a time. `peak_mb` is the most memory the whole process ever held (Linux; 0 elsewhere).

use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::time::Instant;

use furbelow::config::Library;
use furbelow::gcode::Checker;
use furbelow::job::check_settings;
use serde::Serialize;

const LINES: usize = 1_000_000;
const SEED: u64 = 20_210_508;

#[derive(Serialize)]
struct Row {
    name: &'static str,
    lines: usize,
    megabytes: f64,
    seconds: f64,
    peak_mb: f64,
    errors: usize,
    cut_mm: f64,
    time_s: f64,
}

fn main() {
    let json = std::env::args().any(|a| a == "--json");
    let row = check(LINES, SEED);
    if json {
        println!("{}", serde_json::to_string(&row).expect("a row holds nothing JSON cannot"));
    } else {
        println!(
            "{} lines, {:.1} MB: {:.2} s, at most {:.0} MB of memory, {} errors, {:.0} m of cuts in {:.1} h",
            row.lines,
            row.megabytes,
            row.seconds,
            row.peak_mb,
            row.errors,
            row.cut_mm / 1e3,
            row.time_s / 3600.0
        );
    }
}

fn check(lines: usize, seed: u64) -> Row {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let path = folder.path().join("long.nc");
    write(&path, lines, seed);
    let megabytes = path.metadata().expect("just written").len() as f64 / 1e6;
    let machine = Library::built_in().machine("diode-400").expect("built in");
    let settings = check_settings(&machine, None);
    let start = Instant::now();
    let mut checker = Checker::new(&settings);
    let input = BufReader::with_capacity(1 << 16, File::open(&path).expect("just written"));
    checker.read(input, |_| ()).expect("readable");
    let report = checker.finish();
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(report.lines, lines);
    Row {
        name: "check",
        lines,
        megabytes,
        seconds,
        peak_mb: peak_mb(),
        errors: report.errors.len(),
        cut_mm: report.cut_mm,
        time_s: report.time_s,
    }
}

/// A wandering cut on a 400 mm bed: of a hundred lines 80 segments of 0.2 to 3 mm, 10 arcs, 7 changes of power, 3 travels.
fn write(path: &std::path::Path, lines: usize, seed: u64) {
    let mut out = BufWriter::new(File::create(path).expect("a new file"));
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    out.write_all(b"G21G90G94G17G54M5S0\nM4S0\nG0X200Y200\nG1F1200S300\n").expect("written");
    let (mut x, mut y, mut line) = (200.0_f64, 200.0_f64, String::new());
    for _ in 0..lines - 6 {
        let (kind, length, angle) = (random(), 0.2 + 2.8 * random(), std::f64::consts::TAU * random());
        let inside = |v: f64, step: f64| if (20.0..380.0).contains(&(v + step)) { step } else { -step };
        let round = |v: f64| (v * 1000.0).round() / 1000.0;
        let (dx, dy) = (round(inside(x, length * angle.cos())), round(inside(y, length * angle.sin())));
        (x, y) = (round(x + dx), round(y + dy));
        line.clear();
        let written = if kind < 0.80 {
            writeln!(line, "G1X{x}Y{y}")
        } else if kind < 0.90 {
            // A half circle over the chord: its centre is the chord's middle.
            writeln!(line, "G{}X{x}Y{y}I{:.4}J{:.4}", if kind < 0.85 { 2 } else { 3 }, 0.5 * dx, 0.5 * dy)
        } else if kind < 0.97 {
            writeln!(line, "G1X{x}Y{y}S{}", 100 + (random() * 800.0) as u32)
        } else {
            writeln!(line, "G0X{x}Y{y}S0")
        };
        written.expect("a String grows");
        out.write_all(line.as_bytes()).expect("written");
    }
    out.write_all(b"M5S0\nM2\n").expect("written");
}

/// The most memory this process ever held, MB.
fn peak_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kilobytes =
        status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse().ok());
    kilobytes.map_or(0.0, |kb: f64| kb / 1e3)
}
