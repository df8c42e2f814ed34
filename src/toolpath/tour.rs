//! A short way through places that can each be entered in several ways.
//!
//! Nearest neighbour, then 2-opt (a stretch of the tour is gone backward) and Or-opt (one to three places are put elsewhere) until neither helps,
//! in turn with the best choice of entries for the order found, which dynamic programming gives exactly.

use super::runs::Visit;
use crate::geom::P2;

/// Rounds of improvement, at most; each is sweeps until nothing helps. Tours of real sheets settle in two to four.
const ROUNDS: usize = 8;

/// What counts as shorter, mm: less is round-off.
const GAIN_MM: f64 = 1e-6;

/// How costly a hop to what is still hot is, mm.
const HOT_MM: f64 = 1000.0;

/// Where a tour begins and ends and what its hops cost.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rules {
    pub from: P2,
    /// Where it ends; `None` for anywhere.
    pub to: Option<P2>,
    /// Hops shorter than this land where the sheet is still hot, mm.
    pub cool_mm: f64,
}

impl Rules {
    fn hop(&self, from: P2, to: P2) -> f64 {
        let d = (to - from).norm();
        if d < self.cool_mm { d + HOT_MM } else { d }
    }

    fn first(&self, visit: &Visit) -> f64 {
        (visit.entry - self.from).norm()
    }

    fn last(&self, visit: &Visit) -> f64 {
        self.to.map_or(0.0, |to| (to - visit.exit).norm())
    }
}

/// Order and entries: which place comes when (index into `places`), and which of its visits is taken. No place is without a visit.
pub(super) fn tour(places: &[Vec<Visit>], rules: &Rules) -> Vec<(usize, usize)> {
    let mut stops = nearest(places, rules);
    let mut cost = total(&stops, places, rules);
    for _ in 0..ROUNDS {
        while two_opt(&mut stops, places, rules) | or_opt(&mut stops, places, rules) {}
        enter_best(&mut stops, places, rules);
        let now = total(&stops, places, rules);
        if now > cost - GAIN_MM {
            break;
        }
        cost = now;
    }
    stops
}

type Stop = (usize, usize);

fn visit(stop: Stop, places: &[Vec<Visit>]) -> &Visit {
    &places[stop.0][stop.1]
}

/// The same place gone through the other way.
fn flipped(stop: Stop, places: &[Vec<Visit>]) -> Stop {
    (stop.0, visit(stop, places).back)
}

fn total(stops: &[Stop], places: &[Vec<Visit>], rules: &Rules) -> f64 {
    let (Some(first), Some(last)) = (stops.first(), stops.last()) else { return 0.0 };
    let hops = stops.windows(2).map(|w| rules.hop(visit(w[0], places).exit, visit(w[1], places).entry));
    rules.first(visit(*first, places)) + hops.sum::<f64>() + rules.last(visit(*last, places))
}

fn nearest(places: &[Vec<Visit>], rules: &Rules) -> Vec<Stop> {
    let mut left: Vec<usize> = (0..places.len()).collect();
    let mut stops = Vec::with_capacity(places.len());
    let (mut at, mut hot) = (rules.from, false);
    while !left.is_empty() {
        let cost = |to: P2| if hot { rules.hop(at, to) } else { (to - at).norm() };
        let all = left
            .iter()
            .enumerate()
            .flat_map(|(slot, place)| places[*place].iter().enumerate().map(move |(k, v)| (slot, (*place, k), v)));
        let Some((slot, stop, v)) = all.min_by(|a, b| cost(a.2.entry).total_cmp(&cost(b.2.entry))) else { break };
        at = v.exit;
        hot = true;
        stops.push(stop);
        left.remove(slot);
    }
    stops
}

/// Cost of the hop into stop `k` of an order (from the start for 0, to the end for its length).
fn into(stops: &[Stop], k: usize, places: &[Vec<Visit>], rules: &Rules) -> f64 {
    match (k.checked_sub(1).map(|b| visit(stops[b], places)), stops.get(k).map(|s| visit(*s, places))) {
        (None, Some(v)) => rules.first(v),
        (Some(b), Some(v)) => rules.hop(b.exit, v.entry),
        (Some(b), None) => rules.last(b),
        (None, None) => 0.0,
    }
}

