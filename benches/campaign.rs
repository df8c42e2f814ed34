//! Faults at random moments of a job, seeded, on virtual time: `cargo bench --bench campaign -- --runs 5000 --seed 1`.
//!
//! Every run sends a job to an emulated GRBL or grblHAL board, lets something go wrong, and takes the job up again where it can be. It prints what came of
//! it, fault by fault: the worst the account was behind in lines, what was burnt beside the plan, how long the beam was lit after the machine
//! could stand, and how much was cut twice by a job that was taken up with 0.5 mm of overlap. Exit code 1 when anything is not as it must be.

#[path = "../tests/campaign/path.rs"]
mod path;
#[path = "../tests/campaign/play.rs"]
mod play;
#[path = "../tests/campaign/rig.rs"]
mod rig;
#[path = "../tests/campaign/table.rs"]
mod table;

use play::{Run, Sound, play};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

fn main() -> ExitCode {
    let (runs, seed) = (argument("--runs").unwrap_or(5000), argument("--seed").unwrap_or(1));
    let began = Instant::now();
    let sound = Sound::new();
    let next = AtomicU64::new(0);
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let mut played: Vec<(u64, Run)> = std::thread::scope(|scope| {
        let work = || {
            let mut mine = Vec::new();
            loop {
                let nth = next.fetch_add(1, Ordering::Relaxed);
                if nth >= runs {
                    return mine;
                }
                mine.push((seed + nth, play(seed + nth, &sound)));
            }
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("no panic")).collect()
    });
    played.sort_by_key(|(seed, _)| *seed);
    for (seed, run) in played.iter().filter(|(_, run)| !run.broken.is_empty()) {
        println!("seed {seed}: {}, {}: {}", run.kin.title(), run.kind.title(), run.broken.join("; "));
    }
    let all: Vec<Run> = played.into_iter().map(|(_, run)| run).collect();
    print!("{}", table::table(&all));
    let escaped = all.iter().filter(|run| run.escaped).count();
    let broken = all.iter().filter(|run| !run.broken.is_empty()).count();
    println!(
        "\n{runs} runs from seed {seed} in {:.0} s: {broken} not as they must be, {escaped} done and not as planned",
        began.elapsed().as_secs_f64()
    );
    if broken == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The number behind a word of the command line.
fn argument(word: &str) -> Option<u64> {
    let mut words = std::env::args().skip_while(|a| a != word);
    words.next()?;
    words.next()?.parse().ok()
}
