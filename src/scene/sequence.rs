//! Finds the order of bodies within a component. Bodies that elements connect are close together in memory, and the order does
//! not depend on when anything was spawned.
//!
//! The order is breadth first from a body at the rim, as E. Cuthill and J. McKee (1969) number the rows of a sparse matrix. Where
//! their method leaves a choice, the rank of a body decides.

use super::rows::{BodyRow, ElementRow};

/// The neighbours of each body: the bodies to which elements connect it.
pub(crate) struct Neighbours {
    /// Start of each body's neighbours in `all`.
    starts: Vec<u32>,
    all: Vec<u32>,
    /// Number of the last walk that reached each body.
    met: Vec<u32>,
    walk: u32,
    queue: Vec<u32>,
}

impl Neighbours {
    /// Finds the neighbours of all bodies. Only elements for which `sound` returns true count.
    pub(crate) fn of(
        elements: &[ElementRow],
        bodies: &[BodyRow],
        sound: impl Fn(&ElementRow) -> bool,
    ) -> Self {
        let joined = |row: &ElementRow| {
            let [a, b] = [row.movable(0)?, row.movable(1)?];
            (a != b && sound(row)).then_some([a, b])
        };
        let mut starts = vec![0_u32; bodies.len() + 1];
        for body in elements.iter().filter_map(joined).flatten() {
            starts[body + 1] += 1;
        }
        for body in 0..bodies.len() {
            starts[body + 1] += starts[body];
        }
        let mut all = vec![0; starts.last().map_or(0, |end| *end as usize)];
        let mut next = starts.clone();
        for [a, b] in elements.iter().filter_map(joined) {
            for (of, other) in [(a, b), (b, a)] {
                all[next[of] as usize] = other as u32;
                next[of] += 1;
            }
        }
        let mut neighbours = Self {
            starts,
            all,
            met: vec![0; bodies.len()],
            walk: 0,
            queue: Vec::new(),
        };
        for body in 0..bodies.len() {
            let span = neighbours.span(body);
            neighbours.all[span].sort_by_key(|other| bodies[*other as usize].rare.rank);
        }
        neighbours
    }

    fn span(&self, body: usize) -> std::ops::Range<usize> {
        self.starts[body] as usize..self.starts[body + 1] as usize
    }

    /// Sorts the bodies of a component. On entry, the body of least rank must be the first.
    pub(crate) fn arrange(&mut self, component: &mut [u32]) {
        let Some(first) = component.first().copied() else {
            return;
        };
        // The body that the walk reaches last is far from the first body, so it is at the rim.
        self.go(first);
        if let Some(rim) = self.queue.last().copied() {
            self.go(rim);
        }
        if self.queue.len() == component.len() {
            component.copy_from_slice(&self.queue);
        }
    }

    /// Walks over the component of a body, nearest bodies first, and fills the queue with the bodies in that order.
    fn go(&mut self, from: u32) {
        self.walk += 1;
        self.queue.clear();
        self.queue.push(from);
        self.met[from as usize] = self.walk;
        let mut at = 0;
        while let Some(body) = self.queue.get(at).copied() {
            at += 1;
            for next in self.span(body as usize) {
                let other = self.all[next];
                if self.met[other as usize] != self.walk {
                    self.met[other as usize] = self.walk;
                    self.queue.push(other);
                }
            }
        }
    }
}
