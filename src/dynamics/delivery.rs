//! The impulse and force that make the engine arrive where the integrator did.
//!
//! With n substeps the engine does `v += (dt/n)·a; x += (dt/n)·v` n times, so under an impulse at the
//! start and a constant acceleration a over the step
//!
//! ```text
//! v' = v + J/m + dt·a        x' = x + dt·(v + J/m) + β dt²·a        β = (n + 1)/(2n)
//! ```
//!
//! Two unknowns meet two conditions wherever n > 1. Rotation is the same with the engine's own
//! quaternion update and gyroscopic term in between, so there the linear answer is refined by running
//! the engine's rotation here and correcting what is missed.

use super::body::Body;
use bevy::math::{DMat3, DQuat, DVec3, Quat, Vec3};

/// How the engine will step: all substeps of one call together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Schedule {
    /// Seconds in all.
    pub time: f64,
    /// Equal substeps, each one velocity and one position update.
    pub substeps: u32,
}

/// A jump at the start and a constant rate of change over the step, of a linear or angular velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Delivery {
    pub jump: DVec3,
    pub rate: DVec3,
}

impl Schedule {
    fn beta(&self) -> f64 {
        let n = f64::from(self.substeps);
        (n + 1.0) / (2.0 * n)
    }

    /// Jump and rate for a wanted displacement beyond `time·velocity` and a wanted change of velocity.
    pub(crate) fn reach(&self, displacement: DVec3, change: DVec3) -> Delivery {
        if self.substeps < 2 {
            // One substep has one degree of freedom; the velocity is the one that lasts.
            return Delivery {
                jump: DVec3::ZERO,
                rate: change / self.time,
            };
        }
        let beta = self.beta();
        let per_time = self.time.recip();
        let jump = (displacement - beta * self.time * change) * (per_time / (1.0 - beta));
        Delivery {
            jump,
            rate: (change - jump) * per_time,
        }
    }

    /// The engine caps speeds. Where a delivery would exceed that at either end of the step, it moves
    /// steadily instead: the displacement stays right, speed is lost rather than gained.
    pub(crate) fn capped(
        &self,
        delivery: Delivery,
        velocity: DVec3,
        displacement: DVec3,
        cap: f64,
    ) -> Delivery {
        let first = velocity + delivery.jump + self.time / f64::from(self.substeps) * delivery.rate;
        let last = velocity + delivery.jump + self.time * delivery.rate;
        if first.length_squared().max(last.length_squared()) <= cap * cap {
            return delivery;
        }
        Delivery {
            jump: displacement / self.time - velocity,
            rate: DVec3::ZERO,
        }
    }

    /// Angular part: from the start's rotation and angular velocity to where `end` now is.
    pub(crate) fn angular(&self, start: &Body, gyroscopic: bool, end: &Body) -> Delivery {
        let (from, spin) = (start.rotation, start.angular_velocity());
        let wanted = end.angular_velocity();
        let angle = |r: DQuat| {
            let r = end.rotation * r.inverse();
            (if r.w < 0.0 { -r } else { r }).to_scaled_axis()
        };
        let mut delivery = self.reach(angle(from) - self.time * spin, wanted - spin);
        for _ in 0..5 {
            let (rotation, velocity) = self.engine_rotation(start, spin, gyroscopic, &delivery);
            let correction = self.reach(angle(rotation), wanted - velocity);
            delivery.jump += correction.jump;
            delivery.rate += correction.rate;
            let missed = angle(rotation).length() + self.time * (wanted - velocity).length();
            if missed < 1e-12 {
                break;
            }
        }
        // The engine's f32 gyroscopic term is biased: over ten seconds it loses 1e-4 of the momentum.
        // Running it in f32 as well shows the bias of this very step.
        let (rotation, velocity) = self.rounded_rotation(start, spin, gyroscopic, &delivery);
        let correction = self.reach(angle(rotation), wanted - velocity);
        delivery.jump += correction.jump;
        delivery.rate += correction.rate;
        delivery
    }

