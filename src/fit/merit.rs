//! What a shape is worth while its lengths are being found, and how that changes with the place of every node.

use super::Settings;
use super::faces::{Faces, add_doubled_area_slope, doubled_area};
use super::field::Field;
use crate::geom::{P2, V2, cross, long_side};
use crate::ruffle::{Node, Ruffle};
use std::rc::Rc;

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
    field: Rc<Field>,
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

/// How the cost of a shape changes, mm² per mm.
#[derive(Debug, Clone, Default)]
pub(super) struct Slopes {
    /// With the place of every node, as the strip is.
    pub nodes: Vec<V2>,
    /// With the rest length of every segment, while the nodes stay.
    pub rests: Vec<f64>,
}

impl Judge {
    pub fn new(field: Rc<Field>, faces: Faces, settings: &Settings) -> Judge {
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

    /// Cost of a shape; how it changes goes into `slopes`.
    pub fn cost(&self, ruffle: &Ruffle, x: &[P2], pull: &Pull, slopes: &mut Slopes) -> f64 {
        let Slopes { nodes, rests } = slopes;
        nodes.clear();
        nodes.resize(x.len(), V2::zeros());
        rests.clear();
        rests.resize(ruffle.rest_lengths.len(), 0.0);
        let mut cost = self.field.shortfall(&self.faces.border, x, nodes);
        for (node, target) in &pull.targets {
            let away = x[node.index()] - target;
            cost += pull.cost * away.norm_squared();
            nodes[node.index()] += away * (2.0 * pull.cost);
        }
        cost + self.thin_rooms(x, nodes) + self.tight_bends(ruffle, x, slopes)
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
            let full = 2.0 * long_side(&points) * self.room_mm;
            let missing = 1.0 - doubled / full;
            if missing > 0.0 {
                cost += whole * missing * missing;
                add_doubled_area_slope(room, x, -2.0 * whole * missing / full, slopes);
            }
        }
        cost
    }

    /// Bends tighter than they should be: (radius limit / radius - 1)² over the length of strip.
    fn tight_bends(&self, ruffle: &Ruffle, x: &[P2], slopes: &mut Slopes) -> f64 {
        if self.radius_mm <= 0.0 {
            return 0.0;
        }
        let whole = BEND_COST * self.field.area_mm2 / (0.01 * ruffle.walk.len() as f64);
        let mut cost = 0.0;
        for k in 1..ruffle.rest_lengths.len() {
            let [i, j, l] = [k - 1, k, k + 1].map(|k| ruffle.at(k));
            let (e1, e2) = (x[j] - x[i], x[l] - x[j]);
            let both_mm = ruffle.rest_lengths[k - 1] + ruffle.rest_lengths[k];
            let per_radius = 2.0 * self.radius_mm / both_mm;
            let turn = cross(e1, e2).atan2(e1.dot(&e2));
            let excess = per_radius * turn.abs() - 1.0;
            if excess > 0.0 {
                cost += whole * excess * excess;
                let by = 2.0 * whole * excess * per_radius * turn.signum();
                // The angle of a vector e changes by J e / |e|² with it.
                let (u, v) = (V2::new(-e2.y, e2.x) / e2.norm_squared(), V2::new(-e1.y, e1.x) / e1.norm_squared());
                slopes.nodes[i] += v * by;
                slopes.nodes[j] -= (u + v) * by;
                slopes.nodes[l] += u * by;
                // The turn counts as spread over the rest lengths beside it.
                let by_rest = -2.0 * whole * excess * (excess + 1.0) / both_mm;
                slopes.rests[k - 1] += by_rest;
                slopes.rests[k] += by_rest;
            }
        }
        cost
    }
}
