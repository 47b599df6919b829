//! Divides rows into runs, so that several threads can write to them.

use std::mem::{replace, take};
use std::ops::{Index, IndexMut};

/// Rows that are accessed by their indices among all rows.
pub(crate) trait Rows<T>: Index<usize, Output = T> {}

impl<T, R: Index<usize, Output = T> + ?Sized> Rows<T> for R {}

/// Rows that can be written to.
pub(crate) trait RowsMut<T>: IndexMut<usize, Output = T> {}

impl<T, R: IndexMut<usize, Output = T> + ?Sized> RowsMut<T> for R {}

/// A run of consecutive rows.
pub(crate) struct Cut<'a, T> {
    rows: &'a mut [T],
    /// Index of the first row of the run among all rows.
    first: usize,
}

impl<'a, T> Cut<'a, T> {
    /// A run of all rows.
    pub(crate) fn all(rows: &'a mut [T]) -> Self {
        Self { rows, first: 0 }
    }

    /// Borrows the run again.
    pub(crate) fn again(&mut self) -> Cut<'_, T> {
        Cut {
            rows: self.rows,
            first: self.first,
        }
    }

    /// Splits off the rows before the index `end` and returns them.
    pub(crate) fn take_before(&mut self, end: usize) -> Self {
        let end = end.clamp(self.first, self.first + self.rows.len());
        let (rows, others) = take(&mut self.rows).split_at_mut(end - self.first);
        self.rows = others;
        Self {
            rows,
            first: replace(&mut self.first, end),
        }
    }
}

impl<T> Index<usize> for Cut<'_, T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, at: usize) -> &T {
        &self.rows[at - self.first]
    }
}

impl<T> IndexMut<usize> for Cut<'_, T> {
    #[inline(always)]
    fn index_mut(&mut self, at: usize) -> &mut T {
        &mut self.rows[at - self.first]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_run_knows_its_rows_by_their_places_among_all() {
        let mut rows = [0, 1, 2, 3, 4];
        let mut rest = Cut::all(&mut rows);
        let mut first = rest.take_before(2);
        let none = rest.take_before(2);
        let second = rest.take_before(4);
        first[1] += 10;
        assert_eq!((first[0], first[1]), (0, 11));
        assert!(none.rows.is_empty());
        assert_eq!((second[2], second[3], rest[4]), (2, 3, 4));
        assert_eq!(rest.again()[4], 4);
    }
}
