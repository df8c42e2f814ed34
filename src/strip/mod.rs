//! Lays a fitted part flat: the pieces that are cut, with flaps, slits, splices and labels.
//!
//! Strip frame: s along the strip from its first connection point, w across (the plane's normal), mm. The front is the side that is then seen, on the right hand of one
//! who walks along the strip; the first loop shows it outward. Pieces are drawn from the front unless that would spoil a face that is to stay clean.
//!
//! ```text
//! Part -> edges -> passages (fold, seats) -> splices -> per piece: contour, cuts, marks, labels
//! ```

mod base_card;
mod connector;
mod cutting;
mod divide;
mod dovetail;
mod edge;
mod error;
mod fasten;
mod fold;
mod hold;
mod joint;
mod label;
mod lap;
mod lettering;
mod mating;
mod mirror;
mod passage;
mod piece;
mod seats;
mod shape;
mod splice;
mod told;
mod visible;

pub use base_card::base_card;
pub use connector::{Connector, PartJoint, connector, nearest_joints};
pub use error::Error;
pub use fold::Face;
pub use hold::Hold;
pub use joint::{Dashes, Fastening, Joint};
pub use lettering::Labels;
pub use passage::{Half, Passage, Seat};
pub use piece::Piece;
pub use splice::{Splice, SpliceKind, SpliceSettings};

use crate::fit::Part;
use crate::progress::Warning;
use cutting::Cutting;
use edge::Edges;

/// How strips are made into pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// The joint, nominal.
    pub joint: Joint,
    /// Full width that the tool removes, mm: it decides how well the joint holds. Drawings stay nominal.
    pub kerf_mm: f64,
    /// Longest piece that fits the stock, mm.
    pub max_piece_mm: f64,
    /// How pieces of one strip are joined.
    pub splice: SpliceSettings,
    /// How pieces are labelled.
    pub labels: Labels,
    /// Whether the outside of the folded object stays free of marks.
    pub clean_outside: bool,
    /// Mass per area, g/m².
    pub grammage_g_per_m2: f64,
}

/// All pieces of one part and how well their joints are defined.
#[derive(Debug, Clone, PartialEq)]
pub struct Pieces {
    /// In strip order.
    pub pieces: Vec<Piece>,
    /// How each piece is joined to the next.
    pub splices: Vec<Splice>,
    /// Largest distance between where a flap's root finds its slit and where it should, from the drawn cuts, mm.
    pub max_mating_error_mm: f64,
    /// Labels that cross a cut or another label.
    pub label_collisions: usize,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// Lays `part` flat and divides it into pieces. `tied` are the numbers of its joints that [`connector`]s lie in, once for each.
///
/// # Errors
/// A joint that would fall open or not close with this kerf and thickness; a strip that cannot be divided for the stock.
pub fn pieces(part: &Part, tied: &[u32], settings: &Settings) -> Result<Pieces, Error> {
    settings.joint.check(settings.kerf_mm)?;
    let edges = Edges::new(part, settings.joint.end_tab_mm);
    let (passages, warnings) = fasten::passages(part, &edges, &settings.joint, tied);
    let whole = edges.range();
    let spots = if edges.length_mm() <= settings.max_piece_mm {
        Vec::new()
    } else {
        splice::Places { part, edges: &edges, passages: &passages, settings }.spots()
    };
    let used = divide::divide(&spots, whole, settings.max_piece_mm).map_err(|(from_mm, to_mm)| {
        Error::NoRoomForSplice { part: part.name.clone(), from_mm, to_mm, max_piece_mm: settings.max_piece_mm }
    })?;
    Ok(Cutting { part, edges: &edges, tied, settings, spots: &used }.cut(passages, warnings))
}

#[cfg(test)]
mod tests;
