//! What a shape is worth while its lengths are being found, and how that changes with the place of every node.

use super::Settings;
use super::faces::{Faces, add_doubled_area_slope, doubled_area};
use super::field::Field;
use crate::geom::{P2, V2, convex_hull, cross};
use crate::ruffle::{Node, Ruffle};

/// A room of no thickness costs this share of the outline's area. Coverage does not see the inside: without it layers that have collapsed count as full.
const THIN_COST: f64 = 0.06;
/// Rooms are kept thicker than this share of the void that tools need: a little more, since the cost must bite before the limit is reached.
const THIN_MARGIN: f64 = 1.0;
/// A bend twice as tight as the material takes, over one segment in a hundred, costs this share of the outline's area.
const BEND_COST: f64 = 0.5;
const BEND_MARGIN: f64 = 1.1;

/// Judges the shapes of one strip. Costs are areas in mm².
#[derive(Debug, Clone)]
pub(super) struct Judge {
    field: Field,
    pub faces: Faces,
    room_mm: f64,
    radius_mm: f64,
}

/// Points that a shape is drawn to while it is held near its drawing, and the cost of a square millimetre of distance, mm².
#[derive(Debug, Clone, Default)]
pub(super) struct Pull {
    pub targets: Vec<(Node, P2)>,
    pub cost: f64,
}

impl Judge {
    pub fn new(field: Field, faces: Faces, settings: &Settings) -> Judge {
        Judge {
            field,
            faces,
            room_mm: THIN_MARGIN * settings.min_void_mm,
            radius_mm: BEND_MARGIN * settings.min_bend_radius_mm,
        }
    }

    pub fn area_mm2(&self) -> f64 {
        self.field.area_mm2
    }

    /// Cost of a shape; its change per mm that each node moves goes into `slopes`.
    pub fn cost(&self, ruffle: &Ruffle, x: &[P2], pull: &Pull, slopes: &mut [V2]) -> f64 {
        slopes.fill(V2::zeros());
        let mut cost = self.field.shortfall(&self.faces.border, x, slopes);
        for (node, target) in &pull.targets {
            let away = x[node.index()] - target;
            cost += pull.cost * away.norm_squared();
            slopes[node.index()] += away * (2.0 * pull.cost);
        }
        cost + self.thin_rooms(x, slopes) + self.tight_bends(ruffle, x, slopes)
    }

    /// Rooms thinner than they should be: (1 - thickness / limit)² each. How long a room is counts as given.
    fn thin_rooms(&self, x: &[P2], slopes: &mut [V2]) -> f64 {
        if self.room_mm <= 0.0 {
            return 0.0;
        }
        let whole = THIN_COST * self.field.area_mm2;
        let mut cost = 0.0;
        for room in &self.faces.rooms {
            let doubled = doubled_area(room, x);
            let points: Vec<P2> = room.iter().map(|n| x[*n]).collect();
            let full = 2.0 * long_side_mm(&points) * self.room_mm;
            let missing = 1.0 - doubled / full;
            if missing > 0.0 {
                cost += whole * missing * missing;
                add_doubled_area_slope(room, x, -2.0 * whole * missing / full, slopes);
            }
        }
        cost
    }

    /// Bends tighter than they should be: (radius limit / radius - 1)² over the length of strip.
    fn tight_bends(&self, ruffle: &Ruffle, x: &[P2], slopes: &mut [V2]) -> f64 {
        if self.radius_mm <= 0.0 {
            return 0.0;
        }
        let whole = BEND_COST * self.field.area_mm2 / (0.01 * ruffle.walk.len() as f64);
        let mut cost = 0.0;
        for k in 1..ruffle.rest_lengths.len() {
            let [i, j, l] = [k - 1, k, k + 1].map(|k| ruffle.at(k));
            let (e1, e2) = (x[j] - x[i], x[l] - x[j]);
            let per_radius = self.radius_mm / (0.5 * (ruffle.rest_lengths[k - 1] + ruffle.rest_lengths[k]));
            let turn = cross(e1, e2).atan2(e1.dot(&e2));
            let excess = per_radius * turn.abs() - 1.0;
            if excess > 0.0 {
                cost += whole * excess * excess;
                let by = 2.0 * whole * excess * per_radius * turn.signum();
                // The angle of a vector e changes by J e / |e|² with it.
                let (u, v) = (V2::new(-e2.y, e2.x) / e2.norm_squared(), V2::new(-e1.y, e1.x) / e1.norm_squared());
                slopes[i] += v * by;
                slopes[j] -= (u + v) * by;
                slopes[l] += u * by;
            }
        }
        cost
    }
}

/// Long side of the smallest rectangle around points, mm.
pub(super) fn long_side_mm(points: &[P2]) -> f64 {
    let hull = convex_hull(points);
    let n = hull.len();
    let sides = (0..n).filter_map(|i| (hull[(i + 1) % n] - hull[i]).try_normalize(1e-12));
    let boxes = sides.map(|u| {
        let extent = |axis: V2| {
            let along = hull.iter().map(|p| p.coords.dot(&axis));
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            high - low
        };
        let (a, b) = (extent(u), extent(V2::new(-u.y, u.x)));
        (a * b, a.max(b))
    });
    boxes.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(1.0, |(_, long)| long)
}
