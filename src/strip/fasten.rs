//! Where flaps and slits go: one flap per connection point on the sheet that bends away, slits on the others.

use super::edge::Edges;
use super::joint::Joint;
use crate::drawing::{DrawnPath, KerfSide, Role};
use crate::fit::Part;
use crate::geom::{Motion, P2, Rect, V2, tolerance};
use crate::progress::Warning;
use crate::ruffle::ConnectionPoint;
use std::f64::consts::PI;

/// The flaps, or the slits, of one pass of the strip through one connection point.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fastening {
    /// Joint name, unique in the object: "A7".
    pub joint: String,
    /// Where the strip passes the connection point, mm.
    pub station_mm: f64,
    /// +1 when the flaps of this joint point toward growing s on this pass, -1 when the other way.
    pub direction: f64,
    /// Flap here, or slit for the flap of another pass.
    pub is_flap: bool,
    /// Middles across the strip, mm.
    pub across_mm: Vec<f64>,
}

impl Fastening {
    /// Station of the hinge line or of the slit, mm.
    pub fn cut_station_mm(&self, joint: &Joint) -> f64 {
        if self.is_flap { self.station_mm } else { self.station_mm + self.direction * joint.slit_ahead_mm }
    }

    /// The cuts, strip frame.
    pub fn paths<'a>(&'a self, joint: &'a Joint) -> impl Iterator<Item = DrawnPath> + 'a {
        let (nominal, role) = if self.is_flap { (joint.flap(), Role::Flap) } else { (joint.slit(), Role::Slit) };
        let kerf = match (role, nominal.closed) {
            (Role::Flap, _) => KerfSide::Left,
            (_, true) => KerfSide::Inside,
            (_, false) => KerfSide::On,
        };
        let turn = if self.is_flap && self.direction < 0.0 { PI } else { 0.0 };
        self.across_mm.iter().map(move |w| {
            let motion = Motion::new(V2::new(self.cut_station_mm(joint), *w), turn);
            DrawnPath { path: nominal.moved(&motion), role, kerf, joint: Some(self.joint.clone()) }
        })
    }

    /// The box around all cuts of this fastening, strip frame.
    pub fn bounds(&self, joint: &Joint) -> Rect {
        self.paths(joint).fold(Rect::EMPTY, |rect, p| rect.union(p.path.bounds()))
    }
}

/// Fastenings of every connection point, by station.
pub(super) fn fastenings(part: &Part, edges: &Edges, joint: &Joint) -> (Vec<Fastening>, Vec<Warning>) {
    let stations = part.ruffle.stations();
    let (mut fastenings, mut warnings) = (Vec::new(), Vec::new());
    let mut narrow: Vec<(f64, String)> = Vec::new();
    for connection in part.ruffle.connection_points() {
        let name = format!("{}{}", part.name, connection.joint);
        let flap_pass = flap_pass(part, &connection);
        let Bed { lo, hi, ahead } = bed(&connection, flap_pass, &stations, edges, joint);
        // Neighbouring passes run in opposite directions, so what points ahead on one points back on the next.
        let direction = |pass: usize| if (pass + flap_pass).is_multiple_of(2) { ahead } else { -ahead };
        let width = hi - lo;
        if width < joint.min_width_mm - tolerance::LIMIT_SLACK_MM {
            narrow.push((width.max(0.0), name.clone()));
        }
        let count = joint.count(width);
        let across_mm: Vec<f64> = (0..count).map(|i| lo + width * (2 * i + 1) as f64 / (2 * count) as f64).collect();
        for (pass, k) in connection.passes.iter().enumerate() {
            fastenings.push(Fastening {
                joint: name.clone(),
                station_mm: stations[*k],
                direction: direction(pass),
                is_flap: pass == flap_pass,
                across_mm: across_mm.clone(),
            });
        }
    }
    if let Some((width, name)) = narrow.iter().min_by(|a, b| a.0.total_cmp(&b.0)) {
        let names: Vec<&str> = narrow.iter().map(|(_, name)| name.as_str()).collect();
        warnings.push(
            Warning::new(
                "joint-narrow",
                format!(
                    "too little strip for the flap: {width:.1} mm at joint {name}, {:.0} mm are needed or it may tear out. Make the shape larger or deeper",
                    joint.min_width_mm
                ),
            )
            .in_part(&part.name)
            .at(format!("joint {}", names.join(", "))),
        );
    }
    fastenings.sort_by(|a, b| a.station_mm.total_cmp(&b.station_mm));
    for pair in fastenings.windows(2) {
        let gap = pair[1].bounds(joint).min.x - pair[0].bounds(joint).max.x;
        if gap < joint.cut_distance_mm {
            warnings.push(
                Warning::new(
                    "joint-crowded",
                    format!(
                        "joints {} and {} lie {gap:.1} mm apart on the strip; below {:.0} mm the sheet between them is weak",
                        pair[0].joint, pair[1].joint, joint.cut_distance_mm
                    ),
                )
                .in_part(&part.name)
                .at(format!("joint {}", pair[1].joint)),
            );
        }
    }
    (fastenings, warnings)
}

/// Where a joint lies across the strip, and which way its flap points on its own pass.
struct Bed {
    lo: f64,
    hi: f64,
    ahead: f64,
}

