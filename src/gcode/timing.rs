//! How long a program held in memory takes, move by move.

use super::{Held, Limits, Move, Planner};

/// How long a program takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// Time of each move, s, by index.
    pub move_s: Vec<f64>,
    /// Their sum, s: from the first step to the last.
    pub total_s: f64,
    /// True speeds of each move, by index.
    pub speeds: Vec<Speeds>,
}

/// How fast a move is really run, mm/s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Speeds {
    /// At its start.
    pub entry_mm_per_s: f64,
    /// At its fastest.
    pub cruise_mm_per_s: f64,
    /// At its end.
    pub exit_mm_per_s: f64,
    /// What keeps part of it slow, if that is neither feed nor corner.
    pub held: Option<Held>,
}

/// Time of every move, from rest to rest, sent by counting characters.
pub fn estimate(moves: &[Move], limits: &Limits) -> Timing {
    let mut timing = Timing {
        move_s: vec![0.0; moves.len()],
        total_s: 0.0,
        speeds: vec![Speeds::default(); moves.len()],
    };
    let mut last = None;
    let mut sink = |stretch: super::Stretch| {
        let speeds = &mut timing.speeds[stretch.index];
        if last.replace(stretch.index) != Some(stretch.index) {
            speeds.entry_mm_per_s = stretch.entry_mm_per_s;
        }
        speeds.cruise_mm_per_s = speeds.cruise_mm_per_s.max(stretch.cruise_mm_per_s);
        speeds.exit_mm_per_s = stretch.exit_mm_per_s;
        speeds.held = speeds.held.or(stretch.held);
        timing.move_s[stretch.index] += stretch.seconds;
    };
    let mut planner = Planner::new(limits);
    for m in moves {
        planner.push(m, &mut sink);
    }
    planner.finish(&mut sink);
    timing.total_s = timing.move_s.iter().sum();
    timing
}
