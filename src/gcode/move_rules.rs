//! Objections to moves: where they go, how fast they are asked to be, what the beam does in them.

use super::check::{CheckSettings, Notes};
use super::{Action, Beam, Move};
use crate::geom::{P2, Rect, tolerance};

/// Pieces an arc is looked at in, for keep-outs: of a circle of 100 mm radius, chords leave it by less than 0.5 mm.
const ARC_PIECES: u32 = 64;

/// What is still in effect and has been told.
#[derive(Debug, Default)]
pub(super) struct MoveRules {
    power_told: Option<f64>,
    feed_told: Option<f64>,
    lit_travel_told: Option<f64>,
}

impl MoveRules {
    /// Looks at a move. A power or feed is told where it first does harm, not again on every move it stays in effect.
    pub(super) fn judge(&mut self, m: &Move, settings: &CheckSettings, notes: &mut Notes) {
        let line = m.line;
        if m.goes() {
            within_reach(m, settings, notes);
            for (name, rect) in &settings.keep_outs {
                if m.bounds().overlaps(rect) && crosses(m, rect) {
                    notes.errors.add(line, 1, "keep-out", || {
                        format!("the move runs into {name:?}, which stands at X{} Y{} to X{} Y{} mm; move the job or take it away", rect.min.x, rect.min.y, rect.max.x, rect.max.y)
                    });
                }
            }
        }
        if settings.laser {
            self.lit_travel(m, settings, notes);
        }
        if m.beam == Beam::Off || m.power_s <= settings.max_s {
            self.power_told = None;
        } else if self.power_told.replace(m.power_s) != Some(m.power_s) {
            let max_s = settings.max_s;
            notes.errors.add(line, 1, "power-above-max", || {
                format!("S{} is above the machine's full power S{max_s} ($30); set the program that wrote the file to S{max_s}", m.power_s)
            });
        }
        let feed = Some(m.feed_mm_per_min);
        let Some((axis, limit)) = too_fast(m, &settings.limits.max_rate_mm_per_min) else {
            // The same feed along a faster axis is still the feed that was told.
            if m.feeds() && self.feed_told != feed {
                self.feed_told = None;
            }
            return;
        };
        if std::mem::replace(&mut self.feed_told, feed) != feed {
            notes.errors.add(line, 1, "feed-above-limit", || {
                format!("F{} asks more of axis {axis} than its {limit} mm/min; the machine would run slower than the job means", m.feed_mm_per_min)
            });
        }
    }

    /// A travel with the beam commanded on. In laser mode GRBL keeps it off in G0, though its kin do not always under M3.
    fn lit_travel(&mut self, m: &Move, settings: &CheckSettings, notes: &mut Notes) {
        if m.beam == Beam::Off || m.power_s <= 0.0 {
            self.lit_travel_told = None;
        }
        if m.action != Action::Rapid || m.beam == Beam::Off || m.power_s <= 0.0 || m.length_mm() == 0.0 {
            return;
        }
        let (line, s) = (m.line, m.power_s);
        if m.beam == Beam::Constant || !settings.laser_mode {
            notes.errors.add(line, 1, "laser-on-travel", || {
                format!("a travel with the laser on at S{s}; write S0 or M5 before G0")
            });
        } else if self.lit_travel_told.replace(s) != Some(s) {
            notes.warnings.add(line, 1, "laser-on-travel", || {
                format!("travels while S{s} stays in effect: only laser mode ($32 = 1) keeps the beam off in G0; S0 in the G0 line is safer")
            });
        }
    }

    /// Looks at what is left on at the end of the file.
    pub(super) fn end(&self, lines: usize, (beam, power_s): (Beam, f64), settings: &CheckSettings, notes: &mut Notes) {
        if !settings.laser {
            return;
        }
        match beam {
            Beam::Constant if power_s > 0.0 => notes.errors.add(lines, 1, "laser-left-on", || {
                format!(
                    "the file ends with M3 on at S{power_s}: the beam would go on burning where it stands; end with M5"
                )
            }),
            Beam::Constant | Beam::Dynamic => {
                notes.warnings.add(lines, 1, "laser-left-on", || "the file ends without M5; end with M5 or M2".into())
            }
            Beam::Off => {}
        }
    }
}

fn within_reach(m: &Move, settings: &CheckSettings, notes: &mut Notes) {
    let (side, by_mm) = settings.work_area.overrun_by(&m.bounds());
    let z_mm = m.to.z.abs() - settings.travel_z_mm;
    if by_mm > tolerance::LIMIT_SLACK_MM {
        notes.errors.add(m.line, 1, "outside-work-area", || {
            format!("the move leaves the work area by {by_mm:.3} mm on its {side} side; move or shrink the job")
        });
    } else if z_mm > tolerance::LIMIT_SLACK_MM {
        notes.errors.add(m.line, 1, "outside-work-area", || {
            format!("Z{} is more than the {} mm that axis travels", m.to.z, settings.travel_z_mm)
        });
    }
}

fn too_fast(m: &Move, max_rate_mm_per_min: &[f64; 3]) -> Option<(char, f64)> {
    let share = match m.action {
        Action::Line => (m.to - m.from).try_normalize(0.0)?.abs(),
        // Somewhere on the way an arc may run along either axis.
        Action::Arc { .. } => nalgebra::Vector3::new(1.0, 1.0, 0.0),
        _ => return None,
    };
    let axes = ['X', 'Y', 'Z'].into_iter().zip(share.iter()).zip(max_rate_mm_per_min);
    axes.filter(|((_, share), limit)| m.feed_mm_per_min * *share > **limit * (1.0 + 1e-9))
        .map(|((axis, _), limit)| (axis, *limit))
        .next()
}

/// True when the way runs through a box.
fn crosses(m: &Move, rect: &Rect) -> bool {
    let pieces = if matches!(m.action, Action::Arc { .. }) { ARC_PIECES } else { 1 };
    let at = |k: u32| m.point_at(f64::from(k) / f64::from(pieces)).xy();
    (0..pieces).any(|k| clips(at(k), at(k + 1), rect))
}

/// True when a segment has a point within a box (its borders shut out): the shares of the segment within both slabs overlap.
fn clips(from: P2, to: P2, rect: &Rect) -> bool {
    let mut share = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (start, step) = (from[axis], to[axis] - from[axis]);
        if step == 0.0 {
            if start <= rect.min[axis] || start >= rect.max[axis] {
                return false;
            }
            continue;
        }
        let (a, b) = ((rect.min[axis] - start) / step, (rect.max[axis] - start) / step);
        share = (share.0.max(a.min(b)), share.1.min(a.max(b)));
    }
    share.0 < share.1
}
