//! Converts Rapier's bodies for the rest of the crate: implements the backend's `Sight` and `Engine`.

use crate::backend::{BodyId, Engine, JointId, Push, Seen, Sight, Wrench};
use crate::dynamics::body::{Body, Spin, shortest, turn};
use bevy::math::{DQuat, DVec3, Vec3};
use bevy_rapier3d::rapier::dynamics::{
    ImpulseJointHandle, LockedAxes, RigidBody, RigidBodyHandle, RigidBodySet, RigidBodyType,
};
use std::borrow::{Borrow, BorrowMut};

/// Greatest rotation of a body in one pipeline step of Rapier (`MAX_ROTATION` in its solver), rad. No tuning constant.
pub(crate) const FARTHEST_TURN: f64 = std::f64::consts::FRAC_PI_4;

/// The bodies of a context, and its gravity, m/s².
pub(crate) struct Bodies<B> {
    pub set: B,
    pub gravity: Vec3,
}

/// Rapier's handle of a body.
pub(crate) fn handle(body: BodyId) -> RigidBodyHandle {
    RigidBodyHandle::from_raw_parts(body.index, body.generation)
}

/// The crate's id of a body.
pub(crate) fn id(handle: RigidBodyHandle) -> BodyId {
    let (index, generation) = handle.into_raw_parts();
    BodyId { index, generation }
}

/// Rapier's handle of a joint.
pub(crate) fn joint_handle(joint: JointId) -> ImpulseJointHandle {
    ImpulseJointHandle::from_raw_parts(joint.index, joint.generation)
}

/// The crate's id of a joint.
pub(crate) fn joint_id(handle: ImpulseJointHandle) -> JointId {
    let (index, generation) = handle.into_raw_parts();
    JointId { index, generation }
}

/// State of a body now.
#[inline(always)]
pub(crate) fn see(body: &RigidBody, gravity: Vec3) -> Seen {
    let properties = &body.mass_properties().local_mprops;
    let pose = body.position();
    // The engine keeps the velocity of a body that it does not move.
    let stands = body.is_fixed() || !body.is_enabled();
    let (velocity, spin) = if stands {
        (Vec3::ZERO, Vec3::ZERO)
    } else {
        (body.linvel(), body.angvel())
    };
    Seen {
        origin: pose.translation,
        rotation: pose.rotation,
        local_center: properties.local_com,
        velocity,
        spin,
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

/// Whether elements can move a body.
pub(crate) fn is_movable(body: &RigidBody) -> bool {
    body.is_dynamic() && body.is_enabled()
}

/// Rotation from the body's frame to the world.
fn facing(body: &RigidBody) -> DQuat {
    body.position().rotation.as_dquat().normalize()
}

/// Position and velocity of a point fixed to a body. `local` is the point in the body's frame.
pub(crate) fn point_of(body: &RigidBody, local: DVec3) -> (DVec3, DVec3) {
    see(body, Vec3::ZERO).point(local)
}

/// Position after the step of a point on a body that elements cannot move. `local` is the point in the body's frame.
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
        // The centre moves along a straight line, and the body turns at a constant rate.
        RigidBodyType::KinematicVelocityBased => {
            let turned = turn(time * body.angvel().as_dvec3());
            let (center, _) = point_of(body, body.local_center_of_mass().as_dvec3());
            center + time * body.linvel().as_dvec3() + turned * (now - center)
        }
        _ => now,
    }
}

/// Rotation now of a body that elements cannot turn, and its angular velocity over the step, rad/s.
pub(crate) fn turning_of(body: &RigidBody, time: f64) -> (DQuat, DVec3) {
    let now = facing(body);
    if !body.is_kinematic() || !body.is_enabled() {
        return (now, DVec3::ZERO);
    }
    let next = body.next_position().rotation.as_dquat().normalize();
    if body.next_position().rotation != body.position().rotation {
        let by = shortest(next * now.inverse());
        return (now, by.to_scaled_axis() / time);
    }
    match body.body_type() {
        RigidBodyType::KinematicVelocityBased => (now, body.angvel().as_dvec3()),
        _ => (now, DVec3::ZERO),
    }
}

