//! Arcs as a line's words give them: by centre or by radius, in any plane (gcode.c and motion_control.c, mc_arc).

use super::Action;
use super::problem::TraceProblem;
use super::words::{Plane, Said};
use crate::geom::{P2, P3, V2, cross};

/// GRBL turns arcs shorter than this into full circles (ARC_ANGULAR_TRAVEL_EPSILON).
const ARC_EPSILON_RAD: f64 = 5e-7;

/// How far chords may leave an arc outside the XY plane: GRBL's default $12, mm.
const CHORD_TOLERANCE_MM: f64 = 0.002;

/// Most chords GRBL cuts an arc into: it counts them in 16 bits.
pub(super) const MAX_CHORDS: f64 = 65_535.0;

/// True when GRBL refuses an arc whose ends lie at these distances from its centre (error 33, gcode.c).
pub(super) fn refuses_arc(start_mm: f64, end_mm: f64) -> bool {
    let difference = (end_mm - start_mm).abs();
    difference > 0.5 || (difference > 0.005 && difference > 0.001 * start_mm)
}

/// Chords GRBL cuts an arc into so that none leaves it by more than `tolerance_mm` ($12): n = theta r / (2 sqrt(e (2 r - e))), rounded
/// down (motion_control.c, mc_arc); at least 1.
pub(super) fn chord_count(radius_mm: f64, sweep_rad: f64, tolerance_mm: f64) -> f64 {
    let half_chord_squared = tolerance_mm * (2.0 * radius_mm - tolerance_mm);
    if half_chord_squared <= 0.0 {
        return 1.0;
    }
    (0.5 * sweep_rad.abs() * radius_mm / half_chord_squared.sqrt()).floor().clamp(1.0, MAX_CHORDS)
}

/// The arc between two points as an [`Action::Arc`] in the coordinates of its plane.
pub(super) fn arc(
    said: &Said,
    plane: Plane,
    from: P3,
    to: P3,
    unit_mm: f64,
    clockwise: bool,
) -> Result<Action, TraceProblem> {
    let (first, second, letters) = axes(plane);
    let in_plane = |axis: usize| said.value(b"XYZ"[axis]).is_some();
    if !said.has_axes() {
        return Err(TraceProblem::NoAxes(super::Word { letter: 'G', value: if clockwise { 2.0 } else { 3.0 } }));
    }
    if !in_plane(first) && !in_plane(second) {
        return Err(TraceProblem::NoArcEnd);
    }
    let flat = |p: P3| P2::new(p[first], p[second]);
    let (from, to) = (flat(from), flat(to));
    let offset = match said.first_of(b"R") {
        Some((word, _)) => centre_by_radius(to - from, word.value * unit_mm, clockwise).map_err(|e| match e {
            ByRadius::SamePlace => TraceProblem::SamePlace,
            ByRadius::TooSmall => TraceProblem::RadiusTooSmall(word),
        })?,
        None => {
            let [i, j] = letters.map(|letter| said.value(letter));
            if i.is_none() && j.is_none() {
                return Err(TraceProblem::NoArcCentre);
            }
            V2::new(i.unwrap_or(0.0), j.unwrap_or(0.0)) * unit_mm
        }
    };
    let center = from + offset;
    let (start, end) = (-offset, to - center);
    let (start_mm, end_mm) = (start.norm(), end.norm());
    if start_mm == 0.0 || refuses_arc(start_mm, end_mm) {
        return Err(TraceProblem::ArcRadius { start_mm, end_mm });
    }
    // mc_arc: the turn from start to end, a full circle when they coincide.
    let mut sweep_rad = cross(start, end).atan2(start.dot(&end));
    if clockwise && sweep_rad >= -ARC_EPSILON_RAD {
        sweep_rad -= std::f64::consts::TAU;
    } else if !clockwise && sweep_rad <= ARC_EPSILON_RAD {
        sweep_rad += std::f64::consts::TAU;
    }
    Ok(Action::Arc { center, radius_mm: start_mm, sweep_rad })
}

