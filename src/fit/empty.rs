//! Which layer of a filled part leaves most of the outline empty.

use super::Part;
use crate::geom::{P2, V2, contains, signed_area, thickness};

/// The outline is sampled at about so many points along its longer side.
const SAMPLES: f64 = 60.0;

/// Points of the outline, evenly spread, that the strip does not go round.
fn empty_points(part: &Part) -> Vec<P2> {
    let bounds = part.outline.bounds();
    let step = bounds.width().max(bounds.height()) / SAMPLES;
    let covered = |p: P2| part.report.covered.iter().filter(|l| contains(l, p)).count() % 2 == 1;
    let rows = 0..(bounds.height() / step) as usize;
    let columns = 0..(bounds.width() / step) as usize;
    let points = rows.flat_map(|row| columns.clone().map(move |column| V2::new(column as f64 + 0.5, row as f64 + 0.5)));
    points.map(|at| bounds.min + at * step).filter(|p| part.outline.contains(*p) && !covered(*p)).collect()
}

/// Of the layers thick enough to be two of `thickness_mm` each, the one around which most is empty. What is empty belongs to the layer whose border is nearest.
pub(super) fn emptiest_layer(part: &Part, thickness_mm: f64) -> Option<usize> {
    let (ruffle, x) = (&part.ruffle, &part.equilibrium.positions);
    let borders: Vec<Vec<P2>> = ruffle
        .layers()
        .iter()
        .map(|layer| ruffle.layer_border(layer).unwrap_or_default().iter().map(|n| x[*n]).collect())
        .collect();
    let mut empty = vec![0usize; borders.len()];
    for p in empty_points(part) {
        let away = |border: &Vec<P2>| border.iter().map(|q| (q - p).norm_squared()).fold(f64::INFINITY, f64::min);
        let distances = borders.iter().map(away).enumerate();
        if let Some((nearest, _)) = distances.min_by(|a, b| a.1.total_cmp(&b.1)) {
            empty[nearest] += 1;
        }
    }
    let thick =
        |border: &[P2]| !border.is_empty() && thickness(signed_area(border).abs(), border) >= 2.0 * thickness_mm;
    let worth_it = |i: &usize| empty[*i] > 0 && thick(&borders[*i]);
    (0..borders.len()).filter(worth_it).max_by_key(|i| empty[*i])
}
