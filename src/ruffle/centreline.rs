//! The middle line of a bow or a bar, and the outline straightened along it.
//!
//! The line is the longest way through the triangles of the outline (the chordal axis: Prasad 1997), its ends put on the middles of the feet it stands on.

use crate::cut::Outline;
use crate::geom::{P2, V2, cross, signed_area};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// Points of the outline that are triangulated, about.
const BORDER_POINTS: f64 = 160.0;
/// Points of the line.
const LINE_POINTS: usize = 96;
/// The way through the triangles ends in corners: this many half widths of it are left out at either end.
const CORNER_HALVES: f64 = 1.5;
/// A foot ends within this share of the outline's height.
const FOOT_SHARE: f64 = 0.04;
/// And is no wider than this many half widths of the line: what is wider is a base, not the end of a leg.
const FOOT_HALVES: f64 = 4.0;
/// A line is that of a bow if it turns by more than this, rad: over a right angle with room for rounded corners.
const BOW_TURN: f64 = 2.6;
/// The corners of its triangles are smoothed away over half a width, this often.
const SMOOTHINGS: usize = 3;
/// And the outline, straightened along it, has between these shares of its area: branches that the line does not follow are missing.
const BOW_AREA: std::ops::Range<f64> = 0.9..1.15;

/// A smooth line through the middle of an outline.
#[derive(Debug, Clone)]
pub(super) struct Centreline {
    /// Evenly spaced.
    points: Vec<P2>,
    /// To the right of the line at each point, unit length.
    across: Vec<V2>,
    step_mm: f64,
    /// Whether both ends stand, each on a foot of its own.
    two_feet: bool,
    /// Area of the outline, straightened over its own.
    straightened_share: f64,
}

impl Centreline {
    /// The line of `outline`; nothing where holes lie in the way, or where it is too short to speak of.
    pub fn of(outline: &Outline) -> Option<Centreline> {
        if !outline.holes.is_empty() {
            return None;
        }
        let way = longest_way(outline)?;
        let mut depths: Vec<f64> = way.iter().map(|p| outline.signed_distance(*p)).collect();
        depths.sort_by(f64::total_cmp);
        let half = depths[depths.len() / 2];
        let (length, cut) = (length(&way), CORNER_HALVES * half);
        if half <= 0.0 || length < 4.0 * cut {
            return None;
        }
        let inner: Vec<P2> = (0..=LINE_POINTS)
            .map(|i| point_along(&way, cut + (length - 2.0 * cut) * i as f64 / LINE_POINTS as f64))
            .collect();
        let feet = [way[0], way[way.len() - 1]].map(|end| foot_under(outline, end, half));
        let (start, stands) = end_beyond(outline, feet[0], inner[0], inner[0] - inner[LINE_POINTS / 8]);
        let last = inner[LINE_POINTS];
        let (end, stands_too) = end_beyond(outline, feet[1], last, last - inner[LINE_POINTS - LINE_POINTS / 8]);
        let rough: Vec<P2> = std::iter::once(start).chain(inner).chain([end]).collect();
        let stand = [stands, stands_too];
        let line = Centreline::through(&smoothed(&rough, half, stand));
        let mut line = Centreline::through(&smoothed(&line.centred(outline), half, stand));
        line.two_feet = feet[0].zip(feet[1]).is_some_and(|(a, b)| (a - b).norm() > half);
        line.straightened_share = signed_area(&line.straightened(outline).outer) / outline.area();
        Some(line)
    }

    fn through(rough: &[P2]) -> Centreline {
        let total = length(rough);
        let step_mm = total / LINE_POINTS as f64;
        let points: Vec<P2> = (0..=LINE_POINTS).map(|i| point_along(rough, step_mm * i as f64)).collect();
        let along = |i: usize| points[(i + 1).min(LINE_POINTS)] - points[i.saturating_sub(1)];
        let across = (0..=LINE_POINTS).map(|i| V2::new(along(i).y, -along(i).x).normalize()).collect();
        Centreline { points, across, step_mm, two_feet: false, straightened_share: 0.0 }
    }

