//! What stands for the elements of a plan.

use crate::plan::ElementPlan;
use crate::stage::Stage;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// What elements of a plan become.
#[derive(Clone, Copy, PartialEq)]
pub enum Springs {
    /// Elements of this crate.
    Ours,
    /// Joints of the engine with a motor, in as many substeps as this crate may order.
    Engines,
    /// Nothing.
    None,
}

/// Most solver iterations that the crate adds on its own to the engine's four.
const MOST_MORE: usize = 60;

impl Stage {
    /// Adds a joint of the engine that acts much as an element with these parameters.
    pub(crate) fn motor(&mut self, plan: &ElementPlan, ends: [Entity; 2]) {
        let world = self.app.world_mut();
        let is_body = |entity| world.get::<RigidBody>(entity).is_some();
        let [a, b] = ends;
        if a == b || !ends.into_iter().all(is_body) {
            return;
        }
        let number = |x: f32| {
            if x.is_finite() {
                x.clamp(0.0, 1e9)
            } else {
                0.0
            }
        };
        let rest = plan.rest.map_or(1.0, number);
        let (stiffness, damping) = (number(plan.stiffness), number(plan.damping));
        let joint: TypedJoint = if plan.kind < 3 {
            SpringJointBuilder::new(rest, stiffness, damping).into()
        } else {
            let joint = GenericJointBuilder::new(JointAxesMask::empty())
                .motor_model(JointAxis::AngX, MotorModel::ForceBased)
                .motor_position(JointAxis::AngX, rest, stiffness, damping);
            TypedJoint::GenericJoint(joint.build())
        };
        world.spawn((ImpulseJoint::new(a, joint), ChildOf(b)));
        for end in ends {
            let more = AdditionalSolverIterations(MOST_MORE);
            world.entity_mut(end).insert(more);
        }
    }
}
