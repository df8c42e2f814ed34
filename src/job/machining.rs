//! Machine and profile as settings of tool paths, G-code and plots.

use super::order::StartFrom;
use super::settings::{Setup, reach};
use crate::config::{self, Air, AirCode, Axis, Backing, Corner, Dialect, Hold, Machine, ToolClass};
use crate::geom::{P2, Rect, V2};
use crate::{gcode, toolpath};

/// Laser-cut sheets thinner than this, mm, lift and blow away when nothing holds them.
const THIN_MM: f64 = 0.5;

/// Sheets thicker than this, mm, take a lead-in: in thinner ones the burn of a start does not show.
const LEADLESS_MM: f64 = 0.3;

/// Lead-in and lead-out where one is needed and the profile does not say, mm.
const LEAD_MM: f64 = 1.0;

/// Lines and arcs leave the compensated path by at most this, mm: with half a kerf's 0.005 well below what any of these machines repeats.
const CURVE_TOLERANCE_MM: f64 = 0.02;

/// A blade is run on over its start by this many times its trail, so that the ends of the cut meet.
const OVERCUT_TRAILS: f64 = 2.0;

/// Media without backing stays together by ticks: cut so far, mm, and left so far. Half a millimetre of paper holds and breaks by hand.
const TICK_MM: f64 = 15.0;
const TICK_LEFT_MM: f64 = 0.5;

impl Setup {
    /// How a sheet is cut that starts where `start` says.
    pub(super) fn toolpath(&self, start: &StartFrom) -> toolpath::Settings {
        let cut = process(&self.pairing.cut);
        let roll = self.machine.roll.as_ref();
        let mut settings = toolpath::Settings {
            tool: self.tool(),
            // What it does not mark, a pen does, or nobody.
            share: if self.marking().is_some() { toolpath::Share::All } else { toolpath::Share::Cuts },
            kerf_mm: self.pairing.cut.kerf_mm,
            engrave: self.marking().map(process),
            cut_inner: cut.clone(),
            cut_outline: cut,
            curve_tolerance_mm: CURVE_TOLERANCE_MM,
            trials: Vec::new(),
            bridges: self.bridges(),
            held: roll.is_some() || self.machine.hold != Hold::None,
            lead_mm: 0.0,
            overcut_mm: self.pairing.cut.overcut_mm.unwrap_or_else(|| OVERCUT_TRAILS * self.blade_mm()),
            cool_mm: self.pairing.cut.cool_mm,
            common_edges: self.profile.common_edges,
            crosses: !self.by_hand(),
            window_mm: roll.map(|roll| roll.window_mm),
            cross_cut: roll.is_some_and(|roll| roll.backing == Backing::None),
            frame: toolpath::Frame { turned: self.turned(), zero: zero(&self.machine, start), tip: V2::zeros() },
            work_area: reach(&self.machine),
            keep_outs: match start {
                StartFrom::Absolute => obstacles(&self.machine),
                // Nobody knows where they lie from there.
                StartFrom::Origin(_) | StartFrom::Current(_) => Vec::new(),
            },
            park: P2::origin(),
        };
        if self.machine.tool.class.is_laser() {
            let marks = settings.constant_power(&settings.cut_outline) || self.profile.thickness_mm > LEADLESS_MM;
            settings.lead_mm = self.pairing.cut.lead_mm.unwrap_or(if marks { LEAD_MM } else { 0.0 });
        }
        settings
    }

    /// How the machine's pen draws the marks of a sheet, before it is cut; `None` where the tool marks itself or nothing does.
    pub(super) fn drawing(&self, start: &StartFrom) -> Option<toolpath::Settings> {
        let [x, y] = self.machine.pen?.offset_mm;
        let pen = process(self.pen()?);
        let cutting = self.toolpath(start);
        Some(toolpath::Settings {
            tool: toolpath::Tool::Pen,
            share: toolpath::Share::Marks,
            engrave: Some(pen),
            bridges: None,
            lead_mm: 0.0,
            overcut_mm: 0.0,
            cross_cut: false,
            frame: toolpath::Frame { tip: V2::new(x, y), ..cutting.frame },
            ..cutting
        })
    }

    /// True when nothing keeps what is cut out of the sheet in its place.
    pub(super) fn is_loose(&self) -> bool {
        let cuts = !matches!(self.machine.tool.class, ToolClass::Pen | ToolClass::Scissors);
        let thin = cuts && self.profile.thickness_mm < THIN_MM;
        thin && self.machine.hold == Hold::None && self.machine.roll.is_none() && self.bridges().is_none()
    }

    /// A roll's layout has x along the feed; the machine may feed along y.
    pub(super) fn turned(&self) -> bool {
        self.machine.roll.is_some_and(|roll| roll.feed_axis == Axis::Y)
    }

    fn tool(&self) -> toolpath::Tool {
        match self.machine.tool.class {
            ToolClass::Pen | ToolClass::Scissors => toolpath::Tool::Pen,
            ToolClass::Knife => toolpath::Tool::Knife { offset_mm: self.blade_mm() },
            // Below its floor a diode is only weak, and within a micrometre of a corner; a CO2 tube goes out.
            ToolClass::Diode => toolpath::Tool::Laser { strike: None },
            ToolClass::Co2 => {
                let [ax, ay, _] = self.machine.controller.acceleration_mm_per_s2;
                let floor = self.machine.tool.power_floor;
                let strike = toolpath::Strike { floor, acceleration_mm_per_s2: ax.min(ay) };
                toolpath::Tool::Laser { strike: (floor > 0.0).then_some(strike) }
            }
        }
    }

