//! The folded ruffle with its joint numbers, large for the table and small for a step; and the pages of one ruffle.

use super::flow::Flow;
use super::letters::Face;
use super::page::{At, Lettering, Page, Pen, Place};
use super::{Book, count, flat, splices_of};
use crate::fit::Part;
use crate::geom::{Obstacles, P2, Rect, V2};
use crate::ruffle::Role;
use crate::strip::Splice;

const REGION: f64 = 0.9;
const OUTER: Pen = Pen::black(0.55);
const INNER: Pen = Pen::black(0.35);
const FLOOR: Pen = Pen::gray(0.25, 0.55);
const NUMBER: Lettering = Lettering::new(5.6, Face::Bold);
const SEAM: Lettering = Lettering { size_mm: 3.2, face: Face::Plain, gray: 0.25 };
const DOT_MM: f64 = 1.2;
/// Capitals and digits over the size of a face.
pub(super) const CAPITALS: f64 = 0.72;
/// Where joints crowd, numbers shrink with the room between them, down to this share.
const SMALLEST: f64 = 0.5;

/// The pages of a ruffle: folded, then flat.
pub(super) fn pages(flow: &mut Flow, job: &Book, part: &Part) {
    let title = format!("Ruffle {}: folded", part.name);
    flow.page(&title);
    let own: Vec<&Splice> = splices_of(job, &part.name).collect();
    let line = format!(
        "Seen from the front, the floor below. {}, strip {:.0} mm. {} The strip starts at the open ring.",
        count(part.ruffle.connection_points().len(), "joint"),
        part.report.strip_length_mm,
        if !own.is_empty() { "Short bars across the strip show where its pieces overlap." } else { "" }
    );
    flow.paragraph(super::flow::BODY, &line, &title);
    let picture = flow.take((flow.free_mm() - 2.0).min(1.1 * flow.width_mm()), &title);
    large(flow.paper(), &picture, part, &own);
    flat::pages(flow, job, part);
}

/// The folded ruffle in its outline, joints numbered, overlaps marked.
fn large(page: &mut Page, picture: &Rect, part: &Part, splices: &[&Splice]) {
    let (ruffle, x) = (&part.ruffle, &part.equilibrium.positions);
    let shown = Rect::around(part.outline.loops().flatten().chain(x));
    let place = Place::fit(&shown, &picture.grown(-9.0), 2.0);
    let loops: Vec<Vec<P2>> = part.outline.loops().map(|l| l.iter().map(|p| place.point(*p)).collect()).collect();
    page.region(loops.iter().map(Vec::as_slice), REGION, None);
    let floor = place.point(P2::new(shown.min.x, x.iter().map(|p| p.y).fold(f64::INFINITY, f64::min))).y;
    page.line(&[P2::new(picture.min.x, floor), P2::new(picture.max.x, floor)], FLOOR);
    let points: Vec<P2> = x.iter().map(|p| place.point(*p)).collect();
    strip(page, part, &points, |role| if role == Role::Outer { OUTER } else { INNER });

    let stations = ruffle.stations();
    let mut seams = Vec::new();
    for splice in splices {
        let middle = 0.5 * (splice.stations_mm.start + splice.stations_mm.end);
        let k = stations.partition_point(|s| *s <= middle).clamp(1, stations.len() - 1);
        let (a, b) = (points[ruffle.at(k - 1)], points[ruffle.at(k)]);
        let t = ((middle - stations[k - 1]) / (stations[k] - stations[k - 1])).clamp(0.0, 1.0);
        let at = a + (b - a) * t;
        let across = (b - a).try_normalize(1e-9).map_or(V2::y(), |w| V2::new(-w.y, w.x)) * 2.2;
        page.line(&[at - across, at + across], Pen::black(0.9));
        seams.push((at, [at - across, at + across], format!("pieces {}", splice.pieces.join(" / "))));
    }

    let joints = ruffle.connection_points();
    let start = points[ruffle.at(0)];
    let first = joints.iter().any(|joint| joint.node.index() == ruffle.at(0));
    let ring = if first { 2.0 * DOT_MM } else { DOT_MM };
    page.disc(start, ring, 1.0, Some(Pen::black(0.4)));
    let mut dots: Vec<P2> = joints.iter().map(|joint| points[joint.node.index()]).collect();
    for dot in &dots {
        page.disc(*dot, DOT_MM, 0.0, None);
    }
    let pairs = dots.iter().enumerate().flat_map(|(i, a)| dots[..i].iter().map(move |b| (a - b).norm()));
    let crowd = pairs.fold(f64::INFINITY, f64::min);
    let number = Lettering { size_mm: (0.75 * crowd).clamp(SMALLEST * NUMBER.size_mm, NUMBER.size_mm), ..NUMBER };
    let mut words: Vec<(Lettering, String)> =
        joints.iter().map(|joint| (number, format!("{}{}", part.name, joint.joint))).collect();
    words.extend(seams.iter().map(|(_, _, text)| (SEAM, text.clone())));
    dots.extend(seams.iter().map(|(at, ..)| *at));
    let bars = seams.iter().map(|(_, [a, b], _)| (*a, *b));
    let lines: Vec<(P2, P2)> = ruffle.segments().map(|(i, j)| (points[i], points[j])).chain(bars).collect();
    let widths: Vec<f64> = words.iter().map(|(lettering, text)| lettering.width_mm(text)).collect();
    let height = CAPITALS * number.size_mm;
    let obstacles = Obstacles { lines: &lines, dots: &dots, dot_mm: DOT_MM, area: *picture };
    for ((lettering, text), rect) in words.iter().zip(obstacles.place(&widths, height, 0.25 * height)) {
        page.text(P2::new(rect.center().x, rect.min.y), At::Middle, *lettering, text);
    }
}

