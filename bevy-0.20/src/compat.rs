// What is called otherwise, or lies elsewhere, in another version of Bevy and Rapier. `src/compat.rs` is for Bevy 0.19,
// `bevy-0.20/src/compat.rs` for 0.20; both have the same names.

use bevy::ecs::lifecycle::{Add, Insert, Remove};
use bevy::prelude::On;
use bevy_rapier3d::parry::query;
use bevy_rapier3d::parry::shape::Shape;
use bevy_rapier3d::prelude::{RapierContextJoints, RapierRigidBodySet};
use bevy_rapier3d::rapier::dynamics::{IslandManager, RigidBodyHandle, RigidBodySet, SoftBodySet};
use bevy_rapier3d::rapier::geometry::{ColliderSet, ContactManifold, ContactPair};
use bevy_rapier3d::rapier::math::Pose;

pub(crate) use bevy::curve::{Curve, Interval};
#[cfg(feature = "visual")]
pub(crate) use bevy::shape::Primitive3d;

/// What an observer gets of a component that was added.
pub(crate) type Added<'w, 't, C> = On<'w, 't, Add<C>>;

/// What an observer gets of a component that was inserted, there before or not.
pub(crate) type Inserted<'w, 't, C> = On<'w, 't, Insert<C>>;

/// What an observer gets of a component that is about to be removed.
pub(crate) type Removed<'w, 't, C> = On<'w, 't, Remove<C>>;

/// The shader of round wires; how its name ends tells Bevy the language.
#[cfg(feature = "visual")]
pub(crate) const ROUND_WIRE: (&str, &str) = (
    "bevy_coilover/shaders/round_wire.wesl",
    concat!(
        include_str!("../../assets/shaders/round_wire.wesl"),
        include_str!("../../assets/shaders/tube.wgsl"),
    ),
);

/// Where two colliders touch.
pub(crate) fn manifolds(pair: &ContactPair) -> &[ContactManifold] {
    pair.manifolds()
}

/// Metres between two shapes; 0 where they touch, or where nobody knows.
pub(crate) fn distance(at: [&Pose; 2], shapes: [&dyn Shape; 2]) -> f32 {
    let [(a, first), (b, second)] = [(at[0], shapes[0]), (at[1], shapes[1])];
    query::distance(a, first, b, second).map_or(0.0, |apart| apart.distance)
}

/// Takes a body, with all that hangs on it, out of the engine.
pub(crate) fn remove(
    handle: RigidBodyHandle,
    bodies: &mut RigidBodySet,
    islands: &mut IslandManager,
    colliders: &mut ColliderSet,
    joints: &mut RapierContextJoints,
) {
    let RapierContextJoints {
        impulse_joints,
        multibody_joints,
        ..
    } = joints;
    // Whoever calls this takes out what is no part of a soft body.
    let soft = &mut SoftBodySet::new();
    bodies.remove(
        handle,
        islands,
        colliders,
        impulse_joints,
        multibody_joints,
        soft,
        true,
    );
}

/// Soft bodies.
pub(crate) type SoftBodies = SoftBodySet;

/// Those of a context.
pub(crate) fn soft_bodies(set: &RapierRigidBodySet) -> SoftBodies {
    set.soft_bodies.clone()
}

/// Puts them back.
pub(crate) fn put_soft_bodies(set: &mut RapierRigidBodySet, soft: &SoftBodies) {
    set.soft_bodies.clone_from(soft);
}
