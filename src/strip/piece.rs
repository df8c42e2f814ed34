//! Pieces: a strip cut up at its splices, each piece with everything that is cut and marked on it.

use super::edge::{Edges, Notch};
use super::fold::Face;
use super::label::Labelling;
use super::lettering::{Fold, Labels, notches};
use super::mirror::mirrored;
use super::passage::{Half, Passage};
use super::splice::{Splice, SpliceKind, Spot};
use super::{Pieces, Settings, divide, dovetail, lap, mating, visible};
use crate::drawing::{Drawing, DrawnPath, KerfSide, Role};
use crate::fit::Part;
use crate::geom::{P2, Path};
use crate::progress::Warning;
use std::ops::Range;

/// One thing to cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Unique name: part letter and number.
    pub name: String,
    /// The part it belongs to.
    pub part: String,
    /// What is cut and engraved: strip frame, or mirrored with x = -s when it is seen from the back.
    pub drawing: Drawing,
    /// The side it is drawn and marked on.
    pub seen_from: Face,
    /// The stretch of the strip it is, mm, splices and end tabs included; the first connection point is at 0.
    pub stations_mm: Range<f64>,
    /// Where it carries flaps and slits, by station, strip frame. A flap folds toward the reader where its face is [`Piece::seen_from`].
    pub passages: Vec<Passage>,
    /// Extent along s, mm.
    pub length_mm: f64,
    /// Extent along w, mm.
    pub width_mm: f64,
    /// Mass, g.
    pub mass_g: f64,
}

/// A strip about to be cut up.
pub(super) struct Cutting<'a> {
    pub part: &'a Part,
    pub edges: &'a Edges,
    pub settings: &'a Settings,
    pub spots: &'a [Spot],
}

/// Notches keep this far from a piece's ends, mm.
const NOTCH_END_MM: f64 = 2.0;
/// From the last notch of one joint to the first of the next on the same edge, mm, at least.
const NOTCH_APART_MM: f64 = 6.0;

