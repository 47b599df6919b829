//! Repeats Rapier's integration of rotation, so that the crate can predict where a torque takes a body.

use crate::dynamics::body::Body;
use crate::dynamics::delivery::{Delivery, Spinning, torque_for};
use bevy::math::{DQuat, DVec3, Quat, Vec3};

/// Rotation and angular velocity that Rapier reaches with a delivery; see [`TurnRule`](crate::dynamics::delivery::TurnRule).
pub(crate) fn turn(spinning: &Spinning, spin: DVec3, delivery: &Delivery) -> (DQuat, DVec3) {
    Rounded::new(spinning).run(spin, delivery)
}

/// Rapier's rotation of a body over its substeps, in f32 as in Rapier. Rounding biases Rapier's gyroscopic term, by 1e-4 of the
/// angular momentum in ten seconds, even for equal moments of inertia, where the term should be zero. The same computation here
/// gives the bias of this step.
struct Rounded<'a> {
    body: &'a Body,
    substeps: u32,
    /// Number of substeps after which Rapier computes the inertia anew.
    substeps_each: u32,
    /// Duration of one substep, s.
    time: f32,
    rotation: Quat,
    principal: Quat,
    inertia: Vec3,
    inverse_inertia: Vec3,
    gyroscopic: bool,
}

impl<'a> Rounded<'a> {
    fn new(spinning: &Spinning<'a>) -> Self {
        let Spinning {
            schedule,
            body,
            gyroscopic,
        } = *spinning;
        let inertia = body.inertia.as_vec3();
        Self {
            body,
            substeps: schedule.substeps,
            substeps_each: schedule.substeps_each.max(1),
            time: schedule.substep as f32,
            rotation: body.rotation.as_quat(),
            principal: body.principal.as_quat(),
            inertia,
            inverse_inertia: Vec3::select(inertia.cmpgt(Vec3::ZERO), inertia.recip(), Vec3::ZERO),
            gyroscopic,
        }
    }

    /// Rotation and angular velocity after the step.
    fn run(&self, spin: DVec3, delivery: &Delivery) -> (DQuat, DVec3) {
        let h = self.time;
        let mut increment = (delivery.rate * f64::from(h)).as_vec3();
        let mut rotation = self.rotation;
        let mut velocity = (spin + delivery.jump).as_vec3();
        for substep in 0..self.substeps {
            if substep > 0 && substep % self.substeps_each == 0 {
                increment = self.increment(delivery.rate, rotation);
            }
            velocity += increment;
            if self.gyroscopic {
                velocity = self.precessed(rotation, velocity);
            }
            let half = velocity * (h * 0.5);
            rotation = (Quat::from_xyzw(half.x, half.y, half.z, 1.0) * rotation).normalize();
        }
        (rotation.as_dquat(), velocity.as_dvec3())
    }

    /// Change of the angular velocity in a substep of a later step of Rapier, which begins with `rotation`. The torque stays that with
    /// which the rate at the start is `rate`.
    fn increment(&self, rate: DVec3, rotation: Quat) -> Vec3 {
        let torque = torque_for(rate, self.body.inverse_inertia());
        let turned = Body {
            rotation: rotation.as_dquat(),
            ..*self.body
        };
        (turned.inverse_inertia() * torque * f64::from(self.time)).as_vec3()
    }

    /// Angular velocity after Rapier's explicit gyroscopic term, which keeps the magnitude of the angular momentum
    /// (`gyroscopic_corrected_angvel` in rapier3d's rigid_body.rs).
    fn precessed(&self, rotation: Quat, velocity: Vec3) -> Vec3 {
        let axes = rotation * self.principal;
        let w = axes.inverse() * velocity;
        let momentum = self.inertia * w;
        let moved = momentum - w.cross(momentum) * self.time;
        let square = moved.length_squared();
        if square == 0.0 {
            return velocity;
        }
        let kept = moved * (momentum.length_squared() / square).sqrt();
        axes * (self.inverse_inertia * kept)
    }
}
