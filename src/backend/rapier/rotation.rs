//! How Rapier turns a body.

use crate::dynamics::delivery::{Delivery, Spinning};
use bevy::math::{DQuat, DVec3, Quat, Vec3};

/// What Rapier makes of a delivery: see [`TurnRule`](crate::dynamics::delivery::TurnRule).
pub(crate) fn turn(spinning: &Spinning, spin: DVec3, delivery: &Delivery) -> (DQuat, DVec3) {
    Rounded::new(spinning).run(spin, delivery)
}

/// Rapier's rotation of a body over its substeps, with its own f32: its gyroscopic term is biased by that (also
/// where moments are equal, so that there should be none), over ten seconds by 1e-4 of the momentum, and running it
/// shows the bias of this very step.
struct Rounded {
    substeps: u32,
    /// Of one substep.
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

    /// Rapier's explicit gyroscopic term, which keeps the size of the angular momentum
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
