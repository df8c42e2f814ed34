//! Where flaps and slits go: the flaps of a connection point on one pass of the strip, slits on the others.

use super::edge::Edges;
use super::fold::Meeting;
use super::joint::{Fastening, Joint};
use super::passage::{Half, Passage, Seat};
use super::seats;
use crate::fit::Part;
use crate::geom::tolerance;
use crate::progress::Warning;
use crate::ruffle::ConnectionPoint;

/// Passages of every connection point, by station, and what the user should know. `tied` are the numbers of joints that a connector lies in, between the flap's sheet
/// and the next: from there it gets out where the two sheets part. Once for each connector.
pub(super) fn passages(part: &Part, edges: &Edges, joint: &Joint, tied: &[u32]) -> (Vec<Passage>, Vec<Warning>) {
    let stations = part.ruffle.stations();
    let connections = part.ruffle.connection_points();
    let mut site = Site { connections: &connections, stations: &stations, edges, joint, placed: Vec::new() };
    let mut beds: Vec<(f64, String)> = Vec::new();
    for connection in &connections {
        let name = format!("{}{}", part.name, connection.joint);
        let meeting = Meeting::new(part, connection);
        let (flap_pass, face, through) = meeting.flap_pass(joint.head_length_mm);
        let between = tied.iter().filter(|number| **number == connection.joint).count();
        let sheets = through.len() + between;
        let bed = site.bed(connection, flap_pass, sheets);
        beds.push(((bed.hi - bed.lo).max(0.0), name.clone()));
        let middles = bed.middles(joint);
        let passage = |pass: usize, half: Half, face, depth: usize| {
            let alignment = meeting.alignment(flap_pass, pass);
            let seat = |(i, w): (usize, &f64)| Seat { across_mm: *w, direction: alignment * bed.way.direction(i) };
            let seats = middles.iter().enumerate().map(seat).collect();
            let station_mm = stations[connection.passes[pass]];
            Passage { joint: name.clone(), station_mm, half, face, depth, sheets, seats }
        };
        let (from, into) = match joint.fastening {
            Fastening::Flap => (Half::Flap, Half::Slit),
            Fastening::Holes { diameter_mm } => (Half::Holes { diameter_mm }, Half::Holes { diameter_mm }),
            Fastening::Mark => (Half::Mark, Half::Mark),
        };
        site.placed.push(passage(flap_pass, from, face, 0));
        for (i, pass) in through.into_iter().enumerate() {
            site.placed.push(passage(pass, into, meeting.face_toward(pass, flap_pass), between + i + 1));
        }
    }
    let mut passages = site.placed;
    passages.sort_by(|a, b| a.station_mm.total_cmp(&b.station_mm));
    let warnings = narrow(&beds, joint).into_iter().chain(weak(&beds, joint)).chain(crowded(&passages, joint));
    (passages, warnings.map(|w| w.in_part(&part.name)).collect())
}

/// Which way the flaps of a joint point on their own pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Ahead,
    Back,
    /// Ahead and back by turns: they lock both ways, and each station is cut by every other one only.
    Both,
}

impl Way {
    /// Of the `i`-th flap.
    fn direction(self, i: usize) -> f64 {
        match self {
            Way::Ahead => 1.0,
            Way::Back => -1.0,
            Way::Both => [1.0, -1.0][i % 2],
        }
    }

    /// How far flaps reach behind and ahead of their hinge, mm.
    fn reach(self, joint: &Joint, sheets: usize) -> (f64, f64) {
        let (behind, ahead) = joint.reach_both_ways_mm(sheets);
        match self {
            Way::Ahead => (behind, ahead),
            Way::Back => (ahead, behind),
            Way::Both => (ahead, ahead),
        }
    }
}

/// Where a joint lies across the strip, and which way its flaps point on their own pass.
#[derive(Debug, Clone, Copy)]
struct Bed {
    lo: f64,
    hi: f64,
    way: Way,
}

impl Bed {
    fn middles(&self, joint: &Joint) -> Vec<f64> {
        seats::middles(self.lo, self.hi, joint, self.way == Way::Both)
    }
}

/// The strip while its joints are laid out one by one.
struct Site<'a> {
    connections: &'a [ConnectionPoint],
    stations: &'a [f64],
    edges: &'a Edges,
    joint: &'a Joint,
    placed: Vec<Passage>,
}

