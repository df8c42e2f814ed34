//! The folded ruffle with its joint numbers, large for the table and small for a step; and the pages of one ruffle.

use super::flow::Flow;
use super::joints::strip_pieces;
use super::letters::Face;
use super::page::{At, Lettering, Page, Pen, Place};
use super::{Book, count, flat, splices_of};
use crate::fit::{FootUsed, Part};
use crate::geom::{Obstacles, P2, Rect, V2};
use crate::ruffle::Role;
use crate::strip::{Face as Side, Piece, Splice};

const REGION: f64 = 0.9;
const OUTER: Pen = Pen::black(0.55);
const INNER: Pen = Pen::black(0.35);
const FLOOR: Pen = Pen::gray(0.25, 0.55);
const NUMBER: Lettering = Lettering::new(5.6, Face::Bold);
const SEAM: Lettering = Lettering { size_mm: 3.2, face: Face::Plain, gray: 0.25 };
const DOT_MM: f64 = 1.2;
/// Lines that stand on the drawn side of the strip: how long, how far apart and how far from joints, mm.
const HAIR: Pen = Pen::black(0.2);
const HAIR_MM: f64 = 1.7;
const HAIR_APART_MM: f64 = 7.0;
const HAIR_CLEAR_MM: f64 = 5.0;
/// The arrow's tip lies this far along the strip, mm.
const ARROW_AT_MM: f64 = 14.0;
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
        "Seen from the front, the floor below. {}, strip {:.0} mm. The strip starts at the open ring and runs as the arrow shows; hairs stand on its {}.{}{}",
        count(part.ruffle.connection_points().len(), "joint"),
        part.report.strip_length_mm,
        job.handling.marks.side(),
        if own.is_empty() { "" } else { " Bars across the strip show where its pieces meet." },
        if part.report.foot == FootUsed::Pinned { " The triangles show where it is glued in the end." } else { "" }
    );
    flow.paragraph(super::flow::BODY, &line, &title);
    let picture = flow.take((flow.free_mm() - 2.0).min(1.1 * flow.width_mm()), &title);
    let pieces = strip_pieces(&part.name, job.pieces);
    large(flow.paper(), &picture, part, &pieces, &own);
    flat::pages(flow, job, part);
}

/// The folded ruffle in its outline, joints numbered, overlaps marked.
fn large(page: &mut Page, picture: &Rect, part: &Part, pieces: &[&Piece], splices: &[&Splice]) {
    let (ruffle, x) = (&part.ruffle, &part.equilibrium.positions);
    let shown = Rect::around(part.outline.loops().flatten().chain(x));
    let place = Place::fit(&shown, &picture.grown(-9.0), 2.0);
    let loops: Vec<Vec<P2>> = part.outline.loops().map(|l| l.iter().map(|p| place.point(*p)).collect()).collect();
    page.region(loops.iter().map(Vec::as_slice), REGION, None);
    let floor = place.point(P2::new(shown.min.x, x.iter().map(|p| p.y).fold(f64::INFINITY, f64::min))).y;
    page.line(&[P2::new(picture.min.x, floor), P2::new(picture.max.x, floor)], FLOOR);
    let points: Vec<P2> = x.iter().map(|p| place.point(*p)).collect();
    strip(page, part, &points, |role| if role == Role::Outer { OUTER } else { INNER });

    let course = Course { part, points: &points, stations: ruffle.stations() };
    let joints = ruffle.connection_points();
    let hairs = hairs(&course, pieces, place.scale);
    for hair in &hairs {
        page.line(hair, HAIR);
    }
    let feet = feet(part, &points);
    for triangle in &feet {
        page.region([triangle.as_slice()], 0.0, None);
    }
    arrow(page, &course, place.scale);
    let mut seams = Vec::new();
    for splice in splices {
        let middle = 0.5 * (splice.stations_mm.start + splice.stations_mm.end);
        let (at, along) = course.at(middle);
        let across = V2::new(-along.y, along.x) * 2.2;
        page.line(&[at - across, at + across], Pen::black(0.9));
        seams.push((at, [at - across, at + across], format!("pieces {}", splice.pieces.join(" / "))));
    }

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
    let bars = seams.iter().map(|(_, [a, b], _)| (*a, *b)).chain(hairs.iter().map(|[a, b]| (*a, *b)));
    let sides = feet.iter().flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]);
    let lines: Vec<(P2, P2)> =
        ruffle.segments().map(|(i, j)| (points[i], points[j])).chain(bars).chain(sides).collect();
    let widths: Vec<f64> = words.iter().map(|(lettering, text)| lettering.width_mm(text)).collect();
    let height = CAPITALS * number.size_mm;
    let obstacles = Obstacles { lines: &lines, dots: &dots, dot_mm: DOT_MM, area: *picture };
    for ((lettering, text), rect) in words.iter().zip(obstacles.place(&widths, height, 0.25 * height)) {
        page.text(P2::new(rect.center().x, rect.min.y), At::Middle, *lettering, text);
    }
}

