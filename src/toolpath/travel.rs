//! The way between runs: straight, or round what stands on the bed.
//!
//! A way round boxes is sought over their corners (a visibility graph; de Berg et al., Computational Geometry, ch. 15) with Dijkstra's search. There
//! are a handful of boxes on a bed.

use super::{Contour, Error};
use crate::geom::{P2, Rect, V2, tolerance};

/// Ways go round a corner at this distance, mm: more than the rounding of G-code, less than anyone would notice.
const ROUND_MM: f64 = 0.05;

/// Leads every run's way, and the way home, round the keep-outs without leaving `area`. Gives the corners of the way home.
///
/// # Errors
/// No way leads there, or a run itself crosses a keep-out.
pub(super) fn route(
    contours: &mut [Contour],
    keep_outs: &[(String, Rect)],
    area: &Rect,
    park: P2,
) -> Result<Vec<P2>, Error> {
    if keep_outs.is_empty() {
        return Ok(Vec::new());
    }
    let mut at = park;
    for contour in contours.iter_mut() {
        let crossed = keep_outs.iter().find(|(_, rect)| runs_into(contour, rect));
        let refused = |name: &str| Error::KeepOut {
            piece: contour.piece.clone(),
            role: contour.role.class(),
            keep_out: name.to_owned(),
        };
        if let Some((name, _)) = crossed {
            return Err(refused(name));
        }
        let (Some(start), Some(end)) = (contour.path.start(), contour.path.end()) else { continue };
        let way = way(at, start, keep_outs, area).ok_or_else(|| refused(&keep_outs[0].0))?;
        contour.way = way;
        at = end;
    }
    way(at, park, keep_outs, area).ok_or_else(|| Error::NoWayHome { keep_out: keep_outs[0].0.clone() })
}

/// Length of the way from `park` through all runs back to `park` outside them, mm.
pub(super) fn length_mm(contours: &[Contour], home: &[P2], park: P2) -> f64 {
    let mut at = park;
    let mut length = 0.0;
    let mut go = |to: P2, at: &mut P2| {
        length += (to - *at).norm();
        *at = to;
    };
    for contour in contours {
        contour.way.iter().copied().chain(contour.path.start()).for_each(|p| go(p, &mut at));
        at = contour.path.end().unwrap_or(at);
    }
    home.iter().copied().chain([park]).for_each(|p| go(p, &mut at));
    length
}

fn runs_into(contour: &Contour, rect: &Rect) -> bool {
    let points = contour.path.flatten(tolerance::FLATTEN_MM);
    let closing = contour.path.closed.then(|| points.first().copied()).flatten();
    let all: Vec<P2> = points.into_iter().chain(closing).collect();
    contour.path.bounds().overlaps(rect) && all.windows(2).any(|w| crosses(w[0], w[1], rect))
}

/// Corners of the shortest way that crosses no keep-out; none when it is straight. `None` when there is no way.
fn way(from: P2, to: P2, keep_outs: &[(String, Rect)], area: &Rect) -> Option<Vec<P2>> {
    let free = |a: P2, b: P2| !keep_outs.iter().any(|(_, rect)| crosses(a, b, rect));
    if free(from, to) {
        return Some(Vec::new());
    }
    let corners = keep_outs.iter().flat_map(|(_, rect)| {
        let Rect { min, max } = rect.grown(ROUND_MM);
        [min, P2::new(max.x, min.y), max, P2::new(min.x, max.y)]
    });
    let inside = corners.filter(|p| area.holds(&Rect::EMPTY.with(*p), 0.0));
    let nodes: Vec<P2> = [from, to].into_iter().chain(inside).collect();
    let mut reached = vec![(f64::INFINITY, 0_usize); nodes.len()];
    let mut done = vec![false; nodes.len()];
    reached[0].0 = 0.0;
    while let Some(k) = (0..nodes.len()).filter(|k| !done[*k]).min_by(|a, b| reached[*a].0.total_cmp(&reached[*b].0)) {
        if !reached[k].0.is_finite() {
            return None;
        }
        if k == 1 {
            break;
        }
        done[k] = true;
        for next in 0..nodes.len() {
            let longer = reached[k].0 + (nodes[next] - nodes[k]).norm();
            if !done[next] && longer < reached[next].0 && free(nodes[k], nodes[next]) {
                reached[next] = (longer, k);
            }
        }
    }
    let mut way = Vec::new();
    let mut at = reached[1].1;
    while at != 0 {
        way.push(nodes[at]);
        at = reached[at].1;
    }
    way.reverse();
    Some(way)
}

