//! Computes the mass of a body from its components. Rapier's own values are those of its last step, and there may
//! have been no step yet.

use super::expand::SUBDIVISIONS;
use super::place::{above, place};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::prelude::{
    ColliderMassProps, MassProperties as RapierMass, Pose, SharedShape,
};

/// A collider that adds to the mass of its body.
struct Part {
    shape: SharedShape,
    weight: ColliderMassProps,
    /// Pose in the body's frame.
    at: Pose,
}

/// Returns the mass properties of a whole body: its colliders plus the additional mass, summed as Rapier does it.
pub(super) fn mass(world: &World, body: EntityRef) -> MassProperties {
    let parts = parts(world, body.id());
    let weights = parts
        .iter()
        .map(|part| (part.weight.mass_properties(&*part.shape), part.at))
        // A massless collider is skipped, because its position would still affect the sum.
        .filter(|(weight, _)| *weight != RapierMass::default());
    let own = weights
        .map(|(weight, at)| weight.transform_by(&at))
        .reduce(|sum, weight| sum + weight);
    let all = match (body.get::<AdditionalMassProperties>(), own) {
        // Returned exactly as given: Rapier stores reciprocals, which would change the last digits.
        (Some(AdditionalMassProperties::MassProperties(given)), None) => return *given,
        (Some(AdditionalMassProperties::MassProperties(given)), Some(own)) => {
            own + given.into_rapier()
        }
        (Some(AdditionalMassProperties::Mass(mass)), Some(mut own)) => {
            own.set_mass(own.mass() + mass, true);
            own
        }
        (Some(AdditionalMassProperties::Mass(mass)), None) => {
            // Even massless colliders determine how the mass is distributed.
            let volumes = parts
                .iter()
                .map(|part| part.shape.mass_properties(1.0).transform_by(&part.at));
            let mut spread = volumes.reduce(|sum, part| sum + part).unwrap_or_default();
            spread.set_mass(*mass, true);
            spread
        }
        (None, own) => own.unwrap_or_default(),
    };
    MassProperties::from_rapier(all)
}

/// Returns the colliders of a body: on it and on its descendants, except those of other bodies below it.
fn parts(world: &World, body: Entity) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut open = vec![body];
    while let Some(entity) = open.pop() {
        let here = world.get_entity(entity).ok();
        parts.extend(here.and_then(|here| part(world, body, here)));
        let children = world.get::<Children>(entity).into_iter().flatten();
        open.extend(children.filter(|child| world.get::<RigidBody>(**child).is_none()));
    }
    parts
}

fn part(world: &World, body: Entity, here: EntityRef) -> Option<Part> {
    let mut collider = here.get::<Collider>()?.clone();
    if here.contains::<ColliderDisabled>() {
        return None;
    }
    let scale = scale(world, here);
    if !scale.is_finite() || scale.cmpeq(Vec3::ZERO).any() {
        return None;
    }
    collider.set_scale(scale, SUBDIVISIONS);
    let given = here.get::<ColliderMassProperties>();
    let weight = match given.copied().unwrap_or_default() {
        ColliderMassProperties::Density(density) => ColliderMassProps::Density(density),
        ColliderMassProperties::Mass(mass) => ColliderMassProps::Mass(mass),
        ColliderMassProperties::MassProperties(given) => {
            ColliderMassProps::from(given.into_rapier())
        }
    };
    let at = offset(world, body, here.id());
    Some(Part {
        shape: collider.raw,
        weight,
        at: Pose::from_parts(at.translation, at.rotation),
    })
}

/// Returns the scale that Rapier applies to the shape of a collider.
fn scale(world: &World, collider: EntityRef) -> Vec3 {
    let of_node = || place(world, collider.id()).unwrap_or_default().scale;
    match collider.get::<ColliderScale>() {
        Some(ColliderScale::Absolute(scale)) => *scale,
        Some(ColliderScale::Relative(scale)) => *scale * of_node(),
        None => of_node(),
    }
}

/// Returns the transform of a collider relative to its body, as Rapier computes it.
fn offset(world: &World, body: Entity, collider: Entity) -> Transform {
    let local = |entity| world.get::<Transform>(entity).copied().unwrap_or_default();
    let up = std::iter::once(collider).chain(above(world, collider));
    let below = up.take_while(|entity| *entity != body);
    let at = below.fold(Transform::IDENTITY, |at, entity| local(entity) * at);
    Transform::from_scale(local(body).scale) * at
}
