//! A ruffle taken apart for editing: sections as polylines between numbered knots.

use super::EditError;
use crate::geom::P2;
use crate::ruffle::curve::{Curve, segments_for};
use crate::ruffle::{Densification, Densified, Drawn, Node, Role, Ruffle, Section};
use std::ops::Range;

/// A section with its drawing.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub role: Role,
    /// Knots it runs between.
    pub from: usize,
    pub to: usize,
    /// Nodes between the two knots, mm.
    pub inner: Vec<P2>,
    /// Rest length of every segment, mm: one more than there are inner nodes.
    pub rest_mm: Vec<f64>,
    /// [`Section::pinned`].
    pub pinned: bool,
    /// What it is called while a draft is edited: its section's index when the draft was opened, or a later number. Parts of a divided one share its name.
    pub name: usize,
}

impl Part {
    pub fn length_mm(&self) -> f64 {
        self.rest_mm.iter().sum()
    }
}

/// The whole strip.
#[derive(Debug, Clone)]
pub(super) struct Draft {
    pub parts: Vec<Part>,
    /// Position of each knot, mm.
    pub knots: Vec<P2>,
    /// Whether a knot is a midpoint ([`Densified::midpoints`]).
    pub midpoint: Vec<bool>,
    pub made: Vec<Densification>,
    pub foot: [usize; 2],
    /// The next part's name.
    next_name: usize,
}

impl Draft {
    pub fn of(drawn: &Drawn) -> Result<Draft, EditError> {
        let ruffle = &drawn.ruffle;
        ruffle.check()?;
        if drawn.positions.len() != ruffle.node_count {
            return Err(EditError::Positions { found: drawn.positions.len(), expected: ruffle.node_count });
        }
        let mut knot_of = vec![None; ruffle.node_count];
        let mut knots = Vec::new();
        let mut knot = |node: Node| {
            *knot_of[node.index()].get_or_insert_with(|| {
                knots.push(drawn.positions[node.index()]);
                knots.len() - 1
            })
        };
        let parts: Vec<Part> = ruffle
            .sections
            .iter()
            .enumerate()
            .map(|(name, s)| Part {
                role: s.role,
                pinned: s.pinned,
                name,
                from: knot(ruffle.walk[s.first_segment]),
                to: knot(ruffle.walk[s.end_segment]),
                inner: (s.first_segment + 1..s.end_segment).map(|k| drawn.positions[ruffle.at(k)]).collect(),
                rest_mm: ruffle.rest_lengths[s.segments()].to_vec(),
            })
            .collect();
        let foot = ruffle.foot.map(&mut knot);
        let mut midpoint = vec![false; knots.len()];
        for knot in ruffle.densified.midpoints.iter().filter_map(|n| knot_of[n.index()]) {
            midpoint[knot] = true;
        }
        let next_name = parts.len();
        Ok(Draft { parts, knots, midpoint, made: ruffle.densified.made.clone(), foot, next_name })
    }

    /// The ruffle again, its nodes numbered as the strip reaches them.
    pub fn drawn(&self) -> Result<Drawn, EditError> {
        let mut positions = Vec::new();
        let mut node_of: Vec<Option<Node>> = vec![None; self.knots.len()];
        let mut walk = Vec::new();
        let mut rest_lengths = Vec::new();
        let mut sections = Vec::new();
        let new_node = |positions: &mut Vec<P2>, at: P2| {
            positions.push(at);
            Node(positions.len() as u32 - 1)
        };
        for part in &self.parts {
            if walk.is_empty() {
                let start = new_node(&mut positions, self.knots[part.from]);
                node_of[part.from] = Some(start);
                walk.push(start);
            }
            walk.extend(part.inner.iter().map(|p| new_node(&mut positions, *p)));
            let end = *node_of[part.to].get_or_insert_with(|| new_node(&mut positions, self.knots[part.to]));
            walk.push(end);
            let first_segment = rest_lengths.len();
            rest_lengths.extend_from_slice(&part.rest_mm);
            sections.push(Section {
                role: part.role,
                first_segment,
                end_segment: rest_lengths.len(),
                pinned: part.pinned,
            });
        }
        let [Some(left), Some(right)] = self.foot.map(|knot| node_of[knot]) else { return Err(EditError::Foot) };
        let midpoints = (0..self.knots.len()).filter(|k| self.midpoint[*k]).filter_map(|k| node_of[k]);
        let mut midpoints: Vec<Node> = midpoints.collect();
        midpoints.sort_unstable();
        let densified = Densified { made: self.made.clone(), midpoints };
        let foot = [left, right];
        let ruffle = Ruffle { node_count: positions.len(), walk, rest_lengths, sections, foot, densified };
        ruffle.check()?;
        Ok(Drawn { ruffle, positions })
    }

    /// Nodes of a part, its knots included.
    pub fn points(&self, part: usize) -> Vec<P2> {
        let p = &self.parts[part];
        let ends = |knot: usize| std::iter::once(self.knots[knot]);
        ends(p.from).chain(p.inner.iter().copied()).chain(ends(p.to)).collect()
    }

