//! From a cut to the runs that make it: where the tool may begin, stretch by stretch, dash by dash, pass by pass.

use super::cuts::Cut;
use super::lead::Scrap;
use super::{Contour, Dashes, Process, Settings, curve};
use crate::drawing::Role;
use crate::geom::{P2, Path};
use std::ops::Range;

/// Corners of a closed contour at which the tool may begin, at most: more hardly shorten the way.
const MAX_ENTRIES: usize = 40;

/// A way to make a cut: where the tool comes down first and where it is when all is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Visit {
    pub entry: P2,
    pub exit: P2,
    pub way: Way,
    /// Index of the visit that goes the other way round; its own where there is none.
    pub back: usize,
}

/// How a cut is gone through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Way {
    /// An open path from its start, or backward.
    Open { backward: bool },
    /// A closed path from one of its corners, once round.
    Corner(usize),
    /// A path with gaps, beginning with one of its stretches.
    Stretch(usize),
}

/// All ways to make a cut, the one as drawn first.
pub(super) fn visits(cut: &Cut, settings: &Settings) -> Vec<Visit> {
    let passes = settings.process(cut.operation).map_or(1, |process| process.passes.len());
    let (Some(start), Some(end)) = (cut.path.start(), cut.path.end()) else { return Vec::new() };
    if !cut.path.closed {
        // An even number of passes ends where it began, and what is cut from both its ends ends in its middle.
        let (far, near) = match curve::at(&cut.path, 0.5 * cut.path.length()) {
            Some((tip, _)) if is_cut_to_its_tip(cut, settings) => (tip, tip),
            _ if passes.is_multiple_of(2) => (start, end),
            _ => (end, start),
        };
        let visit =
            |entry, exit, backward| Visit { entry, exit, way: Way::Open { backward }, back: usize::from(!backward) };
        return vec![visit(start, far, false), visit(end, near, true)];
    }
    if cut.gaps.is_empty() {
        let n = cut.path.vertices.len();
        let corners = (0..n).step_by(n.div_ceil(MAX_ENTRIES));
        let visit = |(i, k): (usize, usize)| {
            let point = cut.path.vertices[k].point;
            Visit { entry: point, exit: point, way: Way::Corner(k), back: i }
        };
        return corners.enumerate().map(visit).collect();
    }
    let made = cut.made();
    let place = |s: f64| curve::at(&cut.path, s).map_or(start, |(p, _)| p);
    let n = made.len();
    let visit = |k: usize| Visit {
        entry: place(made[k].start),
        exit: place(made[(k + n - 1) % n].end),
        way: Way::Stretch(k),
        back: k,
    };
    (0..n).map(visit).collect()
}

/// The runs of a cut gone through in one way, passes included.
pub(super) fn runs(cut: &Cut, way: Way, process: &Process, settings: &Settings, scrap: &Scrap) -> Vec<Contour> {
    let paths = paths(cut, way, process, settings, scrap);
    let constant_power = settings.constant_power(process);
    let mut runs = Vec::with_capacity(paths.len() * process.passes.len());
    for (number, pass) in process.passes.iter().enumerate() {
        let run = |path: Path| Contour {
            path,
            operation: cut.operation,
            role: cut.role,
            piece: cut.piece.clone(),
            joint: cut.joint.clone(),
            feed_mm_per_min: process.feed_mm_per_min,
            power: pass.power,
            constant_power,
            depth_mm: pass.depth_mm,
            air: process.air,
            way: Vec::new(),
        };
        if number % 2 == 1 && !cut.path.closed && !is_cut_to_its_tip(cut, settings) {
            runs.extend(paths.iter().rev().map(|path| run(path.reversed())));
        } else {
            runs.extend(paths.iter().cloned().map(run));
        }
    }
    runs
}

