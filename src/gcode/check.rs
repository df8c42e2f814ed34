//! What a machine would object to in a program.

use super::{Action, Beam, Move};
use crate::geom::{Rect, tolerance};

/// What the machine permits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckSettings {
    /// What the head may reach, mm in work coordinates.
    pub work_area: Rect,
    /// The S word of full power (GRBL $30).
    pub max_s: f64,
    /// Fastest rate of x, y and z, mm/min (GRBL $110-$112).
    pub max_rate_mm_per_min: [f64; 3],
}

/// One objection. Lines count from 1.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Finding {
    /// A move leaves the work area.
    #[error("line {line}: the move leaves the work area by {by_mm:.3} mm on its {side} side")]
    OutsideWorkArea {
        /// Line of the program.
        line: usize,
        /// "left", "right", "lower" or "upper".
        side: &'static str,
        /// How far, mm.
        by_mm: f64,
    },
    /// A travel with the beam commanded on.
    #[error("line {line}: a travel with the laser on at S{power_s}; write S0 or M5 before G0")]
    LaserOnTravel {
        /// Line of the program.
        line: usize,
        /// S word in effect.
        power_s: f64,
    },
    /// More power than there is.
    #[error("line {line}: S{power_s} is above the machine's full power S{max_s}")]
    PowerAboveMax {
        /// Line of the program.
        line: usize,
        /// S word in effect.
        power_s: f64,
        /// The machine's, GRBL $30.
        max_s: f64,
    },
    /// A feed no axis keeps up with; the controller would silently run slower.
    #[error("line {line}: F{feed_mm_per_min} asks more of axis {axis} than its {limit_mm_per_min} mm/min")]
    FeedAboveLimit {
        /// Line of the program.
        line: usize,
        /// Feed in effect, mm/min.
        feed_mm_per_min: f64,
        /// 'X', 'Y' or 'Z'.
        axis: char,
        /// The axis's, mm/min.
        limit_mm_per_min: f64,
    },
}

impl Finding {
    /// Stable word for scripts.
    pub fn code(&self) -> &'static str {
        match self {
            Finding::OutsideWorkArea { .. } => "outside-work-area",
            Finding::LaserOnTravel { .. } => "laser-on-travel",
            Finding::PowerAboveMax { .. } => "power-above-max",
            Finding::FeedAboveLimit { .. } => "feed-above-limit",
        }
    }

    /// Line of the program, from 1.
    pub fn line(&self) -> usize {
        match *self {
            Finding::OutsideWorkArea { line, .. }
            | Finding::LaserOnTravel { line, .. }
            | Finding::PowerAboveMax { line, .. }
            | Finding::FeedAboveLimit { line, .. } => line,
        }
    }
}

/// Everything the machine would object to, in the order of the program. A power or feed is reported where it first does harm, not again
/// on every move it stays in effect.
pub fn check(moves: &[Move], settings: &CheckSettings) -> Vec<Finding> {
    let mut findings = Vec::new();
    let (mut power_reported, mut feed_reported) = (None, None);
    for m in moves {
        findings.extend(outside(m, &settings.work_area));
        let line = m.line;
        let lit = m.beam != Beam::Off && m.power_s > 0.0;
        if m.action == Action::Rapid && lit && m.length_mm() > 0.0 {
            findings.push(Finding::LaserOnTravel { line, power_s: m.power_s });
        }
        if m.beam != Beam::Off && m.power_s > settings.max_s {
            if power_reported.replace(m.power_s) != Some(m.power_s) {
                findings.push(Finding::PowerAboveMax { line, power_s: m.power_s, max_s: settings.max_s });
            }
        } else {
            power_reported = None;
        }
        if let Some(finding) = too_fast(m, &settings.max_rate_mm_per_min)
            && feed_reported.replace(m.feed_mm_per_min) != Some(m.feed_mm_per_min)
        {
            findings.push(finding);
        }
    }
    findings
}

