//! Layers as the rectangles that together fill most of an outline.

use super::ladder::Slab;
use super::stack::{MIN_CHORD_MM, StackError, StackSettings, layer_count, too_small};
use crate::cut::Outline;

/// Rows of the raster, at most; an outline up to this many mm high is rastered at 1 mm.
const MAX_ROWS: usize = 160;
/// A square millimetre outside the outline costs what one inside is worth.
const OUTSIDE: f64 = 1.0;
/// The two round ends of a layer of height h leave (1 / 2 - pi / 8) h² empty each.
const ROUND_ENDS: f64 = 0.215;
/// One more layer must gain this share of the outline's area.
const LAYER_COST: f64 = 0.004;

/// Inside cells of every column up to every row, and the raster's place.
struct Raster {
    /// Side of a cell along u, and nearly along v, mm.
    cell_mm: f64,
    /// Height of a row, mm: the rows share the outline's height evenly.
    row_mm: f64,
    left: f64,
    bottom: f64,
    columns: usize,
    rows: usize,
    /// `below[row * columns + column]`: cells of the column inside the outline below that row.
    below: Vec<u32>,
}

/// The best rectangle between two rows.
#[derive(Debug, Clone, Copy)]
struct Band {
    left: usize,
    right: usize,
    score: f64,
}

/// A stack that ends at some row: its worth, the row its last layer starts at, and that layer.
#[derive(Debug, Clone, Copy)]
struct Step {
    score: f64,
    from: usize,
    band: Band,
}

/// Divides `outline` into rectangles from the floor up, each at least `min_aspect` times as high as wide. For every layer count and height the best stack is kept;
/// that a worse one below might have shared a longer rung is not looked into.
pub(super) fn slabs(outline: &Outline, min_aspect: f64, settings: &StackSettings) -> Result<Vec<Slab>, StackError> {
    let raster = Raster::new(outline);
    let steps_of = |mm: f64| mm / raster.row_mm;
    let lowest = (steps_of(settings.min_layer_mm).ceil() as usize).max(1);
    let highest = (steps_of(settings.max_layer_mm) as usize).max(lowest);
    let most = raster.rows / lowest;
    if most == 0 {
        return Err(too_small(outline, settings));
    }
    let bands = Bands { raster: &raster, min_aspect, lowest, highest };

    // stacks[n][row]: the best stack of n + 1 layers that ends at the row.
    let mut stacks: Vec<Vec<Option<Step>>> = Vec::new();
    for n in 0..settings.layers.unwrap_or(most).min(most) {
        let row = |top: usize| -> Option<Step> {
            let candidates = bands.under(top).filter_map(|(from, band)| {
                if n == 0 {
                    return (from == 0).then_some(Step { score: band.score, from, band });
                }
                let below = stacks[n - 1][from]?;
                let shared = band.right.min(below.band.right) as f64 - band.left.max(below.band.left) as f64;
                // Neighbouring layers share a rung.
                let joined = shared * raster.cell_mm >= settings.min_rung_mm;
                joined.then_some(Step { score: below.score + band.score, from, band })
            });
            candidates.max_by(|a, b| a.score.total_cmp(&b.score))
        };
        let stack: Vec<Option<Step>> = (0..=raster.rows).map(row).collect();
        stacks.push(stack);
    }

    let area = outline.area() / raster.cell_mm.powi(2);
    let best_end = |stack: &Vec<Option<Step>>| {
        let ends = stack.iter().enumerate().filter_map(|(row, step)| Some((row, (*step)?.score)));
        ends.max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let worth = |n: usize| best_end(&stacks[n]).map(|(row, score)| (n, row, score - LAYER_COST * area * n as f64));
    let chosen = match settings.layers {
        None => (0..stacks.len()).filter_map(worth).max_by(|a, b| a.2.total_cmp(&b.2)),
        Some(layers) => layers.checked_sub(1).filter(|n| *n < stacks.len()).and_then(worth),
    };
    let Some((n, row, _)) = chosen else {
        return Err(match settings.layers {
            None => too_small(outline, settings),
            Some(layers) => {
                let possible = (0..stacks.len()).rev().find(|n| worth(*n).is_some()).map_or(0, |n| n + 1);
                layer_count(layers, possible, outline.bounds().height(), settings)
            }
        });
    };

    let mut slabs = Vec::with_capacity(n + 1);
    let mut top = row;
    for k in (0..=n).rev() {
        let Some(step) = stacks[k][top] else { break };
        slabs.push(raster.slab(step.from, top, &step.band));
        top = step.from;
    }
    slabs.reverse();
    Ok(slabs)
}

/// Rectangles that may become a layer.
struct Bands<'a> {
    raster: &'a Raster,
    min_aspect: f64,
    lowest: usize,
    highest: usize,
}

