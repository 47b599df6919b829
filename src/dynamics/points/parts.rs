//! Divides a large network into parts that threads share. The division depends on the network alone. So the result is the
//! same bit for bit for any number of threads.
//!
//! Work on single points or single elements is divided into pieces of equal length, [`PIECE`]. Elements that share a
//! point must not add to it at the same time. Elements and points are sorted so that neighbours in the network are near
//! in memory (`scene::order`). So the points of a run of elements overlap only those of the previous and the next run.
//! Every second run is processed at the same time, and then the others.

use super::Wire;
use super::kick::Bar;
use crate::threads::{PIECE, share};
use std::ops::Range;

/// A run of elements.
#[derive(Clone, Debug)]
struct Part {
    bars: Range<usize>,
    /// Index of the first body that the run touches; 0 for the first run. The bodies of a run end before the first body
    /// of the run after the next.
    first: usize,
}

/// Runs of elements. Two runs that are not neighbours share no body.
#[derive(Clone, Debug, Default)]
pub(super) struct Parts {
    list: Vec<Part>,
    bodies: usize,
}

/// Values of a contiguous range of bodies.
pub(super) struct Window<'a, T> {
    first: usize,
    values: &'a mut [T],
}

impl<T> Window<'_, T> {
    /// The value of a point; none if the point is not a body.
    pub(super) fn of(&mut self, point: u32) -> Option<&mut T> {
        self.values
            .get_mut((point as usize).wrapping_sub(self.first))
    }
}

impl Parts {
    /// Divides a network of `bodies` bodies.
    pub(super) fn find(&mut self, wires: &[Wire], bodies: usize) {
        self.list.clear();
        self.bodies = bodies;
        // End of the range of bodies that all runs but the last have touched.
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

    /// Number of parts.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.list.len()
    }

    /// Lets every element add to the values of its ends.
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
