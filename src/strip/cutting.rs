//! A strip cut up at its splices: which piece carries what, and each piece with all that is cut and marked on it.

use super::edge::{Edges, Notch};
use super::fold::Face;
use super::label::{Labelling, Written};
use super::lettering::{Fold, Labels, notches};
use super::mirror::mirrored;
use super::passage::{Half, Passage};
use super::piece::Piece;
use super::splice::{Splice, SpliceKind, Spot};
use super::{Pieces, Settings, divide, dovetail, lap, mating, told, visible};
use crate::drawing::{Drawing, DrawnPath, KerfSide, Role};
use crate::fit::Part;
use crate::geom::{P2, Path};
use crate::progress::Warning;
use std::ops::Range;

/// A strip about to be cut up.
pub(super) struct Cutting<'a> {
    pub part: &'a Part,
    pub edges: &'a Edges,
    /// Numbers of the joints that connectors lie in.
    pub tied: &'a [u32],
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
        let joints = self.joints_at_splices(&mut passages);
        let mut own: Vec<Vec<Passage>> = ranges.iter().map(|_| Vec::new()).collect();
        for passage in &passages {
            self.deal(passage, &ranges, &mut own);
        }
        let splices = self.splices(joints, &ranges, &mut own);
        let mut pieces = Vec::with_capacity(ranges.len());
        let (mut label_collisions, mut left_out, mut cuts) = (0, Vec::new(), Vec::new());
        for (i, mut own) in own.into_iter().enumerate() {
            own.sort_by(|a, b| a.station_mm.total_cmp(&b.station_mm));
            cuts.extend(own.iter().flat_map(|p| p.paths(&self.settings.joint)));
            let (piece, written) = self.piece(i, &ranges, own);
            label_collisions += written.collisions;
            left_out.extend(written.left_out.into_iter().map(|text| format!("{text} on {}", piece.name)));
            pieces.push(piece);
        }
        let told = told::warnings(&splices, self.edges.length_mm(), &left_out);
        warnings.extend(told.into_iter().map(|w| w.in_part(&self.part.name)));
        let max_mating_error_mm =
            mating::worst_mating_error_mm(self.part, self.tied, cuts.iter(), &self.settings.joint);
        Pieces { pieces, splices, max_mating_error_mm, label_collisions, warnings }
    }

    fn name(&self, piece: usize) -> String {
        format!("{}{}", self.part.name, piece + 1)
    }

    /// The joint of every splice that uses one, and whether the later piece lies in front there. Its flaps get one sheet more to go through.
    fn joints_at_splices(&self, passages: &mut [Passage]) -> Vec<(Option<String>, bool)> {
        let mut joints = Vec::new();
        for spot in self.spots {
            let Some(passage) = spot.passage.map(|i| passages[i].clone()) else {
                joints.push((None, true));
                continue;
            };
            passages.iter_mut().filter(|p| p.joint == passage.joint).for_each(|p| p.sheets += 1);
            // Between a flap and its partner lies the piece that does not carry the flap.
            let later_has_flap = passage.seats.first().is_some_and(|s| s.direction > 0.0);
            let later_in_front = passage.half != Half::Flap || later_has_flap == (passage.face == Face::Back);
            joints.push((Some(passage.joint), later_in_front));
        }
        joints
    }

    /// Gives a passage to the pieces that carry it: at a splice to both, where flaps go to the piece they point into and the other gets slits.
    fn deal(&self, passage: &Passage, ranges: &[Range<f64>], own: &mut [Vec<Passage>]) {
        let splice_at = |k: Option<usize>| {
            k.and_then(|k| self.spots.get(k)).is_some_and(|s| s.passage.is_some() && s.at_mm == passage.station_mm)
        };
        for (i, _) in ranges.iter().enumerate().filter(|(_, r)| r.contains(&passage.station_mm)) {
            let mut passage = passage.clone();
            let (at_start, at_end) = (splice_at(i.checked_sub(1)), splice_at(Some(i)));
            let points_in = passage.seats.first().is_some_and(|s| (s.direction > 0.0) == at_start);
            if passage.half == Half::Flap && (at_start || at_end) && !points_in {
                passage.half = Half::Slit;
                passage.depth = 1;
                passage.face = passage.face.other();
            }
            own[i].push(passage);
        }
    }

    /// The splices as people see them; laps add joints of their own to the pieces.
    fn splices(
        &self,
        joints: Vec<(Option<String>, bool)>,
        ranges: &[Range<f64>],
        own: &mut [Vec<Passage>],
    ) -> Vec<Splice> {
        let mut number = self.part.ruffle.connection_points().len();
        let mut new_joint = || {
            number += 1;
            format!("{}{number}", self.part.name)
        };
        let mut splices = Vec::with_capacity(joints.len());
        for (i, (spot, (joint, later_in_front))) in self.spots.iter().zip(joints).enumerate() {
            let mut held_by: Vec<String> = joint.into_iter().collect();
            if spot.kind == SpliceKind::Lap {
                let (joint, splice) = (&self.settings.joint, &self.settings.splice);
                let [earlier, later] = lap::passages(spot, self.edges, joint, splice, &mut new_joint);
                held_by = earlier.iter().map(|p| p.joint.clone()).collect();
                own[i].extend(earlier);
                own[i + 1].extend(later);
            }
            splices.push(Splice {
                kind: spot.kind,
                pieces: [self.name(i), self.name(i + 1)],
                stations_mm: ranges[i + 1].start..ranges[i].end,
                joints: held_by,
                later_in_front,
            });
        }
        splices
    }

    /// Piece `i` with what it carries, cut, marked and labelled.
    fn piece(&self, i: usize, ranges: &[Range<f64>], own: Vec<Passage>) -> (Piece, Written) {
        let (settings, name, range) = (self.settings, self.name(i), ranges[i].clone());
        let spots = [i.checked_sub(1).map(|k| &self.spots[k]), self.spots.get(i)];
        let mut neighbours =
            [i.checked_sub(1), (i + 1 < ranges.len()).then_some(i + 1)].map(|k| k.map(|k| self.name(k)));
        let lines = spots.map(|s| self.end_line(s?));
        let seen_from = self.side(&range, &own);
        let notches = self.notches(&range, &own, seen_from);
        let contour = self.edges.contour(range.clone(), [lines[0].as_deref(), lines[1].as_deref()], &notches);
        let mut paths = vec![DrawnPath { path: contour, role: Role::Outline, kerf: KerfSide::Outside, joint: None }];
        paths.extend(own.iter().flat_map(|p| p.paths(&settings.joint)));
        if matches!(settings.labels, Labels::Strokes { .. }) {
            let ends = spots.into_iter().enumerate();
            paths.extend(ends.filter_map(|(end, spot)| Some(self.neighbours_end(spot?, end == 1))).flatten());
        }
        let mut clean = match settings.clean_outside {
            true => visible::outward(self.part, &own, seen_from),
            false => Vec::new(),
        };
        paths.retain(|p| p.role != Role::Mark || !clean.iter().any(|r| r.contains(&p.path.bounds().center().x)));
        let mirror = seen_from == Face::Back;
        if mirror {
            paths = mirrored(&paths);
            neighbours.reverse();
            clean = clean.into_iter().map(|r| -r.end..-r.start).collect();
        }
        let place = |p: &Passage| if mirror { -p.station_mm } else { p.station_mm };
        let mut written = Labelling {
            name: &name,
            neighbours: neighbours.each_ref().map(Option::as_deref),
            paths: &paths,
            passages: &own.iter().map(|p| (p, place(p))).collect::<Vec<_>>(),
            seen_from,
            clean: &clean,
        }
        .write(&settings.labels);
        paths.append(&mut written.paths);
        let drawing = Drawing { name: name.clone(), paths };
        let piece = Piece::new(name, &self.part.name, drawing, (range, own), settings.grammage_g_per_m2);
        (Piece { seen_from, ..piece }, written)
    }

    /// The line along which pieces meet that lie side by side.
    fn end_line(&self, spot: &Spot) -> Option<Vec<P2>> {
        let side_by_side = matches!(spot.kind, SpliceKind::DovetailTape | SpliceKind::Finger);
        side_by_side.then(|| {
            let half = 0.5 * dovetail::DEPTH_MM;
            let band = self.edges.band(spot.at_mm - half..spot.at_mm + half);
            dovetail::line(spot.kind, spot.at_mm, self.edges.at(spot.at_mm - half), band)
        })
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
        let joints = self.part.ruffle.connection_points().len();
        let mut cut: Vec<Notch> = Vec::new();
        for passage in own {
            let fold = if passage.face == seen_from { Fold::Toward } else { Fold::Away };
            let digits = passage.joint.trim_start_matches(|c: char| !c.is_ascii_digit());
            let number: Option<usize> = digits.parse().ok();
            // Both rows of a lap lie where one group has room; the first tells the lap.
            if number.is_some_and(|n| n > joints && (n - joints).is_multiple_of(2)) {
                continue;
            }
            // On one edge groups follow one another without touching.
            let last = cut.iter().rev().find(|n| n.upper == (fold == Fold::Away));
            let from = last.map_or(range.start + NOTCH_END_MM, |n| n.at_mm + NOTCH_APART_MM);
            let between = (from, range.end - NOTCH_END_MM);
            let own = number.and_then(|n| notches(n as u32, passage.station_mm, between, fold));
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
}
