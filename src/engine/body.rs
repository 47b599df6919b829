//! A Rapier body as the integrator's body, and the way back.

use crate::dynamics::body::{Body, Spin, turn};
use crate::dynamics::delivery::{Delivery, Schedule, force_for, torque_for};
use crate::dynamics::single;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::*;
use bevy_rapier3d::prelude::ExternalForce;
use bevy_rapier3d::rapier::dynamics::{LockedAxes, RigidBody as RapierBody, RigidBodyType};

/// Rapier turns no body further in one pipeline step (`MAX_ROTATION` in its solver), rad.
pub(super) const FARTHEST_TURN: f64 = std::f64::consts::FRAC_PI_4;

/// What the engine's settings mean for a delivery.
#[derive(Clone, Copy, Debug)]
pub(super) struct Engine {
    /// Solver iterations of a body that asks for no more.
    pub iterations: usize,
    /// Its cap on speeds, m/s.
    pub fastest: f64,
    /// Its cap on turning in one call, rad; a body that may turn fast has none.
    pub farthest_turn: f64,
    pub length_unit: f32,
    pub gravity: Vec3,
}

/// How the engine will step one body.
pub(super) struct Terms {
    pub schedule: Schedule,
    /// It is given a second solver iteration for that.
    pub raised_iterations: bool,
}

/// Position and velocity of a point fixed to a body (`local` in its frame).
pub(super) fn point_of(body: &RapierBody, local: DVec3) -> (DVec3, DVec3) {
    let pose = body.position();
    let rotation = pose.rotation.as_dquat().normalize();
    let arm = rotation * (local - body.local_center_of_mass().as_dvec3());
    let center = pose.translation.as_dvec3() + rotation * body.local_center_of_mass().as_dvec3();
    let velocity = body.linvel().as_dvec3() + body.angvel().as_dvec3().cross(arm);
    (center + arm, velocity)
}

/// Where a point of a body that the game moves will be after the step.
pub(super) fn point_after(body: &RapierBody, local: DVec3, time: f64) -> DVec3 {
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
pub(super) fn turning_of(body: &RapierBody, time: f64) -> (DQuat, DVec3) {
    let now = body.position().rotation.as_dquat().normalize();
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

/// Centre of mass.
pub(super) fn center_of(body: &RapierBody) -> DVec3 {
    let pose = body.position();
    let mut center = pose.translation.as_dvec3();
    let local = body.local_center_of_mass();
    if local != Vec3::ZERO {
        center += rotation_of(body) * local.as_dvec3();
    }
    center
}

/// From its frame to the world.
pub(super) fn rotation_of(body: &RapierBody) -> DQuat {
    body.position().rotation.as_dquat().normalize()
}

/// Whether an element can move it.
pub(super) fn is_movable(body: &RapierBody) -> bool {
    body.is_dynamic() && body.is_enabled()
}

/// The integrator's view. `turns` is false where every element holds the body at its centre of mass.
pub(super) fn read(body: &RapierBody, gravity: Vec3, user: &ExternalForce, turns: bool) -> Body {
    let properties = &body.mass_properties().local_mprops;
    let rotation = body.position().rotation.as_dquat().normalize();
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

/// What the engine is given for a step, so that a body ends it where the integrator did.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Push {
    /// Velocities at its start, if others than it has.
    pub linvel: Option<Vec3>,
    pub angvel: Option<Vec3>,
    /// Force and torque of the elements over it.
    pub share: [Vec3; 2],
    pub raised_iterations: bool,
}

impl Push {
    /// Gives the body all but the force and torque, which others add to.
    #[inline(always)]
    pub(super) fn act(&self, body: &mut RapierBody) {
        if self.raised_iterations {
            body.set_additional_solver_iterations(1);
        }
        if let Some(linvel) = self.linvel {
            body.set_linvel(linvel, false);
        }
        if let Some(angvel) = self.angvel {
            body.set_angvel(angvel, false);
        }
    }
}

/// The velocity that a body is given for the start of the step, and the acceleration that it must have over
/// it, to move so far and reach such a velocity.
#[inline(always)]
pub(super) fn straight(
    velocity: DVec3,
    displacement: DVec3,
    reached: DVec3,
    terms: &Terms,
    engine: &Engine,
) -> (Vec3, DVec3) {
    let time = terms.schedule.time;
    let schedule = &terms.schedule;
    let wanted = schedule.reach(displacement - time * velocity, reached - velocity);
    let planned = schedule.capped(wanted, velocity, engine.fastest);
    let linvel = (velocity + planned.jump).as_vec3();
    // The engine's velocity is rounded; the force makes up for it.
    let rounding = velocity + planned.jump - linvel.as_dvec3();
    let rate = planned.rate + rounding * schedule.per_time;
    (linvel, rate)
}

/// In single precision, and finite whatever it was.
fn finite(v: DVec3) -> Vec3 {
    Vec3::from(v.to_array().map(single))
}

/// What takes a free body from its start to its end.
pub(super) fn push(
    body: &RapierBody,
    start: &Body,
    end: &Body,
    terms: &Terms,
    engine: &Engine,
) -> Push {
    let (linvel, linear) = straight(
        start.velocity,
        end.position - start.position,
        end.velocity,
        terms,
        engine,
    );
    let force = force_for(linear - start.acceleration, start.inverse_mass);
    let (mut angvel, mut torque) = (None, DVec3::ZERO);
    if start.spin != Spin::Ignored {
        let inverse_inertia = start.inverse_inertia();
        let spin = start.angular_velocity();
        let gyroscopic = body.gyroscopic_forces_enabled();
        let Delivery { jump, rate } = terms.schedule.angular(start, gyroscopic, end);
        angvel = Some((spin + jump).as_vec3());
        torque = torque_for(rate, inverse_inertia) - start.torque;
        for axis in 0..3 {
            if start.rotation_locked[axis] {
                torque[axis] = 0.0;
            }
        }
    }
    Push {
        linvel: Some(linvel),
        angvel,
        share: [force, torque].map(finite),
        raised_iterations: terms.raised_iterations,
    }
}
