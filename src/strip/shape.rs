//! The shape of one flap and its slit, and of what takes their place.

use super::joint::{CROSS_MM, Dashes, Joint};
use crate::drawing::{DrawnPath, KerfSide, Role};
use crate::geom::{P2, Path, PathVertex, V2};

impl Joint {
    /// The open cut that frees the flap: hinge line on x = 0 from (0, neck / 2) to (0, -neck / 2), tip toward +x, through one sheet. Runs from the root above round
    /// the tip to the root below, so that the flap lies on its right and the waste on its left.
    pub fn flap(&self) -> Path {
        self.flap_through(1)
    }

    /// [`Joint::flap`] with a neck for `sheets` sheets.
    pub fn flap_through(&self, sheets: usize) -> Path {
        let half = self.half_flap(self.neck_length_for(sheets));
        // Below, the same corners backwards: arcs turn the same way, each bulge belongs to the corner it starts at.
        let below = (0..half.len()).rev().map(|i| {
            let bulge = if i == 0 { 0.0 } else { half[i - 1].bulge };
            PathVertex { point: P2::new(half[i].point.x, -half[i].point.y), bulge }
        });
        let mut vertices: Vec<PathVertex> = half.iter().copied().chain(below).collect();
        let hook = self.hook_radius_mm;
        if hook > 0.0 {
            // A half circle, away from the flap and back toward its tip.
            let above = P2::new(0.0, 0.5 * self.neck_mm + 2.0 * hook);
            vertices.insert(0, PathVertex { point: above, bulge: 1.0 });
            if let Some(root) = vertices.last_mut() {
                root.bulge = 1.0;
            }
            vertices.push(PathVertex { point: P2::new(0.0, -above.y), bulge: 0.0 });
        }
        Path { vertices, closed: false }
    }

    /// The upper half of the flap's cut: root, shoulder, barb, tip. The barb is an arc that reaches exactly as far across as the barb is wide: a corner rounded
    /// afterwards would hold less than the head's width says.
    fn half_flap(&self, shoulder: f64) -> Vec<PathVertex> {
        let corner = |x: f64, y: f64| PathVertex { point: P2::new(x, y), bulge: 0.0 };
        let (neck, head, tip) = (0.5 * self.neck_mm, 0.5 * self.head_mm(), 0.5 * self.tip_width_mm);
        let r = self.corner_radius_mm.min(self.barb_mm);
        // The shoulder runs straight for (barb - r - r sin u) / cos u before the arc: no undercut may make that negative.
        let undercut = self.shoulder_undercut_rad.min((self.barb_mm / r.max(1e-9) - 1.0).min(1.0).asin());
        let (sin, cos) = undercut.sin_cos();
        let straight = (self.barb_mm - r - r * sin) / cos;
        let at = P2::new(shoulder, neck) + V2::new(-sin, cos) * straight;
        let center = at + V2::new(cos, sin) * r;
        debug_assert!((center.y + r - head).abs() < 1e-9);
        let end = P2::new(shoulder + self.head_length_mm, tip);
        // From the arc on to the tip's corner: the tangent from that corner, its rounding left out of account.
        let (away, distance) = (center - end, (center - end).norm());
        let lift = (r / distance).asin();
        let along = nalgebra::Rotation2::new(-lift) * (away / distance);
        let leave = end + along * (distance * lift.cos());
        let spoke = |p: P2| (p.y - center.y).atan2(p.x - center.x);
        let sweep = (spoke(leave) - spoke(at)).rem_euclid(std::f64::consts::TAU) - std::f64::consts::TAU;
        let corners = [
            (leave, 0.0),
            (end, self.tip_radius_mm),
            (P2::new(end.x, -tip), self.tip_radius_mm),
            (P2::new(leave.x, -leave.y), 0.0),
        ];
        let head_end = Path::rounded(&corners, false).vertices;
        let mut half = vec![corner(0.0, neck), corner(shoulder, neck)];
        if r > 0.0 {
            half.push(PathVertex { point: at, bulge: (sweep / 4.0).tan() });
        }
        // The middle of the tip is a straight line between two corners, so that half the corners are ours.
        half.extend(&head_end[..head_end.len() / 2]);
        half
    }