/// The strip on the page, by distance along it.
struct Course<'a> {
    part: &'a Part,
    points: &'a [P2],
    stations: Vec<f64>,
}

impl Course<'_> {
    /// Where the strip is at station `s` (mm, true size), and the way it runs there.
    fn at(&self, s: f64) -> (P2, V2) {
        let (ruffle, stations) = (&self.part.ruffle, &self.stations);
        let k = stations.partition_point(|t| *t <= s).clamp(1, stations.len() - 1);
        let (a, b) = (self.points[ruffle.at(k - 1)], self.points[ruffle.at(k)]);
        let t = ((s - stations[k - 1]) / (stations[k] - stations[k - 1])).clamp(0.0, 1.0);
        (a + (b - a) * t, (b - a).try_normalize(1e-9).unwrap_or(V2::x()))
    }
}

/// Short lines on the drawn side of every piece, clear of the joints. The front is on the right hand of who walks along the strip.
fn hairs(course: &Course, pieces: &[&Piece], scale: f64) -> Vec<[P2; 2]> {
    let last = course.stations[course.stations.len() - 1];
    let clear =
        |s: f64| pieces.iter().flat_map(|p| &p.passages).all(|p| (p.station_mm - s).abs() * scale > HAIR_CLEAR_MM);
    let on = |piece: &&Piece| {
        let hand = if piece.seen_from == Side::Front { 1.0 } else { -1.0 };
        let range = piece.stations_mm.start.max(0.0)..piece.stations_mm.end.min(last);
        let step = HAIR_APART_MM / scale;
        let count = ((range.end - range.start) / step) as usize;
        let stations = (0..count).map(move |i| range.start + (i as f64 + 0.5) * step);
        stations
            .filter(|s| clear(*s))
            .map(move |s| {
                let (at, along) = course.at(s);
                [at, at + V2::new(along.y, -along.x) * (hand * HAIR_MM)]
            })
            .collect::<Vec<[P2; 2]>>()
    };
    pieces.iter().flat_map(on).collect()
}

/// An arrow head a little after the strip's start.
fn arrow(page: &mut Page, course: &Course, scale: f64) {
    let (tip, along) = course.at(ARROW_AT_MM / scale);
    let across = V2::new(-along.y, along.x);
    let corners = [tip, tip - along * 4.0 + across * 1.5, tip - along * 4.0 - across * 1.5];
    page.region([corners.as_slice()], 0.0, None);
}

/// Triangles under the two points that hold a glued foot.
fn feet(part: &Part, points: &[P2]) -> Vec<[P2; 3]> {
    if part.report.foot != FootUsed::Pinned {
        return Vec::new();
    }
    let triangle = |tip: P2| [tip, tip + V2::new(2.2, -3.6), tip + V2::new(-2.2, -3.6)];
    part.ruffle.foot.map(|node| triangle(points[node.index()] - V2::new(0.0, 0.6))).to_vec()
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
