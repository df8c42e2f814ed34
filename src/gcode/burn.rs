//! Energy per millimetre at the planner's true speed: where power that follows speed falls under what a tube strikes at, and where a beam
//! that does not burns more into the sheet than cutting takes.

use super::check::{CheckSettings, Notes};
use super::{Action, Beam, Move, Stretch};

/// Beyond this factor over what cuts, edges scorch: the range over which energy per length carries from one laser to another.
const SCORCH_FACTOR: f64 = 2.0;

/// Gaps shorter than this, mm, are bridged by the spot and the kerf.
const GAP_MM: f64 = 0.2;

/// What has burnt so far. Energy per length is E = p W / v (p share of power, W optical watts, v mm/s); under M4 p = S v / F, so that E stays
/// the same while p falls with v.
#[derive(Debug, Default)]
pub(super) struct Burn {
    current: Option<Current>,
    unlit: Tally,
    scorched: Tally,
    at_rest: Tally,
    constant_lit: bool,
}

/// The move being added up.
#[derive(Debug)]
struct Current {
    m: Move,
    seconds: f64,
    unlit_mm: f64,
}

/// How often something happened, where first, and the worst.
#[derive(Debug, Default)]
struct Tally {
    count: usize,
    first_line: usize,
    total: f64,
    worst: f64,
}

impl Tally {
    fn add(&mut self, line: usize, amount: f64, worst: f64) {
        if self.count == 0 {
            self.first_line = line;
        }
        self.count += 1;
        self.total += amount;
        self.worst = self.worst.max(worst);
    }
}

impl Burn {
    /// Takes a stretch of a move.
    pub(super) fn add(&mut self, m: &Move, stretch: &Stretch, settings: &CheckSettings) {
        if !settings.laser {
            return;
        }
        if let Action::Dwell { seconds } = m.action
            && self.constant_lit
            && m.beam == Beam::Constant
            && m.power_s > 0.0
            && seconds > 0.0
        {
            self.at_rest.add(m.line, seconds, seconds);
        }
        if m.goes() {
            self.constant_lit = m.burns() && m.beam == Beam::Constant;
        }
        if !m.burns() {
            return self.end_move(settings);
        }
        // A move's stretches share its line and its ends.
        if self.current.as_ref().is_some_and(|c| c.m != *m) {
            self.end_move(settings);
        }
        let current = self.current.get_or_insert(Current { m: *m, seconds: 0.0, unlit_mm: 0.0 });
        current.seconds += stretch.seconds;
        if m.beam == Beam::Dynamic && settings.strike_floor > 0.0 {
            let share = m.power_s / settings.max_s;
            let floor_mm_per_s = settings.strike_floor / share * m.feed_mm_per_min / 60.0;
            current.unlit_mm += stretch.slower_than_mm(floor_mm_per_s);
        } else if m.beam == Beam::Constant && m.power_s < settings.strike_floor * settings.max_s {
            current.unlit_mm += stretch.length_mm;
        }
    }

    /// Settles the move being added up.
    pub(super) fn end_move(&mut self, settings: &CheckSettings) {
        let Some(Current { m, seconds, unlit_mm }) = self.current.take() else { return };
        if unlit_mm > GAP_MM {
            self.unlit.add(m.line, unlit_mm, unlit_mm);
        }
        let Some(energy) = settings.energy else { return };
        let watts = m.power_s / settings.max_s * energy.full_power_w;
        let length_mm = m.length_mm();
        let j_per_mm = match m.beam {
            Beam::Constant => watts * seconds / length_mm,
            _ => watts * 60.0 / m.feed_mm_per_min,
        };
        if length_mm > GAP_MM && j_per_mm > SCORCH_FACTOR * energy.cut_j_per_mm {
            self.scorched.add(m.line, length_mm, j_per_mm);
        }
    }

    /// Tells what was found, once each, where it first happens.
    pub(super) fn tell(&self, settings: &CheckSettings, notes: &mut Notes) {
        let Burn { unlit, scorched, at_rest, .. } = self;
        if unlit.count > 0 {
            notes.warnings.add(unlit.first_line, 1, "below-strike", || {
                format!(
                    "{} moves run with less than the {:.0} % of power at which the tube strikes, {:.1} mm in all, up to {:.1} mm in one: these stay uncut; use more power, or M3 where M4 lets power fall with speed",
                    unlit.count,
                    100.0 * settings.strike_floor,
                    unlit.total,
                    unlit.worst
                )
            });
        }
        if scorched.count > 0
            && let Some(energy) = settings.energy
        {
            notes.warnings.add(scorched.first_line, 1, "scorch", || {
                format!(
                    "{} moves, {:.0} mm in all, burn up to {:.3} J/mm at their true speed where {:.3} J/mm cut this material: edges will scorch; use less power, more feed, or M4",
                    scorched.count, scorched.total, scorched.worst, energy.cut_j_per_mm
                )
            });
        }
        if at_rest.count > 0 {
            notes.warnings.add(at_rest.first_line, 1, "burns-at-rest", || {
                format!(
                    "the beam stays on under M3 while the machine stands, {:.2} s in all; write S0 or M5 before G4",
                    at_rest.total
                )
            });
        }
    }
}
