//! A machine file as types: the controller, what the tool reaches, the tool itself, and what a person must do before it runs.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A cutter as its owner set it up. Safety limits live only here: a design or a job cannot raise them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Version of this file format: 1.
    pub schema: u32,
    /// The name used with `--machine`; the file is called NAME.toml.
    pub name: String,
    /// Name or path of a machine file this one only adds to. Tables are merged key by key, lists are replaced.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inherits: Option<String>,
    /// What people call it.
    pub title: String,
    /// Where the values come from, for all that carry no source of their own.
    pub source: String,
    /// The motion controller and its settings; left out where there is none, for printer and scissors.
    #[serde(default = "Controller::none", skip_serializing_if = "Controller::is_none")]
    pub controller: Controller,
    /// What the tool reaches on a flat bed. A machine has either this or `roll`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub work_area: Option<WorkArea>,
    /// What the tool reaches on a roll-fed machine.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll: Option<Roll>,
    /// The corner of the work area where work X0 Y0 lies, seen by a person standing in front.
    pub origin: Corner,
    /// The corner `$H` drives to; absent when the machine has no homing switches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub homing: Option<Corner>,
    /// What cuts.
    pub tool: Tool,
    /// A pen beside the tool or in its place: labels can then be drawn, first, by programs of their own with the same zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pen: Option<SecondPen>,
    /// Air assist switched by the program; absent when it is switched by hand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub air: Option<AirCodes>,
    /// What holds the sheet on the bed.
    #[serde(default)]
    pub hold: Hold,
    /// Clamps, magnets and posts that the head must not run into.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keep_outs: Vec<KeepOut>,
    /// What to do and to look at before every job, in this order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub setup: Vec<String>,
}

/// The controller's language and those of its settings that decide how long a job takes and what it may ask for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Controller {
    /// The language it speaks.
    pub dialect: Dialect,
    /// Serial speed. A line of n bytes takes 10 n / baud seconds to arrive.
    pub baud: u32,
    /// How far a corner may be rounded to keep speed (GRBL $11).
    pub junction_deviation_mm: f64,
    /// How far the controller's chords may leave a G2/G3 arc (GRBL $12).
    pub arc_tolerance_mm: f64,
    /// The S word of full power (GRBL $30).
    pub max_s: f64,
    /// The S word of the least power above off (GRBL $31).
    pub min_s: f64,
    /// Laser mode (GRBL $32): power follows the true speed under M4 and is off in G0. A laser needs it.
    pub laser_mode: bool,
    /// Fastest feed of x, y and z (GRBL $110-$112).
    pub max_rate_mm_per_min: [f64; 3],
    /// Acceleration of x, y and z (GRBL $120-$122).
    pub acceleration_mm_per_s2: [f64; 3],
    /// Travel of x, y and z from the homing switches (GRBL $130-$132).
    pub max_travel_mm: [f64; 3],
    /// Moves the planner looks ahead.
    pub planner_blocks: u32,
    /// Bytes of the serial receive buffer.
    pub rx_bytes: u32,
    /// Time the controller needs to read and plan one line.
    pub line_ms: f64,
}

/// The language of a controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Dialect {
    /// GRBL 1.1 and its kin.
    Grbl,
    /// HP-GL in steps of 1/40 mm, which most roll cutters speak. The settings of the controller then only serve to estimate times.
    Hpgl,
    /// No board: nothing can be sent. A file says so by leaving `controller` out.
    #[serde(skip)]
    None,
}

/// The rectangle the tool reaches on a bed, in the work frame: x to the right, y away from the person in front.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WorkArea {
    /// Along x.
    pub width_mm: f64,
    /// Along y.
    pub height_mm: f64,
}

/// A roll-fed machine: the head crosses the media, rollers feed it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Roll {
    /// Full width of the media.
    pub media_width_mm: f64,
    /// Strip along each rim that the pinch rollers need.
    pub pinch_margin_mm: f64,
    /// The machine's axis along which the media is fed.
    pub feed_axis: Axis,
    /// Longest feed that still tracks straight.
    pub max_length_mm: f64,
    /// Length of feed made before the next is begun, so that the media is not run back and forth.
    #[serde(default = "usual_window_mm")]
    pub window_mm: f64,
    /// What carries the media through the machine.
    #[serde(default)]
    pub backing: Backing,
}

