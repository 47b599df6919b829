//! Snapshots of Rapier's own state, and how they are restored.

use crate::backend::rapier::kept::{is_disturbed, note_engine};
use crate::compat::{self, SoftBodies};
use crate::snapshot::SnapshotError;
use bevy::ecs::entity::{EntityHashSet, EntityMapper, MapEntities};
use bevy::prelude::*;
use bevy_rapier3d::plugin::systems::writeback_rigid_bodies;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{
    CCDSolver, ImpulseJointHandle, ImpulseJointSet, IntegrationParameters, IslandManager,
    MultibodyJointHandle, MultibodyJointSet, RigidBodyHandle, RigidBodySet,
};
use bevy_rapier3d::rapier::geometry::{BroadPhaseBvh, ColliderHandle, ColliderSet, NarrowPhase};
use bevy_rapier3d::rapier::math::Pose;
use bevy_rapier3d::rapier::pipeline::PhysicsPipeline;
use std::collections::HashMap;

/// The state that Rapier keeps from one tick to the next, in all contexts.
///
/// Most of this state is in public components of `bevy_rapier3d` that are `Clone`. Two parts are not:
/// `RapierContextSimulation`, and the map from entities to handles. So the snapshot copies the parts one by one and does not
/// restore handles. To restore it:
///
/// - Each body, collider and joint must still have the handle that it had. It has, unless it was despawned meanwhile. If a
///   body may have to come back, give it `RigidBodyDisabled` until you are sure, instead of despawning it.
/// - First despawn bodies, colliders and joints that were spawned after the snapshot.
/// - In another world, handles are the same if everything was spawned in the same order and nothing was despawned before.
///
/// Restoring also sets `Transform`, `Velocity` and `Sleeping` of bodies, as Rapier writes them after a step, also while the game is
/// paused. It restores the poses in `TransformInterpolation` of bodies that have it. It gives `RigidBodyDisabled` to
/// the bodies that had it, and takes it from all others. A body that is disabled both in the snapshot and now keeps its `Transform`,
/// because Rapier writes none of a disabled body.
///
/// The snapshot contains no events and no other components of the game, such as `ExternalForce` of bodies without springs.
/// Restore such a force with `bypass_change_detection`, because Rapier wakes a body whose force is written.
///
/// Rapier does not check its own data. So restore only snapshots from sources that you trust: a forged one can make Rapier panic
/// or hang.
#[derive(Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct RapierSnapshot(Vec<Context>);

/// The state of one Rapier context.
#[derive(Clone)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Context {
    entity: Entity,
    /// Time by which the simulation is behind the renderer, s.
    lag: f32,
    bodies: RigidBodySet,
    soft_bodies: SoftBodies,
    colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    ccd_solver: CCDSolver,
    parameters: IntegrationParameters,
    handles: Handles,
    /// Bodies that the game has disabled.
    disabled: Vec<Entity>,
    /// Start and end of the motion that is drawn, of each body that is drawn between two steps.
    interpolations: Vec<(Entity, [Option<Pose>; 2])>,
}

/// The handle of each entity.
#[derive(Clone, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct Handles {
    bodies: Vec<(Entity, RigidBodyHandle)>,
    colliders: Vec<(Entity, ColliderHandle)>,
    impulse_joints: Vec<(Entity, ImpulseJointHandle)>,
    multibody_joints: Vec<(Entity, MultibodyJointHandle)>,
}

/// The components of a context that are written.
type Parts = (
    &'static mut RapierContextSimulation,
    &'static mut RapierRigidBodySet,
    &'static mut RapierContextColliders,
    &'static mut RapierContextJoints,
    &'static mut SimulationToRenderTime,
);

type PartsItem<'a> = (
    Mut<'a, RapierContextSimulation>,
    Mut<'a, RapierRigidBodySet>,
    Mut<'a, RapierContextColliders>,
    Mut<'a, RapierContextJoints>,
    Mut<'a, SimulationToRenderTime>,
);

