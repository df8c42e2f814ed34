//! How much of an outline is empty and how much sticks out, as a smooth function of where a strip's border lies.
//!
//! Both are the integral over what the border goes round of a field: -1 inside the outline, the weight of protrusion outside. With the field's integral G along u,
//! that is the integral of G dv along the border (Green), and its change is the field times how far each stretch of border moves outward. At the outline itself the
//! field rises over a fraction of a millimetre: a jump there would bring every descent to a halt as soon as one loop touches.

use super::faces::sides;
use crate::cut::Outline;
use crate::geom::{P2, V2, distance_to_segment};

/// The field rises over this share of the outline's size (the root of its area) to either side of it: 0.4 mm of 100.
const BLUR: f64 = 0.004;
/// Grid cells in half that rise.
const CELLS_IN_BLUR: f64 = 2.0;
/// The grid goes on for this share of the outline's size around it. Beyond, the field is what it is at the edge of the grid.
const AROUND: f64 = 0.3;
/// Points at which each side of a border is sampled.
const SAMPLES: usize = 24;
/// Sides of the outline that lie this near to the floor, as a share of the size, are no border: the strip is meant to lie there.
const ON_FLOOR: f64 = 1e-3;

/// The field of an outline, bilinear on a grid.
#[derive(Debug, Clone)]
pub(super) struct Field {
    pub area_mm2: f64,
    corner: P2,
    cell_mm: f64,
    columns: usize,
    rows: usize,
    /// Field at the grid's points, by rows.
    values: Vec<f64>,
    /// Its integral along the row up to there.
    sums: Vec<f64>,
}

