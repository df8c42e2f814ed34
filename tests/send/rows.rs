//! Rows that are cut, stopped, and gone on with.

use furbelow::emulator::{BoardSettings, Settings};
use furbelow::geom::V3;
use serde_json::Value;

use super::bench::{Running, Scratch, run};

/// Rows of 80 mm, a millimetre apart, each its own path but for the last ones.
pub fn rows(count: usize) -> String {
    let mut text = String::from(
        "; furbelow\n; sheet: 1/1 A4 297 x 210 mm\n; machine: diode-400\n; material: paper-160\n; crosses: X5.000 Y2.000 and X95.000 Y2.000 mm\nG21G90G94G17G54M5S0\nM4S0\nG0X10Y5\nG1X90S200F6000\n",
    );
    for k in 1..count {
        text += &format!("Y{}\nX{}\n", 5 + k, if k % 2 == 1 { 10 } else { 90 });
    }
    text + "M5S0\nG0X0Y0\nM2\n"
}

/// What so many rows are long, mm.
pub fn whole_mm(count: usize) -> f64 {
    80.0 * count as f64 + (count - 1) as f64
}

pub fn homing() -> BoardSettings {
    let settings = [(22, 1.0), (20, 1.0), (23, 3.0), (24, 600.0), (25, 6000.0)];
    let settings = settings.iter().fold(Settings::default(), |s, (n, v)| s.with(*n, *v));
    let mut hardware = BoardSettings { settings, ..BoardSettings::default() };
    hardware.memory.offsets_mm[0] = V3::new(-398.0, -398.0, 0.0);
    hardware
}

pub fn scratch() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("rows.nc", &rows(30));
    scratch
}

/// `send` of the rows until they are being cut.
pub fn cutting(scratch: &Scratch, port: &str, more: &[&str]) -> Running {
    cutting_beyond(14, scratch, port, more)
}

/// The same, until a line is surely carried out.
pub fn cutting_beyond(executed: u64, scratch: &Scratch, port: &str, more: &[&str]) -> Running {
    let send = ["send", "rows.nc", "--yes", "--json", "-m", "diode-400", "--port", port];
    let mut running = Running::unattended(scratch, &[send.as_slice(), more].concat());
    loop {
        let line = running.wait_for("\"event\":\"status\"");
        let event: Value = serde_json::from_str(&line).expect("an event");
        if event["executed"].as_u64() > Some(executed) {
            return running;
        }
    }
}

pub fn jobs(scratch: &Scratch) -> Vec<Value> {
    let (code, stdout, stderr) = run(scratch, &["jobs", "--json"]);
    assert_eq!(code, 0, "{stderr}");
    let listed: Value = serde_json::from_str(&stdout).expect("JSON");
    listed["jobs"].as_array().expect("a list").clone()
}
