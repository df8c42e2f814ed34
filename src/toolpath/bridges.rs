//! Bridges: short stretches of an outline left uncut, so that the piece stays in its sheet until it is broken out.
//!
//! Where a bridge was, a nub of a few tenths remains. It does no harm on a straight rim away from the joints, and much on a flap (it would not go
//! through its slit), on a splice (two sheets lie there on each other) and at the crown of a loop, midway between two joints, where the strip bends
//! most and would crease at it.

use super::cuts::Cut;
use super::{Bridges, curve};
use crate::drawing::{Drawing, Operation, Role};
use crate::geom::{P2, Path, Rect, V2, cross};
use crate::progress::Warning;
use std::ops::Range;

/// A run counts as straight when it turns by less than this over the bridge and its room, rad (6 degrees).
const STRAIGHT_RAD: f64 = 0.1;

/// Straight run wanted on both sides of a bridge, mm.
const ROOM_MM: f64 = 2.0;

/// Stretch of the rim beside a cut or a mark that is kept free, mm beyond its ends.
const CLEAR_MM: f64 = 2.0;

/// Share of the strip between two joints, around its middle, taken for the crown: beyond it a loop bends less than half as much.
const CROWN_SHARE: f64 = 0.3;

/// Places along a contour are tried at this step, mm.
const STEP_MM: f64 = 1.0;

/// A piece hangs on fewer bridges than this only when there is no other place: on one it could swing into the beam.
const LEAST: usize = 2;

/// Leaves bridges in every outline; warns of those that found too few places.
pub(super) fn place(cuts: &mut [Cut], drawings: &[Drawing], wanted: &Bridges, kerf_mm: f64) -> Option<Warning> {
    let mut loose: Vec<String> = Vec::new();
    for cut in cuts.iter_mut().filter(|c| c.operation == Operation::CutOutline && c.path.closed) {
        let strip = drawings.iter().find(|d| d.name == cut.piece).and_then(Strip::of);
        let places = if wanted.everywhere {
            even(&cut.path, wanted)
        } else {
            chosen(&cut.path, wanted, |p, heading| strip.as_ref().is_none_or(|s| s.bears(p, heading)))
        };
        if places.len() < LEAST {
            loose.push(cut.piece.clone());
        }
        // The tool takes half its kerf off both ends of what it leaves.
        let half = 0.5 * (wanted.width_mm + kerf_mm);
        for place in places {
            cut.leave_out(place - half..place + half);
        }
    }
    let message = || {
        format!("no room for two bridges on {}: tape these pieces down, or hold the sheet on a mat", loose.join(", "))
    };
    (!loose.is_empty()).then(|| Warning::new("few-bridges", message()))
}

/// Middles of bridges at even steps, mm along the path.
fn even(path: &Path, wanted: &Bridges) -> Vec<f64> {
    let total = path.length();
    let count = (total / wanted.pitch_mm).round().max(LEAST as f64) as u32;
    (0..count).map(|k| (f64::from(k) + 0.5) * total / f64::from(count)).collect()
}

/// Middles of bridges about a pitch apart, each at the nearest place that is straight and bears one.
fn chosen(path: &Path, wanted: &Bridges, bears: impl Fn(P2, V2) -> bool) -> Vec<f64> {
    let total = path.length();
    let reach = 0.5 * wanted.width_mm + ROOM_MM;
    let fits = |along: f64| {
        let ends = [along - reach, along, along + reach].map(|s| curve::at(path, s));
        let [Some((_, u)), Some((middle, heading)), Some((_, v))] = ends else { return false };
        let turn = |a: V2, b: V2| cross(a, b).atan2(a.dot(&b)).abs();
        turn(u, heading) < STRAIGHT_RAD && turn(heading, v) < STRAIGHT_RAD && bears(middle, heading)
    };
    let steps = (total / STEP_MM).ceil().max(1.0) as usize;
    let free: Vec<f64> = (0..steps).map(|k| k as f64 * total / steps as f64).filter(|s| fits(*s)).collect();
    let count = ((total / wanted.pitch_mm).ceil() as usize).max(LEAST);
    let apart = |a: f64, b: f64| {
        let d = (a - b).rem_euclid(total);
        d.min(total - d)
    };
    let least = 0.3 * total / count as f64;
    let mut places: Vec<f64> = Vec::new();
    for k in 0..count {
        let target = (k as f64 + 0.5) * total / count as f64;
        let open = free.iter().copied().filter(|s| places.iter().all(|p| apart(*p, *s) >= least));
        let nearest = open.min_by(|a, b| apart(*a, target).total_cmp(&apart(*b, target)));
        places.extend(nearest.filter(|s| apart(*s, target) <= wanted.pitch_mm));
    }
    places.sort_by(f64::total_cmp);
    places
}

/// What a piece of strip shows of itself: which way it runs, and where along it a bridge would do harm.
struct Strip {
    along: V2,
    harm: Vec<Range<f64>>,
}

