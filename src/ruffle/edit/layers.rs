//! Layers of a stack, put in and taken out.

use super::draft::{Draft, Part};
use super::mesh::refine;
use super::tangle::tangle;
use super::undensify::{drop_midpoints, no_room};
use super::{EditError, EditSettings, close, open, positive};
use crate::geom::{P2, V2};
use crate::ruffle::curve::{Curve, smooth};
use crate::ruffle::{Drawn, Role};
use std::ops::Range;

/// Sections of a layer: right loop, diagonal, left loop, rung.
pub(super) const PER_LAYER: usize = 4;
/// The direction at a rung's end is that of this share of it.
pub(super) const END_SHARE: f64 = 0.04;
/// How far the part above a removed layer is lifted off the rung it now stands on, mm: the two rungs it was and is drawn on sag differently.
const LIFTS_MM: [f64; 6] = [0.0, 1.0, 2.0, 4.0, 8.0, 16.0];
/// Near its connections it is lifted less, mm: within this distance by less than two thirds.
const LIFT_WITHIN_MM: f64 = 10.0;

/// A midpoint of the rung below that lies this near to where one is wanted, mm, is taken instead of a new one.
const SAME_MM: f64 = 6.0;

/// Parts that stand for each section of the plain stack: densified and divided ones counted as one.
pub(super) fn plain_sections(draft: &Draft) -> Vec<Range<usize>> {
    let mut starts = vec![0];
    for i in 1..draft.parts.len() {
        let inside = draft.made.iter().any(|m| m.first_section < i && i < m.end_section);
        if !inside && !draft.midpoint[draft.parts[i].from] {
            starts.push(i);
        }
    }
    let ends = starts[1..].iter().copied().chain([draft.parts.len()]);
    starts.iter().copied().zip(ends).map(|(a, b)| a..b).collect()
}

pub(super) fn count(sections: &[Range<usize>]) -> Result<usize, EditError> {
    let layers = sections.len() / PER_LAYER;
    let stack = layers >= 1 && sections.len() == PER_LAYER * layers + 1;
    if stack { Ok(layers) } else { Err(EditError::NotAStack { sections: sections.len() }) }
}

/// How many layers a stack has, however densified.
///
/// # Errors
/// A ruffle that is no stack.
pub fn layer_count(drawn: &Drawn) -> Result<usize, EditError> {
    count(&plain_sections(&Draft::of(drawn)?))
}

/// The first densified part of a rung, as an error.
pub(super) fn plain_rung(draft: &Draft, rung: &Range<usize>) -> Result<(), EditError> {
    let densified = draft.made.iter().find(|m| m.first_section < rung.end && rung.start < m.end_section);
    densified.map_or(Ok(()), |m| Err(EditError::RungDensified { section: m.first_section }))
}

