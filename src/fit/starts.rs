//! Drawings to start from.

use super::{Edits, Error, Settings, Target, floor_mm};
use crate::geom::Rect;
use crate::ruffle::{Direction, Drawn, Layering, StackSettings, draw_stack, suited_direction};

/// A drawing and how it was made.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Start {
    pub drawn: Drawn,
    pub direction: Direction,
}

/// Drawings whose nodes lie within this of each other on average, as a share of the outline's size, come to rest as one.
const SAME: f64 = 0.01;

impl Start {
    fn is_like(&self, other: &Start) -> bool {
        let (a, b) = (&self.drawn.positions, &other.drawn.positions);
        if a.len() != b.len() || self.direction != other.direction {
            return false;
        }
        let apart = a.iter().zip(b).map(|(a, b)| (a - b).norm()).sum::<f64>() / a.len() as f64;
        let bounds = Rect::around(a);
        apart <= SAME * (bounds.width() * bounds.height()).sqrt()
    }
}

/// Layerings that are tried, in this order. Outlines differ in which they like (measured over eleven of them).
const LAYERINGS: [Layering; 9] = [
    Layering::Chords { aspect: 0.35 },
    Layering::Packed { min_aspect: 0.16 },
    Layering::Chords { aspect: 0.22 },
    Layering::Packed { min_aspect: 0.0 },
    Layering::Chords { aspect: 0.28 },
    Layering::Packed { min_aspect: 0.22 },
    Layering::Chords { aspect: 0.18 },
    Layering::Packed { min_aspect: 0.30 },
    Layering::Chords { aspect: 0.45 },
];

/// Outlines of this size (the root of their area, mm) are drawn as the settings say; larger ones with thicker layers and longer segments, so that they have no more of
/// either.
const USUAL_SIZE_MM: f64 = 100.0;
/// Segments grow from this size on,
const FULL_DETAIL_MM: f64 = 110.0;
/// and are shorter in smaller outlines, down to this share: their loops bend as many times as tightly.
const FINEST: f64 = 0.6;

/// Drawings in the direction asked for. A layering that finds no place, or that the edits do not apply to, is passed over as long as another does.
pub(super) fn starts(target: &Target, settings: &Settings, edits: Option<&Edits>) -> Result<Vec<Start>, Error> {
    let directions = match settings.direction.unwrap_or_else(|| suited_direction(target.outline)) {
        // What looks like a bow may fill as well in straight layers.
        Direction::AlongCurve if settings.direction.is_none() => vec![Direction::AlongCurve, Direction::Vertical],
        direction => vec![direction],
    };
    let mut starts: Vec<Start> = Vec::new();
    let mut refused: Option<Error> = None;
    let mut layers = settings.stack.layers;
    let size_mm = target.outline.area().sqrt();
    let larger = (size_mm / USUAL_SIZE_MM).max(1.0);
    let detail = (size_mm / FULL_DETAIL_MM).max((size_mm / USUAL_SIZE_MM).clamp(FINEST, 1.0));
    let stack = StackSettings {
        min_layer_mm: settings.stack.min_layer_mm.max(larger * StackSettings::default().min_layer_mm),
        max_layer_mm: settings.stack.max_layer_mm * larger,
        min_rung_mm: settings.stack.min_rung_mm.max(settings.min_section_mm),
        segment_mm: settings.stack.segment_mm * detail,
        ..settings.stack
    };
    let ways = directions.iter().flat_map(|direction| LAYERINGS.map(|layering| (*direction, layering)));
    for (direction, layering) in ways {
        match start(target, &StackSettings { direction, layering, layers, ..stack }, edits) {
            Ok((drawn, drawn_layers)) => {
                layers = layers.or(edits.map(|_| drawn_layers));
                let start = Start { drawn, direction };
                if !starts.iter().any(|other| other.is_like(&start)) {
                    starts.push(start);
                }
            }
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    match refused {
        Some(error) if starts.is_empty() => Err(error),
        _ => Ok(starts),
    }
}

/// One drawing with its edits, on the floor, and its number of layers before them.
fn start(target: &Target, settings: &StackSettings, edits: Option<&Edits>) -> Result<(Drawn, usize), Error> {
    let drawn =
        draw_stack(target.outline, settings).map_err(|source| Error::Stack { part: target.name.into(), source })?;
    let layers = drawn.ruffle.layers().len();
    let mut drawn = match edits {
        Some(edits) => edits.edited(&drawn).map_err(|source| Error::Edit { part: target.name.into(), source })?,
        None => drawn,
    };
    let drop = target.outline.bounds().min.y - floor_mm(target.outline);
    drawn.positions.iter_mut().for_each(|p| p.y -= drop);
    Ok((drawn, layers))
}
