//! Elements that share their bodies with no other and turn neither: each is the closed form of [`crate::dynamics::pair`].
//!
//! Most elements of most scenes are of this kind. All of them are read and solved first, several at a time and on all threads
//! ([`solve`]), and then what they have come to is given to their bodies ([`deliver`]). One that has anything special (locked
//! axes, ends that coincide, one of two bodies asleep) is left to [`super::assembly`] for a step.

mod alone;
mod deliver;
mod solve;
#[cfg(test)]
mod tests;

use super::rows::{BodyRow, ElementFlags, ElementRow};
use crate::backend::BodyId;
use crate::scene::push::Given;
use crate::threads;
use bevy::prelude::Entity;
pub(crate) use solve::{Piece, Worker};

/// The lone elements of a world of the engine.
pub(crate) struct Lone {
    pub context: Entity,
    /// In the order of their rows.
    pub pairs: Vec<Pair>,
}

/// One lone element, and what it moves. All that is needed of it to begin to read; what is read next is known soon enough to
/// come from memory in time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// Index of its row.
    pub element: u32,
    /// Indices of the rows of the bodies that it moves, or [`NONE`],
    bodies: [u32; 2],
    /// and what the engine calls those.
    ids: [BodyId; 2],
}

/// No body.
const NONE: u32 = u32::MAX;

impl Pair {
    fn of(index: usize, row: &ElementRow, bodies: &[BodyRow]) -> Self {
        let mut pair = Self {
            element: index as u32,
            bodies: [NONE; 2],
            ids: [BodyId::NONE; 2],
        };
        for (end, body) in row.movable_ends() {
            pair.bodies[end] = body as u32;
            pair.ids[end] = bodies[body].id;
        }
        pair
    }

    /// Index of the row of the body that it moves at an end, and what the engine calls that.
    #[inline(always)]
    pub(crate) fn movable(&self, end: usize) -> Option<(usize, BodyId)> {
        let body = self.bodies[end];
        (body != NONE).then_some((body as usize, self.ids[end]))
    }

    /// Index of its component.
    pub(crate) fn group(&self, bodies: &[BodyRow]) -> Option<u32> {
        let body = self.movable(0).or(self.movable(1))?;
        Some(bodies[body.0].rare.group)
    }
}

/// How a lone element goes through the step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Route {
    /// It has nothing to do with this step.
    #[default]
    None,
    /// Solved; its bodies are to be given what that takes.
    Solved,
    /// It has no body any more that it could move.
    Gone,
    /// Asleep.
    Asleep,
    /// By the general solver in this step.
    GeneralOnce,
    /// By the general solver for as long as can be seen.
    General,
}

/// What has become of a lone element in the step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Way {
    /// For the bodies at both ends.
    pub given: [Given; 2],
    pub route: Route,
    /// Each of them may be slow enough to be at rest.
    pub slow: [bool; 2],
    /// Each of them has colliders.
    pub can_touch: [bool; 2],
    /// The engine takes one substep alone, and so a second one.
    pub second_substep: bool,
    /// Something was done to it: its bodies must not fall asleep.
    pub disturbed: bool,
}

/// Elements above which it is worth waking other threads. Pinned by the benchmark `own/isolated`.
const WORTH_SHARING: usize = 1024;

/// Pieces for each thread: what one has done sooner, another need not wait for.
const PIECES: usize = 4;

/// Into how many pieces lone elements are cut.
pub(crate) fn pieces(elements: usize) -> usize {
    if elements < WORTH_SHARING {
        return 1;
    }
    match threads::count() {
        0 | 1 => 1,
        threads => PIECES * threads,
    }
}

/// Lists the lone elements of every world; `is_lone` says which rows are.
pub(crate) fn list(
    elements: &[ElementRow],
    bodies: &[BodyRow],
    is_lone: impl Fn(&ElementRow) -> bool,
) -> Vec<Lone> {
    let mut all: Vec<Lone> = Vec::new();
    for (index, row) in elements.iter().enumerate() {
        let Some(body) = row.all_movable().next() else {
            continue;
        };
        if row.trouble.lasting().is_some() || !row.has(ElementFlags::IS_PLAIN) || !is_lone(row) {
            continue;
        }
        let context = bodies[body].rare.context;
        let of = all.iter().position(|lone| lone.context == context);
        let of = of.unwrap_or_else(|| {
            let pairs = Vec::new();
            all.push(Lone { context, pairs });
            all.len() - 1
        });
        all[of].pairs.push(Pair::of(index, row, bodies));
    }
    all
}
