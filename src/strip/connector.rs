//! Strips that tie two parts together: each end lies in a joint of one part, between the flap's sheet and the slit's, and the joint's own flap goes through it on its
//! way (paper section 3.2). From between two sheets it gets out of the ruffle where they part; from behind them it would have to cross a wall.

use super::{Error, Face, Half, Passage, Piece, Seat, Settings};
use crate::drawing::{Drawing, DrawnPath, KerfSide, Role, text_paths, text_width};
use crate::fit::Part;
use crate::geom::{Motion, P2, P3, Path, V2, V3};
use crate::ruffle::ConnectionPoint;
use std::ops::Range;

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

/// A joint that a connector holds already counts as this much farther away, mm: a flap through four sheets is hard to close.
const TAKEN_MM: f64 = 15.0;

/// The joints nearest to the two ends of the line in which two parts meet (mesh frame, mm), one pair for each end; one pair only where both ends give the same.
/// Joints that are `taken` by other connectors are passed over where another one is near.
pub fn nearest_joints(
    parts: &[Part],
    [a, b]: [usize; 2],
    line: [P3; 2],
    taken: &[[PartJoint; 2]],
) -> Vec<[PartJoint; 2]> {
    let nearest = |part: usize, to: P3| {
        let joints = parts[part].ruffle.connection_points();
        let distance = |c: &ConnectionPoint| {
            let held = taken.iter().flatten().any(|t| *t == PartJoint { part, joint: c.joint });
            (place(&parts[part], c.node.index()) - to).norm() + if held { TAKEN_MM } else { 0.0 }
        };
        let best = joints.iter().min_by(|s, t| distance(s).total_cmp(&distance(t)));
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

/// The connector between two joints. `pieces` are those of all parts, laid flat with these joints tied: they tell where the flaps are.
///
/// # Errors
/// A joint that its part does not have, or that has no flap.
pub fn connector(
    parts: &[Part],
    pieces: &[Piece],
    [from, to]: [PartJoint; 2],
    settings: &Settings,
) -> Result<Connector, Error> {
    let (start, end) = (End::new(parts, pieces, from)?, End::new(parts, pieces, to)?);
    let joint = &settings.joint;
    let pairs = start.seats.iter().flat_map(|a| end.seats.iter().map(|b| (*a, *b)));
    let apart = |(a, b): &(Seat, Seat)| (start.at(a) - end.at(b)).norm();
    let nearest = pairs.min_by(|s, t| apart(s).total_cmp(&apart(t)));
    let Some((a, b)) = nearest else {
        return Err(Error::NoFlap { from: start.name, to: end.name });
    };
    let (p, mut q) = (start.at(&a), end.at(&b));
    let mut shift = 0.0;
    if start.normal.dot(&end.normal).abs() > SAME_ACROSS {
        shift = (q - p).dot(&start.normal);
        q -= start.normal * shift;
    }
    // Either end may leave its joint either way along the strip there: the shortest strip is meant.
    let ways = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let length = |(f, t): &(f64, f64)| bent_length_mm(p, start.along * *f, q, end.along * *t);
    let way = ways.iter().min_by(|a, b| length(a).total_cmp(&length(b))).unwrap_or(&ways[0]);
    let between = length(way).max(2.0 * joint.cut_distance_mm);
    // Flaps that point along the strip of their part point along this one or against it.
    let passages = [
        start.passage(0.0, Seat { across_mm: 0.0, direction: a.direction * way.0 }),
        end.passage(between, Seat { across_mm: shift, direction: b.direction * way.1 }),
    ];
    let name = format!("{}-{}", start.name, end.name);
    let (drawing, range) = drawn(&name, &passages, settings);
    let grammage = settings.grammage_g_per_m2;
    let piece = Piece::new(name, &parts[from.part].name, drawing, (range, passages.to_vec()), grammage);
    Ok(Connector { from: start.name, to: end.name, piece })
}

/// The flat piece, a band with a slit near each end and the joints' numbers behind them; and from where to where it runs, mm.
fn drawn(name: &str, passages: &[Passage; 2], settings: &Settings) -> (Drawing, Range<f64>) {
    let joint = &settings.joint;
    let lettered = settings.labels.drawn_mm().unwrap_or(0.0);
    let text = |s: &str| text_width(s, lettered);
    let cuts = passages.each_ref().map(|p| p.bounds(joint));
    let [from, to] = passages.each_ref().map(|p| p.joint.as_str());
    let tab = |s: &str| joint.end_tab_mm.max(text(s) + 2.0 * CLEAR_MM);
    let half = 0.5 * joint.min_width_mm;
    let (left, right) = (cuts[0].min.x - tab(from), cuts[1].max.x + tab(to));
    let middles = cuts.map(|c| c.center().y);
    let (low, high) = (middles[0].min(middles[1]) - half, middles[0].max(middles[1]) + half);
    let corners = [(left, low), (right, low), (right, high), (left, high)].map(|(x, y)| (P2::new(x, y), CORNER_MM));
    let mut paths = vec![DrawnPath {
        path: Path::rounded(&corners, true),
        role: Role::Outline,
        kerf: KerfSide::Outside,
        joint: None,
    }];
    paths.extend(passages.iter().flat_map(|p| p.paths(joint)));
    if let Some(height) = settings.labels.drawn_mm() {
        let mut letter = |s: &str, joint: Option<&str>, corner: V2| {
            paths.extend(text_paths(s, height).iter().map(|path| DrawnPath {
                path: path.moved(&Motion::new(corner, 0.0)),
                role: Role::Label,
                kerf: KerfSide::On,
                joint: joint.map(str::to_owned),
            }));
        };
        letter(from, Some(from), V2::new(cuts[0].min.x - CLEAR_MM - text(from), middles[0] - 0.5 * height));
        letter(to, Some(to), V2::new(cuts[1].max.x + CLEAR_MM, middles[1] - 0.5 * height));
        let title = format!("PIECE {name}");
        let (room, center) = (cuts[1].min.x - cuts[0].max.x, 0.5 * (cuts[0].max.x + cuts[1].min.x));
        if text(&title) + 2.0 * CLEAR_MM < room {
            let middle = 0.5 * (middles[0] + middles[1]);
            letter(&title, None, V2::new(center - 0.5 * text(&title), middle - 0.5 * height));
        }
    }
    (Drawing { name: name.to_owned(), paths }, left..right)
}

/// One end of a connector: a joint as it lies in space.
struct End {
    name: String,
    place: P3,
    /// Unit vectors, mesh frame: along the strip where it carries the flaps, and across it.
    along: V3,
    normal: V3,
    /// The joint's flaps.
    seats: Vec<Seat>,
    /// Sheets they go through, connectors counted.
    sheets: usize,
}

impl End {
    fn new(parts: &[Part], pieces: &[Piece], joint: PartJoint) -> Result<End, Error> {
        let part = &parts[joint.part];
        let joints = part.ruffle.connection_points();
        let name = format!("{}{}", part.name, joint.joint);
        let Some(connection) = joints.iter().find(|c| c.joint == joint.joint) else {
            return Err(Error::NoSuchJoint { part: part.name.clone(), joint: joint.joint, last: joints.len() });
        };
        let own = pieces.iter().filter(|p| p.part == part.name).flat_map(|p| &p.passages);
        let flaps = own.filter(|p| p.joint == name && p.half == Half::Flap).max_by_key(|p| p.seats.len());
        let stations = part.ruffle.stations();
        let station = flaps.map_or(0.0, |f| f.station_mm);
        let off = |k: &&usize| (stations[**k] - station).abs();
        let pass = connection.passes.iter().min_by(|a, b| off(a).total_cmp(&off(b))).copied().unwrap_or(0);
        let x = &part.equilibrium.positions;
        let (before, after) = (pass.saturating_sub(1), (pass + 1).min(stations.len() - 1));
        let run = (x[part.ruffle.at(after)] - x[part.ruffle.at(before)]).normalize();
        Ok(End {
            name,
            place: place(part, connection.node.index()),
            along: part.frame.u * run.x + part.frame.v * run.y,
            normal: part.frame.normal,
            seats: flaps.map_or_else(Vec::new, |f| f.seats.clone()),
            sheets: flaps.map_or(0, |f| f.sheets),
        })
    }

    /// A flap's place in space.
    fn at(&self, seat: &Seat) -> P3 {
        self.place + self.normal * seat.across_mm
    }

    /// What a connector carries at this end: the first slit its flap goes through.
    fn passage(&self, station_mm: f64, seat: Seat) -> Passage {
        Passage {
            joint: self.name.clone(),
            station_mm,
            half: Half::Slit,
            face: Face::Back,
            depth: 1,
            sheets: self.sheets,
            seats: vec![seat],
        }
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

#[cfg(test)]
mod tests {
    use super::super::tests::{part, settings};
    use super::super::{joint, pieces};
    use super::*;
    use crate::geom::contains;

    /// A filled square and the same one as a second part, 120 mm higher and `before` mm nearer to the viewer.
    fn two(before: f64) -> (Vec<Part>, Vec<Piece>) {
        let last = part(40.0).ruffle.connection_points().len() as u32;
        let lower = part(40.0);
        let mut upper = Part { name: "B".into(), ..lower.clone() };
        upper.frame.origin += V3::new(0.0, 120.0, before);
        let parts = vec![lower, upper];
        let pieces = parts
            .iter()
            .zip([last, 1])
            .flat_map(|(p, tied)| pieces(p, &[tied], &settings(5000.0)).unwrap().pieces)
            .collect();
        (parts, pieces)
    }

    fn joint_at(part: usize, joint: u32) -> PartJoint {
        PartJoint { part, joint }
    }

    #[test]
    fn a_connector_has_a_slit_for_each_joint_as_far_apart_as_they_lie_in_space() {
        let (parts, laid) = two(7.0);
        let last = parts[0].ruffle.connection_points().len() as u32;
        let made = connector(&parts, &laid, [joint_at(0, last), joint_at(1, 1)], &settings(5000.0)).unwrap();
        assert_eq!((made.from.clone(), made.to.as_str()), (format!("A{last}"), "B1"));
        assert_eq!(made.piece.name, format!("A{last}-B1"));
        let [a, b] = [&made.piece.passages[0], &made.piece.passages[1]];
        let node = |part: usize, joint: u32| {
            let joints = parts[part].ruffle.connection_points();
            place(&parts[part], joints.iter().find(|c| c.joint == joint).unwrap().node.index())
        };
        let mut way = node(1, 1) - node(0, last);
        way.z = 0.0;
        let between = b.station_mm - a.station_mm;
        assert!((way.norm()..1.5 * way.norm()).contains(&between), "{between} for {}", way.norm());
        assert!((b.seats[0].across_mm - 7.0).abs() < 1e-9, "the second part lies 7 mm nearer");
        assert_eq!((a.depth, a.sheets), (1, 2), "between the flap's sheet and the slit's");
        let own = laid.iter().flat_map(|p| &p.passages).find(|p| p.joint == b.joint && p.half == Half::Slit).unwrap();
        assert_eq!((own.depth, own.sheets), (2, 2), "the part's own slit comes after the connector's");
        let contour = made.piece.drawing.outline().unwrap().flatten(0.01);
        for cut in made.piece.drawing.paths.iter().filter(|p| p.role != Role::Outline) {
            assert!(cut.path.flatten(0.01).iter().all(|p| contains(&contour, *p)), "{:?} {:?}", cut.role, cut.joint);
        }
        let width = joint::paper().min_width_mm + 7.0;
        assert!((made.piece.width_mm - width).abs() < 1e-9);
        let missing = connector(&parts, &laid, [joint_at(0, 99), joint_at(1, 1)], &settings(5000.0)).unwrap_err();
        assert!(missing.to_string().contains("joint A99, but part A has joints A1 to"), "{missing}");
    }

    #[test]
    fn parts_are_tied_at_both_ends_of_the_line_in_which_they_meet() {
        let (parts, _) = two(0.0);
        let left = P3::new(10.0, 110.0, 0.0);
        let pairs = nearest_joints(&parts, [0, 1], [left, P3::new(90.0, 110.0, 0.0)], &[]);
        assert_eq!(pairs.len(), 2);
        for [from, to] in &pairs {
            assert_eq!((from.part, to.part), (0, 1));
        }
        assert_eq!(nearest_joints(&parts, [0, 1], [left, left], &[]).len(), 1);
    }
}