/// Mean velocity of the centre of mass (m/s) and mean angular velocity (rad/s), over the coming `time` seconds, of a body that
/// the game puts to places. None for other bodies.
pub(crate) fn led(body: &RigidBody, time: f64) -> Option<[Vec3; 2]> {
    if body.body_type() != RigidBodyType::KinematicPositionBased || !body.is_enabled() {
        return None;
    }
    let center = body.local_center_of_mass().as_dvec3();
    let moved = point_after(body, center, time) - point_of(body, center).0;
    let (_, turning) = turning_of(body, time);
    Some([(moved / time).as_vec3(), turning.as_vec3()])
}

/// The body as the integrator sees it. `turns` is false if every element holds the body at its centre of mass.
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

/// Sets how a body can turn, from its locked axes and its inertia.
fn set_spin(body: &mut Body, angular_velocity: DVec3) {
    let locked = body.rotation_locked;
    // For the engine, zero inertia about an axis means that no torque turns the body about it.
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

/// Least and greatest radius (m) with which the angular velocity of a body counts as a speed of its surface. Pinned by
/// `ground::play`.
const SIZES: [f32; 2] = [0.02, 1.0];

/// Greatest radius of gyration of a body, within [`SIZES`].
fn size_of(body: &RigidBody) -> f32 {
    let properties = &body.mass_properties().local_mprops;
    let inertia = properties.principal_inertia().max_element();
    (inertia * properties.inv_mass)
        .sqrt()
        .clamp(SIZES[0], SIZES[1])
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
            // Resets the engine's sleep timer.
            body.activation_mut().time_since_can_sleep = 0.0;
        }
    }

    fn wake(&mut self, body: BodyId) {
        if let Some(body) = self.set.borrow_mut().get_mut(handle(body)) {
            body.wake_up(true);
        }
    }
}

/// Sets the velocities of a body, and its force and torque to the sum of the elements' share and the user's.
#[inline(always)]
pub(crate) fn give(body: &mut RigidBody, push: &Push, user: &Wrench) {
    if push.keep_awake {
        // Resets the engine's sleep timer.
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
    if !(is_zero(sum.torque) && is_zero(body.user_torque())) {
        body.reset_torques(false);
        body.add_torque(sum.torque, false);
    }
}

/// Takes the elements' share from a body, so that only the user's force and torque remain. Also if it is not dynamic now: the
/// engine then neither shows nor takes a force, but keeps the last one until the body is dynamic again.
pub(crate) fn leave(body: &mut RigidBody, user: &Wrench) {
    let kind = body.body_type();
    body.set_body_type(RigidBodyType::Dynamic, false);
    give(body, &Push::default(), user);
    body.set_body_type(kind, false);
}

/// The force and torque that the engine holds for the elements' share and the user's together.
#[inline(always)]
pub(crate) fn sum(elements: &Wrench, user: &Wrench) -> Wrench {
    Wrench {
        force: told_apart(user.force + elements.force, user.force),
        torque: told_apart(user.torque + elements.torque, user.torque),
    }
}

/// Whether a vector is zero. It looks at the bits, which takes half as long as three comparisons, and this runs for each body.
#[inline(always)]
fn is_zero(v: Vec3) -> bool {
    let bits = v.x.to_bits() | v.y.to_bits() | v.z.to_bits();
    // The sign does not count.
    bits << 1 == 0
}

/// Replaces zeros in `sum` by the smallest positive number where the user's share is not zero. Otherwise a user who clears
/// the force would not change it, and the crate would not notice.
#[inline(always)]
fn told_apart(sum: Vec3, user: Vec3) -> Vec3 {
    if is_zero(user) {
        return sum;
    }
    let hidden = sum.cmpeq(Vec3::ZERO) & user.cmpne(Vec3::ZERO);
    Vec3::select(hidden, Vec3::splat(f32::MIN_POSITIVE), sum)
}
