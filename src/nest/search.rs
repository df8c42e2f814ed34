//! Several orders and rules, the best of them kept.

use super::item::Prepared;
use super::maxrects::{Bin, Rule, Spot};
use super::{Container, Error, Item, Layout, Layouts, Placement, Reason, Settings, Unplaced, validate};
use crate::geom::{Rect, V2};
use crate::progress::{Observer, Progress};

/// Places every item on the fewest layouts this method finds.
///
/// Stock is opened in the order given: an item goes to the first container that is open and has room, else to the first kind that can hold
/// it and is not used up. Of all trials the one with the fewest layouts wins, then the one on more preferred stock, then the one with the
/// shortest used length. The observer is called between trials; when it stops the search, the best so far is returned.
///
/// # Errors
/// Distances, containers or items that make no sense; [`Error::Unplaced`] with every item that found no place and the reason. Whatever
/// [`validate`] finds wrong with a layout is an error too: such a layout never leaves this function.
pub fn nest(
    items: &[Item],
    containers: &[Container],
    settings: &Settings,
    observer: &mut dyn Observer,
) -> Result<Layouts, Error> {
    check_settings(containers, settings)?;
    let prepared = items.iter().map(Prepared::new).collect::<Result<Vec<_>, _>>()?;
    let job = Job { items: &prepared, containers, settings };

    let trials: Vec<(Order, Rule)> = Order::ALL.iter().flat_map(|o| Rule::ALL.map(|r| (*o, r))).collect();
    let mut best: Option<Packing> = None;
    let mut stopped_early = false;
    for (k, (order, rule)) in trials.iter().enumerate() {
        let packing = job.pack(&order.of(&prepared), *rule);
        if best.as_ref().is_none_or(|b| packing.better_than(b)) {
            best = Some(packing);
        }
        let note = best.as_ref().map(|b| format!("{} sheets", b.open.len())).unwrap_or_default();
        let progress = Progress { stage: "nesting", done: k as u64 + 1, total: trials.len() as u64, note };
        if observer.step(progress).is_break() {
            stopped_early = k + 1 < trials.len();
            break;
        }
    }

    let best = best.expect("there is at least one order and one rule");
    if !best.unplaced.is_empty() {
        let unplaced = best.unplaced.iter().map(|&i| Unplaced { item: items[i].name.clone(), reason: job.reason(i) });
        return Err(Error::Unplaced(unplaced.collect()));
    }
    let layouts = Layouts { layouts: best.open.into_iter().map(|open| job.layout(open)).collect(), stopped_early };
    validate(items, containers, &layouts, settings)?;
    Ok(layouts)
}

fn check_settings(containers: &[Container], settings: &Settings) -> Result<(), Error> {
    for (name, value_mm) in [("spacing", settings.spacing_mm), ("margin", settings.margin_mm)] {
        if !(value_mm.is_finite() && value_mm >= 0.0) {
            return Err(Error::Distance { name, value_mm });
        }
    }
    if containers.is_empty() {
        return Err(Error::NoContainer);
    }
    for container in containers {
        let size = container.size_mm();
        if !size.iter().all(|v| v.is_finite() && *v > 0.0) {
            let container = container.name().to_string();
            return Err(Error::ContainerSize { container, width_mm: size.x, height_mm: size.y });
        }
    }
    Ok(())
}

/// Which item comes first; the largest by some measure, because what is large finds a place last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    LongSide,
    Area,
    ShortSide,
    Perimeter,
}

impl Order {
    const ALL: [Order; 4] = [Order::LongSide, Order::Area, Order::ShortSide, Order::Perimeter];

    fn of(self, items: &[Prepared]) -> Vec<usize> {
        let key = |i: usize| {
            let (long, short) = items[i].sides();
            match self {
                Order::LongSide => [long, short],
                Order::Area => [items[i].area, long],
                Order::ShortSide => [short, long],
                Order::Perimeter => [long + short, long],
            }
        };
        let mut order: Vec<usize> = (0..items.len()).collect();
        order.sort_by(|&a, &b| {
            let (a, b) = (key(a), key(b));
            b[0].total_cmp(&a[0]).then(b[1].total_cmp(&a[1]))
        });
        order
    }
}

