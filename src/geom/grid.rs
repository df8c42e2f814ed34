//! Finding boxes near a box: a uniform grid over the plane.

use super::{P2, Rect};

/// Boxes listed by the cells they meet. Filling it again reuses its memory.
#[derive(Debug, Clone, Default)]
pub struct BoxGrid {
    boxes: Vec<Rect>,
    origin: P2,
    side: f64,
    cells: [usize; 2],
    /// Boxes of cell c: `listed[starts[c]..starts[c + 1]]`.
    starts: Vec<u32>,
    listed: Vec<u32>,
    /// Last query that met each box.
    met: Vec<u32>,
    query: u32,
}

/// Cells per box, at most: memory stays in proportion to the boxes however far they spread.
const CELLS_PER_BOX: usize = 4;

impl BoxGrid {
    /// Takes `boxes`, none of them empty, into cells of about twice their mean extent.
    pub fn fill(&mut self, boxes: impl IntoIterator<Item = Rect>) {
        self.boxes.clear();
        self.boxes.extend(boxes);
        let n = self.boxes.len();
        let bounds = self.boxes.iter().fold(Rect::EMPTY, |all, b| all.union(*b));
        let extent: f64 = self.boxes.iter().map(|b| b.width().max(b.height())).sum::<f64>() / n.max(1) as f64;
        let spread = bounds.width().max(bounds.height());
        self.origin = bounds.min;
        self.side = (2.0 * extent).max(spread * 1e-4).max(f64::MIN_POSITIVE);
        let count = |side: f64, along: f64| (along / side) as usize + 1;
        while count(self.side, bounds.width()) * count(self.side, bounds.height()) > CELLS_PER_BOX * n + 1 {
            self.side *= 1.5;
        }
        self.cells = [count(self.side, bounds.width()), count(self.side, bounds.height())];

        self.starts.clear();
        self.starts.resize(self.cells[0] * self.cells[1] + 1, 0);
        for i in 0..n {
            let (lo, hi) = self.cells_of(&self.boxes[i]);
            for row in lo[1]..=hi[1] {
                for column in lo[0]..=hi[0] {
                    self.starts[row * self.cells[0] + column] += 1;
                }
            }
        }
        // Counts become ends, and filling from the back makes them starts.
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.listed.clear();
        self.listed.resize(sum as usize, 0);
        for i in (0..n).rev() {
            let (lo, hi) = self.cells_of(&self.boxes[i]);
            for row in lo[1]..=hi[1] {
                for column in lo[0]..=hi[0] {
                    let start = &mut self.starts[row * self.cells[0] + column];
                    *start -= 1;
                    self.listed[*start as usize] = i as u32;
                }
            }
        }
        self.met.clear();
        self.met.resize(n, 0);
        self.query = 0;
    }

    /// Calls `found` once for every box that touches or overlaps `area`.
    pub fn near(&mut self, area: &Rect, mut found: impl FnMut(usize)) {
        self.query += 1;
        if self.boxes.is_empty() {
            return;
        }
        let (lo, hi) = self.cells_of(area);
        for row in lo[1]..=hi[1] {
            for column in lo[0]..=hi[0] {
                let cell = row * self.cells[0] + column;
                for i in self.starts[cell] as usize..self.starts[cell + 1] as usize {
                    let listed = self.listed[i] as usize;
                    let first = std::mem::replace(&mut self.met[listed], self.query) != self.query;
                    let b = &self.boxes[listed];
                    let apart =
                        b.min.x > area.max.x || b.max.x < area.min.x || b.min.y > area.max.y || b.max.y < area.min.y;
                    if first && !apart {
                        found(listed);
                    }
                }
            }
        }
    }

    /// First and last cell, columns and rows, that a box meets; what lies outside counts to the border.
    fn cells_of(&self, b: &Rect) -> ([usize; 2], [usize; 2]) {
        // Casting clamps at 0.
        let cell = |p: P2| {
            let place = (p - self.origin) / self.side;
            [(place.x as usize).min(self.cells[0] - 1), (place.y as usize).min(self.cells[1] - 1)]
        };
        (cell(b.min), cell(b.max))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn boxes() -> impl Strategy<Value = Vec<Rect>> {
        let one = (-50.0..50.0f64, -50.0..50.0f64, 0.0..20.0f64, 0.0..20.0f64);
        prop::collection::vec(one, 0..40).prop_map(|all| {
            let rect = |(x, y, w, h): (f64, f64, f64, f64)| Rect { min: P2::new(x, y), max: P2::new(x + w, y + h) };
            all.into_iter().map(rect).collect()
        })
    }

    proptest! {
        #[test]
        fn every_box_near_is_found_once_and_no_other(first in boxes(), second in boxes(), queries in boxes()) {
            let mut grid = BoxGrid::default();
            grid.fill(first);
            grid.fill(second.clone());
            for query in &queries {
                let mut found = Vec::new();
                grid.near(query, |i| found.push(i));
                found.sort_unstable();
                let touches = |b: &Rect| {
                    b.min.x <= query.max.x && query.min.x <= b.max.x && b.min.y <= query.max.y && query.min.y <= b.max.y
                };
                let expected: Vec<usize> = (0..second.len()).filter(|i| touches(&second[*i])).collect();
                prop_assert_eq!(found, expected);
            }
        }
    }
}
