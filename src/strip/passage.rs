//! What a strip carries where it passes a joint: the data that drawings, labels and assembly sheets are made from.

use super::fold::Face;
use super::joint::Joint;
use super::shape::hole;
use crate::drawing::DrawnPath;
use crate::geom::{Motion, Rect, V2};
use std::f64::consts::PI;

/// What of a joint a passage carries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Half {
    /// The flaps.
    Flap,
    /// The slits they go through.
    Slit,
    /// Holes, the same on every pass.
    Holes {
        /// Diameter, mm.
        diameter_mm: f64,
    },
    /// Marked places, the same on every pass.
    Mark,
}

/// One flap, or one slit, of a passage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seat {
    /// Its middle across the strip, mm.
    pub across_mm: f64,
    /// +1 when the flap points toward growing s on this pass, -1 when the other way.
    pub direction: f64,
}

/// The flaps, or the slits, of one pass of the strip through one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Passage {
    /// Joint name, unique in the object: "A7".
    pub joint: String,
    /// Where the strip passes the joint, mm from its first connection point.
    pub station_mm: f64,
    /// Flaps or slits.
    pub half: Half,
    /// The face on which the other half lies: a flap folds toward it and leaves the strip there, a slit is entered there.
    pub face: Face,
    /// Sheets between the flap's and this one, counting this one: 0 for the flap itself, 1 for the first slit it goes through.
    pub depth: usize,
    /// Sheets the flap goes through, all slits of the joint counted.
    pub sheets: usize,
    /// The flaps or slits side by side.
    pub seats: Vec<Seat>,
}

impl Passage {
    /// Station of a seat's hinge line or slit, mm.
    pub fn cut_station_mm(&self, seat: &Seat, joint: &Joint) -> f64 {
        match self.half {
            Half::Flap | Half::Holes { .. } | Half::Mark => self.station_mm,
            Half::Slit => self.station_mm + seat.direction * joint.lead_mm(self.depth),
        }
    }

    /// The cuts, strip frame.
    pub fn paths(&self, joint: &Joint) -> Vec<DrawnPath> {
        let cuts = match self.half {
            Half::Flap => joint.flap_cuts(self.sheets),
            Half::Slit => joint.slit_cuts(),
            Half::Holes { diameter_mm } => vec![hole(diameter_mm)],
            Half::Mark => joint.cross().to_vec(),
        };
        let place = |seat: &Seat| {
            let turn = if self.half == Half::Flap && seat.direction < 0.0 { PI } else { 0.0 };
            Motion::new(V2::new(self.cut_station_mm(seat, joint), seat.across_mm), turn)
        };
        let cut = |seat: &Seat| {
            let motion = place(seat);
            let joint = Some(self.joint.clone());
            cuts.iter()
                .map(|c| DrawnPath { path: c.path.moved(&motion), role: c.role, kerf: c.kerf, joint: joint.clone() })
                .collect::<Vec<DrawnPath>>()
        };
        self.seats.iter().flat_map(cut).collect()
    }

    /// The box around all cuts of this passage, strip frame.
    pub fn bounds(&self, joint: &Joint) -> Rect {
        self.paths(joint).iter().fold(Rect::EMPTY, |r, p| r.union(p.path.bounds()))
    }
}