impl Site<'_> {
    /// Where a joint lies. Its flaps point whichever way gives enough width, then leaves room to other joints, then holds more flaps, then gives most width; on an end
    /// of the strip always inward.
    fn bed(&self, connection: &ConnectionPoint, flap_pass: usize, sheets: usize) -> Bed {
        let at = connection.passes[flap_pass];
        let ways: &[Way] = match at {
            0 => &[Way::Ahead],
            k if k + 1 == self.stations.len() => &[Way::Back],
            _ => &[Way::Both, Way::Ahead, Way::Back],
        };
        let beds = ways.iter().map(|way| self.band(connection, flap_pass, sheets, *way));
        // One flap points one way.
        let usable = beds.filter(|bed| bed.way != Way::Both || bed.middles(self.joint).len() > 1);
        let tenths = |mm: f64| (mm * 10.0).round() as i64;
        let rank = |bed: &Bed| {
            let width = bed.hi - bed.lo;
            let enough = width >= self.joint.least_bed_mm() - tolerance::LIMIT_SLACK_MM;
            let room = self.room_mm(connection, self.stations[at], bed.way.reach(self.joint, sheets));
            (enough, tenths(room), bed.middles(self.joint).len(), tenths(width))
        };
        usable
            .reduce(|kept, bed| if rank(&bed) > rank(&kept) { bed } else { kept })
            .expect("ahead or back is always among the ways")
    }

    /// The widest band that holds the flaps on their pass and the slits on the others, with room to the edges before and behind. Upside down when there is none.
    fn band(&self, connection: &ConnectionPoint, flap_pass: usize, sheets: usize, way: Way) -> Bed {
        let (clear, lead) = (self.joint.edge_distance_mm, self.joint.lead_mm(sheets));
        let (mut lo, mut hi) = (f64::NEG_INFINITY, f64::INFINITY);
        for (pass, k) in connection.passes.iter().enumerate() {
            let (back, front) = if pass == flap_pass { way.reach(self.joint, sheets) } else { (lead, lead) };
            let s = self.stations[*k];
            let (l, h) = self.edges.band(s - back - clear..s + front + clear);
            (lo, hi) = (lo.max(l), hi.min(h));
        }
        Bed { lo, hi, way }
    }

    /// Least distance from flaps that reach that far behind and ahead of a station to the cuts of other joints, mm; no more than asked for. Joints that are not laid out
    /// yet count with the place of their slits.
    fn room_mm(&self, connection: &ConnectionPoint, s: f64, (back, front): (f64, f64)) -> f64 {
        let gap = |from: f64, to: f64| (from - (s + front)).max(s - back - to);
        let placed = self.placed.iter().map(|p| p.bounds(self.joint)).map(|b| gap(b.min.x, b.max.x));
        let others = self.connections.iter().filter(|c| c.node != connection.node).flat_map(|c| &c.passes);
        let passes = others.map(|k| gap(self.stations[*k], self.stations[*k]));
        placed.chain(passes).fold(self.joint.cut_distance_mm, f64::min)
    }
}

/// Joints with less strip than they need, worst first, told once.
fn narrow(beds: &[(f64, String)], joint: &Joint) -> Option<Warning> {
    let mut short: Vec<&(f64, String)> =
        beds.iter().filter(|(width, _)| *width < joint.least_bed_mm() - tolerance::LIMIT_SLACK_MM).collect();
    short.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (width, name) = short.first()?;
    let names: Vec<&str> = short.iter().map(|(_, name)| name.as_str()).collect();
    let message = format!(
        "too little strip for the flap: {width:.1} mm at joint {name}, {:.1} mm are needed or it may tear out. Make the shape larger or deeper",
        joint.least_bed_mm()
    );
    Some(Warning::new("joint-narrow", message).at(format!("joint {}", names.join(", "))))
}

/// Joints whose one flap takes more out of the strip than it should, worst told.
fn weak(beds: &[(f64, String)], joint: &Joint) -> Option<Warning> {
    let strong = seats::strong_width_mm(joint);
    let (width, name) = beds.iter().min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(width, _)| {
        (joint.least_bed_mm() - tolerance::LIMIT_SLACK_MM..strong - tolerance::LIMIT_SLACK_MM).contains(width)
    })?;
    let message = format!(
        "at joint {name} the cuts take {:.0} % of a strip {width:.0} mm wide; where it must carry load, make the shape deeper until {strong:.0} mm are left (at most {:.0} %)",
        100.0 * joint.cut_out_mm() / width,
        100.0 * seats::CUT_OUT_SHARE
    );
    Some(Warning::new("joint-weak", message).at(format!("joint {name}")))
}

/// Joints that lie too close to each other on the strip.
fn crowded(passages: &[Passage], joint: &Joint) -> Vec<Warning> {
    let close = |pair: &[Passage]| {
        let gap = pair[1].bounds(joint).min.x - pair[0].bounds(joint).max.x;
        let message = format!(
            "joints {} and {} lie {gap:.1} mm apart on the strip; below {:.0} mm the sheet between them is weak",
            pair[0].joint, pair[1].joint, joint.cut_distance_mm
        );
        let warning = Warning::new("joint-crowded", message).at(format!("joint {}", pair[1].joint));
        (gap < joint.cut_distance_mm - tolerance::LIMIT_SLACK_MM).then_some(warning)
    };
    passages.windows(2).filter_map(close).collect()
}