    /// Whether straight layers would not do: the line bends back, or stands on both its ends.
    pub fn is_bow(&self) -> bool {
        let turn = |w: &[V2]| cross(w[0], w[1]).atan2(w[0].dot(&w[1]));
        let turned: f64 = self.across.windows(2).map(turn).sum::<f64>().abs();
        BOW_AREA.contains(&self.straightened_share) && (turned > BOW_TURN || self.two_feet && turned > 0.75 * BOW_TURN)
    }

    /// How far the outline goes on to the left and the right of each point. Its ends, which may lie on the border, have what their neighbours have.
    fn sides(&self, outline: &Outline) -> Vec<[f64; 2]> {
        (0..=LINE_POINTS)
            .map(|i| {
                let i = i.clamp(1, LINE_POINTS - 1);
                [-1.0, 1.0].map(|sign| reach(outline, self.points[i], self.across[i] * sign))
            })
            .collect()
    }

    /// The points, moved to the middle between the sides.
    fn centred(&self, outline: &Outline) -> Vec<P2> {
        let sides = self.sides(outline);
        let middle = |i: usize| {
            let aside = 0.5 * (sides[i][1] - sides[i][0]);
            if aside.is_finite() { self.points[i] + self.across[i] * aside } else { self.points[i] }
        };
        (0..=LINE_POINTS).map(middle).collect()
    }

    /// The outline as it looks from the line: distance to the right of it, and along it.
    pub fn straightened(&self, outline: &Outline) -> Outline {
        let sides = self.sides(outline);
        let v = |i: usize| self.step_mm * i as f64;
        let right = (0..=LINE_POINTS).map(|i| P2::new(sides[i][1], v(i)));
        let left = (0..=LINE_POINTS).rev().map(|i| P2::new(-sides[i][0], v(i)));
        Outline { outer: right.chain(left).collect(), holes: Vec::new() }
    }

    /// Where a point of the straightened outline lies.
    pub fn place(&self, p: P2) -> P2 {
        let at = (p.y / self.step_mm).clamp(0.0, LINE_POINTS as f64);
        let i = (at as usize).min(LINE_POINTS - 1);
        let t = at - i as f64;
        let on_line = self.points[i] + (self.points[i + 1] - self.points[i]) * t;
        on_line + (self.across[i] * (1.0 - t) + self.across[i + 1] * t).normalize() * p.x
    }
}

/// How far from `p` along `out` the outline goes on.
fn reach(outline: &Outline, p: P2, out: V2) -> f64 {
    let hits = edges(outline).filter_map(|(a, b)| {
        let along = b - a;
        let whole = cross(out, along);
        let (way, share) = (cross(a - p, along) / whole, cross(a - p, out) / whole);
        (whole != 0.0 && way > 0.0 && (0.0..=1.0).contains(&share)).then_some(way)
    });
    hits.fold(f64::INFINITY, f64::min)
}

fn edges(outline: &Outline) -> impl Iterator<Item = (P2, P2)> + '_ {
    let l = &outline.outer;
    (0..l.len()).map(|i| (l[i], l[(i + 1) % l.len()]))
}

fn length(points: &[P2]) -> f64 {
    points.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}

fn point_along(points: &[P2], way: f64) -> P2 {
    let mut left = way;
    for w in points.windows(2) {
        let step = (w[1] - w[0]).norm();
        if left <= step && step > 0.0 {
            return w[0] + (w[1] - w[0]) * (left / step);
        }
        left -= step;
    }
    points[points.len() - 1]
}

/// The middle of the foot under an end of the way, if it stands.
fn foot_under(outline: &Outline, end: P2, half: f64) -> Option<P2> {
    let bounds = outline.bounds();
    if end.y > bounds.min.y + half {
        return None;
    }
    let feet = outline.chords(bounds.min.y + FOOT_SHARE * bounds.height());
    let away = |(left, right): &(f64, f64)| (left - end.x).max(end.x - right).max(0.0);
    let foot = feet.into_iter().min_by(|a, b| away(a).total_cmp(&away(b)))?;
    (foot.1 - foot.0 <= FOOT_HALVES * half).then_some(P2::new(0.5 * (foot.0 + foot.1), bounds.min.y))
}

