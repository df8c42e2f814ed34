//! Broken and foreign G-code: `cargo bench --bench fuzz -- --minutes N --seed S`.
//!
//! Mutates a small corpus (our own programs, other programs' dialects, fragments) from a seed and asks of every input: nothing panics, nothing takes
//! longer than [`PATIENCE_S`], times and lengths are finite and not negative, and what was parsed and written reads back as itself. Prints the seed
//! and how many inputs were tried; a failure prints the smallest input that still fails and ends with 1.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use furbelow::config::Library;
use furbelow::gcode::{CheckSettings, Checker, Energy, check, estimate, parse, trace};
use furbelow::geom::{P2, Rect};
use furbelow::job::check_settings;

/// A hundred times what the longest input needs (arcs of tens of thousands of chords on every line).
const PATIENCE_S: f64 = 10.0;

/// Longest input, bytes.
const MAX_BYTES: usize = 2000;

const CORPUS: &[&[u8]] = &[
    include_bytes!("../tests/planner_truth/a-rectangles.nc"),
    include_bytes!("../tests/planner_truth/e-arcs.nc"),
    include_bytes!("../tests/planner_truth/f-slits-toggle.nc"),
    include_bytes!("../tests/gcode_dialects/lightburn-grbl.nc"),
    include_bytes!("../tests/gcode_dialects/lasergrbl-vector.nc"),
    include_bytes!("../tests/gcode_dialects/lasergrbl-raster.nc"),
    include_bytes!("../tests/gcode_dialects/inkscape-laser.nc"),
    include_bytes!("../tests/gcode_dialects/fusion-grbl.nc"),
    include_bytes!("../tests/gcode_dialects/cambam-inch.nc"),
    include_bytes!("../tests/gcode_dialects/vcarve-style.nc"),
    include_bytes!("../tests/gcode_dialects/servo-pen.nc"),
    b"G18G2X10I5F100\nG19G3Y4Z4J2K2\nG17G2X0Y0R50\nG93G1X1F2\nG94\nG38.2Z-5F10\nG80\n",
    b"G10L20P1X0Y0\nG92X5\nG92.1\nG28X1\nG30.1\nG43.1Z2\nG49\nG53G0X1\nG55\nG54\nG91.1G61G40\nM7\nM8\nM9\nM0\nM1\nM30\n",
    b"$H\n$30=255\n%\n(a(b)c) G1 (x) X1 (y) 0 ; end\n/N10 g1 x-.5 y+2.\r\nG4P1\nT1\nM6\n\xff\xfe!~?\n",
];

/// Pieces that mean something, and numbers that hurt.
const WORDS: &[&str] = &[
    "G0",
    "G1",
    "G2",
    "G3",
    "G4P",
    "G17",
    "G18",
    "G19",
    "G20",
    "G21",
    "G28",
    "G38.2",
    "G53",
    "G55",
    "G80",
    "G90",
    "G91",
    "G92",
    "G93",
    "G94",
    "G10L2P1",
    "G43.1Z",
    "M2",
    "M3",
    "M4",
    "M5",
    "M7",
    "M8",
    "M9",
    "M30",
    "X",
    "Y",
    "Z",
    "I",
    "J",
    "K",
    "R",
    "F",
    "S",
    "P",
    "N",
    "\n",
    "(",
    ")",
    ";",
    "/",
    " ",
    "0",
    "-1",
    "1e9",
    "999999999",
    "-999999999",
    "0.0000001",
    "1234567890123",
    ".",
    "-",
    "--",
    "1000",
    "0.001",
    "\u{b5}",
];

struct Random(u64);

impl Random {
    /// xorshift64*.
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() >> 33) as usize % n.max(1)
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let value = |name: &str| {
        let at = arguments.iter().position(|a| a == name)?;
        arguments.get(at + 1)?.parse::<f64>().ok()
    };
    let minutes = value("--minutes").unwrap_or(0.1);
    let seed = value("--seed").map_or(1, |s| s as u64);
    println!("seed {seed}, {minutes} minutes");
    std::panic::set_hook(Box::new(|_| ()));
    let settings = settings();
    let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let end = Instant::now() + Duration::from_secs_f64(60.0 * minutes);
    let (mut executions, mut slowest_s) = (0_u64, 0.0_f64);
    while Instant::now() < end {
        let input = mutated(&mut random);
        let start = Instant::now();
        if let Some(problem) = fault(&input, &settings) {
            let (input, problem) = smallest(input, problem, &settings);
            println!(
                "after {executions} inputs, seed {seed}: {problem}\nsmallest input: {:?}",
                String::from_utf8_lossy(&input)
            );
            std::process::exit(1);
        }
        slowest_s = slowest_s.max(start.elapsed().as_secs_f64());
        executions += 1;
    }
    println!("seed {seed}: {executions} inputs, no fault, the slowest took {slowest_s:.3} s");
}

