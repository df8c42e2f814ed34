//! Nothing leaves the sheet or the work area.

use super::{Contour, Error, Settings, Zero};
use crate::geom::{Rect, V2, tolerance};

/// Checks all runs, arcs as far as they bulge, against the sheet (in the work frame) and the work area. Where the user places the job by hand, nobody
/// knows where it lies, and only its size can be checked.
pub(super) fn check(contours: &[Contour], sheet: &Rect, settings: &Settings) -> Result<(), Error> {
    let mut allowed = vec![("work area", settings.work_area)];
    match settings.frame.zero {
        // The axis of a blade leads its tip: it may lie that far off the sheet.
        Zero::Sheet(_) => allowed.insert(0, ("sheet", sheet.grown(settings.blade_mm()))),
        Zero::Job(_) => {
            let least = contours.iter().fold(Rect::EMPTY, |rect, c| rect.union(c.path.bounds())).min;
            let size = V2::new(settings.work_area.width(), settings.work_area.height());
            allowed[0].1 = Rect { min: least, max: least + size };
        }
    }
    for contour in contours {
        let bounds = contour.path.bounds();
        for (limit, rect) in &allowed {
            let (side, by_mm) = rect.overrun_by(&bounds);
            if by_mm > tolerance::LIMIT_SLACK_MM {
                let (piece, role) = (contour.piece.clone(), contour.role.class());
                return Err(Error::Outside { piece, role, limit, side, by_mm });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::tests::{contour, settings};
    use super::super::{Anchor, Frame};
    use super::*;
    use crate::drawing::Role;
    use crate::geom::{P2, Path};

    const SHEET: Rect = Rect { min: P2::new(0.0, 0.0), max: P2::new(100.0, 100.0) };

    fn judged(path: Path) -> Result<(), Error> {
        check(&[contour(path, Role::Hole)], &SHEET, &Settings { work_area: SHEET, ..settings() })
    }

    #[test]
    fn an_arc_that_bulges_out_between_good_corners_is_caught() {
        let circle = Path::circle(P2::new(50.0, 95.0), 10.0);
        assert!(circle.vertices.iter().all(|v| v.point.y <= 100.0), "its corners lie inside");
        let error = judged(circle).unwrap_err();
        assert!(matches!(error, Error::Outside { side: "upper", by_mm, .. } if (by_mm - 5.0).abs() < 1e-9));
        assert!(judged(Path::circle(P2::new(50.0, 90.0), 10.0)).is_ok());
    }

    #[test]
    fn half_a_printed_digit_is_let_pass_and_no_more() {
        let line = |x| Path::open([P2::new(x, 10.0), P2::new(50.0, 10.0)]);
        assert!(judged(line(-0.0004)).is_ok());
        assert!(judged(line(-0.0006)).is_err());
    }

    #[test]
    fn a_job_placed_by_hand_is_only_too_large_never_out_of_place() {
        let by_hand = |width: f64| {
            let frame = Frame { zero: Zero::Job(Anchor { x: 1.0, y: 0.5 }), ..Frame::PLAIN };
            let settings = Settings { work_area: SHEET, frame, ..settings() };
            let line = Path::open([P2::new(-width, -5.0), P2::new(0.0, 5.0)]);
            check(&[contour(line, Role::Slit)], &SHEET, &settings)
        };
        assert!(by_hand(99.0).is_ok());
        assert!(matches!(by_hand(101.0), Err(Error::Outside { limit: "work area", .. })));
    }
}
