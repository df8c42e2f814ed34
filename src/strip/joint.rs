//! The shape of one flap and its slit.

use crate::geom::{P2, Path, PathVertex};

/// A flap that goes through a slit and holds by two barbs (paper figure 4), nominal, mm. Hinge line and slit lie across the strip, the flap points along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Narrowest strip that can carry one flap.
    pub min_width_mm: f64,
    /// Width of the neck.
    pub neck_mm: f64,
    /// How far the head stands out beyond the neck on each side.
    pub barb_mm: f64,
    /// From the hinge to the shoulders.
    pub neck_length_mm: f64,
    /// From the shoulders to the tip.
    pub head_length_mm: f64,
    /// Width of the head at its tip.
    pub tip_width_mm: f64,
    /// Rounding of the tip's corners.
    pub tip_radius_mm: f64,
    /// How far the shoulders slope back toward the hinge, rad.
    pub shoulder_undercut_rad: f64,
    /// Rounding of the barbs' corners.
    pub corner_radius_mm: f64,
    /// Radius of the hook that ends the open cut outside its root, so that no tear runs into the strip; 0 for none.
    pub hook_radius_mm: f64,
    /// Length of the slit across the strip.
    pub slit_length_mm: f64,
    /// Width of a slit cut as a closed slot; 0 for a plain line.
    pub slit_width_mm: f64,
    /// The slit lies this much ahead of the hinge line.
    pub slit_ahead_mm: f64,
    /// Least distance to the strip's edge.
    pub edge_distance_mm: f64,
    /// Least distance between cuts of different joints.
    pub cut_distance_mm: f64,
    /// Strip beyond the first and the last connection point.
    pub end_tab_mm: f64,
}

impl Joint {
    /// Width of the head over both barbs, mm.
    pub fn head_mm(&self) -> f64 {
        self.neck_mm + 2.0 * self.barb_mm
    }

    /// How far the flap reaches beyond its hinge, mm.
    pub fn reach_mm(&self) -> f64 {
        self.neck_length_mm + self.head_length_mm
    }

    /// Shortest stretch of strip between two joints, mm: a flap from one end, the slit of the other, and the distance between their cuts.
    pub fn min_section_mm(&self) -> f64 {
        self.reach_mm() + self.slit_ahead_mm + self.cut_distance_mm
    }

    /// How far the neck can shift in its slit, mm.
    pub fn play_mm(&self) -> f64 {
        self.slit_length_mm - self.neck_mm
    }

    /// Number of flaps side by side in a strip `width_mm` wide: one below 45 mm, two up to 100, then one per 50; fewer where their heads and hooks would come too
    /// close to the edges or to each other.
    pub fn count(&self, width_mm: f64) -> usize {
        let wanted = match width_mm {
            w if w < 45.0 => 1,
            w if w <= 100.0 => 2,
            w => (w / 50.0).ceil() as usize,
        };
        let flap = self.head_mm().max(self.neck_mm + 4.0 * self.hook_radius_mm);
        // Flaps lie in the middles of equal lanes.
        let lane = (flap + self.cut_distance_mm).max(flap + 2.0 * self.edge_distance_mm);
        wanted.min((width_mm / lane) as usize).max(1)
    }

    /// The open cut that frees the flap: hinge line on x = 0 from (0, neck / 2) to (0, -neck / 2), tip toward +x. Runs from the root above round the tip to the root
    /// below, so that the flap lies on its right and the waste on its left.
    pub fn flap(&self) -> Path {
        let neck = 0.5 * self.neck_mm;
        let shoulder = self.neck_length_mm;
        let back = self.barb_mm * self.shoulder_undercut_rad.tan();
        let side = |sign: f64| {
            [
                (P2::new(0.0, sign * neck), 0.0),
                (P2::new(shoulder, sign * neck), 0.0),
                (P2::new(shoulder - back, sign * (neck + self.barb_mm)), self.corner_radius_mm),
                (P2::new(shoulder + self.head_length_mm, sign * 0.5 * self.tip_width_mm), self.tip_radius_mm),
            ]
        };
        let corners: Vec<(P2, f64)> = side(1.0).into_iter().chain(side(-1.0).into_iter().rev()).collect();
        let mut path = Path::rounded(&corners, false);
        let hook = self.hook_radius_mm;
        if hook > 0.0 {
            // A half circle, away from the flap and back toward its tip.
            let above = P2::new(0.0, neck + 2.0 * hook);
            path.vertices.insert(0, PathVertex { point: above, bulge: 1.0 });
            if let Some(root) = path.vertices.last_mut() {
                root.bulge = 1.0;
            }
            path.vertices.push(PathVertex { point: P2::new(0.0, -above.y), bulge: 0.0 });
        }
        path
    }

