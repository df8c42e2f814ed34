//! What can go wrong in this room: only reading can.

/// Why an SVG could not be read as a drawing.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Not XML at all, or cut short.
    #[error("this is not a complete XML file: {0}. Export the drawing again")]
    Xml(#[from] roxmltree::Error),
    /// Width, height and viewBox do not say that one unit is one millimetre.
    #[error(
        "{place}: the page is not at true size; width and height must be in mm and equal to the viewBox's, as in width=\"600mm\" \
         height=\"400mm\" viewBox=\"0 0 600 400\""
    )]
    NotTrueSize {
        /// Line and column of the root element.
        place: String,
    },
    /// A page whose size in the world is not said.
    #[error(
        "{place}: the page does not say its size; it needs a width in mm, cm or in, and a viewBox, as in width=\"80mm\" viewBox=\"0 0 80 60\""
    )]
    NoSize {
        /// Line and column of the root element.
        place: String,
    },
    /// A shape that cannot be read.
    #[error("{place}: this {element} cannot be used: {what}")]
    Shape {
        /// Line and column.
        place: String,
        /// Element name.
        element: String,
        /// What is wrong.
        what: String,
    },
    /// A transform, which this reader does not apply.
    #[error(
        "{place}: a transform; coordinates must be plain millimetres. Apply the transform in the drawing program, then save again"
    )]
    Transform {
        /// Line and column.
        place: String,
    },
    /// A piece without its name.
    #[error("{place}: a piece without data-name; give it the name it has on the sheet")]
    NoName {
        /// Line and column.
        place: String,
    },
    /// A shape where only a piece's paths may be.
    #[error("{place}: <{element}> here; what is cut must be a <path> in a <g class=\"piece\" data-name=\"...\">")]
    Stray {
        /// Line and column.
        place: String,
        /// Element name.
        element: String,
    },
    /// A class that is no role.
    #[error(
        "{place}: piece \"{piece}\" has a path of class \"{class}\"; classes are outline, flap, slit, hole, mark and label"
    )]
    Class {
        /// Line and column.
        place: String,
        /// Name of the piece.
        piece: String,
        /// The class found.
        class: String,
    },
    /// A word that is no kerf side.
    #[error(
        "{place}: piece \"{piece}\" has a path with data-kerf \"{word}\"; it may be outside, inside, left, right or on"
    )]
    Kerf {
        /// Line and column.
        place: String,
        /// Name of the piece.
        piece: String,
        /// The word found.
        word: String,
    },
    /// Path data that cannot be read.
    #[error("{place}: piece \"{piece}\" has a path whose data cannot be read at character {at}: {what}")]
    PathData {
        /// Line and column of the path.
        place: String,
        /// Name of the piece.
        piece: String,
        /// Bytes from the start of `d`.
        at: usize,
        /// What is wrong there.
        what: String,
    },
}