    /// Everything that is cut for one flap, hinge on the origin: the flap, then the dashes of its hinge.
    pub fn flap_cuts(&self, sheets: usize) -> Vec<DrawnPath> {
        let mut cuts = vec![cut(self.flap_through(sheets), Role::Flap, KerfSide::Left)];
        if let Some(Dashes { cut_mm, gap_mm }) = self.hinge {
            let pitch = cut_mm + gap_mm;
            let count = ((self.neck_mm - gap_mm) / pitch).max(0.0) as usize;
            let first = -0.5 * (count as f64 * pitch - gap_mm);
            cuts.extend((0..count).map(|i| {
                let from = first + i as f64 * pitch;
                let dash = Path::open([P2::new(0.0, from), P2::new(0.0, from + cut_mm)]);
                cut(dash, Role::Hole, KerfSide::On)
            }));
        }
        cuts
    }

    /// The slit, centred on the origin along y: a line, or a closed slot with a drop at each end. A line that ends in drops runs from the middle of one to the middle
    /// of the other; [`Joint::slit_cuts`] adds them.
    pub fn slit(&self) -> Path {
        let (half, wide) = (0.5 * self.slit_length_mm, 0.5 * self.slit_width_mm);
        let r = 0.5 * self.slit_relief_mm;
        if wide <= 0.0 {
            return Path::open([P2::new(0.0, r - half), P2::new(0.0, half - r)]);
        }
        if r <= wide {
            return Path::closed(
                [(-wide, -half), (wide, -half), (wide, half), (-wide, half)].map(|(x, y)| P2::new(x, y)),
            );
        }
        // Where the slot's sides meet the drop's circle, and how far round the drop goes from there: all but the mouth.
        let mouth = half - r - (r * r - wide * wide).sqrt();
        let sweep = std::f64::consts::TAU - 2.0 * (wide / r).asin();
        let bulge = (sweep / 4.0).tan();
        let vertices = [((wide, -mouth), 0.0), ((wide, mouth), bulge), ((-wide, mouth), 0.0), ((-wide, -mouth), bulge)];
        let vertices = vertices.into_iter().map(|((x, y), bulge)| PathVertex { point: P2::new(x, y), bulge });
        Path { vertices: vertices.collect(), closed: true }
    }

    /// Everything that is cut for one slit, centred on the origin.
    pub fn slit_cuts(&self) -> Vec<DrawnPath> {
        let slit = self.slit();
        let kerf = if slit.closed { KerfSide::Inside } else { KerfSide::On };
        let drops = !slit.closed && self.slit_relief_mm > 0.0;
        let r = 0.5 * self.slit_relief_mm;
        let mut cuts = vec![cut(slit, Role::Slit, kerf)];
        if drops {
            let at = 0.5 * self.slit_length_mm - r;
            cuts.extend([-at, at].map(|y| cut(Path::circle(P2::new(0.0, y), r), Role::Hole, KerfSide::Inside)));
        }
        cuts
    }

    /// The cross that marks a seat for tape or glue.
    pub fn cross(&self) -> [DrawnPath; 2] {
        let r = 0.5 * CROSS_MM;
        [(r, 0.0), (0.0, r)].map(|(x, y)| cut(Path::open([P2::new(-x, -y), P2::new(x, y)]), Role::Mark, KerfSide::On))
    }
}

/// A round hole on the origin.
pub(super) fn hole(diameter_mm: f64) -> DrawnPath {
    cut(Path::circle(P2::origin(), 0.5 * diameter_mm), Role::Hole, KerfSide::Inside)
}

fn cut(path: Path, role: Role, kerf: KerfSide) -> DrawnPath {
    DrawnPath { path, role, kerf, joint: None }
}

#[cfg(test)]
mod tests {
    use super::super::joint::paper;
    use super::*;
    use std::f64::consts::PI;

    fn film() -> Joint {
        Joint {
            barb_mm: 1.0,
            head_length_mm: 6.0,
            corner_radius_mm: 0.8,
            hook_radius_mm: 1.0,
            hinge: Some(Dashes { cut_mm: 1.5, gap_mm: 0.8 }),
            slit_length_mm: 8.7,
            slit_width_mm: 0.35,
            slit_relief_mm: 1.0,
            slit_ahead_mm: 0.4,
            thickness_mm: 0.1,
            ..paper()
        }
    }

