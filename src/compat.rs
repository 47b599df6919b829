// What is called otherwise, or lies elsewhere, in another version of Bevy and Rapier. `src/compat.rs` is for Bevy 0.19,
// `bevy-0.20/src/compat.rs` for 0.20; both have the same names.

use bevy::ecs::lifecycle::{Add, Insert, Remove};
use bevy::prelude::On;
use bevy_rapier3d::parry::query;
use bevy_rapier3d::parry::shape::Shape;
use bevy_rapier3d::prelude::{RapierContextJoints, RapierRigidBodySet};
use bevy_rapier3d::rapier::dynamics::{IslandManager, RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{ColliderSet, ContactManifold, ContactPair};
use bevy_rapier3d::rapier::math::Pose;

#[cfg(feature = "visual")]
pub(crate) use bevy::math::primitives::Primitive3d;
pub(crate) use bevy_math::curve::{Curve, Interval};

/// What an observer gets of a component that was added.
pub(crate) type Added<'w, 't, C> = On<'w, 't, Add, C>;

/// What an observer gets of a component that was inserted, there before or not.
pub(crate) type Inserted<'w, 't, C> = On<'w, 't, Insert, C>;

/// What an observer gets of a component that is about to be removed.
pub(crate) type Removed<'w, 't, C> = On<'w, 't, Remove, C>;

/// The shader of round wires; how its name ends tells Bevy the language.
#[cfg(feature = "visual")]
pub(crate) const ROUND_WIRE: (&str, &str) = (
    "bevy_coilover/shaders/round_wire.wgsl",
    concat!(
        include_str!("../assets/shaders/round_wire.wgsl"),
        include_str!("../assets/shaders/tube.wgsl"),
    ),
);

/// Where two colliders touch.
pub(crate) fn manifolds(pair: &ContactPair) -> &[ContactManifold] {
    &pair.manifolds
}

/// Metres between two shapes; 0 where they touch, or where nobody knows.
pub(crate) fn distance(at: [&Pose; 2], shapes: [&dyn Shape; 2]) -> f32 {
    let [(a, first), (b, second)] = [(at[0], shapes[0]), (at[1], shapes[1])];
    query::distance(a, first, b, second).unwrap_or(0.0)
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
    bodies.remove(
        handle,
        islands,
        colliders,
        impulse_joints,
        multibody_joints,
        true,
    );
}

/// Soft bodies, which this version has not.
pub(crate) type SoftBodies = ();

/// Those of a context.
pub(crate) fn soft_bodies(_: &RapierRigidBodySet) -> SoftBodies {}

/// Puts them back.
pub(crate) fn put_soft_bodies(_: &mut RapierRigidBodySet, (): &SoftBodies) {}
