//! How densely and how fast is nested: `cargo bench --bench nest -- [FILE.json ...] [--efforts N,N] [--seed N] [--spacing-mm MM] [--json]`.
//!
//! Files are nesting instances of jagua-rs or ESICUP; without any, ribbons of the bench's own: on a roll, on sheets, and three hundred of them. Effort 0 is
//! the first complete layout. Seconds are the processor's, on one core, where the system tells them, else the clock's; `rss_mib` is the most memory the
//! process ever held. With `--efforts 0,300000,1200000` and the ribbons of a teddy and of forty mixed strips (roll 610, sheets 1200 x 900 and 600 x 400) that
//! is 0.02 s for the first complete layout of forty, 1846.5 mm for the teddy, 3314 mm in 3.4 s and 3243 mm in 14 s for the forty, 2 sheets and 9; three
//! hundred ribbons stay below 10 MiB. `benches/nest/beside_spyrrow.py` puts the same instances beside spyrrow.

use furbelow::geom::P2;
use furbelow::nest::{Container, Instance, Item, Settings, nest};
use furbelow::progress::Quiet;
use serde::Serialize;
use std::time::Instant;

#[derive(Serialize)]
struct Row {
    instance: String,
    effort: u64,
    seed: u64,
    items: u32,
    sheets: usize,
    unplaced: usize,
    length_mm: f64,
    density_percent: f64,
    seconds: f64,
    rss_mib: Option<f64>,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let value = |flag: &str| arguments.windows(2).find(|w| w[0] == flag).map(|w| w[1].clone());
    let files: Vec<&String> = arguments.iter().filter(|a| a.ends_with(".json")).collect();
    let instances = if files.is_empty() { own() } else { files.iter().map(|f| read(f)).collect() };
    let efforts = value("--efforts").unwrap_or_else(|| "0,30000,300000".into());
    let efforts: Vec<u64> = efforts.split(',').map(|n| n.parse().expect("--efforts takes numbers")).collect();
    let seed = value("--seed").map_or(1, |n| n.parse().expect("--seed takes a number"));
    let spacing = value("--spacing-mm").map(|n| n.parse().expect("--spacing-mm takes a number"));
    let as_json = arguments.iter().any(|a| a == "--json");
    if !as_json {
        println!("instance              items  effort    sheets  length mm  density %  seconds  MiB");
    }
    for instance in &instances {
        for &effort in &efforts {
            let row = measure(instance, effort, seed, spacing.unwrap_or(instance.spacing_mm));
            match as_json {
                true => println!("{}", serde_json::to_string(&row).expect("numbers and names")),
                false => println!(
                    "{:<20} {:>6} {:>8} {:>8} {:>10.1} {:>10.2} {:>8.2} {:>5.0}",
                    row.instance,
                    row.items,
                    row.effort,
                    row.sheets,
                    row.length_mm,
                    row.density_percent,
                    row.seconds,
                    row.rss_mib.unwrap_or(f64::NAN)
                ),
            }
        }
    }
}

fn measure(instance: &Instance, effort: u64, seed: u64, spacing_mm: f64) -> Row {
    let settings = Settings { spacing_mm, margin_mm: spacing_mm, effort, seed };
    let began = (Instant::now(), processor_s());
    let layouts = nest(&instance.items, &instance.containers, &settings, &mut Quiet).expect("a valid instance");
    let seconds = match (began.1, processor_s()) {
        (Some(from), Some(to)) => to - from,
        _ => began.0.elapsed().as_secs_f64(),
    };
    let area = |l: &furbelow::nest::Layout| l.width_mm * l.height_mm;
    let all: f64 = layouts.layouts.iter().map(area).sum();
    Row {
        instance: instance.name.clone(),
        effort,
        seed,
        items: instance.items.iter().map(|i| i.copies).sum(),
        sheets: layouts.layouts.len(),
        unplaced: layouts.unplaced.len(),
        length_mm: layouts.layouts.iter().map(|l| l.width_mm).sum(),
        density_percent: 100.0 * layouts.layouts.iter().map(|l| l.density * area(l)).sum::<f64>() / all,
        seconds,
        rss_mib: peak_mib(),
    }
}

fn read(file: &str) -> Instance {
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{file}: {e}"));
    Instance::parse(&text).unwrap_or_else(|e| panic!("{file}: {e}"))
}

/// Wavy bands of 150 to 1100 mm, 25 to 80 mm wide.
fn own() -> Vec<Instance> {
    let ribbon = |k: u32| {
        let share = |step: f64| (f64::from(k) * step).fract();
        let (length, width) = (150.0 + 950.0 * share(0.618), 25.0 + 55.0 * share(0.414));
        let (height, waves) = (25.0 * share(0.732), 0.5 + 4.0 * share(0.236));
        let rim = |i: u32, up: f64| {
            let s = f64::from(i) / 120.0;
            P2::new(s * length, up * width * (1.0 - 0.3 * s) + height * (s * waves * std::f64::consts::TAU).sin())
        };
        let polygon = (0..=120).map(|i| rim(i, 0.0)).chain((0..=120).rev().map(|i| rim(i, 1.0))).collect();
        Item::new(format!("{k}"), polygon, vec![0.0, 180.0])
    };
    let ribbons = |n: u32| (0..n).map(ribbon).collect::<Vec<Item>>();
    let roll = |max_length_mm| Container::Roll { name: "roll".into(), width_mm: 610.0, max_length_mm };
    vec![
        Instance::new("ribbons-roll", &ribbons(40), &[roll(20_000.0)], 0.0),
        Instance::new("ribbons-sheets", &ribbons(40), &[Container::sheet("1200x900", 1200.0, 900.0, None)], 2.0),
        Instance::new("ribbons-300", &ribbons(300), &[roll(100_000.0)], 0.0),
    ]
}

/// CPU seconds of this process so far, where the system tells them.
fn processor_s() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
    let ticks = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    // USER_HZ is 100 on every Linux there is.
    Some(ticks / 100.0)
}

fn peak_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}
