//! What the machine does, one thing after the other.

use crate::geom::{P2, P3, Rect, V2, cross};

/// How the machine gets from one state to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// G0: as fast as the axes go.
    Rapid,
    /// G1: along a line at the feed.
    Line,
    /// G2 or G3: along an arc at the feed; z changes evenly.
    Arc {
        /// Centre, mm.
        center: P2,
        /// Radius at the start, mm.
        radius_mm: f64,
        /// Signed turn in rad, positive counter-clockwise.
        sweep_rad: f64,
    },
    /// G4: stands still.
    Dwell {
        /// For how long, s.
        seconds: f64,
    },
    /// Comes to rest, because the laser mode, the air or the program's flow changes.
    Stop,
}

/// What the laser does while it is commanded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beam {
    /// M5.
    Off,
    /// M3: the same power at any speed.
    Constant,
    /// M4: power follows the speed.
    Dynamic,
}

/// One thing the machine does, with the modal state it does it in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Line of the program, from 1.
    pub line: usize,
    /// What is done.
    pub action: Action,
    /// Where from, mm.
    pub from: P3,
    /// Where to, mm.
    pub to: P3,
    /// Feed in effect, mm/min; 0 before the first F word.
    pub feed_mm_per_min: f64,
    /// S word in effect.
    pub power_s: f64,
    /// Laser mode in effect.
    pub beam: Beam,
    /// The motion mode in effect is G1, G2 or G3, in which a constant beam is lit at rest too.
    pub feeding: bool,
    /// Bytes of its line as a sender sends it: without blanks and comments, with its line feed.
    pub bytes: usize,
}

impl Move {
    /// True for feed moves with the laser on. (In laser mode GRBL keeps it off in G0; whether a program relies on that is for
    /// [`super::check`] to say.)
    pub fn burns(&self) -> bool {
        self.feeds() && self.beam != Beam::Off && self.power_s > 0.0
    }

    /// True for what leaves a trace: a laser's burning moves, another tool's moves at a feed along the sheet.
    pub fn works(&self, laser: bool) -> bool {
        if laser {
            self.burns()
        } else {
            self.feeds() && (self.from.xy() != self.to.xy() || !matches!(self.action, Action::Line))
        }
    }

    /// True for moves at a feed: lines and arcs.
    pub fn feeds(&self) -> bool {
        matches!(self.action, Action::Line | Action::Arc { .. })
    }

    /// True for whatever is no rest.
    pub fn goes(&self) -> bool {
        !matches!(self.action, Action::Dwell { .. } | Action::Stop)
    }

    /// Length of the way, mm.
    pub fn length_mm(&self) -> f64 {
        match self.action {
            Action::Rapid | Action::Line => (self.to - self.from).norm(),
            Action::Arc { radius_mm, sweep_rad, .. } => (radius_mm * sweep_rad).hypot(self.to.z - self.from.z),
            Action::Dwell { .. } | Action::Stop => 0.0,
        }
    }

    /// The point a fraction `t` of the way along, mm.
    pub fn point_at(&self, t: f64) -> P3 {
        let straight = self.from + (self.to - self.from) * t;
        match self.action {
            Action::Arc { center, sweep_rad, .. } => {
                let p = center + nalgebra::Rotation2::new(sweep_rad * t) * (self.from.xy() - center);
                P3::new(p.x, p.y, straight.z)
            }
            _ => straight,
        }
    }

