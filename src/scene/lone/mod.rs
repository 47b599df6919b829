//! Lone elements: they share their bodies with no other element and do not turn them. The closed form of
//! [`crate::dynamics::pair`] solves each of them.
//!
//! Most elements of most scenes are of this kind. First all of them are read and solved, several at a time and on all threads
//! ([`solve`]). Then their bodies get the results ([`deliver`]). An element with a special case is left to [`super::assembly`]:
//! for one step if its ends coincide or one of two bodies is asleep, for good if a body has locked axes.

mod by_itself;
mod deliver;
mod solve;
#[cfg(test)]
mod tests;

use super::rows::{BodyRow, ElementFlags, ElementRow};
use crate::backend::BodyId;
use crate::scene::push::Given;
use bevy::prelude::{Entity, Vec3};
pub(crate) use solve::{Piece, Worker};

/// The lone elements of a context.
pub(crate) struct Lone {
    pub context: Entity,
    /// In the order of their rows.
    pub pairs: Vec<LonePair>,
}

/// One lone element and the bodies that it moves: all that is needed to begin to read it. So the processor knows early
/// which rows it must load from memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LonePair {
    /// Index of its row.
    pub element: u32,
    /// Row indices of the bodies that it moves, or [`NONE`].
    bodies: [u32; 2],
    /// Engine handles of the bodies that it moves.
    ids: [BodyId; 2],
    /// Centres of mass of these bodies in their frames when the rows were made, m. The element holds them there.
    centers: [Vec3; 2],
}

/// Index that stands for no body.
const NONE: u32 = u32::MAX;

impl LonePair {
    fn of(index: usize, row: &ElementRow, bodies: &[BodyRow]) -> Self {
        let mut pair = Self {
            element: index as u32,
            bodies: [NONE; 2],
            ids: [BodyId::NONE; 2],
            centers: [Vec3::ZERO; 2],
        };
        for (end, body) in row.movable_ends() {
            pair.bodies[end] = body as u32;
            pair.ids[end] = bodies[body].id;
            pair.centers[end] = bodies[body].rare.center;
        }
        pair
    }

    /// Row index and engine handle of the body at an end, if the element moves it.
    #[inline(always)]
    pub(crate) fn movable(&self, end: usize) -> Option<(usize, BodyId)> {
        let body = self.bodies[end];
        (body != NONE).then_some((body as usize, self.ids[end]))
    }

    /// Index of its group.
    pub(crate) fn group(&self, bodies: &[BodyRow]) -> Option<u32> {
        let body = self.movable(0).or(self.movable(1))?;
        Some(bodies[body.0].rare.group)
    }
}

/// How a lone element goes through the step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Route {
    /// Not solved here, because contacts or joints hold its component.
    #[default]
    None,
    /// Solved. Its bodies must be given their pushes.
    Solved,
    /// Not solved, because one of its bodies can no longer be moved.
    Gone,
    /// Asleep.
    Asleep,
    /// Needs the general solver in this step.
    GeneralOnce,
    /// Needs the general solver in this step and in later ones.
    General,
}

/// Result of a lone element in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Way {
    /// Velocity and force for the body at each end.
    pub given: [Given; 2],
    pub route: Route,
    /// Whether the body at each end may be slow enough to rest.
    pub slow: [bool; 2],
    /// Whether the body at each end has colliders.
    pub can_touch: [bool; 2],
    /// Whether the bodies must be given a second substep, because the engine would take only one.
    pub second_substep: bool,
    /// Whether the element or one of its ends was changed, so that its bodies must not fall asleep.
    pub disturbed: bool,
}

/// Number of elements from which on several threads are worth their start-up time. Pinned by the benchmark `own/isolated`.
pub(crate) const WORTH_SHARING: usize = 1024;

/// Lists the lone elements of every context. `is_lone` says which of the plain elements are lone.
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
        all[of].pairs.push(LonePair::of(index, row, bodies));
    }
    for lone in &mut all {
        lone.pairs.shrink_to_fit();
    }
    all
}
