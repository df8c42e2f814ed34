//! The speed within each move, so that the tool's dot is where the tool is.
//!
//! The planner tells how long each move takes. Along a chain of moves from rest to rest that fixes the speed at every corner: a trapezoid
//! that starts at a known speed and takes a known time ends at one speed only.

use crate::gcode::{Action, Limits, Move};

/// Halvings that find a speed to better than 1e-9 of its range.
const HALVINGS: usize = 40;

/// The trapezoid of one move, mm/s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Pace {
    /// At the start, where the move before ends.
    pub entry: f64,
    /// Fastest on the way.
    pub peak: f64,
    /// At the end.
    pub exit: f64,
}

/// Speeds of every move, given their times in s. Zero for what does not move.
pub(super) fn paces(moves: &[Move], move_s: &[f64], limits: &Limits) -> Vec<Pace> {
    let mut entry = 0.0;
    let mut paces = vec![Pace::default(); moves.len()];
    for (k, m) in moves.iter().enumerate() {
        let length_mm = m.length_mm();
        if length_mm == 0.0 {
            // A move to where the tool stands is no rest; a dwell or a stop is one.
            if matches!(m.action, Action::Dwell { .. } | Action::Stop) {
                entry = 0.0;
            }
            continue;
        }
        let ramp = Ramp { entry, length_mm, nominal: nominal(m, limits), acceleration: acceleration(m, limits) };
        let next = moves[k + 1..].iter().find(|n| n.length_mm() > 0.0 || rests(n));
        let exit = match next {
            Some(next) if !rests(next) => ramp.exit_after(move_s[k], nominal(next, limits)),
            _ => 0.0,
        };
        paces[k] = Pace { entry, peak: ramp.peak(exit), exit };
        entry = exit;
    }
    paces
}

fn rests(m: &Move) -> bool {
    matches!(m.action, Action::Dwell { .. } | Action::Stop)
}

/// Commanded speed within the axes' rates, mm/s.
fn nominal(m: &Move, limits: &Limits) -> f64 {
    let rate = along(m, limits.max_rate_mm_per_min);
    let feed = if m.action == Action::Rapid { rate } else { rate.min(m.feed_mm_per_min) };
    feed / 60.0
}

fn acceleration(m: &Move, limits: &Limits) -> f64 {
    along(m, limits.acceleration_mm_per_s2)
}

/// The greatest value along a move that keeps every axis within its own limit; on an arc, which turns through all directions, the lower of
/// the plane's two.
fn along(m: &Move, [x, y, z]: [f64; 3]) -> f64 {
    match m.action {
        Action::Arc { .. } => x.min(y),
        _ => {
            let d = (m.to - m.from).normalize();
            (x / d.x.abs()).min(y / d.y.abs()).min(z / d.z.abs())
        }
    }
}

struct Ramp {
    entry: f64,
    length_mm: f64,
    nominal: f64,
    acceleration: f64,
}

impl Ramp {
    fn peak(&self, exit: f64) -> f64 {
        let squares = self.entry * self.entry + exit * exit;
        (self.acceleration * self.length_mm + 0.5 * squares).sqrt().min(self.nominal).max(self.entry).max(exit)
    }

    /// v0 to the peak to v1, s: (2 p - v0 - v1) / a, and what is left of the way at p.
    fn seconds(&self, exit: f64) -> f64 {
        let (a, peak) = (self.acceleration, self.peak(exit));
        let ramps_mm = (2.0 * peak * peak - self.entry * self.entry - exit * exit) / (2.0 * a);
        (2.0 * peak - self.entry - exit) / a + (self.length_mm - ramps_mm).max(0.0) / peak
    }

    /// The speed at the end of a move that took `time_s`, at most `cap`.
    fn exit_after(&self, time_s: f64, cap: f64) -> f64 {
        let squared =
            |sign: f64| (self.entry * self.entry + sign * 2.0 * self.acceleration * self.length_mm).max(0.0).sqrt();
        let mut slow = squared(-1.0);
        let mut fast = squared(1.0).min(self.nominal).min(cap).max(slow);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (slow + fast);
            if self.seconds(middle) > time_s { slow = middle } else { fast = middle }
        }
        0.5 * (slow + fast)
    }
}

#[cfg(test)]
mod tests {
    use super::super::run::tests::{bed, moves};
    use super::*;
    use crate::gcode::estimate;

    fn of(text: &str) -> (Vec<Move>, Vec<Pace>) {
        let moves = moves(text);
        let limits = bed().limits;
        let timing = estimate(&moves, &limits);
        let paces = paces(&moves, &timing.move_s, &limits);
        (moves, paces)
    }

    #[test]
    fn the_speed_at_a_square_corner_is_the_junction_speed() {
        let (_, paces) = of("G1X100F3000\nY100");
        let s = 0.5_f64.sqrt();
        let corner = (500.0 * 2.0_f64.sqrt() * 0.01 * s / (1.0 - s)).sqrt();
        assert!((paces[0].exit - corner).abs() < 1e-4, "{:?} {corner}", paces[0]);
        assert!((paces[0].peak - 50.0).abs() < 1e-9);
        assert_eq!(paces[1].exit, 0.0, "it comes to rest at the end");
    }

    #[test]
    fn a_line_in_many_pieces_keeps_its_speed_through_all_of_them() {
        let pieces: String = (1..=60).map(|k| format!("G1X{}F3000\n", k)).collect();
        let (_, paces) = of(&pieces);
        // 50 mm/s are reached within 2.5 mm, and left only for the end.
        for pace in &paces[3..55] {
            assert!((pace.exit - 50.0).abs() < 1e-3 && (pace.peak - 50.0).abs() < 1e-3, "{pace:?}");
        }
    }

    #[test]
    fn dwells_and_mode_changes_are_rests() {
        let (_, paces) = of("G1X10F3000\nG4P1\nX20\nM3\nX30");
        let exits: Vec<f64> = paces.iter().map(|p| p.exit).collect();
        assert_eq!(exits, [0.0; 5]);
        assert_eq!(paces[1].peak, 0.0);
    }
}