impl Strip {
    /// `None` for a piece without joints, of which nothing is known.
    fn of(piece: &Drawing) -> Option<Strip> {
        let inside = || piece.paths.iter().filter(|p| !matches!(p.role, Role::Outline | Role::Label));
        inside().find(|p| p.joint.is_some())?;
        let along = longest_run(piece.outline()?)?;
        let extent = |path: &Path| {
            let reach = |p: &P2| p.coords.dot(&along);
            let points = path.flatten(crate::geom::tolerance::FLATTEN_MM);
            let ends = points.iter().map(reach);
            ends.fold(f64::INFINITY..f64::NEG_INFINITY, |r, s| r.start.min(s)..r.end.max(s))
        };
        let mut stations: Vec<f64> = inside()
            .filter(|p| p.joint.is_some())
            .map(|p| {
                let r = extent(&p.path);
                0.5 * (r.start + r.end)
            })
            .collect();
        stations.sort_by(f64::total_cmp);
        let crowns = stations.windows(2).map(|pair| {
            let half = 0.5 * CROWN_SHARE * (pair[1] - pair[0]);
            let middle = 0.5 * (pair[0] + pair[1]);
            middle - half..middle + half
        });
        let beside = inside().map(|p| {
            let r = extent(&p.path);
            r.start - CLEAR_MM..r.end + CLEAR_MM
        });
        Some(Strip { along, harm: beside.chain(crowns).collect() })
    }

    /// True where a bridge does no harm: on a rim that runs along the strip, beside no cut and at no crown.
    fn bears(&self, p: P2, heading: V2) -> bool {
        let s = p.coords.dot(&self.along);
        heading.dot(&self.along).abs() > 0.7 && !self.harm.iter().any(|r| r.contains(&s))
    }
}

/// The direction in which a contour is longest, by its box turned every way its edges run.
fn longest_run(outline: &Path) -> Option<V2> {
    let directions = outline.segments().filter(|s| s.length() > STEP_MM).map(|s| (s.to() - s.from()).normalize());
    let corners: Vec<P2> = outline.flatten(0.1);
    let extent = |u: &V2| {
        let turned =
            Rect::around(&corners.iter().map(|p| P2::new(p.coords.dot(u), cross(*u, p.coords))).collect::<Vec<_>>());
        turned.width() / turned.height().max(1e-9)
    };
    directions.max_by(|a, b| extent(a).total_cmp(&extent(b)))
}

#[cfg(test)]
mod tests {
    use super::super::cuts::tests::cut;
    use super::*;
    use crate::drawing::{DrawnPath, KerfSide};
    use crate::geom::Motion;

    const WANTED: Bridges = Bridges { width_mm: 0.4, pitch_mm: 100.0, everywhere: false };

    /// A strip of 300 x 40 with a slit at 50, 150 and 250.
    fn strip(turn: f64) -> Drawing {
        let motion = Motion::new(V2::new(200.0, 200.0), turn);
        let p = |x, y| motion * P2::new(x, y);
        let outline = Path::closed([p(0.0, 0.0), p(300.0, 0.0), p(300.0, 40.0), p(0.0, 40.0)]);
        let drawn = |path, role, joint: Option<&str>| DrawnPath {
            path,
            role,
            kerf: KerfSide::On,
            joint: joint.map(Into::into),
        };
        let mut paths = vec![drawn(outline, Role::Outline, None)];
        for (x, joint) in [(50.0, "A1"), (150.0, "A2"), (250.0, "A3")] {
            paths.push(drawn(Path::open([p(x, 15.0), p(x, 25.0)]), Role::Slit, Some(joint)));
        }
        Drawing { name: "A1".into(), paths }
    }

    #[test]
    fn bridges_stand_on_straight_rims_and_never_at_joints_crowns_or_ends() {
        for turn in [0.0, 0.4, std::f64::consts::FRAC_PI_2, std::f64::consts::PI] {
            let piece = strip(turn);
            let mut cuts = [cut(piece.outline().unwrap().clone(), Role::Outline)];
            assert_eq!(place(&mut cuts, std::slice::from_ref(&piece), &WANTED, 0.15), None);
            let gaps = &cuts[0].gaps;
            assert_eq!(gaps.len(), 7, "680 mm at a pitch of 100");
            let back = Motion::new(V2::new(200.0, 200.0), turn).inverse();
            for gap in gaps {
                assert!((gap.end - gap.start - 0.55).abs() < 1e-9, "the kerf takes its half off both ends");
                let (p, _) = curve::at(&cuts[0].path, 0.5 * (gap.start + gap.end)).unwrap();
                let s = (back * p).x;
                assert!(s > 1.0 && s < 299.0, "on an end: {s}");
                for slit in [50.0, 150.0, 250.0] {
                    assert!((s - slit).abs() > CLEAR_MM - 1e-6, "beside a joint: {s}");
                }
                for crown in [100.0, 200.0] {
                    assert!((s - crown).abs() > 14.0, "at a crown: {s}");
                }
            }
        }
    }

    #[test]
    fn a_circle_has_no_place_and_says_so_unless_ticks_are_wanted() {
        let circle = || [cut(Path::circle(P2::new(50.0, 50.0), 8.0), Role::Outline)];
        let mut cuts = circle();
        let warning = place(&mut cuts, &[], &WANTED, 0.15).expect("no straight run");
        assert!(cuts[0].gaps.is_empty() && warning.message.contains("A1"), "{}", warning.message);
        let mut cuts = circle();
        let ticks = Bridges { width_mm: 0.5, pitch_mm: 15.5, everywhere: true };
        assert_eq!(place(&mut cuts, &[], &ticks, 0.0), None);
        assert_eq!(cuts[0].gaps.len(), 3);
    }
}
