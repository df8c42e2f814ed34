//! The default stack of loops (paper section 3.1, figures 6 and 10), drawn into an outline.
//!
//! A stack is a ladder of rungs, bottom to top. The strip runs along rung 0, and then for each layer: right loop up to the next rung, diagonal
//! back down to the left, left loop up, straight along the next rung.
//!
//! ```text
//!      L1 ______________ R1
//!       /          __---  \        rung 0: L0 -> R0
//!      (      __---        )       right loop R0 -> R1, diagonal R1 -> L0,
//!       \__---____________/        left loop L0 -> L1, rung 1: L1 -> R1
//!      L0                R0
//! ```

use super::direction::{Direction, unrolled};
use super::ladder::{Drawing, Slab, thread_slabs};
use super::{Ruffle, chords, packed};
use crate::cut::Outline;
use crate::geom::P2;

/// How the outline is divided into layers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Layering {
    /// Layer heights follow the outline's width, each slab as wide as the outline is there.
    Chords {
        /// Layer height over width. 0.35 is the ratio at which neither loops collapse nor corners stay empty (measured over ten outlines: square,
        /// circle, triangle, L, hourglass and the like).
        aspect: f64,
    },
    /// The rectangles that together fill most, by dynamic programming: snaps to steps and shoulders, spans gaps between feet, passes ears by.
    Packed {
        /// Least layer height over width: long thin layers sag onto one another.
        min_aspect: f64,
    },
}

/// How a stack is drawn into an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StackSettings {
    /// Which way layers lie on each other.
    pub direction: Direction,
    /// How the outline is divided.
    pub layering: Layering,
    /// Number of layers; `None` chooses it from the outline.
    pub layers: Option<usize>,
    /// Thinnest layer, mm.
    pub min_layer_mm: f64,
    /// Thickest layer, mm; where the outline is wide it may be exceeded if few layers are asked for.
    pub max_layer_mm: f64,
    /// Shortest rung, mm: a flap's neck with room at both sides.
    pub min_rung_mm: f64,
    /// Length of a segment, mm, about: sections are divided evenly.
    pub segment_mm: f64,
}

impl Default for StackSettings {
    fn default() -> Self {
        StackSettings {
            direction: Direction::Vertical,
            layering: Layering::Chords { aspect: 0.35 },
            layers: None,
            min_layer_mm: 12.0,
            max_layer_mm: 45.0,
            min_rung_mm: 10.0,
            segment_mm: 3.0,
        }
    }
}

/// Narrower than this, in mm, an outline holds no layer.
pub(super) const MIN_CHORD_MM: f64 = 20.0;

/// Why no stack could be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StackError {
    /// The outline is too small anywhere.
    #[error(
        "the outline, {width_mm:.1} x {height_mm:.1} mm, has no place for a layer {min_layer_mm:.0} mm high and {min_chord_mm:.0} mm wide; make the shape larger (--height-mm)"
    )]
    TooSmall {
        /// Width of the outline.
        width_mm: f64,
        /// Height of the outline.
        height_mm: f64,
        /// Least layer height.
        min_layer_mm: f64,
        /// Least width.
        min_chord_mm: f64,
    },
    /// An outline without a line to follow.
    #[error("the outline has no middle line that layers could follow; stack them vertically or horizontally")]
    NoCurve,
    /// A layer count that does not fit.
    #[error(
        "{layers} layers do not go into an outline {height_mm:.1} mm high: a layer is at least {min_layer_mm:.0} mm, or its loops crease and nobody reaches the flaps. At most {most} fit"
    )]
    LayerCount {
        /// Asked for.
        layers: usize,
        /// Usable height.
        height_mm: f64,
        /// Least layer height.
        min_layer_mm: f64,
        /// Largest count that works.
        most: usize,
    },
}

/// A ruffle and the drawing of it that a solver may start from.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Topology and rest lengths.
    pub ruffle: Ruffle,
    /// Position of every node, plane frame, mm.
    pub positions: Vec<P2>,
}

/// Draws a stack of layers into `outline`.
pub fn draw_stack(outline: &Outline, settings: &StackSettings) -> Result<Drawn, StackError> {
    let unrolled = unrolled(outline, settings.direction)?;
    let slabs: Vec<Slab> = match settings.layering {
        Layering::Chords { aspect } => chords::slabs(&unrolled.outline, aspect, settings)?,
        Layering::Packed { min_aspect } => packed::slabs(&unrolled.outline, min_aspect, settings)?,
    };
    let drawing = Drawing { segment_mm: settings.segment_mm, min_rung_mm: settings.min_rung_mm };
    Ok(thread_slabs(&slabs, drawing, &unrolled.place))
}

/// The error for an outline that holds no layer.
pub(super) fn too_small(outline: &Outline, settings: &StackSettings) -> StackError {
    let bounds = outline.bounds();
    StackError::TooSmall {
        width_mm: bounds.width(),
        height_mm: bounds.height(),
        min_layer_mm: settings.min_layer_mm,
        min_chord_mm: MIN_CHORD_MM,
    }
}

