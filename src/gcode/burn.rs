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
    unlit_run: Run,
    scorched_run: Run,
    unlit: Tally,
    scorched: Tally,
    at_rest: Tally,
}

/// The move being added up.
#[derive(Debug)]
struct Current {
    m: Move,
    seconds: f64,
}

/// A way without a break along which the same is wrong, over as many moves as it goes: a contour may be written in chords however short.
#[derive(Debug, Default)]
struct Run {
    first_line: usize,
    mm: f64,
    /// What was worst along it; 0 when that is its length.
    worst: f64,
}

impl Run {
    fn add(&mut self, line: usize, mm: f64, worst: f64) {
        if self.mm == 0.0 {
            self.first_line = line;
        }
        self.mm += mm;
        self.worst = self.worst.max(worst);
    }

    /// The way breaks off here.
    fn end(&mut self, tally: &mut Tally) {
        let Run { first_line, mm, worst } = std::mem::take(self);
        if mm > GAP_MM {
            tally.add(first_line, mm, if worst > 0.0 { worst } else { mm });
        }
    }
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
        // In laser mode GRBL lights a constant beam at rest too, unless the motion mode is a travel.
        let dwells =
            matches!(m.action, Action::Dwell { .. }) && m.feeding && m.beam == Beam::Constant && m.power_s > 0.0;
        // What moves along z alone burns one spot.
        let in_place = m.burns() && m.action == Action::Line && m.from.xy() == m.to.xy();
        if let Action::Dwell { seconds } = m.action
            && dwells
            && seconds > 0.0
        {
            self.at_rest.add(m.line, seconds, seconds);
        } else if in_place {
            self.at_rest.add(m.line, stretch.seconds, stretch.seconds);
        }
        if !m.burns() || in_place {
            return self.end(settings);
        }
        // A move's stretches share its line and its ends.
        if self.current.as_ref().is_some_and(|c| c.m != *m) {
            self.end_move(settings);
        }
        let current = self.current.get_or_insert(Current { m: *m, seconds: 0.0 });
        current.seconds += stretch.seconds;
        let share = m.power_s / settings.max_s;
        let floor_mm_per_s = match m.beam {
            Beam::Dynamic => settings.strike_floor / share * m.feed_mm_per_min / 60.0,
            _ if share < settings.strike_floor => f64::INFINITY,
            _ => 0.0,
        };
        // Unlit ends of stretches that follow on each other are one gap.
        let (before_mm, after_mm) = stretch.slow_ends_mm(floor_mm_per_s);
        self.unlit_run.add(m.line, before_mm, 0.0);
        if before_mm < stretch.length_mm {
            self.unlit_run.end(&mut self.unlit);
            self.unlit_run.add(m.line, after_mm, 0.0);
        }
    }

    /// Settles what burnt until here: the beam goes out, or the file ends.
    pub(super) fn end(&mut self, settings: &CheckSettings) {
        self.end_move(settings);
        self.unlit_run.end(&mut self.unlit);
        self.scorched_run.end(&mut self.scorched);
    }

    fn end_move(&mut self, settings: &CheckSettings) {
        let Some(Current { m, seconds }) = self.current.take() else { return };
        let Some(energy) = settings.energy else { return };
        let watts = m.power_s / settings.max_s * energy.full_power_w;
        let length_mm = m.length_mm();
        let j_per_mm = match m.beam {
            Beam::Constant => watts * seconds / length_mm,
            _ => watts * 60.0 / m.feed_mm_per_min,
        };
        if j_per_mm > SCORCH_FACTOR * energy.cut_j_per_mm {
            self.scorched_run.add(m.line, length_mm, j_per_mm);
        } else {
            self.scorched_run.end(&mut self.scorched);
        }
    }

    /// Tells what was found, once each, where it first happens.
    pub(super) fn tell(&self, settings: &CheckSettings, notes: &mut Notes) {
        let Burn { unlit, scorched, at_rest, .. } = self;
        if unlit.count > 0 {
            notes.warnings.add(unlit.first_line, 1, "below-strike", || {
                format!(
                    "{} stretches run with less than the {:.0} % of power at which the tube strikes, {:.1} mm in all, up to {:.1} mm in one: these stay uncut; use more power, or M3 where M4 lets power fall with speed",
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
                    "{} stretches, {:.0} mm in all, burn up to {:.3} J/mm at their true speed where {:.3} J/mm cut this material: edges will scorch; use less power, more feed, or M4",
                    scorched.count, scorched.total, scorched.worst, energy.cut_j_per_mm
                )
            });
        }
        if at_rest.count > 0 {
            notes.warnings.add(at_rest.first_line, 1, "burns-at-rest", || {
                format!(
                    "the beam stays on in one place, {:.2} s in all: M3 burns on while the machine stands, and M3 and M4 while only Z moves; write S0 or M5 before",
                    at_rest.total
                )
            });
        }
    }
}
