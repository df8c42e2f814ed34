//! Jobs run as long as they did on GRBL; tests/planner_truth/truth.json says how that was measured.

use super::bench::Bench;

fn file(name: &str) -> String {
    std::fs::read_to_string(format!("{}/tests/planner_truth/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// From the first motion to the last, and how long the beam was lit, s.
fn run(job: &str) -> (f64, f64) {
    let text = file(job);
    let lines: Vec<&str> = text.lines().filter(|l| !l.is_empty() && !l.starts_with(';')).collect();
    let mut bench = Bench::ready(&[]);
    let answers = bench.stream(&lines);
    assert!(answers.iter().all(|a| a == "ok"), "{job}: {answers:?}");
    bench.settle();
    assert_eq!(bench.board.bytes_lost(), 0);
    let trace = bench.board.trace();
    let moving: Vec<_> = trace.iter().filter(|s| s.length_mm() > 0.0).collect();
    let lit_s = trace.iter().filter(|s| s.is_lit()).map(|s| s.end_s - s.start_s).sum();
    (moving[moving.len() - 1].end_s - moving[0].start_s, lit_s)
}

#[test]
fn measured_jobs_take_as_long_as_they_did_within_one_percent() {
    let truth: serde_json::Value = serde_json::from_str(&file("truth.json")).unwrap();
    let mut table = String::new();
    let mut good = true;
    for job in truth["jobs"].as_array().unwrap() {
        let name = job["job"].as_str().unwrap();
        let (motion_s, lit_s) = run(name);
        let error = |ours: f64, key: &str| 100.0 * (ours / job[key].as_f64().unwrap() - 1.0);
        let errors = [error(motion_s, "motion_s"), error(lit_s, "laser_on_s")];
        table += &format!("{name}: motion {:+.3} %, lit {:+.3} %\n", errors[0], errors[1]);
        // The light of 60 M3 cuts ends 15 ms after each has stopped, and the emulator lets no motion begin before it is dark.
        let allowed = if name.starts_with('f') { 1.0 } else { 0.3 };
        good &= errors.iter().all(|e| e.abs() < allowed);
    }
    println!("{table}");
    assert!(good, "{table}");
}

#[test]
fn short_segments_hold_what_grbl_held() {
    let mut table = String::new();
    let mut good = true;
    for (segment_mm, feed, reached) in
        [(0.2, 3000.0, 2970.0), (0.2, 6000.0, 3210.0), (0.5, 6000.0, 5279.0), (0.3, 6000.0, 4095.0)]
    {
        let at = |k: f64| (50.0 * (segment_mm * k / 50.0_f64).cos(), 50.0 * (segment_mm * k / 50.0_f64).sin());
        let mut lines = vec!["M4S500".to_owned(), "G0X50Y0".into(), format!("G1F{feed}")];
        lines.extend((1..=2000).map(|k| at(f64::from(k))).map(|(x, y)| format!("X{x:.3}Y{y:.3}")));
        let mut bench = Bench::ready(&[]);
        bench.stream(&lines.iter().map(String::as_str).collect::<Vec<_>>());
        bench.settle();
        let lit_s: f64 = bench.board.trace().iter().filter(|s| s.is_lit()).map(|s| s.end_s - s.start_s).sum();
        let ours = 2000.0 * segment_mm * 60.0 / lit_s;
        table += &format!("{segment_mm} mm F{feed}: {ours:.0} mm/min, measured {reached}\n");
        good &= (ours / reached - 1.0).abs() < 0.02;
    }
    println!("{table}");
    assert!(good, "{table}");
}