    pub fn curve(&self, part: usize) -> Curve {
        Curve::through(self.points(part))
    }

    /// Parts one after the other as one curve.
    pub fn joined(&self, parts: impl IntoIterator<Item = usize>) -> Curve {
        let mut points: Vec<P2> = parts.into_iter().flat_map(|p| self.points(p)).collect();
        points.dedup();
        Curve::through(points)
    }

    /// The inner node of a part that lies nearest to `at_mm` of rest length from its start.
    pub fn nearest_node(&self, part: usize, at_mm: f64) -> usize {
        let p = &self.parts[part];
        let mut way = 0.0;
        let mut nearest = (f64::INFINITY, 0);
        for (k, rest) in p.rest_mm[..p.inner.len()].iter().enumerate() {
            way += rest;
            if (way - at_mm).abs() < nearest.0 {
                nearest = ((way - at_mm).abs(), k);
            }
        }
        nearest.1
    }

    pub fn new_knot(&mut self, at: P2) -> usize {
        self.knots.push(at);
        self.midpoint.push(false);
        self.knots.len() - 1
    }

    /// A new part drawn along `curve`, divided evenly, of `length_mm` at rest.
    pub fn part(&mut self, role: Role, [from, to]: [usize; 2], curve: &Curve, length_mm: f64, segment_mm: f64) -> Part {
        let n = segments_for(length_mm, segment_mm);
        let points = curve.divide(n);
        let name = self.next_name;
        self.next_name += 1;
        let (inner, rest_mm) = (points[1..n].to_vec(), vec![length_mm / n as f64; n]);
        Part { role, from, to, inner, rest_mm, pinned: false, name }
    }

    /// Parts of that name, first to last.
    pub fn named(&self, name: usize) -> Vec<usize> {
        (0..self.parts.len()).filter(|p| self.parts[*p].name == name).collect()
    }

    /// The knot that a node of the drawing became, when sections end there; `at` is a position of the walk between two sections of `ruffle`.
    pub fn knot_at(&self, ruffle: &Ruffle, at: usize) -> Option<usize> {
        let starts = ruffle.sections.iter().position(|s| s.first_segment == at).map(|s| self.parts[s].from);
        starts.or_else(|| ruffle.sections.iter().position(|s| s.end_segment == at).map(|s| self.parts[s].to))
    }

    /// How often the strip passes a knot.
    pub fn passes(&self, knot: usize) -> usize {
        let start = usize::from(self.parts.first().is_some_and(|p| p.from == knot));
        start + self.parts.iter().filter(|p| p.to == knot).count()
    }

    /// Puts parts in place of others, all inside the same densifications. Those that lose all their parts are forgotten.
    pub fn replace(&mut self, old: Range<usize>, new: Vec<Part>) {
        let count = new.len();
        let moved = |k: usize| if k >= old.end { k - old.len() + count } else { k.min(old.start) };
        for made in &mut self.made {
            made.first_section = moved(made.first_section);
            made.end_section = moved(made.end_section);
        }
        self.made.retain(|made| made.first_section < made.end_section);
        self.parts.splice(old, new);
    }

    /// Puts parts in place of one as what densifying made of it.
    pub fn densified(&mut self, part: usize, new: Vec<Part>) {
        let old = &self.parts[part];
        let run = part..part + new.len();
        let (role, length_mm) = (old.role, old.length_mm());
        self.replace(part..part + 1, new);
        self.made.push(Densification { first_section: run.start, end_section: run.end, role, length_mm });
        // An outer one first: of those that start together the longer, and of equal ones the older.
        self.made.sort_by_key(|made| (made.first_section, std::cmp::Reverse(made.end_section)));
    }

    /// Divides a part at its node `inner`, which becomes a midpoint; returns that knot.
    pub fn divide_part(&mut self, part: usize, inner: usize) -> usize {
        let whole = self.parts[part].clone();
        let knot = self.new_knot(whole.inner[inner]);
        self.midpoint[knot] = true;
        let low = Part {
            to: knot,
            inner: whole.inner[..inner].to_vec(),
            rest_mm: whole.rest_mm[..=inner].to_vec(),
            ..whole.clone()
        };
        let high = Part {
            from: knot,
            inner: whole.inner[inner + 1..].to_vec(),
            rest_mm: whole.rest_mm[inner + 1..].to_vec(),
            ..whole
        };
        self.replace(part..part + 1, vec![low, high]);
        knot
    }

    /// Joins the part that ends at a knot with the next one.
    pub fn join_parts(&mut self, first: usize) {
        let (mut low, high) = (self.parts[first].clone(), self.parts[first + 1].clone());
        let knot = low.to;
        self.midpoint[knot] = false;
        low.pinned |= high.pinned;
        low.inner.push(self.knots[knot]);
        low.inner.extend(high.inner);
        low.rest_mm.extend(high.rest_mm);
        low.to = high.to;
        self.replace(first..first + 2, vec![low]);
    }
}
