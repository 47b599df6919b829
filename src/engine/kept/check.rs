//! Whether a world is one that it can be put into.

use super::{Kept, NONE};
use crate::engine::held::is_ours;
use crate::engine::parts::Acts;
use crate::engine::scene::Scene;
use crate::snapshot::SnapshotError;
use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

impl Kept {
    /// What does not fit; nothing is changed.
    pub(super) fn check(&self, world: &mut World) -> Result<(), SnapshotError> {
        if !world.contains_resource::<Scene>() {
            return Err(SnapshotError::NoPlugin);
        }
        let body = |index: u32| index == NONE || (index as usize) < self.bodies.len();
        let elements = self.elements.iter().flat_map(|element| element.on);
        let groups = self.groups.iter().map(|group| group.body);
        if !elements.chain(groups).all(body) {
            return Err(SnapshotError::Broken);
        }
        let mut elements = world.query_filtered::<(), Acts>();
        let mut seen = EntityHashSet::default();
        for element in &self.elements {
            if elements.get(world, element.entity).is_err() {
                return Err(SnapshotError::NoElement(element.entity));
            }
            if !seen.insert(element.entity) {
                return Err(SnapshotError::Twice(element.entity));
            }
        }
        seen.clear();
        let mut bodies = world.query::<(&RapierRigidBodyHandle, &RapierContextEntityLink)>();
        for body in &self.bodies {
            if bodies.get(world, body.entity).is_err() {
                return Err(SnapshotError::NoBody(body.entity));
            }
            if !seen.insert(body.entity) {
                return Err(SnapshotError::Twice(body.entity));
            }
        }
        if self.engine_stays {
            return Ok(());
        }
        self.check_engine(world)
    }

    /// Whether the engine has just those joints of ours that are known.
    fn check_engine(&self, world: &mut World) -> Result<(), SnapshotError> {
        let insides = self.elements.iter().filter_map(|e| e.inside.as_deref());
        let insides = || {
            insides
                .clone()
                .chain(self.left.iter().map(|(_, inside)| inside))
        };
        let known: usize = insides().map(|inside| inside.joints.len()).sum();
        let mut contexts = world.query::<(&RapierRigidBodySet, &RapierContextJoints)>();
        let mut there = 0;
        for (_, joints) in contexts.iter(world) {
            let ours = joints.impulse_joints.iter().filter(|(_, j)| is_ours(j));
            there += ours.count();
        }
        let in_some = |inside: &super::KeptInside| {
            let mut contexts = contexts.iter(world);
            contexts.any(|(set, joints)| inside.is_in(set, joints))
        };
        if there == known && insides().all(in_some) {
            Ok(())
        } else {
            Err(SnapshotError::OtherEngine)
        }
    }

    /// Leaves out what is in the engine: joints are made anew then.
    pub(crate) fn forget_engine(&mut self) {
        self.engine_stays = true;
        for element in &mut self.elements {
            if let Some(inside) = &mut element.inside {
                inside.joints.clear();
                inside.hidden = [None; 2];
            }
        }
    }
}
