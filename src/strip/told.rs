//! What the user should know about splices and labels.

use super::splice::{Splice, SpliceKind};
use crate::progress::Warning;

/// How a strip of `length_mm` is divided, if it is, and which labels found no place.
pub(super) fn warnings(splices: &[Splice], length_mm: f64, left_out: &[String]) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let of = |kind: SpliceKind| splices.iter().filter(|s| s.kind == kind).count();
    let ways = [
        (SpliceKind::Connection, "at joints, whose flaps go through both ends"),
        (SpliceKind::Lap, "between joints, by a lap with joints of its own"),
        (SpliceKind::DovetailTape, "by dovetails, taped over between the ticks"),
        (SpliceKind::Finger, "by fingers, to be glued or taped"),
    ];
    let used = ways.iter().filter(|(kind, _)| of(*kind) > 0);
    let how: Vec<String> = used.map(|(kind, how)| format!("{} {how}", of(*kind))).collect();
    if !splices.is_empty() {
        let message = format!(
            "the strip of {length_mm:.0} mm is longer than the stock: {} pieces, joined {}",
            splices.len() + 1,
            how.join(" and ")
        );
        warnings.push(Warning::new("spliced", message));
    }
    if !left_out.is_empty() {
        let message = format!(
            "no free place for {} of the labels, which are left out: {}; the pictures in parts/ show the joint numbers",
            left_out.len(),
            left_out.join(", ")
        );
        warnings.push(Warning::new("labels-left-out", message));
    }
    warnings
}
