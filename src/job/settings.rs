//! The only place where machine and profile become the stages' settings.

use super::Error;
use crate::config::{self, AirCode, Corner, Grain, Library, Machine, Pairing, Profile, ToolClass};
use crate::design::{Design, Foot, Up};
use crate::geom::{P2, Rect};
use crate::progress::Warning;
use crate::{cut, fit, gcode, mesh, nest, sim, stream, strip};

/// Least height of letters a pen writes so that they can be read, mm: its line is half a millimetre wide.
const PEN_LABEL_MM: f64 = 5.0;

/// Machine, material and how they go together.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The machine.
    pub machine: Machine,
    /// The material.
    pub profile: Profile,
    /// How the one cuts the other.
    pub pairing: Pairing,
    /// Stock the design asks for; empty for the material's own.
    pub stock: Vec<String>,
    /// What the user should know about the pair.
    pub warnings: Vec<Warning>,
}

impl Setup {
    /// Loads and pairs what the design names.
    pub fn new(design: &Design, library: &Library) -> Result<Setup, Error> {
        let machine = library.machine(&design.machine)?;
        let profile = library.profile(&design.material)?;
        let pairing = machine.pair(&profile)?;
        let mut warnings = pairing.warnings.clone();
        if pairing.engrave.is_none() && pairing.pen.is_some() {
            warnings.push(Warning::new(
                "pen-first",
                "labels are drawn, not cut: put a pen in the knife's place and run sheets/*.pen.* first, then the knife and the other file, without moving the zero",
            ));
        } else if pairing.engrave.is_none() {
            warnings.push(Warning::new(
                "no-labels",
                format!(
                    "{} cannot mark {} legibly: nothing is engraved; parts/ shows the joint numbers",
                    machine.name, profile.name
                ),
            ));
        }
        let mut setup = Setup { stock: design.stock.clone(), machine, profile, pairing, warnings };
        if setup.is_loose() {
            setup.warnings.push(Warning::new(
                "not-held",
                "nothing holds a piece once its outline is cut: use a tacky mat or a honeycomb with magnets, and little air",
            ));
        }
        Ok(setup)
    }

    /// What the head reaches of a sheet in the stop corner, mm along and across the sheet: a roll's x is its feed.
    pub fn reach(&self) -> Rect {
        let [width, height] = self.machine.reach_mm();
        if self.turned() { Rect::from_size(height, width) } else { Rect::from_size(width, height) }
    }

    /// The sheet along the strip: strips are cut along the grain (machine direction), where paper is stiffest and springs back best.
    pub fn material(&self) -> sim::Material {
        sim::Material {
            flexural_rigidity_n_mm: self.profile.flexural_rigidity_md_n_mm,
            membrane_stiffness_n_per_mm: self.profile.membrane_stiffness_n_per_mm,
            grammage_g_per_m2: self.profile.grammage_g_per_m2,
            thickness_mm: self.profile.thickness_mm,
        }
    }

    /// How the mesh is loaded.
    pub fn mesh(&self, design: &Design) -> mesh::Settings {
        let [width, height] = self.machine.reach_mm();
        let up = design.mesh.up.map(|up| match up {
            Up::X => mesh::Up::X,
            Up::Y => mesh::Up::Y,
            Up::Z => mesh::Up::Z,
        });
        mesh::Settings { up, height_mm: design.mesh.height_mm, bed_mm: width.max(height), ..mesh::Settings::default() }
    }

    /// How it is cut.
    pub fn cut(&self) -> cut::Settings {
        cut::Settings::default()
    }

