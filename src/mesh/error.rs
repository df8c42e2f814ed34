//! Why a file does not become a mesh.

/// A file that cannot be used as a mesh. Every message names the file, the place in it where there is one, and the way out.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The operating system would not hand the file over.
    #[error("{name}: cannot be read: {source}")]
    Read {
        /// The file.
        name: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The extension is not one we read.
    #[error("{name}: not a mesh format furbelow reads; export the shape as .obj or .stl")]
    UnknownFormat {
        /// The file.
        name: String,
    },
    /// The file is longer than the limit.
    #[error("{name}: longer than the limit of {limit} bytes; simplify (decimate) the mesh first")]
    TooLarge {
        /// The file.
        name: String,
        /// The longest that is read.
        limit: u64,
    },
    /// The file holds more triangles than the limit.
    #[error("{name}: more than {limit} triangles; simplify (decimate) the mesh to under {limit} first")]
    TooManyFaces {
        /// The file.
        name: String,
        /// The most that is read.
        limit: usize,
    },
    /// The file breaks its format, or ends too soon.
    #[error("{name}{place}: {what}; export the file again or repair this place")]
    Syntax {
        /// The file.
        name: String,
        /// Where, ready to follow the name: ":17" or ", byte 1084". May be empty.
        place: String,
        /// What is wrong there.
        what: String,
    },
    /// Nothing to cut in the file.
    #[error(
        "{name}: holds no faces; it may be empty, a point cloud, curves only, or not a mesh at all. Export a surface with faces"
    )]
    NoFaces {
        /// The file.
        name: String,
    },
    /// The mesh has no volume.
    #[error(
        "{name}: the mesh is flat: {x} x {y} x {z} file units; a ruffle needs a body with an extent along all three axes"
    )]
    Flat {
        /// The file.
        name: String,
        /// Extent along x, file units.
        x: f64,
        /// Extent along y, file units.
        y: f64,
        /// Extent along z, file units.
        z: f64,
    },
    /// Without a given height, the file's own numbers taken as mm make no sense.
    #[error("{name}: {height_mm} mm high if its unit is mm, which is {}; say how high it should be: {suggestions}", if *too_small { "under 10 mm".to_string() } else { format!("over {limit_mm} mm, five times the machine's bed") })]
    Height {
        /// The file.
        name: String,
        /// Height when a file unit is a mm.
        height_mm: f64,
        /// Under the lower limit, not over the upper.
        too_small: bool,
        /// The upper limit, mm.
        limit_mm: f64,
        /// Ready to read: what to type for each likely unit.
        suggestions: String,
    },
    /// The height asked for is not one.
    #[error("height {height_mm} mm is not usable; give a number above 0 and up to {limit_mm}")]
    BadHeight {
        /// What was asked for, mm.
        height_mm: f64,
        /// The most that is taken, mm.
        limit_mm: f64,
    },
    /// Coordinates or extents beyond all reason.
    #[error(
        "{name}: {what} is beyond the limit of {limit} {unit}; check the file for stray points, or give a smaller --height-mm"
    )]
    Gigantic {
        /// The file.
        name: String,
        /// What is too large, with its value.
        what: String,
        /// The limit.
        limit: f64,
        /// Unit of the limit.
        unit: &'static str,
    },
}
