//! A profile file as types: a sheet material with its stiffness, the stock it comes in, its joint, which tools may touch it and how.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::joint::{Dashes, Joint, Joints};
use super::machine::ToolClass;
use super::making::{LabelsByTool, SpliceKind};

/// A sheet material as a shop has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// Version of this file format: 1.
    pub schema: u32,
    /// The name used with `--material`; the file is called NAME.toml.
    pub name: String,
    /// Name or path of a profile this one only adds to. Tables are merged key by key, lists are replaced.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inherits: Option<String>,
    /// What people call it.
    pub title: String,
    /// Where the values come from, for all that carry no source of their own.
    pub source: String,
    /// Thickness of the sheet.
    pub thickness_mm: f64,
    /// Mass per area.
    pub grammage_g_per_m2: f64,
    /// Bending stiffness per width of a strip that runs along the grain (machine direction). 1 N mm = 1 mN m, as on data sheets.
    pub flexural_rigidity_md_n_mm: f64,
    /// Bending stiffness per width of a strip that runs across the grain.
    pub flexural_rigidity_cd_n_mm: f64,
    /// Where the two flexural rigidities come from, when not from `source`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flexural_rigidity_source: Option<String>,
    /// Tension per width at strain 1: Young's modulus times thickness.
    pub membrane_stiffness_n_per_mm: f64,
    /// Where the membrane stiffness comes from.
    pub membrane_stiffness_source: String,
    /// Whether the direction a strip is cut in matters.
    pub grain: Grain,
    /// Tightest bend that leaves no crease.
    pub min_bend_radius_mm: f64,
    /// Narrowest void in which a flap can still be closed.
    pub min_void_mm: f64,
    /// Least height of letters that can be read.
    pub min_label_height_mm: f64,
    /// Distance between neighbouring pieces on a sheet.
    pub spacing_mm: f64,
    /// Distance between pieces and the edge of the stock.
    pub margin_mm: f64,
    /// Straight edges that two pieces share are cut once. Needs spacing_mm = 0: pieces then lie a kerf apart.
    #[serde(default)]
    pub common_edges: bool,
    /// Sheets and rolls at hand, in the order they are used.
    pub stock: Vec<Stock>,
    /// Flap and slit.
    pub joint: Joints,
    /// How two pieces of one strip are joined.
    pub splice: Splice,
    /// How pieces are labelled.
    #[serde(default)]
    pub label: LabelsByTool,
    /// Which tools may touch it.
    pub allowed: Allowed,
    /// Settings that worked: one row per tool, operation and reference power.
    pub process: Vec<ProcessRow>,
    /// What this material needs before a job, beside the machine's list.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub setup: Vec<String>,
}

/// Whether a sheet is stiffer one way than the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Grain {
    /// The same both ways: pieces may lie at any angle.
    None,
    /// Stiffer along the grain: all strips of an object lie the same way.
    Directional,
}

/// A sheet size or a roll.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stock {
    /// The name used with `--stock`: "A4".
    pub name: String,
    /// Width and height of a sheet as it lies on the bed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_mm: Option<[f64; 2]>,
    /// Width of a roll.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_width_mm: Option<f64>,
    /// Sheets at hand; absent: as many as it takes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<u32>,
    /// How the grain runs.
    #[serde(default)]
    pub grain: StockGrain,
}

/// How the grain of a directional material runs in a sheet. On a roll it runs along the feed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StockGrain {
    /// Along the longer side.
    Long,
    /// Along the shorter side.
    Short,
    /// Not known (or the material has none): lay all sheets of an object the same way.
    #[default]
    Unknown,
}

/// How two pieces of one strip are joined.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Splice {
    /// The kind; absent: at joints for sheets up to 0.3 mm, by a lap for thicker ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<SpliceKind>,
    /// How far the two ends overlap at a joint.
    #[serde(default = "connection_mm")]
    pub connection_mm: f64,
    /// How far the two ends overlap in a lap.
    pub lap_mm: f64,
    /// From one row of a lap's flaps or holes to the other.
    #[serde(default = "rows_mm")]
    pub rows_mm: f64,
    /// Diameter of holes for thread along a lap; absent: it has flaps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thread_hole_mm: Option<f64>,
    /// Where the value comes from.
    pub source: String,
}

/// From practice: 12-18.
fn connection_mm() -> f64 {
    14.0
}

/// From practice.
fn rows_mm() -> f64 {
    12.0
}

/// Sheets up to this thickness, mm, are spliced at joints: a lap of its own would stiffen a section more than it has to.
const THIN_MM: f64 = 0.3;

/// Which tools may touch the material. A tool that is not named has not been tried and counts as `test`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Allowed {
    /// Diode lasers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diode: Option<Verdict>,
    /// Why, unless the verdict is yes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diode_reason: Option<String>,
    /// CO2 lasers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub co2: Option<Verdict>,
    /// Why, unless the verdict is yes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub co2_reason: Option<String>,
    /// Drag knives.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub knife: Option<Verdict>,
    /// Why, unless the verdict is yes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub knife_reason: Option<String>,
    /// Pens.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pen: Option<Verdict>,
    /// Why, unless the verdict is yes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pen_reason: Option<String>,
}

