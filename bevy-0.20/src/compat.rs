// Names and functions that differ between versions of Bevy and Rapier. `src/compat.rs` is for Bevy 0.19 and
// `bevy-0.20/src/compat.rs` is for Bevy 0.20. Both define the same names.

use bevy::ecs::lifecycle::{Add, Insert, Remove};
use bevy::prelude::On;
use bevy_rapier3d::parry::query;
use bevy_rapier3d::parry::shape::Shape;
use bevy_rapier3d::prelude::{RapierContextJoints, RapierRigidBodySet};
use bevy_rapier3d::rapier::dynamics::{IslandManager, RigidBodyHandle, RigidBodySet, SoftBodySet};
use bevy_rapier3d::rapier::geometry::{ColliderSet, SolverFlags};
use bevy_rapier3d::rapier::math::Pose;

pub(crate) use bevy::curve::{Curve, Interval};
#[cfg(feature = "visual")]
pub(crate) use bevy::shape::Primitive3d;

/// Parameter of an observer that runs when a component is added to an entity.
pub(crate) type Added<'w, 't, C> = On<'w, 't, Add<C>>;

/// Parameter of an observer that runs when a component is inserted, whether or not the entity had it before.
pub(crate) type Inserted<'w, 't, C> = On<'w, 't, Insert<C>>;

/// Parameter of an observer that runs when a component is about to be removed.
pub(crate) type Removed<'w, 't, C> = On<'w, 't, Remove<C>>;

/// Path and source of the shader of round wires. Bevy takes the shader language from the end of the path.
#[cfg(feature = "visual")]
pub(crate) const ROUND_WIRE: (&str, &str) = (
    "bevy_coilover/shaders/round_wire.wesl",
    concat!(
        include_str!("../../assets/shaders/round_wire.wesl"),
        include_str!("../../assets/shaders/tube.wgsl"),
    ),
);

/// Flag of the contacts that the engine solves.
pub(crate) const SOLVED: SolverFlags = SolverFlags::COMPUTE_RIGID_IMPULSES;

/// Distance between two shapes, m; 0 where they touch, or where Rapier cannot compute it for these shapes.
pub(crate) fn distance(at: [&Pose; 2], shapes: [&dyn Shape; 2]) -> f32 {
    let [(a, first), (b, second)] = [(at[0], shapes[0]), (at[1], shapes[1])];
    query::distance(a, first, b, second).map_or(0.0, |apart| apart.distance)
}

/// Removes a body from the engine, together with its colliders and joints.
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
    // Callers pass no body that is part of a soft body, so an empty set is enough.
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

/// Soft bodies of a context.
pub(crate) type SoftBodies = SoftBodySet;

/// Returns the soft bodies of a context.
pub(crate) fn soft_bodies(set: &RapierRigidBodySet) -> SoftBodies {
    set.soft_bodies.clone()
}

/// Restores the soft bodies of a context.
pub(crate) fn put_soft_bodies(set: &mut RapierRigidBodySet, soft: &SoftBodies) {
    set.soft_bodies.clone_from(soft);
}
