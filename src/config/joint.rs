//! The geometry of a flap and its slit, one table per kind of tool in a profile.
//!
//! The strip meets itself at a connection point; there a flap, cut open and left hinged, goes through a slit and holds by two barbs.
//! Hinge line and slit lie across the strip, the flap points along it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::machine::ToolClass;
use super::making::JointKind;

/// Joint geometry per kind of tool: a blade turns no small radius and cuts no closed slot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Joints {
    /// What fastens joints, unless the design says otherwise.
    #[serde(default)]
    pub kind: JointKind,
    /// Where joints are fastened through holes.
    #[serde(default)]
    pub holes: Holes,
    /// For diode and CO2 lasers.
    pub laser: Joint,
    /// For drag knives, and for scissors along drawn lines.
    pub knife: Joint,
}

/// Holes that take the place of flap and slit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Holes {
    /// Diameter: 3.2 for 3 mm rivets, 4.2 for brass fasteners.
    pub diameter_mm: f64,
    /// Least distance of a hole's middle to the strip's edge.
    pub edge_mm: f64,
}

impl Default for Holes {
    /// For 3 mm rivets (materials practice).
    fn default() -> Holes {
        Holes { diameter_mm: 3.2, edge_mm: 5.0 }
    }
}

/// A flap and its slit, nominal (before kerf).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Where the values come from.
    pub source: String,
    /// Narrowest strip that can carry one flap.
    pub min_width_mm: f64,
    /// Strip width from which the joint is comfortable to close.
    pub good_width_mm: f64,
    /// Width of the neck at the hinge, across the strip.
    pub neck_mm: f64,
    /// How far the head stands out beyond the neck on each side.
    pub barb_mm: f64,
    /// The slit is this much longer than the neck is wide.
    pub slit_extra_mm: f64,
    /// Least hold of each barb behind the slit's end, whatever kerf and thickness come out as: with less the joint falls open.
    pub min_retention_mm: f64,
    /// Width of a slit cut as a closed slot; absent: the slit is one plain line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slit_width_mm: Option<f64>,
    /// From the hinge to the shoulders: two sheets and some play.
    pub neck_length_mm: f64,
    /// From the shoulders to the tip.
    pub head_length_mm: f64,
    /// Width of the head at its tip.
    pub tip_width_mm: f64,
    /// Rounding of the tip's corners.
    pub tip_radius_mm: f64,
    /// How far the shoulders slope back towards the hinge, so that the barbs hook.
    pub shoulder_undercut_deg: f64,
    /// Rounding of the barbs' corners.
    pub corner_radius_mm: f64,
    /// Radius of the hook, outward and back towards the tip, that ends the open cut, so that no tear runs into the strip; absent: no hook.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hook_radius_mm: Option<f64>,
    /// Diameter of the drop-shaped relief at each end of the slit, within its length; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slit_relief_mm: Option<f64>,
    /// Dashes along the hinge line; absent: the hinge is not weakened. Never scored: scored flaps fold one way only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hinge: Option<Dashes>,
    /// The slit lies this much ahead of the hinge line of its flap, along the strip.
    pub slit_ahead_mm: f64,
    /// Least distance to the strip's edge.
    pub edge_distance_mm: f64,
    /// Least distance to any other cut.
    pub cut_distance_mm: f64,
    /// Strip beyond the first and the last connection point.
    pub end_tab_mm: f64,
}

/// A dashed cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dashes {
    /// Length of a dash.
    pub cut_mm: f64,
    /// Length left between two dashes.
    pub gap_mm: f64,
}

impl Joints {
    /// The table for a tool.
    pub fn for_tool(&self, class: ToolClass) -> &Joint {
        if class.is_laser() { &self.laser } else { &self.knife }
    }
}

impl Joint {
    /// Width of the head over both barbs, mm.
    pub fn head_mm(&self) -> f64 {
        self.neck_mm + 2.0 * self.barb_mm
    }

    /// Length of the slit across the strip, mm.
    pub fn slit_length_mm(&self) -> f64 {
        self.neck_mm + self.slit_extra_mm
    }

    /// How much sheet holds behind the slit's end on each side, mm: (head - slit) / 2. The joint falls open at 0.
    pub fn retention_mm(&self) -> f64 {
        (self.head_mm() - self.slit_length_mm()) / 2.0
    }

    /// How far the neck can shift in its slit, mm.
    pub fn play_mm(&self) -> f64 {
        self.slit_length_mm() - self.neck_mm
    }
}