    #[test]
    fn a_flap_is_as_wide_as_its_head_and_as_long_as_its_reach_barbs_rounded_or_not() {
        let blade = Joint { corner_radius_mm: 1.0, ..film() };
        for joint in [paper(), film(), blade, Joint { corner_radius_mm: 0.0, ..paper() }] {
            let bounds = Joint { hook_radius_mm: 0.0, ..joint }.flap().bounds();
            assert!((bounds.max.x - joint.reach_mm(1)).abs() < 1e-9);
            assert!((bounds.height() - joint.head_mm()).abs() < 1e-6, "{bounds:?}");
            assert_eq!(bounds.min.x, 0.0);
        }
        let hooked = paper().flap().bounds();
        assert!((hooked.min.x + 0.8).abs() < 1e-6 && (hooked.height() - 11.2).abs() < 1e-6, "{hooked:?}");
    }

    #[test]
    fn shoulders_slope_back_and_every_arc_has_the_radius_it_was_given() {
        let flap = Joint { hook_radius_mm: 0.0, ..paper() }.flap();
        let back = flap.vertices[2].point;
        assert!(back.x < 1.6 && back.y > 4.0, "{back}");
        let radii: Vec<f64> = flap
            .segments()
            .filter_map(|s| match s {
                crate::geom::Segment::Arc { radius, .. } => Some(radius),
                crate::geom::Segment::Line { .. } => None,
            })
            .collect();
        assert_eq!(radii.len(), 4, "{flap:?}");
        for (radius, wanted) in radii.iter().zip([0.6, 1.0, 1.0, 0.6]) {
            assert!((radius - wanted).abs() < 1e-9, "{radii:?}");
        }
    }

    #[test]
    fn the_flap_is_symmetric_and_lies_on_the_right_of_its_cut() {
        for joint in [paper(), film()] {
            let path = joint.flap();
            let n = path.vertices.len();
            for i in 0..n {
                let (a, b) = (path.vertices[i].point, path.vertices[n - 1 - i].point);
                assert!((a.x - b.x).abs() < 1e-12 && (a.y + b.y).abs() < 1e-12, "{a} {b}");
            }
            let mut closed = Joint { hook_radius_mm: 0.0, ..joint }.flap();
            closed.closed = true;
            assert!(closed.signed_area() < -40.0);
        }
    }

    #[test]
    fn hinge_dashes_keep_a_gap_to_the_flaps_roots() {
        for (joint, count) in [(paper(), 3), (film(), 3)] {
            let cuts = joint.flap_cuts(1);
            let dashes = joint.hinge.unwrap();
            assert_eq!(cuts.len(), 1 + count);
            assert!(cuts[1..].iter().all(|c| c.role == Role::Hole && c.kerf == KerfSide::On));
            assert!(cuts[1..].iter().all(|c| (c.path.length() - dashes.cut_mm).abs() < 1e-9));
            let (first, last) = (cuts[1].path.bounds(), cuts[count].path.bounds());
            assert!(first.min.y + 0.5 * joint.neck_mm >= dashes.gap_mm - 1e-9);
            assert!((first.min.y + last.max.y).abs() < 1e-9, "dashes lie in the middle");
        }
    }

    #[test]
    fn reliefs_lie_within_the_slits_length_so_the_head_keeps_its_hold() {
        for joint in [paper(), film(), Joint { slit_width_mm: 0.35, slit_relief_mm: 0.0, ..film() }] {
            let cuts = joint.slit_cuts();
            let bounds = cuts.iter().fold(crate::geom::Rect::EMPTY, |r, c| r.union(c.path.bounds()));
            assert!((bounds.height() - joint.slit_length_mm).abs() < 1e-9, "{bounds:?}");
        }
        let slot = film().slit();
        assert!(slot.closed);
        // Two drops of 1 mm, less the lens where each runs over the slot, and the slot between them.
        let mouth: f64 = 2.0 * (4.35 - 0.5 - (0.25 - 0.175f64.powi(2)).sqrt());
        let segment = 0.25 * ((0.35f64).asin() - 0.35 * (1.0 - 0.35f64.powi(2)).sqrt());
        let expected = 0.35 * mouth + 2.0 * (0.25 * PI - segment);
        assert!((slot.signed_area() - expected).abs() < 1e-9, "{} {expected}", slot.signed_area());
        let plain = Joint { slit_relief_mm: 0.0, ..paper() }.slit_cuts();
        assert_eq!((plain.len(), plain[0].path.length()), (1, 8.8));
    }
}