fn link(before: Option<Stop>, after: Option<Stop>, places: &[Vec<Visit>], rules: &Rules) -> f64 {
    match (before.map(|s| visit(s, places)), after.map(|s| visit(s, places))) {
        (None, Some(v)) => rules.first(v),
        (Some(b), Some(v)) => rules.hop(b.exit, v.entry),
        (Some(b), None) => rules.last(b),
        (None, None) => 0.0,
    }
}

/// One sweep of reversals; true when one was made.
fn two_opt(stops: &mut [Stop], places: &[Vec<Visit>], rules: &Rules) -> bool {
    let n = stops.len();
    let mut improved = false;
    for i in 0..n {
        // Hops inside the stretch, forward and backward, summed as it grows.
        let (mut forward, mut backward) = (0.0, 0.0);
        let mut best = (GAIN_MM, i);
        let before = i.checked_sub(1).map(|b| stops[b]);
        for j in i..n {
            if j > i {
                forward += into(stops, j, places, rules);
                let (a, b) = (flipped(stops[j], places), flipped(stops[j - 1], places));
                backward += rules.hop(visit(a, places).exit, visit(b, places).entry);
            }
            let after = stops.get(j + 1).copied();
            let (first, last) = (flipped(stops[j], places), flipped(stops[i], places));
            let old =
                link(before, Some(stops[i]), places, rules) + forward + link(Some(stops[j]), after, places, rules);
            let new = link(before, Some(first), places, rules) + backward + link(Some(last), after, places, rules);
            if old - new > best.0 {
                best = (old - new, j);
            }
        }
        if best.0 > GAIN_MM {
            stops[i..=best.1].reverse();
            for stop in &mut stops[i..=best.1] {
                *stop = flipped(*stop, places);
            }
            improved = true;
        }
    }
    improved
}

/// One sweep of moves of one to three places to where they cost less; true when one was made.
fn or_opt(stops: &mut Vec<Stop>, places: &[Vec<Visit>], rules: &Rules) -> bool {
    let mut improved = false;
    for length in 1..=3 {
        let mut i = 0;
        while i + length <= stops.len() {
            let before = i.checked_sub(1).map(|b| stops[b]);
            let after = stops.get(i + length).copied();
            let (head, tail) = (stops[i], stops[i + length - 1]);
            let freed = link(before, Some(head), places, rules) + link(Some(tail), after, places, rules)
                - link(before, after, places, rules);
            let mut best = (GAIN_MM, 0);
            for k in (0..=stops.len()).filter(|k| *k < i || *k > i + length) {
                let (a, b) = (k.checked_sub(1).map(|b| stops[b]), stops.get(k).copied());
                let paid =
                    link(a, Some(head), places, rules) + link(Some(tail), b, places, rules) - link(a, b, places, rules);
                if freed - paid > best.0 {
                    best = (freed - paid, k);
                }
            }
            if best.0 > GAIN_MM {
                let moved: Vec<Stop> = stops.drain(i..i + length).collect();
                let at = if best.1 > i { best.1 - length } else { best.1 };
                stops.splice(at..at, moved);
                improved = true;
            }
            i += 1;
        }
    }
    improved
}

/// The best entries for the order as it is: the cheapest way to every visit of every stop, from the one before.
fn enter_best(stops: &mut [Stop], places: &[Vec<Visit>], rules: &Rules) {
    let mut cheapest: Vec<Vec<(f64, usize)>> = Vec::with_capacity(stops.len());
    for (k, stop) in stops.iter().enumerate() {
        let row = places[stop.0].iter().map(|v| match k.checked_sub(1) {
            None => (rules.first(v), 0),
            Some(b) => {
                let came =
                    |(from, visit): (usize, &Visit)| (cheapest[b][from].0 + rules.hop(visit.exit, v.entry), from);
                let ways = places[stops[b].0].iter().enumerate().map(came);
                ways.min_by(|x, y| x.0.total_cmp(&y.0)).unwrap_or((f64::INFINITY, 0))
            }
        });
        cheapest.push(row.collect());
    }
    let Some(last) = stops.len().checked_sub(1) else { return };
    let end = |k: usize| cheapest[last][k].0 + rules.last(&places[stops[last].0][k]);
    let mut choice = (0..cheapest[last].len()).min_by(|a, b| end(*a).total_cmp(&end(*b))).unwrap_or(0);
    for k in (0..=last).rev() {
        stops[k].1 = choice;
        choice = cheapest[k][choice].1;
    }
}

