//! Two crosses on a sheet say where it lies.

use std::fmt;

use crate::geom::{P2, Similarity, similarity};

/// How much farther apart, or nearer, crosses may be found than they were planned, mm: what a hand leaves of a dot on a cross twice, and paper
/// that has taken up damp over a sheet's length. More is another cross, or another sheet.
const MOST_STRETCH_MM: f64 = 0.3;

/// How far a sheet may be turned from how the job lies, degrees: one that is laid on by hand against nothing lies straighter, and crosses in the wrong
/// order turn a job by about 180.
const MOST_TURN_DEG: f64 = 15.0;

/// How a job must be laid so that its crosses meet those on the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// From the job's coordinates to work coordinates.
    pub placing: Similarity,
    /// How much farther apart the crosses are than planned, mm.
    pub stretch_mm: f64,
    /// How far the sheet is turned from how the job lies, degrees, counter-clockwise.
    pub turn_deg: f64,
}

/// The crosses do not say where the sheet lies.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum AlignmentError {
    /// Two crosses at the same place.
    #[error("both crosses are at the same place: move the head onto the other one for the second")]
    SamePlace,
    /// They are not as far apart as they should be.
    #[error(
        "the crosses are {found_mm:.2} mm apart on the sheet and {planned_mm:.2} mm in the job; up to {MOST_STRETCH_MM} mm is borne: look whether they are this job's crosses, and come closer to their middles"
    )]
    Stretched {
        /// On the sheet, mm.
        found_mm: f64,
        /// In the job, mm.
        planned_mm: f64,
    },
    /// They are too far from the directions in which they should lie.
    #[error(
        "the sheet would be turned by {turn_deg:.1} degrees, and up to {MOST_TURN_DEG} are borne: the first cross is the one the job has at X{:.1} Y{:.1}, the second the one at X{:.1} Y{:.1}; if they were taken the other way round, give them in the other order, and else lay the sheet on straighter",
        planned[0].x, planned[0].y, planned[1].x, planned[1].y
    )]
    Turned {
        /// How far, counter-clockwise.
        turn_deg: f64,
        /// In the job, mm.
        planned: [P2; 2],
    },
}

impl Alignment {
    /// Lays a job with crosses at `planned` on a sheet with crosses at `found`, both mm.
    ///
    /// # Errors
    /// Crosses at one place, not as far apart as planned, or so far turned that they were likely taken in the wrong order.
    pub fn solve(planned: [P2; 2], found: [P2; 2]) -> Result<Alignment, AlignmentError> {
        let apart = |places: [P2; 2]| (places[1] - places[0]).norm();
        let (planned_mm, found_mm) = (apart(planned), apart(found));
        let placing = similarity(planned, found).ok_or(AlignmentError::SamePlace)?;
        let stretch_mm = found_mm - planned_mm;
        if stretch_mm.abs() > MOST_STRETCH_MM {
            return Err(AlignmentError::Stretched { found_mm, planned_mm });
        }
        let turn_deg = placing.isometry.rotation.angle().to_degrees();
        if turn_deg.abs() > MOST_TURN_DEG {
            return Err(AlignmentError::Turned { turn_deg, planned });
        }
        Ok(Alignment { placing, stretch_mm, turn_deg })
    }
}

impl fmt::Display for Alignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shift = self.placing.isometry.translation.vector;
        let scale = 100.0 * self.placing.scaling();
        write!(
            f,
            "the sheet lies at X{:.3} Y{:.3}, turned {:.3} degrees, at {scale:.3} %",
            shift.x + 0.0,
            shift.y + 0.0,
            self.turn_deg
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crosses_that_are_as_far_apart_as_planned_say_where_the_sheet_lies() {
        let planned = [P2::new(10.0, 10.0), P2::new(280.0, 200.0)];
        let truth = Similarity::new(crate::geom::V2::new(12.0, -3.0), 0.02, 1.0005);
        let solved = Alignment::solve(planned, planned.map(|p| truth * p)).unwrap();
        let p = P2::new(100.0, 50.0);
        assert!((solved.placing * p - truth * p).norm() < 1e-9);
        assert!((solved.stretch_mm - 0.165).abs() < 1e-3);
        assert!(solved.to_string().contains("turned 1.146 degrees, at 100.050 %"), "{solved}");
    }

    #[test]
    fn other_crosses_are_refused_with_both_distances() {
        let planned = [P2::new(0.0, 0.0), P2::new(100.0, 0.0)];
        assert!(Alignment::solve(planned, [P2::new(0.0, 0.0), P2::new(99.71, 0.0)]).is_ok());
        let error = Alignment::solve(planned, [P2::new(0.0, 0.0), P2::new(99.6, 0.0)]).unwrap_err();
        assert!(error.to_string().contains("99.60 mm apart on the sheet and 100.00 mm in the job"), "{error}");
        assert_eq!(Alignment::solve(planned, [P2::new(5.0, 5.0); 2]), Err(AlignmentError::SamePlace));
    }

    #[test]
    fn crosses_in_the_wrong_order_are_refused_and_not_obeyed() {
        let planned = [P2::new(10.0, 10.0), P2::new(280.0, 200.0)];
        let error = Alignment::solve(planned, [planned[1], planned[0]]).unwrap_err().to_string();
        assert!(
            error.contains("by 180.0 degrees") && error.contains("first cross is the one the job has at X10.0 Y10.0")
        );
        assert!(
            error.contains("the second the one at X280.0 Y200.0") && error.contains("in the other order"),
            "{error}"
        );
        let turned = |deg: f64| Similarity::new(crate::geom::V2::new(50.0, 0.0), deg.to_radians(), 1.0);
        let solve = |deg: f64| Alignment::solve(planned, planned.map(|p| turned(deg) * p));
        assert!(solve(-14.9).is_ok_and(|alignment| (alignment.turn_deg + 14.9).abs() < 1e-9));
        assert!(matches!(solve(15.1), Err(AlignmentError::Turned { .. })));
    }
}