impl Field {
    /// The field of `outline` where a protruding square millimetre costs `protrusion_weight` empty ones.
    pub fn new(outline: &Outline, protrusion_weight: f64) -> Field {
        let area_mm2 = outline.area();
        let size = area_mm2.sqrt();
        let (blur, cell_mm) = (BLUR * size, BLUR * size / CELLS_IN_BLUR);
        let bounds = outline.bounds();
        let floor = bounds.min.y + ON_FLOOR * size;
        let around = bounds.grown(AROUND * size);
        let count = |extent: f64| (extent / cell_mm).ceil() as usize + 1;
        let (columns, rows) = (count(around.width()), count(around.height()));
        let at = |column: usize, row: usize| around.min + V2::new(column as f64, row as f64) * cell_mm;

        // Distance to the border, as far as it matters.
        let mut distance = vec![blur; columns * rows];
        for (a, b) in outline.loops().flat_map(|l| (0..l.len()).map(|i| (l[i], l[(i + 1) % l.len()]))) {
            if a.y <= floor && b.y <= floor {
                continue;
            }
            let index = |value: f64, low: f64, most: usize| (((value - low) / cell_mm).max(0.0) as usize).min(most - 1);
            let (low, high) = (a.inf(&b) - V2::repeat(blur), a.sup(&b) + V2::repeat(blur + cell_mm));
            for row in index(low.y, around.min.y, rows)..=index(high.y, around.min.y, rows) {
                for column in index(low.x, around.min.x, columns)..=index(high.x, around.min.x, columns) {
                    let d = &mut distance[row * columns + column];
                    *d = d.min(distance_to_segment(at(column, row), a, b));
                }
            }
        }
        let mut values = Vec::with_capacity(columns * rows);
        let mut sums = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            // Below the floor there is nothing to keep clear of.
            let chords = outline.chords((around.min.y + row as f64 * cell_mm).max(floor));
            let mut sum = 0.0;
            for column in 0..columns {
                let u = at(column, row).x;
                let inside = chords.iter().any(|(left, right)| (*left..*right).contains(&u));
                let share = 0.5 * distance[row * columns + column] / blur;
                let outside = if inside { 0.5 - share } else { 0.5 + share };
                let value = (1.0 + protrusion_weight) * outside - 1.0;
                if column > 0 {
                    sum += 0.5 * (value + values[values.len() - 1]) * cell_mm;
                }
                values.push(value);
                sums.push(sum);
            }
        }
        Field { area_mm2, corner: around.min, cell_mm, columns, rows, values, sums }
    }

    /// The field at a point, and its integral along u up to there.
    fn at(&self, p: P2) -> (f64, f64) {
        let place = (p - self.corner) / self.cell_mm;
        let row = place.y.clamp(0.0, (self.rows - 1) as f64 - 1e-9);
        let column = place.x.clamp(0.0, (self.columns - 1) as f64 - 1e-9);
        let (i, j, s) = (column as usize, row as usize, row.fract());
        let t = column.fract();
        let in_row = |j: usize| {
            let k = j * self.columns + i;
            let (a, b) = (self.values[k], self.values[k + 1]);
            let value = a + (b - a) * t;
            // Beyond the grid's ends the field stays as it is there.
            let beyond = (place.x - column) * self.cell_mm;
            (value, self.sums[k] + 0.5 * (a + value) * t * self.cell_mm + value * beyond)
        };
        let ((value, sum), (value_above, sum_above)) = (in_row(j), in_row(j + 1));
        (value + (value_above - value) * s, sum + (sum_above - sum) * s)
    }

    /// Empty area plus weighted protruding area (mm²) where a strip's `border`, a counter-clockwise walk over nodes at `x`, goes round the rest; its change per mm that each node
    /// moves is added to `slopes`.
    pub fn shortfall(&self, border: &[usize], x: &[P2], slopes: &mut [V2]) -> f64 {
        let mut total = self.area_mm2;
        for (i, j) in sides(border) {
            let along = x[j] - x[i];
            let out = V2::new(along.y, -along.x) / SAMPLES as f64;
            for k in 0..SAMPLES {
                let share = (k as f64 + 0.5) / SAMPLES as f64;
                let (value, sum) = self.at(x[i] + along * share);
                total += sum * along.y / SAMPLES as f64;
                slopes[i] += out * (value * (1.0 - share));
                slopes[j] += out * (value * share);
            }
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::faces::Faces;
    use crate::geom::enclosed;
    use crate::ruffle::{Drawn, uniform_stack};

    const WEIGHT: f64 = 3.0;

    fn outline() -> Outline {
        let loops = |points: &[(f64, f64)]| points.iter().map(|(x, y)| P2::new(*x, *y)).collect::<Vec<P2>>();
        Outline {
            outer: loops(&[(-9.0, 0.0), (61.0, 0.0), (57.0, 80.0), (30.0, 40.0), (-12.0, 75.0)]),
            holes: vec![loops(&[(20.0, 10.0), (23.0, 24.0), (36.0, 20.0), (33.0, 6.0)])],
        }
    }

    fn wobbly() -> (Drawn, Vec<usize>) {
        let mut drawn = uniform_stack(3, 24.0, 45.0, 4.0);
        for (i, p) in drawn.positions.iter_mut().enumerate() {
            *p += V2::new((0.7 * i as f64).sin(), (1.1 * i as f64).cos()) * 0.4;
        }
        let border = Faces::of(&drawn.ruffle, &drawn.positions).border;
        (drawn, border)
    }

    #[test]
    fn the_shortfall_is_what_triangles_clipped_one_by_one_say() {
        let (drawn, border) = wobbly();
        let x: Vec<P2> = drawn.positions.iter().map(|p| P2::new(p.x, p.y.max(0.0))).collect();
        let field = Field::new(&outline(), WEIGHT);
        let segments: Vec<(P2, P2)> = drawn.ruffle.segments().map(|(i, j)| (x[i], x[j])).collect();
        let exact = enclosed(&segments).coverage(outline().loops());
        let expected = exact.target - exact.covered + WEIGHT * (exact.enclosed - exact.covered);
        let found = field.shortfall(&border, &x, &mut vec![V2::zeros(); x.len()]);
        assert!((found - expected).abs() < 0.005 * exact.target, "{found} against {expected} mm²");
    }

    #[test]
    fn slopes_match_finite_differences() {
        let (drawn, border) = wobbly();
        let field = Field::new(&outline(), WEIGHT);
        let value = |x: &[P2]| field.shortfall(&border, x, &mut vec![V2::zeros(); x.len()]);
        let mut slopes = vec![V2::zeros(); drawn.positions.len()];
        field.shortfall(&border, &drawn.positions, &mut slopes);
        // A side of 4 mm weighs up to 12. Between grid points field and integral are interpolated apart: a side along the outline's rise is off by a few percent of that.
        let tolerance = 0.5;
        assert!(slopes.iter().any(|s| s.norm() > 5.0));
        for node in &border {
            for axis in 0..2 {
                let moved = |by: f64| {
                    let mut x = drawn.positions.clone();
                    x[*node].coords[axis] += by;
                    value(&x)
                };
                let slope = (moved(0.02) - moved(-0.02)) / 0.04;
                assert!(
                    (slope - slopes[*node][axis]).abs() < tolerance,
                    "node {node}: {slope} against {}",
                    slopes[*node]
                );
            }
        }
    }
}
