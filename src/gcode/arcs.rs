//! Arcs as three decimals can write them.
//!
//! Rounding moves both ends and the centre of an arc. The centre is therefore chosen again: of the grid points around the true one, the one
//! whose circle through the rounded start stays nearest to the true arc. Where none is near enough (one or two arcs in a hundred) the arc is halved,
//! which rounds anew. An arc too short, too flat or too large to survive rounding is written as chords.

use super::arc_words::refuses_arc;
use super::program::round3;
use crate::geom::{P2, Segment, V2};

/// Shortest chord of an arc: below it the rounded ends (0.7 um off each) could change places, and GRBL would burn a full circle.
const MIN_CHORD_MM: f64 = 0.02;

/// GRBL computes in 32-bit floats: beyond this radius the ends of an arc lose the third decimal.
const MAX_RADIUS_MM: f64 = 1000.0;

/// How far chords may leave an arc: below the 0.5 um of rounding.
const CHORD_TOLERANCE_MM: f64 = 2e-4;

/// How far a written arc may leave the true one at the points checked; between them it stays below the last decimal. Rounding the ends alone
/// costs up to 0.7 um.
const ARC_TOLERANCE_MM: f64 = 9e-4;

/// How often an arc is halved before it is written as chords.
const MAX_HALVINGS: u32 = 4;

/// One piece to write, its numbers rounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Piece {
    Line { to: P2 },
    Arc { to: P2, offset: V2, clockwise: bool },
}

/// A point as three decimals write it.
pub(super) fn rounded(p: P2) -> P2 {
    p.map(round3)
}

/// What to write for one segment when the tool stands at `at`, the rounded end of the segment before.
pub(super) fn pieces(segment: &Segment, at: P2) -> Vec<Piece> {
    match *segment {
        Segment::Line { to, .. } => line(at, to).into_iter().collect(),
        Segment::Arc { from, center, radius, sweep_rad, .. } => {
            // Beyond a half circle, ends come near each other: two arcs are safer.
            let parts = if sweep_rad.abs() > 1.1 * std::f64::consts::PI { 2 } else { 1 };
            let mut pieces = Vec::new();
            let mut at = at;
            for k in 0..parts {
                let start = turned(center, from, sweep_rad * f64::from(k) / f64::from(parts));
                let part = Arc { start, center, radius, sweep_rad: sweep_rad / f64::from(parts) };
                part.write(MAX_HALVINGS, &mut at, &mut pieces);
            }
            pieces
        }
    }
}

fn line(at: P2, to: P2) -> Option<Piece> {
    let to = rounded(to);
    (to != at).then_some(Piece::Line { to })
}

fn turned(center: P2, p: P2, angle_rad: f64) -> P2 {
    center + nalgebra::Rotation2::new(angle_rad) * (p - center)
}

/// A true arc of at most a little more than a half circle.
struct Arc {
    start: P2,
    center: P2,
    radius: f64,
    sweep_rad: f64,
}

impl Arc {
    fn at(&self, t: f64) -> P2 {
        turned(self.center, self.start, self.sweep_rad * t)
    }

    fn write(&self, halvings: u32, at: &mut P2, pieces: &mut Vec<Piece>) {
        let to = rounded(self.at(1.0));
        let chord = (to - *at).norm();
        let sagitta = self.radius * (1.0 - (0.5 * self.sweep_rad).cos());
        if chord >= MIN_CHORD_MM && sagitta > CHORD_TOLERANCE_MM && self.radius <= MAX_RADIUS_MM {
            let (offset, deviation_mm) = self.best_centre(*at, to);
            if deviation_mm <= ARC_TOLERANCE_MM && !refuses_arc(offset.norm(), (to - *at - offset).norm()) {
                pieces.push(Piece::Arc { to, offset, clockwise: self.sweep_rad < 0.0 });
                *at = to;
                return;
            }
            if halvings > 0 {
                let half = |start| Arc { start, sweep_rad: 0.5 * self.sweep_rad, ..*self };
                half(self.start).write(halvings - 1, at, pieces);
                half(self.at(0.5)).write(halvings - 1, at, pieces);
                return;
            }
        }
        // The sagitta of n chords is radius (1 - cos(sweep / 2n)), about radius sweep^2 / 8n^2.
        let chords = (self.sweep_rad.abs() * (self.radius / (8.0 * CHORD_TOLERANCE_MM)).sqrt()).ceil().max(1.0);
        for k in 1..=chords as u32 {
            if let Some(Piece::Line { to }) = line(*at, self.at(f64::from(k) / chords)) {
                pieces.push(Piece::Line { to });
                *at = to;
            }
        }
    }