/// A forearm's length of media: short enough that it does not sag out of line, long enough for most pieces.
fn usual_window_mm() -> f64 {
    300.0
}

/// What carries roll media.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Backing {
    /// A carrier that is not cut through: liner paper, or a mat.
    #[default]
    Carrier,
    /// Nothing: pieces stay in the media by ticks, and it is cut off across at the end.
    None,
}

/// What keeps sheets and what is cut out of them in place on a bed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Hold {
    /// Nothing, or tape and magnets: thin sheet is held by bridges.
    #[default]
    None,
    /// A tacky mat.
    Mat,
    /// A vacuum table.
    Vacuum,
}

/// A servo on the spindle's output that swings a pen or a knife; GRBL must run with laser_mode = false ($32=0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Servo {
    /// S word for down.
    pub down_s: f64,
    /// S word for up.
    pub up_s: f64,
    /// Time it takes either way.
    pub dwell_s: f64,
}

/// A z axis that lowers and lifts a pen or a knife.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Lift {
    /// Height on the sheet.
    pub down_mm: f64,
    /// Height for travel.
    pub up_mm: f64,
    /// Feed of the way down.
    pub feed_mm_per_min: f64,
    /// Rest on the sheet before it moves on.
    #[serde(default)]
    pub dwell_s: f64,
}

/// A pen on a machine that cuts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SecondPen {
    /// Where its tip is, seen from where the tool works: x to the right, y away from the person in front. 0 in the tool's own place.
    #[serde(default)]
    pub offset_mm: [f64; 2],
    /// The z axis that lowers and lifts it; absent where it comes down as the tool does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lift: Option<Lift>,
}

/// An axis of the machine in the plane of the sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// To the right.
    X,
    /// Away from the person in front.
    Y,
}

/// A corner of the work area, seen by a person standing in front of the machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Corner {
    /// Least x, least y.
    FrontLeft,
    /// Most x, least y.
    FrontRight,
    /// Least x, most y.
    BackLeft,
    /// Most x, most y.
    BackRight,
}

/// What cuts or draws.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// The kind of tool; decides joint geometry, process values and what is allowed.
    pub class: ToolClass,
    /// Light that leaves the lens at full power. Sellers print electrical watts: a "40 W" diode may give 5.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub optical_power_w: Option<f64>,
    /// Diameter of the focused spot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spot_mm: Option<f64>,
    /// Power 0..1 below which nothing leaves the tool (a CO2 tube strikes at about 0.10) or does any work.
    #[serde(default)]
    pub power_floor: f64,
    /// Power 0..1 a laser may show while it traces the border; absent: the border is traced with the beam off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame_power_max: Option<f64>,
    /// The servo that brings a knife or a pen down. A plotter that speaks HP-GL needs neither this nor `lift`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub servo: Option<Servo>,
    /// The z axis that brings a knife or a pen down.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lift: Option<Lift>,
    /// Free height under the head while it travels: it passes over what stands no higher. A laser's is from its nozzle to the sheet.
    #[serde(default)]
    pub clearance_mm: f64,
    /// Half the width of the head where it could run into what stands on the bed.
    #[serde(default)]
    pub head_radius_mm: f64,
}

/// The kind of tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ToolClass {
    /// Blue laser diode, about 450 nm: passes through clear sheet.
    Diode,
    /// CO2 laser tube, 10.6 um.
    Co2,
    /// Drag knife.
    Knife,
    /// Pen: draws the lines, cut by hand.
    Pen,
    /// A printer draws the lines, a person cuts them.
    Scissors,
}

/// M words that switch air assist on; M9 switches it off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AirCodes {
    /// Keeps smoke off the lens and does not lift thin sheet.
    pub low: AirCode,
    /// Clears the cut of thick sheet.
    pub high: AirCode,
}

/// A word that opens an air valve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum AirCode {
    /// Mist output; on GRBL only when built with it.
    M7,
    /// Flood output.
    M8,
}

/// Something that stands on the bed, as a rectangle in the work frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KeepOut {
    /// What it is: "magnet, front left".
    pub name: String,
    /// Left edge.
    pub x_mm: f64,
    /// Front edge.
    pub y_mm: f64,
    /// Along x.
    pub width_mm: f64,
    /// Along y.
    pub height_mm: f64,
    /// How far it stands above the sheet.
    pub rise_mm: f64,
}

