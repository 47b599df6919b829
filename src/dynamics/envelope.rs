//! Cholesky factorisation of a symmetric and positive definite matrix most of whose entries are zero. It consists of blocks of
//! 3 × 3 entries. Each row of blocks keeps those from its first block that is not zero to the diagonal. These blocks are the
//! envelope. The factor has no entries outside it (George and Liu, Computer Solution of Large Sparse Positive Definite Systems,
//! 1981, chapter 4). The operations for a chain whose bodies come in order are proportional to the number of bodies; those for a
//! full matrix are proportional to the cube of it.

use bevy::math::{DMat3, DVec3};

/// The lower half of a matrix, or its factor. Rows and columns are counted in blocks.
#[derive(Clone, Default)]
pub(super) struct Envelope {
    blocks: Vec<DMat3>,
    rows: Vec<Row>,
}

#[derive(Clone, Copy)]
struct Row {
    /// Column of the first block that is kept.
    first: usize,
    /// Where that block stands in the list of all blocks.
    start: usize,
    /// Of the factor: its block on the diagonal.
    diagonal: Triangle,
}

/// A lower triangle of 3 × 3 entries, with the inverses of those on its diagonal.
#[derive(Clone, Copy, Default)]
struct Triangle {
    inverse: DVec3,
    /// The entries below the diagonal: second row and first column, third and first, third and second.
    below: DVec3,
}

impl Triangle {
    /// The Cholesky factor of a block, of which only the lower half is read. None if it is not positive definite.
    fn of(block: &DMat3) -> Option<Self> {
        let [x, y, z] = [block.x_axis, block.y_axis, block.z_axis];
        let inverse_x = inverse_root(x.x)?;
        let (yx, zx) = (x.y * inverse_x, x.z * inverse_x);
        let inverse_y = inverse_root(y.y - yx * yx)?;
        let zy = (y.z - zx * yx) * inverse_y;
        let inverse_z = inverse_root(z.z - (zx * zx + zy * zy))?;
        Some(Self {
            inverse: DVec3::new(inverse_x, inverse_y, inverse_z),
            below: DVec3::new(yx, zx, zy),
        })
    }

    /// L⁻¹ v.
    fn solve(&self, v: DVec3) -> DVec3 {
        let x = v.x * self.inverse.x;
        let y = (v.y - self.below.x * x) * self.inverse.y;
        let z = (v.z - (self.below.y * x + self.below.z * y)) * self.inverse.z;
        DVec3::new(x, y, z)
    }

    /// L⁻ᵀ v.
    fn solve_transposed(&self, v: DVec3) -> DVec3 {
        let z = v.z * self.inverse.z;
        let y = (v.y - self.below.z * z) * self.inverse.y;
        let x = (v.x - (self.below.x * y + self.below.y * z)) * self.inverse.x;
        DVec3::new(x, y, z)
    }

    /// B L⁻ᵀ.
    fn divide(&self, block: &DMat3) -> DMat3 {
        let x = block.x_axis * self.inverse.x;
        let y = (block.y_axis - x * self.below.x) * self.inverse.y;
        let z = (block.z_axis - (x * self.below.y + y * self.below.z)) * self.inverse.z;
        DMat3::from_cols(x, y, z)
    }
}

/// 1/√x. None unless x is positive.
fn inverse_root(x: f64) -> Option<f64> {
    (x > 0.0).then(|| 1.0 / x.sqrt())
}

/// a −= b cᵀ.
fn subtract_product(a: &mut DMat3, b: &DMat3, c: &DMat3) {
    let [x, y, z] = [b.x_axis, b.y_axis, b.z_axis];
    a.x_axis -= x * c.x_axis.x + y * c.y_axis.x + z * c.z_axis.x;
    a.y_axis -= x * c.x_axis.y + y * c.y_axis.y + z * c.z_axis.y;
    a.z_axis -= x * c.x_axis.z + y * c.y_axis.z + z * c.z_axis.z;
}

impl Envelope {
    /// Removes all rows.
    pub(super) fn clear(&mut self) {
        self.blocks.clear();
        self.rows.clear();
    }

    /// Appends a row of zeros that is kept from the block `first` on.
    pub(super) fn push(&mut self, first: usize) {
        let (row, start) = (self.rows.len(), self.blocks.len());
        self.rows.push(Row {
            first,
            start,
            diagonal: Triangle::default(),
        });
        self.blocks.resize(start + row + 1 - first, DMat3::ZERO);
    }