impl Bands<'_> {
    /// The best rectangle under row `top` for every height allowed, with the row it starts at.
    fn under(&self, top: usize) -> impl Iterator<Item = (usize, Band)> + '_ {
        let heights = self.lowest..=self.highest.min(top);
        heights.filter_map(move |height| self.between(top - height, top).map(|band| (top - height, band)))
    }

    /// The rectangle between two rows that gains most: the largest sum over consecutive columns (Kadane 1984).
    fn between(&self, from: usize, top: usize) -> Option<Band> {
        let height = (top - from) as f64;
        let mut best: Option<Band> = None;
        let (mut sum, mut left) = (0.0, 0);
        for column in 0..self.raster.columns {
            let inside = self.raster.inside(column, from, top) as f64;
            if sum <= 0.0 {
                (sum, left) = (0.0, column);
            }
            sum += inside - OUTSIDE * (height - inside);
            if best.is_none_or(|b| sum > b.score) {
                best = Some(Band { left, right: column + 1, score: sum });
            }
        }
        let band = best?;
        let width = (band.right - band.left) as f64;
        let wide_enough = width * self.raster.cell_mm >= MIN_CHORD_MM;
        let high_enough = height >= self.min_aspect * width;
        (wide_enough && high_enough).then_some(Band { score: band.score - ROUND_ENDS * height * height, ..band })
    }
}

impl Raster {
    fn new(outline: &Outline) -> Raster {
        let bounds = outline.bounds();
        let cell_mm = (bounds.height() / MAX_ROWS as f64).max(1.0);
        let cells = |mm: f64| (mm / cell_mm).round().max(1.0) as usize;
        let (columns, rows) = (cells(bounds.width()), cells(bounds.height()));
        let row_mm = bounds.height() / rows as f64;
        let mut below = vec![0; (rows + 1) * columns];
        for row in 0..rows {
            let v = bounds.min.y + (row as f64 + 0.5) * row_mm;
            let chords = outline.chords(v);
            for column in 0..columns {
                let u = bounds.min.x + (column as f64 + 0.5) * cell_mm;
                let inside = chords.iter().any(|(l, r)| (*l..*r).contains(&u));
                below[(row + 1) * columns + column] = below[row * columns + column] + u32::from(inside);
            }
        }
        Raster { cell_mm, row_mm, left: bounds.min.x, bottom: bounds.min.y, columns, rows, below }
    }

    /// Inside cells of a column between two rows.
    fn inside(&self, column: usize, from: usize, top: usize) -> u32 {
        self.below[top * self.columns + column] - self.below[from * self.columns + column]
    }

    fn slab(&self, from: usize, top: usize, band: &Band) -> Slab {
        let u = |column: usize| self.left + column as f64 * self.cell_mm;
        let v = |row: usize| self.bottom + row as f64 * self.row_mm;
        Slab { bottom: v(from), top: v(top), left: u(band.left), right: u(band.right) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::P2;
    use crate::ruffle::Layering;

    fn polygon(points: &[(f64, f64)]) -> Outline {
        Outline { outer: points.iter().map(|(x, y)| P2::new(*x, *y)).collect(), holes: Vec::new() }
    }

    fn packed(points: &[(f64, f64)]) -> Vec<Slab> {
        let settings = StackSettings { layering: Layering::Packed { min_aspect: 0.16 }, ..StackSettings::default() };
        slabs(&polygon(points), 0.16, &settings).unwrap()
    }

    #[test]
    fn a_level_snaps_to_the_shoulder_of_an_l() {
        let l = packed(&[(0.0, 0.0), (100.0, 0.0), (100.0, 40.0), (40.0, 40.0), (40.0, 100.0), (0.0, 100.0)]);
        assert!(l.iter().any(|s| (s.top - 40.0).abs() <= 1.0), "{l:?}");
        for slab in &l {
            let width = if slab.top <= 41.0 { 100.0 } else { 40.0 };
            assert!((slab.right - slab.left - width).abs() <= 1.0, "{slab:?}");
        }
    }

    #[test]
    fn a_narrow_gap_between_feet_is_spanned_and_horns_are_left_out() {
        let feet = packed(&[
            (0.0, 0.0),
            (45.0, 0.0),
            (45.0, 30.0),
            (55.0, 30.0),
            (55.0, 0.0),
            (100.0, 0.0),
            (100.0, 100.0),
            (0.0, 100.0),
        ]);
        assert!(feet.iter().all(|s| s.right - s.left > 90.0), "{feet:?}");
        let horns = packed(&[(0.0, 0.0), (100.0, 0.0), (100.0, 95.0), (80.0, 60.0), (20.0, 60.0), (0.0, 95.0)]);
        assert!(horns.iter().all(|s| s.right - s.left > 60.0), "{horns:?}");
    }

    #[test]
    fn slabs_stand_on_the_floor_and_on_each_other() {
        let slabs = packed(&[(0.0, 0.0), (110.0, 0.0), (55.0, 100.0)]);
        assert_eq!(slabs[0].bottom, 0.0);
        assert!(slabs.windows(2).all(|w| w[0].top == w[1].bottom));
        assert!(slabs.iter().all(|s| s.top - s.bottom >= 12.0));
    }
}
