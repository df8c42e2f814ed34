//! Strips that tie two parts together: each end lies over a joint of one part, and the joint's own flap goes through it as well (paper section 3.2).

use super::{Error, Piece, Settings};
use crate::drawing::{Drawing, DrawnPath, KerfSide, Role, text_paths, text_width};
use crate::fit::Part;
use crate::geom::{Motion, P2, P3, Path, V2, V3};

/// A joint of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartJoint {
    /// The part, by number.
    pub part: usize,
    /// The joint's number in the part.
    pub joint: u32,
}

/// A connector and the joints it ties.
#[derive(Debug, Clone, PartialEq)]
pub struct Connector {
    /// Joint at its start: "A7".
    pub from: String,
    /// Joint at its end: "B2".
    pub to: String,
    /// What is cut.
    pub piece: Piece,
}

/// Room around lettering, mm.
const CLEAR_MM: f64 = 1.5;
/// Rounding of the ends' corners, mm: a sharp one snags.
const CORNER_MM: f64 = 3.0;
/// Planes that lean to each other by no more than this (18 degrees) share the direction across; between others a connector twists.
const SAME_ACROSS: f64 = 0.95;

/// The joints nearest to the two ends of the line in which two parts meet (mesh frame, mm), one pair for each end; one pair only where both ends give the same.
pub fn nearest_joints(parts: &[Part], [a, b]: [usize; 2], line: [P3; 2]) -> Vec<[PartJoint; 2]> {
    let nearest = |part: usize, to: P3| {
        let joints = parts[part].ruffle.connection_points();
        let distance = |node: usize| (place(&parts[part], node) - to).norm();
        let best = joints.iter().min_by(|s, t| distance(s.node.index()).total_cmp(&distance(t.node.index())));
        best.map(|c| PartJoint { part, joint: c.joint })
    };
    let mut pairs: Vec<[PartJoint; 2]> = Vec::new();
    for end in line {
        if let (Some(from), Some(to)) = (nearest(a, end), nearest(b, end))
            && !pairs.iter().any(|[f, t]| *f == from || *t == to)
        {
            pairs.push([from, to]);
        }
    }
    pairs
}

/// The connector between two joints. `pieces` are those of all parts: they tell where the flaps are.
///
/// # Errors
/// A joint that its part does not have.
pub fn connector(
    parts: &[Part],
    pieces: &[Piece],
    [from, to]: [PartJoint; 2],
    settings: &Settings,
) -> Result<Connector, Error> {
    let (start, end) = (End::new(parts, pieces, from)?, End::new(parts, pieces, to)?);
    let joint = &settings.joint;
    let apart = |w: &(f64, f64)| (start.at(w.0) - end.at(w.1)).norm();
    let pairs = start.flaps_mm.iter().flat_map(|a| end.flaps_mm.iter().map(|b| (*a, *b)));
    let (w0, w1) = pairs.min_by(|s, t| apart(s).total_cmp(&apart(t))).unwrap_or((0.0, 0.0));
    let (p, mut q) = (start.at(w0), end.at(w1));
    let mut shift = 0.0;
    if start.normal.dot(&end.normal).abs() > SAME_ACROSS {
        shift = (q - p).dot(&start.normal);
        q -= start.normal * shift;
    }
    // Either end may leave its joint either way along the strip there: the shortest strip is meant.
    let ways = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(a, b)| (start.along * a, end.along * b));
    let length = |way: &(V3, V3)| bent_length_mm(p, way.0, q, way.1);
    let way = ways.iter().min_by(|a, b| length(a).total_cmp(&length(b))).unwrap_or(&ways[0]);
    let between = length(way).max(2.0 * joint.cut_distance_mm);
    let lead = |points: V3, leaves: V3| joint.slit_ahead_mm * points.dot(&leaves).signum();
    let slits = [
        (P2::new(lead(start.points, way.0), 0.0), &start.name),
        (P2::new(between + lead(end.points, way.1), shift), &end.name),
    ];
    let name = format!("{}-{}", start.name, end.name);
    let drawing = drawn(&name, slits, settings);
    let piece = Piece::new(name, &parts[from.part].name, drawing, settings.grammage_g_per_m2);
    Ok(Connector { from: start.name, to: end.name, piece })
}