fn paths(cut: &Cut, way: Way, process: &Process, settings: &Settings, scrap: &Scrap) -> Vec<Path> {
    let total = cut.path.length();
    if is_cut_to_its_tip(cut, settings) {
        return to_the_tip(cut, way, settings.blade_mm(), settings.overcut_mm);
    }
    if way_is_whole(cut, way) && process.dashes.is_none() {
        let Way::Corner(first) = way else {
            let backward = way == Way::Open { backward: true };
            return vec![if backward { cut.path.reversed() } else { cut.path.clone() }];
        };
        let path = cut.path.starting_at(first);
        let beyond =
            if settings.overcut_mm > 0.0 { curve::stretch(&path, 0.0, total + settings.overcut_mm) } else { path };
        return vec![scrap.led(beyond, cut, settings.lead_mm, true)];
    }
    let (begin, stretches) = match way {
        Way::Corner(first) => {
            let begin: f64 = cut.path.segments().take(first).map(|s| s.length()).sum();
            (0, vec![begin..begin + total])
        }
        Way::Stretch(first) => (first, cut.made()),
        Way::Open { .. } => (0, cut.made()),
    };
    let n = stretches.len();
    let ordered = (0..n).map(|k| stretches[(begin + k) % n].clone());
    let pieces: Vec<Range<f64>> = match process.dashes {
        Some(dashes) => ordered.flat_map(|stretch| dashed(stretch, dashes)).collect(),
        None => ordered.collect(),
    };
    let mut paths: Vec<Path> = pieces.into_iter().map(|r| curve::stretch(&cut.path, r.start, r.end)).collect();
    if way == (Way::Open { backward: true }) {
        paths = paths.iter().rev().map(Path::reversed).collect();
    }
    if let Some(first) = paths.first_mut()
        && cut.path.closed
        && process.dashes.is_none()
    {
        // Each contour ends at a bridge, so that only its start needs a lead.
        *first = scrap.led(first.clone(), cut, settings.lead_mm, false);
    }
    paths
}

fn way_is_whole(cut: &Cut, way: Way) -> bool {
    cut.gaps.is_empty() && !matches!(way, Way::Stretch(_))
}

/// True for the open cut of a flap made by a blade.
fn is_cut_to_its_tip(cut: &Cut, settings: &Settings) -> bool {
    settings.blade_mm() > 0.0 && cut.role == Role::Flap && !cut.path.closed
}

/// A blade would tear the hinge if it turned there: it comes down its own trail away from both ends of the cut, and runs from each to the tip.
fn to_the_tip(cut: &Cut, way: Way, blade_mm: f64, overcut_mm: f64) -> Vec<Path> {
    let path = if way == (Way::Open { backward: true }) { cut.path.reversed() } else { cut.path.clone() };
    let total = path.length();
    let short_mm = blade_mm.min(0.25 * total);
    let tip = 0.5 * total + 0.5 * overcut_mm.min(0.25 * total);
    vec![curve::stretch(&path, short_mm, tip), curve::stretch(&path.reversed(), short_mm, tip)]
}

/// Dashes evenly over a stretch, beginning and ending with one.
fn dashed(stretch: Range<f64>, dashes: Dashes) -> Vec<Range<f64>> {
    let length = stretch.end - stretch.start;
    let pitch = dashes.cut_mm + dashes.gap_mm;
    let gaps = ((length - dashes.cut_mm) / pitch).round().max(0.0);
    // Dashes keep their length; what does not come out even goes into the gaps.
    let step = if gaps > 0.0 { (length - dashes.cut_mm) / gaps } else { 0.0 };
    let dash = |k: u32| {
        let from = stretch.start + f64::from(k) * step;
        from..(from + dashes.cut_mm).min(stretch.end)
    };
    (0..=gaps as u32).map(dash).collect()
}

#[cfg(test)]
mod tests {
    use super::super::cuts::tests::cut;
    use super::super::tests::settings;
    use super::super::{Pass, Tool};
    use super::*;

    fn stroke(length: f64, role: Role) -> Cut {
        cut(Path::open([P2::new(0.0, 0.0), P2::new(length, 0.0)]), role)
    }

    fn made(cut: &Cut, way: Way, settings: &Settings) -> Vec<Contour> {
        let process = settings.process(cut.operation).unwrap();
        runs(cut, way, process, settings, &Scrap::of(&[], settings))
    }

    fn length(runs: &[Contour]) -> f64 {
        runs.iter().map(|r| r.path.length()).sum()
    }