    /// [`engine_rotation`](Self::engine_rotation) with the engine's own rounding.
    pub(super) fn rounded_rotation(
        &self,
        start: &Body,
        spin: DVec3,
        gyroscopic: bool,
        delivery: &Delivery,
    ) -> (DQuat, DVec3) {
        let h = (self.time / f64::from(self.substeps)) as f32;
        let increment = (delivery.rate * f64::from(h)).as_vec3();
        let (principal, inertia) = (start.principal.as_quat(), start.inertia.as_vec3());
        let inverse = Vec3::select(inertia.cmpgt(Vec3::ZERO), inertia.recip(), Vec3::ZERO);
        let mut rotation = start.rotation.as_quat();
        let mut velocity = (spin + delivery.jump).as_vec3();
        for _ in 0..self.substeps {
            velocity += increment;
            if gyroscopic {
                let axes = rotation * principal;
                let w = axes.inverse() * velocity;
                let momentum = inertia * w;
                let moved = momentum - w.cross(momentum) * h;
                let square = moved.length_squared();
                if square != 0.0 {
                    let kept = moved * (momentum.length_squared() / square).sqrt();
                    velocity = axes * (inverse * kept);
                }
            }
            let half = velocity * (h * 0.5);
            rotation = (Quat::from_xyzw(half.x, half.y, half.z, 1.0) * rotation).normalize();
        }
        (rotation.as_dquat(), velocity.as_dvec3())
    }

    /// What the engine's substeps do to rotation and angular velocity.
    fn engine_rotation(
        &self,
        start: &Body,
        spin: DVec3,
        gyroscopic: bool,
        delivery: &Delivery,
    ) -> (DQuat, DVec3) {
        let h = self.time / f64::from(self.substeps);
        let (mut rotation, mut velocity) = (start.rotation, spin + delivery.jump);
        for _ in 0..self.substeps {
            velocity += h * delivery.rate;
            if gyroscopic {
                velocity =
                    gyroscopic_correction(velocity, rotation * start.principal, start.inertia, h);
            }
            let half = 0.5 * h * velocity;
            rotation = (DQuat::from_xyzw(half.x, half.y, half.z, 1.0) * rotation).normalize();
        }
        (rotation, velocity)
    }
}

/// Rapier's explicit gyroscopic term, which keeps the size of the angular momentum
/// (`gyroscopic_corrected_angvel` in rapier3d's rigid_body.rs).
fn gyroscopic_correction(velocity: DVec3, axes: DQuat, inertia: DVec3, h: f64) -> DVec3 {
    let w = axes.inverse() * velocity;
    let momentum = inertia * w;
    let moved = momentum - h * w.cross(momentum);
    let square = moved.length_squared();
    if square == 0.0 {
        return velocity;
    }
    let kept = moved * (momentum.length_squared() / square).sqrt();
    let inverse = DVec3::select(inertia.cmpgt(DVec3::ZERO), inertia.recip(), DVec3::ZERO);
    axes * (inverse * kept)
}

/// The force or torque with which an inverse mass or inertia gives an acceleration; nothing along
/// locked axes.
pub(crate) fn force_for(acceleration: DVec3, inverse_mass: DVec3) -> DVec3 {
    DVec3::select(
        inverse_mass.cmpgt(DVec3::ZERO),
        acceleration / inverse_mass,
        DVec3::ZERO,
    )
}

/// See [`force_for`]: a locked axis has an empty row and column.
pub(crate) fn torque_for(acceleration: DVec3, mut inverse_inertia: DMat3) -> DVec3 {
    let mut free = DVec3::ONE;
    for axis in 0..3 {
        if inverse_inertia.col(axis)[axis] == 0.0 {
            inverse_inertia.col_mut(axis)[axis] = 1.0;
            free[axis] = 0.0;
        }
    }
    let torque = inverse_inertia.inverse() * (acceleration * free) * free;
    if torque.is_finite() {
        torque
    } else {
        DVec3::ZERO
    }
}