    /// How an outline is filled.
    pub fn fit(&self, layers: Option<usize>, foot: Foot) -> fit::Settings {
        let mut settings = fit::Settings {
            foot: match foot {
                Foot::Auto => fit::Foot::Auto,
                Foot::Free => fit::Foot::Free,
                Foot::Pinned => fit::Foot::Pinned,
            },
            min_bend_radius_mm: self.profile.min_bend_radius_mm,
            min_void_mm: self.profile.min_void_mm,
            ..fit::Settings::default()
        };
        settings.stack.layers = layers;
        // A loop of height h bends to about h / 3 where it is tightest, and its diagonal leaves voids of about h / 2.
        let makeable = (3.0 * self.profile.min_bend_radius_mm).max(2.0 * self.profile.min_void_mm);
        settings.stack.min_layer_mm = settings.stack.min_layer_mm.max(makeable);
        settings.stack.max_layer_mm = settings.stack.max_layer_mm.max(makeable);
        settings
    }

    /// The joint for this tool.
    pub fn joint(&self) -> strip::Joint {
        let joint = self.profile.joint_for(self.machine.tool.class);
        strip::Joint {
            min_width_mm: joint.min_width_mm,
            neck_mm: joint.neck_mm,
            barb_mm: joint.barb_mm,
            neck_length_mm: joint.neck_length_mm,
            head_length_mm: joint.head_length_mm,
            tip_width_mm: joint.tip_width_mm,
            tip_radius_mm: joint.tip_radius_mm,
            shoulder_undercut_rad: joint.shoulder_undercut_deg.to_radians(),
            corner_radius_mm: joint.corner_radius_mm,
            hook_radius_mm: joint.hook_radius_mm.unwrap_or(0.0),
            slit_length_mm: joint.slit_length_mm(),
            slit_width_mm: joint.slit_width_mm.unwrap_or(0.0),
            slit_ahead_mm: joint.slit_ahead_mm,
            edge_distance_mm: joint.edge_distance_mm,
            cut_distance_mm: joint.cut_distance_mm,
            end_tab_mm: joint.end_tab_mm,
        }
    }

    /// How marks and letters are made, by the tool or by a pen in its place.
    pub(super) fn marking(&self) -> Option<&config::Process> {
        self.pairing.engrave.as_ref().or(self.pairing.pen.as_ref())
    }

    /// Height of lettering, mm; `None` where nothing can be lettered.
    pub(super) fn label_mm(&self) -> Option<f64> {
        let by_pen = self.machine.tool.class == ToolClass::Pen || self.pairing.pen.is_some();
        let least = if by_pen { PEN_LABEL_MM } else { 0.0 };
        self.marking().map(|_| self.profile.min_label_height_mm.max(least))
    }

    /// How strips become pieces of at most `max_piece_mm`.
    pub fn strip(&self, max_piece_mm: f64) -> strip::Settings {
        strip::Settings {
            joint: self.joint(),
            max_piece_mm,
            splice_overlap_mm: self.profile.splice.lap_mm,
            label_mm: self.label_mm(),
            grammage_g_per_m2: self.profile.grammage_g_per_m2,
        }
    }

    /// How pieces are placed.
    pub fn nest(&self) -> nest::Settings {
        // The cut itself needs room, however close the user wants the pieces.
        let kerf = self.pairing.cut.kerf_mm;
        nest::Settings {
            spacing_mm: self.profile.spacing_mm.max(kerf),
            margin_mm: self.profile.margin_mm.max(0.5 * kerf),
        }
    }

    /// Turns a piece may take on a sheet whose grain runs along x, degrees.
    pub fn angles_deg(&self) -> Vec<f64> {
        match self.profile.grain {
            Grain::Directional => vec![0.0, 180.0],
            Grain::None => vec![0.0, 180.0, 90.0, 270.0],
        }
    }

    /// How it is cut, as people read it.
    pub(super) fn cut_told(&self) -> String {
        let cut = &self.pairing.cut;
        let feed = format!("{:.0} mm/min", cut.feed_mm_per_min);
        match (self.machine.tool.class, cut.blade) {
            (ToolClass::Pen, _) => format!("{feed}, pen"),
            (_, Some(blade)) => format!("{feed}, blade {:.0} deg, {:.0} gf", blade.angle_deg, blade.force_gf),
            _ => format!("{feed}, {:.1} %, kerf {} mm", 100.0 * cut.power, cut.kerf_mm),
        }
    }

