//! The planner against times measured on GRBL itself: tests/planner_truth/truth.json says how they were measured.

use furbelow::gcode::{Action, Beam, Limits, Move, Planner, Stretch, estimate, parse, trace};
use furbelow::geom::P3;

/// The measured controller: truth.json's settings, 115200 baud, about 270 lines/s.
const MEASURED: Limits = Limits {
    max_rate_mm_per_min: [10_000.0, 10_000.0, 3000.0],
    acceleration_mm_per_s2: [500.0, 500.0, 100.0],
    junction_deviation_mm: 0.01,
    arc_tolerance_mm: 0.002,
    planner_blocks: 15,
    bytes_per_s: 11_520.0,
    rx_bytes: 128,
    line_s: 0.0037,
};

fn moves(job: &str) -> Vec<Move> {
    let path = format!("{}/tests/planner_truth/{job}", env!("CARGO_MANIFEST_DIR"));
    trace(&parse(&std::fs::read_to_string(path).unwrap()).unwrap()).unwrap()
}

fn truth() -> Vec<(String, f64, f64, f64)> {
    let path = format!("{}/tests/planner_truth/truth.json", env!("CARGO_MANIFEST_DIR"));
    let truth: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let number = |job: &serde_json::Value, key: &str| job[key].as_f64().unwrap();
    truth["jobs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|job| {
            let name = job["job"].as_str().unwrap().to_owned();
            (name, number(job, "motion_s"), number(job, "laser_on_s"), number(job, "laser_on_mm"))
        })
        .collect()
}

#[test]
fn measured_jobs_take_as_long_as_they_did_and_burn_as_long() {
    let mut table = String::new();
    let mut worst = Vec::new();
    for (job, motion_s, laser_on_s, laser_on_mm) in truth() {
        let moves = moves(&job);
        let timing = estimate(&moves, &MEASURED);
        let seen_mm = measured_path_mm(&moves);
        let error = |ours: f64, measured: f64| 100.0 * (ours / measured - 1.0);
        let errors =
            [error(timing.total_s, motion_s), error(timing.laser_on_s, laser_on_s), error(seen_mm, laser_on_mm)];
        table += &format!("{job}: time {:+.3} %, laser on {:+.3} %, path {:+.3} %\n", errors[0], errors[1], errors[2]);
        // Where changes of the laser stop the machine 120 times, 1 %; elsewhere motion alone decides.
        let allowed = if job.starts_with('f') { 1.0 } else { 0.3 };
        worst.push(errors.iter().all(|e| e.abs() < allowed));
    }
    println!("{table}");
    assert!(worst.iter().all(|ok| *ok) && worst.len() == 5, "{table}");
}

/// The path with the beam on as the measurement saw it: whole motor steps (80 a mm), looked at every 2 ms. Between looks the steps of the two motors
/// make a staircase somewhat longer than the line they follow.
fn measured_path_mm(moves: &[Move]) -> f64 {
    const LOOK_S: f64 = 0.002;
    let mut stretches: Vec<Stretch> = Vec::new();
    let mut planner = Planner::new(&MEASURED);
    for m in moves {
        planner.push(m, &mut |s| stretches.push(s));
    }
    planner.finish(&mut |s| stretches.push(s));
    let steps = |p: P3| P3::new((p.x * 80.0).round() / 80.0, (p.y * 80.0).round() / 80.0, 0.0);
    let (mut path_mm, mut clock_s, mut look_s, mut done_mm, mut last) = (0.0, 0.0, 0.0, 0.0, 0);
    let mut seen: Option<P3> = None;
    for s in stretches {
        let m = &moves[s.index];
        if s.index != last {
            (last, done_mm) = (s.index, 0.0);
        }
        let end_s = clock_s + s.seconds;
        while look_s < end_s {
            let at_mm = (done_mm + way(&s, look_s - clock_s)).min(m.length_mm());
            let here = steps(m.point_at(if m.length_mm() > 0.0 { at_mm / m.length_mm() } else { 1.0 }));
            let lit = m.burns();
            if let Some(before) = seen
                && lit
            {
                path_mm += (here - before).norm();
            }
            seen = (lit || m.beam != Beam::Off && m.action == Action::Rapid).then_some(here);
            look_s += LOOK_S;
        }
        clock_s = end_s;
        done_mm += s.length_mm;
    }
    path_mm
}

/// How far along a stretch the tool is after a time, mm.
fn way(s: &Stretch, t: f64) -> f64 {
    let (v0, v, v1, a) = (s.entry_mm_per_s, s.cruise_mm_per_s, s.exit_mm_per_s, s.acceleration_mm_per_s2);
    if s.length_mm == 0.0 {
        return 0.0;
    }
    let (up, down) = ((v - v0) / a, (v - v1) / a);
    let t = t.max(0.0);
    let left = s.seconds - t;
    if t < up {
        v0 * t + 0.5 * a * t * t
    } else if left < down {
        s.length_mm - (v1 * left + 0.5 * a * left * left)
    } else {
        0.5 * (v0 + v) * up + v * (t - up)
    }
}

/// 2000 segments along a circle of 50 mm radius: the feed GRBL really reached, mm/min, and what held it.
#[test]
fn short_segments_run_as_fast_as_link_controller_and_look_ahead_let_them() {
    let measured = [
        (0.2, 3000.0, 2970.0),
        (0.3, 3000.0, 2980.0),
        (0.5, 3000.0, 2987.0),
        (0.2, 6000.0, 3210.0),
        (0.5, 6000.0, 5279.0),
        (0.3, 6000.0, 4095.0),
    ];
    let mut table = String::new();
    let mut good = true;
    for (segment_mm, feed, reached) in measured {
        let at = |k: f64| (50.0 * (segment_mm * k / 50.0_f64).cos(), 50.0 * (segment_mm * k / 50.0_f64).sin());
        let lines: String = (1..=2000).map(|k| at(f64::from(k))).map(|(x, y)| format!("X{x:.3}Y{y:.3}\n")).collect();
        let text = format!("M4S500\nG0X50Y0\nG1F{feed}\n{lines}");
        let moves = trace(&parse(&text).unwrap()).unwrap();
        let timing = estimate(&moves, &MEASURED);
        let ours = 2000.0 * segment_mm * 60.0
            / moves.iter().zip(&timing.move_s).filter(|(m, _)| m.burns()).map(|(_, s)| s).sum::<f64>();
        let held = timing.speeds.iter().filter_map(|s| s.held).fold([0; 3], |mut n, h| {
            n[h as usize] += 1;
            n
        });
        table += &format!(
            "{segment_mm} mm F{feed}: {ours:.0} mm/min, measured {reached} ({:+.2} %), held {held:?}\n",
            100.0 * (ours / reached - 1.0)
        );
        good &= (ours / reached - 1.0).abs() < 0.01;
    }
    println!("{table}");
    assert!(good, "{table}");
}