    #[test]
    fn passes_of_an_open_path_alternate_with_their_own_power_and_depth() {
        let mut settings = settings();
        let pass = |power, depth_mm| Pass { power, depth_mm };
        settings.cut_inner.passes = vec![pass(0.9, 0.0), pass(0.7, 0.5), pass(0.5, 1.0)];
        let cut = stroke(10.0, Role::Slit);
        let runs = made(&cut, Way::Open { backward: false }, &settings);
        assert_eq!(
            runs.iter().map(|r| (r.power, r.depth_mm)).collect::<Vec<_>>(),
            [(0.9, 0.0), (0.7, 0.5), (0.5, 1.0)]
        );
        assert_eq!(runs[1].path.start(), runs[0].path.end());
        assert_eq!(runs[2].path, runs[0].path);
        let [forward, back] = visits(&cut, &settings)[..] else { panic!("two ends") };
        assert_eq!((forward.exit, back.exit), (P2::new(10.0, 0.0), P2::new(0.0, 0.0)));
        settings.cut_inner.passes.pop();
        assert_eq!(visits(&cut, &settings)[0].exit, P2::new(0.0, 0.0), "there and back");
    }

    #[test]
    fn a_perforation_begins_and_ends_with_a_dash_and_leaves_the_gaps() {
        let mut settings = settings();
        settings.cut_inner.dashes = Some(Dashes { cut_mm: 1.0, gap_mm: 1.0 });
        let runs = made(&stroke(9.2, Role::Slit), Way::Open { backward: true }, &settings);
        assert_eq!(runs.len(), 5);
        assert!((length(&runs) - 5.0).abs() < 1e-9);
        assert_eq!((runs[0].path.start(), runs[4].path.end()), (Some(P2::new(9.2, 0.0)), Some(P2::new(0.0, 0.0))));
    }

    #[test]
    fn an_overcut_runs_on_over_the_start() {
        let settings = Settings { overcut_mm: 0.5, ..settings() };
        let circle = cut(Path::circle(P2::new(50.0, 50.0), 10.0), Role::Outline);
        let runs = made(&circle, Way::Corner(1), &settings);
        assert_eq!(runs.len(), 1);
        assert!(!runs[0].path.closed && (length(&runs) - circle.path.length() - 0.5).abs() < 1e-9);
    }

    #[test]
    fn a_contour_with_bridges_ends_at_the_bridge_before_its_first_stretch() {
        let mut square = cut(
            Path::closed([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|(x, y)| P2::new(x, y))),
            Role::Outline,
        );
        square.leave_out(4.0..6.0);
        square.leave_out(24.0..26.0);
        let settings = settings();
        for (k, visit) in visits(&square, &settings).iter().enumerate() {
            assert_eq!(visit.way, Way::Stretch(k));
            let runs = made(&square, visit.way, &settings);
            assert_eq!((runs[0].path.start(), runs[1].path.end()), (Some(visit.entry), Some(visit.exit)));
            assert!((visit.entry - visit.exit).norm() - 2.0 < 1e-9);
            assert!((length(&runs) - 36.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_blade_cuts_a_flap_from_both_hinge_ends_to_its_tip() {
        let settings = Settings { tool: Tool::Knife { offset_mm: 0.25 }, overcut_mm: 0.5, ..settings() };
        let flap =
            cut(Path::open([(0.0, 0.0), (0.0, 8.0), (6.0, 8.0), (6.0, 0.0)].map(|(x, y)| P2::new(x, y))), Role::Flap);
        let mut twice = settings.clone();
        twice.cut_inner.passes.push(twice.cut_inner.passes[0]);
        let runs = made(&flap, Way::Open { backward: false }, &twice);
        assert!(runs.len() == 4 && runs[2] == runs[0] && runs[3] == runs[1], "the second pass too");
        let runs = made(&flap, Way::Open { backward: false }, &settings);
        assert_eq!(runs.len(), 2);
        assert!((runs[0].path.start().unwrap() - P2::new(0.0, 0.25)).norm() < 1e-9);
        assert!((runs[1].path.start().unwrap() - P2::new(6.0, 0.25)).norm() < 1e-9);
        assert!((runs[0].path.end().unwrap() - P2::new(3.25, 8.0)).norm() < 1e-9, "the two meet over each other");
        assert!((runs[1].path.end().unwrap() - P2::new(2.75, 8.0)).norm() < 1e-9);
    }
}