/// A container in use.
struct Open {
    container: usize,
    bin: Bin,
    placements: Vec<Placement>,
    /// Greatest x of an item on the layout, mm.
    used_length_mm: f64,
    /// Sum of the items' areas, mm2.
    filled_mm2: f64,
}

/// One trial's result.
struct Packing {
    open: Vec<Open>,
    unplaced: Vec<usize>,
}

impl Packing {
    fn better_than(&self, other: &Packing) -> bool {
        let counts = |p: &Packing| (p.unplaced.len(), p.open.len(), p.open.iter().map(|o| o.container).sum::<usize>());
        let length = |p: &Packing| p.open.iter().map(|o| o.used_length_mm).sum::<f64>();
        counts(self).cmp(&counts(other)).then(length(self).total_cmp(&length(other))).is_lt()
    }
}

struct Job<'a> {
    items: &'a [Prepared],
    containers: &'a [Container],
    settings: &'a Settings,
}

impl Job<'_> {
    /// What is left of a container inside its margins, mm; negative when the margins meet.
    fn usable(&self, container: usize) -> V2 {
        self.containers[container].size_mm() - V2::repeat(2.0 * self.settings.margin_mm)
    }

    /// Each box carries half the spacing on every side, so the space inside the margins grows by as much.
    fn inflated(&self, size: V2) -> V2 {
        size + V2::repeat(self.settings.spacing_mm)
    }

    fn pack(&self, order: &[usize], rule: Rule) -> Packing {
        let mut packing = Packing { open: Vec::new(), unplaced: Vec::new() };
        for &item in order {
            let placed = packing.open.iter_mut().any(|open| self.place(item, open, rule));
            if !placed && !self.open_for(item, rule, &mut packing.open) {
                packing.unplaced.push(item);
            }
        }
        packing.unplaced.sort_unstable();
        packing
    }

    /// Opens the first kind of container that can hold the item and is not used up; false when there is none.
    fn open_for(&self, item: usize, rule: Rule, open: &mut Vec<Open>) -> bool {
        for (container, kind) in self.containers.iter().enumerate() {
            let used = open.iter().filter(|o| o.container == container).count();
            if kind.count().is_some_and(|count| used >= count as usize) {
                continue;
            }
            let bin = Bin::new(self.inflated(self.usable(container)));
            let mut fresh = Open { container, bin, placements: Vec::new(), used_length_mm: 0.0, filled_mm2: 0.0 };
            if self.place(item, &mut fresh, rule) {
                open.push(fresh);
                return true;
            }
        }
        false
    }

    fn place(&self, item: usize, open: &mut Open, rule: Rule) -> bool {
        let mut best: Option<(Spot, usize)> = None;
        for (t, turn) in self.items[item].turns.iter().enumerate() {
            if let Some(spot) = open.bin.best(self.inflated(turn.size()), rule)
                && best.is_none_or(|(b, _)| spot.better_than(&b))
            {
                best = Some((spot, t));
            }
        }
        let Some((spot, t)) = best else { return false };
        let turn = &self.items[item].turns[t];
        open.bin.fill(Rect { min: spot.corner, max: spot.corner + self.inflated(turn.size()) });
        // In the bin the item's box sits half a spacing inside its own, and the bin half a spacing outside the margin: they cancel.
        let margin = self.settings.margin_mm;
        let shift = spot.corner.coords + V2::repeat(margin) - turn.bounds.min.coords;
        open.placements.push(Placement { item, rotation_deg: turn.angle_deg, shift });
        open.used_length_mm = open.used_length_mm.max(shift.x + turn.bounds.max.x);
        open.filled_mm2 += self.items[item].area;
        true
    }

    fn layout(&self, open: Open) -> Layout {
        let size = self.containers[open.container].size_mm();
        let width_mm = match self.containers[open.container] {
            Container::Sheet { .. } => size.x,
            // An exact fit may end a round-off beyond the longest layout.
            Container::Roll { .. } => (open.used_length_mm + self.settings.margin_mm).min(size.x),
        };
        let density = open.filled_mm2 / (width_mm * size.y);
        Layout { container: open.container, width_mm, height_mm: size.y, placements: open.placements, density }
    }

    /// Why an item that was not placed was not.
    fn reason(&self, item: usize) -> Reason {
        let mut nearest = (f64::INFINITY, 0);
        for container in 0..self.containers.len() {
            let usable = self.usable(container);
            for turn in &self.items[item].turns {
                let missing = (turn.size() - usable).max();
                if missing < nearest.0 {
                    nearest = (missing, container);
                }
            }
        }
        let (by_mm, container) = nearest;
        match by_mm > 1e-9 {
            true => Reason::TooLarge { container: self.containers[container].name().to_string(), by_mm },
            false => Reason::StockUsedUp,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::P2;
    use crate::progress::Quiet;
    use proptest::prelude::*;
    use std::ops::ControlFlow;

    const SETTINGS: Settings = Settings { spacing_mm: 2.0, margin_mm: 6.0 };

    fn bar(name: &str, w: f64, h: f64, angles_deg: &[f64]) -> Item {
        let polygon = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)].map(|(x, y)| P2::new(x, y)).to_vec();
        Item { name: name.into(), polygon, angles_deg: angles_deg.to_vec() }
    }

    fn sheet(name: &str, width_mm: f64, height_mm: f64, count: Option<u32>) -> Container {
        Container::Sheet { name: name.into(), width_mm, height_mm, count }
    }

    fn place(items: &[Item], containers: &[Container]) -> Result<Layouts, Error> {
        nest(items, containers, &SETTINGS, &mut Quiet)
    }

    #[test]
    fn strips_fill_a_sheet_to_the_last_millimetre() {
        // 5 strips of 50 and 4 spacings of 2 between margins of 6: 270 exactly.
        let items: Vec<Item> = (0..5).map(|i| bar(&format!("A{i}"), 388.0, 50.0, &[0.0])).collect();
        let layouts = place(&items, &[sheet("S", 400.0, 270.0, None)]).unwrap();
        assert_eq!(layouts.layouts.len(), 1);
        assert!((layouts.layouts[0].density - 5.0 * 388.0 * 50.0 / (400.0 * 270.0)).abs() < 1e-12);
        assert_eq!(place(&items, &[sheet("S", 400.0, 269.9, None)]).unwrap().layouts.len(), 2);
    }

    #[test]
    fn a_turn_is_made_only_when_it_is_allowed() {
        let tall = [sheet("S", 60.0, 400.0, None)];
        let error = place(&[bar("A1", 300.0, 20.0, &[0.0, 180.0])], &tall).unwrap_err();
        let expected = Reason::TooLarge { container: "S".into(), by_mm: 252.0 };
        assert_eq!(error, Error::Unplaced(vec![Unplaced { item: "A1".into(), reason: expected }]));
        let layouts = place(&[bar("A1", 300.0, 20.0, &[0.0, 90.0])], &tall).unwrap();
        assert_eq!(layouts.layouts[0].placements[0].rotation_deg, 90.0);
    }

    #[test]
    fn an_item_too_long_for_the_first_stock_goes_to_the_second() {
        let stock = [sheet("A4", 297.0, 210.0, None), sheet("A3", 420.0, 297.0, None)];
        let layouts = place(&[bar("short", 200.0, 30.0, &[0.0])], &stock).unwrap();
        assert_eq!(layouts.layouts[0].container, 0);
        let layouts = place(&[bar("long", 400.0, 30.0, &[0.0]), bar("short", 200.0, 30.0, &[0.0])], &stock).unwrap();
        assert_eq!(layouts.layouts.len(), 1, "the short one lies beside the long one");
        assert_eq!(layouts.layouts[0].container, 1);
    }

    #[test]
    fn every_item_without_a_place_is_named_with_its_reason() {
        let items = [
            bar("huge", 500.0, 30.0, &[0.0]),
            bar("A1", 250.0, 90.0, &[0.0]),
            bar("A2", 250.0, 90.0, &[0.0]),
            bar("A3", 250.0, 90.0, &[0.0]),
        ];
        let Error::Unplaced(unplaced) = place(&items, &[sheet("A4", 297.0, 210.0, Some(1))]).unwrap_err() else {
            panic!("wrong error");
        };
        assert_eq!(unplaced.len(), 2);
        assert_eq!(unplaced[0].reason, Reason::TooLarge { container: "A4".into(), by_mm: 215.0 });
        assert_eq!((unplaced[1].item.as_str(), &unplaced[1].reason), ("A3", &Reason::StockUsedUp));
    }

    #[test]
    fn a_roll_is_used_only_as_far_as_needed_and_starts_again_when_full() {
        let roll = [Container::Roll { name: "R".into(), width_mm: 112.0, max_length_mm: 500.0 }];
        let items: Vec<Item> = (0..3).map(|i| bar(&format!("A{i}"), 300.0, 49.0, &[0.0])).collect();
        let layouts = place(&items[..2], &roll).unwrap();
        assert_eq!(layouts.layouts.len(), 1);
        assert!((layouts.layouts[0].width_mm - 312.0).abs() < 1e-9);
        assert_eq!(layouts.layouts[0].height_mm, 112.0);
        assert_eq!(place(&items, &roll).unwrap().layouts.len(), 2);
    }

    #[test]
    fn nothing_to_place_needs_no_sheet_and_nothing_to_place_on_is_an_error() {
        assert_eq!(place(&[], &[sheet("S", 10.0, 10.0, None)]).unwrap(), Layouts::default());
        assert_eq!(place(&[], &[]).unwrap_err(), Error::NoContainer);
        assert!(matches!(place(&[], &[sheet("S", 0.0, 10.0, None)]), Err(Error::ContainerSize { .. })));
        let bad = Settings { spacing_mm: -1.0, margin_mm: 0.0 };
        assert!(matches!(nest(&[], &[sheet("S", 9.0, 9.0, None)], &bad, &mut Quiet), Err(Error::Distance { .. })));
    }

    #[test]
    fn a_stopped_search_still_returns_a_complete_layout() {
        struct Stop;
        impl Observer for Stop {
            fn step(&mut self, _: Progress) -> ControlFlow<()> {
                ControlFlow::Break(())
            }
        }
        let items = [bar("A1", 100.0, 20.0, &[0.0]), bar("A2", 80.0, 20.0, &[0.0])];
        let layouts = nest(&items, &[sheet("S", 200.0, 100.0, None)], &SETTINGS, &mut Stop).unwrap();
        assert!(layouts.stopped_early);
        assert_eq!(layouts.layouts[0].placements.len(), 2);
    }

    prop_compose! {
        /// A wavy band, like a flattened strip, somewhere in the plane.
        fn ribbon()(
            length in 20.0..280.0f64, width in 8.0..40.0f64, wave in 0.0..15.0f64, turns in 0.5..4.0f64,
            x in -100.0..100.0f64, y in -100.0..100.0f64, grain in prop::bool::ANY,
        ) -> Item {
            let rim = |k: i32, up: f64| {
                let s = f64::from(k) / 20.0;
                P2::new(x + s * length, y + up * width + wave * (s * turns * std::f64::consts::TAU).sin())
            };
            let polygon = (0..=20).map(|k| rim(k, 0.0)).chain((0..=20).rev().map(|k| rim(k, 1.0))).collect();
            let angles_deg = if grain { vec![0.0, 180.0] } else { vec![0.0, 90.0] };
            Item { name: format!("{length:.0}x{width:.0}"), polygon, angles_deg }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn random_ribbons_are_all_placed_validly_and_the_same_way_twice(
            items in prop::collection::vec(ribbon(), 1..25),
            spacing_mm in 0.0..4.0f64,
            margin_mm in 0.0..10.0f64,
        ) {
            let stock = [
                sheet("small", 250.0, 200.0, Some(2)),
                sheet("large", 400.0, 300.0, None),
                Container::Roll { name: "R".into(), width_mm: 300.0, max_length_mm: 1000.0 },
            ];
            let settings = Settings { spacing_mm, margin_mm };
            let layouts = nest(&items, &stock, &settings, &mut Quiet).unwrap();
            prop_assert_eq!(validate(&items, &stock, &layouts, &settings), Ok(()));
            prop_assert_eq!(&layouts, &nest(&items, &stock, &settings, &mut Quiet).unwrap());
            let filled: f64 = layouts.layouts.iter().map(|l| l.density * l.width_mm * l.height_mm).sum();
            let area: f64 = items.iter().map(|i| crate::geom::signed_area(&i.polygon)).sum();
            prop_assert!((filled - area).abs() < 1e-6 * area);
            let roll = nest(&items, &stock[2..], &settings, &mut Quiet).unwrap();
            prop_assert!(roll.layouts.iter().all(|l| l.width_mm <= 1000.0));
        }
    }
}
