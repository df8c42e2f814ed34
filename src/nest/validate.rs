//! Checks a finished result on the true polygons, knowing nothing of how it was made.

use super::{Container, Error, Item, Layout, Layouts, Settings};
use crate::geom::{P2, Rect, V2, distance_to_segment, enclosed, tolerance};

/// A placed polygon and the box around it.
struct Placed<'a> {
    name: &'a str,
    polygon: Vec<P2>,
    bounds: Rect,
}

/// Checks that every item is placed exactly once at an allowed angle, that no more stock is used than there is, that no two items overlap or
/// come nearer than the spacing, and that all keep the margin. Distances may fall short by [`tolerance::SAME_POINT_MM`].
///
/// # Errors
/// The first thing found wrong, naming items and layout.
pub fn validate(items: &[Item], containers: &[Container], layouts: &Layouts, settings: &Settings) -> Result<(), Error> {
    let mut times = vec![0; items.len()];
    let mut used = vec![0; containers.len()];
    for (l, layout) in layouts.layouts.iter().enumerate() {
        let number = l + 1;
        let container = containers.get(layout.container).ok_or(Error::Dangling {
            layout: number,
            what: "container",
            index: layout.container,
        })?;
        used[layout.container] += 1;
        check_size(layout, container, number)?;

        let mut placed: Vec<Placed> = Vec::with_capacity(layout.placements.len());
        for placement in &layout.placements {
            let dangling = Error::Dangling { layout: number, what: "item", index: placement.item };
            let item = items.get(placement.item).ok_or(dangling)?;
            times[placement.item] += 1;
            if !item.angles_deg.contains(&placement.rotation_deg) {
                return Err(Error::Angle { item: item.name.clone(), rotation_deg: placement.rotation_deg });
            }
            let motion = placement.motion();
            let polygon: Vec<P2> = item.polygon.iter().map(|p| motion * p).collect();
            let bounds = box_around(&polygon);
            check_margin(&item.name, &bounds, layout, settings.margin_mm, number)?;
            placed.push(Placed { name: &item.name, polygon, bounds });
        }
        for (i, a) in placed.iter().enumerate() {
            for b in &placed[i + 1..] {
                check_pair(a, b, settings.spacing_mm, number)?;
            }
        }
    }
    for (container, &used) in containers.iter().zip(&used) {
        if let Some(count) = container.count()
            && used > count as usize
        {
            return Err(Error::Stock { container: container.name().to_string(), used, count });
        }
    }
    match items.iter().zip(times).find(|(_, times)| *times != 1) {
        Some((item, times)) => Err(Error::Times { item: item.name.clone(), times }),
        None => Ok(()),
    }
}

fn check_size(layout: &Layout, container: &Container, number: usize) -> Result<(), Error> {
    let size = container.size_mm();
    let slack = tolerance::SAME_POINT_MM;
    let width_fits = match container {
        Container::Sheet { .. } => (layout.width_mm - size.x).abs() <= slack,
        Container::Roll { .. } => layout.width_mm <= size.x + slack,
    };
    if width_fits && (layout.height_mm - size.y).abs() <= slack {
        return Ok(());
    }
    let (width_mm, height_mm) = (layout.width_mm, layout.height_mm);
    Err(Error::LayoutSize { layout: number, container: container.name().to_string(), width_mm, height_mm })
}

/// The box around the polygon; the whole plane when a coordinate is not a number, so that no margin holds it.
fn box_around(polygon: &[P2]) -> Rect {
    if polygon.iter().all(|p| p.x.is_finite() && p.y.is_finite()) {
        return Rect::around(polygon);
    }
    let all = f64::INFINITY;
    Rect { min: P2::new(-all, -all), max: P2::new(all, all) }
}

fn check_margin(item: &str, bounds: &Rect, layout: &Layout, margin_mm: f64, number: usize) -> Result<(), Error> {
    let inside = Rect::from_size(layout.width_mm, layout.height_mm).grown(-margin_mm);
    let by_mm = (inside.min - bounds.min).max().max((bounds.max - inside.max).max());
    if by_mm <= tolerance::SAME_POINT_MM {
        return Ok(());
    }
    Err(Error::Margin { item: item.to_string(), layout: number, by_mm, margin_mm })
}

fn check_pair(a: &Placed, b: &Placed, spacing_mm: f64, number: usize) -> Result<(), Error> {
    if !a.bounds.grown(spacing_mm).overlaps(&b.bounds) {
        return Ok(());
    }
    let names = || (a.name.to_string(), b.name.to_string());
    let area_mm2 = common_area(&a.polygon, &b.polygon);
    // Polygons that touch along an edge share no more than round-off times its length.
    let round_off = 10.0 * tolerance::SAME_POINT_MM * (perimeter(&a.polygon) + perimeter(&b.polygon));
    if area_mm2 > round_off {
        let (first, second) = names();
        return Err(Error::Overlap { first, second, layout: number, area_mm2 });
    }
    let distance_mm = distance(&a.polygon, &b.polygon);
    if distance_mm < spacing_mm - tolerance::SAME_POINT_MM {
        let (first, second) = names();
        return Err(Error::Spacing { first, second, layout: number, distance_mm, spacing_mm });
    }
    Ok(())
}

