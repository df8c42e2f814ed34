//! A part of the fault campaign that a build has time for; `cargo bench --bench campaign` runs all of it.

#[path = "campaign/path.rs"]
mod path;
#[path = "campaign/play.rs"]
mod play;
#[path = "campaign/rig.rs"]
mod rig;
#[path = "campaign/table.rs"]
mod table;

use play::{Kind, Run, Sound, play};

/// Seeded runs.
const RUNS: u64 = 500;

#[test]
fn whatever_strikes_the_account_is_true_the_beam_goes_out_and_the_job_can_be_finished() {
    let sound = Sound::new();
    let runs: Vec<(u64, Run)> = (1..=RUNS).map(|seed| (seed, play(seed, &sound))).collect();
    let broken: Vec<String> = runs
        .iter()
        .filter(|(_, run)| !run.broken.is_empty())
        .map(|(seed, run)| format!("seed {seed}: {}, {}: {}", run.kin.title(), run.kind.title(), run.broken.join("; ")))
        .collect();
    let all: Vec<Run> = runs.into_iter().map(|(_, run)| run).collect();
    println!("{}", table::table(&all));
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    for kind in Kind::ALL {
        let those: Vec<&Run> = all.iter().filter(|run| run.kind == kind).collect();
        let harmless = those.iter().filter(|run| run.outcome == "done" && !run.escaped).count();
        // Faults that never do anything are no test; chatter should do nothing.
        assert_eq!(harmless == those.len(), kind == Kind::Chatter, "{}", kind.title());
        let finished = those.iter().filter(|run| run.finished).count();
        assert!(kind.alters() || kind == Kind::Chatter || finished > 0, "{} is never finished", kind.title());
    }
    let altered: Vec<&Run> = all.iter().filter(|run| run.kind.alters() && run.stray_mm > play::STRAY_MM).collect();
    let noticed = altered.iter().filter(|run| run.damaged).count();
    let escaped = altered.iter().filter(|run| run.escaped).count();
    println!("{} runs strayed from their way; {noticed} were marked, {escaped} passed for done", altered.len());
    // That none is overlooked for longer than two reports is judged in every run.
    assert!(noticed > 0, "{noticed} of {}", altered.len());
}
