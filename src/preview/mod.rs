//! Pictures for people: the folded ruffle in its outline, and what the machine will do to a sheet. As SVG and as PNG, both from one
//! [`Canvas`], so that they cannot differ; and as an HTML page that plays a program at the machine's own speed.

mod canvas;
mod come_canvas;
mod html;
mod pack;
mod part;
mod png;
mod run;
mod run_canvas;
mod shade;
mod sheet;
mod svg;

pub use canvas::{Align, Canvas, Colour, Stroke, Text};
pub use come_canvas::{Come, come_canvas};
pub use html::{MAX_MOVES, html};
pub use part::{PartView, part_canvas};
pub use run::{Bed, GrainRun, Run, Stock};
pub use run_canvas::{flattened, run_canvas};
pub use shade::ColorBy;
pub use sheet::{MoveKind, Pen, SheetMove, SheetView, sheet_canvas};

/// Why a picture could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Nothing to show, or a size that is no number.
    #[error("a picture of {width_mm} mm by {height_mm} mm has no area; give it something to show")]
    NoArea {
        /// Width of the canvas, mm.
        width_mm: f64,
        /// Height of the canvas, mm.
        height_mm: f64,
    },
    /// More pixels than fit in memory comfortably, or none.
    #[error(
        "a PNG of {width_px} x {height_px} pixels was asked for; each side can have 1 to {limit_px}. Ask for a smaller one, or for SVG"
    )]
    Size {
        /// Width asked for.
        width_px: u32,
        /// Height that follows.
        height_px: u32,
        /// The most a side may have.
        limit_px: u32,
    },
    /// More moves than a browser shows without stuttering.
    #[error(
        "an HTML preview of {moves} moves was asked for; it holds up to {limit}. Ask for a picture (--out FILE.png or FILE.svg shows all of them), or split the program"
    )]
    TooManyMoves {
        /// In all programs together.
        moves: usize,
        /// The most there may be.
        limit: usize,
    },
    /// The encoder failed.
    #[error("the PNG could not be encoded: {0}")]
    Encode(String),
}