impl Cutting<'_> {
    /// All pieces. `passages` are those of the connection points.
    pub fn cut(&self, mut passages: Vec<Passage>, mut warnings: Vec<Warning>) -> Pieces {
        let ranges = divide::ranges(self.spots, self.edges.range());
        let name = |i: usize| format!("{}{}", self.part.name, i + 1);
        let splices = self.splices(&mut passages);
        let mut own: Vec<Vec<Passage>> = ranges.iter().map(|_| Vec::new()).collect();
        for passage in &passages {
            self.deal(passage, &ranges, &mut own);
        }
        let joints = self.part.ruffle.connection_points().len();
        let mut number = joints;
        let mut new_joint = || {
            number += 1;
            format!("{}{number}", self.part.name)
        };
        let mut full_splices = Vec::new();
        for (i, (spot, (joint, later_in_front))) in self.spots.iter().zip(splices).enumerate() {
            let mut joints: Vec<String> = joint.into_iter().collect();
            if spot.kind == SpliceKind::Lap {
                let [earlier, later] =
                    lap::passages(spot, self.edges, &self.settings.joint, &self.settings.splice, &mut new_joint);
                joints = earlier.iter().map(|p| p.joint.clone()).collect();
                own[i].extend(earlier);
                own[i + 1].extend(later);
            }
            let stations_mm = ranges[i + 1].start..ranges[i].end;
            full_splices.push(Splice {
                kind: spot.kind,
                pieces: [name(i), name(i + 1)],
                stations_mm,
                joints,
                later_in_front,
            });
        }
        let mut pieces = Vec::with_capacity(ranges.len());
        let (mut collisions, mut left_out, mut cuts) = (0, Vec::new(), Vec::new());
        for (i, (range, mut own)) in ranges.iter().zip(own).enumerate() {
            own.sort_by(|a, b| a.station_mm.total_cmp(&b.station_mm));
            let neighbours = [i.checked_sub(1).map(name), (i + 1 < ranges.len()).then(|| name(i + 1))];
            let made = self.piece(i, &name(i), range, own, neighbours);
            collisions += made.collisions;
            left_out.extend(made.left_out.into_iter().map(|text| format!("{text} on {}", made.piece.name)));
            cuts.extend(made.cuts);
            pieces.push(made.piece);
        }
        warnings.extend(self.told(&full_splices, &left_out).into_iter().map(|w| w.in_part(&self.part.name)));
        let max_mating_error_mm = mating::worst_mating_error_mm(self.part, cuts.iter(), &self.settings.joint);
        Pieces { pieces, splices: full_splices, max_mating_error_mm, label_collisions: collisions, warnings }
    }

    /// The joint of every splice that uses one, and which piece lies in front there. Its flaps get one sheet more to go through.
    fn splices(&self, passages: &mut [Passage]) -> Vec<(Option<String>, bool)> {
        let mut spliced = Vec::new();
        for spot in self.spots {
            let Some(passage) = spot.passage.map(|i| passages[i].clone()) else {
                spliced.push((None, true));
                continue;
            };
            passages.iter_mut().filter(|p| p.joint == passage.joint).for_each(|p| p.sheets += 1);
            // Between a flap and its partner lies the piece that does not carry the flap.
            let later_has_flap = passage.seats.first().is_some_and(|s| s.direction > 0.0);
            let later_in_front = passage.half != Half::Flap || (later_has_flap == (passage.face == Face::Back));
            spliced.push((Some(passage.joint), later_in_front));
        }
        spliced
    }

    /// Gives a passage to the pieces that carry it: at a splice to both, where flaps go to the piece they point into and the other gets slits.
    fn deal(&self, passage: &Passage, ranges: &[Range<f64>], own: &mut [Vec<Passage>]) {
        for (i, range) in ranges.iter().enumerate() {
            if !range.contains(&passage.station_mm) {
                continue;
            }
            let mut passage = passage.clone();
            let at_splice =
                |k: Option<usize>| k.and_then(|k| self.spots.get(k)).is_some_and(|s| s.at_mm == passage.station_mm);
            let (at_start, at_end) = (at_splice(i.checked_sub(1)), at_splice(Some(i)));
            if passage.half == Half::Flap && (at_start || at_end) {
                let points_in = passage.seats.first().is_some_and(|s| (s.direction > 0.0) == at_start);
                if !points_in {
                    passage.half = Half::Slit;
                    passage.depth = 1;
                    passage.face = passage.face.other();
                }
            }
            own[i].push(passage);
        }
    }

    fn piece(
        &self,
        i: usize,
        name: &str,
        range: &Range<f64>,
        own: Vec<Passage>,
        neighbours: [Option<String>; 2],
    ) -> Made {
        let (settings, part) = (self.settings, self.part);
        let spots = [i.checked_sub(1).map(|k| &self.spots[k]), self.spots.get(i)];
        let line = |spot: Option<&Spot>| {
            let spot = spot.filter(|s| matches!(s.kind, SpliceKind::DovetailTape | SpliceKind::Finger))?;
            let half = 0.5 * dovetail::DEPTH_MM;
            let band = self.edges.band(spot.at_mm - half..spot.at_mm + half);
            Some(dovetail::line(spot.kind, spot.at_mm, self.edges.at(spot.at_mm - half), band))
        };
        let lines = spots.map(line);
        let seen_from = self.side(range, &own);
        let contour = self.edges.contour(
            range.clone(),
            [lines[0].as_deref(), lines[1].as_deref()],
            &self.notches(range, &own, seen_from),
        );
        let cuts: Vec<DrawnPath> = own.iter().flat_map(|p| p.paths(&settings.joint)).collect();
        let mut paths = vec![DrawnPath { path: contour, role: Role::Outline, kerf: KerfSide::Outside, joint: None }];
        paths.extend(cuts.iter().cloned());
        if matches!(settings.labels, Labels::Strokes { .. }) {
            let ends = spots.into_iter().enumerate();
            paths.extend(ends.filter_map(|(end, spot)| Some(self.neighbours_end(spot?, end == 1))).flatten());
        }
        let back = seen_from == Face::Back;
        let mut neighbours = neighbours;
        let mut clean = Vec::new();
        if settings.clean_outside {
            clean = visible::outward(part, &own, seen_from);
        }
        if back {
            paths = mirrored(&paths);
            neighbours.reverse();
            clean = clean.into_iter().map(|r| -r.end..-r.start).collect();
        }
        let placed: Vec<(&Passage, f64)> =
            own.iter().map(|p| (p, if back { -p.station_mm } else { p.station_mm })).collect();
        let written = Labelling {
            name,
            neighbours: [neighbours[0].as_deref(), neighbours[1].as_deref()],
            paths: &paths,
            passages: &placed,
            seen_from,
            clean: &clean,
        }
        .write(&settings.labels);
        paths.extend(written.paths);
        let outline = paths[0].path.clone();
        let bounds = outline.bounds();
        let piece = Piece {
            name: name.to_owned(),
            part: part.name.clone(),
            drawing: Drawing { name: name.to_owned(), paths },
            seen_from,
            stations_mm: range.clone(),
            passages: own,
            length_mm: bounds.width(),
            width_mm: bounds.height(),
            mass_g: outline.signed_area() * 1e-6 * settings.grammage_g_per_m2,
        };
        Made { piece, cuts, left_out: written.left_out, collisions: written.collisions }
    }

    /// The side a piece is drawn from: the front, or where the outside is to stay clean the one that is seen less of.
    fn side(&self, range: &Range<f64>, own: &[Passage]) -> Face {
        if !self.settings.clean_outside {
            return Face::Front;
        }
        let seen = |face: Face| -> f64 {
            let stretches = visible::outward(self.part, own, face);
            stretches.iter().map(|r| (r.end.min(range.end) - r.start.max(range.start)).max(0.0)).sum()
        };
        if seen(Face::Front) <= seen(Face::Back) { Face::Front } else { Face::Back }
    }

    /// Where notches label: those of every joint, in the edge that tells which way its flap folds.
    fn notches(&self, range: &Range<f64>, own: &[Passage], seen_from: Face) -> Vec<Notch> {
        if self.settings.labels != Labels::Notches {
            return Vec::new();
        }
        let mut cut: Vec<Notch> = Vec::new();
        for passage in own {
            let fold = if passage.face == seen_from { Fold::Toward } else { Fold::Away };
            let digits = passage.joint.trim_start_matches(|c: char| !c.is_ascii_digit());
            // On one edge groups follow one another without touching.
            let last = cut.iter().rev().find(|n| n.upper == (fold == Fold::Away));
            let from = last.map_or(range.start + NOTCH_END_MM, |n| n.at_mm + NOTCH_APART_MM);
            let between = (from, range.end - NOTCH_END_MM);
            let own = digits.parse().ok().and_then(|n| notches(n, passage.station_mm, between, fold));
            cut.extend(own.unwrap_or_default());
        }
        cut
    }

    /// Ticks at both edges that show where a neighbour's end lies, or the edge of the tape. They are as long as cuts stay away from edges.
    fn neighbours_end(&self, spot: &Spot, at_end: bool) -> [DrawnPath; 2] {
        let beyond = match spot.kind {
            SpliceKind::Connection | SpliceKind::Lap => spot.half_mm,
            SpliceKind::DovetailTape | SpliceKind::Finger => spot.half_mm + dovetail::TAPE_MM,
        };
        let s = if at_end { spot.at_mm - beyond } else { spot.at_mm + beyond };
        let (lo, hi) = self.edges.at(s);
        let tick = self.settings.joint.edge_distance_mm.min(0.25 * (hi - lo));
        [(lo, lo + tick), (hi - tick, hi)].map(|(from, to)| {
            let path = Path::open([P2::new(s, from), P2::new(s, to)]);
            DrawnPath { path, role: Role::Mark, kerf: KerfSide::On, joint: None }
        })
    }

    /// What the user should know about splices and labels.
    fn told(&self, splices: &[Splice], left_out: &[String]) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let of = |kind: SpliceKind| splices.iter().filter(|s| s.kind == kind).count();
        let ways = [
            (SpliceKind::Connection, "at joints, whose flaps go through both ends"),
            (SpliceKind::Lap, "between joints, by a lap with joints of its own"),
            (SpliceKind::DovetailTape, "by dovetails, taped over between the two lines"),
            (SpliceKind::Finger, "by fingers, to be glued or taped"),
        ];
        let how: Vec<String> =
            ways.iter().filter(|(kind, _)| of(*kind) > 0).map(|(kind, how)| format!("{} {how}", of(*kind))).collect();
        if !splices.is_empty() {
            let message = format!(
                "the strip of {:.0} mm is longer than the stock: {} pieces, joined {}",
                self.edges.length_mm(),
                splices.len() + 1,
                how.join(" and ")
            );
            warnings.push(Warning::new("spliced", message));
        }
        if !left_out.is_empty() {
            let message = format!(
                "no free place for {} of the labels, which are left out: {}; the pictures in parts/ show the joint numbers",
                left_out.len(),
                left_out.join(", ")
            );
            warnings.push(Warning::new("labels-left-out", message));
        }
        warnings
    }
}

/// A piece and what came out beside it.
struct Made {
    piece: Piece,
    /// Its cuts, strip frame.
    cuts: Vec<DrawnPath>,
    left_out: Vec<String>,
    collisions: usize,
}
