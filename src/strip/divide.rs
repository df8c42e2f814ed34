//! Dividing a strip that is longer than the stock: which of the possible places are used.

use super::splice::Spot;
use std::ops::Range;

/// Pieces of equal length are easier to handle and to place: what a piece of the full length costs beyond one.
const LENGTH_COST: f64 = 0.05;

/// The splices that divide `whole` into pieces of at most `max_mm`: fewest pieces first, then splices where they disturb least, then even lengths, by dynamic programming
/// over the places, which are ascending. Where there is no way, the stretch in which a splice would have to lie.
pub(super) fn divide(spots: &[Spot], whole: Range<f64>, max_mm: f64) -> Result<Vec<Spot>, (f64, f64)> {
    if whole.end - whole.start <= max_mm {
        return Ok(Vec::new());
    }
    // A piece from one splice to the next; the strip's own ends have none.
    let piece = |from: Option<&Spot>, to: Option<&Spot>| {
        let (start, start_inside) =
            from.map_or((whole.start, whole.start), |s| (s.at_mm - s.half_mm, s.at_mm + s.half_mm));
        let (end, end_inside) = to.map_or((whole.end, whole.end), |s| (s.at_mm + s.half_mm, s.at_mm - s.half_mm));
        let length = end - start;
        let fits = length <= max_mm && start_inside < end_inside;
        fits.then(|| 1.0 + LENGTH_COST * (length / max_mm).powi(2))
    };
    // best[k]: cost of everything before splice k, and the splice before it.
    let mut best: Vec<Option<(f64, Option<usize>)>> = Vec::with_capacity(spots.len());
    let before = |best: &[Option<(f64, Option<usize>)>], to: Option<&Spot>| {
        let from_start = piece(None, to).map(|cost| (cost, None));
        let near = spots.partition_point(|s| s.at_mm < to.map_or(whole.end, |t| t.at_mm) - max_mm);
        let from_spots = (near..best.len()).filter_map(|k| {
            let (cost, _) = best[k]?;
            Some((cost + spots[k].cost + piece(Some(&spots[k]), to)?, Some(k)))
        });
        from_start.into_iter().chain(from_spots).min_by(|a, b| a.0.total_cmp(&b.0))
    };
    for spot in spots {
        let way = before(&best, Some(spot));
        best.push(way);
    }
    let Some((_, mut last)) = before(&best, None) else {
        let reached = (0..spots.len()).rev().find(|k| best[*k].is_some()).map_or(whole.start, |k| spots[k].at_mm);
        return Err((reached, (reached + max_mm).min(whole.end)));
    };
    let mut used = Vec::new();
    while let Some(k) = last {
        used.push(spots[k].clone());
        last = best[k].and_then(|(_, previous)| previous);
    }
    used.reverse();
    Ok(used)
}

/// The stretches of strip that the pieces are.
pub(super) fn ranges(spots: &[Spot], whole: Range<f64>) -> Vec<Range<f64>> {
    let starts = std::iter::once(whole.start).chain(spots.iter().map(|s| s.at_mm - s.half_mm));
    let ends = spots.iter().map(|s| s.at_mm + s.half_mm).chain(std::iter::once(whole.end));
    starts.zip(ends).map(|(start, end)| start..end).collect()
}

#[cfg(test)]
mod tests {
    use super::super::SpliceKind;
    use super::*;
    use proptest::prelude::*;

    fn spot(at_mm: f64, half_mm: f64, cost: f64) -> Spot {
        Spot { at_mm, half_mm, cost, kind: SpliceKind::Lap, passage: None }
    }

    #[test]
    fn fewer_pieces_beat_better_places_and_better_places_beat_even_lengths() {
        let free = |places: &[(f64, f64)]| {
            let spots: Vec<Spot> = places.iter().map(|(at, cost)| spot(*at, 5.0, *cost)).collect();
            divide(&spots, 0.0..100.0, 60.0).map(|used| used.iter().map(|s| s.at_mm).collect::<Vec<f64>>())
        };
        // Both in one splice: the dear place at 50 still saves a piece.
        assert_eq!(free(&[(20.0, 0.0), (50.0, 0.3), (80.0, 0.0)]), Ok(vec![50.0]));
        assert_eq!(free(&[(46.0, 0.3), (53.0, 0.0), (55.0, 0.0)]), Ok(vec![53.0]));
        assert_eq!(free(&[(20.0, 0.0)]), Err((20.0, 80.0)));
        // A very dear one does not.
        assert_eq!(free(&[(20.0, 0.0), (50.0, 1.2), (70.0, 0.0)]), Ok(vec![20.0, 70.0]));
    }

    proptest! {
        #[test]
        fn pieces_cover_the_strip_fit_the_stock_and_overlap_by_their_splices(
            length in 60.0..900.0f64, max in 60.0..300.0f64, holes in prop::collection::vec((0.0..1.0f64, 1.0..25.0f64), 0..12),
        ) {
            let whole = -9.0..length - 9.0;
            prop_assume!(length > max);
            let blocked = |at: f64| holes.iter().any(|(h, w)| (at - (whole.start + h * length)).abs() < w + 10.0);
            let spots: Vec<Spot> = (1..(length / 0.5) as usize)
                .map(|n| whole.start + n as f64 * 0.5)
                .filter(|at| at - 10.0 > whole.start && at + 10.0 < whole.end && !blocked(*at))
                .map(|at| spot(at, if at < 200.0 { 10.0 } else { 7.0 }, 0.0))
                .collect();
            if let Ok(used) = divide(&spots, whole.clone(), max) {
                let pieces = ranges(&used, whole.clone());
                prop_assert_eq!((pieces[0].start, pieces[pieces.len() - 1].end), (whole.start, whole.end));
                prop_assert!(pieces.iter().all(|p| p.end - p.start <= max + 1e-9));
                for (pair, spot) in pieces.windows(2).zip(&used) {
                    prop_assert!((pair[0].end - pair[1].start - 2.0 * spot.half_mm).abs() < 1e-9 && !blocked(spot.at_mm));
                }
                prop_assert!(pieces.windows(3).all(|p| p[0].end < p[2].start), "splices do not meet");
            }
        }
    }
}
