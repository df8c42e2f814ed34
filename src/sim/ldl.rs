//! Sparse symmetric systems: a pattern that is analysed once, and an LDLᵀ factorisation that is repeated for every Newton step.

use super::Error;

/// Factors a symmetric matrix with a fixed pattern and solves with it.
pub trait Factorisation {
    /// Factors the matrix whose entries are `values`, one per slot of the pattern. Returns false, leaving nothing to solve with, when the matrix is
    /// not positive definite.
    fn factor(&mut self, values: &[f64]) -> bool;
    /// Replaces `b` by the solution of A x = b.
    fn solve(&mut self, b: &mut [f64]);
}

/// Where the entries of a symmetric matrix lie: upper triangle by columns, rows and columns permuted to keep the factor sparse (approximate
/// minimum degree: Amestoy, Davis and Duff 1996, doi:10.1137/S0895479894278952).
#[derive(Debug, Clone)]
pub struct Pattern {
    /// Permuted place of each unknown.
    place: Vec<usize>,
    /// First slot of each permuted column; one more than there are columns.
    starts: Vec<usize>,
    /// Permuted row of each slot, ascending within a column; the last slot of a column is its diagonal.
    rows: Vec<usize>,
    /// First of each permuted row's slots in `row_slots`; one more than there are rows.
    row_starts: Vec<usize>,
    row_slots: Vec<usize>,
}

/// Entries of a column as its elements name them, most of them several times: three hinges of six and two segments of four.
const USUAL_ENTRIES: usize = 32;

impl Pattern {
    /// The pattern of a sum of element matrices: each element couples all the unknowns it names.
    pub fn new<'a>(unknowns: usize, elements: impl IntoIterator<Item = &'a [usize]>) -> Result<Pattern, Error> {
        let mut columns: Vec<Vec<usize>> = (0..unknowns).map(|_| Vec::with_capacity(USUAL_ENTRIES)).collect();
        columns.iter_mut().enumerate().for_each(|(i, column)| column.push(i));
        for element in elements {
            for a in element {
                columns[*a].extend(element);
            }
        }
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for column in &mut columns {
            column.sort_unstable();
            column.dedup();
            rows.extend_from_slice(column);
            starts.push(rows.len());
        }
        let (_, place, _) = amd::order(unknowns, &starts, &rows, &amd::Control::default())
            .map_err(|status| Error::Ordering { unknowns, status: format!("{status:?}") })?;

        let mut permuted: Vec<Vec<usize>> = vec![Vec::new(); unknowns];
        for (j, column) in columns.iter().enumerate() {
            let pj = place[j];
            permuted[pj].extend(column.iter().map(|i| place[*i]).filter(|pi| *pi <= pj));
        }
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for column in &mut permuted {
            column.sort_unstable();
            rows.append(column);
            starts.push(rows.len());
        }
        let mut row_starts = vec![0; unknowns + 1];
        rows.iter().for_each(|row| row_starts[row + 1] += 1);
        for row in 0..unknowns {
            row_starts[row + 1] += row_starts[row];
        }
        let mut row_slots = vec![0; rows.len()];
        let mut next = row_starts.clone();
        for (slot, row) in rows.iter().enumerate() {
            row_slots[next[*row]] = slot;
            next[*row] += 1;
        }
        Ok(Pattern { place, starts, rows, row_starts, row_slots })
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.place.len()
    }

    /// Number of slots.
    pub fn slots(&self) -> usize {
        self.rows.len()
    }

    /// The slot that holds entry (`i`, `j`) and (`j`, `i`), if an element couples them.
    pub fn slot(&self, i: usize, j: usize) -> Option<usize> {
        let (row, column) = (self.place[i].min(self.place[j]), self.place[i].max(self.place[j]));
        let range = self.starts[column]..self.starts[column + 1];
        self.rows[range.clone()].binary_search(&row).ok().map(|k| range.start + k)
    }

    /// Turns the rows and columns of the unknowns marked in `fixed` into those of the unit matrix: they then keep their value.
    pub fn fix(&self, values: &mut [f64], fixed: &[bool]) {
        for (unknown, _) in fixed.iter().enumerate().filter(|(_, fixed)| **fixed) {
            let place = self.place[unknown];
            values[self.starts[place]..self.starts[place + 1]].fill(0.0);
            for slot in &self.row_slots[self.row_starts[place]..self.row_starts[place + 1]] {
                values[*slot] = 0.0;
            }
            values[self.starts[place + 1] - 1] = 1.0;
        }
    }

    /// Adds `by` to every diagonal entry.
    pub fn damp(&self, values: &mut [f64], by: f64) {
        for end in &self.starts[1..] {
            values[end - 1] += by;
        }
    }

    fn permute(&self, from: &[f64], to: &mut [f64]) {
        for (i, p) in self.place.iter().enumerate() {
            to[*p] = from[i];
        }
    }

    fn permute_back(&self, from: &[f64], to: &mut [f64]) {
        for (i, p) in self.place.iter().enumerate() {
            to[i] = from[*p];
        }
    }
}

