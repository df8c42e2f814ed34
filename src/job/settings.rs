//! The only place where machine and profile become the stages' settings.

use super::Error;
use super::machining::obstacles;
use crate::config::{
    self, AirCode, Corner, Grain, JointKind, LabelKind, Library, Machine, Making, Pairing, Profile, SpliceKind,
    ToolClass, VisibleFace,
};
use crate::design::{Design, Foot, MeshSource, Method, Paper, PartDesign, Stack, StripAlong, Up};
use crate::geom::{P2, Rect};
use crate::progress::Warning;
use crate::ruffle::Limits;
use crate::{cut, fit, gcode, mesh, nest, sim, stream, strip};

/// Letters a pen draws are legible from this height, mm, and letters cut in dashes from this (materials practice).
const PEN_LABEL_MM: f64 = 5.0;
const PERFORATED_LABEL_MM: f64 = 6.0;

/// Pieces keep this far from the edge of stock that goes through a printer, mm: what [`crate::assembly::patterns`] needs to put a full A4 sheet on one page.
const PRINT_MARGIN_MM: f64 = 13.0;

/// How long `make` nests: a few tenths of a second for the pieces of an object. `furbelow nest` goes on as long as is wanted.
const NEST_EFFORT: u64 = 25_000;
const NEST_SEED: u64 = 1;

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
    /// Which way strips run in the sheet.
    pub strip_along: StripAlong,
    /// What sheets for people are printed on.
    pub paper: Paper,
    /// How strips are fastened, divided and labelled, where the design says so.
    pub making: Making,
    /// What the user should know about the pair.
    pub warnings: Vec<Warning>,
}

impl Setup {
    /// Loads and pairs what the design names.
    pub fn new(design: &Design, library: &Library) -> Result<Setup, Error> {
        let machine = library.machine(&design.machine)?;
        let profile = library.profile(&design.material)?;
        let pairing = machine.pair(&profile)?;
        let warnings = pairing.warnings.clone();
        let mut setup = Setup {
            stock: design.stock.clone(),
            strip_along: design.strip_along,
            paper: design.paper,
            making: design.making,
            machine,
            profile,
            pairing,
            warnings,
        };
        if setup.is_loose() {
            setup.warnings.push(Warning::new(
                "not-held",
                "nothing holds a piece once its outline is cut: use a tacky mat or a honeycomb with magnets, and little air",
            ));
        }
        setup.warnings.extend(setup.label_warning());
        if setup.joint().fastening == strip::Fastening::Mark && setup.marking().is_none() {
            setup.warnings.push(Warning::new(
                "marks-not-made",
                "joints are to be taped or glued where they are marked, and nothing is engraved: the crosses are only in the drawings in strips/ and sheets/",
            ));
        }
        Ok(setup)
    }

    /// For a test card: nothing is known yet, so a laser's values are carried over from any power.
    pub(super) fn for_test(machine: &str, material: &str, library: &Library) -> Result<Setup, Error> {
        let (machine, profile) = (library.machine(machine)?, library.profile(material)?);
        let pairing = machine.trial(&profile)?;
        let (stock, strip_along, paper, making, warnings) = Default::default();
        Ok(Setup { machine, profile, pairing, stock, strip_along, paper, making, warnings })
    }

    /// What the chosen labels ask of the user.
    fn label_warning(&self) -> Option<Warning> {
        let (machine, profile) = (&self.machine.name, &self.profile.name);
        let machine_draws = self.machine.tool.class == ToolClass::Pen;
        let message = match self.label_kind() {
            LabelKind::Engrave | LabelKind::Perforate => return None,
            LabelKind::Pen if machine_draws => return None,
            LabelKind::Pen if self.pen().is_some() => {
                let message = "labels are drawn first: run the program in pen/ with the pen, then the one of the same name in sheets/, without moving sheet or zero between them";
                return Some(Warning::new("pen-first", message));
            }
            LabelKind::Pen => {
                "joint numbers are left to a pen: they are in the drawings (black), not in the cutting programs".into()
            }
            LabelKind::Notch => format!(
                "{machine} writes nothing on {profile}: notches in the edge tell the joints, a deep one counts five, a shallow one one; in the lower edge fold toward you, in the upper away"
            ),
            LabelKind::Map => {
                format!("{machine} cannot mark {profile} legibly: nothing is engraved; parts/ shows the joint numbers")
            }
        };
        Some(Warning::new("no-labels", message))
    }

