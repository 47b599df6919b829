//! Before the first step: what the joints that tie a body to fixed ground leave of a load's effect.

use crate::dynamics::body::Body;
use bevy::math::{DMat3, DVec3};
use bevy_rapier3d::prelude::RapierContextJoints;
use bevy_rapier3d::rapier::dynamics::{
    JointAxesMask, RigidBody as RapierBody, RigidBodyHandle, RigidBodySet,
};
use nalgebra::{DMatrix, Matrix6, Vector6};

const LINEAR: [JointAxesMask; 3] = [
    JointAxesMask::LIN_X,
    JointAxesMask::LIN_Y,
    JointAxesMask::LIN_Z,
];
const ANGULAR: [JointAxesMask; 3] = [
    JointAxesMask::ANG_X,
    JointAxesMask::ANG_Y,
    JointAxesMask::ANG_Z,
];

/// Share of a free body's response to a force (N) and torque (N m) that is left to this one, or `None`
/// where no joint ties it to something that cannot be moved. `free` must know its inertia.
pub(super) fn share(
    handle: RigidBodyHandle,
    free: &Body,
    load: (DVec3, DVec3),
    bodies: &RigidBodySet,
    joints: &RapierContextJoints,
) -> Option<f64> {
    let mut rows: Vec<Vector6<f64>> = Vec::new();
    for (first, second, _, joint) in joints.impulse_joints.attached_enabled_joints(handle) {
        let (other, frame) = if first == handle {
            (second, joint.data.local_frame1)
        } else {
            (first, joint.data.local_frame2)
        };
        if bodies.get(other).is_some_and(RapierBody::is_dynamic) {
            continue;
        }
        let Some(center) = bodies.get(handle).map(RapierBody::local_center_of_mass) else {
            continue;
        };
        let arm = free.rotation * (frame.translation - center).as_dvec3();
        let axes = DMat3::from_quat(free.rotation * frame.rotation.as_dquat());
        for k in 0..3 {
            let axis = axes.col(k);
            if joint.data.locked_axes.contains(LINEAR[k]) {
                rows.push(stack(axis, arm.cross(axis)));
            }
            if joint.data.locked_axes.contains(ANGULAR[k]) {
                rows.push(stack(DVec3::ZERO, axis));
            }
        }
    }
    if rows.is_empty() {
        return None;
    }
    let mut mobility = Matrix6::zeros();
    let inverse_inertia = free.inverse_inertia();
    for r in 0..3 {
        mobility[(r, r)] = free.inverse_mass[r];
        for c in 0..3 {
            mobility[(3 + r, 3 + c)] = inverse_inertia.col(c)[r];
        }
    }
    let load = stack(load.0, load.1);
    let response = mobility * load;
    let whole = load.dot(&response);
    // The constraint force that keeps every row at rest: J W Jᵀ λ = J W p.
    let jacobian = DMatrix::from_fn(rows.len(), 6, |r, c| rows[r][c]);
    let constrained = &jacobian * mobility * jacobian.transpose();
    let wanted = &jacobian * response;
    let scale = constrained.amax().max(f64::MIN_POSITIVE);
    let lambda = constrained
        .svd(true, true)
        .solve(&wanted, 1e-9 * scale)
        .ok()?;
    let held = lambda.dot(&wanted);
    (whole > 0.0).then(|| (1.0 - held / whole).clamp(0.0, 1.0))
}

fn stack(linear: DVec3, angular: DVec3) -> Vector6<f64> {
    Vector6::new(
        linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
    )
}
