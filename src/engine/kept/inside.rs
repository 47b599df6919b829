//! What an element has in the engine's solver, to and fro.

use super::KeptInside;
use crate::engine::held::{Inside, Joints, is_ours};
use bevy::prelude::Entity;
use bevy_rapier3d::prelude::{RapierContextJoints, RapierRigidBodySet};

impl KeptInside {
    pub(super) fn of(inside: &Inside) -> Self {
        // The rest is found anew before each step.
        let Inside {
            joints,
            hidden,
            context: _,
            active,
            pieces: _,
            from: _,
            direction: _,
            places: _,
            facings: _,
            rates,
            debt,
            turn: _,
            slipped,
            leeway,
        } = inside;
        Self {
            joints: joints.kept().collect(),
            hidden: *hidden,
            active: *active,
            slipped: *slipped,
            rates: *rates,
            debt: *debt,
            leeway: *leeway,
        }
    }

    pub(super) fn put(&self, context: Entity) -> Box<Inside> {
        Box::new(Inside {
            joints: Joints::of(&self.joints),
            hidden: self.hidden,
            context: Some(context),
            active: self.active,
            slipped: self.slipped,
            rates: self.rates,
            debt: self.debt,
            leeway: self.leeway,
            ..Inside::default()
        })
    }

    /// Whether all of it is in the engine, as ours.
    pub(super) fn is_in(&self, set: &RapierRigidBodySet, joints: &RapierContextJoints) -> bool {
        let there = |kept: &super::KeptJoint| {
            let joint = joints.impulse_joints.get(kept.handle);
            joint.is_some_and(is_ours)
        };
        let mut hidden = self.hidden.iter().flatten();
        self.joints.iter().all(there) && hidden.all(|handle| set.bodies.contains(*handle))
    }
}
