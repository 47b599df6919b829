//! Divides a large network into parts that threads share. The division depends on the network alone. So the result is the
//! same bit for bit for any number of threads.
//!
//! Work on single points or single elements is divided into pieces of equal length, [`PIECE`]. Elements that share a
//! point must not add to it at the same time. Elements and points are sorted so that neighbours in the network are near
//! in memory (`scene::sequence`). So the points of a run of elements overlap only those of the previous and the next run, if
//! runs are long enough.
//! Every second run is processed at the same time ([`Stage::Even`]), and then the others ([`Stage::Odd`]).
//!
//! In each stage, every body belongs to one run. So what a body needs before all its elements is done in the first stage,
//! and what it needs after them in the last, while the body is in the processor's cache anyway.

use super::Wire;
use crate::threads::{PIECE, share};
use std::mem::{replace, take};
use std::ops::Range;

/// Least number of runs: of fewer, most of the work would be in one. Pinned by the benchmark `own/Cloth`.
const LEAST: usize = 4;

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

/// Which runs are processed at the same time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stage {
    /// All elements, because there is only one run.
    Whole,
    Even,
    Odd,
}

impl Stage {
    /// Whether no element has been processed before.
    #[inline(always)]
    pub(super) fn is_first(self) -> bool {
        self != Self::Odd
    }

    /// Whether all elements have been processed after it.
    #[inline(always)]
    pub(super) fn is_last(self) -> bool {
        self != Self::Even
    }
}

/// Elements of a run, and the bodies that no other run touches in its stage.
pub(super) struct Run<E, B> {
    pub elements: E,
    pub bodies: B,
    /// Index of its first body.
    pub first: usize,
}

/// Places of the ends of an element among the bodies of a run, the first of which has the index `first`. An end that is
/// not a body has a place beyond all of them.
#[inline(always)]
pub(super) fn places(ends: [u32; 2], first: usize) -> [usize; 2] {
    let [a, b] = ends;
    [
        (a as usize).wrapping_sub(first),
        (b as usize).wrapping_sub(first),
    ]
}

/// Lists that are divided at the same place.
pub(super) trait Split: Sized + Send + Default {
    /// The values before `at`, and the others.
    fn split(self, at: usize) -> (Self, Self);
}

impl<T: Sync> Split for &[T] {
    fn split(self, at: usize) -> (Self, Self) {
        self.split_at(at)
    }
}

impl<T: Send> Split for &mut [T] {
    fn split(self, at: usize) -> (Self, Self) {
        self.split_at_mut(at)
    }
}

impl<A: Split, B: Split> Split for (A, B) {
    fn split(self, at: usize) -> (Self, Self) {
        let ((a, c), (b, d)) = (self.0.split(at), self.1.split(at));
        ((a, b), (c, d))
    }
}

impl<A: Split, B: Split, C: Split> Split for (A, B, C) {
    fn split(self, at: usize) -> (Self, Self) {
        let ((a, (b, c)), (d, (e, f))) = (self.0, (self.1, self.2)).split(at);
        ((a, b, c), (d, e, f))
    }
}

impl Parts {
    /// Divides a network of `bodies` bodies into as many runs as possible. The wider the network is, the longer its runs have to be.
    pub(super) fn find(&mut self, wires: &[Wire], bodies: usize) {
        self.bodies = bodies;
        let mut length = PIECE;
        while wires.len().div_ceil(length) >= LEAST {
            if self.divide(wires, length) {
                return;
            }
            length *= 2;
        }
        self.list.clear();
        self.list.push(Part {
            bars: 0..wires.len(),
            first: 0,
        });
    }

    /// Divides a network into runs of so many elements. Returns whether runs that are not neighbours share no body.
    fn divide(&mut self, wires: &[Wire], length: usize) -> bool {
        self.list.clear();
        let bodies = self.bodies;
        // End of the range of bodies that all runs but the last have touched.
        let (mut touched, mut last) = (0, 0);
        for (at, run) in wires.chunks(length).enumerate() {
            let ends = run.iter().flat_map(|wire| wire.ends);
            let ends = ends.map(|end| end as usize).filter(|end| *end < bodies);
            let (least, most) = ends.fold((usize::MAX, 0), |(a, b), e| (a.min(e), b.max(e + 1)));
            let least = least.min(bodies);
            let ahead = self.list.last().is_none_or(|part| least >= part.first);
            if !ahead || least < touched {
                return false;
            }
            (touched, last) = (touched.max(last), most);
            let start = at * length;
            self.list.push(Part {
                bars: start..start + run.len(),
                first: if at == 0 { 0 } else { least },
            });
        }
        true
    }

    /// Number of parts.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.list.len()
    }

    /// The stages of a pass over all elements.
    pub(super) fn stages(&self) -> &'static [Stage] {
        if self.list.len() > 1 {
            &[Stage::Even, Stage::Odd]
        } else {
            &[Stage::Whole]
        }
    }

    /// Number of runs in a stage.
    fn count_in(&self, stage: Stage) -> usize {
        match stage {
            Stage::Whole | Stage::Even => self.list.len().div_ceil(2),
            // One more, without elements, has the bodies before those of the second run.
            Stage::Odd => 1 + self.list.len() / 2,
        }
    }

    /// Does a stage of a pass over all elements. `elements` and `bodies` are lists of what the work needs of them.
    pub(super) fn pass<E: Split, B: Split>(
        &self,
        stage: Stage,
        elements: E,
        bodies: B,
        work: impl Fn(Run<E, B>) + Sync,
    ) {
        let mut nothing = vec![];
        self.pass_with(stage, elements, bodies, &mut nothing, |run, _: &mut ()| {
            work(run)
        });
    }

    /// Like [`Self::pass`], but the work also has a result for each run.
    pub(super) fn pass_with<E: Split, B: Split, T: Default + Send>(
        &self,
        stage: Stage,
        mut elements: E,
        mut bodies: B,
        results: &mut Vec<T>,
        work: impl Fn(Run<E, B>, &mut T) + Sync,
    ) {
        results.clear();
        results.resize_with(self.count_in(stage), T::default);
        // Number of elements and bodies that have been taken from the lists.
        let (mut met, mut first) = (0, 0);
        let runs = results.iter_mut().enumerate().map(|(k, result)| {
            // Index of the next run of this stage.
            let next = 2 * k + if stage == Stage::Odd { 1 } else { 2 };
            let own = next
                .checked_sub(2)
                .map_or(0..0, |own| self.list[own].bars.clone());
            let end = self.list.get(next).map_or(self.bodies, |part| part.first);
            let (_, rest) = take(&mut elements).split(own.start - met);
            let (elements_here, rest) = rest.split(own.len());
            elements = rest;
            let (bodies_here, rest) = take(&mut bodies).split(end - first);
            bodies = rest;
            met = own.end;
            let run = Run {
                elements: elements_here,
                bodies: bodies_here,
                first: replace(&mut first, end),
            };
            (run, result)
        });
        share(runs, |(run, result)| work(run, result));
    }
}
