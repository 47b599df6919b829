//! Checks that all numbers that can be read are finite: in components, in readouts, and in the engine.

use crate::fault::Fault;
use crate::judge::Met;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{ImpulseJoint as RapierJoint, RigidBody as RapierBody};

/// `user_data` of the joints that the crate makes in the engine. If the crate changes it, a search meets no such joint
/// and fails because of that.
const OUR_JOINT: u128 = u128::from_be_bytes(*b"bevy_coilover\0\0\0");

/// Kind of the faults that the engine has by itself now and then. It has one name for components and engine, because
/// the engine's numbers are copied to components.
pub(crate) const NOT_FINITE: &str = "numbers of a body are not finite";

/// Whether the crate made a joint of the engine.
pub(crate) fn is_our_joint(joint: &RapierJoint) -> bool {
    joint.data.user_data == OUR_JOINT
}

/// Whether the crate made a body of the engine, to stand for an end without a body. Bodies of entities have the bits of
/// their entity there, which are never zero.
pub(crate) fn is_stand_in(body: &RapierBody) -> bool {
    body.user_data == 0
}

/// Returns a fault unless all numbers are finite. Counts what it meets.
pub(crate) fn are_finite(world: &mut World, met: &mut Met) -> Result<(), Fault> {
    components(world)?;
    engine(world, met)?;
    readouts(world, met)
}

fn external(force: &ExternalForce) -> bool {
    force.force.is_finite() && force.torque.is_finite()
}

fn components(world: &mut World) -> Result<(), Fault> {
    let mut bodies = world.query_filtered::<(
        Entity,
        &Transform,
        Option<&Velocity>,
        Option<&ExternalForce>,
    ), Allow<Disabled>>();
    for (entity, place, velocity, force) in bodies.iter(world) {
        let moves = velocity.is_none_or(|v| v.linear.is_finite() && v.angular.is_finite());
        if !(place.is_finite() && moves && force.is_none_or(external)) {
            let seen = format!("{entity}: {place:?}, {velocity:?}, {force:?}");
            return Err(Fault::new(NOT_FINITE, seen));
        }
    }
    Ok(())
}

/// All bodies, colliders and joints of the engine, also those of no entity.
fn engine(world: &mut World, met: &mut Met) -> Result<(), Fault> {
    let mut contexts = world.query::<(
        &RapierRigidBodySet,
        &RapierContextColliders,
        &RapierContextJoints,
        &RapierConfiguration,
    )>();
    for (set, colliders, joints, configuration) in contexts.iter(world) {
        let is_stepped = configuration.physics_pipeline_active;
        for (handle, body) in set.bodies.iter() {
            let ours = is_stand_in(body);
            met.stand_ins += u64::from(ours);
            if !is_finite(body) {
                let [place, next] = [body.position(), body.next_position()];
                let [velocity, spin] = [body.linvel(), body.angvel()];
                let seen = format!("{handle:?}: {place:?}, {next:?}, {velocity}, {spin}");
                return Err(if ours {
                    Fault::ours("numbers of a stand-in body are not finite", seen)
                } else {
                    Fault::new(NOT_FINITE, seen)
                });
            }
        }
        for (handle, collider) in colliders.colliders.iter() {
            if !collider.position().is_finite() {
                let seen = format!("collider {handle:?}: {:?}", collider.position());
                return Err(Fault::new(NOT_FINITE, seen));
            }
        }
        for (handle, joint) in joints.impulse_joints.iter() {
            let ours = is_our_joint(joint);
            met.joints += u64::from(ours);
            let seen = || format!("{handle:?}: {joint:?}");
            if ours && !is_sound(joint) {
                let kind = "numbers of a spring's joint are not finite";
                return Err(Fault::ours(kind, seen()));
            }
            let motors = joint.data.motors.iter().map(|motor| motor.impulse);
            let mut impulses = joint.impulses.iter().copied().chain(motors);
            if !impulses.all(f32::is_finite) {
                return Err(Fault::new(NOT_FINITE, seen()));
            }
            // The engine disables bodies whose numbers are not finite, so only now.
            let moves = |handle| {
                let body = set.bodies.get(handle);
                body.is_some_and(|body| body.is_dynamic() && body.is_enabled())
            };
            if ours && is_stepped && !(moves(joint.body1()) || moves(joint.body2())) {
                let kind = "a spring's joint holds nothing that moves";
                return Err(Fault::ours(kind, seen()));
            }
        }
    }
    Ok(())
}

fn is_finite(body: &RapierBody) -> bool {
    let places = [body.position(), body.next_position()];
    let vectors = [
        body.linvel(),
        body.angvel(),
        body.user_force(),
        body.user_torque(),
    ];
    places.iter().all(|place| place.is_finite())
        && vectors.iter().all(|vector| vector.is_finite())
        && body.soft_ccd_prediction().is_finite()
}

/// Whether what the crate orders of the engine's solver is finite. Only the greatest force of a motor may be infinite.
fn is_sound(joint: &RapierJoint) -> bool {
    let data = &joint.data;
    let frames = [&data.local_frame1, &data.local_frame2];
    let motors = data.motors.iter().all(|motor| {
        let orders = [
            motor.target_pos,
            motor.target_vel,
            motor.stiffness,
            motor.damping,
        ];
        orders.iter().all(|order| order.is_finite()) && !motor.max_force.is_nan()
    });
    frames.iter().all(|frame| frame.is_finite()) && motors
}

/// The readouts of elements and bodies. Only the crate writes them.
fn readouts(world: &mut World, met: &mut Met) -> Result<(), Fault> {
    const KIND: &str = "a readout is not a number";
    let mut loads = world.query_filtered::<(Entity, &SpringLoad), Allow<Disabled>>();
    for (entity, load) in loads.iter(world) {
        if !(external(&load.elements) && external(&load.user)) {
            return Err(Fault::ours(KIND, format!("{entity}: {load:?}")));
        }
    }
    // Disabled elements keep their readout.
    let mut readouts = world.query_filtered::<(Entity, &SpringReadout), Allow<Disabled>>();
    for (entity, readout) in readouts.iter(world) {
        met.solved += u64::from(readout.method != SpringMethod::None);
        if !is_number(readout) {
            return Err(Fault::ours(KIND, format!("{entity}: {readout:?}")));
        }
    }
    Ok(())
}

/// Whether every field of a readout is a number. All fields are named, so that a new one is not forgotten.
fn is_number(readout: &SpringReadout) -> bool {
    let SpringReadout {
        length,
        rate,
        spring_force,
        damper_force,
        stored_energy,
        dissipated_power,
        dissipated_energy,
        work,
        omega_dt,
        effective_mass,
        method: _,
        microsteps: _,
        error,
        capped: _,
    } = *readout;
    let finite = [
        length,
        rate,
        spring_force,
        damper_force,
        stored_energy,
        dissipated_power,
        dissipated_energy,
        work,
        omega_dt,
        error,
    ];
    // It is infinite where neither end can move.
    finite.into_iter().all(f32::is_finite) && effective_mass >= 0.0
}
