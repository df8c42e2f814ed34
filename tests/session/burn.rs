//! What was burnt, made comparable: where the lit path goes and how much light each millimetre got, whatever the time it took.

use furbelow::emulator::Segment;
use furbelow::gcode::{parse, trace};
use furbelow::geom::P3;

/// Rounding of positions and energies summed over a job, mm and S-share seconds.
const SAME: f64 = 1e-6;

/// The lit path by its length: (mm so far, place, light so far).
pub struct Burn {
    points: Vec<(f64, P3, f64)>,
}

impl Burn {
    pub fn of(trace: &[Segment]) -> Burn {
        let mut points = Vec::new();
        let (mut length_mm, mut light) = (0.0, 0.0);
        for s in trace.iter().filter(|s| s.is_lit() && s.length_mm() > 0.0) {
            points.push((length_mm, s.from_mm, light));
            length_mm += s.length_mm();
            light += 0.5 * (s.start_power + s.end_power) * (s.end_s - s.start_s);
            points.push((length_mm, s.to_mm, light));
        }
        Burn { points }
    }

    pub fn length_mm(&self) -> f64 {
        self.points.last().map_or(0.0, |p| p.0)
    }

    /// Place and light at a length. Where the path jumps, at the jump's end when `after`.
    fn at(&self, mm: f64, after: bool) -> (P3, f64) {
        let next = self.points.partition_point(|p| if after { p.0 <= mm + SAME } else { p.0 < mm - SAME });
        let next = next.clamp(1, self.points.len() - 1);
        let (a, b) = (self.points[next - 1], self.points[next]);
        let t = if b.0 > a.0 { ((mm - a.0) / (b.0 - a.0)).clamp(0.0, 1.0) } else { 0.0 };
        (a.1 + (b.1 - a.1) * t, a.2 + (b.2 - a.2) * t)
    }

    /// The same path with the same light along it.
    pub fn equals(&self, other: &Burn) -> bool {
        let half = |a: &Burn, b: &Burn| {
            a.points.chunks(2).all(|pair| {
                let [from, to] = pair else { return false };
                let (at_from, at_to) = (b.at(from.0, true), b.at(to.0, false));
                let near = |p: &(f64, P3, f64), q: (P3, f64)| (p.1 - q.0).norm() < SAME && (p.2 - q.1).abs() < SAME;
                near(from, at_from) && near(to, at_to)
            })
        };
        if self.points.is_empty() || other.points.is_empty() {
            return self.points.is_empty() && other.points.is_empty();
        }
        (self.length_mm() - other.length_mm()).abs() < SAME && half(self, other) && half(other, self)
    }
}

/// What a program burns up to and with each of its lines, mm; of line 0 nothing.
pub fn planned_mm(text: &str) -> Vec<f64> {
    let moves = trace(&parse(text).expect("a program")).expect("moves");
    let mut planned = vec![0.0; text.lines().count() + 1];
    for m in moves.iter().filter(|m| m.burns()) {
        planned[m.line] += m.length_mm();
    }
    (1..planned.len()).for_each(|line| planned[line] += planned[line - 1]);
    planned
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(places: &[(f64, f64)], seconds: f64, power: f64) -> Vec<Segment> {
        let at = |p: (f64, f64)| P3::new(p.0, p.1, 0.0);
        let ways = places.windows(2).enumerate();
        ways.map(|(k, w)| Segment {
            start_s: k as f64 * seconds,
            end_s: (k + 1) as f64 * seconds,
            from_mm: at(w[0]),
            to_mm: at(w[1]),
            start_mm_per_s: 1.0,
            end_mm_per_s: 1.0,
            start_power: power,
            end_power: power,
        })
        .collect()
    }

    #[test]
    fn the_same_path_in_other_pieces_is_the_same_and_another_is_not() {
        let whole = Burn::of(&straight(&[(0.0, 0.0), (2.0, 0.0)], 2.0, 0.5));
        let halves = Burn::of(&straight(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)], 1.0, 0.5));
        assert!(whole.equals(&halves) && halves.equals(&whole));
        let bent = Burn::of(&straight(&[(0.0, 0.0), (1.0, 0.1), (2.0, 0.0)], 1.0, 0.5));
        let bright = Burn::of(&straight(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)], 1.0, 0.6));
        assert!(!bent.equals(&whole) && !bright.equals(&whole) && !Burn::of(&[]).equals(&whole));
    }
}
