//! Why a plane gives no outline.

/// A plane that gives no outline.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The plane passes beside the mesh, or through a gap in it.
    #[error("the plane does not meet the mesh; move it along its normal by {} mm to hit", ranges(.hits))]
    Misses {
        /// Offsets along the normal, from the plane as given, at which the mesh is met: mm, ascending.
        hits: Vec<(f64, f64)>,
    },
    /// The plane touches the mesh without enclosing an area worth filling.
    #[error(
        "the cut encloses only {area_mm2:.3} mm2, under the limit of {min_area_mm2} mm2; move the plane further into the body, or scale the mesh up"
    )]
    TooSmall {
        /// Area of the largest region found, mm^2.
        area_mm2: f64,
        /// The limit, mm^2.
        min_area_mm2: f64,
    },
    /// The normal has no direction, or a number is not finite.
    #[error(
        "the plane's origin and normal must be finite and the normal longer than 0; got origin {origin:?}, normal {normal:?}"
    )]
    BadPlane {
        /// The point given, mm.
        origin: [f64; 3],
        /// The normal given.
        normal: [f64; 3],
    },
    /// There is nothing to cut.
    #[error("the mesh has no triangles; load one with faces")]
    EmptyMesh,
}

fn ranges(hits: &[(f64, f64)]) -> String {
    hits.iter().map(|(lo, hi)| format!("{lo:.2} to {hi:.2}")).collect::<Vec<_>>().join(", or ")
}