/// The flat piece: a band with a slit near each end, the joints' numbers behind them.
fn drawn(name: &str, slits: [(P2, &String); 2], settings: &Settings) -> Drawing {
    let joint = &settings.joint;
    let lettered = settings.label_mm.unwrap_or(0.0);
    let text = |s: &str| text_width(s, lettered);
    let tab = |s: &str| joint.end_tab_mm.max(text(s) + 2.0 * CLEAR_MM + joint.slit_width_mm);
    let half = 0.5 * joint.min_width_mm;
    let [(a, from), (b, to)] = slits;
    let (left, right) = (a.x - tab(from), b.x + tab(to));
    let (low, high) = (a.y.min(b.y) - half, a.y.max(b.y) + half);
    let corners = [(left, low), (right, low), (right, high), (left, high)].map(|(x, y)| (P2::new(x, y), CORNER_MM));
    let mut paths = vec![DrawnPath {
        path: Path::rounded(&corners, true),
        role: Role::Outline,
        kerf: KerfSide::Outside,
        joint: None,
    }];
    for (at, name) in slits {
        let slit = joint.slit().moved(&Motion::new(at.coords, 0.0));
        let kerf = if slit.closed { KerfSide::Inside } else { KerfSide::On };
        paths.push(DrawnPath { path: slit, role: Role::Slit, kerf, joint: Some(name.clone()) });
    }
    if let Some(height) = settings.label_mm {
        let mut letter = |s: &str, joint: Option<&String>, corner: V2| {
            paths.extend(text_paths(s, height).iter().map(|path| DrawnPath {
                path: path.moved(&Motion::new(corner, 0.0)),
                role: Role::Label,
                kerf: KerfSide::On,
                joint: joint.cloned(),
            }));
        };
        let aside = CLEAR_MM + 0.5 * joint.slit_width_mm;
        letter(from, Some(from), V2::new(a.x - aside - text(from), a.y - 0.5 * height));
        letter(to, Some(to), V2::new(b.x + aside, b.y - 0.5 * height));
        let title = format!("PIECE {name}");
        let (room, middle) = (b.x - a.x - 2.0 * aside, 0.5 * (a.x + b.x - text(&title)));
        if text(&title) < room {
            letter(&title, None, V2::new(middle, 0.5 * (a.y + b.y - height)));
        }
    }
    Drawing { name: name.to_owned(), paths }
}

/// One end of a connector: a joint as it lies in space.
struct End {
    name: String,
    place: P3,
    /// Unit vectors, mesh frame: along the strip, the way the flap points, and across the strip.
    along: V3,
    points: V3,
    normal: V3,
    /// Middles of the joint's flaps across the strip, mm.
    flaps_mm: Vec<f64>,
}

impl End {
    fn new(parts: &[Part], pieces: &[Piece], joint: PartJoint) -> Result<End, Error> {
        let part = &parts[joint.part];
        let joints = part.ruffle.connection_points();
        let name = format!("{}{}", part.name, joint.joint);
        let Some(connection) = joints.iter().find(|c| c.joint == joint.joint) else {
            return Err(Error::NoSuchJoint { part: part.name.clone(), joint: joint.joint, last: joints.len() });
        };
        let own = pieces.iter().filter(|p| p.part == part.name).flat_map(|p| &p.drawing.paths);
        let flaps: Vec<(P2, f64)> = own
            .filter(|d| d.role == Role::Flap && d.joint.as_ref() == Some(&name))
            .map(|d| {
                let ends = [d.path.start(), d.path.end()].map(Option::unwrap_or_default);
                let root = nalgebra::center(&ends[0], &ends[1]);
                (root, (d.path.bounds().center().x - root.x).signum())
            })
            .collect();
        let (root, ahead) = flaps.first().copied().unwrap_or((P2::origin(), 1.0));
        let stations = part.ruffle.stations();
        let off = |k: &&usize| (stations[**k] - root.x).abs();
        let pass = connection.passes.iter().min_by(|a, b| off(a).total_cmp(&off(b))).copied().unwrap_or(0);
        let x = &part.equilibrium.positions;
        let (before, after) = (pass.saturating_sub(1), (pass + 1).min(stations.len() - 1));
        let run = (x[part.ruffle.at(after)] - x[part.ruffle.at(before)]).normalize();
        let along = part.frame.u * run.x + part.frame.v * run.y;
        Ok(End {
            name,
            place: place(part, connection.node.index()),
            along,
            points: along * ahead,
            normal: part.frame.normal,
            flaps_mm: flaps.iter().map(|(root, _)| root.y).collect(),
        })
    }

    /// The joint's place in space `across_mm` before its plane.
    fn at(&self, across_mm: f64) -> P3 {
        self.place + self.normal * across_mm
    }
}

/// Where a node of a part lies in space, in the part's plane, mm.
fn place(part: &Part, node: usize) -> P3 {
    part.frame.to_space(part.equilibrium.positions[node], 0.0)
}

/// Length of the smooth curve (cubic, handles of a third) that leaves `p` along `a` and comes into `q` along `b`, mm: a strip bends, it has no corners.
fn bent_length_mm(p: P3, a: V3, q: P3, b: V3) -> f64 {
    let reach = (q - p).norm() / 3.0;
    let (c, d) = (p + a * reach, q - b * reach);
    let at = |t: f64| {
        let s = 1.0 - t;
        p.coords * (s * s * s) + c.coords * (3.0 * s * s * t) + d.coords * (3.0 * s * t * t) + q.coords * (t * t * t)
    };
    const STEPS: usize = 64;
    (0..STEPS).map(|i| (at((i + 1) as f64 / STEPS as f64) - at(i as f64 / STEPS as f64)).norm()).sum()
}