impl Machine {
    /// How high the z axis lifts what it carries, the tool or the pen beside it, for travel, mm above the sheet; `None` without one.
    pub fn up_mm(&self) -> Option<f64> {
        let lifts = [self.tool.lift, self.pen.and_then(|pen| pen.lift)];
        lifts.into_iter().flatten().map(|lift| lift.up_mm).reduce(f64::max)
    }

    /// The rectangle the tool reaches, along the machine's x and y, in mm. Zero for a machine that says neither work area nor roll,
    /// which a loaded one never is.
    pub fn reach_mm(&self) -> [f64; 2] {
        match (&self.work_area, &self.roll) {
            (Some(area), _) => [area.width_mm, area.height_mm],
            (None, Some(roll)) => {
                let across = roll.media_width_mm - 2.0 * roll.pinch_margin_mm;
                match roll.feed_axis {
                    Axis::X => [roll.max_length_mm, across],
                    Axis::Y => [across, roll.max_length_mm],
                }
            }
            (None, None) => [0.0, 0.0],
        }
    }

    /// The keep-outs the head cannot pass over, each grown by half the head's width, mm in the work frame: name, x, y, width, height.
    pub fn obstacles(&self) -> impl Iterator<Item = (&str, [f64; 4])> {
        let (clearance, r) = (self.tool.clearance_mm, self.tool.head_radius_mm);
        self.keep_outs
            .iter()
            .filter(move |k| k.rise_mm > clearance)
            .map(move |k| (k.name.as_str(), [k.x_mm - r, k.y_mm - r, k.width_mm + 2.0 * r, k.height_mm + 2.0 * r]))
    }

    /// The fastest feed both axes can run, mm/min.
    pub fn max_feed_mm_per_min(&self) -> f64 {
        self.controller.max_rate_mm_per_min[0].min(self.controller.max_rate_mm_per_min[1])
    }
}

impl Controller {
    /// What a machine without a board has: nothing that moves.
    fn none() -> Controller {
        Controller {
            dialect: Dialect::None,
            baud: 0,
            junction_deviation_mm: 0.0,
            arc_tolerance_mm: 0.0,
            max_s: 0.0,
            min_s: 0.0,
            laser_mode: false,
            max_rate_mm_per_min: [0.0; 3],
            acceleration_mm_per_s2: [0.0; 3],
            max_travel_mm: [0.0; 3],
            planner_blocks: 0,
            rx_bytes: 0,
            line_ms: 0.0,
        }
    }

    /// True where there is no board.
    pub fn is_none(&self) -> bool {
        self.dialect == Dialect::None
    }
}

impl Dialect {
    /// The words people read.
    pub fn title(self) -> &'static str {
        match self {
            Dialect::Grbl => "GRBL",
            Dialect::Hpgl => "HP-GL",
            Dialect::None => "none",
        }
    }
}

impl Corner {
    /// The words people read.
    pub fn title(self) -> &'static str {
        match self {
            Corner::FrontLeft => "front left",
            Corner::FrontRight => "front right",
            Corner::BackLeft => "back left",
            Corner::BackRight => "back right",
        }
    }
}

impl ToolClass {
    /// All classes, in the order they are listed to people.
    pub const ALL: [ToolClass; 5] =
        [ToolClass::Diode, ToolClass::Co2, ToolClass::Knife, ToolClass::Pen, ToolClass::Scissors];

    /// The word used in files.
    pub fn word(self) -> &'static str {
        match self {
            ToolClass::Diode => "diode",
            ToolClass::Co2 => "co2",
            ToolClass::Knife => "knife",
            ToolClass::Pen => "pen",
            ToolClass::Scissors => "scissors",
        }
    }

    /// The words people read.
    pub fn title(self) -> &'static str {
        match self {
            ToolClass::Diode => "diode laser",
            ToolClass::Co2 => "CO2 laser",
            ToolClass::Knife => "drag knife",
            ToolClass::Pen => "pen",
            ToolClass::Scissors => "printer and scissors",
        }
    }

    /// True for tools that burn.
    pub fn is_laser(self) -> bool {
        matches!(self, ToolClass::Diode | ToolClass::Co2)
    }
}
