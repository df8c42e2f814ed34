//! Where link, controller or look-ahead keep cuts slower than their feed.

use super::check::Notes;
use super::{Held, Move, Stretch};

/// Slower than this share of its feed, a cut looks and burns otherwise than meant.
const SLOW_SHARE: f64 = 0.95;

/// Told only when this share of all that is cut is concerned: single slow moves leave no trace.
const TOLD_SHARE: f64 = 0.05;
/// And nothing that takes less than this, s.
const TOLD_S: f64 = 0.5;

/// Lengths that ran too slow, by reason.
#[derive(Debug, Default)]
pub(super) struct HeldFeed {
    reasons: [Slow; 3],
    feed_mm: f64,
}

#[derive(Debug, Default, Clone, Copy)]
struct Slow {
    first_line: usize,
    mm: f64,
    seconds: f64,
}

impl HeldFeed {
    /// Takes a stretch of a move.
    pub(super) fn add(&mut self, m: &Move, stretch: &Stretch) {
        if !m.feeds() {
            return;
        }
        self.feed_mm += stretch.length_mm;
        let Some(held) = stretch.held else { return };
        if stretch.cruise_mm_per_s >= SLOW_SHARE * m.feed_mm_per_min / 60.0 {
            return;
        }
        let slow = &mut self.reasons[held as usize];
        if slow.mm == 0.0 {
            slow.first_line = m.line;
        }
        slow.mm += stretch.length_mm;
        slow.seconds += stretch.seconds;
    }

    /// Tells each reason once, where it first holds.
    pub(super) fn tell(&self, notes: &mut Notes) {
        for held in [Held::Link, Held::Controller, Held::LookAhead] {
            let Slow { first_line, mm, seconds } = self.reasons[held as usize];
            if seconds < TOLD_S || mm < TOLD_SHARE * self.feed_mm {
                continue;
            }
            let reason = match held {
                Held::Link => "lines do not arrive fast enough: raise the baud rate or write shorter lines",
                Held::Controller => "the controller cannot read lines fast enough: write arcs or longer moves",
                Held::LookAhead => "the planner sees too short a way ahead to stop in: write arcs or longer moves",
            };
            notes.warnings.add(first_line, 1, "feed-held", || {
                format!(
                    "{mm:.0} mm run at {:.0} mm/min on average, below their feed, because {reason}",
                    60.0 * mm / seconds
                )
            });
        }
    }
}
