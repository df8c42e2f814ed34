//! Leads: a constant beam is lit, and put out, beside the contour, on what falls away.

use super::cuts::Cut;
use super::{Settings, curve};
use crate::drawing::Role;
use crate::geom::{P2, Path, PathVertex, V2, contains, distance_to_loop, tolerance};

/// Room between a lead's beam and any piece, mm.
const CLEAR_MM: f64 = 0.1;

/// Points at which a lead is looked at.
const LOOKS: u32 = 8;

/// Where leads may lie: everywhere but on a piece.
pub(super) struct Scrap {
    pieces: Vec<(String, Vec<P2>)>,
    half_kerf_mm: f64,
}

impl Scrap {
    /// What the outlines among `cuts` leave over. Outlines are compensated, so they lie half a kerf outside their piece.
    pub fn of(cuts: &[Cut], settings: &Settings) -> Scrap {
        let outlines = cuts.iter().filter(|c| c.role == Role::Outline && c.path.closed);
        let flat = |c: &Cut| (c.piece.clone(), c.path.flatten(tolerance::FLATTEN_MM));
        Scrap { pieces: outlines.map(flat).collect(), half_kerf_mm: 0.5 * settings.kerf_mm }
    }

    /// The contours of all pieces, for who looks for free places.
    pub fn pieces(&self) -> impl Iterator<Item = &[P2]> {
        self.pieces.iter().map(|(_, outline)| outline.as_slice())
    }

    /// The path with a lead-in of `lead_mm`, and with a lead-out when it `closes`, at 45 degrees from the waste. Without where they would touch a
    /// piece, and on what has no waste.
    pub fn led(&self, path: Path, cut: &Cut, lead_mm: f64, closes: bool) -> Path {
        let Some(waste_left) = cut.waste_left.filter(|_| lead_mm > 0.0) else { return path };
        let total = path.length();
        let closes = closes && path.closed;
        let open = if path.closed { curve::stretch(&path, 0.0, total) } else { path.clone() };
        let mut segments = open.segments();
        let (Some(first), last) = (segments.next(), open.segments().last()) else { return path };
        let aside = |heading: V2| V2::new(-heading.y, heading.x) * if waste_left { 1.0 } else { -1.0 };
        let heading = curve::start_direction(&first);
        let from = first.from() + (aside(heading) - heading).normalize() * lead_mm;
        if !self.is_free(from, first.from(), cut) {
            return path;
        }
        let mut vertices = vec![PathVertex { point: from, bulge: 0.0 }];
        vertices.extend(open.vertices.iter().copied());
        if let Some(last) = last.filter(|_| closes) {
            let heading = curve::direction_at(&last, 1.0);
            let to = last.to() + (aside(heading) + heading).normalize() * lead_mm;
            if self.is_free(to, last.to(), cut) {
                vertices.push(PathVertex { point: to, bulge: 0.0 });
            }
        }
        Path { vertices, closed: false }
    }

    /// True when the beam touches no piece between a point on scrap and one on the contour of `cut`.
    fn is_free(&self, off: P2, on: P2, cut: &Cut) -> bool {
        (0..LOOKS).map(|k| off + (on - off) * (f64::from(k) / f64::from(LOOKS))).all(|p| {
            self.pieces.iter().all(|(name, outline)| {
                let own = *name == cut.piece;
                // A hole's waste lies in its own piece.
                let inside = contains(outline, p) != (own && cut.role == Role::Hole);
                !inside && (own || distance_to_loop(outline, p) > self.half_kerf_mm + CLEAR_MM)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::cuts::tests::cut;
    use super::super::tests::settings;
    use super::*;
    use crate::geom::signed_area;

    fn square(x: f64, piece: &str) -> Cut {
        let corners = [(x, 0.0), (x + 10.0, 0.0), (x + 10.0, 10.0), (x, 10.0)];
        Cut { piece: piece.into(), ..cut(Path::closed(corners.map(|(x, y)| P2::new(x, y))), Role::Outline) }
    }

    #[test]
    fn leads_come_from_the_waste_and_leave_to_it_whichever_way_the_contour_runs() {
        for turned in [false, true] {
            let mut piece = square(0.0, "A1");
            if turned {
                piece.path = piece.path.reversed();
                piece.waste_left = piece.waste_left.map(|left| !left);
            }
            let led = Scrap::of(std::slice::from_ref(&piece), &settings()).led(piece.path.clone(), &piece, 1.0, true);
            let corners = piece.path.flatten(0.01);
            assert!((led.length() - 42.0).abs() < 1e-9 && !led.closed);
            for p in [led.start().unwrap(), led.end().unwrap()] {
                assert!(!contains(&corners, p), "{p} of {:?}", signed_area(&corners));
            }
        }
        let mut hole = square(0.0, "A1");
        (hole.role, hole.waste_left) = (Role::Hole, Some(true));
        let scrap = Scrap::of(&[square(-20.0, "A2")], &settings());
        let led = scrap.led(hole.path.clone(), &hole, 1.0, true);
        assert!(contains(&hole.path.flatten(0.01), led.start().unwrap()));
    }

    #[test]
    fn no_lead_touches_a_neighbour() {
        let (left, right) = (square(0.0, "A1"), square(10.5, "A2"));
        let scrap = Scrap::of(&[left.clone(), right], &settings());
        // From the right lower corner the lead would run into the neighbour.
        assert_eq!(scrap.led(left.path.starting_at(1), &left, 1.0, true), left.path.starting_at(1));
        assert!((scrap.led(left.path.starting_at(3), &left, 1.0, true).length() - 42.0).abs() < 1e-9);
    }
}
