//! Whether contacts or joints hold a body.

use super::joint::is_ours;
use crate::engine::scene::BodyRow;
use bevy::math::Vec3;
use bevy_rapier3d::prelude::RapierContextJoints;
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::NarrowPhase;

/// How long a body counts as held after the last contact, s: a wheel that hops and a foot that drums need not change
/// between the two ways of being solved in every step. Pinned by `ground::drumming`.
const LINGER: f32 = 0.1;

/// What can hold bodies in a Rapier context.
pub(in crate::engine) struct Surroundings<'a> {
    pub narrow: &'a NarrowPhase,
    pub joints: &'a RapierContextJoints,
    /// There are joints at all.
    pub any_joints: bool,
}

impl<'a> Surroundings<'a> {
    pub(in crate::engine) fn new(narrow: &'a NarrowPhase, joints: &'a RapierContextJoints) -> Self {
        let links = joints.multibody_joints.multibodies().next().is_some();
        Self {
            narrow,
            joints,
            any_joints: links || !joints.impulse_joints.is_empty(),
        }
    }

    /// Whether a joint other than ours acts on a body.
    pub(in crate::engine) fn is_jointed(&self, handle: RigidBodyHandle) -> bool {
        if !self.any_joints {
            return false;
        }
        let RapierContextJoints {
            impulse_joints,
            multibody_joints,
            ..
        } = self.joints;
        multibody_joints.rigid_body_link(handle).is_some()
            || impulse_joints
                .attached_enabled_joints(handle)
                .any(|(_, _, _, joint)| !is_ours(joint))
    }

    /// Whether anything touches a body, or will in the coming step as far as the engine has looked ahead; and whether it
    /// has pushed it in the last one.
    fn touch(&self, body: &RapierBody) -> (bool, bool) {
        let (mut touched, mut pressed) = (false, false);
        for collider in body.colliders() {
            for pair in self.narrow.contact_pairs_with(*collider) {
                touched |= pair.has_any_active_contact();
                pressed |= pair.total_impulse() != Vec3::ZERO;
            }
        }
        (touched, pressed)
    }

    /// Looks what holds a body at the start of a step of `time` seconds; says whether anything does, or did a moment ago.
    pub(in crate::engine) fn look(&self, row: &mut BodyRow, body: &RapierBody, time: f64) -> bool {
        row.can_touch = !body.colliders().is_empty();
        row.jointed = self.is_jointed(row.handle);
        (row.touched, row.pressed) = self.touch(body);
        if row.jointed || row.touched {
            row.lingers = LINGER;
        } else {
            row.lingers = (row.lingers - time as f32).max(0.0);
        }
        // Contacts are found only within a step: before its first one it may touch anything.
        let unknown = std::mem::take(&mut row.is_new) && row.can_touch;
        row.pressed |= unknown;
        row.lingers > 0.0 || unknown
    }
}
