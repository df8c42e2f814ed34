//! The paper's length updates (section 4.2).

use crate::cut::Outline;
use crate::geom::P2;
use crate::ruffle::{Drawn, Role, Ruffle};

/// eta of the outer rule. The paper asks for less than 2; above 0.5 stacks of more than two layers oscillate.
const OUTER_GAIN: f64 = 0.4;
/// Sections keep at least this share of the length they were drawn with, so that no layer collapses, and at most this many times it.
const SHORTEST: f64 = 0.6;
const LONGEST: f64 = 1.6;

/// Section lengths for the next round, from where the strip lies now.
///
/// An outer section grows by eta times the smallest signed distance d of its nodes to the outline, so that it comes to touch it:
/// l' = l + eta min d. An inner section is to span its share alpha of the way across: l' = alpha (d(start) + l + d(end)).
/// Two things differ from the paper, which leaves them open: the outline's floor does not count as border, since the strip is meant to lie on it; and every
/// inner section has an alpha of its own, the share it was drawn with, so that a drawing that is right already stays as it is.
pub(super) struct LengthRule {
    /// The outline with its floor out of the way.
    target: Outline,
    drawn_lengths: Vec<f64>,
    /// alpha of each section.
    shares: Vec<f64>,
}

impl LengthRule {
    /// The rule for sections that start as `drawn`.
    pub fn new(drawn: &Drawn, outline: &Outline) -> LengthRule {
        let ruffle = &drawn.ruffle;
        let target = without_floor(outline);
        let drawn_lengths: Vec<f64> = (0..ruffle.sections.len()).map(|s| ruffle.section_length(s)).collect();
        let d = |p: P2| target.signed_distance(p).max(0.0);
        let share = |(s, length): (usize, &f64)| {
            let (from, to) = ruffle.section_ends(s);
            length / (d(drawn.positions[from.index()]) + length + d(drawn.positions[to.index()]))
        };
        let shares = drawn_lengths.iter().enumerate().map(share).collect();
        LengthRule { target, drawn_lengths, shares }
    }

    /// Lengths of all sections, mm, for a strip that lies at `positions`.
    pub fn lengths(&self, ruffle: &Ruffle, positions: &[P2]) -> Vec<f64> {
        let distances: Vec<f64> = positions.iter().map(|p| self.target.signed_distance(*p)).collect();
        let wanted = |s: usize| {
            let length = ruffle.section_length(s);
            let section = &ruffle.sections[s];
            match section.role {
                Role::Outer => {
                    let nodes = section.first_segment..=section.end_segment;
                    length + OUTER_GAIN * nodes.map(|k| distances[ruffle.at(k)]).fold(f64::INFINITY, f64::min)
                }
                Role::Inner => {
                    let (from, to) = ruffle.section_ends(s);
                    self.shares[s] * (distances[from.index()] + length + distances[to.index()])
                }
                Role::Densified => length,
            }
        };
        self.drawn_lengths
            .iter()
            .enumerate()
            .map(|(s, drawn)| wanted(s).clamp(SHORTEST * drawn, LONGEST * drawn))
            .collect()
    }
}

/// The outline with its lowest border pushed far down.
fn without_floor(outline: &Outline) -> Outline {
    let bounds = outline.bounds();
    let floor = bounds.min.y + 1e-3 * bounds.height();
    let depth = bounds.width() + bounds.height();
    let lowered = |p: &P2| if p.y <= floor { P2::new(p.x, p.y - depth) } else { *p };
    Outline { outer: outline.outer.iter().map(lowered).collect(), holes: outline.holes.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ruffle::{StackSettings, draw_stack};

    fn square() -> Outline {
        let p = |(x, y)| P2::new(x, y);
        Outline { outer: [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)].map(p).to_vec(), holes: Vec::new() }
    }

    #[test]
    fn rungs_keep_their_length_while_the_strip_lies_as_drawn() {
        let drawn = draw_stack(&square(), &StackSettings::default()).unwrap();
        let rule = LengthRule::new(&drawn, &square());
        let lengths = rule.lengths(&drawn.ruffle, &drawn.positions);
        for (s, length) in lengths.iter().enumerate() {
            if drawn.ruffle.sections[s].role == Role::Inner {
                assert!((length - drawn.ruffle.section_length(s)).abs() < 1e-9, "section {s}");
            }
        }
    }

    #[test]
    fn a_loop_short_of_the_outline_grows_and_one_beyond_it_shrinks() {
        let drawn = draw_stack(&square(), &StackSettings::default()).unwrap();
        let rule = LengthRule::new(&drawn, &square());
        let right_loop = 1;
        let shifted = |by: f64| -> Vec<P2> {
            drawn.positions.iter().map(|p| P2::new((p.x - 50.0) * 0.8 + 50.0 + by, p.y)).collect()
        };
        let length = drawn.ruffle.section_length(right_loop);
        assert!(rule.lengths(&drawn.ruffle, &shifted(0.0))[right_loop] > length);
        assert!(rule.lengths(&drawn.ruffle, &shifted(30.0))[right_loop] < length);
    }

    #[test]
    fn no_section_leaves_its_bounds() {
        let drawn = draw_stack(&square(), &StackSettings::default()).unwrap();
        let rule = LengthRule::new(&drawn, &square());
        let far: Vec<P2> = drawn.positions.iter().map(|p| P2::new(p.x + 900.0, p.y)).collect();
        for (s, length) in rule.lengths(&drawn.ruffle, &far).into_iter().enumerate() {
            let drawn = drawn.ruffle.section_length(s);
            assert!(length >= 0.6 * drawn - 1e-9 && length <= 1.6 * drawn + 1e-9);
        }
    }
}
