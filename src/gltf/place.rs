//! Computes transforms in the world from the `Transform`s of an entity and its ancestors. Bevy's `GlobalTransform` is
//! a frame old, and is not set before the first frame.

use bevy::prelude::*;

/// Returns the ancestors of an entity, the nearest first.
pub(super) fn above(world: &World, entity: Entity) -> impl Iterator<Item = Entity> {
    let parent = move |entity: Entity| world.get::<ChildOf>(entity).map(ChildOf::parent);
    std::iter::successors(parent(entity), move |entity| parent(*entity))
}

/// Returns the transform of an entity in the world, as a matrix; `None` if the entity or an ancestor has no
/// `Transform`.
pub(super) fn matrix(world: &World, entity: Entity) -> Option<GlobalTransform> {
    let mut matrix = GlobalTransform::from(*world.get::<Transform>(entity)?);
    for parent in above(world, entity) {
        matrix = *world.get::<Transform>(parent)? * matrix;
    }
    Some(matrix)
}

/// Returns the transform of an entity in the world, as translation, rotation and scale; `None` if the entity or an
/// ancestor has no `Transform`, or if the result is not finite.
pub(super) fn place(world: &World, entity: Entity) -> Option<Transform> {
    let place = matrix(world, entity)?.compute_transform();
    place.is_finite().then_some(place)
}
