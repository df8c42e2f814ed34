//! One thing to cut.

use super::fold::Face;
use super::passage::Passage;
use crate::drawing::Drawing;
use std::ops::Range;

/// One thing to cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Unique name: part letter and number.
    pub name: String,
    /// The part it belongs to.
    pub part: String,
    /// What is cut and engraved: strip frame, or mirrored with x = -s when it is seen from the back.
    pub drawing: Drawing,
    /// The side it is drawn and marked on.
    pub seen_from: Face,
    /// The stretch of the strip it is, mm, splices and end tabs included; the first connection point is at 0.
    pub stations_mm: Range<f64>,
    /// Where it carries flaps and slits, by station, strip frame. A flap folds toward the reader where its face is [`Piece::seen_from`].
    pub passages: Vec<Passage>,
    /// Extent along s, mm.
    pub length_mm: f64,
    /// Extent along w, mm.
    pub width_mm: f64,
    /// Mass, g.
    pub mass_g: f64,
}

impl Piece {
    /// A piece of `part` as it is drawn from the front, with what it carries on its stretch of strip; its size and mass are those of its contour.
    pub(super) fn new(
        name: String,
        part: &str,
        drawing: Drawing,
        (stations_mm, passages): (Range<f64>, Vec<Passage>),
        grammage_g_per_m2: f64,
    ) -> Piece {
        let (bounds, area_mm2) = drawing.outline().map_or_else(Default::default, |o| {
            let bounds = o.bounds();
            ((bounds.width(), bounds.height()), o.signed_area().abs())
        });
        Piece {
            name,
            part: part.to_owned(),
            drawing,
            seen_from: Face::Front,
            stations_mm,
            passages,
            length_mm: bounds.0,
            width_mm: bounds.1,
            mass_g: area_mm2 * 1e-6 * grammage_g_per_m2,
        }
    }
}
