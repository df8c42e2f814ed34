//! Nothing leaves the sheet or the work area.

use super::Error;
use crate::drawing::Role;
use crate::geom::{Path, Rect, tolerance};

/// Checks one run, arcs as far as they bulge, against both boxes.
pub(super) fn check(path: &Path, piece: &str, role: Role, sheet: &Rect, work_area: &Rect) -> Result<(), Error> {
    let bounds = path.bounds();
    for (limit, allowed) in [("sheet", sheet), ("work area", work_area)] {
        let (side, by_mm) = allowed.overrun_by(&bounds);
        if by_mm > tolerance::LIMIT_SLACK_MM {
            return Err(Error::Outside { piece: piece.to_string(), role: role.class(), limit, side, by_mm });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::P2;

    #[test]
    fn an_arc_that_bulges_out_between_good_corners_is_caught() {
        let area = Rect::from_size(100.0, 100.0);
        let circle = Path::circle(P2::new(50.0, 95.0), 10.0);
        let corners_inside = circle.vertices.iter().all(|v| v.point.y <= 100.0);
        assert!(corners_inside);
        let error = check(&circle, "A1", Role::Hole, &area, &area).unwrap_err();
        assert!(matches!(error, Error::Outside { side: "upper", by_mm, .. } if (by_mm - 5.0).abs() < 1e-9));
        assert!(check(&Path::circle(P2::new(50.0, 90.0), 10.0), "A1", Role::Hole, &area, &area).is_ok());
    }

    #[test]
    fn half_a_printed_digit_is_let_pass_and_no_more() {
        let area = Rect::from_size(100.0, 100.0);
        let line = |x| Path::open([P2::new(x, 10.0), P2::new(50.0, 10.0)]);
        assert!(check(&line(-0.0004), "A1", Role::Mark, &area, &area).is_ok());
        assert!(check(&line(-0.0006), "A1", Role::Mark, &area, &area).is_err());
    }
}