    /// Blocks of a row before the diagonal.
    fn before(&self, row: usize) -> &[DMat3] {
        let Row { first, start, .. } = self.rows[row];
        &self.blocks[start..start + row - first]
    }

    /// Adds a block. What stands above the diagonal is the mirror of what stands below, and is ignored.
    pub(super) fn add(&mut self, row: usize, column: usize, block: DMat3) {
        if column <= row {
            let Row { first, start, .. } = self.rows[row];
            self.blocks[start + column - first] += block;
        }
    }

    /// Replaces the matrix by its factor L with L Lᵀ = A. Returns whether it is positive definite; if not, what is left is of
    /// no use.
    pub(super) fn factorise(&mut self) -> bool {
        for row in 0..self.rows.len() {
            let Row { first, start, .. } = self.rows[row];
            let (above, own) = self.blocks.split_at_mut(start);
            for column in first..row {
                let other = self.rows[column];
                let from = first.max(other.first);
                let theirs =
                    &above[other.start + from - other.first..other.start + column - other.first];
                let (known, rest) = own.split_at_mut(column - first);
                for (a, b) in known[from - first..].iter().zip(theirs) {
                    subtract_product(&mut rest[0], a, b);
                }
                rest[0] = other.diagonal.divide(&rest[0]);
            }
            let Some((diagonal, known)) = own[..=row - first].split_last_mut() else {
                return false;
            };
            for block in known {
                subtract_product(diagonal, block, block);
            }
            let Some(triangle) = Triangle::of(diagonal) else {
                return false;
            };
            self.rows[row].diagonal = triangle;
        }
        true
    }

    /// Solves A x = b with the factor of A. `x` is b before, and the solution after.
    pub(super) fn solve(&self, x: &mut [DVec3]) {
        for row in 0..self.rows.len() {
            let Row {
                first, diagonal, ..
            } = self.rows[row];
            let (known, rest) = x.split_at_mut(row);
            let mut value = rest[0];
            for (block, x) in self.before(row).iter().zip(&known[first..]) {
                value -= *block * *x;
            }
            rest[0] = diagonal.solve(value);
        }
        for row in (0..self.rows.len()).rev() {
            let Row {
                first, diagonal, ..
            } = self.rows[row];
            let (known, rest) = x.split_at_mut(row);
            let value = diagonal.solve_transposed(rest[0]);
            rest[0] = value;
            for (block, x) in self.before(row).iter().zip(&mut known[first..]) {
                *x -= block.transpose() * value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// A matrix with the given first block of each row, and the same one in full.
    fn both(firsts: &[usize], diagonal: f64) -> (Envelope, DMatrix<f64>) {
        let n = firsts.len();
        let (mut envelope, mut full) = (Envelope::default(), DMatrix::zeros(3 * n, 3 * n));
        for (row, first) in firsts.iter().enumerate() {
            envelope.push(*first);
            for column in *first..=row {
                let mut block = DMat3::ZERO;
                for (r, c) in (0..9).map(|at| (at % 3, at / 3)) {
                    let (r, c) = (3 * row + r, 3 * column + c);
                    // The same on either side of the diagonal.
                    let (low, high) = (r.min(c), r.max(c));
                    let value = if r == c {
                        diagonal
                    } else {
                        ((high * 7 + low * 3) % 5) as f64 - 2.0
                    };
                    block.col_mut(c % 3)[r % 3] = value;
                    full[(r, c)] = value;
                    full[(c, r)] = value;
                }
                envelope.add(row, column, block);
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
            let (mut envelope, full) = both(&firsts, 90.0);
            let right = DVector::from_fn(3 * firsts.len(), |i, _| (i as f64 - 3.0) * 1.7);
            let wanted = full.cholesky().expect("a large diagonal").solve(&right);
            assert!(envelope.factorise());
            let mut solution: Vec<_> = right.as_slice().chunks(3).map(DVec3::from_slice).collect();
            envelope.solve(&mut solution);
            for (at, solution) in solution.iter().enumerate() {
                let wanted = DVec3::from_slice(&wanted.as_slice()[3 * at..]);
                assert!((*solution - wanted).length() < 1e-14, "{firsts:?}");
            }
        }
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        assert!(!both(&[0, 0], 0.5).0.factorise());
        assert!(!both(&[0, 0], f64::NAN).0.factorise());
    }
}