/// True when a segment has a point inside a box, its border shut out: the shares of the segment within both slabs overlap.
fn crosses(from: P2, to: P2, rect: &Rect) -> bool {
    let step: V2 = to - from;
    let mut share = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (low, high) = (rect.min[axis] - from[axis], rect.max[axis] - from[axis]);
        if step[axis] == 0.0 {
            if low >= 0.0 || high <= 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (low / step[axis], high / step[axis]);
        share = (share.0.max(a.min(b)), share.1.min(a.max(b)));
    }
    share.0 < share.1
}

#[cfg(test)]
mod tests {
    use super::super::tests::contour;
    use super::*;
    use crate::drawing::Role;
    use crate::geom::Path;
    use proptest::prelude::*;

    const BED: Rect = Rect { min: P2::new(-50.0, -50.0), max: P2::new(450.0, 450.0) };

    fn magnet(x: f64, y: f64) -> (String, Rect) {
        ("magnet".into(), Rect { min: P2::new(x, y), max: P2::new(x + 20.0, y + 20.0) })
    }

    #[test]
    fn a_way_goes_round_the_nearer_side_of_a_clamp() {
        let mut runs = [contour(Path::open([P2::new(60.0, 8.0), P2::new(60.0, 40.0)]), Role::Slit)];
        let home = route(&mut runs, &[magnet(30.0, 0.0)], &BED, P2::new(0.0, 8.0)).unwrap();
        assert_eq!(runs[0].way.len(), 2);
        assert!(runs[0].way.iter().all(|p| p.y < 0.0), "below is nearer: {:?}", runs[0].way);
        assert!(home.is_empty(), "from up there the way home is free");
    }

    #[test]
    fn a_way_round_never_leaves_the_bed() {
        let mut runs = [contour(Path::open([P2::new(60.0, 8.0), P2::new(60.0, 40.0)]), Role::Slit)];
        let bed = Rect::from_size(400.0, 400.0);
        route(&mut runs, &[magnet(30.0, 0.0)], &bed, P2::new(0.0, 8.0)).unwrap();
        assert!(runs[0].way.iter().all(|p| p.y > 20.0), "there is no room below: {:?}", runs[0].way);
    }

    #[test]
    fn a_cut_through_a_clamp_is_refused_with_both_names() {
        let mut runs = [contour(Path::circle(P2::new(40.0, 30.0), 15.0), Role::Hole)];
        let error = route(&mut runs, &[magnet(30.0, 0.0)], &BED, P2::origin()).unwrap_err().to_string();
        assert!(error.contains("A1") && error.contains("magnet"), "{error}");
    }

    proptest! {
        #[test]
        fn no_way_ever_crosses_a_keep_out(
            boxes in prop::collection::vec((20.0..330.0f64, 20.0..330.0f64), 0..5),
            ends in prop::collection::vec((0.0..400.0f64, 0.0..400.0f64), 2..12),
        ) {
            let keep_outs: Vec<(String, Rect)> = boxes.iter().map(|(x, y)| magnet(*x, *y)).collect();
            let inside = |p: &P2| keep_outs.iter().any(|(_, r)| r.grown(0.1).holds(&Rect::EMPTY.with(*p), 0.0));
            let mut runs: Vec<Contour> = ends
                .iter()
                .map(|(x, y)| P2::new(*x, *y))
                .filter(|p| !inside(p) && !inside(&(p + V2::new(0.01, 0.0))))
                .map(|p| contour(Path::open([p, p + V2::new(0.01, 0.0)]), Role::Mark))
                .collect();
            if let Ok(home) = route(&mut runs, &keep_outs, &BED, P2::origin()) {
                let mut at = P2::origin();
                let stops = runs.iter().flat_map(|r| r.way.iter().copied().chain(r.path.start()).chain(r.path.end()));
                for p in stops.chain(home).chain([P2::origin()]) {
                    for (_, rect) in &keep_outs {
                        prop_assert!(!crosses(at, p, rect));
                    }
                    at = p;
                }
            } else {
                // Boxes that overlap may shut a place in; single ones never do.
                prop_assert!(boxes.len() > 1);
            }
        }
    }
}
