//! Checks that nothing of the elements is left once they are despawned: in components, and in the engine.

use crate::fault::Fault;
use crate::judge::Met;
use crate::numbers::{are_finite, is_our_joint, is_stand_in};
use crate::stage::Stage;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{IntegrationParameters, RigidBodyType};
use std::collections::HashSet;

/// Despawns all elements and goes on for three ticks. Returns a fault if something of theirs is left. `unpushed` tells
/// whether the game gave no body a force.
pub(crate) fn nothing_is_left(stage: &mut Stage, unpushed: bool) -> Result<(), Fault> {
    let mut configurations = stage.app.world_mut().query::<&mut RapierConfiguration>();
    for mut configuration in configurations.iter_mut(stage.app.world_mut()) {
        configuration.physics_pipeline_active = true;
    }
    for element in stage.elements.clone() {
        if let Ok(element) = stage.app.world_mut().get_entity_mut(element) {
            element.despawn();
        }
    }
    for _ in 0..3 {
        stage.app.update();
        are_finite(stage.app.world_mut(), &mut Met::default())?;
    }
    let world = stage.app.world_mut();
    no_component_is_left(world)?;
    nothing_of_ours_is_in_the_engine(world)?;
    all_belongs_to_entities(world)?;
    settings_are_the_games(world)?;
    if unpushed {
        no_force_is_left(world)?;
    }
    Ok(())
}

fn no_component_is_left(world: &mut World) -> Result<(), Fault> {
    macro_rules! none {
        ($($kind:ident)*) => {$(
            let mut left = world.query_filtered::<&$kind, Allow<Disabled>>();
            let left = left.iter(world).count();
            if left > 0 {
                let kind = concat!("a ", stringify!($kind), " is left");
                return Err(Fault::ours(kind, format!("{left} of them")));
            }
        )*};
    }
    none!(SpringLoad SpringReadout SpringFault);
    Ok(())
}

/// Joints, stand-in bodies and sweeps: only the crate makes or changes these.
fn nothing_of_ours_is_in_the_engine(world: &mut World) -> Result<(), Fault> {
    let mut contexts = world.query::<(
        &RapierRigidBodySet,
        &RapierContextJoints,
        &RapierContextSimulation,
    )>();
    let usual = IntegrationParameters::default().num_internal_pgs_iterations;
    for (set, joints, simulation) in contexts.iter(world) {
        let joints = joints.impulse_joints.iter();
        let joints = joints.filter(|(_, joint)| is_our_joint(joint)).count();
        if joints > 0 {
            let seen = format!("{joints} of them");
            return Err(Fault::ours("a spring's joint is left in the engine", seen));
        }
        let bodies = set.bodies.iter();
        let bodies = bodies.filter(|(_, body)| is_stand_in(body)).count();
        if bodies > 0 {
            let seen = format!("{bodies} of them");
            return Err(Fault::ours("a stand-in body is left in the engine", seen));
        }
        let sweeps = simulation
            .integration_parameters
            .num_internal_pgs_iterations;
        if sweeps != usual {
            let seen = format!("{sweeps}, of which the game ordered {usual}");
            return Err(Fault::ours("solver sweeps are left in the engine", seen));
        }
    }
    Ok(())
}

/// Checks that each body, collider and joint of the engine belongs to an entity. A lost handle may be the engine's fault.
fn all_belongs_to_entities(world: &mut World) -> Result<(), Fault> {
    macro_rules! known {
        ($handle:ident) => {{
            let mut handles = world.query_filtered::<&$handle, Allow<Disabled>>();
            let handles = handles.iter(world).map(|handle| handle.0);
            handles.collect::<HashSet<_>>()
        }};
    }
    let bodies = known!(RapierRigidBodyHandle);
    let colliders = known!(RapierColliderHandle);
    let joints = known!(RapierImpulseJointHandle);
    let mut contexts = world.query::<(
        &RapierRigidBodySet,
        &RapierContextColliders,
        &RapierContextJoints,
    )>();
    for (set, shapes, links) in contexts.iter(world) {
        let all = set.bodies.iter();
        let no_bodies = all.filter(|(handle, _)| !bodies.contains(handle)).count();
        let all = shapes.colliders.iter();
        let no_colliders = all
            .filter(|(handle, _)| !colliders.contains(handle))
            .count();
        let all = links.impulse_joints.iter();
        let no_joints = all.filter(|(handle, _)| !joints.contains(handle)).count();
        if no_bodies + no_colliders + no_joints > 0 {
            return Err(Fault::new(
                "something in the engine belongs to no entity",
                format!("{no_bodies} bodies, {no_colliders} colliders, {no_joints} joints"),
            ));
        }
    }
    Ok(())
}

/// Checks that bodies have the solver iterations and the contact prediction that the game ordered.
fn settings_are_the_games(world: &mut World) -> Result<(), Fault> {
    let mut bodies = world.query::<(
        &RapierRigidBodyHandle,
        Option<&AdditionalSolverIterations>,
        Option<&SoftCcd>,
    )>();
    let ordered: Vec<_> = bodies
        .iter(world)
        .map(|(handle, more, ahead)| {
            let ahead = ahead.map_or(0.0, |ahead| ahead.prediction);
            (handle.0, more.map_or(0, |more| more.0), ahead)
        })
        .collect();
    // The game has one context, and that contains all bodies.
    for set in world.query::<&RapierRigidBodySet>().iter(world) {
        for (handle, iterations, prediction) in &ordered {
            let Some(body) = set.bodies.get(*handle) else {
                let kind = "the engine has lost a body";
                return Err(Fault::new(kind, format!("{handle:?}")));
            };
            let more = body.additional_solver_iterations();
            if more != *iterations {
                let seen = format!("{more} more, of which the game ordered {iterations}");
                return Err(Fault::new("solver iterations are left on a body", seen));
            }
            let ahead = body.soft_ccd_prediction();
            if ahead != *prediction {
                let seen = format!("{ahead} m, of which the game ordered {prediction} m");
                return Err(Fault::new("a contact prediction is left on a body", seen));
            }
        }
    }
    Ok(())
}

/// Checks that no force acts on any body, neither by its component nor in the engine alone.
fn no_force_is_left(world: &mut World) -> Result<(), Fault> {
    const KIND: &str = "a force of springs is left on a body";
    let mut forces = world.query::<(Entity, &ExternalForce)>();
    for (entity, force) in forces.iter(world) {
        if *force != ExternalForce::default() {
            return Err(Fault::ours(KIND, format!("{entity}: {force:?}")));
        }
    }
    for mut set in world.query::<&mut RapierRigidBodySet>().iter_mut(world) {
        for (handle, body) in set.bodies.iter_mut() {
            // Only of a dynamic body does the engine show the force that it keeps.
            body.set_body_type(RigidBodyType::Dynamic, false);
            let [force, torque] = [body.user_force(), body.user_torque()];
            if [force, torque] != [Vec3::ZERO; 2] {
                let seen = format!("{handle:?}: {force} N, {torque} N m in the engine");
                return Err(Fault::ours(KIND, seen));
            }
        }
    }
    Ok(())
}
