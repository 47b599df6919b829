//! Creates joints. Rigid limits become a Rapier joint. Soft limits and drives become elements of this crate, except
//! for drives in acceleration mode without stiffness or with a target velocity, which become Rapier motors.

use super::carry::LoadedJoint;
use super::expand::{anchor, owner};
use super::physics_joint::{Drive, Limit};
use super::place::place;
use super::soft::{self, Frames};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{JointAxis, MotorModel};

const LINEAR: [JointAxis; 3] = [JointAxis::LinX, JointAxis::LinY, JointAxis::LinZ];
const ANGULAR: [JointAxis; 3] = [JointAxis::AngX, JointAxis::AngY, JointAxis::AngZ];

/// Returns Rapier's name for an axis of the joint.
fn axis(linear: bool, index: usize) -> JointAxis {
    if linear {
        LINEAR[index]
    } else {
        ANGULAR[index]
    }
}

/// Creates a joint between a node and its connected node.
pub(super) fn add(world: &mut World, node: Entity, joint: &LoadedJoint) {
    let told = |what: &str| log::warn!("{}: joint: {what}", joint.place);
    let other = joint.connected;
    let (Some(a), Some(b)) = (place(world, node), place(world, other)) else {
        return told("one of its nodes is nowhere; left out");
    };
    let bodies = [node, other].map(|end| owner(world, end));
    let moves = |body: &Entity| world.get::<RigidBody>(*body) != Some(&RigidBody::Fixed);
    if !bodies.iter().flatten().any(moves) {
        return told("neither of its nodes has a motion; left out");
    }
    if bodies[0] == bodies[1] {
        return told("both of its nodes belong to the same body; left out");
    }
    let [body_a, body_b] = [(bodies[0], node), (bodies[1], other)]
        .map(|(body, end)| body.unwrap_or_else(|| anchor(world, end)));
    let (Some(on_a), Some(on_b)) = (place(world, body_a), place(world, body_b)) else {
        return told("one of its bodies is nowhere; left out");
    };
    let frames = Frames {
        nodes: [node, other],
        places: [a, b],
        bodies: [on_a, on_b],
    };
    let mut rigid = GenericJoint::new(JointAxesMask::empty());
    let local = |on: &Transform, at: &Transform| {
        let turned = on.rotation.inverse();
        (
            turned * (at.translation - on.translation),
            turned * at.rotation,
        )
    };
    let ((at_a, turned_a), (at_b, turned_b)) = (local(&on_a, &a), local(&on_b, &b));
    rigid
        .set_local_anchor1(at_a)
        .set_local_basis1(turned_a)
        .set_local_anchor2(at_b)
        .set_local_basis2(turned_b)
        .set_contacts_enabled(joint.collide);
    let mut acts = !joint.collide;
    for limit in &joint.kind.limits {
        if let Some(stiffness) = limit.stiffness {
            if let Err(reason) = soft::add_limit(world, &frames, limit, stiffness) {
                told(reason);
            }
        } else {
            let (holds, lacks) = hold(&mut rigid, limit);
            acts |= holds;
            if let Some(reason) = lacks {
                told(reason);
            }
        }
    }
    for drive in &joint.kind.drives {
        if soft::is_ours(drive) {
            soft::add_drive(world, &frames, drive);
        } else {
            acts = true;
            motor(&mut rigid, drive);
        }
    }
    if acts {
        // On a separate entity, because a body can hold only one joint component.
        world.spawn((
            ImpulseJoint::new(body_a, TypedJoint::GenericJoint(rigid)),
            ChildOf(body_b),
        ));
    }
}

/// What is reported of a limit for which Rapier has no room beside an earlier one.
const SECOND: &str = "a second rigid limit on an axis, or on two or three axes, is left out";

/// Applies a rigid limit to a joint. Returns whether any of it takes effect, and a message if part of it does not.
fn hold(joint: &mut GenericJoint, limit: &Limit) -> (bool, Option<&'static str>) {
    let axes: Vec<_> = (0..3).filter(|i| limit.axes[*i]).collect();
    let mut mask = JointAxesMask::empty();
    for i in &axes {
        mask |= JointAxesMask::from(axis(limit.linear, *i));
    }
    if limit.min.is_none() && limit.max.is_none() {
        return (false, None);
    }
    let (locked, coupled) = (joint.raw.locked_axes, joint.raw.coupled_axes);
    let limited = joint.raw.limit_axes | coupled;
    if let [only] = axes[..] {
        if (limit.min, limit.max) == (Some(0.0), Some(0.0)) {
            if coupled.intersects(mask) {
                return (false, Some(SECOND));
            }
            joint.lock_axes(mask);
            return (true, None);
        }
        // On a locked axis it would have no effect.
        if limited.intersects(mask) {
            return (false, Some(SECOND));
        }
        let ends = [
            limit.min.unwrap_or(-f32::MAX),
            limit.max.unwrap_or(f32::MAX),
        ];
        joint.set_limits(axis(limit.linear, only), ends);
        return (true, None);
    }
    // The value is a distance or the angle of a cone, so it is never negative.
    let min = limit.min.unwrap_or(0.0).max(0.0);
    let Some(max) = limit.max else {
        let lacks = "a rigid limit with only a min on two or three axes is not honoured";
        return (false, Some(lacks));
    };
    if max <= 0.0 {
        if coupled.intersects(mask) {
            return (false, Some(SECOND));
        }
        joint.lock_axes(mask);
        return (true, None);
    }
    if !limit.linear && axes.len() == 3 {
        let lacks = "a rigid limit of the whole rotation is not honoured, but for max = 0";
        return (false, Some(lacks));
    }
    let kind = if limit.linear {
        JointAxesMask::LIN_AXES
    } else {
        JointAxesMask::ANG_AXES
    };
    // Rapier would couple the axes of both limits together, and panics if these are all three angles. It has one limit for
    // each axis, that of coupled axes in the place of the first, and ignores it where that axis is locked.
    if coupled.intersects(kind) || (limited | locked).intersects(mask) {
        return (false, Some(SECOND));
    }
    joint.set_coupled_axes(coupled | mask);
    joint.set_limits(axis(limit.linear, axes[0]), [0.0, max]);
    let lacks = "the min of a rigid limit on two or three axes is not honoured; its max is";
    (true, (min > 0.0).then_some(lacks))
}

/// Applies a drive to a joint as a Rapier motor.
fn motor(joint: &mut GenericJoint, drive: &Drive) {
    let axis = axis(drive.linear, drive.axis);
    let model = if drive.acceleration {
        MotorModel::AccelerationBased
    } else {
        MotorModel::ForceBased
    };
    joint.set_motor_model(axis, model);
    joint.set_motor(
        axis,
        drive.position,
        drive.velocity,
        drive.stiffness,
        drive.damping,
    );
    if let Some(most) = drive.max_force {
        joint.set_motor_max_force(axis, most);
    }
}