#[cfg(test)]
mod tests {
    use super::super::runs::Way;
    use super::*;
    use proptest::prelude::*;

    fn open(from: P2, to: P2) -> Vec<Visit> {
        let visit = |entry, exit, backward: bool| Visit {
            entry,
            exit,
            way: Way::Open { backward },
            back: usize::from(!backward),
        };
        vec![visit(from, to, false), visit(to, from, true)]
    }

    const RULES: Rules = Rules { from: P2::new(0.0, 0.0), to: Some(P2::new(0.0, 0.0)), cool_mm: 0.0 };

    #[test]
    fn a_row_of_strokes_is_walked_there_and_back_instead_of_jumped() {
        let strokes: Vec<Vec<Visit>> =
            (1..=5).map(|k| open(P2::new(f64::from(k), 0.0), P2::new(f64::from(k), 10.0))).collect();
        let stops = tour(&strokes, &RULES);
        // Hops of 1 mm between neighbours; in and out over the corners.
        let least = 1.0 + 4.0 + (25.0_f64 + 100.0).sqrt();
        assert!((total(&stops, &strokes, &RULES) - least).abs() < 1e-9);
    }

    #[test]
    fn crossed_ways_are_uncrossed() {
        // Points on a ring, given in a scrambled order: the tour is the ring.
        let ring: Vec<Vec<Visit>> = (0..60)
            .map(|k| {
                let angle = f64::from(k * 37 % 60) / 60.0 * std::f64::consts::TAU;
                let p = P2::new(100.0 + 100.0 * angle.cos(), 100.0 * angle.sin());
                vec![Visit { entry: p, exit: p, way: Way::Corner(0), back: 0 }]
            })
            .collect();
        let length = total(&tour(&ring, &RULES), &ring, &RULES);
        assert!(length < std::f64::consts::TAU * 100.0 + 1.0, "{length}");
    }

    #[test]
    fn what_is_hot_is_left_to_cool_where_there_is_anywhere_else_to_go() {
        let row: Vec<Vec<Visit>> =
            (0..12).map(|k| open(P2::new(4.0 * f64::from(k), 0.0), P2::new(4.0 * f64::from(k), 1.0))).collect();
        let rules = Rules { cool_mm: 6.0, ..RULES };
        let stops = tour(&row, &rules);
        for pair in stops.windows(2) {
            let hop = (visit(pair[1], &row).entry - visit(pair[0], &row).exit).norm();
            assert!(hop >= 6.0, "{hop}");
        }
    }

    proptest! {
        #[test]
        fn every_place_is_visited_once_and_the_way_is_no_longer_than_to_the_nearest(
            ends in prop::collection::vec((0.0..300.0f64, 0.0..300.0f64, 0.0..300.0f64, 0.0..300.0f64), 1..30),
        ) {
            let places: Vec<Vec<Visit>> = ends.iter().map(|(a, b, c, d)| open(P2::new(*a, *b), P2::new(*c, *d))).collect();
            let stops = tour(&places, &RULES);
            let mut seen: Vec<usize> = stops.iter().map(|s| s.0).collect();
            seen.sort_unstable();
            prop_assert_eq!(seen, (0..places.len()).collect::<Vec<_>>());
            let greedy = total(&nearest(&places, &RULES), &places, &RULES);
            prop_assert!(total(&stops, &places, &RULES) <= greedy + 1e-9);
        }
    }
}
