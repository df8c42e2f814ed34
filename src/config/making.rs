//! How strips are fastened, divided and labelled: choices a profile makes for its material and a design may make anew.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::machine::ToolClass;

/// What fastens the passes of a joint to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum JointKind {
    /// Flaps cut into the strip go through slits.
    #[default]
    Flap,
    /// Holes for rivets or brass fasteners.
    Holes,
    /// Only marked: tape or glue.
    Mark,
}

/// How two pieces of one strip are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpliceKind {
    /// Both ends overlap at a joint, whose own flaps go through both.
    Connection,
    /// Both ends overlap between two joints and are held by flaps or holes of their own.
    Lap,
    /// Dovetails side by side, taped over.
    DovetailTape,
    /// Fingers side by side, glued or taped.
    Finger,
}

/// How pieces are labelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LabelKind {
    /// Letters engraved by the machine that cuts.
    Engrave,
    /// Letters drawn with a pen: in the drawings, not in the cutting program.
    Pen,
    /// Letters cut through in dashes.
    Perforate,
    /// Notches in the edge.
    Notch,
    /// Nothing on the sheet: a map shows which joint is which.
    Map,
}

/// Whether the outside of the folded object may carry marks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VisibleFace {
    /// It may.
    #[default]
    Marked,
    /// All marks go where nobody sees them, or are left out.
    Clean,
}

/// How pieces are labelled, per tool. A tool that is not named engraves if the profile has settings for that, and else leaves it to the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LabelsByTool {
    /// Diode lasers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diode: Option<LabelKind>,
    /// CO2 lasers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub co2: Option<LabelKind>,
    /// Drag knives.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub knife: Option<LabelKind>,
    /// Pens.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pen: Option<LabelKind>,
}

/// A design's own choices; what it leaves out is the material's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Making {
    /// What fastens joints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<JointKind>,
    /// How pieces of one strip are joined.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub splice: Option<SpliceKind>,
    /// How pieces are labelled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<LabelKind>,
    /// Whether the outside may carry marks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub visible_face: Option<VisibleFace>,
}

impl LabelsByTool {
    /// What the profile says for a tool.
    pub fn for_tool(&self, class: ToolClass) -> Option<LabelKind> {
        match class {
            ToolClass::Diode => self.diode,
            ToolClass::Co2 => self.co2,
            ToolClass::Knife => self.knife,
            ToolClass::Pen => self.pen,
            // A printer draws all of them.
            ToolClass::Scissors => None,
        }
    }
}

impl Making {
    /// True when everything is left to the material.
    pub fn is_default(&self) -> bool {
        *self == Making::default()
    }
}

impl SpliceKind {
    /// The word used in files.
    pub fn word(self) -> &'static str {
        match self {
            SpliceKind::Connection => "connection",
            SpliceKind::Lap => "lap",
            SpliceKind::DovetailTape => "dovetail-tape",
            SpliceKind::Finger => "finger",
        }
    }
}