    /// The rounded I and J whose circle through the rounded start stays nearest to the true arc, and how near.
    fn best_centre(&self, at: P2, to: P2) -> (V2, f64) {
        let nominal = rounded(self.center - at.coords).coords;
        let mut best = (nominal, f64::INFINITY);
        for di in -2..=2 {
            for dj in -2..=2 {
                let offset =
                    V2::new(round3(nominal.x + 0.001 * f64::from(di)), round3(nominal.y + 0.001 * f64::from(dj)));
                let deviation_mm = self.deviation_mm(at, to, offset);
                if deviation_mm < best.1 {
                    best = (offset, deviation_mm);
                }
            }
        }
        best
    }

    /// Farthest the written arc comes from the true one, judged at quarters and by how far its end misses its circle, mm.
    fn deviation_mm(&self, at: P2, to: P2, offset: V2) -> f64 {
        let center = at + offset;
        let radius = offset.norm();
        let miss = ((to - center).norm() - radius).abs();
        [0.0, 0.25, 0.5, 0.75, 1.0].iter().map(|t| ((self.at(*t) - center).norm() - radius).abs()).fold(miss, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Path, PathVertex};

    fn arc(from: (f64, f64), to: (f64, f64), bulge: f64) -> Segment {
        let vertices = vec![
            PathVertex { point: P2::new(from.0, from.1), bulge },
            PathVertex { point: P2::new(to.0, to.1), bulge: 0.0 },
        ];
        Path { vertices, closed: false }.segments().next().unwrap()
    }

    fn write(segment: Segment) -> Vec<Piece> {
        pieces(&segment, rounded(segment.from()))
    }

    #[test]
    fn a_half_circle_is_one_arc_and_three_quarters_are_two() {
        let half = write(arc((0.0, 0.0), (0.0, 10.0), 1.0));
        let expected = Piece::Arc { to: P2::new(0.0, 10.0), offset: V2::new(0.0, 5.0), clockwise: false };
        assert_eq!(half, [expected]);
        let more = write(arc((1.0, 0.0), (0.0, -1.0), -(0.75 * std::f64::consts::FRAC_PI_2).tan()));
        assert_eq!(more.len(), 2);
        assert!(more.iter().all(|p| matches!(p, Piece::Arc { clockwise: true, .. })));
    }

    #[test]
    fn arcs_too_short_or_too_flat_for_three_decimals_are_lines() {
        let tiny = write(arc((0.0, 0.0), (0.01, 0.0), 0.3));
        assert!(!tiny.is_empty() && tiny.iter().all(|p| matches!(p, Piece::Line { .. })), "{tiny:?}");
        assert_eq!(write(arc((0.0, 0.0), (10.0, 0.0), 2e-5)), [Piece::Line { to: P2::new(10.0, 0.0) }]);
        assert!(write(arc((0.0, 0.0), (0.0002, 0.0), 0.5)).is_empty(), "shorter than the last digit");
    }

    #[test]
    fn an_arc_of_huge_radius_becomes_chords_on_it() {
        let segment = arc((0.0, 0.0), (100.0, 0.0), 0.01);
        let Segment::Arc { center, radius, .. } = segment else { panic!("an arc") };
        assert!(radius > MAX_RADIUS_MM);
        let written = write(segment);
        assert!(written.len() > 10);
        for piece in &written {
            let Piece::Line { to } = piece else { panic!("{piece:?}") };
            assert!(((to - center).norm() - radius).abs() < 1e-3);
        }
        assert_eq!(written[written.len() - 1], Piece::Line { to: P2::new(100.0, 0.0) });
    }
}
