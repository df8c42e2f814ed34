//! Drag knives: the tip trails the axis it swivels about, so the axis is led ahead of the tip and round every corner.
//!
//! A blade whose tip is drawn behind its axis heads along the way of its tip (a tractrix). While the tip follows a curve heading t, the axis is at
//! tip + offset t: along a line that is the same line, ahead; along an arc a concentric one. At a corner the tip stands and the axis swings round it.

use super::{Contour, curve, mitre};
use crate::geom::{Path, PathVertex, Segment, V2, cross};
use crate::progress::Warning;

/// Corners flatter than this, rad (8 degrees), are passed over straight: the tip leaves its way by less than offset x angle² / 8, under a micrometre.
const SWIVEL_RAD: f64 = 0.14;

/// A blade follows smaller radii than this badly, mm: it twists in the sheet.
const LIKED_RADIUS_MM: f64 = 1.0;

/// Closed cuts smaller than this, mm, are torn out rather than cut.
const LEAST_SIZE_MM: f64 = 3.0;

/// Moves every run from the way of the tip to the way of the axis. The blade keeps the heading of one run until the next; before the first it is
/// taken to head as that run begins.
pub(super) fn drag(contours: &mut [Contour], offset_mm: f64) {
    let mut heading = None;
    for contour in contours {
        let open = if contour.path.closed {
            curve::stretch(&contour.path, 0.0, contour.path.length())
        } else {
            contour.path.clone()
        };
        let Some(first) = open.segments().next() else { continue };
        let came = heading.unwrap_or_else(|| curve::start_direction(&first));
        let (path, left) = axis(&open, came, offset_mm);
        contour.path = path;
        heading = Some(left);
    }
}

/// The way of the axis for the way of a tip that comes heading `came`, and the heading it is left with.
fn axis(tip: &Path, came: V2, offset_mm: f64) -> (Path, V2) {
    let mut vertices: Vec<PathVertex> = Vec::new();
    let mut heading = came;
    for segment in tip.segments().filter(|s| s.length() > 0.0) {
        let (begin, finish) = (curve::start_direction(&segment), curve::direction_at(&segment, 1.0));
        let turn = cross(heading, begin).atan2(heading.dot(&begin));
        // The way so far ends ahead of this corner; from there the axis swings round it.
        let swing = if turn.abs() > SWIVEL_RAD { (0.25 * turn).tan() } else { 0.0 };
        match vertices.last_mut() {
            Some(last) => last.bulge = swing,
            None => vertices.push(PathVertex { point: segment.from() + heading * offset_mm, bulge: swing }),
        }
        let bulge = match segment {
            Segment::Line { .. } => 0.0,
            Segment::Arc { sweep_rad, .. } => (0.25 * sweep_rad).tan(),
        };
        vertices.push(PathVertex { point: segment.from() + begin * offset_mm, bulge });
        vertices.push(PathVertex { point: segment.to() + finish * offset_mm, bulge: 0.0 });
        heading = finish;
    }
    (Path { vertices, closed: false }.deduplicated(), heading)
}

/// What was too small for a blade.
#[derive(Debug, Default)]
pub(super) struct Details {
    /// Pieces with roundings that a blade follows badly.
    tight: Vec<String>,
    /// Pieces of which corners were sharpened.
    sharpened: Vec<String>,
    /// Pieces of which holes were left out.
    left_out: Vec<String>,
}

impl Details {
    /// The path with roundings tighter than the blade's trail made corners, round which the blade swings; `None` for a closed cut too small to cut at
    /// all.
    pub fn simplified(&mut self, path: Path, offset_mm: f64, piece: &str) -> Option<Path> {
        let size = path.bounds();
        if path.closed && size.width().max(size.height()) < LEAST_SIZE_MM {
            self.left_out.push(piece.to_owned());
            return None;
        }
        let before = path.vertices.len();
        let path = mitre::cornered(path, |radius_mm, _| radius_mm < offset_mm);
        if path.vertices.len() != before {
            self.sharpened.push(piece.to_owned());
        }
        // Arcs that make up for a rim's waves are flat, however short; a rounding turns.
        let tight = |s: &Segment| matches!(s, Segment::Arc { radius, sweep_rad, .. } if *radius < LIKED_RADIUS_MM - 1e-3 && sweep_rad.abs() > SWIVEL_RAD);
        if path.segments().any(|s| tight(&s)) {
            self.tight.push(piece.to_owned());
        }
        Some(path)
    }

