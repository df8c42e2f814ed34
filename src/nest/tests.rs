//! The room as its callers see it.

use super::*;
use crate::geom::{Rect, signed_area};
use crate::progress::{Observer, Progress, Quiet};
use proptest::prelude::*;
use std::ops::ControlFlow;

const SETTINGS: Settings = Settings { spacing_mm: 2.0, margin_mm: 6.0, effort: 500, seed: 1 };

fn polygon(points: &[(f64, f64)]) -> Vec<P2> {
    points.iter().map(|&(x, y)| P2::new(x, y)).collect()
}

fn bar(name: &str, w: f64, h: f64, angles_deg: &[f64]) -> Item {
    Item::new(name, polygon(&[(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)]), angles_deg.to_vec())
}

fn sheet(name: &str, width_mm: f64, height_mm: f64, count: Option<u32>) -> Container {
    Container::sheet(name, width_mm, height_mm, count)
}

fn roll(width_mm: f64, max_length_mm: f64) -> Container {
    Container::Roll { name: "R".into(), width_mm, max_length_mm }
}

fn place(items: &[Item], containers: &[Container]) -> Result<Layouts, Error> {
    nest(items, containers, &SETTINGS, &mut Quiet)
}

/// A wavy band, like a flattened strip, from (`x`, `y`).
fn wave(length: f64, width: f64, height: f64, turns: f64, (x, y): (f64, f64)) -> Vec<P2> {
    let rim = |k: i32, up: f64| {
        let s = f64::from(k) / 40.0;
        P2::new(x + s * length, y + up * width + height * (s * turns * std::f64::consts::TAU).sin())
    };
    (0..=40).map(|k| rim(k, 0.0)).chain((0..=40).rev().map(|k| rim(k, 1.0))).collect()
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
fn waves_lie_in_each_other_where_boxes_would_not() {
    // Boxes of 80 mm; a wave 40 mm wide follows the next at little more than its width.
    let items: Vec<Item> = (0..4)
        .map(|i| Item::new(format!("A{i}"), wave(300.0, 40.0, 20.0, 2.0, (0.0, 0.0)), vec![0.0, 180.0]))
        .collect();
    // Where waves are steepest, 2 mm of spacing are 2.6 mm of height.
    let stock = [sheet("S", 320.0, 12.0 + 80.0 + 3.0 * 43.0, None)];
    assert_eq!(place(&items, &stock).unwrap().layouts.len(), 1);
}

#[test]
fn a_turn_is_made_only_when_it_is_allowed() {
    let tall = [sheet("S", 60.0, 400.0, None)];
    let left_out = place(&[bar("A1", 300.0, 20.0, &[0.0, 180.0])], &tall).unwrap();
    let expected = Reason::TooLarge { container: "S".into(), by_mm: 252.0 };
    assert_eq!(left_out.unplaced, [Unplaced { item: 0, copy: 0, name: "A1".into(), reason: expected }]);
    let layouts = place(&[bar("A1", 300.0, 20.0, &[0.0, 90.0])], &tall).unwrap();
    assert_eq!(layouts.layouts[0].placements[0].rotation_deg, 90.0);
}

#[test]
fn a_shape_is_turned_over_only_when_it_may_be() {
    // An L and its mirror image fill a rectangle; an L and the same L turned do not.
    let l = polygon(&[(0.0, 0.0), (100.0, 0.0), (100.0, 20.0), (20.0, 20.0), (20.0, 40.0), (0.0, 40.0)]);
    let tight = Settings { spacing_mm: 0.0, margin_mm: 0.0, ..SETTINGS };
    let item = |mirror| Item { copies: 2, mirror, ..Item::new("L", l.clone(), vec![0.0]) };
    let stock = [sheet("S", 120.0, 45.0, None)];
    let placed = |mirror| nest(&[item(mirror)], &stock, &tight, &mut Quiet).unwrap();
    assert_eq!(placed(false).layouts.len(), 2);
    assert!(placed(false).layouts.iter().flat_map(|l| &l.placements).all(|p| !p.mirrored));
    let stock_over = [sheet("S", 100.0, 60.0, None)];
    let over = nest(&[item(true)], &stock_over, &tight, &mut Quiet).unwrap();
    let plain = nest(&[item(false)], &stock_over, &tight, &mut Quiet).unwrap();
    assert!(over.layouts.len() <= plain.layouts.len());
}

#[test]
fn stock_is_taken_in_order_of_preference_and_the_cheapest_first() {
    let stock = [sheet("A4", 297.0, 210.0, None), sheet("A3", 420.0, 297.0, None)];
    let layouts = place(&[bar("short", 200.0, 30.0, &[0.0])], &stock).unwrap();
    assert_eq!(layouts.layouts[0].container, 0);
    let layouts = place(&[bar("long", 400.0, 30.0, &[0.0]), bar("short", 200.0, 30.0, &[0.0])], &stock).unwrap();
    assert_eq!(layouts.layouts.len(), 1, "the short one lies beside the long one");
    assert_eq!(layouts.layouts[0].container, 1);
    let mut offcut = sheet("offcut", 220.0, 50.0, Some(1));
    if let Container::Sheet { cost, .. } = &mut offcut {
        *cost = 0.1;
    }
    let stock = [sheet("A4", 297.0, 210.0, None), offcut];
    let layouts = place(&[bar("short", 200.0, 30.0, &[0.0])], &stock).unwrap();
    assert_eq!(layouts.layouts[0].container, 1, "the offcut is good enough");
}

#[test]
fn every_item_without_a_place_is_named_with_its_reason_and_the_important_ones_have_one() {
    let important = Item { priority: 1, ..bar("A3", 250.0, 90.0, &[0.0]) };
    let items = [bar("huge", 500.0, 30.0, &[0.0]), Item { copies: 2, ..bar("A1", 250.0, 90.0, &[0.0]) }, important];
    let unplaced = place(&items, &[sheet("A4", 297.0, 210.0, Some(1))]).unwrap().unplaced;
    assert_eq!(unplaced.len(), 2);
    assert_eq!(unplaced[0].reason, Reason::TooLarge { container: "A4".into(), by_mm: 215.0 });
    assert_eq!((unplaced[1].name.as_str(), unplaced[1].copy, &unplaced[1].reason), ("A1", 1, &Reason::StockUsedUp));
}

#[test]
fn a_roll_is_used_only_as_far_as_needed_and_starts_again_when_full() {
    let items: Vec<Item> = (0..3).map(|i| bar(&format!("A{i}"), 300.0, 49.0, &[0.0])).collect();
    let layouts = place(&items[..2], &[roll(112.0, 500.0)]).unwrap();
    assert_eq!(layouts.layouts.len(), 1);
    assert!((layouts.layouts[0].width_mm - 312.0).abs() < 1e-9);
    assert_eq!(layouts.layouts[0].height_mm, 112.0);
    assert_eq!(place(&items, &[roll(112.0, 500.0)]).unwrap().layouts.len(), 2);
}

#[test]
fn clamps_holes_and_borders_are_kept_clear_of() {
    let clamped = |blocked: &[(f64, f64)], outline: &[(f64, f64)]| {
        let (name, width_mm, height_mm) = ("S".to_owned(), 212.0, 62.0);
        let (blocked, outline) = (if blocked.is_empty() { vec![] } else { vec![polygon(blocked)] }, polygon(outline));
        [Container::Sheet { name, width_mm, height_mm, count: Some(1), cost: 1.0, outline, blocked }]
    };
    let items = [bar("A", 200.0, 20.0, &[0.0])];
    let y = |stock: &[Container]| place(&items, stock).unwrap().layouts.first().map(|l| l.placements[0].shift.y);
    assert_eq!(y(&clamped(&[], &[])), Some(6.0));
    // The clamp ends at 20, two below the bar.
    assert!((y(&clamped(&[(90.0, 0.0), (120.0, 0.0), (120.0, 20.0), (90.0, 20.0)], &[])).unwrap() - 22.0).abs() < 1e-6);
    // A border that rises to 15 at the right: the margin of 6 is kept there as well.
    let slope = [(0.0, 0.0), (106.0, 0.0), (212.0, 15.0), (212.0, 62.0), (0.0, 62.0)];
    assert!(y(&clamped(&[], &slope)).unwrap() > 20.0);
    let band = [(0.0, 25.0), (212.0, 25.0), (212.0, 40.0), (0.0, 40.0)];
    let refused = place(&items, &clamped(&band, &[])).unwrap();
    assert_eq!(refused.unplaced[0].reason, Reason::NoRoom);
}

#[test]
fn what_is_fixed_stays_and_others_keep_their_distance() {
    let fixed = Fixed { container: 0, rotation_deg: 180.0, shift: V2::new(250.0, 56.0) };
    let items = [Item { fixed: Some(fixed), ..bar("held", 200.0, 50.0, &[0.0]) }, bar("free", 200.0, 50.0, &[0.0])];
    let layouts = place(&items, &[sheet("S", 300.0, 120.0, None)]).unwrap();
    assert_eq!(layouts.layouts.len(), 1);
    let held = layouts.layouts[0].placements.iter().find(|p| p.item == 0).unwrap();
    assert_eq!((held.shift, held.rotation_deg), (fixed.shift, 180.0));
    let outside = Fixed { shift: V2::new(150.0, 56.0), ..fixed };
    let items = [Item { fixed: Some(outside), ..items[0].clone() }];
    assert!(matches!(place(&items, &[sheet("S", 300.0, 120.0, None)]), Err(Error::Margin { .. })));
}

#[test]
fn a_set_lies_on_one_sheet_when_that_costs_nothing() {
    let member = |name: &str, w: f64, set| Item { set: Some(set), ..bar(name, w, 88.0, &[0.0]) };
    let items = [member("A1", 280.0, 1), member("B1", 279.0, 2), member("A2", 180.0, 1), member("B2", 180.0, 2)];
    let layouts = place(&items, &[sheet("S", 480.0, 100.0, None)]).unwrap();
    assert_eq!(layouts.layouts.len(), 2);
    for layout in &layouts.layouts {
        let sets: Vec<_> = layout.placements.iter().map(|p| items[p.item].set).collect();
        assert_eq!(sets[0], sets[1], "{sets:?}");
    }
}

#[test]
fn nothing_to_place_needs_no_sheet_and_nonsense_is_refused() {
    assert_eq!(place(&[], &[sheet("S", 10.0, 10.0, None)]).unwrap(), Layouts::default());
    assert_eq!(place(&[], &[]).unwrap_err(), Error::NoContainer);
    assert!(matches!(place(&[], &[sheet("S", 0.0, 10.0, None)]), Err(Error::ContainerSize { .. })));
    let bad = Settings { spacing_mm: -1.0, ..SETTINGS };
    assert!(matches!(nest(&[], &[sheet("S", 9.0, 9.0, None)], &bad, &mut Quiet), Err(Error::Distance { .. })));
    let (name, blocked) = ("S".to_owned(), vec![polygon(&[(0.0, 0.0), (1.0, 1.0)])]);
    let outline = Vec::new();
    let holed = Container::Sheet { name, width_mm: 9.0, height_mm: 9.0, count: None, cost: 1.0, outline, blocked };
    assert!(matches!(place(&[], &[holed]), Err(Error::ContainerShape { .. })));
}

#[test]
fn a_stopped_search_still_returns_a_complete_layout() {
    struct Stop;
    impl Observer for Stop {
        fn step(&mut self, _: Progress) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }
    let items = [Item { copies: 5, ..Item::new("A", wave(100.0, 15.0, 8.0, 1.5, (0.0, 0.0)), vec![0.0, 180.0]) }];
    let layouts = nest(&items, &[roll(70.0, 1000.0)], &SETTINGS, &mut Stop).unwrap();
    assert!(layouts.stopped_early);
    assert_eq!(layouts.layouts[0].placements.len(), 5);
}

#[test]
fn more_effort_makes_a_roll_shorter() {
    let items: Vec<Item> = (0..14)
        .map(|i| {
            let k = f64::from(i);
            let shape = wave(150.0 + 37.0 * (k % 5.0), 18.0, 4.0 + k, 1.0 + 0.3 * k, (0.0, 0.0));
            Item::new(format!("A{i}"), shape, vec![0.0, 180.0])
        })
        .collect();
    let length = |effort| {
        let settings = Settings { effort, ..SETTINGS };
        nest(&items, &[roll(200.0, 5000.0)], &settings, &mut Quiet).unwrap().layouts[0].width_mm
    };
    assert!(length(4000) < 0.97 * length(0));
}

#[test]
fn hundreds_of_parts_find_their_places() {
    let items: Vec<Item> = (0..30)
        .map(|i| {
            let k = f64::from(i);
            let shape = wave(60.0 + 7.0 * (k % 11.0), 10.0, k % 4.0, 1.0, (0.0, 0.0));
            Item { copies: 10, ..Item::new(format!("A{i}"), shape, vec![0.0]) }
        })
        .collect();
    let settings = Settings { effort: 0, ..SETTINGS };
    let layouts = nest(&items, &[sheet("S", 600.0, 400.0, None)], &settings, &mut Quiet).unwrap();
    assert_eq!(layouts.layouts.iter().map(|l| l.placements.len()).sum::<usize>(), 300);
}

#[test]
fn a_search_that_is_stopped_among_very_many_pieces_still_places_them_all() {
    struct Stop;
    impl Observer for Stop {
        fn step(&mut self, _: Progress) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }
    let shape = |k: u32| wave(60.0 + f64::from(k), 10.0, f64::from(k % 4), 1.0, (0.0, 0.0));
    let items: Vec<Item> =
        (0..15).map(|k| Item { copies: 40, ..Item::new(format!("A{k}"), shape(k), vec![0.0, 180.0]) }).collect();
    for stock in [sheet("S", 600.0, 400.0, None), roll(400.0, 30_000.0)] {
        let layouts = nest(&items, &[stock], &SETTINGS, &mut Stop).unwrap();
        assert!(layouts.stopped_early && layouts.unplaced.is_empty());
        assert_eq!(layouts.layouts.iter().map(|l| l.placements.len()).sum::<usize>(), 600);
    }
    let many = [Item { copies: u32::MAX, ..items[0].clone() }];
    assert!(matches!(place(&many, &[roll(400.0, 900.0)]), Err(Error::TooMany { .. })));
}

prop_compose! {
    /// A wavy band somewhere in the plane.
    fn ribbon()(
        length in 20.0..280.0f64, width in 8.0..40.0f64, height in 0.0..15.0f64, turns in 0.5..4.0f64,
        x in -100.0..100.0f64, y in -100.0..100.0f64, grain in prop::bool::ANY, copies in 1..3u32, mirror in prop::bool::ANY,
    ) -> Item {
        let angles_deg = if grain { vec![0.0, 180.0] } else { vec![0.0, 90.0] };
        let shape = wave(length, width, height, turns, (x, y));
        Item { copies, mirror, ..Item::new(format!("{length:.0}x{width:.0}"), shape, angles_deg) }
    }
}

prop_compose! {
    /// A star: as far from a band as shapes get.
    fn star()(radii in prop::collection::vec(5.0..60.0f64, 5..14), x in -50.0..50.0f64, angle in 0.0..360.0f64) -> Item {
        let n = radii.len() as f64;
        let corner = |(k, r): (usize, &f64)| {
            let a = k as f64 / n * std::f64::consts::TAU;
            P2::new(x + r * a.cos(), r * a.sin())
        };
        Item::new("star", radii.iter().enumerate().map(corner).collect(), vec![0.0, angle])
    }
}

prop_compose! {
    /// A sheet with a corner cut off and a clamp or hole somewhere.
    fn offcut_stock()(
        cut in 10.0..150.0f64, x in 0.0..350.0f64, y in 0.0..250.0f64, w in 5.0..60.0f64, h in 5.0..60.0f64,
    ) -> Container {
        let outline = polygon(&[(0.0, 0.0), (400.0, 0.0), (400.0, 300.0 - cut), (400.0 - cut, 300.0), (0.0, 300.0)]);
        let blocked = vec![polygon(&[(x, y), (x + w, y), (x + 0.5 * w, y + h)])];
        let (name, count) = ("offcut".into(), Some(2));
        Container::Sheet { name, width_mm: 400.0, height_mm: 300.0, count, cost: 0.5, outline, blocked }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn whatever_is_nested_on_offcuts_sheets_and_a_roll_passes_the_validator_and_comes_out_the_same_twice(
        ribbons in prop::collection::vec(ribbon(), 1..12),
        stars in prop::collection::vec(star(), 0..4),
        offcut_stock in offcut_stock(),
        spacing_mm in prop_oneof![Just(0.0), 0.0..4.0f64],
        margin_mm in 0.0..10.0f64,
        seed in 0..1000u64,
    ) {
        let items: Vec<Item> = ribbons.into_iter().chain(stars).collect();
        let stock = [offcut_stock, sheet("small", 250.0, 200.0, Some(2)), roll(320.0, 1000.0)];
        let settings = Settings { spacing_mm, margin_mm, effort: 300, seed };
        let layouts = nest(&items, &stock, &settings, &mut Quiet).unwrap();
        prop_assert_eq!(validate(&items, &stock, &layouts, &settings), Ok(()));
        prop_assert!(layouts.unplaced.is_empty(), "{:?}", layouts.unplaced);
        prop_assert_eq!(&layouts, &nest(&items, &stock, &settings, &mut Quiet).unwrap());
        let filled: f64 = layouts.layouts.iter().map(|l| l.density * l.width_mm * l.height_mm).sum();
        let area: f64 = items.iter().map(|i| signed_area(&i.polygon).abs() * f64::from(i.copies)).sum();
        prop_assert!((filled - area).abs() < 1e-6 * area);
        for layout in &layouts.layouts {
            if let Some(rest) = offcut(&items, &stock, layout, &settings) {
                let whole = Rect::from_size(layout.width_mm, layout.height_mm);
                prop_assert!(whole.holds(&rest, 1e-9));
                for placement in &layout.placements {
                    let placed = placement.placed(&items[placement.item].polygon);
                    let nearest = rest.grown(spacing_mm - 1e-6);
                    prop_assert!(placed.iter().all(|p| !nearest.holds(&Rect::around([p]), 0.0)));
                }
            }
        }
    }
}
