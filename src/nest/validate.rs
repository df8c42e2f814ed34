//! Checks a finished result on the true polygons, knowing nothing of how it was made.

use super::{Container, Error, Item, Layout, Layouts, Placement, Settings};
use crate::geom::{P2, Rect, V2, contains, distance_to_segment, enclosed, segments_cross, signed_area, tolerance};

/// A placed polygon and the box around it.
struct Placed<'a> {
    name: &'a str,
    polygon: Vec<P2>,
    bounds: Rect,
}

/// Checks that every copy of every item is placed exactly once at an allowed angle or named as unplaced, that what is fixed lies where it was fixed, that no
/// more stock is used than there is, that no two items overlap or come nearer than the spacing, that all keep the margin to the border, and the spacing to
/// what is blocked. Distances may fall short by [`tolerance::SAME_POINT_MM`].
///
/// # Errors
/// The first thing found wrong, naming items and layout.
pub fn validate(items: &[Item], containers: &[Container], layouts: &Layouts, settings: &Settings) -> Result<(), Error> {
    let mut times: Vec<Vec<usize>> = items.iter().map(|item| vec![0; item.copies as usize]).collect();
    let mut used = vec![0; containers.len()];
    for (l, layout) in layouts.layouts.iter().enumerate() {
        let number = l + 1;
        let dangling = |what, index| Error::Dangling { layout: number, what, index };
        let container = containers.get(layout.container).ok_or(dangling("container", layout.container))?;
        used[layout.container] += 1;
        check_size(layout, container, number)?;

        let mut placed: Vec<Placed> = Vec::with_capacity(layout.placements.len());
        for placement in &layout.placements {
            let item = items.get(placement.item).ok_or(dangling("item", placement.item))?;
            let copy = placement.copy as usize;
            *times[placement.item].get_mut(copy).ok_or(dangling("copy", copy))? += 1;
            check_turn(item, placement, layout)?;
            let polygon = placement.placed(&item.polygon);
            let bounds = box_around(&polygon);
            check_margin(&item.name, &bounds, layout, settings.margin_mm, number)?;
            let placed_here = Placed { name: &item.name, polygon, bounds };
            check_flaws(&placed_here, container, settings, number)?;
            placed.push(placed_here);
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
    for unplaced in &layouts.unplaced {
        if let Some(times) = times.get_mut(unplaced.item).and_then(|t| t.get_mut(unplaced.copy as usize)) {
            *times += 1;
        }
    }
    let wrong = |(item, times): (&Item, &Vec<usize>)| {
        let times = times.iter().copied().find(|t| *t != 1)?;
        Some(Error::Times { item: item.name.clone(), times })
    };
    items.iter().zip(&times).find_map(wrong).map_or(Ok(()), Err)
}

fn check_turn(item: &Item, placement: &Placement, layout: &Layout) -> Result<(), Error> {
    let item_name = || item.name.clone();
    if let Some(fixed) = item.fixed {
        let here = (placement.rotation_deg, placement.shift, placement.mirrored, layout.container);
        let there = (fixed.rotation_deg, fixed.shift, false, fixed.container);
        return if here == there { Ok(()) } else { Err(Error::Moved { item: item_name() }) };
    }
    if placement.mirrored && !item.mirror {
        return Err(Error::Mirrored { item: item_name() });
    }
    if !item.angles_deg.contains(&placement.rotation_deg) {
        return Err(Error::Angle { item: item_name(), rotation_deg: placement.rotation_deg });
    }
    Ok(())
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

/// The border of an offcut keeps the margin, what is blocked the spacing.
fn check_flaws(item: &Placed, container: &Container, settings: &Settings, number: usize) -> Result<(), Error> {
    let (outline, blocked) = container.flaws();
    let wrong = |what, distance_mm, limit_mm| {
        let (item, container) = (item.name.to_string(), container.name().to_string());
        Err(Error::Blocked { item, layout: number, container, what, distance_mm, limit_mm })
    };
    if !outline.is_empty() {
        let outside = signed_area(&item.polygon).abs() - common_area(&item.polygon, outline);
        if outside > round_off(&item.polygon, outline) {
            return wrong("the border", 0.0, settings.margin_mm);
        }
        if let Some(distance_mm) = nearer_than(&item.polygon, outline, settings.margin_mm - tolerance::SAME_POINT_MM) {
            return wrong("the border", distance_mm, settings.margin_mm);
        }
    }
    for area in blocked.iter().filter(|b| box_around(b).grown(settings.spacing_mm).overlaps(&item.bounds)) {
        match clash(&item.polygon, area, settings.spacing_mm) {
            Some(Clash::Overlap(_)) => return wrong("what is blocked", 0.0, settings.spacing_mm),
            Some(Clash::Near(distance_mm)) => return wrong("what is blocked", distance_mm, settings.spacing_mm),
            None => {}
        }
    }
    Ok(())
}

fn check_pair(a: &Placed, b: &Placed, spacing_mm: f64, number: usize) -> Result<(), Error> {
    if !a.bounds.grown(spacing_mm).overlaps(&b.bounds) {
        return Ok(());
    }
    let (first, second, layout) = (a.name.to_string(), b.name.to_string(), number);
    match clash(&a.polygon, &b.polygon, spacing_mm) {
        Some(Clash::Overlap(area_mm2)) => Err(Error::Overlap { first, second, layout, area_mm2 }),
        Some(Clash::Near(distance_mm)) => Err(Error::Spacing { first, second, layout, distance_mm, spacing_mm }),
        None => Ok(()),
    }
}

/// What two polygons have against each other.
enum Clash {
    /// They share so much area, mm2.
    Overlap(f64),
    /// They are only so far apart, mm.
    Near(f64),
}

fn clash(a: &[P2], b: &[P2], spacing_mm: f64) -> Option<Clash> {
    // Polygons whose borders keep clear of each other overlap only when one lies inside the other.
    let near = nearer_than(a, b, spacing_mm.max(10.0 * tolerance::SAME_POINT_MM));
    let touch = near.is_some_and(|distance| distance < 10.0 * tolerance::SAME_POINT_MM);
    if touch || contains(a, b[0]) || contains(b, a[0]) {
        let area = common_area(a, b);
        if area > round_off(a, b) {
            return Some(Clash::Overlap(area));
        }
    }
    near.filter(|distance| *distance < spacing_mm - tolerance::SAME_POINT_MM).map(Clash::Near)
}

/// Polygons that touch along an edge share no more than round-off times its length.
fn round_off(a: &[P2], b: &[P2]) -> f64 {
    10.0 * tolerance::SAME_POINT_MM * (perimeter(a) + perimeter(b))
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

/// The distance between two borders, when it is below a limit; 0 where they cross.
fn nearer_than(a: &[P2], b: &[P2], limit: f64) -> Option<f64> {
    let mut beside: Vec<(P2, P2)> = edges(b).collect();
    let left = |(p, q): &(P2, P2)| p.x.min(q.x);
    beside.sort_by(|e, f| left(e).total_cmp(&left(f)));
    let longest = beside.iter().map(|(p, q)| (p.x - q.x).abs()).fold(0.0, f64::max);
    let mut nearest = limit;
    for (p, q) in edges(a) {
        let (from, to) = (p.x.min(q.x) - limit, p.x.max(q.x) + limit);
        let first = beside.partition_point(|e| left(e) < from - longest);
        for (c, d) in beside[first..].iter().take_while(|e| left(e) <= to).copied() {
            if segments_cross(p, q, c, d) {
                return Some(0.0);
            }
            let ends = [(p, c, d), (q, c, d), (c, p, q), (d, p, q)];
            nearest = ends.into_iter().map(|(r, s, t)| distance_to_segment(r, s, t)).fold(nearest, f64::min);
        }
    }
    (nearest < limit).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::super::{Fixed, Reason, Unplaced};
    use super::*;

    fn square(name: &str) -> Item {
        let polygon = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|(x, y)| P2::new(x, y)).to_vec();
        Item::new(name, polygon, vec![0.0])
    }

    fn two(second: (f64, f64)) -> Layouts {
        let at = |item, (x, y)| Placement { item, copy: 0, mirrored: false, rotation_deg: 0.0, shift: V2::new(x, y) };
        let placements = vec![at(0, (5.0, 5.0)), at(1, second)];
        let layout = Layout { container: 0, width_mm: 50.0, height_mm: 40.0, placements, density: 0.1 };
        Layouts { layouts: vec![layout], unplaced: Vec::new(), stopped_early: false }
    }

    fn verdict(layouts: &Layouts, spacing_mm: f64) -> Result<(), Error> {
        let stock = [Container::sheet("S", 50.0, 40.0, Some(1))];
        let settings = Settings { spacing_mm, margin_mm: 5.0, effort: 0, seed: 0 };
        validate(&[square("A"), square("B")], &stock, layouts, &settings)
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
        assert!(matches!(spoilt(&|l| l.layouts[0].placements[1].copy = 1), Err(Error::Dangling { what: "copy", .. })));
        assert!(matches!(spoilt(&|l| l.layouts[0].placements[1].mirrored = true), Err(Error::Mirrored { .. })));
        let reason = Reason::NoRoom;
        let missing = Unplaced { item: 1, copy: 0, name: "B".into(), reason };
        assert!(matches!(spoilt(&|l| l.unplaced.push(missing.clone())), Err(Error::Times { times: 2, .. })));
        let named = |l: &mut Layouts| {
            l.layouts[0].placements.truncate(1);
            l.unplaced.push(missing.clone());
        };
        assert_eq!(spoilt(&named), Ok(()), "named as unplaced");
        let empty = Layout { placements: vec![], ..good.layouts[0].clone() };
        assert!(matches!(spoilt(&|l| l.layouts.push(empty.clone())), Err(Error::Stock { used: 2, .. })));
    }

    fn verdict_on(stock: Container, item: Item, at: (f64, f64)) -> Result<(), Error> {
        let settings = Settings { spacing_mm: 2.0, margin_mm: 5.0, effort: 0, seed: 0 };
        let shift = V2::new(at.0, at.1);
        let placements = vec![Placement { item: 0, copy: 0, mirrored: false, rotation_deg: 0.0, shift }];
        let layout = Layout { container: 0, width_mm: 50.0, height_mm: 40.0, placements, density: 0.05 };
        let layouts = Layouts { layouts: vec![layout], unplaced: Vec::new(), stopped_early: false };
        validate(&[item], &[stock], &layouts, &settings)
    }

    #[test]
    fn borders_that_are_no_rectangle_and_clamps_are_kept_clear() {
        let corners = |points: &[(f64, f64)]| points.iter().map(|&(x, y)| P2::new(x, y)).collect::<Vec<_>>();
        let (name, width_mm, height_mm) = ("S".to_owned(), 50.0, 40.0);
        let stock = |outline: &[(f64, f64)], blocked: &[(f64, f64)]| Container::Sheet {
            name: name.clone(),
            width_mm,
            height_mm,
            count: None,
            cost: 1.0,
            outline: corners(outline),
            blocked: if blocked.is_empty() { Vec::new() } else { vec![corners(blocked)] },
        };
        // A corner is cut off from (30, 40) to (50, 20).
        let cut = [(0.0, 0.0), (50.0, 0.0), (50.0, 20.0), (30.0, 40.0), (0.0, 40.0)];
        let on_cut = |x, y| verdict_on(stock(&cut, &[]), square("A"), (x, y));
        assert_eq!(on_cut(15.0, 25.0), Ok(()));
        assert!(matches!(on_cut(23.0, 25.0), Err(Error::Blocked { what: "the border", .. })), "too near");
        assert!(matches!(on_cut(35.0, 25.0), Err(Error::Blocked { distance_mm: 0.0, .. })), "outside");
        let clamp = [(40.0, 0.0), (50.0, 0.0), (50.0, 10.0), (40.0, 10.0)];
        let by_clamp = |x, y| verdict_on(stock(&[], &clamp), square("A"), (x, y));
        assert_eq!(by_clamp(28.0, 5.0), Ok(()));
        assert!(matches!(by_clamp(28.1, 5.0), Err(Error::Blocked { what: "what is blocked", .. })));
        assert!(matches!(by_clamp(35.0, 5.0), Err(Error::Blocked { distance_mm: 0.0, .. })));
    }

    #[test]
    fn what_is_fixed_must_lie_there() {
        let shift = V2::new(10.0, 10.0);
        let fixed = Item { fixed: Some(Fixed { container: 0, rotation_deg: 0.0, shift }), ..square("A") };
        let stock = || Container::sheet("S", 50.0, 40.0, None);
        assert_eq!(verdict_on(stock(), fixed.clone(), (10.0, 10.0)), Ok(()));
        assert!(matches!(verdict_on(stock(), fixed, (10.5, 10.0)), Err(Error::Moved { .. })));
    }
}