/// Where a line that ends at `last`, going `along`, meets the foot or the outline; and whether it stands there.
fn end_beyond(outline: &Outline, foot: Option<P2>, last: P2, along: V2) -> (P2, bool) {
    if let Some(foot) = foot {
        return (foot, true);
    }
    let along = along.try_normalize(1e-9).unwrap_or(V2::y());
    let way = reach(outline, last, along);
    (if way.is_finite() { last + along * way } else { last }, false)
}

/// A line without the corners of triangles. Where it stands it comes down upright, and its end may move along the floor; elsewhere its end stays.
fn smoothed(rough: &[P2], half: f64, stands: [bool; 2]) -> Vec<P2> {
    let step = length(rough) / LINE_POINTS as f64;
    let mut points: Vec<P2> = (0..=LINE_POINTS).map(|i| point_along(rough, step * i as f64)).collect();
    let window = (half / step).ceil().max(1.0) as i64;
    let most = LINE_POINTS as i64;
    for _ in 0..SMOOTHINGS {
        // Beyond its ends the line goes on mirrored: in the floor where it stands, in its end elsewhere.
        let mirrored =
            |end: P2, p: P2, stands: bool| P2::new(if stands { p.x } else { 2.0 * end.x - p.x }, 2.0 * end.y - p.y);
        let at = |i: i64| match i {
            i if i < 0 => mirrored(points[0], points[(-i).min(most) as usize], stands[0]),
            i if i > most => mirrored(points[LINE_POINTS], points[(2 * most - i).max(0) as usize], stands[1]),
            i => points[i as usize],
        };
        let mean = |i: usize| {
            let around = (i as i64 - window)..=(i as i64 + window);
            let sum = around.clone().fold(V2::zeros(), |sum, k| sum + at(k).coords);
            P2::from(sum / around.count() as f64)
        };
        points = (0..=LINE_POINTS).map(mean).collect();
    }
    points
}

/// The longest way through the triangles that tile an outline, from middle to middle of their shared sides, with the corners it starts and ends in.
fn longest_way(outline: &Outline) -> Option<Vec<P2>> {
    let perimeter: f64 = edges(outline).map(|(a, b)| (b - a).norm()).sum();
    let mut border: Vec<P2> = Vec::new();
    for (a, b) in edges(outline) {
        let parts = ((b - a).norm() / (perimeter / BORDER_POINTS)).ceil().max(1.0) as usize;
        border.extend((0..parts).map(|k| a + (b - a) * (k as f64 / parts as f64)));
    }
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let handles: Vec<_> = border.iter().filter_map(|p| cdt.insert(Point2::new(p.x, p.y)).ok()).collect();
    for (i, a) in handles.iter().enumerate() {
        let b = handles[(i + 1) % handles.len()];
        if *a != b {
            cdt.try_add_constraint(*a, b);
        }
    }
    let point = |p: Point2<f64>| P2::new(p.x, p.y);
    let mut ways: Vec<Vec<(usize, P2)>> = vec![Vec::new(); cdt.num_all_faces()];
    let mut middles = vec![None; cdt.num_all_faces()];
    for face in cdt.inner_faces() {
        let corners = face.positions().map(point);
        let middle = P2::from((corners[0].coords + corners[1].coords + corners[2].coords) / 3.0);
        if outline.contains(middle) {
            middles[face.fix().index()] = Some(middle);
        }
    }
    for face in cdt.inner_faces().filter(|f| middles[f.fix().index()].is_some()) {
        for edge in face.adjacent_edges() {
            let across = edge.rev().face().fix().index();
            if !edge.is_constraint_edge() && middles[across].is_some() {
                let shared = nalgebra::center(&point(edge.from().position()), &point(edge.to().position()));
                ways[face.fix().index()].push((across, shared));
            }
        }
    }
    let start = middles.iter().position(Option::is_some)?;
    let (one_end, _) = farthest(&ways, &middles, start);
    let (other_end, way) = farthest(&ways, &middles, one_end);
    (one_end != other_end).then_some(way)
}

