//! Repeats Rapier's integration of rotation, so that the crate can predict where a torque takes a body.

use crate::dynamics::delivery::{Delivery, Spinning};
use bevy::math::{DQuat, DVec3, Quat, Vec3};

/// Rotation and angular velocity that Rapier reaches with a delivery; see [`TurnRule`](crate::dynamics::delivery::TurnRule).
pub(crate) fn turn(spinning: &Spinning, spin: DVec3, delivery: &Delivery) -> (DQuat, DVec3) {
    Rounded::new(spinning).run(spin, delivery)
}

/// Rapier's rotation of a body over its substeps, in f32 as in Rapier. Rounding biases Rapier's gyroscopic term, by 1e-4 of the
/// angular momentum in ten seconds, even for equal moments of inertia, where the term should be zero. The same computation here
/// gives the bias of this step.
struct Rounded {
    substeps: u32,
    /// Duration of one substep, s.
    time: f32,
    rotation: Quat,
    principal: Quat,
    inertia: Vec3,
    inverse_inertia: Vec3,
    gyroscopic: bool,
}

impl Rounded {
    fn new(spinning: &Spinning) -> Self {
        let Spinning {
            schedule,
            body,
            gyroscopic,
        } = *spinning;
        let inertia = body.inertia.as_vec3();
        Self {
            substeps: schedule.substeps,
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
        let increment = (delivery.rate * f64::from(h)).as_vec3();
        let mut rotation = self.rotation;
        let mut velocity = (spin + delivery.jump).as_vec3();
        for _ in 0..self.substeps {
            velocity += increment;
            if self.gyroscopic {
                velocity = self.precessed(rotation, velocity);
            }
            let half = velocity * (h * 0.5);
            rotation = (Quat::from_xyzw(half.x, half.y, half.z, 1.0) * rotation).normalize();
        }
        (rotation.as_dquat(), velocity.as_dvec3())
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