/// The error for a layer count that does not fit into `height_mm`.
pub(super) fn layer_count(layers: usize, most: usize, height_mm: f64, settings: &StackSettings) -> StackError {
    StackError::LayerCount { layers, height_mm, min_layer_mm: settings.min_layer_mm, most }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn polygon(points: &[(f64, f64)]) -> Outline {
        Outline { outer: points.iter().map(|(x, y)| P2::new(*x, *y)).collect(), holes: Vec::new() }
    }

    fn rectangle(width: f64, height: f64) -> Outline {
        polygon(&[(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)])
    }

    #[test]
    fn a_stack_of_n_layers_has_4n_plus_1_sections_and_2n_connection_points() {
        for layers in 1..=5 {
            let settings = StackSettings { layers: Some(layers), ..StackSettings::default() };
            let drawn = draw_stack(&rectangle(100.0, 100.0), &settings).unwrap();
            drawn.ruffle.check().unwrap();
            assert_eq!(drawn.ruffle.sections.len(), 4 * layers + 1);
            assert_eq!(drawn.ruffle.connection_points().len(), 2 * layers);
        }
    }

    #[test]
    fn the_drawing_has_the_rest_lengths_to_within_its_chords() {
        let drawn = draw_stack(&rectangle(100.0, 100.0), &StackSettings::default()).unwrap();
        for (k, (i, j)) in drawn.ruffle.segments().enumerate() {
            let length = (drawn.positions[j] - drawn.positions[i]).norm();
            let rest = drawn.ruffle.rest_lengths[k];
            assert!((length / rest - 1.0).abs() < 0.02, "segment {k}: {length} against {rest}");
        }
    }

    #[test]
    fn the_first_rung_lies_on_the_floor_and_loops_touch_the_sides() {
        let drawn = draw_stack(&rectangle(100.0, 100.0), &StackSettings::default()).unwrap();
        let bounds = crate::geom::Rect::around(&drawn.positions);
        assert!(bounds.min.y.abs() < 1e-9 && (bounds.max.y - 100.0).abs() < 1e-9);
        assert!(bounds.min.x.abs() < 1.5 && (bounds.max.x - 100.0).abs() < 1.5, "{bounds:?}");
    }

    #[test]
    fn layers_are_thinner_where_the_outline_is_narrower() {
        let drawn =
            draw_stack(&polygon(&[(0.0, 0.0), (111.0, 0.0), (55.5, 100.0)]), &StackSettings::default()).unwrap();
        let ends: Vec<f64> =
            drawn.ruffle.connection_points().iter().map(|c| drawn.positions[c.node.index()].y).collect();
        let bottom = ends[1] - ends[0];
        let top = ends[ends.len() - 1] - ends[ends.len() - 3];
        assert!(top < bottom, "{ends:?}");
    }

    #[test]
    fn an_outline_without_room_is_refused_with_its_size() {
        let error = draw_stack(&rectangle(15.0, 9.0), &StackSettings::default()).unwrap_err();
        assert!(error.to_string().contains("15.0 x 9.0"), "{error}");
        let settings = StackSettings { layers: Some(20), ..StackSettings::default() };
        let error = draw_stack(&rectangle(100.0, 100.0), &settings).unwrap_err();
        assert!(error.to_string().contains("At most 8"), "{error}");
    }

    proptest! {
        #[test]
        fn any_stack_passes_its_check_and_starts_without_crossings(
            bottom in 40.0..150.0f64, top in 40.0..150.0f64, height in 30.0..200.0f64, aspect in 0.2..0.6f64, packed in any::<bool>(),
        ) {
            let layering =
                if packed { Layering::Packed { min_aspect: aspect / 2.0 } } else { Layering::Chords { aspect } };
            let outline = polygon(&[(-bottom / 2.0, 0.0), (bottom / 2.0, 0.0), (top / 2.0, height), (-top / 2.0, height)]);
            let settings = StackSettings { layering, ..StackSettings::default() };
            let Ok(drawn) = draw_stack(&outline, &settings) else {
                // Layers thinner than the aspect allows are refused, and only those.
                let thickest = settings.max_layer_mm.min(height);
                prop_assert!(packed && thickest < aspect / 2.0 * bottom.max(top) + 1.0);
                return Ok(());
            };
            prop_assert!(drawn.ruffle.check().is_ok());
            let segments: Vec<(P2, P2)> =
                drawn.ruffle.segments().map(|(i, j)| (drawn.positions[i], drawn.positions[j])).collect();
            for (a, s) in segments.iter().enumerate() {
                for t in &segments[a + 1..] {
                    prop_assert!(!crate::geom::segments_cross(s.0, s.1, t.0, t.1));
                }
            }
        }
    }
}
