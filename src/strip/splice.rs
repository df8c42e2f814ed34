//! Where a strip that is longer than the stock may be divided, and by what the pieces hold on to each other.

use super::edge::Edges;
use super::joint::Joint;
use super::passage::{Half, Passage};
use super::{Settings, dovetail};
use crate::fit::Part;
use crate::ruffle;
use std::ops::Range;

/// How two pieces of one strip are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SpliceKind {
    /// Both ends overlap at a connection point, whose own flaps go through both. Where no connection point is near, a lap.
    Connection,
    /// Both ends overlap between two connection points and are held by flaps or holes of their own.
    Lap,
    /// Dovetails side by side, taped over.
    DovetailTape,
    /// Fingers side by side, glued or taped.
    Finger,
}

/// How splices are made, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpliceSettings {
    /// The kind that is wanted.
    pub kind: SpliceKind,
    /// How far the ends overlap at a connection point, centred on it.
    pub connection_mm: f64,
    /// How far they overlap in a lap.
    pub lap_mm: f64,
    /// From one row of a lap's flaps to the other.
    pub rows_mm: f64,
    /// Diameter of a lap's holes for thread, instead of flaps; `None` for flaps.
    pub thread_hole_mm: Option<f64>,
}

/// Where two pieces of one strip are joined.
#[derive(Debug, Clone, PartialEq)]
pub struct Splice {
    /// How.
    pub kind: SpliceKind,
    /// The earlier piece and the later one.
    pub pieces: [String; 2],
    /// Where both are, mm along the strip.
    pub stations_mm: Range<f64>,
    /// Joints that hold it: that of the connection point, or the lap's own. None where it is taped or glued.
    pub joints: Vec<String>,
    /// Whether the later piece lies on the front of the earlier one, or behind it.
    pub later_in_front: bool,
}

/// A place for a splice.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Spot {
    /// Its middle, mm.
    pub at_mm: f64,
    /// How far both pieces reach beyond it, mm.
    pub half_mm: f64,
    /// What it costs, in pieces.
    pub cost: f64,
    /// How the pieces are joined there.
    pub kind: SpliceKind,
    /// For a splice at a connection point, its passage.
    pub passage: Option<usize>,
}

/// Laps may lie at stations this far apart, mm.
const STEP_MM: f64 = 0.5;
/// A splice keeps this much from the cuts of other joints, mm, whatever else.
const LEAST_CLEAR_MM: f64 = 1.0;
/// What a splice costs, in pieces, where it comes closer to a joint than joints may to each other.
const CROWDED_COST: f64 = 0.3;
/// A pass that carries the flap: the end of the other piece lies between the flap and its partner, which is fiddly.
const FLAP_PASS_COST: f64 = 0.4;
/// A lap where splices at connection points are wanted: two more joints to close, and a stiff place in the middle of a section. One more piece is better.
const LAP_COST: f64 = 2.0;
/// The share of a loop about its middle that is its crown: a doubled sheet flattens the bend there.
const CROWN_SHARE: f64 = 1.0 / 3.0;

/// Everything that decides where splices go.
pub(super) struct Places<'a> {
    pub part: &'a Part,
    pub edges: &'a Edges,
    pub passages: &'a [Passage],
    pub settings: &'a Settings,
}