/// May this tool touch this material?
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It works and is safe with the usual care.
    Yes,
    /// It may work: cut a test piece and look, first.
    Test,
    /// It does not work, or harms people or the machine. No job can override it.
    Never,
}

/// Settings that worked for one operation with one tool.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProcessRow {
    /// The tool.
    pub tool: ToolClass,
    /// What is done.
    pub operation: ProcessKind,
    /// Where the values come from.
    pub source: String,
    /// Name of the machine the values were measured on; absent: not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured_on: Option<String>,
    /// Optical power of the laser the row is for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_power_w: Option<f64>,
    /// Full width of what the cut removes; 0 for a blade. Engraving has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kerf_mm: Option<f64>,
    /// Speed of the tool along its path.
    pub feed_mm_per_min: f64,
    /// Share of full power, 0..1; a laser needs it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub power: Option<f64>,
    /// Air assist.
    #[serde(default)]
    pub air: Air,
    /// How often every path is run.
    #[serde(default = "once")]
    pub passes: u32,
    /// Power of every pass as a share of `power`, where it is not the same for all: [1, 0.8].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pass_power: Vec<f64>,
    /// How much lower the tool is set for each pass after the first.
    #[serde(default)]
    pub z_step_mm: f64,
    /// Lead-in, and lead-out, beside outlines and holes, on what falls away; absent: 1 mm where a beam of constant power would mark its start, and in
    /// sheet above 0.3 mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lead_mm: Option<f64>,
    /// How far a closed contour is run on over its start; absent: twice a blade's trail, nothing for a laser.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub overcut_mm: Option<f64>,
    /// Each cut begins at least this far from where the last one ended, so that thin sheet cools; absent: anywhere.
    #[serde(default)]
    pub cool_mm: f64,
    /// Dashes instead of lines: marks that are pricked through where nothing shows on the surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub perforation: Option<Dashes>,
    /// Uncut stretches that hold the pieces in the sheet; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bridges: Option<Bridges>,
    /// A drag knife's blade and pressure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blade: Option<Blade>,
}

fn once() -> u32 {
    1
}

/// What a process row does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ProcessKind {
    /// Through the sheet.
    Cut,
    /// Onto its surface: labels and marks.
    Engrave,
}

/// Air assist.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Air {
    /// No air.
    #[default]
    Off,
    /// Keeps smoke off the lens and does not lift thin sheet.
    Low,
    /// Clears the cut of thick sheet.
    High,
}

/// Uncut stretches that hold a piece in its sheet.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bridges {
    /// Length left uncut.
    pub width_mm: f64,
    /// Distance from bridge to bridge along the contour.
    pub pitch_mm: f64,
}

/// A drag knife's blade and pressure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Blade {
    /// Angle of the edge to the sheet's normal: 45 or 60.
    pub angle_deg: f64,
    /// How far the tip trails the axis it swivels about.
    pub offset_mm: f64,
    /// Downforce, in the unit on the cutters' panels: 100 gf = 0.98 N.
    pub force_gf: f64,
}

impl Profile {
    /// Flap and slit for a tool.
    pub fn joint_for(&self, class: ToolClass) -> &Joint {
        self.joint.for_tool(class)
    }

    /// How pieces of one strip are joined.
    pub fn splice_kind(&self) -> SpliceKind {
        let usual = if self.thickness_mm <= THIN_MM { SpliceKind::Connection } else { SpliceKind::Lap };
        self.splice.kind.unwrap_or(usual)
    }

    /// The stock of that name, regardless of case.
    pub fn stock_named(&self, name: &str) -> Option<&Stock> {
        self.stock.iter().find(|stock| stock.name.eq_ignore_ascii_case(name))
    }
}

impl Allowed {
    /// What the profile says about a tool, and why. `None` for the verdict when it says nothing.
    pub fn for_tool(&self, class: ToolClass) -> (Option<Verdict>, Option<&str>) {
        let (verdict, reason) = match class {
            ToolClass::Diode => (self.diode, &self.diode_reason),
            ToolClass::Co2 => (self.co2, &self.co2_reason),
            ToolClass::Knife => (self.knife, &self.knife_reason),
            ToolClass::Pen => (self.pen, &self.pen_reason),
            // Scissors cut what a person can lift.
            ToolClass::Scissors => return (Some(Verdict::Yes), None),
        };
        (verdict, reason.as_deref())
    }
}

impl ProcessKind {
    /// The word used in files.
    pub fn word(self) -> &'static str {
        match self {
            ProcessKind::Cut => "cut",
            ProcessKind::Engrave => "engrave",
        }
    }
}

impl Air {
    /// The word used in files.
    pub fn word(self) -> &'static str {
        match self {
            Air::Off => "off",
            Air::Low => "low",
            Air::High => "high",
        }
    }
}

impl Verdict {
    /// The word used in files.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Yes => "yes",
            Verdict::Test => "test",
            Verdict::Never => "never",
        }
    }
}