/// Puts a layer of `height_mm` on rung `at`: 0 is the lowest, and as many as there are layers the top. What stood there moves up.
///
/// # Errors
/// A ruffle that is no stack, a place it does not have, a densified rung, no room.
pub fn insert_layer(drawn: &Drawn, at: usize, height_mm: f64, settings: &EditSettings) -> Result<Drawn, EditError> {
    let (mut draft, before) = open(drawn, settings)?;
    positive("the layer's height", height_mm)?;
    let sections = plain_sections(&draft);
    let layers = count(&sections)?;
    if at > layers {
        return Err(EditError::NoSuchLayer { layer: at, count: layers });
    }
    let rung = sections[PER_LAYER * at].clone();
    plain_rung(&draft, &rung)?;
    let above = rung.end..draft.parts.len();
    let up = V2::new(0.0, height_mm);

    // Knots of the rung get twins on the new one, which everything above holds on to from now on.
    let mut twin: Vec<Option<usize>> = vec![None; draft.knots.len()];
    let rung_knots = rung.clone().flat_map(|p| [draft.parts[p].from, draft.parts[p].to]).collect::<Vec<usize>>();
    let mut old = vec![false; draft.knots.len()];
    draft.parts[..rung.end].iter().for_each(|p| (old[p.from], old[p.to]) = (true, true));
    for knot in rung_knots {
        if twin[knot].is_none() {
            let new = draft.new_knot(draft.knots[knot] + up);
            draft.midpoint[new] = draft.midpoint[knot];
            twin[knot] = Some(new);
        }
    }
    for (knot, _) in old.iter().enumerate().filter(|(_, old)| !**old) {
        draft.knots[knot] += up;
    }
    let on_twin = |knot: usize| twin.get(knot).copied().flatten().unwrap_or(knot);
    for part in &mut draft.parts[above] {
        (part.from, part.to) = (on_twin(part.from), on_twin(part.to));
        part.inner.iter_mut().for_each(|p| *p += up);
    }

    let curve = draft.joined(rung.clone());
    let (left, right) = (draft.parts[rung.start].from, draft.parts[rung.end - 1].to);
    let (next_left, next_right) = (on_twin(left), on_twin(right));
    let mut side = |from: usize, to: usize, inside: f64, end: f64| {
        let out = (curve.at(end) - curve.at(inside)).normalize();
        let drawn = Curve::loop_beyond([draft.knots[from], draft.knots[to]], [out; 2], 0.5 * height_mm);
        draft.part(Role::Outer, [from, to], &drawn, drawn.length(), settings.segment_mm)
    };
    let across = Curve::traced(|v| curve.at(1.0 - v) + up * smooth(1.0 - v));
    let (right_loop, left_loop) =
        (side(right, next_right, 1.0 - END_SHARE, 1.0), side(left, next_left, END_SHARE, 0.0));
    let diagonal = draft.part(Role::Inner, [next_right, left], &across, across.length(), settings.segment_mm);
    let mut new = vec![right_loop, diagonal, left_loop];
    for part in rung.clone() {
        let part = &mut draft.parts[part];
        let inner = part.inner.iter().map(|p| p + up).collect();
        new.push(Part { from: on_twin(part.from), to: on_twin(part.to), inner, ..part.clone() });
        part.role = Role::Inner;
    }
    draft.replace(rung.end..rung.end, new);
    drop_midpoints(&mut draft, settings.segment_mm)?;
    close(draft, rung.end, before, settings)?.drawn()
}

/// Takes layer `layer` out, 0 the lowest, with everything densified in it. What stood on it moves down onto the rung below.
///
/// # Errors
/// A ruffle that is no stack, a layer it does not have, its last layer, a densified rung that loops from above would have to hold on to, no room.
pub fn remove_layer(drawn: &Drawn, layer: usize, settings: &EditSettings) -> Result<Drawn, EditError> {
    let (mut draft, before) = open(drawn, settings)?;
    let sections = plain_sections(&draft);
    let layers = count(&sections)?;
    if layer >= layers {
        return Err(EditError::NoSuchLayer { layer, count: layers });
    }
    if layers == 1 {
        return Err(EditError::LastLayer);
    }
    let first = PER_LAYER * layer;
    let (rung, next_rung) = (sections[first].clone(), sections[first + PER_LAYER].clone());
    let gone = rung.end..next_rung.end;
    if gone.end == draft.parts.len() {
        let outer = |role: &mut Role| {
            if *role == Role::Inner {
                *role = Role::Outer
            }
        };
        draft.parts[rung.clone()].iter_mut().for_each(|p| outer(&mut p.role));
        draft
            .made
            .iter_mut()
            .filter(|m| rung.start <= m.first_section && m.end_section <= rung.end)
            .for_each(|m| outer(&mut m.role));
        draft.replace(gone, Vec::new());
        drop_midpoints(&mut draft, settings.segment_mm)?;
        return close(draft, rung.start, before, settings)?.drawn();
    }

    let seam = Seam::new(&mut draft, rung, next_rung, settings.segment_mm)?;
    let gone = gone.start + seam.divided..gone.end + seam.divided;
    let place = |draft: &Draft, lift_mm: f64| {
        let mut placed = draft.clone();
        let moved = |p: P2| seam.moved(draft, p, lift_mm);
        let mut above = vec![false; placed.knots.len()];
        for part in &mut placed.parts[gone.end..] {
            for knot in [&mut part.from, &mut part.to] {
                match seam.pairs.iter().find(|pair| pair.above == *knot) {
                    Some(pair) => *knot = pair.below,
                    None => above[*knot] = true,
                }
            }
            part.inner.iter_mut().for_each(|p| *p = moved(*p));
        }
        for (at, _) in placed.knots.iter_mut().zip(&above).filter(|(_, above)| **above) {
            *at = moved(*at);
        }
        placed.replace(gone.clone(), Vec::new());
        placed
    };
    let placed = LIFTS_MM.iter().map(|lift| place(&draft, *lift)).find(|d| tangle(d).is_none());
    let mut draft = placed.ok_or_else(|| no_room(&place(&draft, 0.0), gone.start - 1))?;
    drop_midpoints(&mut draft, settings.segment_mm)?;
    close(draft, gone.start - 1, before, settings)?.drawn()
}