impl Places<'_> {
    /// All places for the kind of splice that is wanted, ascending.
    pub fn spots(&self) -> Vec<Spot> {
        let mut spots = match self.settings.splice.kind {
            SpliceKind::Connection => {
                let mut spots = self.at_connections();
                spots.extend(self.between(SpliceKind::Lap, LAP_COST));
                spots
            }
            kind => self.between(kind, 0.0),
        };
        spots.sort_by(|a, b| a.at_mm.total_cmp(&b.at_mm));
        spots
    }

    fn joint(&self) -> &Joint {
        &self.settings.joint
    }

    /// Extents of the cuts of all passages but one.
    fn cuts(&self, without: Option<usize>) -> Vec<Range<f64>> {
        let others = self.passages.iter().enumerate().filter(|(i, _)| Some(*i) != without);
        others.map(|(_, p)| p.bounds(self.joint())).map(|b| b.min.x..b.max.x).collect()
    }

    /// Places at connection points.
    fn at_connections(&self) -> Vec<Spot> {
        let half = 0.5 * self.settings.splice.connection_mm;
        let whole = self.edges.range();
        let mut spots = Vec::new();
        for (i, passage) in self.passages.iter().enumerate() {
            let at = passage.station_mm;
            let cuts = self.cuts(Some(i));
            let one_way = passage.seats.windows(2).all(|s| s[0].direction == s[1].direction);
            // A piece's end with flaps of both ways would cut into some of them.
            let bad_flap = passage.half == Half::Flap && !one_way;
            let beyond = at - half <= whole.start || at + half >= whole.end;
            if bad_flap || beyond || meets(&cuts, at, half + LEAST_CLEAR_MM) {
                continue;
            }
            let crowded = meets(&cuts, at, half + 0.5 * self.joint().cut_distance_mm);
            let flap_pass = if passage.half == Half::Flap { FLAP_PASS_COST } else { 0.0 };
            let cost = flap_pass + if crowded { CROWDED_COST } else { 0.0 };
            spots.push(Spot { at_mm: at, half_mm: half, cost, kind: SpliceKind::Connection, passage: Some(i) });
        }
        spots
    }

    /// Places between connection points, never at the crown of a loop.
    fn between(&self, kind: SpliceKind, base_cost: f64) -> Vec<Spot> {
        let splice = &self.settings.splice;
        let half = match kind {
            SpliceKind::DovetailTape | SpliceKind::Finger => 0.5 * dovetail::DEPTH_MM,
            SpliceKind::Connection | SpliceKind::Lap => 0.5 * splice.lap_mm,
        };
        // What lies around it beside the overlap: tape, or flaps that point away from it.
        let zone = match (kind, splice.thread_hole_mm) {
            (SpliceKind::DovetailTape | SpliceKind::Finger, _) => half + dovetail::TAPE_MM,
            (_, None) => half.max(0.5 * splice.rows_mm + self.joint().reach_both_ways_mm(1).1),
            (_, Some(_)) => half,
        };
        let (cuts, crowns, whole) = (self.cuts(None), self.crowns(), self.edges.range());
        let steps = (self.edges.length_mm() / STEP_MM) as usize;
        let spot = |at: f64| {
            let crowded = meets(&cuts, at, zone + 0.5 * self.joint().cut_distance_mm);
            let cost = base_cost + if crowded { CROWDED_COST } else { 0.0 };
            Spot { at_mm: at, half_mm: half, cost, kind, passage: None }
        };
        (1..steps)
            .map(|n| whole.start + n as f64 * STEP_MM)
            .filter(|at| at - zone > whole.start && at + zone < whole.end)
            .filter(|at| !meets(&cuts, *at, zone + LEAST_CLEAR_MM) && !meets(&crowns, *at, half))
            .map(spot)
            .collect()
    }

    /// Middles of the outer loops.
    fn crowns(&self) -> Vec<Range<f64>> {
        let stations = self.part.ruffle.stations();
        let loops = self.part.ruffle.sections.iter().filter(|s| s.role != ruffle::Role::Inner);
        loops
            .map(|s| {
                let (from, to) = (stations[s.first_segment], stations[s.end_segment]);
                let (middle, half) = (0.5 * (from + to), 0.5 * CROWN_SHARE * (to - from));
                middle - half..middle + half
            })
            .collect()
    }
}

/// True when a stretch comes within `reach` of a place.
fn meets(ranges: &[Range<f64>], at: f64, reach: f64) -> bool {
    ranges.iter().any(|r| r.start < at + reach && r.end > at - reach)
}