/// Up-looking LDLᵀ (Davis 2005, Algorithm 849, doi:10.1145/1114268.1114277): row k of L by a sparse triangular solve whose pattern is read off the
/// elimination tree. No pivoting: a pivot that is not positive ends the factorisation.
#[derive(Debug, Clone)]
pub struct LdlT {
    pattern: Pattern,
    /// Elimination tree; a root is its own parent.
    parent: Vec<usize>,
    /// First entry of each column of L; one more than there are columns.
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
    diagonal: Vec<f64>,
    work: Workspace,
}

#[derive(Debug, Clone)]
struct Workspace {
    /// Entries of each column of L found so far.
    filled: Vec<usize>,
    /// Row being formed, dense.
    y: Vec<f64>,
    /// Columns the row touches, in elimination order, at the back.
    touched: Vec<usize>,
    /// Last row that visited each column.
    visited: Vec<usize>,
    /// Right-hand side, permuted.
    b: Vec<f64>,
}

const NEVER: usize = usize::MAX;

/// Pivots below this fraction of the matrix's own diagonal entry are lost to cancellation: what is left of the entry is round-off.
const LEAST_PIVOT_FRACTION: f64 = 1e-14;

impl LdlT {
    /// Analyses the pattern: elimination tree and the room each column of L needs.
    pub fn new(pattern: Pattern) -> LdlT {
        let n = pattern.unknowns();
        let mut parent: Vec<usize> = (0..n).collect();
        let mut visited = vec![NEVER; n];
        let mut count = vec![0usize; n];
        for k in 0..n {
            visited[k] = k;
            for slot in pattern.starts[k]..pattern.starts[k + 1] {
                let mut i = pattern.rows[slot];
                while visited[i] != k {
                    if parent[i] == i {
                        parent[i] = k;
                    }
                    count[i] += 1;
                    visited[i] = k;
                    i = parent[i];
                }
            }
        }
        let mut starts = vec![0];
        for c in &count {
            starts.push(starts[starts.len() - 1] + c);
        }
        let entries = starts[n];
        LdlT {
            parent,
            starts,
            rows: vec![0; entries],
            values: vec![0.0; entries],
            diagonal: vec![0.0; n],
            work: Workspace {
                filled: vec![0; n],
                y: vec![0.0; n],
                touched: vec![0; n],
                visited: vec![NEVER; n],
                b: vec![0.0; n],
            },
            pattern,
        }
    }

    /// The pattern the factorisation was made for.
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }
}

impl Factorisation for LdlT {
    fn factor(&mut self, values: &[f64]) -> bool {
        let n = self.pattern.unknowns();
        let Workspace { filled, y, touched, visited, .. } = &mut self.work;
        filled.fill(0);
        y.fill(0.0);
        visited.fill(NEVER);
        for k in 0..n {
            let mut top = n;
            visited[k] = k;
            let mut own = 0.0;
            let slots = self.pattern.starts[k]..self.pattern.starts[k + 1];
            for (value, row) in values[slots.clone()].iter().zip(&self.pattern.rows[slots]) {
                let mut i = *row;
                if i == k {
                    own = *value;
                    continue;
                }
                y[i] += value;
                let mut length = 0;
                while visited[i] != k {
                    touched[length] = i;
                    length += 1;
                    visited[i] = k;
                    i = self.parent[i];
                }
                // The path toward the root goes in front of those found before: ancestors are eliminated later.
                touched.copy_within(0..length, top - length);
                top -= length;
            }
            let mut pivot = own;
            for &i in &touched[top..n] {
                let yi = std::mem::take(&mut y[i]);
                let column = self.starts[i]..self.starts[i] + filled[i];
                for (row, l) in self.rows[column.clone()].iter().zip(&self.values[column.clone()]) {
                    y[*row] -= l * yi;
                }
                let l = yi / self.diagonal[i];
                pivot -= l * yi;
                self.rows[column.end] = k;
                self.values[column.end] = l;
                filled[i] += 1;
            }
            // Written so that NaN counts as not positive.
            if !(pivot > LEAST_PIVOT_FRACTION * own.abs() && pivot > 0.0) {
                return false;
            }
            self.diagonal[k] = pivot;
        }
        true
    }

