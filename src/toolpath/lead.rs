//! Leads: a constant beam is lit, and put out, beside the contour, on what falls away.

use super::cuts::Cut;
use super::{Settings, curve};
use crate::drawing::Drawing;
use crate::geom::{P2, Path, PathVertex, V2, contains, distance_to_loop, signed_area, tolerance};

/// Room between a lead's beam and any piece, mm.
const CLEAR_MM: f64 = 0.1;

/// Points at which a lead is looked at.
const LOOKS: u32 = 8;

/// Where leads may lie: everywhere but on a piece.
pub(super) struct Scrap {
    pieces: Vec<(String, Vec<P2>)>,
    kerf_mm: f64,
}

impl Scrap {
    /// What the pieces leave over, mm in the frame they are drawn in.
    pub fn of(pieces: &[Drawing], settings: &Settings) -> Scrap {
        let flat = |d: &Drawing| Some((d.name.clone(), d.outline()?.flatten(tolerance::FLATTEN_MM)));
        Scrap { pieces: pieces.iter().filter_map(flat).collect(), kerf_mm: settings.kerf_mm }
    }

    /// The contours of all pieces, for who looks for free places.
    pub fn pieces(&self) -> impl Iterator<Item = &[P2]> {
        self.pieces.iter().map(|(_, outline)| outline.as_slice())
    }

    /// The path with a lead-in of `lead_mm`, and with a lead-out when it `closes`, over the waste. Without where they would touch a piece, and on what
    /// has no waste.
    pub fn led(&self, path: Path, cut: &Cut, lead_mm: f64, closes: bool) -> Path {
        let Some(waste_left) = cut.waste_left.filter(|_| lead_mm > 0.0) else { return path };
        let closes = closes && path.closed;
        let open = if path.closed { curve::stretch(&path, 0.0, path.length()) } else { path.clone() };
        let (Some(first), Some(last)) = (open.segments().next(), open.segments().last()) else { return path };
        let own = cut.path.flatten(tolerance::FLATTEN_MM);
        let side = if waste_left { 1.0 } else { -1.0 };
        // Slanting, so that it meets the contour smoothly; where a corner is in the way, slanting the other way or straight.
        let off = |on: P2, heading: V2, slant: f64| {
            let aside = V2::new(-heading.y, heading.x) * side;
            let ways = [aside - heading * slant, aside + heading * slant, aside];
            ways.into_iter().map(|way| on + way.normalize() * lead_mm).find(|off| self.is_free(*off, on, cut, &own))
        };
        let Some(from) = off(first.from(), curve::start_direction(&first), 1.0) else { return path };
        let to = off(last.to(), curve::direction_at(&last, 1.0), -1.0).filter(|_| closes);
        let ends = |p| PathVertex { point: p, bulge: 0.0 };
        let vertices = std::iter::once(ends(from)).chain(open.vertices).chain(to.map(ends));
        Path { vertices: vertices.collect(), closed: false }
    }

    /// True when the beam touches no piece between a point on scrap and one on the contour of `cut`, which flattened is `own`.
    fn is_free(&self, off: P2, on: P2, cut: &Cut, own: &[P2]) -> bool {
        let waste_inside = cut.waste_left == Some(signed_area(own) > 0.0);
        (0..LOOKS).map(|k| off + (on - off) * (f64::from(k) / f64::from(LOOKS))).all(|p| {
            let clear = |(name, outline): &(String, Vec<P2>)| {
                *name == cut.piece || !contains(outline, p) && distance_to_loop(outline, p) > self.kerf_mm + CLEAR_MM
            };
            contains(own, p) == waste_inside && self.pieces.iter().all(clear)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::cuts::tests::cut;
    use super::super::tests::settings;
    use super::*;
    use crate::drawing::{DrawnPath, KerfSide, Role};

    fn drawn(cut: &Cut) -> Drawing {
        let path = DrawnPath { path: cut.path.clone(), role: Role::Outline, kerf: KerfSide::Outside, joint: None };
        Drawing { name: cut.piece.clone(), paths: vec![path] }
    }

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
            let led = Scrap::of(&[drawn(&piece)], &settings()).led(piece.path.clone(), &piece, 1.0, true);
            let corners = piece.path.flatten(0.01);
            assert!((led.length() - 42.0).abs() < 1e-9 && !led.closed);
            for p in [led.start().unwrap(), led.end().unwrap()] {
                assert!(!contains(&corners, p), "{p} of {:?}", signed_area(&corners));
            }
        }
        let mut hole = square(0.0, "A1");
        (hole.role, hole.waste_left) = (Role::Hole, Some(true));
        let scrap = Scrap::of(&[drawn(&square(-20.0, "A2"))], &settings());
        let led = scrap.led(hole.path.clone(), &hole, 1.0, true);
        assert!(contains(&hole.path.flatten(0.01), led.start().unwrap()));
    }

    #[test]
    fn no_lead_touches_a_neighbour() {
        let left = square(0.0, "A1");
        let beside = [(10.5, -5.0), (20.0, -5.0), (20.0, 15.0), (10.5, 15.0)].map(|(x, y)| P2::new(x, y));
        let right = Cut { piece: "A2".into(), ..cut(Path::closed(beside), Role::Outline) };
        let scrap = Scrap::of(&[drawn(&left), drawn(&right)], &settings());
        // From the right lower corner the lead would run into the neighbour.
        assert_eq!(scrap.led(left.path.starting_at(1), &left, 1.0, true), left.path.starting_at(1));
        assert!((scrap.led(left.path.starting_at(3), &left, 1.0, true).length() - 42.0).abs() < 1e-9);
    }
}
