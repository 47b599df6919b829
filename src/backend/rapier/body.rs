//! Rapier's bodies, as the rest of the crate sees them.

use crate::backend::{BodyId, Engine, JointId, Push, Seen, Sight, Wrench};
use crate::dynamics::body::{Body, Spin, turn};
use bevy::math::{DQuat, DVec3, Vec3};
use bevy_rapier3d::rapier::dynamics::{
    ImpulseJointHandle, LockedAxes, RigidBody, RigidBodyHandle, RigidBodySet, RigidBodyType,
};
use std::borrow::{Borrow, BorrowMut};

/// Rapier turns no body further in one pipeline step (`MAX_ROTATION` in its solver), rad.
pub(crate) const FARTHEST_TURN: f64 = std::f64::consts::FRAC_PI_4;

/// The bodies of a context, with gravity there, m/s².
pub(crate) struct Bodies<B> {
    pub set: B,
    pub gravity: Vec3,
}

/// What Rapier calls a body.
pub(crate) fn handle(body: BodyId) -> RigidBodyHandle {
    RigidBodyHandle::from_raw_parts(body.index, body.generation)
}

/// What all else calls it.
pub(crate) fn id(handle: RigidBodyHandle) -> BodyId {
    let (index, generation) = handle.into_raw_parts();
    BodyId { index, generation }
}

/// What Rapier calls a joint.
pub(crate) fn joint_handle(joint: JointId) -> ImpulseJointHandle {
    ImpulseJointHandle::from_raw_parts(joint.index, joint.generation)
}

/// What all else calls it.
pub(crate) fn joint_id(handle: ImpulseJointHandle) -> JointId {
    let (index, generation) = handle.into_raw_parts();
    JointId { index, generation }
}

/// How a body is now.
#[inline(always)]
pub(crate) fn see(body: &RigidBody, gravity: Vec3) -> Seen {
    let properties = &body.mass_properties().local_mprops;
    let pose = body.position();
    Seen {
        origin: pose.translation,
        rotation: pose.rotation,
        local_center: properties.local_com,
        velocity: body.linvel(),
        spin: body.angvel(),
        inverse_mass: properties.inv_mass,
        gravity: gravity.as_dvec3() * f64::from(body.gravity_scale()),
        more_substeps: body.additional_solver_iterations(),
        is_movable: is_movable(body),
        is_asleep: body.is_sleeping(),
        is_locked: body
            .locked_axes()
            .intersects(LockedAxes::TRANSLATION_LOCKED),
        can_touch: !body.colliders().is_empty(),
        turns_fast: body.is_fast_rotation_allowed(),
        is_gyroscopic: body.gyroscopic_forces_enabled(),
    }
}

/// Whether an element can move it.
pub(crate) fn is_movable(body: &RigidBody) -> bool {
    body.is_dynamic() && body.is_enabled()
}

/// From its frame to the world.
fn facing(body: &RigidBody) -> DQuat {
    body.position().rotation.as_dquat().normalize()
}

/// Position and velocity of a point fixed to a body (`local` in its frame).
pub(crate) fn point_of(body: &RigidBody, local: DVec3) -> (DVec3, DVec3) {
    see(body, Vec3::ZERO).point(local)
}

/// Where a point of a body that the game moves will be after the step.
fn point_after(body: &RigidBody, local: DVec3, time: f64) -> DVec3 {
    let (now, _) = point_of(body, local);
    if !body.is_kinematic() || !body.is_enabled() {
        return now;
    }
    let next = body.next_position();
    let here = body.position();
    if next != here {
        return next.translation.as_dvec3() + next.rotation.as_dquat().normalize() * local;
    }
    match body.body_type() {
        // Velocity-based: moves straight and turns steadily.
        RigidBodyType::KinematicVelocityBased => {
            let turned = turn(time * body.angvel().as_dvec3());
            let (center, _) = point_of(body, body.local_center_of_mass().as_dvec3());
            center + time * body.linvel().as_dvec3() + turned * (now - center)
        }
        _ => now,
    }
}

/// Rotation of a body that elements cannot turn, and its angular velocity over the step.
pub(crate) fn turning_of(body: &RigidBody, time: f64) -> (DQuat, DVec3) {
    let now = facing(body);
    if !body.is_kinematic() || !body.is_enabled() {
        return (now, DVec3::ZERO);
    }
    let next = body.next_position().rotation.as_dquat().normalize();
    if body.next_position().rotation != body.position().rotation {
        let mut by = next * now.inverse();
        if by.w < 0.0 {
            by = -by;
        }
        return (now, by.to_scaled_axis() / time);
    }
    match body.body_type() {
        RigidBodyType::KinematicVelocityBased => (now, body.angvel().as_dvec3()),
        _ => (now, DVec3::ZERO),
    }
}

