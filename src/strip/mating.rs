//! Do the drawn cuts meet in space?

use super::joint::Joint;
use crate::drawing::{DrawnPath, Role};
use crate::fit::Part;
use crate::geom::{P2, V2};
use crate::ruffle::ConnectionPoint;

/// Largest distance between where a flap's root finds its slits and where it should, mm. Both are taken from the drawn cuts and bent along the equilibrium: root and
/// slit pass through the same point of space, at the same height, and the slit lies ahead of it by the joint's lead, the way the flap points. A flap without a slit,
/// or a slit without a flap, is infinitely far off. `tied` are the numbers of joints that a connector lies in.
pub(super) fn worst_mating_error_mm<'a>(
    part: &Part,
    tied: &[u32],
    cuts: impl Iterator<Item = &'a DrawnPath> + Clone,
    joint: &Joint,
) -> f64 {
    let curve = Curve { part, tied, joints: part.ruffle.connection_points(), stations: part.ruffle.stations() };
    let of = |role: Role| cuts.clone().filter(move |c| c.role == role);
    let nearest = |cut: &DrawnPath, errors: &mut dyn Iterator<Item = (f64, &Option<String>)>| {
        let own = errors.filter(|(_, joint)| **joint == cut.joint).map(|(error, _)| error);
        own.fold(f64::INFINITY, f64::min)
    };
    let flaps =
        of(Role::Flap).map(|f| nearest(f, &mut of(Role::Slit).map(|s| (curve.error_mm(f, s, joint), &s.joint))));
    let slits =
        of(Role::Slit).map(|s| nearest(s, &mut of(Role::Flap).map(|f| (curve.error_mm(f, s, joint), &f.joint))));
    flaps.chain(slits).fold(0.0, f64::max)
}

/// A root this close to a connection point belongs to it, mm.
const LAP_MM: f64 = 1.0;

/// The strip as it lies, by distance along it.
struct Curve<'a> {
    part: &'a Part,
    tied: &'a [u32],
    joints: Vec<ConnectionPoint>,
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

    /// The station near `s` at which the strip comes closest to where it is at `root`. In a lap that is the same station.
    fn nearest_pass(&self, s: f64, root: f64) -> f64 {
        let near = self.stations.iter().copied().chain([root]).filter(|t| (t - s).abs() < 10.0);
        let distance = |t: f64| (self.place(t) - self.place(root)).norm();
        near.min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(s)
    }

    /// How far a slit is from where a flap wants it, mm.
    fn error_mm(&self, flap: &DrawnPath, slit: &DrawnPath, joint: &Joint) -> f64 {
        let ends = [flap.path.start(), flap.path.end()].map(Option::unwrap_or_default);
        let root = nalgebra::center(&ends[0], &ends[1]);
        let points = self.direction(root.x) * (flap.path.bounds().center().x - root.x).signum();
        let middle = slit.path.bounds().center();
        let pass = self.nearest_pass(middle.x, root.x);
        let lead = (middle.x - pass) * self.direction(pass).dot(&points).signum();
        let apart = (self.place(pass) - self.place(root.x)).norm();
        // Behind another sheet the slit lies a thickness farther ahead; connectors lie before all others.
        let (partners, between) = self.partners_at(root.x);
        let depths = (between + 1..=between + partners).map(|depth| (lead - joint.lead_mm(depth)).abs());
        let lead_error = depths.fold(f64::INFINITY, f64::min);
        apart.hypot(lead_error).hypot(middle.y - root.y)
    }

    /// Passes that meet the strip where it passes `s`, and connectors between; one, its own, in a lap.
    fn partners_at(&self, s: f64) -> (usize, usize) {
        let at = |joint: &&ConnectionPoint| joint.passes.iter().any(|k| (self.stations[*k] - s).abs() < LAP_MM);
        let Some(joint) = self.joints.iter().find(at) else { return (1, 0) };
        let between = self.tied.iter().filter(|number| **number == joint.joint).count();
        (joint.passes.len() - 1, between)
    }
}
