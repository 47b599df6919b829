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

/// Why [`place`] may return `None` for a node of a file.
pub(super) const NOWHERE: &str = "its transform is not finite, or its scale is zero along an axis";

/// Returns the transform of an entity in the world, as translation, rotation and scale; `None` if the entity or an
/// ancestor has no `Transform`, or if the result is not finite. A scale of zero gives no rotation that is finite.
pub(super) fn place(world: &World, entity: Entity) -> Option<Transform> {
    let mut place = matrix(world, entity)?.compute_transform();
    if !place.is_finite() {
        return None;
    }
    place.rotation = rotation(world, entity)?;
    place.is_finite().then_some(place)
}

/// Returns the rotation of an entity in the world: the product of the rotations of its ancestors and of itself. An
/// uneven scale of an ancestor would skew a rotation that is taken from the matrix. A negative scale counts by its
/// sign; what is mirrored has its X axis reversed, as in [`GlobalTransform::compute_transform`].
fn rotation(world: &World, entity: Entity) -> Option<Quat> {
    let mut turned = Mat3::IDENTITY;
    for entity in std::iter::once(entity).chain(above(world, entity)) {
        let local = world.get::<Transform>(entity)?;
        let mirrored = Mat3::from_diagonal(local.scale.signum());
        turned = Mat3::from_quat(local.rotation.normalize()) * mirrored * turned;
    }
    if turned.determinant() < 0.0 {
        turned.x_axis = -turned.x_axis;
    }
    Some(Quat::from_mat3(&turned))
}
