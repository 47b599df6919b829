use super::check::Fault;
use bevy::math::DVec3;
use bevy::prelude::*;

/// What an element remembers from step to step; not part of its public state.
#[derive(Component, Clone, Debug, Default)]
pub struct ElementMemory {
    /// Last well-defined direction from end A to end B.
    pub(super) direction: Option<DVec3>,
    pub(super) ends: [EndMemory; 2],
    /// The engine step in which that was noted.
    pub(super) step: u64,
    /// What was reported last, so that each message comes once.
    pub(super) fault: Option<Fault>,
}

/// What is remembered of one end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EndMemory {
    /// Where the end was after the last step it acted in: on a body that elements can move, a point of
    /// that body; else a point of the world.
    pub place: Option<(Entity, DVec3)>,
    /// The body's scale, held against the rounding noise of its transform.
    pub scale: Option<(Entity, DVec3)>,
}