impl RapierSnapshot {
    /// Takes a snapshot. It is empty if there is no `RapierPhysicsPlugin`.
    pub fn take(world: &World) -> Self {
        let Some(mut contexts) = world.try_query::<(
            Entity,
            &RapierContextSimulation,
            &RapierRigidBodySet,
            &RapierContextColliders,
            &RapierContextJoints,
            &SimulationToRenderTime,
        )>() else {
            return Self(Vec::new());
        };
        let contexts = contexts.iter(world);
        let mut all: Vec<_> = contexts
            .map(
                |(entity, simulation, set, colliders, joints, lag)| Context {
                    entity,
                    lag: lag.diff,
                    bodies: set.bodies.clone(),
                    soft_bodies: compat::soft_bodies(set),
                    colliders: colliders.colliders.clone(),
                    impulse_joints: joints.impulse_joints.clone(),
                    multibody_joints: joints.multibody_joints.clone(),
                    islands: simulation.islands.clone(),
                    broad_phase: simulation.broad_phase.clone(),
                    narrow_phase: simulation.narrow_phase.clone(),
                    ccd_solver: simulation.ccd_solver.clone(),
                    parameters: simulation.integration_parameters,
                    handles: Handles {
                        bodies: sorted(set.entity2body()),
                        colliders: sorted(colliders.entity2collider()),
                        impulse_joints: sorted(joints.entity2impulse_joint()),
                        multibody_joints: sorted(joints.entity2multibody_joint()),
                    },
                    disabled: disabled(world, set),
                    interpolations: interpolations(world, set),
                },
            )
            .collect();
        all.sort_by_key(|context| context.entity);
        Self(all)
    }

    /// Restores Rapier's state. If the snapshot does not fit the world, nothing is changed.
    pub fn restore(&self, world: &mut World) -> Result<(), SnapshotError> {
        if !world.contains_resource::<TimestepMode>() {
            return Err(SnapshotError::NoPlugin);
        }
        let mut contexts = world.query::<Parts>();
        let places = self.places(world);
        for (context, place) in self.0.iter().zip(&places) {
            if contexts.get(world, *place).is_err() {
                return Err(SnapshotError::NoContext(*place));
            }
            context.handles.check(*place, world)?;
        }
        for (context, place) in self.0.iter().zip(&places) {
            if let Ok(parts) = contexts.get_mut(world, *place) {
                context.put(parts);
            }
        }
        let disturbed = is_disturbed(world);
        // Rapier writes back only the bodies that are enabled by the components of both times.
        let mut behind = false;
        for context in &self.0 {
            context.put_interpolations(world);
            behind |= context.set_disabled(false, world);
        }
        // Rapier writes nothing back in a context that is paused.
        let paused = set_active(world, |_, active| !active, true);
        // The write-back also records what it wrote, so that bevy_rapier does not take it for changes by the game.
        let written = world.run_system_cached(writeback_rigid_bodies);
        set_active(world, |context, _| paused.contains(&context), false);
        for context in &self.0 {
            behind |= context.set_disabled(true, world);
        }
        note_engine(world, !(disturbed || behind));
        written.map_err(|_| SnapshotError::NoPlugin)
    }

    /// The entities of the snapshot's contexts in a world. If snapshot and world each have only one context, they match whatever
    /// the entity.
    fn places(&self, world: &mut World) -> Vec<Entity> {
        let mut there = world.query_filtered::<Entity, With<RapierContextSimulation>>();
        let mut there = there.iter(world);
        match (&self.0[..], there.next(), there.next()) {
            ([_], Some(only), None) => vec![only],
            _ => self.0.iter().map(|context| context.entity).collect(),
        }
    }
}

