//! Which joints connectors tie: those the design names, and the nearest ones wherever parts touch.

use super::standing::Touch;
use crate::design::Design;
use crate::fit::Part;
use crate::strip::{PartJoint, nearest_joints};

/// Pairs of joints in the design's order, then those of parts that touch and that no connector of the design ties.
pub(super) fn ties(design: &Design, parts: &[Part], meetings: &[Touch]) -> Vec<[PartJoint; 2]> {
    let number = |name: &str| parts.iter().position(|p| p.name == name);
    let end = |(name, joint): (&str, u32)| Some(PartJoint { part: number(name)?, joint });
    // That names are joints of parts was checked when the design was read.
    let mut ties: Vec<[PartJoint; 2]> =
        design.connectors.iter().filter_map(|c| c.ends().and_then(|[from, to]| Some([end(from)?, end(to)?]))).collect();
    let by_hand: Vec<[usize; 2]> = ties.iter().map(|[a, b]| [a.part.min(b.part), a.part.max(b.part)]).collect();
    for touch in meetings.iter().filter(|t| !by_hand.contains(&t.parts)) {
        let frame = &parts[touch.parts[0]].frame;
        let nearest = nearest_joints(parts, touch.parts, touch.line(frame.origin, frame.normal), &ties);
        ties.extend(nearest);
    }
    ties
}