    /// What the user should know.
    pub fn warning(self) -> Option<Warning> {
        let said = [
            (self.tight, format!("roundings below {LIKED_RADIUS_MM} mm, where a worn blade tears, on ")),
            (self.sharpened, "roundings tighter than the blade's trail, which become corners, on ".to_owned()),
            (self.left_out, format!("cuts below {LEAST_SIZE_MM} mm, which are left out (punch them), on ")),
        ];
        let told: Vec<String> = said
            .into_iter()
            .filter(|(pieces, _)| !pieces.is_empty())
            .map(|(mut pieces, what)| {
                pieces.sort();
                pieces.dedup();
                what + &pieces.join(", ")
            })
            .collect();
        let message = || format!("too fine for a blade: {}", told.join("; "));
        (!told.is_empty()).then(|| Warning::new("knife-details", message()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::contour;
    use super::*;
    use crate::drawing::Role;
    use crate::geom::P2;
    use proptest::prelude::*;

    /// Where the tip of a blade goes that is drawn behind its axis: followed in short steps, knowing nothing of how the way was made.
    fn trail(axis: &Path, mut tip: P2, offset_mm: f64) -> Vec<P2> {
        let mut trail = Vec::new();
        let steps = (axis.length() / 0.005).ceil();
        for (at, _) in (0..=steps as u32).filter_map(|k| curve::at(axis, axis.length() * f64::from(k) / steps)) {
            let pull: V2 = at - tip;
            if pull.norm() > offset_mm {
                tip = at - pull.normalize() * offset_mm;
            }
            trail.push(tip);
        }
        trail
    }

    fn apart(trail: &[P2], wanted: &Path) -> (f64, f64) {
        let segments: Vec<Segment> = wanted.segments().collect();
        let off = trail.iter().map(|p| curve::distance(&segments, *p)).fold(0.0, f64::max);
        let missed =
            curve::samples(wanted, 0.1).map(|p| trail.iter().map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min));
        (off, missed.fold(0.0, f64::max))
    }

    #[test]
    fn the_tip_keeps_to_a_square_round_all_its_corners() {
        let square = Path::closed([(5.0, 5.0), (25.0, 5.0), (25.0, 25.0), (5.0, 25.0)].map(|(x, y)| P2::new(x, y)));
        let mut runs = [contour(square.clone(), Role::Outline)];
        drag(&mut runs, 0.25);
        let axis = &runs[0].path;
        assert_eq!(axis.start(), Some(P2::new(5.25, 5.0)));
        let (off, missed) = apart(&trail(axis, P2::new(5.0, 5.0), 0.25), &square);
        assert!(off < 0.01 && missed < 0.06, "{off} {missed}");
        // Without the swings the corners are rounded off.
        let (off, _) = apart(&trail(&square, P2::new(4.75, 5.0), 0.25), &square);
        assert!(off > 0.08, "{off}");
    }

    #[test]
    fn a_blade_left_heading_elsewhere_is_turned_where_the_next_cut_begins() {
        let up = contour(Path::open([P2::new(0.0, 0.0), P2::new(0.0, 10.0)]), Role::Slit);
        let right = contour(Path::open([P2::new(5.0, 5.0), P2::new(15.0, 5.0)]), Role::Slit);
        let mut runs = [up, right];
        drag(&mut runs, 0.25);
        assert_eq!(runs[1].path.start(), Some(P2::new(5.0, 5.25)), "it still heads up");
        let (off, missed) =
            apart(&trail(&runs[1].path, P2::new(5.0, 5.0), 0.25), &Path::open([P2::new(5.0, 5.0), P2::new(15.0, 5.0)]));
        assert!(off < 0.01 && missed < 0.06, "{off} {missed}");
    }

    #[test]
    fn small_roundings_become_corners_and_small_holes_are_left_out_and_told() {
        let mut details = Details::default();
        let corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (0.0, 10.0)].map(|(x, y)| P2::new(x, y));
        let rounded = |radius: f64| Path::rounded(&corners.map(|p| (p, radius)), true);
        let mut simplified = |path: Path, piece: &str| details.simplified(path, 0.25, piece);
        assert_eq!(simplified(rounded(0.2), "A1").unwrap().vertices.len(), 4);
        assert_eq!(simplified(rounded(1.0), "A2").unwrap(), rounded(1.0));
        assert_eq!(simplified(Path::circle(P2::origin(), 1.2), "A3"), None);
        assert_eq!(simplified(rounded(0.6), "A4").unwrap(), rounded(0.6));
        let message = details.warning().unwrap().message;
        assert!(["A1", "A3", "A4"].iter().all(|piece| message.contains(piece)) && !message.contains("A2"), "{message}");
    }

    prop_compose! {
        /// Lines and arcs of at least 1 mm radius, with corners between them.
        fn way()(steps in prop::collection::vec((2.0..20.0f64, -2.5..2.5f64, -0.9..0.9f64), 1..8)) -> Path {
            let (mut at, mut heading) = (P2::new(100.0, 100.0), 0.0_f64);
            let mut vertices = Vec::new();
            for (length, turn, bulge) in steps {
                heading += turn;
                vertices.push(PathVertex { point: at, bulge: if bulge.abs() < 0.3 { 0.0 } else { bulge } });
                at += V2::new(heading.cos(), heading.sin()) * length;
            }
            vertices.push(PathVertex { point: at, bulge: 0.0 });
            Path { vertices, closed: false }
        }
    }

    proptest! {
        #[test]
        fn the_tip_keeps_to_any_way_a_blade_can_turn(wanted in way(), offset_mm in 0.2..0.5f64) {
            let mut runs = [contour(wanted.clone(), Role::Slit)];
            drag(&mut runs, offset_mm);
            let (off, missed) = apart(&trail(&runs[0].path, wanted.start().unwrap(), offset_mm), &wanted);
            prop_assert!(off < 0.015 && missed < 0.07, "{} {}", off, missed);
        }
    }
}