    /// The slit, centred on the origin along y: a line, or a closed slot.
    pub fn slit(&self) -> Path {
        let (half, wide) = (0.5 * self.slit_length_mm, 0.5 * self.slit_width_mm);
        if wide > 0.0 {
            Path::closed([(-wide, -half), (wide, -half), (wide, half), (-wide, half)].map(|(x, y)| P2::new(x, y)))
        } else {
            Path::open([P2::new(0.0, -half), P2::new(0.0, half)])
        }
    }
}

#[cfg(test)]
pub(super) fn paper() -> Joint {
    Joint {
        min_width_mm: 20.0,
        neck_mm: 8.0,
        barb_mm: 1.5,
        neck_length_mm: 1.6,
        head_length_mm: 7.0,
        tip_width_mm: 3.2,
        tip_radius_mm: 1.0,
        shoulder_undercut_rad: 10_f64.to_radians(),
        corner_radius_mm: 0.6,
        hook_radius_mm: 0.8,
        slit_length_mm: 8.8,
        slit_width_mm: 0.0,
        slit_ahead_mm: 0.5,
        edge_distance_mm: 4.0,
        cut_distance_mm: 8.0,
        end_tab_mm: 9.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flap_is_as_wide_as_its_head_and_as_long_as_its_reach() {
        let joint = paper();
        let bounds = joint.flap().bounds();
        assert!((bounds.max.x - joint.reach_mm()).abs() < 1e-9);
        assert!((bounds.min.x + joint.hook_radius_mm).abs() < 1e-6, "{bounds:?}");
        assert!((bounds.height() - 2.0 * (4.0 + 1.6)).abs() < 1e-6, "{bounds:?}");
        let without_hooks = Joint { hook_radius_mm: 0.0, ..joint }.flap().bounds();
        // The barbs' corners are rounded, which takes off less than the radius.
        assert!((10.0..=11.0).contains(&without_hooks.height()), "{without_hooks:?}");
        assert_eq!(without_hooks.min.x, 0.0);
    }

    #[test]
    fn the_flap_lies_on_the_right_of_its_cut() {
        let mut closed = Joint { hook_radius_mm: 0.0, ..paper() }.flap();
        closed.closed = true;
        assert!(closed.signed_area() < -40.0);
    }

    #[test]
    fn the_head_is_wider_than_the_slit_and_the_slit_than_the_neck() {
        let joint = paper();
        assert!(joint.head_mm() > joint.slit_length_mm);
        assert!((joint.play_mm() - 0.8).abs() < 1e-12);
        assert_eq!(joint.slit().length(), 8.8);
        let slot = Joint { slit_width_mm: 0.35, ..joint }.slit();
        assert!((slot.signed_area() - 0.35 * 8.8).abs() < 1e-12);
    }

    #[test]
    fn wide_strips_get_more_flaps() {
        let counts = [30.0, 45.0, 100.0, 101.0, 160.0].map(|w| paper().count(w));
        assert_eq!(counts, [1, 2, 2, 3, 4]);
        // A felt joint is wide: two do not fit side by side where two of paper do.
        let felt = Joint { neck_mm: 13.0, barb_mm: 3.0, edge_distance_mm: 8.0, cut_distance_mm: 12.0, ..paper() };
        assert_eq!((felt.count(46.0), felt.count(80.0)), (1, 2));
    }
}
