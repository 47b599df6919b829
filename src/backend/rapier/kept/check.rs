//! Checks whether a snapshot of the springs fits a world.

use crate::backend::BodyId;
use crate::backend::rapier::body::{handle, joint_handle};
use crate::backend::rapier::held::{fits, is_ours};
use crate::input::parts::Acts;
use crate::scene::held::{Joints, KeptJoint};
use crate::scene::kept::{Kept, KeptBody, KeptContext, KeptInside, NONE};
use crate::scene::rows::{BodyRow, Raised};
use crate::scene::state::Scene;
use crate::snapshot::SnapshotError;
use bevy::ecs::entity::EntityHashSet;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

impl Kept {
    /// Returns an error if the snapshot does not fit the world. Changes nothing.
    pub(crate) fn check(
        &self,
        world: &mut World,
        engine_went_back: bool,
    ) -> Result<(), SnapshotError> {
        if !world.contains_resource::<Scene>() {
            return Err(SnapshotError::NoPlugin);
        }
        let body = |index: u32| index == NONE || (index as usize) < self.bodies.len();
        let elements = self.elements.iter().flat_map(|element| element.on);
        let groups = self.groups.iter().map(|group| group.body);
        if !elements.chain(groups).all(body) {
            return Err(SnapshotError::Broken);
        }
        let insides = self.elements.iter().filter_map(|e| e.inside.as_deref());
        let mut insides = insides.chain(self.left.iter().map(|(_, inside)| inside));
        // Of two joints at one place, nobody would take care of the first.
        if insides.any(|inside| Joints::of(&inside.joints).count() != inside.joints.len()) {
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
        self.check_engine(world)?;
        self.check_orders(world, engine_went_back)
    }

    /// Checks that the engine has exactly those joints of the crate that the snapshot knows.
    fn check_engine(&self, world: &mut World) -> Result<(), SnapshotError> {
        let insides = self.elements.iter().filter_map(|e| e.inside.as_deref());
        let insides = || {
            insides
                .clone()
                .chain(self.left.iter().map(|(_, inside)| inside))
        };
        let elements = self.elements.iter().filter_map(|element| {
            let inside = element.inside.as_deref()?;
            Some((self.context_of(element, world), inside))
        });
        let left = self.left.iter().map(|(of, inside)| (Some(*of), inside));
        let joints = elements.chain(left).flat_map(|(of, inside)| {
            let joints = inside.joints.iter();
            joints.map(move |joint| (of, joint.id))
        });
        // A joint that is named twice counts once.
        let known = joints.collect::<HashSet<_>>().len();
        let mut contexts = world.query::<(&RapierRigidBodySet, &RapierContextJoints)>();
        let mut there = 0;
        for (_, joints) in contexts.iter(world) {
            let ours = joints.impulse_joints.iter().filter(|(_, j)| is_ours(j));
            there += ours.count();
        }
        let in_some = |inside: &KeptInside| {
            let mut contexts = contexts.iter(world);
            contexts.any(|(set, joints)| is_in(inside, set, joints))
        };
        if there == known && insides().all(in_some) {
            Ok(())
        } else {
            Err(SnapshotError::OtherEngine)
        }
    }

    /// Checks that bodies and contexts have the settings that the snapshot knows, such as solver iterations, and not later ones.
    fn check_orders(&self, world: &World, engine_went_back: bool) -> Result<(), SnapshotError> {
        let scene = world.get_resource::<Scene>().filter(|_| !engine_went_back);
        let as_known = |known: &KeptBody| {
            let body = world.get_entity(known.entity).ok()?;
            let context = body.get::<RapierContextEntityLink>()?.0;
            let set = world.get::<RapierRigidBodySet>(context)?;
            let of = body.get::<RapierRigidBodyHandle>()?.0;
            let meanwhile = scene.and_then(|scene| {
                let row = scene.body_row(known.entity)?;
                Some(scene.bodies[row].rare.raised)
            });
            let meanwhile = meanwhile.unwrap_or_default();
            Some(fits(&known.raised, set.bodies.get(of)?, meanwhile))
        };
        let has_sweeps = |known: &KeptContext| {
            let engine = world.get::<RapierContextSimulation>(known.entity)?;
            let now = engine.integration_parameters.num_internal_pgs_iterations;
            let meanwhile = scene.and_then(|scene| scene.sweeps.get(&known.entity).copied());
            Some(known.sweeps.fits(now, meanwhile.unwrap_or_default()))
        };
        // Bodies that no element moved at the time of the snapshot had no changed settings.
        let then: EntityHashSet = self.bodies.iter().map(|body| body.entity).collect();
        let had_nothing = |row: &BodyRow| {
            let set = world.get::<RapierRigidBodySet>(row.rare.context)?;
            let body = set.bodies.get(handle(row.id))?;
            Some(fits(&Raised::default(), body, row.rare.raised))
        };
        let new = scene.iter().flat_map(|scene| &scene.bodies);
        let mut new = new.filter(|row| !then.contains(&row.entity));
        // A body or context that the engine does not know yet counts as fitting.
        let bodies = self.bodies.iter();
        let mut contexts = self.contexts.iter();
        if bodies.map(as_known).all(|fits| fits.unwrap_or(true))
            && new.all(|row| had_nothing(row).unwrap_or(true))
            && contexts.all(|context| has_sweeps(context).unwrap_or(true))
        {
            Ok(())
        } else {
            Err(SnapshotError::OtherEngine)
        }
    }

    /// Drops the data about joints and hidden bodies in the engine. Joints are then made anew.
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

/// Whether all joints and hidden bodies of an element are in the engine. A handle alone does not tell: in another world it may
/// belong to a joint between other bodies, or to a body of the game.
pub(crate) fn is_in(
    inside: &KeptInside,
    set: &RapierRigidBodySet,
    joints: &RapierContextJoints,
) -> bool {
    let there = |kept: &KeptJoint| {
        let joint = joints.impulse_joints.get(joint_handle(kept.id));
        let bodies = kept.joint.bodies.map(handle);
        joint.is_some_and(|joint| is_ours(joint) && [joint.body1(), joint.body2()] == bodies)
    };
    let is_hidden = |body: &BodyId| {
        let body = set.bodies.get(handle(*body));
        // A body of the game has the bits of its entity here, which are never zero.
        body.is_some_and(|body| body.user_data == 0)
    };
    inside.joints.iter().all(there) && inside.hidden.iter().flatten().all(is_hidden)
}
