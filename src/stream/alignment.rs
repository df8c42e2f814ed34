//! Two crosses on a sheet say where it lies.

use std::fmt;

use crate::geom::{P2, Similarity, similarity};

/// How much farther apart, or nearer, crosses may be found than they were planned, mm: what a hand leaves of a dot on a cross twice, and paper
/// that has taken up damp over a sheet's length. More is another cross, or another sheet.
const MOST_STRETCH_MM: f64 = 0.3;

/// How a job must be laid so that its crosses meet those on the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// From the job's coordinates to work coordinates.
    pub placing: Similarity,
    /// How much farther apart the crosses are than planned, mm.
    pub stretch_mm: f64,
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
}

impl Alignment {
    /// Lays a job with crosses at `planned` on a sheet with crosses at `found`, both mm.
    ///
    /// # Errors
    /// Crosses at one place, or not as far apart as planned.
    pub fn solve(planned: [P2; 2], found: [P2; 2]) -> Result<Alignment, AlignmentError> {
        let apart = |places: [P2; 2]| (places[1] - places[0]).norm();
        let (planned_mm, found_mm) = (apart(planned), apart(found));
        let placing = similarity(planned, found).ok_or(AlignmentError::SamePlace)?;
        let stretch_mm = found_mm - planned_mm;
        if stretch_mm.abs() > MOST_STRETCH_MM {
            return Err(AlignmentError::Stretched { found_mm, planned_mm });
        }
        Ok(Alignment { placing, stretch_mm })
    }
}

impl fmt::Display for Alignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shift = self.placing.isometry.translation.vector;
        let turn = self.placing.isometry.rotation.angle().to_degrees();
        let scale = 100.0 * self.placing.scaling();
        write!(
            f,
            "the sheet lies at X{:.3} Y{:.3}, turned {turn:.3} degrees, at {scale:.3} %",
            shift.x + 0.0,
            shift.y + 0.0
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
        assert!(Alignment::solve(planned, [P2::new(0.0, 0.0), P2::new(0.0, 99.71)]).is_ok());
        let error = Alignment::solve(planned, [P2::new(0.0, 0.0), P2::new(0.0, 99.6)]).unwrap_err();
        assert!(error.to_string().contains("99.60 mm apart on the sheet and 100.00 mm in the job"), "{error}");
        assert_eq!(Alignment::solve(planned, [P2::new(5.0, 5.0); 2]), Err(AlignmentError::SamePlace));
    }
}