/// The triangle farthest from `start`, and the way there. Without holes there is one way only.
fn farthest(ways: &[Vec<(usize, P2)>], middles: &[Option<P2>], start: usize) -> (usize, Vec<P2>) {
    let mut came: Vec<Option<(usize, P2)>> = vec![None; ways.len()];
    let mut far = vec![0.0; ways.len()];
    let mut open = vec![start];
    let mut end = start;
    while let Some(face) = open.pop() {
        if far[face] > far[end] {
            end = face;
        }
        for (next, shared) in &ways[face] {
            if *next == start || came[*next].is_some() {
                continue;
            }
            let step = |face: usize| middles[face].map_or(0.0, |m| (m - shared).norm());
            far[*next] = far[face] + step(face) + step(*next);
            came[*next] = Some((face, *shared));
            open.push(*next);
        }
    }
    let mut way: Vec<P2> = middles[end].into_iter().collect();
    let mut face = end;
    while let Some((before, shared)) = came[face] {
        way.push(shared);
        face = before;
    }
    way.extend(middles[start]);
    way.reverse();
    (end, way)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ruffle::{Direction, suited_direction};

    fn polygon(points: &[(f64, f64)]) -> Outline {
        Outline { outer: points.iter().map(|(x, y)| P2::new(*x, *y)).collect(), holes: Vec::new() }
    }

    fn arch(outer: f64, inner: f64) -> Outline {
        let at = |r: f64, i: usize| {
            let angle = std::f64::consts::PI * i as f64 / 40.0;
            (r * angle.cos(), r * angle.sin())
        };
        let points: Vec<(f64, f64)> =
            (0..=40).map(|i| at(outer, i)).chain((0..=40).rev().map(|i| at(inner, i))).collect();
        polygon(&points)
    }

    #[test]
    fn the_line_of_an_arch_runs_from_foot_to_foot_through_its_middle() {
        let outline = arch(100.0, 55.0);
        let line = Centreline::of(&outline).unwrap();
        assert!(line.is_bow());
        for p in &line.points {
            assert!((p.coords.norm() - 77.5).abs() < 5.0, "{p}");
        }
        assert!(line.points[0].y.abs() < 0.1 && line.points[LINE_POINTS].y.abs() < 0.1);
        assert!((line.straightened_share - 1.0).abs() < 0.06, "{}", line.straightened_share);
        let back = line.place(P2::new(10.0, 0.5 * line.step_mm * LINE_POINTS as f64));
        assert!((back.y - 77.5).abs() > 8.0 && back.x.abs() < 3.0, "{back}");
    }

    #[test]
    fn only_bows_are_followed() {
        let rectangle = |w: f64, h: f64| polygon(&[(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)]);
        let l = polygon(&[(0.0, 0.0), (100.0, 0.0), (100.0, 42.0), (42.0, 42.0), (42.0, 100.0), (0.0, 100.0)]);
        let u = polygon(&[
            (0.0, 0.0),
            (30.0, 0.0),
            (30.0, 70.0),
            (70.0, 70.0),
            (70.0, 0.0),
            (100.0, 0.0),
            (100.0, 100.0),
            (0.0, 100.0),
        ]);
        assert_eq!(suited_direction(&arch(100.0, 55.0)), Direction::AlongCurve);
        assert_eq!(suited_direction(&u), Direction::AlongCurve);
        assert_eq!(suited_direction(&rectangle(100.0, 100.0)), Direction::Vertical);
        assert_eq!(suited_direction(&rectangle(40.0, 160.0)), Direction::Vertical);
        assert_eq!(suited_direction(&rectangle(200.0, 60.0)), Direction::Horizontal);
        assert_eq!(suited_direction(&rectangle(140.0, 50.0)), Direction::Horizontal);
        assert_eq!(suited_direction(&l), Direction::Vertical);
    }
}
