//! How firmly a joint holds once it is cut: nominal sizes, and what kerf and thickness make of them.

use super::Error;
use super::joint::{Fastening, Joint};
use crate::geom::tolerance;

/// A kerf is known to within this, mm: lenses foul, beds tilt (materials practice).
const KERF_TOLERANCE_MM: f64 = 0.05;
/// And a thickness to within this share (materials practice).
const THICKNESS_TOLERANCE: f64 = 0.1;

/// Worst cases of a joint as cut, mm, over a kerf off by 0.05 mm and a sheet 10 % thicker or thinner than they are said to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// Least sheet behind the slit's end on each side of the head. At 0 the joint falls open.
    pub retention_mm: f64,
    /// Farthest that a neck can shift along its slit, across the strip.
    pub play_mm: f64,
    /// Least room of the neck beside the sheets it holds together; below 0 the head does not come through.
    pub slack_mm: f64,
    /// Most of that room: how far the two sheets can move apart, along the strip.
    pub most_slack_mm: f64,
}

impl Joint {
    /// What the joint amounts to when it is cut with `kerf_mm`. A closed cut and a flap come out at their nominal size when the kerf is what it is said to be, and are
    /// off by the kerf's error when not: holes larger, flaps smaller. A plain slit is followed along its middle and comes out a kerf longer than it is drawn.
    pub fn hold(&self, kerf_mm: f64) -> Hold {
        let plain = self.slit_width_mm <= 0.0 && self.slit_relief_mm <= 0.0;
        let slit = self.slit_length_mm + if plain { kerf_mm } else { 0.0 };
        let sheets_mm = 2.0 * self.thickness_mm;
        Hold {
            retention_mm: 0.5 * (self.head_mm() - KERF_TOLERANCE_MM - slit - KERF_TOLERANCE_MM),
            play_mm: slit + KERF_TOLERANCE_MM - (self.neck_mm - KERF_TOLERANCE_MM),
            slack_mm: self.neck_length_mm - sheets_mm * (1.0 + THICKNESS_TOLERANCE),
            most_slack_mm: self.neck_length_mm - sheets_mm * (1.0 - THICKNESS_TOLERANCE),
        }
    }

    /// Refuses a flap that would slip out of its slit, or not close, once cut with `kerf_mm`. Other fastenings bring their own hold.
    pub(super) fn check(&self, kerf_mm: f64) -> Result<(), Error> {
        if self.fastening != Fastening::Flap {
            return Ok(());
        }
        let hold = self.hold(kerf_mm);
        if hold.retention_mm < self.min_retention_mm - tolerance::LIMIT_SLACK_MM {
            let least_mm = self.min_retention_mm;
            return Err(Error::FallsOpen { retention_mm: hold.retention_mm, least_mm, kerf_mm });
        }
        if hold.slack_mm < 0.0 {
            return Err(Error::NeckShort { short_mm: -hold.slack_mm, thickness_mm: self.thickness_mm });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::joint::paper;
    use super::*;

    #[test]
    fn a_plain_slit_grows_by_the_kerf_and_one_with_drops_does_not() {
        let dropped = paper().hold(0.15);
        assert!((dropped.retention_mm - (1.1 - 0.05)).abs() < 1e-12);
        assert!((dropped.play_mm - 0.9).abs() < 1e-12);
        let plain = Joint { slit_relief_mm: 0.0, ..paper() }.hold(0.15);
        assert!((plain.retention_mm - (1.1 - 0.05 - 0.075)).abs() < 1e-12);
        assert!((plain.play_mm - 1.05).abs() < 1e-12);
    }

    #[test]
    fn two_thicker_sheets_leave_the_neck_less_room() {
        let hold = paper().hold(0.15);
        assert!((hold.slack_mm - (1.6 - 0.418)).abs() < 1e-12 && (hold.most_slack_mm - (1.6 - 0.342)).abs() < 1e-12);
        assert!(Joint { thickness_mm: 0.8, ..paper() }.hold(0.15).slack_mm < 0.0);
    }
}