/// The widest band that holds the flap on its pass and the slits on the others, with room to the edges before and behind. The flap points whichever way gives more, on
/// an end of the strip always inward.
fn bed(connection: &ConnectionPoint, flap_pass: usize, stations: &[f64], edges: &Edges, joint: &Joint) -> Bed {
    let clear = joint.edge_distance_mm;
    let band = |ahead: f64| {
        connection.passes.iter().enumerate().fold((f64::NEG_INFINITY, f64::INFINITY), |(lo, hi), (pass, k)| {
            let s = stations[*k];
            let (back, front) = if pass == flap_pass {
                (-ahead * joint.hook_radius_mm, ahead * joint.reach_mm())
            } else {
                (-joint.slit_ahead_mm, joint.slit_ahead_mm)
            };
            let (l, h) = edges.band(s + back.min(front) - clear..s + back.max(front) + clear);
            (lo.max(l), hi.min(h))
        })
    };
    let (on, back) = (band(1.0), band(-1.0));
    let at = connection.passes[flap_pass];
    let only_back = at + 1 == stations.len();
    let wider_back = at > 0 && back.1 - back.0 > on.1 - on.0 + tolerance::LIMIT_SLACK_MM;
    if only_back || wider_back {
        Bed { lo: back.0, hi: back.1, ahead: -1.0 }
    } else {
        Bed { lo: on.0, hi: on.1, ahead: 1.0 }
    }
}

/// The pass that carries the flap. At an end of the strip that is the end: the other sheet lies inside of it, so that the flap goes into the object and not out
/// through its floor or top. Elsewhere the pass that bends most, since a flap on the convex side of a bend lifts by itself toward its partner.
fn flap_pass(part: &Part, connection: &ConnectionPoint) -> usize {
    let (ruffle, x) = (&part.ruffle, &part.equilibrium.positions);
    let bend = |k: usize| {
        if k == 0 || k == ruffle.rest_lengths.len() {
            return f64::INFINITY;
        }
        let (e1, e2) = (x[ruffle.at(k)] - x[ruffle.at(k - 1)], x[ruffle.at(k + 1)] - x[ruffle.at(k)]);
        e1.angle(&e2) / (ruffle.rest_lengths[k - 1] + ruffle.rest_lengths[k])
    };
    (0..connection.passes.len())
        .max_by(|a, b| bend(connection.passes[*a]).total_cmp(&bend(connection.passes[*b])).then(b.cmp(a)))
        .unwrap_or(0)
}

/// Largest distance between where a flap's root finds its slit and where it should, mm. Both are taken from the drawn cuts and bent along the equilibrium: root and
/// slit pass through the same point of space, at the same height, and the slit lies ahead of it by the joint's lead, the way the flap points.
pub(super) fn worst_mating_error_mm<'a>(
    part: &Part,
    cuts: impl Iterator<Item = &'a DrawnPath> + Clone,
    joint: &Joint,
) -> f64 {
    let curve = Curve { part, stations: part.ruffle.stations() };
    let slits = || cuts.clone().filter(|c| c.role == Role::Slit);
    let errors = cuts.clone().filter(|c| c.role == Role::Flap).map(|flap| {
        let ends = [flap.path.start(), flap.path.vertices.last().map(|v| v.point)].map(Option::unwrap_or_default);
        let root = nalgebra::center(&ends[0], &ends[1]);
        let points = curve.direction(root.x) * (flap.path.bounds().center().x - root.x).signum();
        let off = |slit: &DrawnPath| {
            let middle = slit.path.bounds().center();
            let pass = curve.nearest_pass(middle.x, curve.place(root.x));
            let lead = (middle.x - pass) * curve.direction(pass).dot(&points).signum();
            let apart = (curve.place(pass) - curve.place(root.x)).norm();
            apart.hypot(lead - joint.slit_ahead_mm).hypot(middle.y - root.y)
        };
        slits().filter(|s| s.joint == flap.joint).map(off).fold(f64::INFINITY, f64::min)
    });
    errors.fold(0.0, f64::max)
}

/// The strip as it lies, by distance along it.
struct Curve<'a> {
    part: &'a Part,
    stations: Vec<f64>,
}

impl Curve<'_> {
    fn place(&self, s: f64) -> P2 {
        let k = self.stations.partition_point(|t| *t <= s).clamp(1, self.stations.len() - 1);
        let t = (s - self.stations[k - 1]) / (self.stations[k] - self.stations[k - 1]);
        let x = &self.part.equilibrium.positions;
        let (a, b) = (x[self.part.ruffle.at(k - 1)], x[self.part.ruffle.at(k)]);
        a + (b - a) * t
    }

    /// Direction of growing s, over a few millimetres: the strip bends, its segments do not.
    fn direction(&self, s: f64) -> V2 {
        (self.place(s + 2.0) - self.place(s - 2.0)).normalize()
    }

    /// The station near `s` at which the strip comes closest to `at`.
    fn nearest_pass(&self, s: f64, at: P2) -> f64 {
        let near = self.stations.iter().copied().filter(|t| (t - s).abs() < 10.0);
        let distance = |t: f64| (self.place(t) - at).norm();
        near.min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(s)
    }
}