    /// The share of the way at which it comes nearest to a point, and how far off the point is, mm. Of places equally near the first counts.
    pub fn nearest(&self, p: P3) -> (f64, f64) {
        let way = self.to - self.from;
        let between = match self.action {
            Action::Arc { center, sweep_rad, .. } => {
                let (start, there) = (self.from.xy() - center, p.xy() - center);
                let turned = cross(start, there).atan2(start.dot(&there)) * sweep_rad.signum();
                turned.rem_euclid(std::f64::consts::TAU) / sweep_rad.abs()
            }
            _ if way.norm_squared() > 0.0 => (p - self.from).dot(&way) / way.norm_squared(),
            _ => 0.0,
        };
        let off = |t: f64| (self.point_at(t) - p).norm();
        let inside = (0.0..1.0).contains(&between).then_some(between);
        let places = [Some(0.0), inside, Some(1.0)].into_iter().flatten().map(|t| (t, off(t)));
        places.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0.0, off(0.0)))
    }

    /// The smallest box in the XY plane around the way, mm, arcs as far as they bulge.
    pub fn bounds(&self) -> Rect {
        let mut bounds = Rect::EMPTY.with(self.from.xy()).with(self.to.xy());
        if let Action::Arc { center, radius_mm, sweep_rad } = self.action {
            let start = self.from.xy() - center;
            for axis in [V2::x(), V2::y(), -V2::x(), -V2::y()] {
                let turn = cross(start, axis).atan2(start.dot(&axis)) * sweep_rad.signum();
                if turn.rem_euclid(std::f64::consts::TAU) <= sweep_rad.abs() {
                    bounds = bounds.with(center + axis * radius_mm);
                }
            }
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn arc(sweep_rad: f64) -> Move {
        let action = Action::Arc { center: P2::origin(), radius_mm: 2.0, sweep_rad };
        let (from, beam) = (P3::new(2.0, 0.0, 0.0), Beam::Dynamic);
        let to = P3::new(2.0 * sweep_rad.cos(), 2.0 * sweep_rad.sin(), 0.0);
        Move { line: 1, action, from, to, feed_mm_per_min: 600.0, power_s: 100.0, beam, feeding: true, bytes: 20 }
    }

    #[test]
    fn an_arc_bulges_beyond_its_ends_on_its_own_side() {
        let upper = arc(PI);
        assert!((upper.bounds().max.y - 2.0).abs() < 1e-12 && upper.bounds().min.y > -1e-9);
        assert!((arc(-PI).bounds().min.y + 2.0).abs() < 1e-12);
        let three_quarters = arc(1.5 * PI).bounds();
        assert!((three_quarters.min - P2::new(-2.0, -2.0)).norm() < 1e-9);
        assert!((upper.length_mm() - 2.0 * PI).abs() < 1e-12);
        assert!((upper.point_at(0.5) - P3::new(0.0, 2.0, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn the_nearest_place_of_a_way_is_on_it() {
        let line = Move { action: Action::Line, to: P3::new(2.0, 4.0, 0.0), ..arc(1.0) };
        let near = |m: &Move, x: f64, y: f64| m.nearest(P3::new(x, y, 0.0));
        assert_eq!(near(&line, 3.0, 1.0), (0.25, 1.0));
        assert_eq!(near(&line, 2.0, 9.0), (1.0, 5.0));
        let half = arc(PI);
        let (t, off) = near(&half, 0.0, 3.0);
        assert!((t - 0.5).abs() < 1e-12 && (off - 1.0).abs() < 1e-12);
        assert_eq!(near(&half, 2.0, -1.0), (0.0, 1.0), "behind its start");
        let (t, off) = near(&arc(-PI), 0.0, -2.5);
        assert!((t - 0.5).abs() < 1e-12 && (off - 0.5).abs() < 1e-12);
        let around = arc(2.0 * PI);
        assert_eq!(near(&around, 2.5, 0.0), (0.0, 0.5), "of start and end of a full circle the start");
    }

    #[test]
    fn only_feed_moves_with_power_burn() {
        assert!(arc(1.0).burns());
        assert!(!Move { beam: Beam::Off, ..arc(1.0) }.burns());
        assert!(!Move { power_s: 0.0, ..arc(1.0) }.burns());
        assert!(!Move { action: Action::Rapid, ..arc(1.0) }.burns());
    }
}
