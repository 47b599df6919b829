//! The order in which bodies of a component stand: what elements join stands close together in memory, and when anything was
//! spawned changes nothing.
//!
//! Breadth first from a body at the rim, as E. Cuthill and J. McKee (1969) number the rows of a sparse matrix; where they leave
//! a choice, a body's rank decides.

use super::rows::{BodyRow, ElementRow};

/// Which bodies elements join.
pub(crate) struct Neighbours {
    /// Where those of a body begin among all.
    starts: Vec<u32>,
    all: Vec<u32>,
    /// Which walk over its component has met a body last.
    met: Vec<u32>,
    walk: u32,
    queue: Vec<u32>,
}

impl Neighbours {
    /// Of these rows, as far as they are `sound`.
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

    /// Puts the bodies of a component, the one of least rank first, into their order.
    pub(crate) fn arrange(&mut self, component: &mut [u32]) {
        let Some(first) = component.first().copied() else {
            return;
        };
        // The last one met is far from the first: at the rim.
        self.go(first);
        if let Some(rim) = self.queue.last().copied() {
            self.go(rim);
        }
        if self.queue.len() == component.len() {
            component.copy_from_slice(&self.queue);
        }
    }

    /// Meets all bodies of a component, the nearest first.
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
