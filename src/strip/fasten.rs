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

/// The widest band that holds the flap on its pass and the slits on the others, with the flap pointing whichever way gives more.
fn bed(connection: &ConnectionPoint, flap_pass: usize, stations: &[f64], edges: &Edges, joint: &Joint) -> Bed {
    let band = |ahead: f64| {
        connection.passes.iter().enumerate().fold((f64::NEG_INFINITY, f64::INFINITY), |(lo, hi), (pass, k)| {
            let s = stations[*k];
            let (back, front) = if pass == flap_pass {
                (-ahead * joint.hook_radius_mm, ahead * joint.reach_mm())
            } else {
                (-joint.slit_ahead_mm, joint.slit_ahead_mm)
            };
            let (l, h) = edges.band(s + back.min(front)..s + back.max(front));
            (lo.max(l), hi.min(h))
        })
    };
    let (on, back) = (band(1.0), band(-1.0));
    if back.1 - back.0 > on.1 - on.0 + tolerance::LIMIT_SLACK_MM {
        Bed { lo: back.0, hi: back.1, ahead: -1.0 }
    } else {
        Bed { lo: on.0, hi: on.1, ahead: 1.0 }
    }
}

/// The pass that carries the flap: the one that bends most, since a flap on the convex side of a bend lifts by itself toward its partner. Never an end of the strip,
/// whose tab is too short for one.
fn flap_pass(part: &Part, connection: &ConnectionPoint) -> usize {
    let (ruffle, x) = (&part.ruffle, &part.equilibrium.positions);
    let bend = |k: usize| {
        if k == 0 || k == ruffle.rest_lengths.len() {
            return 0.0;
        }
        let (e1, e2) = (x[ruffle.at(k)] - x[ruffle.at(k - 1)], x[ruffle.at(k + 1)] - x[ruffle.at(k)]);
        e1.angle(&e2) / (ruffle.rest_lengths[k - 1] + ruffle.rest_lengths[k])
    };
    (0..connection.passes.len())
        .max_by(|a, b| bend(connection.passes[*a]).total_cmp(&bend(connection.passes[*b])).then(b.cmp(a)))
        .unwrap_or(0)
}

/// Pairs of a flap and a slit that belong together.
pub(super) struct Mating<'a>(Vec<(&'a Fastening, &'a Fastening)>);

impl Mating<'_> {
    /// Every flap with every slit of its joint.
    pub fn of(fastenings: &[Fastening]) -> Mating<'_> {
        let flaps = fastenings.iter().filter(|f| f.is_flap);
        let slits = |flap: &'_ Fastening| {
            let joint = flap.joint.clone();
            fastenings.iter().filter(move |f| !f.is_flap && f.joint == joint)
        };
        Mating(flaps.flat_map(|f| slits(f).map(move |s| (f, s))).collect())
    }

    /// Largest distance in space between a flap's root and its slit when both are bent along the equilibrium, lead taken off, mm.
    pub fn worst_error_mm(&self, part: &Part) -> f64 {
        let stations = part.ruffle.stations();
        let place = |s: f64| -> P2 {
            let k = stations.partition_point(|t| *t <= s).clamp(1, stations.len() - 1);
            let t = (s - stations[k - 1]) / (stations[k] - stations[k - 1]);
            let x = &part.equilibrium.positions;
            let (a, b) = (x[part.ruffle.at(k - 1)], x[part.ruffle.at(k)]);
            a + (b - a) * t
        };
        let error = |(flap, slit): &(&Fastening, &Fastening)| {
            let in_plane = (place(flap.station_mm) - place(slit.station_mm)).norm();
            let across = flap.across_mm.iter().zip(&slit.across_mm).map(|(a, b)| (a - b).abs());
            across.fold(in_plane, |worst, d| worst.max(d.hypot(in_plane)))
        };
        self.0.iter().map(error).fold(0.0, f64::max)
    }
}