    /// How pieces are labelled: as the design says, else the material for this tool, else engraved where that can be done.
    pub(super) fn label_kind(&self) -> LabelKind {
        let usual = match (&self.pairing.engrave, &self.pairing.pen) {
            (Some(_), _) => LabelKind::Engrave,
            (None, Some(_)) => LabelKind::Pen,
            (None, None) => LabelKind::Map,
        };
        let wanted = self.making.label.or_else(|| self.profile.label.for_tool(self.machine.tool.class));
        match wanted.unwrap_or(usual) {
            LabelKind::Engrave => usual,
            other => other,
        }
    }

    /// What the pieces carry.
    fn labels(&self) -> strip::Labels {
        let least = self.profile.min_label_height_mm;
        match self.label_kind() {
            LabelKind::Engrave => strip::Labels::Strokes { height_mm: least },
            LabelKind::Pen => strip::Labels::Strokes { height_mm: least.max(PEN_LABEL_MM) },
            LabelKind::Perforate => strip::Labels::Perforated { height_mm: least.max(PERFORATED_LABEL_MM) },
            LabelKind::Notch => strip::Labels::Notches,
            LabelKind::Map => strip::Labels::Nothing,
        }
    }

    /// How marks and letters are made by the tool itself; `None` where they are not.
    pub(super) fn marking(&self) -> Option<&config::Process> {
        let drawn = self.machine.tool.class == ToolClass::Pen && self.label_kind() == LabelKind::Pen;
        self.pairing.engrave.as_ref().filter(|_| drawn || self.label_kind() == LabelKind::Engrave)
    }

    /// How the machine's pen draws them; `None` where none does.
    pub(super) fn pen(&self) -> Option<&config::Process> {
        self.pairing.pen.as_ref().filter(|_| self.label_kind() == LabelKind::Pen)
    }

    /// Height of strokes that letter a sheet, mm; `None` where there are none.
    pub(super) fn lettering_mm(&self) -> Option<f64> {
        self.marking().or(self.pen())?;
        match self.labels() {
            strip::Labels::Strokes { height_mm } => Some(height_mm),
            strip::Labels::Perforated { .. } | strip::Labels::Notches | strip::Labels::Nothing => None,
        }
    }

    /// True for a job that a person cuts along printed lines: it has drawings and patterns, and no programs.
    pub fn by_hand(&self) -> bool {
        self.machine.tool.class == ToolClass::Scissors
    }

    /// Distance between pieces and the edge of the stock, mm. Printers leave an edge white and a line with the rule stands at the foot.
    pub fn margin_mm(&self) -> f64 {
        if self.by_hand() { self.profile.margin_mm.max(PRINT_MARGIN_MM) } else { self.profile.margin_mm }
    }

    /// What the head reaches of a sheet in the stop corner, mm along and across the sheet: a roll's x is its feed.
    pub fn reach(&self) -> Rect {
        let [width, height] = self.machine.reach_mm();
        if self.turned() { Rect::from_size(height, width) } else { Rect::from_size(width, height) }
    }