/// The strip, section by section.
fn strip(page: &mut Page, part: &Part, points: &[P2], pen: impl Fn(Role) -> Pen) {
    for section in &part.ruffle.sections {
        page.line(&section_points(part, section.segments(), points), pen(section.role));
    }
}

fn section_points(part: &Part, segments: std::ops::Range<usize>, points: &[P2]) -> Vec<P2> {
    part.ruffle.walk[segments.start..=segments.end].iter().map(|node| points[node.index()]).collect()
}

/// The ruffle after one step: what is closed in black, what is still loose in grey, this step's joint ringed and named. `closed` are joint numbers.
pub(super) fn small(page: &mut Page, picture: &Rect, part: &Part, closed: &[u32], now: u32) {
    let (ruffle, x) = (&part.ruffle, &part.equilibrium.positions);
    let place = Place::fit(&Rect::around(x), &picture.grown(-3.0), 1.0);
    let points: Vec<P2> = x.iter().map(|p| place.point(*p)).collect();
    let joints = ruffle.connection_points();
    let done =
        |node: usize| joints.iter().any(|j| j.node.index() == node && (closed.contains(&j.joint) || j.joint == now));
    let fixed = |section: usize| {
        let (start, end) = ruffle.section_ends(section);
        done(start.index()) && done(end.index())
    };
    for loose in [true, false] {
        for (i, section) in ruffle.sections.iter().enumerate().filter(|(i, _)| fixed(*i) != loose) {
            let pen = if fixed(i) { Pen::black(0.4) } else { Pen::gray(0.22, 0.62) };
            page.line(&section_points(part, section.segments(), &points), pen);
        }
    }
    for joint in &joints {
        let at = points[joint.node.index()];
        if joint.joint == now {
            page.disc(at, 1.9, 1.0, Some(Pen::black(0.6)));
            page.disc(at, 0.9, 0.0, None);
        } else if closed.contains(&joint.joint) {
            page.disc(at, 0.6, 0.0, None);
        }
    }
}
