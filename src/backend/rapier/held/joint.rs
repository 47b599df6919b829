//! A soft constraint as a joint of Rapier's: the only place that knows how its motors reckon.
//!
//! A motor with stiffness k, damping c and target s₀ gives in a substep h the impulse h·(k (s − s₀) + (h k + c) ṡ − …),
//! where s is the length at the start and ṡ its rate at the end. So a damping of C is ordered as C − h k; what is left is
//! the symplectic Euler rule with an implicit damper.

use crate::backend::JointId;
use crate::backend::rapier::body::{handle, joint_handle, joint_id};
use crate::scene::held::{Along, SoftJoint, SoftJoints};
use bevy_rapier3d::rapier::dynamics::{
    GenericJoint, GenericJointBuilder, ImpulseJoint, ImpulseJointSet, JointAxesMask, JointAxis,
    MotorModel, SpringCoefficients,
};
use bevy_rapier3d::rapier::math::Pose;

/// Marks the joints that are ours alone.
const OURS: u128 = u128::from_be_bytes(*b"bevy_coilover\0\0\0");

/// How softly an axis is held that is to be free, Hz: not at all, but for numbers that Rapier divides by. Rapier pushes the
/// first body where the second one is, but for what lies along axes that are held. Pinned by `ground::companions`.
const LOOSE: SpringCoefficients<f32> = SpringCoefficients {
    natural_frequency: 1e-9,
    damping_ratio: 1.0,
};

/// Whether elements have made a joint.
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
        // As Rapier reckons it: what its damper gives at a speed of 1.
        let acting = self.substep * self.stiffness + ordered;
        let mut joint = GenericJointBuilder::new(held)
            .softness(LOOSE)
            .coupled_axes(coupled)
            .local_frame1(frame(0))
            .local_frame2(frame(1))
            .user_data(OURS)
            .build();
        joint
            .set_motor(
                axis,
                self.target,
                -self.force / acting,
                self.stiffness,
                ordered,
            )
            .set_motor_model(axis, MotorModel::ForceBased)
            .set_motor_max_force(axis, self.most);
        joint
    }
}

/// The damping to order so that in substeps of so long a damping of `wanted` acts. What Rapier makes of it in f32 is a
/// small difference of large numbers, so of its neighbours the one is taken that leaves the stiffness as it is.
fn ordered_damping(stiffness: f32, wanted: f32, substep: f32) -> f32 {
    let (k, h) = (stiffness, substep);
    let ordered = (f64::from(wanted) - f64::from(h) * f64::from(k)) as f32;
    let off = |c: f32| {
        // As in Rapier's `MotorModel::combine_coefficients`.
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

/// Neighbours that are tried, and the relative error of the stiffness that is small enough.
const NEIGHBOURS: usize = 64;
const EXACT: f64 = 3e-7;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rapier_makes_of_the_order_is_what_was_wanted() {
        let model = MotorModel::ForceBased;
        for substep in [1.0 / 960.0_f32, 1.0 / 3840.0, 1.0 / 240.0] {
            for stiffness in [1.0_f32, 777.0, 30e3, 1.234e6] {
                let least = 5e-4 * substep * stiffness;
                for damping in [least, least.max(0.1), least.max(2e3)] {
                    let ordered = ordered_damping(stiffness, damping, substep);
                    let (bias, _, gain) = model.combine_coefficients(substep, stiffness, ordered);
                    // Force for a stretch, and for a speed.
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
}