    /// The sheet in the direction strips are cut in. Along the grain (machine direction) paper is stiffest and springs back best.
    pub fn material(&self) -> sim::Material {
        sim::Material {
            flexural_rigidity_n_mm: match self.strip_along {
                StripAlong::Grain => self.profile.flexural_rigidity_md_n_mm,
                StripAlong::Across => self.profile.flexural_rigidity_cd_n_mm,
            },
            membrane_stiffness_n_per_mm: self.profile.membrane_stiffness_n_per_mm,
            grammage_g_per_m2: self.profile.grammage_g_per_m2,
            thickness_mm: self.profile.thickness_mm,
        }
    }

    /// How the mesh is loaded.
    pub fn mesh(&self, source: &MeshSource) -> mesh::Settings {
        let [width, height] = self.machine.reach_mm();
        let up = source.up.map(|up| match up {
            Up::X => mesh::Up::X,
            Up::Y => mesh::Up::Y,
            Up::Z => mesh::Up::Z,
        });
        mesh::Settings { up, height_mm: source.height_mm, bed_mm: width.max(height), ..mesh::Settings::default() }
    }

    /// How it is cut.
    pub fn cut(&self) -> cut::Settings {
        cut::Settings::default()
    }

    /// How an outline is filled.
    pub fn fit(&self, part: &PartDesign) -> fit::Settings {
        let mut settings = fit::Settings {
            foot: match part.foot {
                Foot::Auto => fit::Foot::Auto,
                Foot::Free => fit::Foot::Free,
                Foot::Pinned => fit::Foot::Pinned,
            },
            direction: match part.stack {
                Some(Stack::Toward(direction)) => Some(direction),
                _ => None,
            },
            method: match part.method {
                Some(Method::Paper) => fit::Method::Paper,
                None => fit::Method::Adjoint,
            },
            min_bend_radius_mm: self.profile.min_bend_radius_mm,
            min_void_mm: self.profile.min_void_mm,
            min_section_mm: self.joint().min_section_mm(),
            ..fit::Settings::default()
        };
        settings.stack.layers = part.layers;
        // A loop of height h bends to about h / 2.6 where it is tightest, and its diagonal leaves voids of about h / 1.9.
        let makeable = (2.6 * self.profile.min_bend_radius_mm).max(1.65 * self.profile.min_void_mm);
        settings.stack.min_layer_mm = settings.stack.min_layer_mm.max(makeable);
        settings.stack.max_layer_mm = settings.stack.max_layer_mm.max(makeable);
        settings
    }

    /// What edits by hand may not do.
    pub fn edit_limits(&self) -> Limits {
        Limits { min_bend_radius_mm: self.profile.min_bend_radius_mm, min_void_mm: self.profile.min_void_mm }
    }

    /// The joint for this tool.
    pub fn joint(&self) -> strip::Joint {
        let joint = self.profile.joint_for(self.machine.tool.class);
        let holes = self.profile.joint.holes;
        let (fastening, min_width_mm, edge_distance_mm) = match self.making.joint.unwrap_or(self.profile.joint.kind) {
            JointKind::Flap => (strip::Fastening::Flap, joint.min_width_mm, joint.edge_distance_mm),
            JointKind::Holes => {
                (strip::Fastening::Holes { diameter_mm: holes.diameter_mm }, 2.0 * holes.edge_mm, holes.edge_mm)
            }
            JointKind::Mark => (strip::Fastening::Mark, joint.min_width_mm, joint.edge_distance_mm),
        };
        strip::Joint {
            fastening,
            min_width_mm,
            neck_mm: joint.neck_mm,
            barb_mm: joint.barb_mm,
            neck_length_mm: joint.neck_length_mm,
            head_length_mm: joint.head_length_mm,
            tip_width_mm: joint.tip_width_mm,
            tip_radius_mm: joint.tip_radius_mm,
            shoulder_undercut_rad: joint.shoulder_undercut_deg.to_radians(),
            corner_radius_mm: joint.corner_radius_mm,
            hook_radius_mm: joint.hook_radius_mm.unwrap_or(0.0),
            hinge: joint.hinge.map(|d| strip::Dashes { cut_mm: d.cut_mm, gap_mm: d.gap_mm }),
            slit_length_mm: joint.slit_length_mm(),
            slit_width_mm: joint.slit_width_mm.unwrap_or(0.0),
            slit_relief_mm: joint.slit_relief_mm.unwrap_or(0.0),
            slit_ahead_mm: joint.slit_ahead_mm,
            edge_distance_mm,
            cut_distance_mm: joint.cut_distance_mm,
            end_tab_mm: joint.end_tab_mm,
            thickness_mm: self.profile.thickness_mm,
            min_retention_mm: joint.min_retention_mm,
        }
    }