/// A knot of the rung that goes, and the one of the rung below that takes its place.
struct Pair {
    above: usize,
    below: usize,
    /// Where it lies on the rung, as a share of its length.
    share: f64,
}

/// How the part above comes to stand on the rung below.
struct Seam {
    /// From left to right.
    pairs: Vec<Pair>,
    /// Parts by which the rung below has grown to hold midpoints.
    divided: usize,
}

impl Seam {
    /// Finds a partner on `rung` for every knot of `next_rung` that the strip above it holds on to, dividing the rung where it has none.
    fn new(
        draft: &mut Draft,
        mut rung: Range<usize>,
        mut next_rung: Range<usize>,
        segment_mm: f64,
    ) -> Result<Seam, EditError> {
        let count = draft.parts.len();
        let used: Vec<usize> = draft.parts[next_rung.end..].iter().flat_map(|p| [p.from, p.to]).collect();
        let share = |draft: &Draft, rung: &Range<usize>, part: usize| {
            let length = |parts: Range<usize>| parts.map(|p| draft.parts[p].length_mm()).sum::<f64>();
            length(rung.start..part + 1) / length(rung.clone())
        };
        let ends = |draft: &Draft, r: &Range<usize>| (draft.parts[r.start].from, draft.parts[r.end - 1].to);
        let ((left, right), (next_left, next_right)) = (ends(draft, &rung), ends(draft, &next_rung));
        let mut pairs = vec![Pair { above: next_left, below: left, share: 0.0 }];
        let middles = next_rung.start..next_rung.end - 1;
        let middles: Vec<(usize, f64)> = middles.map(|p| (draft.parts[p].to, share(draft, &next_rung, p))).collect();
        for (above, wanted) in middles.into_iter().filter(|(knot, _)| used.contains(knot)) {
            plain_rung(draft, &rung)?;
            let length_mm: f64 = rung.clone().map(|p| draft.parts[p].length_mm()).sum();
            let near = |p: &usize| (share(draft, &rung, *p) - wanted).abs() * length_mm < SAME_MM;
            let below = match (rung.start..rung.end - 1).find(near) {
                Some(part) => draft.parts[part].to,
                None => {
                    let part = rung.clone().find(|p| share(draft, &rung, *p) >= wanted).unwrap_or(rung.end - 1);
                    let own_mm = draft.parts[part].length_mm();
                    let at_mm = own_mm - (share(draft, &rung, part) - wanted) * length_mm;
                    let knot = draft.divide_part(part, draft.nearest_node(part, at_mm));
                    refine(draft, part, segment_mm);
                    refine(draft, part + 1, segment_mm);
                    (rung.end, next_rung) = (rung.end + 1, next_rung.start + 1..next_rung.end + 1);
                    knot
                }
            };
            pairs.push(Pair { above, below, share: wanted });
        }
        pairs.push(Pair { above: next_right, below: right, share: 1.0 });
        Ok(Seam { pairs, divided: draft.parts.len() - count })
    }

    /// Where a point above the seam comes to lie: it goes with the knots of the seam that it lies over, and is lifted off away from them.
    fn moved(&self, draft: &Draft, p: P2, lift_mm: f64) -> P2 {
        let last = self.pairs.len() - 1;
        let at = |pair: &Pair| draft.knots[pair.above];
        let along = at(&self.pairs[last]) - at(&self.pairs[0]);
        let share = ((p - at(&self.pairs[0])).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        let k = self.pairs.partition_point(|pair| pair.share < share).clamp(1, last);
        let (low, high) = (&self.pairs[k - 1], &self.pairs[k]);
        let by = |pair: &Pair| draft.knots[pair.below] - at(pair);
        let t = ((share - low.share) / (high.share - low.share)).clamp(0.0, 1.0);
        let away = self.pairs.iter().map(|pair| (p - at(pair)).norm()).fold(f64::INFINITY, f64::min);
        let lift = lift_mm * (1.0 - (-(away / LIFT_WITHIN_MM).powi(2)).exp());
        p + by(low) * (1.0 - t) + by(high) * t + V2::new(0.0, lift)
    }
}
