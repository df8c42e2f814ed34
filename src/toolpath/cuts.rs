//! What is to be made, before it is known in which order: compensated paths with the stretches that are left out of them.

use super::bridges;
use super::{Error, Settings, common, kerf, knife, smooth};
use crate::drawing::{Drawing, KerfSide, Operation, Role};
use crate::geom::{Path, Rect};
use crate::progress::Warning;
use std::ops::Range;

/// One path to be made.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cut {
    /// What the middle of the tool follows, kerf included, mm in the work frame.
    pub path: Path,
    /// When it is made.
    pub operation: Operation,
    /// What it is for.
    pub role: Role,
    /// Name of the piece it belongs to.
    pub piece: String,
    /// The joint it belongs to, if any.
    pub joint: Option<String>,
    /// Whether the waste lies on the left of the path; `None` where there is none.
    pub waste_left: Option<bool>,
    /// Stretches left out, mm along the path, ascending and apart; on a closed path the last may reach over the seam.
    pub gaps: Vec<Range<f64>>,
    /// Length of feed it is made in, from 0; all 0 on a bed.
    pub window: usize,
}

/// Everything to be made, and what came of it.
pub(super) struct Cuts {
    pub cuts: Vec<Cut>,
    pub max_kerf_deviation_mm: f64,
    pub max_curve_deviation_mm: f64,
    pub warnings: Vec<Warning>,
}

/// Compensates every path of `drawings`, which lie in the work frame, and decides what is left out of it. `feed_of` tells how far along the feed a
/// box reaches, mm.
pub(super) fn cuts(drawings: &[Drawing], settings: &Settings, feed_of: &dyn Fn(&Rect) -> f64) -> Result<Cuts, Error> {
    let mut made =
        Cuts { cuts: Vec::new(), max_kerf_deviation_mm: 0.0, max_curve_deviation_mm: 0.0, warnings: Vec::new() };
    let mut details = knife::Details::default();
    for drawing in drawings {
        let window = settings.window_mm.map_or(0, |window| (feed_of(&drawing.bounds()) / window).max(0.0) as usize);
        for drawn in &drawing.paths {
            let operation = drawn.role.operation();
            if !settings.share.holds(operation) {
                continue;
            }
            if settings.process(operation).is_none() {
                return Err(Error::NoProcess { piece: drawing.name.clone(), role: drawn.role.class() });
            }
            let compensated = kerf::compensate(drawn, &drawing.name, settings.kerf_mm)?;
            let (mut path, off) = smooth::smooth(&compensated.path, settings.curve_tolerance_mm);
            if settings.blade_mm() > 0.0 && operation != Operation::Engrave {
                match details.simplified(path, settings.blade_mm(), &drawing.name) {
                    Some(simple) => path = simple,
                    None => continue,
                }
            }
            made.max_kerf_deviation_mm = made.max_kerf_deviation_mm.max(compensated.deviation_mm);
            made.max_curve_deviation_mm = made.max_curve_deviation_mm.max(off);
            let outside_left = path.signed_area() < 0.0;
            made.cuts.push(Cut {
                waste_left: match drawn.kerf {
                    KerfSide::On => None,
                    KerfSide::Left => Some(true),
                    KerfSide::Right => Some(false),
                    KerfSide::Outside => Some(outside_left),
                    KerfSide::Inside => Some(!outside_left),
                },
                path,
                operation,
                role: drawn.role,
                piece: drawing.name.clone(),
                joint: drawn.joint.clone(),
                gaps: Vec::new(),
                window,
            });
        }
    }
    made.warnings.extend(details.warning());
    if settings.common_edges {
        common::share(&mut made.cuts);
    }
    if let Some(wanted) = &settings.bridges {
        made.warnings.extend(bridges::place(&mut made.cuts, drawings, wanted, settings.kerf_mm));
    }
    made.cuts.sort_by_key(|cut| (cut.window, cut.operation));
    Ok(made)
}

impl Cut {
    /// The stretches that are made, mm along the path: one after each gap. A closed path without gaps is one stretch once around from its start.
    pub fn made(&self) -> Vec<Range<f64>> {
        let total = self.path.length();
        let n = self.gaps.len();
        if n == 0 {
            return std::iter::once(0.0..total).collect();
        }
        let between =
            |k: usize| self.gaps[k].end..if k + 1 < n { self.gaps[k + 1].start } else { self.gaps[0].start + total };
        let stretches: Vec<Range<f64>> = if self.path.closed {
            (0..n).map(between).collect()
        } else {
            let inner = (0..n - 1).map(between);
            std::iter::once(0.0..self.gaps[0].start)
                .chain(inner)
                .chain(std::iter::once(self.gaps[n - 1].end..total))
                .collect()
        };
        stretches.into_iter().filter(|s| s.end - s.start > LEAST_STRETCH_MM).collect()
    }

    /// Leaves `gap` out too; overlapping gaps become one.
    pub fn leave_out(&mut self, gap: Range<f64>) {
        let total = self.path.length();
        let shift = if self.path.closed { gap.start.rem_euclid(total) - gap.start } else { 0.0 };
        self.gaps.push(gap.start + shift..gap.end + shift);
        self.gaps.sort_by(|a, b| a.start.total_cmp(&b.start));
        self.gaps.dedup_by(|next, kept| {
            let joins = next.start <= kept.end;
            if joins {
                kept.end = kept.end.max(next.end);
            }
            joins
        });
    }
}

/// What is shorter than this, mm, is not worth putting the tool down for.
const LEAST_STRETCH_MM: f64 = 0.05;

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::geom::P2;

    pub(crate) fn cut(path: Path, role: Role) -> Cut {
        let waste_left = path.closed.then(|| path.signed_area() < 0.0);
        Cut {
            path,
            operation: role.operation(),
            role,
            piece: "A1".into(),
            joint: None,
            waste_left,
            gaps: Vec::new(),
            window: 0,
        }
    }

    fn square() -> Path {
        Path::closed([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|(x, y)| P2::new(x, y)))
    }

    #[test]
    fn what_is_made_and_what_is_left_out_add_up_to_the_path() {
        for path in [square(), Path::open([P2::new(0.0, 0.0), P2::new(40.0, 0.0)])] {
            let mut cut = cut(path, Role::Outline);
            for gap in [5.0..6.0, 20.0..21.0, 5.5..7.0, 12.0..13.5] {
                cut.leave_out(gap);
            }
            assert_eq!(cut.gaps.len(), 3);
            let made: f64 = cut.made().iter().map(|s| s.end - s.start).sum();
            assert!((made - (40.0 - 2.0 - 1.0 - 1.5)).abs() < 1e-9);
        }
    }

    #[test]
    fn a_gap_over_the_seam_starts_the_first_stretch_behind_it() {
        let mut cut = cut(square(), Role::Outline);
        cut.leave_out(-1.0..1.0);
        assert_eq!(cut.made(), vec![41.0..79.0]);
    }
}
