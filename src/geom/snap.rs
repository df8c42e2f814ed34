//! Segments that cross become segments that only share ends.
//!
//! Snap rounding (Hobby 1999, doi:10.1016/S0925-7721(99)00021-8) in whole numbers of grid steps, so that every test is exact: a cell of
//! the grid that holds an end or a crossing is hot, and every segment through a hot cell is led through the cell's middle.

use super::{P2, Rect};

/// The grid's step (2^-20, about 1e-6): below anything a machine can do. Coarser by powers of two for coordinates above 2^20 mm, a km.
const GRID_MM: f64 = 1.0 / 1_048_576.0;
/// Most grid steps from the origin: products of three differences then fit into 128 bits.
const MAX_STEPS: f64 = (1u64 << 40) as f64;

/// A grid point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Cell {
    x: i128,
    y: i128,
}

impl Cell {
    fn minus(self, other: Cell) -> Cell {
        Cell { x: self.x - other.x, y: self.y - other.y }
    }

    fn cross(self, other: Cell) -> i128 {
        self.x * other.y - self.y * other.x
    }

    fn dot(self, other: Cell) -> i128 {
        self.x * other.x + self.y * other.y
    }
}

/// For each segment the points it is led through, on the grid, such that no two of the pieces cross or touch other than in common ends;
/// pieces may coincide. No piece strays from its segment by more than a grid step.
pub fn snap_round(segments: &[(P2, P2)]) -> Vec<Vec<P2>> {
    let reach = segments.iter().flat_map(|(a, b)| [a.coords.amax(), b.coords.amax()]).fold(0.0, f64::max);
    let mut grid = GRID_MM;
    while reach / grid > MAX_STEPS {
        grid *= 2.0;
    }
    let steps = |x: f64| (x / grid + 0.5).floor().clamp(-MAX_STEPS, MAX_STEPS) as i128;
    let cell = |p: &P2| Cell { x: steps(p.x), y: steps(p.y) };
    let snapped: Vec<(Cell, Cell)> = segments.iter().map(|(a, b)| (cell(a), cell(b))).collect();
    let mut hot: Vec<Cell> = snapped.iter().flat_map(|(a, b)| [*a, *b]).collect();
    hot.extend(crossings(segments, &snapped, 2.0 * grid));
    hot.sort();
    hot.dedup();
    let point = |c: Cell| P2::new(c.x as f64 * grid, c.y as f64 * grid);
    snapped.iter().map(|(a, b)| led_through(*a, *b, &hot).into_iter().map(point).collect()).collect()
}

/// Cells in which two segments properly cross. Ends on other segments need no crossing: they are hot already.
fn crossings(segments: &[(P2, P2)], snapped: &[(Cell, Cell)], slack: f64) -> Vec<Cell> {
    let bounds: Vec<Rect> = segments.iter().map(|(a, b)| Rect::around([a, b]).grown(slack)).collect();
    let mut order: Vec<usize> = (0..segments.len()).collect();
    order.sort_by(|i, j| bounds[*i].min.x.total_cmp(&bounds[*j].min.x));
    let mut found = Vec::new();
    for (k, i) in order.iter().enumerate() {
        let near = order[k + 1..].iter().take_while(|j| bounds[**j].min.x <= bounds[*i].max.x);
        for j in near.filter(|j| bounds[**j].overlaps(&bounds[*i])) {
            let ((a, b), (c, d)) = (snapped[*i], snapped[*j]);
            let (ab, cd) = (b.minus(a), d.minus(c));
            let (at_a, at_b) = (cd.cross(a.minus(c)), cd.cross(b.minus(c)));
            if at_a.signum() * at_b.signum() < 0 && ab.cross(c.minus(a)).signum() * ab.cross(d.minus(a)).signum() < 0 {
                // a + ab * at_a / (at_a - at_b), rounded half up like every coordinate.
                let whole = at_a - at_b;
                let rounded = |from: i128, along: i128| {
                    from + (2 * along * at_a * whole.signum() + whole.abs()).div_euclid(2 * whole.abs())
                };
                found.push(Cell { x: rounded(a.x, ab.x), y: rounded(a.y, ab.y) });
            }
        }
    }
    found
}