impl Context {
    fn put(&self, parts: PartsItem) {
        let (mut simulation, mut set, mut colliders, mut joints, mut lag) = parts;
        lag.diff = self.lag;
        set.bodies.clone_from(&self.bodies);
        compat::put_soft_bodies(&mut set, &self.soft_bodies);
        colliders.colliders.clone_from(&self.colliders);
        joints.impulse_joints.clone_from(&self.impulse_joints);
        joints.multibody_joints.clone_from(&self.multibody_joints);
        simulation.islands.clone_from(&self.islands);
        simulation.broad_phase.clone_from(&self.broad_phase);
        simulation.narrow_phase.clone_from(&self.narrow_phase);
        simulation.ccd_solver.clone_from(&self.ccd_solver);
        simulation.integration_parameters = self.parameters;
        // The pipeline detects changes of joints by a counter, which now has an earlier value.
        simulation.pipeline = PhysicsPipeline::new();
    }

    /// Restores between which poses bodies are drawn.
    fn put_interpolations(&self, world: &mut World) {
        for (entity, [start, end]) in &self.interpolations {
            if let Some(mut drawn) = world.get_mut::<TransformInterpolation>(*entity) {
                (drawn.start, drawn.end) = (*start, *end);
            }
        }
    }

    /// Gives `RigidBodyDisabled` to the bodies that had it (`is`), or takes it from those that had it not. Returns whether the
    /// engine did not follow the component of such a body yet.
    fn set_disabled(&self, is: bool, world: &mut World) -> bool {
        let then: EntityHashSet = self.disabled.iter().copied().collect();
        let mut behind = false;
        for (entity, handle) in &self.handles.bodies {
            let Ok(mut body) = world.get_entity_mut(*entity) else {
                continue;
            };
            if then.contains(entity) != is || body.contains::<RigidBodyDisabled>() == is {
                continue;
            }
            if is {
                body.insert(RigidBodyDisabled);
            } else {
                body.remove::<RigidBodyDisabled>();
            }
            let of = self.bodies.get(*handle);
            behind |= of.is_some_and(|body| body.is_enabled() == is);
        }
        behind
    }
}

/// Sets whether Rapier steps the contexts for which `is_meant` holds: it gets the context and whether Rapier steps it now. Returns
/// those contexts. No system notices.
fn set_active(
    world: &mut World,
    is_meant: impl Fn(Entity, bool) -> bool,
    active: bool,
) -> Vec<Entity> {
    let mut meant = Vec::new();
    let mut contexts = world.query::<(Entity, &mut RapierConfiguration)>();
    for (context, mut configuration) in contexts.iter_mut(world) {
        if is_meant(context, configuration.physics_pipeline_active) {
            configuration
                .bypass_change_detection()
                .physics_pipeline_active = active;
            meant.push(context);
        }
    }
    meant
}

/// The bodies of a context that are drawn between two steps, sorted, with the poses between which they are drawn.
fn interpolations(world: &World, set: &RapierRigidBodySet) -> Vec<(Entity, [Option<Pose>; 2])> {
    let bodies = set.entity2body().keys();
    let mut all: Vec<_> = bodies
        .filter_map(|body| {
            let drawn = world.get::<TransformInterpolation>(*body)?;
            Some((*body, [drawn.start, drawn.end]))
        })
        .collect();
    all.sort_unstable_by_key(|(body, _)| *body);
    all
}

/// The bodies of a context that the game has disabled, sorted, so that the same world gives the same snapshot.
fn disabled(world: &World, set: &RapierRigidBodySet) -> Vec<Entity> {
    let bodies = set.entity2body().keys().copied();
    let has = |body: &Entity| world.get::<RigidBodyDisabled>(*body).is_some();
    let mut all: Vec<_> = bodies.filter(has).collect();
    all.sort_unstable();
    all
}