fn outside(m: &Move, work_area: &Rect) -> Option<Finding> {
    if matches!(m.action, Action::Dwell { .. } | Action::Stop) {
        return None;
    }
    let (side, by_mm) = work_area.overrun_by(&m.bounds());
    (by_mm > tolerance::LIMIT_SLACK_MM).then_some(Finding::OutsideWorkArea { line: m.line, side, by_mm })
}

fn too_fast(m: &Move, max_rate_mm_per_min: &[f64; 3]) -> Option<Finding> {
    let share = match m.action {
        Action::Line => (m.to - m.from).try_normalize(0.0)?.abs(),
        // Somewhere on the way an arc may run along either axis.
        Action::Arc { .. } => nalgebra::Vector3::new(1.0, 1.0, 0.0),
        _ => return None,
    };
    let axes = ['X', 'Y', 'Z'].into_iter().zip(share.iter()).zip(max_rate_mm_per_min);
    axes.filter(|((_, share), limit)| m.feed_mm_per_min * *share > **limit * (1.0 + 1e-9))
        .map(|((axis, _), limit)| Finding::FeedAboveLimit {
            line: m.line,
            feed_mm_per_min: m.feed_mm_per_min,
            axis,
            limit_mm_per_min: *limit,
        })
        .next()
}

#[cfg(test)]
mod tests {
    use super::super::{parse, trace};
    use super::*;

    fn findings(text: &str) -> Vec<Finding> {
        let settings = CheckSettings {
            work_area: Rect::from_size(400.0, 300.0),
            max_s: 1000.0,
            max_rate_mm_per_min: [6000.0, 3000.0, 600.0],
        };
        check(&trace(&parse(text).unwrap()).unwrap(), &settings)
    }

    #[test]
    fn a_good_program_is_left_in_peace() {
        assert_eq!(findings("M4S0\nG0X400Y300S0\nG1X0S1000F6000\nG0Y0S0\nM5\nG0X0S500"), []);
    }

    #[test]
    fn moves_beyond_the_work_area_are_found_arcs_and_travels_too() {
        let expected = Finding::OutsideWorkArea { line: 2, side: "right", by_mm: 0.5 };
        assert_eq!(
            findings("G0X10\nX400.5\nX400"),
            [expected, Finding::OutsideWorkArea { line: 3, side: "right", by_mm: 0.5 }]
        );
        let arc = findings("G0X10Y10\nG2X30Y10I10F100\nG3X50Y10I10F100");
        assert!(matches!(arc[..], []), "{arc:?}");
        let arc = findings("G0X10Y5\nG3X30Y5I10F100");
        assert!(
            matches!(arc[..], [Finding::OutsideWorkArea { line: 2, side: "lower", by_mm }] if (by_mm - 5.0).abs() < 1e-9)
        );
    }

    #[test]
    fn a_lit_travel_is_found_only_where_it_goes_somewhere() {
        assert_eq!(findings("M3S500\nG0X10"), [Finding::LaserOnTravel { line: 2, power_s: 500.0 }]);
        assert_eq!(findings("M3S500\nG0X0\nM5\nG0X10"), []);
    }

    #[test]
    fn power_and_feed_over_their_limits_are_reported_once_while_they_last() {
        let found = findings("M4S0\nG1X10S1200F100\nX20\nX30S900\nX40S1200");
        assert_eq!(
            found.iter().map(|f| (f.code(), f.line())).collect::<Vec<_>>(),
            [("power-above-max", 2), ("power-above-max", 5)]
        );
        let found = findings("G1X10F6500\nX20\nY10\nX100Y11F5000");
        assert_eq!(found.iter().map(|f| (f.code(), f.line())).collect::<Vec<_>>(), [("feed-above-limit", 1)]);
        assert!(matches!(
            findings("G1Y10F5000")[..],
            [Finding::FeedAboveLimit { axis: 'Y', limit_mm_per_min: 3000.0, .. }]
        ));
        assert!(matches!(findings("G3Y10J5F5000")[..], [Finding::FeedAboveLimit { line: 1, axis: 'Y', .. }]), "an arc");
    }
}