    fn blade_mm(&self) -> f64 {
        match self.machine.tool.class {
            ToolClass::Knife => self.pairing.cut.blade.map_or(0.0, |blade| blade.offset_mm),
            ToolClass::Diode | ToolClass::Co2 | ToolClass::Pen | ToolClass::Scissors => 0.0,
        }
    }

    fn bridges(&self) -> Option<toolpath::Bridges> {
        match &self.machine.roll {
            Some(roll) if roll.backing == Backing::None => {
                Some(toolpath::Bridges { width_mm: TICK_LEFT_MM, pitch_mm: TICK_MM + TICK_LEFT_MM, everywhere: true })
            }
            Some(_) => None,
            None => {
                let by_laser = self.machine.tool.class.is_laser() && self.profile.thickness_mm < THIN_MM;
                let wanted = self.pairing.cut.bridges.filter(|_| by_laser && self.machine.hold == Hold::None);
                wanted.map(|b| toolpath::Bridges { width_mm: b.width_mm, pitch_mm: b.pitch_mm, everywhere: false })
            }
        }
    }

    /// What the controller wants to read, for its own tool or for the pen beside it.
    pub(super) fn dialect(&self, start: &StartFrom, tool: toolpath::Tool) -> gcode::Dialect {
        let word = |code: AirCode| match code {
            AirCode::M7 => 7,
            AirCode::M8 => 8,
        };
        let machine = &self.machine;
        let second = machine.pen.filter(|_| self.is_second(tool)).and_then(|pen| pen.lift);
        let tool = match (machine.tool.servo, second.or(machine.tool.lift)) {
            (Some(servo), None) => {
                gcode::ToolWords::Servo { down_s: servo.down_s, up_s: servo.up_s, dwell_s: servo.dwell_s }
            }
            (_, Some(lift)) => gcode::ToolWords::Lift {
                down_mm: lift.down_mm,
                up_mm: lift.up_mm,
                feed_mm_per_min: lift.feed_mm_per_min,
                dwell_s: lift.dwell_s,
            },
            (None, None) => gcode::ToolWords::Laser { constant_power: !machine.controller.laser_mode },
        };
        gcode::Dialect {
            max_s: machine.controller.max_s,
            tool,
            from_here: matches!(start, StartFrom::Current(_)),
            air: machine.air.as_ref().map(|a| gcode::AirWords { low: word(a.low), high: word(a.high) }),
        }
    }

    /// True for the pen of a machine that cuts with something else.
    pub(super) fn is_second(&self, tool: toolpath::Tool) -> bool {
        tool == toolpath::Tool::Pen && self.machine.tool.class != ToolClass::Pen
    }

    /// What a plotter is told beside the way; `None` for a machine that reads G-code.
    pub(super) fn plotter(&self, tool: toolpath::Tool) -> Option<gcode::Plotter> {
        let process = self.pen().filter(|_| self.is_second(tool)).unwrap_or(&self.pairing.cut);
        self.plots().then(|| gcode::Plotter {
            speed_mm_per_s: Some(process.feed_mm_per_min / 60.0),
            force_gf: process.blade.map(|blade| blade.force_gf),
        })
    }

    /// True for a machine that reads plots instead of G-code.
    pub(super) fn plots(&self) -> bool {
        self.machine.controller.dialect == Dialect::Hpgl
    }
}

fn process(p: &config::Process) -> toolpath::Process {
    let pass = |(k, share): (usize, &f64)| toolpath::Pass { power: p.power * share, depth_mm: k as f64 * p.z_step_mm };
    toolpath::Process {
        feed_mm_per_min: p.feed_mm_per_min,
        passes: p.pass_power.iter().enumerate().map(pass).collect(),
        air: match p.air {
            Air::Off => toolpath::Air::Off,
            Air::Low => toolpath::Air::Low,
            Air::High => toolpath::Air::High,
        },
        dashes: p.perforation.map(|d| toolpath::Dashes { cut_mm: d.cut_mm, gap_mm: d.gap_mm }),
    }
}

fn zero(machine: &Machine, start: &StartFrom) -> toolpath::Zero {
    match start {
        StartFrom::Absolute => toolpath::Zero::Sheet(corner(machine.origin)),
        StartFrom::Origin(anchor) | StartFrom::Current(anchor) => toolpath::Zero::Job(*anchor),
    }
}

fn corner(corner: Corner) -> toolpath::Anchor {
    let (x, y) = match corner {
        Corner::FrontLeft => (0.0, 0.0),
        Corner::FrontRight => (1.0, 0.0),
        Corner::BackLeft => (0.0, 1.0),
        Corner::BackRight => (1.0, 1.0),
    };
    toolpath::Anchor { x, y }
}

/// What the head has to go round, mm in the work frame.
pub(super) fn obstacles(machine: &Machine) -> Vec<(String, Rect)> {
    let rect = |[x, y, width, height]: [f64; 4]| Rect { min: P2::new(x, y), max: P2::new(x + width, y + height) };
    machine.obstacles().map(|(name, sides)| (name.to_owned(), rect(sides))).collect()
}