/// An arc outside the XY plane as the ends of its chords; the last one is `to`.
pub(super) fn chords(turn: Action, plane: Plane, from: P3, to: P3) -> impl Iterator<Item = P3> {
    let (first, second, _) = axes(plane);
    let (center, radius_mm, sweep_rad) = match turn {
        Action::Arc { center, radius_mm, sweep_rad } => (center, radius_mm, sweep_rad),
        _ => (P2::origin(), 0.0, 0.0),
    };
    let count = chord_count(radius_mm, sweep_rad, CHORD_TOLERANCE_MM);
    let start = P2::new(from[first], from[second]) - center;
    (1..=count as u64).map(move |k| {
        let t = k as f64 / count;
        if t >= 1.0 {
            return to;
        }
        let p = center + nalgebra::Rotation2::new(sweep_rad * t) * start;
        let mut at = from + (to - from) * t;
        (at[first], at[second]) = (p.x, p.y);
        at
    })
}

/// The plane's axes in right-handed order, and the letters of an arc's centre along them.
fn axes(plane: Plane) -> (usize, usize, [u8; 2]) {
    match plane {
        Plane::Xy => (0, 1, *b"IJ"),
        Plane::Zx => (2, 0, *b"KI"),
        Plane::Yz => (1, 2, *b"JK"),
    }
}

enum ByRadius {
    SamePlace,
    TooSmall,
}

/// Centre, from the start, of the arc of a radius over a chord: the smaller turn, or the greater one for a negative radius. The centre lies
/// on the chord's perpendicular bisector, sqrt(r^2 - (d/2)^2) from it.
fn centre_by_radius(chord: V2, radius_mm: f64, clockwise: bool) -> Result<V2, ByRadius> {
    let length = chord.norm();
    if length == 0.0 {
        return Err(ByRadius::SamePlace);
    }
    let height_squared = radius_mm * radius_mm - 0.25 * length * length;
    if height_squared < 0.0 {
        return Err(ByRadius::TooSmall);
    }
    let left = V2::new(-chord.y, chord.x) / length;
    let side = if clockwise != (radius_mm < 0.0) { -1.0 } else { 1.0 };
    Ok(0.5 * chord + left * (side * height_squared.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::super::{Move, parse, trace};
    use super::*;

    fn last(text: &str) -> Move {
        *trace(&parse(text).unwrap()).unwrap().last().unwrap()
    }

    #[test]
    fn an_arc_may_miss_its_circle_by_as_much_as_grbl_lets_pass() {
        assert!(!refuses_arc(10.0, 10.004) && !refuses_arc(100.0, 100.09));
        assert!(refuses_arc(1.0, 1.006) && refuses_arc(1000.0, 1000.6) && !refuses_arc(1000.0, 1000.4));
    }

    #[test]
    fn a_radius_gives_the_short_way_and_a_negative_one_the_long_way() {
        let sweep = |text: &str| match last(text).action {
            Action::Arc { center, sweep_rad, .. } => (center, sweep_rad.to_degrees()),
            other => panic!("{other:?}"),
        };
        for (text, center, degrees) in [
            ("G0X10\nG3X0Y10R10F1", P2::new(0.0, 0.0), 90.0),
            ("G0X10\nG2X0Y10R10F1", P2::new(10.0, 10.0), -90.0),
            ("G0X10\nG3X0Y10R-10F1", P2::new(10.0, 10.0), 270.0),
            ("G0X10\nG2X0Y10R-10F1", P2::new(0.0, 0.0), -270.0),
        ] {
            let (at, turn) = sweep(text);
            assert!((at - center).norm() < 1e-9 && (turn - degrees).abs() < 1e-9, "{text}: {at} {turn}");
        }
    }

    #[test]
    fn arcs_in_other_planes_are_followed_in_chords() {
        // A half circle in the ZX plane from x 0 to x 10, counter-clockwise seen from +y: it rises, or falls when clockwise.
        let moves = trace(&parse("G18G3X10K5I4F100\n").unwrap());
        assert!(moves.is_err(), "the centre lies off the bisector");
        let moves = trace(&parse("G18G2X10I5F100").unwrap()).unwrap();
        assert!(moves.len() > 20 && moves.iter().all(|m| m.action == Action::Line && m.line == 1));
        let length: f64 = moves.iter().map(Move::length_mm).sum();
        assert!((length - 5.0 * std::f64::consts::PI).abs() < 0.01, "{length}");
        let highest = moves.iter().map(|m| m.to.z.abs()).fold(0.0, f64::max);
        assert!((highest - 5.0).abs() < 0.01 && moves[moves.len() - 1].to == P3::new(10.0, 0.0, 0.0));
    }
}
