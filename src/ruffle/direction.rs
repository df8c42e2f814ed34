//! Which way layers lie on each other, by straightening the outline: what is drawn upward in the straightened one is put back where it belongs.

use super::StackError;
use super::centreline::Centreline;
use crate::cut::Outline;
use crate::geom::P2;
use serde::{Deserialize, Serialize};

/// Which way the layers of a stack follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// From the floor up.
    #[default]
    Vertical,
    /// From left to right.
    Horizontal,
    /// Along the outline's middle line.
    AlongCurve,
}

/// An outline in which layers lie on each other from the bottom up.
pub(super) struct Unrolled {
    pub outline: Outline,
    /// Where a point of it lies in the plane.
    pub place: Box<dyn Fn(P2) -> P2>,
}

/// Straightens `outline` so that `direction` becomes upward.
pub(super) fn unrolled(outline: &Outline, direction: Direction) -> Result<Unrolled, StackError> {
    Ok(match direction {
        Direction::Vertical => Unrolled { outline: outline.clone(), place: Box::new(|p| p) },
        Direction::Horizontal => {
            let swapped = |p: P2| P2::new(p.y, p.x);
            // Swapping the axes turns loops round.
            let turned = |l: &Vec<P2>| l.iter().rev().map(|p| swapped(*p)).collect();
            let outline = Outline { outer: turned(&outline.outer), holes: outline.holes.iter().map(turned).collect() };
            Unrolled { outline, place: Box::new(swapped) }
        }
        Direction::AlongCurve => {
            let line = Centreline::of(outline).ok_or(StackError::NoCurve)?;
            Unrolled { outline: line.straightened(outline), place: Box::new(move |p| line.place(p)) }
        }
    })
}

/// The direction in which an outline is best stacked. Wider than tall, an upright stack would be a few long sheets that sag onto each other; a bow that stands on two
/// feet, or bends by more than a right angle, has no place for straight layers.
///
/// Measured over eleven outlines: horizontal where the bounding box is wider than 1.7 times its height and the outline at least half as high over most of its length.
pub fn suited_direction(outline: &Outline) -> Direction {
    if Centreline::of(outline).is_some_and(|line| line.is_bow()) {
        return Direction::AlongCurve;
    }
    let bounds = outline.bounds();
    if bounds.width() <= WIDE * bounds.height() {
        return Direction::Vertical;
    }
    let sideways = Outline { outer: outline.outer.iter().map(|p| P2::new(p.y, p.x)).collect(), holes: Vec::new() };
    let high = |i: &usize| {
        let at = bounds.min.x + (*i as f64 + 0.5) / SAMPLES as f64 * bounds.width();
        sideways.chords(at).iter().any(|(low, high)| high - low >= HIGH_SHARE * bounds.height())
    };
    let over = (0..SAMPLES).filter(high).count();
    if over as f64 >= HIGH_OVER * SAMPLES as f64 { Direction::Horizontal } else { Direction::Vertical }
}

const WIDE: f64 = 1.7;
const HIGH_SHARE: f64 = 0.5;
const HIGH_OVER: f64 = 0.6;
const SAMPLES: usize = 64;
