//! What is left of a sheet.

use super::empty::Empty;
use super::item::flaw;
use super::{Container, Item, Layout, Settings};
use crate::geom::{P2, Rect, V2};

/// Shapes are covered by so many boxes side by side.
const SLICES: usize = 24;

/// The largest rectangle of a sheet, or of the roll as far as the layout uses it, on which nothing lies and which keeps the spacing to everything that
/// does. A margin at the sheet's border belongs to it. `None` when nothing is left, and for sheets that are no rectangles.
pub fn offcut(items: &[Item], containers: &[Container], layout: &Layout, settings: &Settings) -> Option<Rect> {
    let (outline, blocked) = containers.get(layout.container)?.flaws();
    if !outline.is_empty() {
        return None;
    }
    let mut empty = Empty::new(V2::new(layout.width_mm, layout.height_mm));
    let placed = layout.placements.iter().filter_map(|p| Some(p.placed(&items.get(p.item)?.polygon)));
    for polygon in placed.chain(blocked.iter().cloned()).filter(|p| flaw(p).is_none()) {
        for slice in slices(&polygon) {
            empty.fill(slice.grown(settings.spacing_mm));
        }
    }
    empty.largest()
}

/// Boxes side by side along x that cover a polygon.
fn slices(polygon: &[P2]) -> Vec<Rect> {
    let bounds = Rect::around(polygon);
    let width = bounds.width() / SLICES as f64;
    let mut slices = vec![Rect::EMPTY; SLICES];
    for i in 0..polygon.len() {
        let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        let (a, b) = if a.x <= b.x { (a, b) } else { (b, a) };
        let at = |x: f64| if b.x > a.x { a + (b - a) * ((x - a.x) / (b.x - a.x)).clamp(0.0, 1.0) } else { a };
        for (k, slice) in slices.iter_mut().enumerate() {
            let (from, to) = (bounds.min.x + k as f64 * width, bounds.min.x + (k + 1) as f64 * width);
            if a.x <= to && b.x >= from {
                let ends = if b.x > a.x { [at(from.max(a.x)), at(to.min(b.x))] } else { [a, b] };
                *slice = slice.with(ends[0]).with(ends[1]);
                slice.min.x = from;
                slice.max.x = to;
            }
        }
    }
    slices.retain(|s| !s.is_empty());
    slices
}

#[cfg(test)]
mod tests {
    use super::super::Placement;
    use super::*;

    #[test]
    fn the_rest_of_a_sheet_is_found_beside_and_above_what_lies_on_it() {
        let polygon = [(0.0, 0.0), (60.0, 0.0), (60.0, 30.0)].map(|(x, y)| P2::new(x, y)).to_vec();
        let items = [Item::new("wedge", polygon, vec![0.0])];
        let placements =
            vec![Placement { item: 0, copy: 0, mirrored: false, rotation_deg: 0.0, shift: V2::new(10.0, 10.0) }];
        let layout = Layout { container: 0, width_mm: 100.0, height_mm: 100.0, placements, density: 0.09 };
        let settings = Settings { spacing_mm: 2.0, margin_mm: 10.0, effort: 0, seed: 0 };
        let stock = |blocked| {
            let name = "S".to_owned();
            let (width_mm, height_mm) = (100.0, 100.0);
            [Container::Sheet { name, width_mm, height_mm, count: None, cost: 1.0, outline: Vec::new(), blocked }]
        };
        let rest = offcut(&items, &stock(Vec::new()), &layout, &settings).unwrap();
        assert_eq!(rest, Rect { min: P2::new(0.0, 42.0), max: P2::new(100.0, 100.0) });
        let clamp = [(90.0, 90.0), (100.0, 90.0), (100.0, 100.0), (90.0, 100.0)].map(|(x, y)| P2::new(x, y)).to_vec();
        let rest = offcut(&items, &stock(vec![clamp]), &layout, &settings).unwrap();
        assert_eq!(rest, Rect { min: P2::new(0.0, 42.0), max: P2::new(88.0, 100.0) });
    }
}