/// The strictest eyes: a laser with everything to object to, and a slow machine without laser mode.
fn settings() -> [CheckSettings; 2] {
    let machine = Library::built_in().machine("k40").expect("built in");
    let strict = CheckSettings {
        keep_outs: vec![("magnet".into(), Rect { min: P2::new(20.0, 20.0), max: P2::new(40.0, 40.0) })],
        energy: Some(Energy { full_power_w: 40.0, cut_j_per_mm: 0.1 }),
        ..check_settings(&machine, None)
    };
    let mut plain = CheckSettings { laser_mode: false, mist: false, ..strict.clone() };
    plain.limits.planner_blocks = 1;
    plain.limits.rx_bytes = 16;
    plain.limits.bytes_per_s = 100.0;
    [strict, plain]
}

fn mutated(random: &mut Random) -> Vec<u8> {
    let mut input = CORPUS[random.below(CORPUS.len())].to_vec();
    for _ in 0..1 + random.below(8) {
        let at = random.below(input.len() + 1);
        let end = (at + 1 + random.below(40)).min(input.len());
        match random.below(7) {
            0 if at < input.len() => input[at] = random.next() as u8,
            1 if at < end => drop(input.drain(at..end)),
            2 => {
                let copy = input[at.min(end)..end].to_vec();
                let to = random.below(input.len() + 1);
                input.splice(to..to, copy);
            }
            3 => {
                let other = CORPUS[random.below(CORPUS.len())];
                let from = random.below(other.len());
                let to = (from + random.below(200)).min(other.len());
                input.splice(at..at, other[from..to].iter().copied());
            }
            4 => input.truncate(at),
            _ => {
                let word = WORDS[random.below(WORDS.len())];
                input.splice(at..at, word.bytes());
            }
        }
    }
    input.truncate(MAX_BYTES);
    input
}

/// What is wrong with how an input is taken.
fn fault(input: &[u8], settings: &[CheckSettings; 2]) -> Option<String> {
    let start = Instant::now();
    let answer = catch_unwind(AssertUnwindSafe(|| settings.iter().find_map(|s| wrong(input, s))));
    match answer {
        Err(panic) => {
            let words = panic.downcast_ref::<String>().cloned();
            Some(format!(
                "panic: {}",
                words.or(panic.downcast_ref::<&str>().map(|s| (*s).to_owned())).unwrap_or_default()
            ))
        }
        Ok(Some(problem)) => Some(problem),
        Ok(None) if start.elapsed().as_secs_f64() > PATIENCE_S => Some("takes too long".into()),
        Ok(None) => None,
    }
}

fn wrong(input: &[u8], settings: &CheckSettings) -> Option<String> {
    let bad = |v: f64| !(v.is_finite() && v >= 0.0);
    let mut checker = Checker::new(settings);
    checker.read(input, |_| ()).expect("bytes in memory are readable");
    let report = checker.finish();
    for (name, v) in
        [("time", report.time_s), ("lit time", report.laser_on_s), ("cut", report.cut_mm), ("travel", report.travel_mm)]
    {
        if bad(v) {
            return Some(format!("{name} is {v}"));
        }
    }
    let program = parse(&String::from_utf8_lossy(input)).ok()?;
    let written = program.to_string();
    let again = match parse(&written) {
        Ok(again) => again,
        Err(e) => return Some(format!("what was written is not read: {e}")),
    };
    if again.to_string() != written {
        return Some("what was written reads back as something else".into());
    }
    let words = |p: &furbelow::gcode::Program| p.lines.iter().map(|l| l.words.clone()).collect::<Vec<_>>();
    if words(&again) != words(&program) {
        return Some("words are lost in writing".into());
    }
    let moves = trace(&program).ok()?;
    let timing = estimate(&moves, &settings.limits);
    if timing.move_s.iter().any(|s| bad(*s)) || bad(timing.total_s) {
        return Some("a move takes no finite time".into());
    }
    // Both read what was written; only the check refuses lines that are too long for GRBL.
    let report = check(&program, settings);
    let alike = report.errors.iter().any(|e| e.code.starts_with("error:"))
        || (timing.total_s - report.time_s).abs() <= 1e-6 * timing.total_s.max(1.0);
    (!alike).then(|| format!("check says {} s and the planner {} s", report.time_s, timing.total_s))
}

/// Leaves out stretches as long as what remains still fails.
fn smallest(mut input: Vec<u8>, mut problem: String, settings: &[CheckSettings; 2]) -> (Vec<u8>, String) {
    let mut length = input.len() / 2;
    while length > 0 {
        let mut at = 0;
        while at + length <= input.len() {
            let mut shorter = input.clone();
            shorter.drain(at..at + length);
            match fault(&shorter, settings) {
                Some(still) => (input, problem) = (shorter, still),
                None => at += length,
            }
        }
        length /= 2;
    }
    (input, problem)
}