impl Handles {
    /// Checks that entities have the same handles in a context of a world.
    fn check(&self, context: Entity, world: &World) -> Result<(), SnapshotError> {
        use SnapshotError::{NoBody, NoCollider, NoContext, NoJoint};
        // Two contexts may have the same handles.
        let is_here = |e| world.get(e) == Some(&RapierContextEntityLink(context));
        let handle = |e| world.get::<RapierRigidBodyHandle>(e).map(|h| h.0);
        let bodies = |e| handle(e).filter(|_| is_here(e));
        let colliders = |e| world.get::<RapierColliderHandle>(e).map(|h| h.0);
        let joints = |e| world.get::<RapierImpulseJointHandle>(e).map(|h| h.0);
        let multibody_joints = |e| world.get::<RapierMultibodyJointHandle>(e).map(|h| h.0);
        let missing = NoContext(context);
        let set = world.get::<RapierRigidBodySet>(context).ok_or(missing)?;
        let all_colliders = world
            .get::<RapierContextColliders>(context)
            .ok_or(missing)?;
        let all_joints = world.get::<RapierContextJoints>(context).ok_or(missing)?;
        fit(&self.bodies, set.entity2body(), bodies, NoBody)?;
        let known = all_colliders.entity2collider();
        fit(&self.colliders, known, colliders, NoCollider)?;
        let known = all_joints.entity2impulse_joint();
        fit(&self.impulse_joints, known, joints, NoJoint)?;
        let known = all_joints.entity2multibody_joint();
        fit(&self.multibody_joints, known, multibody_joints, NoJoint)
    }
}

/// Checks that entities have the handles that they had (`then`), and that no other entity has a handle. The map `known` may
/// still contain despawned entities.
fn fit<H: Copy + PartialEq>(
    then: &[(Entity, H)],
    known: &HashMap<Entity, H>,
    now: impl Fn(Entity) -> Option<H>,
    missing: fn(Entity) -> SnapshotError,
) -> Result<(), SnapshotError> {
    let mut seen = EntityHashSet::default();
    for (entity, handle) in then {
        if !seen.insert(*entity) {
            return Err(SnapshotError::Twice(*entity));
        }
        match now(*entity) {
            None => return Err(missing(*entity)),
            Some(now) if now != *handle => return Err(SnapshotError::OtherHandle(*entity)),
            Some(_) => {}
        }
    }
    let mut later = known.keys().filter(|entity| !seen.contains(*entity));
    match later.find(|entity| now(**entity).is_some()) {
        Some(entity) => Err(SnapshotError::Unknown(*entity)),
        None => Ok(()),
    }
}

/// The entries of a map, sorted by entity, so that the same world gives the same snapshot.
fn sorted<H: Copy>(map: &HashMap<Entity, H>) -> Vec<(Entity, H)> {
    let mut all: Vec<_> = map
        .iter()
        .map(|(entity, handle)| (*entity, *handle))
        .collect();
    all.sort_unstable_by_key(|(entity, _)| *entity);
    all
}

impl MapEntities for RapierSnapshot {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        for context in &mut self.0 {
            context.entity = mapper.get_mapped(context.entity);
            let handles = &mut context.handles;
            for (entity, handle) in &mut handles.bodies {
                // Mutable access marks the body as changed.
                if let Some(name) = rename(entity, mapper)
                    && let Some(body) = context.bodies.get_mut(*handle)
                {
                    body.user_data = name;
                }
            }
            for (entity, handle) in &mut handles.colliders {
                if let Some(name) = rename(entity, mapper)
                    && let Some(collider) = context.colliders.get_mut(*handle)
                {
                    collider.user_data = name;
                }
            }
            for (entity, _) in &mut handles.impulse_joints {
                rename(entity, mapper);
            }
            for (entity, _) in &mut handles.multibody_joints {
                rename(entity, mapper);
            }
            let drawn = context.interpolations.iter_mut().map(|(entity, _)| entity);
            for entity in context.disabled.iter_mut().chain(drawn) {
                rename(entity, mapper);
            }
        }
    }
}

/// Maps an entity. Returns its new `user_data` in Rapier if the entity changed.
fn rename<M: EntityMapper>(entity: &mut Entity, mapper: &mut M) -> Option<u128> {
    let before = std::mem::replace(entity, mapper.get_mapped(*entity));
    (before != *entity).then(|| u128::from(entity.to_bits()))
}