    /// What the machine permits and the material bears.
    pub fn check(&self) -> gcode::CheckSettings {
        check_settings(&self.machine, Some(&self.pairing))
    }

    /// How fast it moves.
    pub fn limits(&self) -> gcode::Limits {
        limits(&self.machine)
    }
}

/// What the head reaches, mm in the work frame: work X0 Y0 lies in the machine's origin corner.
pub(super) fn reach(machine: &Machine) -> Rect {
    let [width, height] = machine.reach_mm();
    let least = match machine.origin {
        Corner::FrontLeft => P2::new(0.0, 0.0),
        Corner::FrontRight => P2::new(-width, 0.0),
        Corner::BackLeft => P2::new(0.0, -height),
        Corner::BackRight => P2::new(-width, -height),
    };
    Rect { min: least, max: P2::new(least.x + width, least.y + height) }
}

/// What a machine permits and, when it is known, what the material on it bears. Work X0 Y0 lies in the machine's origin corner.
pub fn check_settings(machine: &Machine, pairing: Option<&Pairing>) -> gcode::CheckSettings {
    let controller = &machine.controller;
    let keep_out = |k: &config::KeepOut| {
        let min = P2::new(k.x_mm, k.y_mm);
        (k.name.clone(), Rect { min, max: P2::new(k.x_mm + k.width_mm, k.y_mm + k.height_mm) })
    };
    let energy = |pairing: &Pairing| {
        let full_power_w = machine.tool.optical_power_w?;
        Some(gcode::Energy { full_power_w, cut_j_per_mm: pairing.cut.energy_j_per_mm(full_power_w) })
    };
    gcode::CheckSettings {
        work_area: reach(machine),
        travel_z_mm: controller.max_travel_mm[2],
        // The head passes over what stands no higher than it travels.
        keep_outs: machine.keep_outs.iter().filter(|k| k.rise_mm > machine.tool.clearance_mm).map(keep_out).collect(),
        max_s: controller.max_s,
        limits: limits(machine),
        laser: machine.tool.class.is_laser(),
        laser_mode: controller.laser_mode,
        mist: machine.air.is_some_and(|air| [air.low, air.high].contains(&AirCode::M7)),
        // Below its floor a diode is only weak; a CO2 tube goes out.
        strike_floor: if machine.tool.class == ToolClass::Co2 { machine.tool.power_floor } else { 0.0 },
        energy: pairing.filter(|_| machine.tool.class.is_laser()).and_then(energy),
    }
}

/// What a machine file says of the board: GRBL's settings by number, in its units.
pub fn expected(machine: &Machine) -> stream::Expected {
    let c = &machine.controller;
    let mut settings = vec![
        (11, c.junction_deviation_mm),
        (12, c.arc_tolerance_mm),
        (30, c.max_s),
        (31, c.min_s),
        (32, f64::from(u8::from(c.laser_mode))),
    ];
    for axis in 0..3 {
        let number = axis as u16;
        settings.push((110 + number, c.max_rate_mm_per_min[axis]));
        settings.push((120 + number, c.acceleration_mm_per_s2[axis]));
        settings.push((130 + number, c.max_travel_mm[axis]));
    }
    stream::Expected { machine: machine.name.clone(), laser: machine.tool.class.is_laser(), settings }
}

/// How fast a machine moves and is fed.
pub fn limits(machine: &Machine) -> gcode::Limits {
    let controller = &machine.controller;
    gcode::Limits {
        max_rate_mm_per_min: controller.max_rate_mm_per_min,
        acceleration_mm_per_s2: controller.acceleration_mm_per_s2,
        junction_deviation_mm: controller.junction_deviation_mm,
        arc_tolerance_mm: controller.arc_tolerance_mm,
        planner_blocks: controller.planner_blocks as usize,
        // Ten bits a byte: start, eight, stop.
        bytes_per_s: f64::from(controller.baud) / 10.0,
        rx_bytes: controller.rx_bytes as usize,
        line_s: controller.line_ms / 1000.0,
    }
}
