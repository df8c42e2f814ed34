//! How long a program held in memory takes, move by move.

use super::{Action, Beam, Held, Limits, Move, Planner};

/// How long a program takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// Time of each move, s, by index.
    pub move_s: Vec<f64>,
    /// Their sum, s: from the first step to the last.
    pub total_s: f64,
    /// True speeds of each move, by index.
    pub speeds: Vec<Speeds>,
    /// How long the laser's output is above zero, s.
    pub laser_on_s: f64,
}

/// How long after a cut with a constant beam (M3) its M5 darkens it, s: 60 cuts on GRBL 1.1h were lit 14.9 ms longer each than they moved. Power
/// that follows speed (M4) is zero at rest by itself.
const DARKENING_S: f64 = 0.0149;

/// Adds up how long the laser is lit.
#[derive(Debug, Default)]
pub(super) struct LitTime {
    pub(super) seconds: f64,
    /// A constant beam is lit.
    constant: bool,
}

impl LitTime {
    /// Takes a move that took `seconds`. A beam that stays constant burns on in a dwell.
    pub(super) fn add(&mut self, m: &Move, seconds: f64) {
        let stands = matches!(m.action, Action::Stop | Action::Dwell { .. });
        let lit = m.burns() || stands && self.constant && m.beam == Beam::Constant && m.power_s > 0.0;
        if lit {
            self.seconds += seconds;
        } else if self.constant && stands {
            self.seconds += DARKENING_S;
        }
        self.constant = lit && m.beam == Beam::Constant;
    }
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
        laser_on_s: 0.0,
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
    let mut lit = LitTime::default();
    moves.iter().zip(&timing.move_s).for_each(|(m, seconds)| lit.add(m, *seconds));
    timing.laser_on_s = lit.seconds;
    timing
}