    fn solve(&mut self, b: &mut [f64]) {
        let x = &mut self.work.b;
        self.pattern.permute(b, x);
        let n = x.len();
        for j in 0..n {
            for p in self.starts[j]..self.starts[j + 1] {
                x[self.rows[p]] -= self.values[p] * x[j];
            }
        }
        for (value, d) in x.iter_mut().zip(&self.diagonal) {
            *value /= d;
        }
        for j in (0..n).rev() {
            for p in self.starts[j]..self.starts[j + 1] {
                x[j] -= self.values[p] * x[self.rows[p]];
            }
        }
        self.pattern.permute_back(x, b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use nalgebra_sparse::{CooMatrix, CscMatrix, factorization::CscCholesky};
    use proptest::prelude::*;

    /// The second opinion: nalgebra-sparse's Cholesky on the unpermuted matrix.
    struct Oracle {
        pattern: Pattern,
        factor: Option<CscCholesky<f64>>,
    }

    impl Factorisation for Oracle {
        fn factor(&mut self, values: &[f64]) -> bool {
            let n = self.pattern.unknowns();
            let mut matrix = CooMatrix::new(n, n);
            for i in 0..n {
                for j in 0..n {
                    if let Some(slot) = self.pattern.slot(i, j) {
                        matrix.push(i, j, values[slot]);
                    }
                }
            }
            self.factor = CscCholesky::factor(&CscMatrix::from(&matrix)).ok();
            self.factor.is_some()
        }

        fn solve(&mut self, b: &mut [f64]) {
            let factor = self.factor.as_ref().expect("factored");
            let x = factor.solve(&DVector::from_column_slice(b));
            b.copy_from_slice(x.as_slice());
        }
    }

    /// A chain with a few far ties, as a ruffle has, from random element matrices.
    fn system(n: usize, ties: &[(usize, usize)], seed: &[f64]) -> (Pattern, Vec<f64>) {
        let mut elements: Vec<Vec<usize>> = (0..n - 2).map(|i| vec![i, i + 1, i + 2]).collect();
        elements.extend(ties.iter().filter(|(a, b)| a != b).map(|(a, b)| vec![*a, *b]));
        let pattern = Pattern::new(n, elements.iter().map(|e| e.as_slice())).unwrap();
        let mut values = vec![0.0; pattern.slots()];
        for (e, element) in elements.iter().enumerate() {
            let v: Vec<f64> = element.iter().enumerate().map(|(k, _)| seed[(e + 3 * k) % seed.len()]).collect();
            for (a, i) in element.iter().enumerate() {
                for (b, j) in element.iter().enumerate().skip(a) {
                    values[pattern.slot(*i, *j).unwrap()] += v[a] * v[b];
                }
            }
        }
        for i in 0..n {
            values[pattern.slot(i, i).unwrap()] += 0.1;
        }
        (pattern, values)
    }

    proptest! {
        #[test]
        fn solutions_agree_with_the_oracle(
            n in 3usize..40,
            ties in prop::collection::vec((0usize..40, 0usize..40), 0..8),
            seed in prop::collection::vec(-2.0..2.0f64, 7),
        ) {
            let ties: Vec<(usize, usize)> = ties.iter().map(|(a, b)| (a % n, b % n)).collect();
            let (pattern, values) = system(n, &ties, &seed);
            let b: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
            let (mut ours, mut theirs) = (b.clone(), b);
            let mut oracle = Oracle { pattern: pattern.clone(), factor: None };
            let mut ldl = LdlT::new(pattern);
            prop_assert!(ldl.factor(&values) && oracle.factor(&values));
            ldl.solve(&mut ours);
            oracle.solve(&mut theirs);
            for (x, y) in ours.iter().zip(&theirs) {
                prop_assert!((x - y).abs() < 1e-8 * (1.0 + y.abs()), "{x} {y}");
            }
        }
    }

    #[test]
    fn an_indefinite_or_broken_matrix_is_reported() {
        let pattern = Pattern::new(2, [[0usize, 1].as_slice()]).unwrap();
        let mut values = vec![0.0; pattern.slots()];
        values[pattern.slot(0, 0).unwrap()] = 1.0;
        values[pattern.slot(1, 1).unwrap()] = 1.0;
        values[pattern.slot(0, 1).unwrap()] = 2.0;
        assert!(DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]).symmetric_eigenvalues().min() < 0.0);
        let mut ldl = LdlT::new(pattern.clone());
        assert!(!ldl.factor(&values));
        values[pattern.slot(0, 1).unwrap()] = f64::NAN;
        assert!(!ldl.factor(&values));
    }

    #[test]
    fn fixed_unknowns_keep_their_value() {
        let (pattern, mut values) = system(6, &[(0, 5)], &[1.0, -0.5, 0.7]);
        pattern.fix(&mut values, &[false, true, false, false, true, false]);
        let mut ldl = LdlT::new(pattern);
        assert!(ldl.factor(&values));
        let mut b = vec![1.0, 7.0, 1.0, 1.0, -3.0, 1.0];
        ldl.solve(&mut b);
        assert_eq!((b[1], b[4]), (7.0, -3.0));
    }
}
