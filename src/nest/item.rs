//! Items made ready for placing: checked, turned, taken apart into bands.

use super::shape::Shape;
use super::{Error, Item};
use crate::geom::{Motion, P2, Rect, V2, segments_cross, signed_area};
use std::rc::Rc;

/// The smallest area an item may have, mm2: a thousandth of a square millimetre is below anything a kerf leaves over.
const MIN_AREA_MM2: f64 = 1e-3;

/// Farther out round-off comes near what validation forgives, mm.
const FARTHEST_MM: f64 = 1e7;

/// Shapes may become this much too large where that saves corners, as a share of how thick items are (area over perimeter of their boxes): 0.1 mm for
/// ribbons of 600 x 80 mm. Less costs as much in speed as it gains in room.
const ROUGH: f64 = 3e-3;

/// One way to lay an item: turned over or not, then turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    pub(super) angle_deg: f64,
    pub(super) mirrored: bool,
}

impl Turn {
    /// The outline as it lies, its own origin at the origin.
    fn of(self, polygon: &[P2]) -> Vec<P2> {
        let motion = Motion::new(V2::zeros(), self.angle_deg.to_radians());
        polygon.iter().map(|p| motion * if self.mirrored { P2::new(p.x, -p.y) } else { *p }).collect()
    }
}

/// What placing needs to know of an item.
pub(super) struct Prepared {
    pub(super) area: f64,
    /// Area it takes up with its share of the spacing around it, mm2.
    pub(super) takes: f64,
    /// Never empty.
    pub(super) turns: Vec<Turn>,
    /// The item at each turn.
    pub(super) shapes: Rc<[Shape]>,
}

/// Checks the items and takes them apart, each grown by `by`.
pub(super) fn prepared(items: &[Item], by: f64) -> Result<Vec<Prepared>, Error> {
    items.iter().try_for_each(check)?;
    let within = roughness(items);
    Ok(items.iter().map(|item| prepare(item, within, by)).collect())
}

/// How much too large shapes may become, mm.
pub(super) fn roughness(items: &[Item]) -> f64 {
    let boxes = items.iter().map(|item| Rect::around(&item.polygon));
    let thick = boxes.map(|b| 0.5 * b.width() * b.height() / (b.width() + b.height())).sum::<f64>();
    ROUGH * thick / items.len().max(1) as f64
}

fn prepare(item: &Item, within: f64, by: f64) -> Prepared {
    let sides: &[bool] = if item.mirror && item.fixed.is_none() { &[false, true] } else { &[false] };
    let angles = item.fixed.as_ref().map_or(item.angles_deg.clone(), |fixed| vec![fixed.rotation_deg]);
    let mut turns: Vec<Turn> = Vec::new();
    for mirrored in sides {
        for angle_deg in &angles {
            let turn = Turn { angle_deg: *angle_deg, mirrored: *mirrored };
            if !turns.contains(&turn) {
                turns.push(turn);
            }
        }
    }
    let shapes = turns.iter().map(|turn| Shape::new(&[turn.of(&item.polygon)], within, by)).collect();
    let (area, bounds) = (signed_area(&item.polygon).abs(), Rect::around(&item.polygon));
    let takes = area + 2.0 * by * (bounds.width() + bounds.height());
    Prepared { area, takes, turns, shapes }
}

fn check(item: &Item) -> Result<(), Error> {
    let flawed = |flaw| Err(Error::Item { item: item.name.clone(), flaw });
    if let Some(flaw) = flaw(&item.polygon) {
        return flawed(flaw);
    }
    if item.angles_deg.is_empty() {
        return flawed("no angle is allowed for it; allow at least 0 degrees");
    }
    let fixed = item.fixed.map(|f| [f.rotation_deg, f.shift.x, f.shift.y]);
    if !item.angles_deg.iter().chain(fixed.iter().flatten()).all(|a| a.is_finite()) {
        return flawed("one of its angles, or where it is fixed, is not a finite number");
    }
    if item.fixed.is_some() && item.copies != 1 {
        return flawed("it is fixed in place and can be there once only");
    }
    Ok(())
}

