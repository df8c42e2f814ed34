//! Items made ready for packing: checked, turned, boxed.

use super::{Error, Item};
use crate::geom::{Motion, Rect, V2, signed_area};

/// The smallest area an item may have, mm2: a thousandth of a square millimetre is below anything a kerf leaves over.
const MIN_AREA_MM2: f64 = 1e-3;

/// One permitted turn of an item and the box it then fills.
pub(super) struct Turn {
    pub(super) angle_deg: f64,
    /// Box around the turned polygon, before any shift.
    pub(super) bounds: Rect,
}

impl Turn {
    pub(super) fn size(&self) -> V2 {
        V2::new(self.bounds.width(), self.bounds.height())
    }
}

/// What packing needs to know of an item.
pub(super) struct Prepared {
    pub(super) area: f64,
    /// Never empty.
    pub(super) turns: Vec<Turn>,
}

impl Prepared {
    pub(super) fn new(item: &Item) -> Result<Prepared, Error> {
        let flawed = |flaw| Error::Item { item: item.name.clone(), flaw };
        if item.polygon.len() < 3 {
            return Err(flawed("its outline has fewer than 3 points"));
        }
        if !item.polygon.iter().all(|p| p.x.is_finite() && p.y.is_finite()) {
            return Err(flawed("its outline has a coordinate that is not a finite number"));
        }
        let area = signed_area(&item.polygon).abs();
        if area < MIN_AREA_MM2 {
            return Err(flawed("its outline encloses no area (below 0.001 mm2)"));
        }
        if item.angles_deg.is_empty() {
            return Err(flawed("no angle is allowed for it; allow at least 0 degrees"));
        }
        if !item.angles_deg.iter().all(|a| a.is_finite()) {
            return Err(flawed("one of its angles is not a finite number"));
        }
        let turns = item.angles_deg.iter().map(|&angle_deg| turn(item, angle_deg)).collect();
        Ok(Prepared { area, turns })
    }

    /// Longer and shorter side of the box at the first turn.
    pub(super) fn sides(&self) -> (f64, f64) {
        let size = self.turns[0].size();
        (size.x.max(size.y), size.x.min(size.y))
    }
}

fn turn(item: &Item, angle_deg: f64) -> Turn {
    let motion = Motion::new(V2::zeros(), angle_deg.to_radians());
    let bounds = item.polygon.iter().fold(Rect::EMPTY, |rect, p| rect.with(motion * p));
    Turn { angle_deg, bounds }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::P2;

    fn item(points: &[(f64, f64)], angles_deg: &[f64]) -> Item {
        let polygon = points.iter().map(|&(x, y)| P2::new(x, y)).collect();
        Item { name: "A1".into(), polygon, angles_deg: angles_deg.to_vec() }
    }

    #[test]
    fn a_quarter_turn_swaps_the_sides_of_the_box() {
        let prepared = Prepared::new(&item(&[(0.0, 0.0), (30.0, 0.0), (30.0, 5.0), (0.0, 5.0)], &[0.0, 90.0])).unwrap();
        assert_eq!(prepared.area, 150.0);
        assert!((prepared.turns[1].size() - V2::new(5.0, 30.0)).norm() < 1e-9);
        assert!((prepared.turns[1].bounds.min.x + 5.0).abs() < 1e-9);
    }

    #[test]
    fn shapes_that_are_none_are_refused_by_name() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let cases = [
            (item(&[(0.0, 0.0), (1.0, 0.0)], &[0.0]), "fewer than 3"),
            (item(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)], &[0.0]), "no area"),
            (item(&[(0.0, 0.0), (f64::NAN, 0.0), (2.0, 1.0)], &[0.0]), "finite"),
            (item(&[(0.0, 0.0), (f64::INFINITY, 0.0), (2.0, 1.0)], &[0.0]), "finite"),
            (item(&square, &[]), "no angle"),
            (item(&square, &[f64::NAN]), "angles"),
        ];
        for (item, word) in cases {
            let message = Prepared::new(&item).err().expect("refused").to_string();
            assert!(message.contains("A1") && message.contains(word), "{message}");
        }
    }
}