/// The hot cells (sorted) that segment `a b` meets, from `a` to `b`. A cell owns its left and lower border: without that, a segment along
/// the border of two cells would be led through both.
fn led_through(a: Cell, b: Cell, hot: &[Cell]) -> Vec<Cell> {
    let ab = b.minus(a);
    let (lo, hi) = (Cell { x: a.x.min(b.x), y: a.y.min(b.y) }, Cell { x: a.x.max(b.x), y: a.y.max(b.y) });
    let meets = |p: &Cell| {
        // Sides, doubled, of the cell's lower left corner and of the others.
        let side = |dx: i128, dy: i128| 2 * ab.cross(p.minus(a)) + ab.x * dy - ab.y * dx;
        let others = [side(1, -1), side(1, 1), side(-1, 1)];
        let corner = side(-1, -1);
        let left = corner > 0 || others.iter().any(|s| *s > 0);
        let right = corner < 0 || others.iter().any(|s| *s < 0);
        corner == 0 || (left && right)
    };
    // The line meets no cell with its middle in the segment's box beyond the ends: corners are whole numbers.
    let first = hot.partition_point(|p| p.x < lo.x);
    let in_box = hot[first..].iter().take_while(|p| p.x <= hi.x).filter(|p| lo.y <= p.y && p.y <= hi.y);
    let mut met: Vec<Cell> = in_box.filter(|p| meets(p)).copied().collect();
    met.sort_by_key(|p| p.minus(a).dot(ab));
    met
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pieces(segments: &[(P2, P2)]) -> Vec<(P2, P2)> {
        snap_round(segments)
            .iter()
            .flat_map(|points| points.windows(2).map(|w| (w[0], w[1])).collect::<Vec<_>>())
            .collect()
    }

    /// The sign of the turn p, q, r, exactly: coordinates are whole numbers of grid steps.
    fn turn(p: P2, q: P2, r: P2) -> i128 {
        let cell = |p: P2| Cell { x: (p.x / GRID_MM) as i128, y: (p.y / GRID_MM) as i128 };
        cell(q).minus(cell(p)).cross(cell(r).minus(cell(p))).signum()
    }

    fn clash((a, b): (P2, P2), (c, d): (P2, P2)) -> bool {
        let on = |p: P2, q: P2, r: P2| r != p && r != q && turn(p, q, r) == 0 && (r - p).dot(&(r - q)) < 0.0;
        (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0)
            || on(a, b, c)
            || on(a, b, d)
            || on(c, d, a)
            || on(c, d, b)
    }

    #[test]
    fn a_cross_becomes_four_segments_and_a_touch_three() {
        let p = |x, y| P2::new(x, y);
        assert_eq!(pieces(&[(p(0.0, 0.0), p(2.0, 2.0)), (p(0.0, 2.0), p(2.0, 0.0))]).len(), 4);
        let touch = pieces(&[(p(0.0, 0.0), p(2.0, 0.0)), (p(1.0, 0.0), p(1.0, 5.0))]);
        assert_eq!(touch, [(p(0.0, 0.0), p(1.0, 0.0)), (p(1.0, 0.0), p(2.0, 0.0)), (p(1.0, 0.0), p(1.0, 5.0))]);
        assert!(pieces(&[(p(1.0, 1.0), p(1.0, 1.0))]).is_empty());
    }

    proptest! {
        #[test]
        fn no_two_pieces_cross_or_touch_inside(
            ends in prop::collection::vec(prop::array::uniform4(-100.0..100.0f64), 2..40),
        ) {
            let segments: Vec<_> = ends.iter().map(|[a, b, c, d]| (P2::new(*a, *b), P2::new(*c, *d))).collect();
            let pieces = pieces(&segments);
            for (i, a) in pieces.iter().enumerate() {
                prop_assert!(pieces[..i].iter().all(|b| !clash(*a, *b)));
            }
        }

        #[test]
        fn nor_do_they_when_everything_nearly_coincides(
            ends in prop::collection::vec((prop::array::uniform4(-3i32..3), prop::array::uniform4(-2e-6..2e-6f64)), 2..20),
        ) {
            let at = |whole: i32, near: f64| f64::from(whole) + near;
            let segments: Vec<_> = ends
                .iter()
                .map(|(w, n)| (P2::new(at(w[0], n[0]), at(w[1], n[1])), P2::new(at(w[2], n[2]), at(w[3], n[3]))))
                .collect();
            let pieces = pieces(&segments);
            for (i, a) in pieces.iter().enumerate() {
                prop_assert!(pieces[..i].iter().all(|b| !clash(*a, *b)));
            }
        }
    }
}
