//! What a design amounts to before anything is cut: its parts, and their sections as people name them when they change something.

use super::pictures;
use super::settings::Setup;
use super::{Error, Order, Realised, realise};
use crate::config::Library;
use crate::cut::PlaneFrame;
use crate::design::{Design, PlaneSource};
use crate::fit::{FootUsed, Part};
use crate::geom::P2;
use crate::preview::Canvas;
use crate::progress::{Observer, Warning};
use crate::ruffle::{Direction, Drawn, Role, loops};
use serde::Serialize;

/// A design and what became of it.
#[derive(Debug, Clone, Serialize)]
pub struct Survey {
    /// Version of this format.
    pub schema: u32,
    /// Machine it is for.
    pub machine: String,
    /// Material it is cut from.
    pub material: String,
    /// Its parts.
    pub parts: Vec<PartSurvey>,
    /// Its edits in words, in order.
    pub edits: Vec<String>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// One part.
#[derive(Debug, Clone, Serialize)]
pub struct PartSurvey {
    /// Name.
    pub name: String,
    /// Where its plane lies in the mesh frame.
    pub plane: PlaneSource,
    /// Layers of its stack, however densified.
    pub layers: Option<usize>,
    /// Which way they lie on each other.
    pub stack: Direction,
    /// How it stands.
    pub foot: FootUsed,
    /// Outline area enclosed over outline area.
    pub filled_fraction: f64,
    /// Strip without end tabs, mm.
    pub strip_length_mm: f64,
    /// Its mass, g.
    pub strip_mass_g: f64,
    /// Where its joints are, the first joint first: u and v in the picture, mm.
    pub joints_mm: Vec<[f64; 2]>,
    /// In strip order; a section's index is its number.
    pub sections: Vec<SectionSurvey>,
    /// The picture of it.
    #[serde(skip)]
    pub picture: Canvas,
    /// Where its plane lies, with both axes of the picture.
    #[serde(skip)]
    pub(super) frame: PlaneFrame,
    /// Where its sections lie, one list of points each, plane frame, mm.
    #[serde(skip)]
    pub(super) paths: Vec<Vec<P2>>,
}

/// One section.
#[derive(Debug, Clone, Serialize)]
pub struct SectionSurvey {
    /// Its number in the picture and in edits.
    pub number: usize,
    /// What it does for the shape.
    pub role: Role,
    /// Whether it is a loop that closes a room: densifying divides that room. Others are folded.
    pub closes_room: bool,
    /// Rest length, mm.
    pub length_mm: f64,
    /// Its middle: u and v in the picture, mm.
    pub middle_mm: [f64; 2],
    /// Joints at its ends, such as "A3"; none where the strip begins or passes only once.
    pub joints: [Option<String>; 2],
    /// How often it was densified.
    pub level: usize,
    /// Whether its length was given by hand.
    pub pinned: bool,
}

/// Works a design out and tells what it is.
pub fn survey(order: &Order, library: &Library, observer: &mut dyn Observer) -> Result<Survey, Error> {
    let setup = Setup::new(&order.design, library)?;
    let realised = realise(&order.design, &order.folder, &setup, observer).map_err(|e| order.placed(e))?;
    Ok(surveyed(&order.design, &setup, &realised))
}

fn surveyed(design: &Design, setup: &Setup, realised: &Realised) -> Survey {
    Survey {
        schema: 1,
        machine: setup.machine.name.clone(),
        material: setup.profile.name.clone(),
        parts: realised.parts.iter().map(part).collect(),
        edits: design.edits.iter().map(ToString::to_string).collect(),
        warnings: realised.warnings.clone(),
    }
}

/// To a tenth of a millimetre, as people give places.
fn place(at: &P2) -> [f64; 2] {
    [at.x, at.y].map(|v| (v * 10.0).round() / 10.0 + 0.0)
}

fn part(part: &Part) -> PartSurvey {
    let (ruffle, frame, report) = (&part.ruffle, &part.frame, &part.report);
    let drawn = Drawn { ruffle: ruffle.clone(), positions: part.equilibrium.positions.clone() };
    let points = ruffle.connection_points();
    let joint = |node| points.iter().find(|c| c.node == node).map(|c| format!("{}{}", part.name, c.joint));
    // A settled part's ruffle is in order.
    let rooms = loops(&drawn).unwrap_or_default();
    let section = |(number, section): (usize, &crate::ruffle::Section)| {
        let (start, end) = ruffle.section_ends(number);
        SectionSurvey {
            number,
            role: section.role,
            closes_room: rooms.contains(&number),
            length_mm: ruffle.section_length(number),
            middle_mm: place(&drawn.positions[ruffle.at((section.first_segment + section.end_segment) / 2)]),
            joints: [joint(start), joint(end)],
            level: ruffle.densified.level(number),
            pinned: section.pinned,
        }
    };
    let path = |s: &crate::ruffle::Section| {
        let nodes = &ruffle.walk[s.first_segment..=s.end_segment];
        nodes.iter().map(|n| drawn.positions[n.index()]).collect()
    };
    PartSurvey {
        name: part.name.clone(),
        plane: PlaneSource {
            origin_mm: [frame.origin.x, frame.origin.y, frame.origin.z],
            normal: [frame.normal.x, frame.normal.y, frame.normal.z],
        },
        layers: Some(ruffle.layers().len()).filter(|n| *n > 0),
        stack: report.direction,
        foot: report.foot,
        filled_fraction: 1.0 - report.uncovered_fraction,
        strip_length_mm: report.strip_length_mm,
        strip_mass_g: report.strip_mass_g,
        joints_mm: points.iter().map(|c| place(&drawn.positions[c.node.index()])).collect(),
        sections: ruffle.sections.iter().enumerate().map(section).collect(),
        picture: pictures::part(part),
        frame: part.frame,
        paths: ruffle.sections.iter().map(path).collect(),
    }
}
