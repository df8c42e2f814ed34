//! In which order, from which end: length of feed by length of feed; in each, all engraving, then all inner cuts, then the outlines.

use super::cuts::Cut;
use super::lead::Scrap;
use super::runs::{self, Visit};
use super::tour::{Rules, tour};
use super::{Contour, Settings};
use crate::drawing::Operation;
use crate::geom::P2;

/// All runs, for cuts sorted by length of feed and operation, by a tool that stands at `from`.
///
/// Where nothing holds the sheet, outlines are made from the far side toward the park point, so that what is freed never lies between the head and
/// uncut sheet.
pub(super) fn arranged(cuts: &[Cut], from: P2, settings: &Settings, scrap: &Scrap) -> Vec<Contour> {
    let mut contours: Vec<Contour> = Vec::new();
    let mut at = from;
    let groups: Vec<&[Cut]> = cuts.chunk_by(|a, b| (a.window, a.operation) == (b.window, b.operation)).collect();
    for (number, group) in groups.iter().enumerate() {
        let places: Vec<Vec<Visit>> = group.iter().map(|cut| runs::visits(cut, settings)).collect();
        let burns = group[0].operation != Operation::Engrave;
        let rules = Rules {
            from: at,
            to: (number + 1 == groups.len()).then_some(settings.park),
            cool_mm: if burns { settings.cool_mm } else { 0.0 },
        };
        let held = settings.held || settings.bridges.is_some();
        let stops = if group[0].operation == Operation::CutOutline && !held {
            from_the_far_side(group, &places, &rules, settings.park)
        } else {
            tour(&places, &rules)
        };
        for (place, visit) in stops {
            let (cut, visit) = (&group[place], &places[place][visit]);
            at = visit.exit;
            contours.extend(runs_of(cut, visit, settings, scrap));
        }
    }
    contours
}

/// All runs in the order of the drawings inside each operation, every path as drawn.
pub(super) fn as_drawn(cuts: &[Cut], settings: &Settings, scrap: &Scrap) -> Vec<Contour> {
    let first = |cut: &Cut| runs::visits(cut, settings).into_iter().next();
    cuts.iter().filter_map(|cut| Some(runs_of(cut, &first(cut)?, settings, scrap))).flatten().collect()
}

fn runs_of(cut: &Cut, visit: &Visit, settings: &Settings, scrap: &Scrap) -> Vec<Contour> {
    let process = settings.process_on(&cut.piece, cut.operation).expect("cuts without a process were refused");
    runs::runs(cut, visit.way, &process, settings, scrap)
}

fn from_the_far_side(group: &[Cut], places: &[Vec<Visit>], rules: &Rules, park: P2) -> Vec<(usize, usize)> {
    let distance = |k: usize| (group[k].path.bounds().center() - park).norm();
    let mut order: Vec<usize> = (0..group.len()).collect();
    order.sort_by(|a, b| distance(*b).total_cmp(&distance(*a)));
    let mut at = rules.from;
    let mut stops = Vec::with_capacity(order.len());
    for place in order {
        let near = |k: &usize| (places[place][*k].entry - at).norm();
        if let Some(visit) = (0..places[place].len()).min_by(|a, b| near(a).total_cmp(&near(b))) {
            at = places[place][visit].exit;
            stops.push((place, visit));
        }
    }
    stops
}
