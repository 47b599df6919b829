//! Which body an end belongs to. Axes and angles are those of bodies, also where an end is a descendant of one.

use crate::input::named_ends::and_above;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_rapier3d::prelude::RigidBody;

/// Finds the bodies of ends.
#[derive(SystemParam)]
pub(super) struct Bodies<'w, 's> {
    bodies: Query<'w, 's, (), With<RigidBody>>,
    parents: Query<'w, 's, &'static ChildOf>,
}

impl Bodies<'_, '_> {
    /// The body that an end belongs to: the end itself or its nearest ancestor that is a body. If there is none, it is
    /// the end.
    pub fn of(&self, end: Entity) -> Entity {
        let mut up = and_above(end, &self.parents);
        let body = up.find(|entity| self.bodies.contains(*entity));
        body.unwrap_or(end)
    }
}
