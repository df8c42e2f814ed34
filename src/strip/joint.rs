//! The sizes of a joint; what is cut with them is in `shape`.

/// What fastens the passes of a joint to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fastening {
    /// A flap through slits, cut into the strip itself.
    Flap,
    /// Round holes for rivets, brass fasteners or thread.
    Holes {
        /// Diameter, mm.
        diameter_mm: f64,
    },
    /// Marked places for tape or glue; nothing is cut.
    Mark,
}

/// A joint, nominal, mm: a flap that goes through a slit and holds by two barbs (paper figure 4). Hinge line and slit lie across the strip, the flap points along it.
/// Other fastenings take the place of flap and slit and keep the distances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// What fastens it.
    pub fastening: Fastening,
    /// Narrowest strip that can carry one flap.
    pub min_width_mm: f64,
    /// Width of the neck.
    pub neck_mm: f64,
    /// How far the head stands out beyond the neck on each side.
    pub barb_mm: f64,
    /// From the hinge to the shoulders, for a flap that goes through one sheet.
    pub neck_length_mm: f64,
    /// From the shoulders to the tip.
    pub head_length_mm: f64,
    /// Width of the head at its tip.
    pub tip_width_mm: f64,
    /// Rounding of the tip's corners.
    pub tip_radius_mm: f64,
    /// How far the shoulders slope back toward the hinge, rad; less where the barbs are too small for it.
    pub shoulder_undercut_rad: f64,
    /// Rounding of the barbs.
    pub corner_radius_mm: f64,
    /// Radius of the hook that ends the open cut outside its root, so that no tear runs into the strip; 0 for none.
    pub hook_radius_mm: f64,
    /// Dashes that weaken the hinge.
    pub hinge: Option<Dashes>,
    /// Length of the slit across the strip, reliefs included.
    pub slit_length_mm: f64,
    /// Width of a slit cut as a closed slot; 0 for a plain line.
    pub slit_width_mm: f64,
    /// Diameter of the drop at each end of the slit that keeps it from tearing on; it lies within the slit's length, so that no barb slips through. 0 for none.
    pub slit_relief_mm: f64,
    /// The slit lies this much ahead of the hinge line.
    pub slit_ahead_mm: f64,
    /// Least distance to the strip's edge.
    pub edge_distance_mm: f64,
    /// Least distance between cuts of different joints.
    pub cut_distance_mm: f64,
    /// Strip beyond the first and the last connection point.
    pub end_tab_mm: f64,
    /// Thickness of the sheet.
    pub thickness_mm: f64,
    /// Least sheet behind the slit's end on each side of a head, when kerf is at its worst; below it a joint falls open.
    pub min_retention_mm: f64,
}

/// A dashed cut, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dashes {
    /// Length of a dash.
    pub cut_mm: f64,
    /// Length left between two dashes, and at least beside the first and last.
    pub gap_mm: f64,
}

/// What a flap needs in its neck beside the sheets it holds together, mm, when these are more than two (materials practice: 3 t + 1 at a splice).
const NECK_PLAY_MM: f64 = 1.0;
/// Size of the cross that marks a place for tape or glue, mm.
pub(super) const CROSS_MM: f64 = 6.0;

impl Joint {
    /// Width of the head over both barbs, mm.
    pub fn head_mm(&self) -> f64 {
        self.neck_mm + 2.0 * self.barb_mm
    }

    /// Extent across the strip of what is cut or marked at one seat, hooks included, mm.
    pub fn cut_out_mm(&self) -> f64 {
        match self.fastening {
            Fastening::Flap => self.head_mm().max(self.neck_mm + 4.0 * self.hook_radius_mm).max(self.slit_length_mm),
            Fastening::Holes { diameter_mm } => diameter_mm,
            Fastening::Mark => CROSS_MM,
        }
    }

    /// Narrowest bed of one flap with sheet enough on both sides, mm. A strip as narrow as it may be often leaves a little less than its own width: its middle wanders.
    pub fn least_bed_mm(&self) -> f64 {
        self.min_width_mm.min(self.cut_out_mm() + 2.0 * self.edge_distance_mm)
    }

    /// How far what is cut at one seat reaches behind its station and ahead of it, mm, on the pass that carries the flap.
    pub fn reach_both_ways_mm(&self, sheets: usize) -> (f64, f64) {
        match self.fastening {
            Fastening::Flap => (self.hook_radius_mm, self.reach_mm(sheets)),
            Fastening::Holes { .. } | Fastening::Mark => (0.5 * self.cut_out_mm(), 0.5 * self.cut_out_mm()),
        }
    }

    /// From the hinge to the shoulders of a flap that goes through `sheets` sheets, mm.
    pub fn neck_length_for(&self, sheets: usize) -> f64 {
        if sheets < 2 {
            return self.neck_length_mm;
        }
        self.neck_length_mm.max((sheets + 1) as f64 * self.thickness_mm + NECK_PLAY_MM)
    }

    /// How far a flap that goes through `sheets` sheets reaches beyond its hinge, mm.
    pub fn reach_mm(&self, sheets: usize) -> f64 {
        self.neck_length_for(sheets) + self.head_length_mm
    }

    /// Shortest stretch of strip between two joints, mm: a flap from one end, the slit of the other, and the distance between their cuts.
    pub fn min_section_mm(&self) -> f64 {
        self.reach_mm(2) + self.slit_ahead_mm + self.cut_distance_mm
    }

    /// How far ahead of the hinge line the slit in the `depth`-th sheet lies, mm: each sheet farther takes the flap one thickness more to get there.
    pub fn lead_mm(&self, depth: usize) -> f64 {
        if self.fastening != Fastening::Flap {
            return 0.0;
        }
        self.slit_ahead_mm + depth.saturating_sub(1) as f64 * self.thickness_mm
    }
}

#[cfg(test)]
pub(super) fn paper() -> Joint {
    Joint {
        fastening: Fastening::Flap,
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
        hinge: Some(Dashes { cut_mm: 1.0, gap_mm: 1.0 }),
        slit_length_mm: 8.8,
        slit_width_mm: 0.0,
        slit_relief_mm: 0.8,
        slit_ahead_mm: 0.5,
        edge_distance_mm: 4.0,
        cut_distance_mm: 8.0,
        end_tab_mm: 9.0,
        thickness_mm: 0.19,
        min_retention_mm: 0.6,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_sheets_get_a_longer_neck_and_a_slit_farther_ahead() {
        let joint = Joint { slit_ahead_mm: 0.4, thickness_mm: 0.1, ..paper() };
        assert_eq!(joint.neck_length_for(1), 1.6);
        assert!((Joint { neck_length_mm: 1.2, ..joint }.neck_length_for(2) - 1.3).abs() < 1e-12);
        assert!((joint.neck_length_for(8) - 1.9).abs() < 1e-12);
        assert!((joint.lead_mm(3) - 0.6).abs() < 1e-12);
        assert_eq!((joint.lead_mm(0), joint.lead_mm(1)), (0.4, 0.4));
    }
}
