//! Ends of pieces that meet side by side: dovetails and fingers.

use super::splice::SpliceKind;
use crate::geom::P2;

/// How far tails and fingers reach into the other piece, mm (materials practice).
pub(super) const DEPTH_MM: f64 = 7.0;
/// Width of a tail at its end and at its root, and of a finger, mm (materials practice). They are cut to size: the kerf is made up for on both sides.
const HEAD_MM: f64 = 10.0;
const NECK_MM: f64 = 7.0;
/// Tape reaches this far beyond the tails on either side, mm.
pub(super) const TAPE_MM: f64 = 9.0;
/// Sheet beside the outermost tail, mm, and between two, at least.
const BESIDE_MM: f64 = 4.0;
/// Rounding of a tail's corners, mm: what a blade can turn.
pub(super) const RADIUS_MM: f64 = 1.0;

/// The line between two pieces, from the lower edge to the upper, `ends` at its roots. The earlier piece lies behind it; its tails reach from `at_mm` - depth / 2 to
/// `at_mm` + depth / 2 and lie in the band from `lo` to `hi`.
pub(super) fn line(kind: SpliceKind, at_mm: f64, ends: (f64, f64), (lo, hi): (f64, f64)) -> Vec<P2> {
    let (root, tip) = (at_mm - 0.5 * DEPTH_MM, at_mm + 0.5 * DEPTH_MM);
    let neck = if kind == SpliceKind::Finger { HEAD_MM } else { NECK_MM };
    let width = hi - lo;
    let count = (((width - BESIDE_MM) / (HEAD_MM + BESIDE_MM)) as usize).max(1);
    let tail = |i: usize| {
        let middle = lo + width * (2 * i + 1) as f64 / (2 * count) as f64;
        let (n, h) = (0.5 * neck, 0.5 * HEAD_MM);
        [(root, middle - n), (tip, middle - h), (tip, middle + h), (root, middle + n)].map(|(s, w)| P2::new(s, w))
    };
    let inner = (0..count).flat_map(tail);
    std::iter::once(P2::new(root, ends.0)).chain(inner).chain([P2::new(root, ends.1)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_are_wider_at_their_end_and_keep_off_the_edges() {
        let line = line(SpliceKind::DovetailTape, 100.0, (-30.0, 10.0), (-30.0, 10.0));
        assert_eq!(line.len(), 2 + 4 * 2);
        assert_eq!((line[1], line[2]), (P2::new(96.5, -23.5), P2::new(103.5, -25.0)));
        assert!(line.windows(2).all(|p| (p[1] - p[0]).norm() > 1.0));
        let fingers = super::line(SpliceKind::Finger, 0.0, (0.0, 20.0), (0.0, 20.0));
        assert_eq!(fingers[1].y, fingers[2].y);
    }
}
