//! Two small crosses on scrap, made first: by them a sheet is found again, after a stop, for a second tool, or for its other side.

use super::{Contour, Settings};
use crate::drawing::{Operation, Role};
use crate::geom::{P2, Path, Rect, V2, contains, distance_to_loop};

/// Length of a cross's arm from its middle, mm: seen without glasses, and room for it in any margin.
pub(crate) const ARM_MM: f64 = 2.0;

/// Room around a cross, mm.
const CLEAR_MM: f64 = 1.0;

/// Places are tried this far apart, mm.
const STEP_MM: f64 = 4.0;

/// Middles of two crosses far apart on `field`, clear of all pieces and keep-outs; `None` without room.
pub(super) fn places<'a>(
    field: &Rect,
    pieces: impl Iterator<Item = &'a [P2]>,
    keep_outs: &[(String, Rect)],
) -> Option<[P2; 2]> {
    let room = field.grown(-(ARM_MM + CLEAR_MM));
    if room.is_empty() {
        return None;
    }
    let reach = (ARM_MM + CLEAR_MM) * std::f64::consts::SQRT_2;
    let boxes: Vec<(Rect, &[P2])> = pieces.map(|p| (Rect::around(p).grown(reach), p)).collect();
    let free = |p: &P2| {
        let around = Rect::EMPTY.with(*p).grown(ARM_MM + CLEAR_MM);
        let holds = |rect: &Rect| rect.overlaps(&around);
        let clear = |(rect, outline): &(Rect, &[P2])| {
            !holds(rect) || !contains(outline, *p) && distance_to_loop(outline, *p) > reach
        };
        boxes.iter().all(clear) && !keep_outs.iter().any(|(_, rect)| holds(rect))
    };
    let count = |extent: f64| (extent / STEP_MM).floor() as u32;
    let (columns, rows) = (count(room.width()), count(room.height()));
    let grid = || (0..=columns).flat_map(|i| (0..=rows).map(move |j| V2::new(f64::from(i), f64::from(j)) * STEP_MM));
    // Opposite corners of the sheet give the best measure of its turn.
    let far = |p: &P2, corner: P2| (p - corner).norm();
    let nearest = |corner: P2, towards: &dyn Fn(V2) -> P2| {
        grid().map(towards).filter(free).min_by(|a, b| far(a, corner).total_cmp(&far(b, corner)))
    };
    let first = nearest(room.min, &|d| room.min + d)?;
    let second = nearest(room.max, &|d| room.max - d)?;
    ((second - first).norm() > 4.0 * ARM_MM).then_some([first, second])
}

/// The strokes of both crosses, engraved, or cut where the tool cannot engrave. The first runs along x: a blade heads along x from then on.
pub(super) fn strokes(places: &[P2; 2], settings: &Settings) -> Vec<Contour> {
    let (process, operation) = match &settings.engrave {
        Some(engrave) => (engrave, Operation::Engrave),
        None => (&settings.cut_inner, Operation::CutInner),
    };
    let constant_power = settings.constant_power(process);
    let stroke = |middle: P2, arm: V2| Contour {
        path: Path::open([middle - arm, middle + arm]),
        operation,
        role: Role::Mark,
        piece: CROSS.into(),
        joint: None,
        feed_mm_per_min: process.feed_mm_per_min,
        power: process.power(),
        constant_power,
        depth_mm: 0.0,
        air: process.air,
        way: Vec::new(),
    };
    let arms = [V2::new(ARM_MM, 0.0), V2::new(0.0, ARM_MM)];
    places.iter().flat_map(|place| arms.map(|arm| stroke(*place, arm))).collect()
}

/// What the crosses are called among the pieces.
pub(super) const CROSS: &str = "cross";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crosses_lie_far_apart_on_scrap_and_off_the_clamps() {
        let sheet = Rect::from_size(297.0, 210.0);
        let piece =
            Path::closed([(10.0, 10.0), (287.0, 10.0), (287.0, 200.0), (10.0, 200.0)].map(|(x, y)| P2::new(x, y)));
        let outline = piece.flatten(0.01);
        let clamp = ("clamp".to_owned(), Rect { min: P2::new(0.0, 0.0), max: P2::new(30.0, 30.0) });
        let [a, b] = places(&sheet, [outline.as_slice()].into_iter(), std::slice::from_ref(&clamp)).unwrap();
        assert!((b - a).norm() > 250.0);
        for p in [a, b] {
            assert!(!contains(&outline, p) && distance_to_loop(&outline, p) > ARM_MM + CLEAR_MM);
            assert!(!clamp.1.overlaps(&Rect::EMPTY.with(p).grown(ARM_MM)));
        }
        let all = Path::closed([(1.0, 1.0), (296.0, 1.0), (296.0, 209.0), (1.0, 209.0)].map(|(x, y)| P2::new(x, y)));
        assert_eq!(places(&sheet, [all.flatten(0.01).as_slice()].into_iter(), &[]), None);
    }
}
