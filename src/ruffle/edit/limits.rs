//! Loops that would crease, and voids that nobody reaches into.

use super::{Draft, EditError};

/// What the sheet and the hands allow; zero for no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Radius below which the sheet creases, mm.
    pub min_bend_radius_mm: f64,
    /// Thickness of a void below which its flaps are out of reach, mm.
    pub min_void_mm: f64,
}

/// Curvature at the crown of a free tangent teardrop times its length: the elastica whose ends meet with opposite tangents.
const CROWN_CURVATURE: f64 = 10.76882;
/// Width of the same teardrop over its length.
const WIDTH: f64 = 0.204214;

/// A room of the ruffle: the shortest way round from a section back to itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Room {
    /// The section of it that bends most.
    pub section: usize,
    /// Strip around it, mm.
    pub around_mm: f64,
}

impl Limits {
    /// Refuses `after` if its tightest room breaks a limit and is tighter than any `before`.
    pub(super) fn judge(&self, before: Option<Room>, after: &Draft) -> Result<(), EditError> {
        let Some(room) = tightest_room(after) else { return Ok(()) };
        if before.is_some_and(|b| b.around_mm <= room.around_mm * (1.0 + 1e-9)) {
            return Ok(());
        }
        let Room { section, around_mm } = room;
        let (radius_mm, void_mm) = (around_mm / CROWN_CURVATURE, WIDTH * around_mm);
        if radius_mm < self.min_bend_radius_mm {
            return Err(EditError::Crease { section, radius_mm, limit_mm: self.min_bend_radius_mm });
        }
        if void_mm < self.min_void_mm {
            return Err(EditError::OutOfReach { section, void_mm, limit_mm: self.min_void_mm });
        }
        Ok(())
    }
}

/// The room with the least strip around it.
pub(super) fn tightest_room(draft: &Draft) -> Option<Room> {
    let lengths: Vec<f64> = draft.parts.iter().map(|p| p.length_mm()).collect();
    let mut tightest: Option<(f64, Vec<usize>)> = None;
    for (s, length) in lengths.iter().enumerate() {
        let limit = tightest.as_ref().map_or(f64::INFINITY, |t| t.0);
        if let Some((back, mut around)) = way_back(draft, &lengths, s, limit - length) {
            around.push(s);
            tightest = Some((back + length, around));
        }
    }
    let (around_mm, around) = tightest?;
    let section = around.into_iter().max_by(|a, b| turn(draft, *a).total_cmp(&turn(draft, *b)))?;
    Some(Room { section, around_mm })
}

/// The shortest way from a part's end back to its start over other parts (Dijkstra 1959), if it is shorter than `limit_mm`, and the parts on it.
fn way_back(draft: &Draft, lengths: &[f64], part: usize, limit_mm: f64) -> Option<(f64, Vec<usize>)> {
    let (goal, start) = (draft.parts[part].from, draft.parts[part].to);
    let mut way = vec![f64::INFINITY; draft.knots.len()];
    let mut over: Vec<Option<(usize, usize)>> = vec![None; draft.knots.len()];
    let mut done = vec![false; draft.knots.len()];
    way[start] = 0.0;
    loop {
        let open = (0..way.len()).filter(|k| !done[*k] && way[*k] < limit_mm);
        let knot = open.min_by(|a, b| way[*a].total_cmp(&way[*b]))?;
        if knot == goal {
            break;
        }
        done[knot] = true;
        for (s, p) in draft.parts.iter().enumerate().filter(|(s, _)| *s != part) {
            for (here, there) in [(p.from, p.to), (p.to, p.from)] {
                if here == knot && way[knot] + lengths[s] < way[there] {
                    way[there] = way[knot] + lengths[s];
                    over[there] = Some((knot, s));
                }
            }
        }
    }
    let mut parts = Vec::new();
    let mut knot = goal;
    while let Some((before, s)) = over[knot].filter(|_| knot != start) {
        parts.push(s);
        knot = before;
    }
    Some((way[goal], parts))
}

/// How far a part turns from end to end, rad.
fn turn(draft: &Draft, part: usize) -> f64 {
    let points = draft.points(part);
    points.windows(3).map(|w| (w[1] - w[0]).angle(&(w[2] - w[1]))).sum()
}