/// The integrator's view. `turns` is false where every element holds the body at its centre of mass.
pub(crate) fn read(body: &RigidBody, gravity: Vec3, user: &Wrench, turns: bool) -> Body {
    let properties = &body.mass_properties().local_mprops;
    let rotation = facing(body);
    let locks = body.locked_axes();
    let locked = |axes: [LockedAxes; 3]| axes.map(|axis| locks.contains(axis));
    let [x, y, z] = locked([
        LockedAxes::TRANSLATION_LOCKED_X,
        LockedAxes::TRANSLATION_LOCKED_Y,
        LockedAxes::TRANSLATION_LOCKED_Z,
    ]);
    let free = |locked: bool| {
        if locked {
            0.0
        } else {
            f64::from(properties.inv_mass)
        }
    };
    let inverse_mass = DVec3::new(free(x), free(y), free(z));
    let rotation_locked = locked([
        LockedAxes::ROTATION_LOCKED_X,
        LockedAxes::ROTATION_LOCKED_Y,
        LockedAxes::ROTATION_LOCKED_Z,
    ]);
    let moves = DVec3::select(inverse_mass.cmpgt(DVec3::ZERO), DVec3::ONE, DVec3::ZERO);
    let mut out = Body {
        position: body.position().translation.as_dvec3()
            + rotation * properties.local_com.as_dvec3(),
        velocity: body.linvel().as_dvec3(),
        rotation,
        spin: Spin::Ignored,
        inverse_mass,
        inertia: properties.principal_inertia().as_dvec3(),
        principal: properties
            .principal_inertia_local_frame
            .as_dquat()
            .normalize(),
        rotation_locked,
        farthest_turn: f64::INFINITY,
        acceleration: moves * gravity.as_dvec3() * f64::from(body.gravity_scale())
            + inverse_mass * user.force.as_dvec3(),
        torque: user.torque.as_dvec3(),
        given: (DVec3::ZERO, DVec3::ZERO),
        torque_work: 0.0,
        turned: None,
    };
    if turns {
        set_spin(&mut out, body.angvel().as_dvec3());
        out.note_turn();
    }
    out
}

/// Lets a body turn as its locks and its inertia allow.
fn set_spin(body: &mut Body, angular_velocity: DVec3) {
    let locked = body.rotation_locked;
    // No inertia about an axis means to the engine that nothing turns the body about it.
    if locked == [false; 3] && body.inertia.min_element() > 0.0 {
        body.spin = Spin::Free {
            momentum: DVec3::ZERO,
        };
        body.set_angular_velocity(angular_velocity);
    } else if locked != [true; 3] || angular_velocity != DVec3::ZERO {
        body.spin = Spin::Locked {
            velocity: angular_velocity,
        };
    }
}

/// Its greatest radius of gyration, but a metre at most and two centimetres at least, m.
fn size_of(body: &RigidBody) -> f32 {
    let properties = &body.mass_properties().local_mprops;
    let inertia = properties.principal_inertia().max_element();
    (inertia * properties.inv_mass).sqrt().clamp(0.02, 1.0)
}

impl<B: Borrow<RigidBodySet> + Sync> Bodies<B> {
    fn get(&self, body: BodyId) -> Option<&RigidBody> {
        self.set.borrow().get(handle(body))
    }
}

impl<B: Borrow<RigidBodySet> + Sync> Sight for Bodies<B> {
    #[inline(always)]
    fn see(&self, body: BodyId) -> Option<Seen> {
        self.get(body).map(|body| see(body, self.gravity))
    }

    #[inline(always)]
    fn is_asleep(&self, body: BodyId) -> bool {
        self.get(body).is_some_and(RigidBody::is_sleeping)
    }

    fn body(&self, body: BodyId, user: &Wrench, turns: bool) -> Option<Body> {
        let body = self.get(body)?;
        Some(read(body, self.gravity, user, turns))
    }

    fn way(&self, body: BodyId, local: DVec3, time: f64) -> Option<[DVec3; 2]> {
        let body = self.get(body)?;
        Some([point_of(body, local).0, point_after(body, local, time)])
    }

    fn turning(&self, body: BodyId, time: f64) -> Option<(DQuat, DVec3)> {
        self.get(body).map(|body| turning_of(body, time))
    }

    fn size(&self, body: BodyId) -> f32 {
        self.get(body).map_or(1.0, size_of)
    }
}

impl<B: BorrowMut<RigidBodySet> + Sync> Engine for Bodies<B> {
    #[inline(always)]
    fn give(&mut self, body: BodyId, push: &Push, user: &Wrench) {
        if let Some(body) = self.set.borrow_mut().get_mut(handle(body)) {
            give(body, push, user);
        }
    }

    #[inline(always)]
    fn keep_awake(&mut self, body: BodyId) {
        if let Some(body) = self.set.borrow_mut().get_mut(handle(body)) {
            // The engine's sleep timer.
            body.activation_mut().time_since_can_sleep = 0.0;
        }
    }

    fn wake(&mut self, body: BodyId) {
        if let Some(body) = self.set.borrow_mut().get_mut(handle(body)) {
            body.wake_up(true);
        }
    }
}

/// Gives a body velocities, and the elements' share of force and torque beside the user's.
#[inline(always)]
pub(crate) fn give(body: &mut RigidBody, push: &Push, user: &Wrench) {
    if push.keep_awake {
        // The engine's sleep timer.
        body.activation_mut().time_since_can_sleep = 0.0;
    }
    if push.second_substep {
        body.set_additional_solver_iterations(1);
    }
    if let Some(velocity) = push.velocity {
        body.set_linvel(velocity, false);
    }
    if let Some(spin) = push.spin {
        body.set_angvel(spin, false);
    }
    let sum = sum(&push.share, user);
    body.reset_forces(false);
    body.add_force(sum.force, false);
    if sum.torque != Vec3::ZERO || body.user_torque() != Vec3::ZERO {
        body.reset_torques(false);
        body.add_torque(sum.torque, false);
    }
}

/// The elements' share and the user's: what stands in the engine for them.
pub(crate) fn sum(elements: &Wrench, user: &Wrench) -> Wrench {
    Wrench {
        force: told_apart(user.force + elements.force, user.force),
        torque: told_apart(user.torque + elements.torque, user.torque),
    }
}

/// A sum that happens to be zero is left as the smallest number instead, so that a user who clears it
/// changes it.
fn told_apart(sum: Vec3, user: Vec3) -> Vec3 {
    let hidden = sum.cmpeq(Vec3::ZERO) & user.cmpne(Vec3::ZERO);
    Vec3::select(hidden, Vec3::splat(f32::MIN_POSITIVE), sum)
}
