//! What is known of machine and material before anything was measured, and how trials differ from it.

use crate::strip::Joint;

/// How fast and how strong a tool runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Feed, mm/min, above 0.
    pub feed_mm_per_min: f64,
    /// Power as a share of the machine's, 0..=1; 0 for blades.
    pub power: f64,
}

/// Values to start from.
#[derive(Debug, Clone, PartialEq)]
pub struct Shop {
    /// Name of the machine, for the card's title.
    pub machine: String,
    /// Name of the material, for the card's title.
    pub material: String,
    /// True for a beam: power and kerf can be measured.
    pub laser: bool,
    /// How the material is cut as far as is known.
    pub cut: Setting,
    /// How it is engraved; `None` where this tool leaves no marks.
    pub engrave: Option<Setting>,
    /// Least power the tool makes, share of full power.
    pub power_floor: f64,
    /// Fastest feed in every direction, mm/min.
    pub max_feed_mm_per_min: f64,
    /// The joint in use.
    pub joint: Joint,
    /// Height of letters, mm.
    pub letter_mm: f64,
    /// Mass per area, g/m².
    pub grammage_g_per_m2: f64,
    /// Distance between the card's edge and what is cut from it, mm.
    pub margin_mm: f64,
}

impl Setting {
    /// This setting with `factor` times its energy per length: a slower feed before more power, as thin sheet wants it. Where the feed would be faster than
    /// the machine, the power falls; it never falls below the tool's floor.
    pub fn with_energy(self, factor: f64, shop: &Shop) -> Setting {
        let wanted = self.feed_mm_per_min / factor;
        let feed_mm_per_min = wanted.min(shop.max_feed_mm_per_min);
        let power = (self.power * feed_mm_per_min / wanted).max(shop.power_floor).min(1.0);
        Setting { feed_mm_per_min, power }
    }

    /// Energy per length in units of the machine's full power, min/mm.
    pub fn energy(self) -> f64 {
        self.power / self.feed_mm_per_min
    }
}

impl Shop {
    /// Lengths by which the slits of the joint series are longer than the neck is wide, mm: from tight to as loose as still holds.
    pub fn slit_extras_mm(&self) -> [f64; 5] {
        let (tight, loose) = (0.2, 1.4);
        // With more the barbs have less behind them than holds.
        let holding = 2.0 * (self.joint.barb_mm - self.joint.min_retention_mm);
        let loose = holding.clamp(tight + 0.4, loose);
        std::array::from_fn(|i| ((tight + (loose - tight) * i as f64 / 4.0) * 100.0).round() / 100.0)
    }
}

#[cfg(test)]
pub(super) fn paper() -> Shop {
    Shop {
        machine: "diode-400".into(),
        material: "paper-160".into(),
        laser: true,
        cut: Setting { feed_mm_per_min: 1200.0, power: 0.5 },
        engrave: Some(Setting { feed_mm_per_min: 1800.0, power: 0.08 }),
        power_floor: 0.03,
        max_feed_mm_per_min: 10000.0,
        joint: crate::strip::Joint {
            fastening: crate::strip::Fastening::Flap,
            min_width_mm: 20.0,
            neck_mm: 8.0,
            barb_mm: 1.5,
            neck_length_mm: 1.6,
            head_length_mm: 7.0,
            tip_width_mm: 3.2,
            tip_radius_mm: 1.0,
            shoulder_undercut_rad: 0.17,
            corner_radius_mm: 0.6,
            hook_radius_mm: 0.8,
            hinge: Some(crate::strip::Dashes { cut_mm: 1.0, gap_mm: 1.0 }),
            slit_length_mm: 8.8,
            slit_width_mm: 0.0,
            slit_relief_mm: 0.8,
            slit_ahead_mm: 0.5,
            edge_distance_mm: 4.0,
            cut_distance_mm: 8.0,
            end_tab_mm: 9.0,
            thickness_mm: 0.19,
            min_retention_mm: 0.6,
        },
        letter_mm: 3.0,
        grammage_g_per_m2: 160.0,
        margin_mm: 10.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_energy_is_a_slower_feed_and_a_machine_at_its_limit_takes_less_power() {
        let shop = paper();
        let twice = shop.cut.with_energy(2.0, &shop);
        assert_eq!((twice.feed_mm_per_min, twice.power), (600.0, 0.5));
        let slow = Shop { max_feed_mm_per_min: 1500.0, ..paper() };
        let half = slow.cut.with_energy(0.5, &slow);
        assert_eq!(half.feed_mm_per_min, 1500.0);
        assert!((half.energy() / slow.cut.energy() - 0.5).abs() < 1e-12);
        let floored = Shop { power_floor: 0.4, ..slow };
        assert_eq!(floored.cut.with_energy(0.5, &floored).power, 0.4);
    }

    #[test]
    fn every_slit_of_the_series_still_holds() {
        assert_eq!(paper().slit_extras_mm(), [0.2, 0.5, 0.8, 1.1, 1.4]);
        let mut film = paper();
        film.joint.barb_mm = 1.0;
        assert_eq!(film.slit_extras_mm(), [0.2, 0.35, 0.5, 0.65, 0.8]);
    }
}
