//! Sessions against emulated boards over real pseudo-terminals, in real time: open, send, stop, and all that goes wrong between.
#![cfg(unix)]

#[path = "pty/breaks.rs"]
mod breaks;
#[path = "pty/jobs.rs"]
mod jobs;
#[path = "pty/opening.rs"]
mod opening;
#[path = "pty/orders.rs"]
mod orders;
#[path = "pty/stage.rs"]
mod stage;

use furbelow::emulator::{Board, BoardSettings};
use furbelow::stream::ServedBoard;
use stage::{Case, Stage};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Cases at the same time: they mostly wait.
const AT_ONCE: usize = 12;

#[test]
fn every_scenario_over_a_pseudo_terminal_ends_as_it_should_with_the_beam_off() {
    if let Err(reason) = ServedBoard::start(Board::new(BoardSettings::default()), drop) {
        println!("skipped: no pseudo-terminals here ({reason})");
        return;
    }
    let cases: Vec<&Case> = [opening::CASES, jobs::CASES, orders::CASES, breaks::CASES].into_iter().flatten().collect();
    assert!(cases.len() >= 40);
    let (next, told) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let began = Instant::now();
                    let went = catch_unwind(AssertUnwindSafe(|| {
                        let mut stage = Stage::new((case.board)());
                        (case.play)(&mut stage);
                        stage.ends_dark();
                    }));
                    let line = (case.name, began.elapsed().as_secs_f64(), went.is_ok());
                    told.lock().expect("nobody panics with it").push(line);
                }
            });
        }
    });
    let told = told.into_inner().expect("nobody panics with it");
    for (name, seconds, well) in &told {
        println!("{} {seconds:5.2} s  {name}", if *well { "ok  " } else { "FAIL" });
    }
    let failed: Vec<&str> = told.iter().filter(|(_, _, well)| !well).map(|(name, _, _)| *name).collect();
    assert!(failed.is_empty(), "{failed:#?}; what each said stands above");
}
