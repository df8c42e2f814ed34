//! Which layer of a filled part leaves most of the outline empty.

use super::{Part, merit::long_side_mm};
use crate::geom::{P2, signed_area};

/// The outline is sampled at about so many points along its longer side.
const SAMPLES: f64 = 60.0;

/// Layers thick enough to be two of `thickness_mm` each, the one around which most is empty first. What is empty belongs to the layer whose border is nearest.
pub(super) fn emptiest_layers(part: &Part, thickness_mm: f64) -> Vec<usize> {
    let (ruffle, x) = (&part.ruffle, &part.equilibrium.positions);
    let borders: Vec<Vec<P2>> = ruffle
        .layers()
        .iter()
        .map(|layer| ruffle.layer_border(layer).unwrap_or_default().iter().map(|n| x[*n]).collect())
        .collect();
    let mut empty = vec![0usize; borders.len()];
    let bounds = part.outline.bounds();
    let step = bounds.width().max(bounds.height()) / SAMPLES;
    let covered = |p: P2| part.report.covered.iter().filter(|l| crate::geom::contains(l, p)).count() % 2 == 1;
    for row in 0..(bounds.height() / step) as usize {
        for column in 0..(bounds.width() / step) as usize {
            let p = bounds.min + crate::geom::V2::new(column as f64 + 0.5, row as f64 + 0.5) * step;
            if !part.outline.contains(p) || covered(p) {
                continue;
            }
            let away = |border: &[P2]| border.iter().map(|q| (q - p).norm_squared()).fold(f64::INFINITY, f64::min);
            let distances = borders.iter().map(|b| away(b)).enumerate();
            if let Some((nearest, _)) = distances.min_by(|a, b| a.1.total_cmp(&b.1)) {
                empty[nearest] += 1;
            }
        }
    }
    let thick =
        |border: &[P2]| !border.is_empty() && signed_area(border).abs() / long_side_mm(border) >= 2.0 * thickness_mm;
    let mut layers: Vec<usize> = (0..borders.len()).filter(|i| empty[*i] > 0 && thick(&borders[*i])).collect();
    layers.sort_by_key(|i| std::cmp::Reverse(empty[*i]));
    layers
}
