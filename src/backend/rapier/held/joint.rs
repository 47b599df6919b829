//! Converts a soft constraint into a Rapier joint with a motor. Only this file knows how Rapier computes motor forces.
//!
//! In a substep h, a motor with stiffness k, damping c and target s₀ gives the impulse h·(k (s − s₀) + (h k + c) ṡ − …), where
//! s is the length at the start of the substep and ṡ its rate at the end. For a damping C the motor therefore gets C − h k.
//! The result is symplectic Euler for the spring with implicit damping.

use crate::backend::JointId;
use crate::backend::rapier::body::{handle, joint_handle, joint_id};
use crate::dynamics::single;
use crate::scene::held::{Along, SoftJoint, SoftJoints};
use bevy_rapier3d::rapier::dynamics::{
    GenericJoint, GenericJointBuilder, ImpulseJoint, ImpulseJointSet, JointAxesMask, JointAxis,
    MotorModel, SpringCoefficients,
};
use bevy_rapier3d::rapier::math::Pose;

/// `user_data` of the joints that this crate makes.
const OURS: u128 = u128::from_be_bytes(*b"bevy_coilover\0\0\0");

/// Softness of locked axes that are to be free in fact. The frequency (Hz) is nearly zero, but not zero because Rapier divides
/// by it. [`Along::Apart`] needs such axes: Rapier applies a joint's impulse on the first body at the anchor of the second,
/// except for the offset along locked axes. Pinned by `ground::companions`.
const LOOSE: SpringCoefficients<f32> = SpringCoefficients {
    natural_frequency: 1e-9,
    damping_ratio: 1.0,
};

/// Whether this crate made a joint.
pub(crate) fn is_ours(joint: &ImpulseJoint) -> bool {
    joint.data.user_data == OURS
}

impl SoftJoints for ImpulseJointSet {
    fn put(&mut self, joint: &SoftJoint) -> JointId {
        let [a, b] = joint.bodies.map(handle);
        joint_id(self.insert(a, b, joint.data(), false))
    }

    fn change(&mut self, joint: JointId, numbers: &SoftJoint) -> bool {
        let joint = self.get_mut(joint_handle(joint), false);
        joint.map(|joint| joint.data = numbers.data()).is_some()
    }

    fn remove(&mut self, joint: JointId) {
        self.remove(joint_handle(joint), false);
    }

    fn has(&self, joint: JointId) -> bool {
        self.contains(joint_handle(joint))
    }
}

impl SoftJoint {
    fn axis(&self) -> JointAxis {
        match self.along {
            Along::Distance | Along::Slide | Along::Apart => JointAxis::LinX,
            Along::Twist => JointAxis::AngX,
        }
    }

    fn data(&self) -> GenericJoint {
        let axis = self.axis();
        let frame = |end: usize| Pose::from_parts(self.anchors[end], self.rotations[end]);
        let none = JointAxesMask::empty();
        let across = JointAxesMask::LIN_Y | JointAxesMask::LIN_Z;
        let (coupled, held) = match self.along {
            Along::Distance => (JointAxesMask::LIN_AXES, none),
            Along::Slide | Along::Twist => (none, none),
            Along::Apart => (none, across),
        };
        let ordered = ordered_damping(self.stiffness, self.damping, self.substep);
        // Total damping as Rapier computes it: the motor's force at a rate of 1.
        let acting = self.substep * self.stiffness + ordered;
        // A very large force over a very small damping does not fit into f32.
        let speed = single(-f64::from(self.force) / f64::from(acting));
        let mut joint = GenericJointBuilder::new(held)
            .softness(LOOSE)
            .coupled_axes(coupled)
            .local_frame1(frame(0))
            .local_frame2(frame(1))
            .user_data(OURS)
            .build();
        joint
            .set_motor(axis, self.target, speed, self.stiffness, ordered)
            .set_motor_model(axis, MotorModel::ForceBased)
            .set_motor_max_force(axis, self.most);
        joint
    }
}

/// Returns the damping to give Rapier so that the damping `wanted` acts in substeps of `substep` seconds. In Rapier's f32 this
/// is a small difference of large numbers, so the function also tries the next larger f32 numbers and returns the one that
/// changes the stiffness least.
fn ordered_damping(stiffness: f32, wanted: f32, substep: f32) -> f32 {
    let (k, h) = (stiffness, substep);
    let ordered = (f64::from(wanted) - f64::from(h) * f64::from(k)) as f32;
    let off = |c: f32| {
        // Same operations as in Rapier's `MotorModel::combine_coefficients`.
        let (per_rate, per_speed) = (h * k + c, h * h * k + h * c);
        if per_rate > 0.0 && per_speed > 0.0 {
            (f64::from(per_speed) / (f64::from(per_rate) * f64::from(h)) - 1.0).abs()
        } else {
            f64::INFINITY
        }
    };
    let mut best = (off(ordered), ordered);
    let mut candidate = ordered;
    for _ in 0..NEIGHBOURS {
        if best.0 < EXACT {
            break;
        }
        candidate = candidate.next_up();
        if off(candidate) < best.0 {
            best = (off(candidate), candidate);
        }
    }
    best.1
}

/// Number of neighbouring f32 numbers to try. Pinned by
/// `joint::tests::what_rapier_makes_of_the_order_is_what_was_wanted`.
const NEIGHBOURS: usize = 64;
/// Relative error of the stiffness that is small enough. Pinned by
/// `joint::tests::what_rapier_makes_of_the_order_is_what_was_wanted`.
const EXACT: f64 = 3e-7;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::BodyId;
    use bevy::math::{Quat, Vec3};

    #[test]
    fn what_rapier_makes_of_the_order_is_what_was_wanted() {
        let model = MotorModel::ForceBased;
        for substep in [1.0 / 960.0_f32, 1.0 / 3840.0, 1.0 / 240.0] {
            for stiffness in [1.0_f32, 777.0, 30e3, 1.234e6] {
                let least = 5e-4 * substep * stiffness;
                for damping in [least, least.max(0.1), least.max(2e3)] {
                    let ordered = ordered_damping(stiffness, damping, substep);
                    let (bias, _, gain) = model.combine_coefficients(substep, stiffness, ordered);
                    // Ratios of the acting stiffness and damping to the wanted ones.
                    let (bias, gain) = (f64::from(bias), f64::from(gain));
                    let springs = bias / gain / f64::from(substep) / f64::from(stiffness);
                    let dampens = 1.0 / (gain * f64::from(substep)) / f64::from(damping);
                    assert!(
                        (springs - 1.0).abs() < 2e-5,
                        "{stiffness} {damping}: {springs}"
                    );
                    assert!(
                        (dampens - 1.0).abs() < 0.01,
                        "{stiffness} {damping}: {dampens}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_huge_force_beside_a_tiny_damping_gives_a_motor_of_finite_numbers() {
        let joint = SoftJoint {
            bodies: [0, 1].map(|index| BodyId {
                index,
                generation: 0,
            }),
            anchors: [Vec3::ZERO; 2],
            rotations: [Quat::IDENTITY; 2],
            along: Along::Distance,
            substep: 1.0 / 960.0,
            stiffness: 0.0,
            damping: 5e-6,
            target: 0.0,
            force: -1e36,
            most: 5e7,
        };
        let speed = joint.data().motors[JointAxis::LinX as usize].target_vel;
        assert_eq!(speed, f32::MAX);
    }
}
