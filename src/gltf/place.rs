//! Where entities stand in the world, by the `Transform`s of all that they stand below: Bevy's `GlobalTransform` is a frame
//! old, and says nothing before the first frame.

use bevy::prelude::*;

/// What an entity stands below, the nearest first.
pub(super) fn above(world: &World, entity: Entity) -> impl Iterator<Item = Entity> {
    let parent = move |entity: Entity| world.get::<ChildOf>(entity).map(ChildOf::parent);
    std::iter::successors(parent(entity), move |entity| parent(*entity))
}

/// Where an entity stands, as a matrix; `None` if it, or something above it, is nowhere.
pub(super) fn matrix(world: &World, entity: Entity) -> Option<GlobalTransform> {
    let mut matrix = GlobalTransform::from(*world.get::<Transform>(entity)?);
    for parent in above(world, entity) {
        matrix = *world.get::<Transform>(parent)? * matrix;
    }
    Some(matrix)
}

/// The same as a translation, a rotation and a scale; `None`, too, if these are no numbers.
pub(super) fn place(world: &World, entity: Entity) -> Option<Transform> {
    let place = matrix(world, entity)?.compute_transform();
    place.is_finite().then_some(place)
}
