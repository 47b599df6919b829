//! Cholesky factorisation of a symmetric and positive definite matrix most of whose entries are zero. Each row keeps the entries
//! from its first nonzero entry to the diagonal. These entries are the envelope. The factor has no entries outside it (George and
//! Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981, chapter 4). The operations for a chain whose bodies come
//! in order are proportional to the number of bodies; those for a full matrix are proportional to the cube of it.

use bevy::math::DMat3;

/// The lower half of a matrix, or its factor.
#[derive(Clone, Default)]
pub(super) struct Envelope {
    entries: Vec<f64>,
    rows: Vec<Row>,
}

#[derive(Clone, Copy)]
struct Row {
    /// Index of the first entry that is kept.
    first: usize,
    /// Where that entry stands in the list of all entries.
    start: usize,
}

impl Envelope {
    /// Removes all rows.
    pub(super) fn clear(&mut self) {
        self.entries.clear();
        self.rows.clear();
    }

    /// Appends a row of zeros that is kept from `first` on.
    pub(super) fn push(&mut self, first: usize) {
        let (row, start) = (self.rows.len(), self.entries.len());
        self.rows.push(Row { first, start });
        self.entries.resize(start + row + 1 - first, 0.0);
    }

    /// Entries of a row, up to and with the diagonal.
    fn row(&self, row: usize) -> &[f64] {
        let Row { first, start } = self.rows[row];
        &self.entries[start..start + row + 1 - first]
    }

    /// Adds a block whose first entry stands in `row` and `column`. What stands above the diagonal is the mirror of what stands
    /// below, and is ignored.
    pub(super) fn add(&mut self, row: usize, column: usize, block: DMat3) {
        for r in 0..3 {
            let Row { first, start } = self.rows[row + r];
            let below = (row + r + 1).saturating_sub(column).min(3);
            for c in 0..below {
                self.entries[start + column + c - first] += block.col(c)[r];
            }
        }
    }

    /// Replaces the matrix by its factor L with L Lᵀ = A. Returns whether it is positive definite; if not, what is left is of
    /// no use.
    pub(super) fn factorise(&mut self) -> bool {
        for row in 0..self.rows.len() {
            let Row { first, start } = self.rows[row];
            let (above, own) = self.entries.split_at_mut(start);
            let mut column = first;
            while column < row {
                let other = self.rows[column];
                let from = first.max(other.first);
                let (kept, diagonal) = (other.start + column - other.first, column - first);
                let sum = dot(
                    &above[other.start + from - other.first..kept],
                    &own[from - first..diagonal],
                );
                own[diagonal] = (own[diagonal] - sum) / above[kept];
                column += 1;
            }
            let diagonal = row - first;
            let square = own[diagonal] - dot(&own[..diagonal], &own[..diagonal]);
            if square.is_nan() || square <= 0.0 {
                return false;
            }
            own[diagonal] = square.sqrt();
        }
        true
    }

    /// Solves A x = b with the factor of A. `x` is b before, and the solution after.
    pub(super) fn solve(&self, x: &mut [f64]) {
        for row in 0..self.rows.len() {
            let first = self.rows[row].first;
            let own = self.row(row);
            let sum = dot(&own[..row - first], &x[first..row]);
            x[row] = (x[row] - sum) / own[row - first];
        }
        for row in (0..self.rows.len()).rev() {
            let first = self.rows[row].first;
            let own = self.row(row);
            let value = x[row] / own[row - first];
            x[row] = value;
            for (x, own) in x[first..row].iter_mut().zip(own) {
                *x -= own * value;
            }
        }
    }
}

/// Scalar product of two lists of the same length. Four sums do not wait for each other, and a loop by index is fast where the
/// compiler hardly optimises, as for tests.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let (a, b) = (&a[..length], &b[..length]);
    let mut sums = [0.0; 4];
    let mut k = 0;
    while k + 4 <= length {
        sums[0] += a[k] * b[k];
        sums[1] += a[k + 1] * b[k + 1];
        sums[2] += a[k + 2] * b[k + 2];
        sums[3] += a[k + 3] * b[k + 3];
        k += 4;
    }
    while k < length {
        sums[0] += a[k] * b[k];
        k += 1;
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// A matrix with the given first column of each row, and the same one in full.
    fn both(firsts: &[usize], diagonal: f64) -> (Envelope, DMatrix<f64>) {
        let n = firsts.len();
        let (mut envelope, mut full) = (Envelope::default(), DMatrix::zeros(n, n));
        for (row, first) in firsts.iter().enumerate() {
            envelope.push(*first);
            for column in *first..=row {
                let value = if column == row {
                    diagonal
                } else {
                    ((row * 7 + column * 3) % 5) as f64 - 2.0
                };
                let Row { first, start } = envelope.rows[row];
                envelope.entries[start + column - first] = value;
                full[(row, column)] = value;
                full[(column, row)] = value;
            }
        }
        (envelope, full)
    }

    #[test]
    fn it_solves_what_a_full_matrix_solves() {
        for firsts in [
            vec![0],
            vec![0, 1, 2],
            vec![0, 0, 0, 0, 0, 0, 0],
            vec![0, 0, 1, 2, 3, 4, 5, 6, 7],
            vec![0, 1, 0, 3, 2, 5, 0, 4, 8, 1],
        ] {
            let (mut envelope, full) = both(&firsts, 40.0);
            let right = DVector::from_fn(firsts.len(), |i, _| (i as f64 - 3.0) * 1.7);
            let wanted = full.cholesky().expect("a large diagonal").solve(&right);
            assert!(envelope.factorise());
            let mut solution = right;
            envelope.solve(solution.as_mut_slice());
            assert!((solution - wanted).amax() < 1e-14, "{firsts:?}");
        }
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        assert!(!both(&[0, 0, 0, 0], 0.5).0.factorise());
        assert!(!both(&[0, 0], f64::NAN).0.factorise());
    }
}