    /// How strips become pieces of at most `max_piece_mm`.
    pub fn strip(&self, max_piece_mm: f64) -> strip::Settings {
        strip::Settings {
            joint: self.joint(),
            kerf_mm: self.pairing.cut.kerf_mm,
            max_piece_mm,
            splice: strip::SpliceSettings {
                kind: match self.making.splice.unwrap_or(self.profile.splice_kind()) {
                    SpliceKind::Connection => strip::SpliceKind::Connection,
                    SpliceKind::Lap => strip::SpliceKind::Lap,
                    SpliceKind::DovetailTape => strip::SpliceKind::DovetailTape,
                    SpliceKind::Finger => strip::SpliceKind::Finger,
                },
                connection_mm: self.profile.splice.connection_mm,
                lap_mm: self.profile.splice.lap_mm,
                rows_mm: self.profile.splice.rows_mm,
                thread_hole_mm: self.profile.splice.thread_hole_mm,
            },
            labels: self.labels(),
            clean_outside: self.making.visible_face == Some(VisibleFace::Clean),
            grammage_g_per_m2: self.profile.grammage_g_per_m2,
        }
    }

    /// How pieces are placed.
    pub fn nest(&self) -> nest::Settings {
        // The cut itself needs room, however close the user wants the pieces.
        let kerf = self.pairing.cut.kerf_mm;
        let (spacing_mm, margin_mm) = (self.profile.spacing_mm.max(kerf), self.margin_mm().max(0.5 * kerf));
        nest::Settings { spacing_mm, margin_mm, effort: NEST_EFFORT, seed: NEST_SEED }
    }

    /// Turns a piece may take on a sheet whose grain runs along x, degrees.
    pub fn angles_deg(&self) -> Vec<f64> {
        match (self.profile.grain, self.strip_along) {
            (Grain::Directional, StripAlong::Grain) => vec![0.0, 180.0],
            (Grain::Directional, StripAlong::Across) => vec![90.0, 270.0],
            (Grain::None, _) => vec![0.0, 180.0, 90.0, 270.0],
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
    let energy = |pairing: &Pairing| {
        let full_power_w = machine.tool.optical_power_w?;
        Some(gcode::Energy { full_power_w, cut_j_per_mm: pairing.cut.energy_j_per_mm(full_power_w) })
    };
    gcode::CheckSettings {
        work_area: reach(machine),
        travel_z_mm: controller.max_travel_mm[2],
        keep_outs: obstacles(machine),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_across_the_grain_bend_as_soft_as_they_are_cut() {
        let text = "schema = 1\nmachine = \"diode-400\"\nmaterial = \"paper-160\"\nmesh = { file = \"a.obj\" }\n[[part]]\nname = \"A\"\n";
        let along = |word: &str| {
            let design = Design::parse("d.toml", &format!("strip_along = \"{word}\"\n{text}")).unwrap();
            Setup::new(&design, &Library::built_in()).unwrap()
        };
        let (grain, across) = (along("grain"), along("across"));
        assert_eq!((grain.material().flexural_rigidity_n_mm, grain.angles_deg()), (2.1, vec![0.0, 180.0]));
        assert_eq!((across.material().flexural_rigidity_n_mm, across.angles_deg()), (0.9, vec![90.0, 270.0]));
    }
}
