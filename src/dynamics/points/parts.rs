//! A large network cut into parts, which threads share. How many threads there are changes no bit of what comes out: where a
//! network is cut depends on the network alone.
//!
//! What each point or each element has for itself is cut at even lengths, [`PIECE`]. Where elements add to their points, two
//! that share a point must not go at one time. Elements and points stand so that what is near each other in the network is near
//! in memory (`scene::order`), so a run of elements touches a run of points that overlaps those of the next run and the last
//! alone: every second run goes at one time, and then the others.

use super::Wire;
use super::kick::Bar;
use crate::threads::{PIECE, share};
use std::ops::Range;

/// A run of elements.
#[derive(Clone, Debug)]
struct Part {
    bars: Range<usize>,
    /// Index of the first body that they touch; the last part's end at the number of bodies.
    first: usize,
}

/// Runs of elements, of which no two that are not neighbours share a body.
#[derive(Clone, Debug, Default)]
pub(super) struct Parts {
    list: Vec<Part>,
    bodies: usize,
}

/// A run of what there is for each body.
pub(super) struct Window<'a, T> {
    first: usize,
    values: &'a mut [T],
}

impl<T> Window<'_, T> {
    /// What there is for a point; none for one that is not a body.
    pub(super) fn of(&mut self, point: u32) -> Option<&mut T> {
        self.values
            .get_mut((point as usize).wrapping_sub(self.first))
    }
}

impl Parts {
    /// Cuts a network of so many bodies.
    pub(super) fn find(&mut self, wires: &[Wire], bodies: usize) {
        self.list.clear();
        self.bodies = bodies;
        // The end of what has been touched by all parts but the last.
        let (mut touched, mut last) = (0, 0);
        for (at, run) in wires.chunks(PIECE).enumerate() {
            let ends = run.iter().flat_map(|wire| wire.ends);
            let ends = ends.map(|end| end as usize).filter(|end| *end < bodies);
            let (least, most) = ends.fold((usize::MAX, 0), |(a, b), e| (a.min(e), b.max(e + 1)));
            let least = least.min(bodies);
            let ahead = self.list.last().is_none_or(|part| least >= part.first);
            if !ahead || least < touched {
                return self.be_whole(wires.len());
            }
            (touched, last) = (touched.max(last), most);
            let start = at * PIECE;
            self.list.push(Part {
                bars: start..start + run.len(),
                first: if at == 0 { 0 } else { least },
            });
        }
        if self.list.is_empty() {
            self.be_whole(wires.len());
        }
    }

    fn be_whole(&mut self, bars: usize) {
        self.list.clear();
        self.list.push(Part {
            bars: 0..bars,
            first: 0,
        });
    }

    /// How many they are.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.list.len()
    }

    /// Has every element add to what there is for its ends.
    pub(super) fn scatter<T: Send>(
        &self,
        bars: &[Bar],
        to: &mut [T],
        add: impl Fn(&Bar, &mut Window<T>) + Sync,
    ) {
        for parity in 0..self.list.len().min(2) {
            let mut at = self.list[parity].first;
            let mut rest = &mut to[at..self.bodies];
            let pieces = (parity..self.list.len()).step_by(2).map(|k| {
                let end = self.list.get(k + 2).map_or(self.bodies, |part| part.first);
                let (values, others) = std::mem::take(&mut rest).split_at_mut(end - at);
                rest = others;
                let first = std::mem::replace(&mut at, end);
                (&bars[self.list[k].bars.clone()], Window { first, values })
            });
            share(pieces, |(bars, mut window)| {
                for bar in bars {
                    add(bar, &mut window);
                }
            });
        }
    }
}