/// Why a polygon is none.
pub(super) fn flaw(polygon: &[P2]) -> Option<&'static str> {
    if polygon.len() < 3 {
        return Some("its outline has fewer than 3 points");
    }
    if !polygon.iter().all(|p| p.x.is_finite() && p.y.is_finite()) {
        return Some("its outline has a coordinate that is not a finite number");
    }
    if polygon.iter().any(|p| p.x.abs().max(p.y.abs()) > FARTHEST_MM) {
        return Some("its outline reaches beyond 10 km; check the unit it is drawn in");
    }
    if signed_area(polygon).abs() < MIN_AREA_MM2 {
        return Some("its outline encloses no area (below 0.001 mm2)");
    }
    crosses_itself(polygon).then_some("its outline crosses itself; draw it in one turn around the shape")
}

fn crosses_itself(polygon: &[P2]) -> bool {
    let n = polygon.len();
    let edge = |i: usize| (polygon[i], polygon[(i + 1) % n]);
    let mut order: Vec<usize> = (0..n).collect();
    let left = |i: usize| edge(i).0.x.min(edge(i).1.x);
    order.sort_by(|i, j| left(*i).total_cmp(&left(*j)));
    order.iter().enumerate().any(|(k, i)| {
        let (a, b) = edge(*i);
        let right = a.x.max(b.x);
        let near = order[k + 1..].iter().take_while(|j| left(**j) <= right);
        near.map(|j| edge(*j)).any(|(c, d)| segments_cross(a, b, c, d))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(points: &[(f64, f64)], angles_deg: &[f64]) -> Item {
        Item::new("A1", points.iter().map(|&(x, y)| P2::new(x, y)).collect(), angles_deg.to_vec())
    }

    #[test]
    fn a_quarter_turn_swaps_the_sides_of_the_box() {
        let bar = item(&[(0.0, 0.0), (30.0, 0.0), (30.0, 5.0), (0.0, 5.0)], &[0.0, 90.0]);
        let ready = &prepared(&[bar], 0.0).unwrap()[0];
        assert_eq!(ready.area, 150.0);
        assert!((ready.shapes[1].size - V2::new(5.0, 30.0)).norm() < 1e-9);
        assert!((ready.shapes[1].origin - V2::new(-5.0, 0.0)).norm() < 1e-9);
    }

    #[test]
    fn a_shape_that_may_be_turned_over_has_twice_the_turns() {
        let mut wedge = item(&[(0.0, 0.0), (30.0, 0.0), (30.0, 5.0)], &[0.0, 180.0, 0.0]);
        assert_eq!(prepared(&[wedge.clone()], 0.0).unwrap()[0].turns.len(), 2);
        wedge.mirror = true;
        assert_eq!(prepared(&[wedge], 0.0).unwrap()[0].turns.len(), 4);
    }

    #[test]
    fn shapes_that_are_none_are_refused_by_name() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let cases = [
            (item(&[(0.0, 0.0), (1.0, 0.0)], &[0.0]), "fewer than 3"),
            (item(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)], &[0.0]), "no area"),
            (item(&[(0.0, 0.0), (f64::NAN, 0.0), (2.0, 1.0)], &[0.0]), "finite"),
            (item(&[(0.0, 0.0), (f64::INFINITY, 0.0), (2.0, 1.0)], &[0.0]), "finite"),
            (item(&[(0.0, 0.0), (1e300, 0.0), (2.0, 1.0)], &[0.0]), "10 km"),
            (item(&[(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 1.0)], &[0.0]), "crosses itself"),
            (item(&square, &[]), "no angle"),
            (item(&square, &[f64::NAN]), "angles"),
        ];
        for (item, word) in cases {
            let message = prepared(&[item], 0.0).err().expect("refused").to_string();
            assert!(message.contains("A1") && message.contains(word), "{message}");
        }
    }
}