fn edges(polygon: &[P2]) -> impl Iterator<Item = (P2, P2)> + '_ {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

fn perimeter(polygon: &[P2]) -> f64 {
    edges(polygon).map(|(a, b)| (b - a).norm()).sum()
}

fn common_area(a: &[P2], b: &[P2]) -> f64 {
    // Near the origin, where the grid of the triangulation is finest against the numbers.
    let shift: V2 = a[0].coords;
    let b: Vec<P2> = b.iter().map(|p| p - shift).collect();
    let segments: Vec<(P2, P2)> = edges(a).map(|(p, q)| (p - shift, q - shift)).collect();
    enclosed(&segments).coverage([b].iter()).covered.abs()
}

/// Smallest distance between the borders of two polygons that do not cross.
fn distance(a: &[P2], b: &[P2]) -> f64 {
    let corner_to_edge = |corners: &[P2], polygon: &[P2]| {
        edges(polygon)
            .flat_map(|(p, q)| corners.iter().map(move |c| distance_to_segment(*c, p, q)))
            .fold(f64::INFINITY, f64::min)
    };
    corner_to_edge(a, b).min(corner_to_edge(b, a))
}

#[cfg(test)]
mod tests {
    use super::super::Placement;
    use super::*;

    fn square(name: &str) -> Item {
        let polygon = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|(x, y)| P2::new(x, y)).to_vec();
        Item { name: name.into(), polygon, angles_deg: vec![0.0] }
    }

    fn two(second: (f64, f64)) -> Layouts {
        let at = |item, (x, y)| Placement { item, rotation_deg: 0.0, shift: V2::new(x, y) };
        let placements = vec![at(0, (5.0, 5.0)), at(1, second)];
        let layout = Layout { container: 0, width_mm: 50.0, height_mm: 40.0, placements, density: 0.1 };
        Layouts { layouts: vec![layout], stopped_early: false }
    }

    fn verdict(layouts: &Layouts, spacing_mm: f64) -> Result<(), Error> {
        let stock = [Container::Sheet { name: "S".into(), width_mm: 50.0, height_mm: 40.0, count: Some(1) }];
        validate(&[square("A"), square("B")], &stock, layouts, &Settings { spacing_mm, margin_mm: 5.0 })
    }

    #[test]
    fn a_layout_that_just_keeps_its_distances_passes() {
        assert_eq!(verdict(&two((17.0, 5.0)), 2.0), Ok(()));
        assert_eq!(verdict(&two((35.0, 25.0)), 2.0), Ok(()));
        assert_eq!(verdict(&two((15.0, 5.0)), 0.0), Ok(()));
    }

    #[test]
    fn a_spoilt_layout_is_told_what_is_wrong_with_it() {
        assert!(matches!(verdict(&two((16.9, 5.0)), 2.0), Err(Error::Spacing { .. })));
        assert!(matches!(verdict(&two((16.0, 16.0)), 2.0), Err(Error::Spacing { .. })), "corner to corner");
        assert!(matches!(verdict(&two((14.9, 5.0)), 0.0), Err(Error::Overlap { .. })));
        assert!(matches!(verdict(&two((5.0, 5.0)), 0.0), Err(Error::Overlap { .. })), "on top of each other");
        assert!(matches!(verdict(&two((35.1, 5.0)), 2.0), Err(Error::Margin { .. })));
        assert!(matches!(verdict(&two((f64::NAN, 5.0)), 2.0), Err(Error::Margin { .. })));
    }

    #[test]
    fn bookkeeping_is_checked_too() {
        let good = two((17.0, 5.0));
        let spoilt = |change: &dyn Fn(&mut Layouts)| {
            let mut layouts = good.clone();
            change(&mut layouts);
            verdict(&layouts, 2.0)
        };
        assert!(matches!(spoilt(&|l| l.layouts[0].placements[1].item = 2), Err(Error::Dangling { .. })));
        assert!(matches!(spoilt(&|l| l.layouts[0].placements[1].item = 0), Err(Error::Times { times: 2, .. })));
        assert!(matches!(spoilt(&|l| l.layouts[0].placements.truncate(1)), Err(Error::Times { times: 0, .. })));
        assert!(matches!(spoilt(&|l| l.layouts[0].placements[1].rotation_deg = 90.0), Err(Error::Angle { .. })));
        assert!(matches!(spoilt(&|l| l.layouts[0].width_mm = 60.0), Err(Error::LayoutSize { .. })));
        assert!(matches!(spoilt(&|l| l.layouts[0].container = 1), Err(Error::Dangling { .. })));
        let empty = Layout { placements: vec![], ..good.layouts[0].clone() };
        assert!(matches!(spoilt(&|l| l.layouts.push(empty.clone())), Err(Error::Stock { used: 2, .. })));
    }
}
