//! The row of a body: what is kept of it from step to step.

use super::flags::BodyFlags;
use super::marks::turning_mark;
use super::raised::Raised;
use crate::backend::{BodyId, Seen, Wrench};
use bevy::math::{DVec3, Vec3};
use bevy::prelude::Entity;

/// For how long and where a body has been at rest.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Rest {
    pub position: Vec3,
    /// A quaternion. As such it would be aligned to 16 bytes, and the row with it.
    pub rotation: [f32; 4],
    pub seconds: f32,
    /// Mean speed at which the body has moved away from `position`, m/s.
    pub rate: f32,
}

/// One movable body on which elements act: the data that every step needs, in one cache line. Thousands of rows do not fit into
/// the processor's cache, and data that is not read need not be loaded.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct BodyRow {
    pub entity: Entity,
    pub id: BodyId,
    pub flags: BodyFlags,
    /// Number of the tick in which it was last given its share of force.
    pub given: u32,
    /// Force of the user, N.
    pub user_force: Vec3,
    /// Force of elements over the coming step, N.
    pub share_force: Vec3,
    /// Number of steps in which nothing can come near its component, if the body moves as [`RareBody::searched`] allows. It is
    /// stored in the body, so that it is not lost when components are found anew.
    pub clear: u8,
    pub rare: Box<RareBody>,
}

/// A search for what a component may hit.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Searched {
    /// Centre of mass of the body at that time, m.
    pub at: Vec3,
    /// Distance that the body can move without a new search, m.
    pub way: f32,
}

/// Data of a body that not every step needs. It has many fields because each is read alone, in another stage of a step.
#[derive(Clone, Debug)]
pub(crate) struct RareBody {
    /// Entity of the context that contains the body.
    pub context: Entity,
    /// Index of its group.
    pub group: u32,
    /// Index of the body within its component.
    pub slot: u32,
    /// Sort key within its component: see [`crate::backend::Movable::rank`].
    pub rank: u64,
    /// Hash of the elements that act on it. A change wakes the body.
    pub signature: u64,
    /// Centre of mass in the body's frame when the rows were made, m. Elements that do not turn the body hold it there.
    pub center: Vec3,
    /// For how long and where it has been at rest, if it is at rest.
    pub rest: Rest,
    /// Time for which it still counts as held, s.
    pub lingers: f32,
    /// Torque of the user, N m. Valid only with [`BodyFlags::USER_TORQUE`].
    pub user_torque: Vec3,
    /// Torque of elements, N m. Valid only with [`BodyFlags::SHARES_TORQUE`].
    pub share_torque: Vec3,
    /// Settings of the engine's body that the crate has changed for a time.
    pub raised: Raised,
    /// Total stiffness of its elements without torsion elements, N/m. Infinite if an element has a force law.
    pub stiffness: f64,
    /// Substep with which the engine last solved its component, s.
    pub substep: f64,
    /// Position (m) and velocity (m/s) of the centre of mass when they were last stored after a step.
    pub now: (DVec3, Vec3),
    /// The last search for what its component may hit.
    pub searched: Searched,
    /// Hash of its acceleration by everything but elements in the last step.
    pub pulled: u64,
    /// Hash of rotation and angular velocity when `now` was stored, for a body that elements turn.
    pub turned: u64,
}

impl BodyRow {
    pub(crate) fn new(entity: Entity, id: BodyId, context: Entity) -> Self {
        Self {
            entity,
            id,
            flags: BodyFlags::DISTURBED | BodyFlags::NEW | BodyFlags::CAN_TOUCH | BodyFlags::NOTED,
            given: 0,
            user_force: Vec3::ZERO,
            share_force: Vec3::ZERO,
            clear: 0,
            rare: Box::new(RareBody {
                context,
                group: u32::MAX,
                slot: 0,
                rank: 0,
                signature: 0,
                center: Vec3::ZERO,
                rest: Rest::default(),
                lingers: 0.0,
                user_torque: Vec3::ZERO,
                share_torque: Vec3::ZERO,
                raised: Raised::default(),
                stiffness: 0.0,
                substep: 0.0,
                now: (DVec3::ZERO, Vec3::ZERO),
                searched: Searched::default(),
                pulled: 0,
                turned: 0,
            }),
        }
    }

    pub(crate) fn has(&self, flags: BodyFlags) -> bool {
        self.flags.contains(flags)
    }

    /// Stores whether the body has colliders. Returns whether that has changed.
    #[inline(always)]
    pub(crate) fn notice_colliders(&mut self, can_touch: bool) -> bool {
        let new = self.has(BodyFlags::CAN_TOUCH) != can_touch;
        self.flags.set(BodyFlags::CAN_TOUCH, can_touch);
        new
    }

    /// Force and torque of the user.
    #[inline(always)]
    pub(crate) fn user(&self) -> Wrench {
        let torque = if self.has(BodyFlags::USER_TORQUE) {
            self.rare.user_torque
        } else {
            Vec3::ZERO
        };
        Wrench {
            force: self.user_force,
            torque,
        }
    }

    pub(crate) fn set_user(&mut self, user: Wrench) {
        let turns = user.torque != Vec3::ZERO;
        self.user_force = user.force;
        self.flags.set(BodyFlags::USER_TORQUE, turns);
        if turns {
            self.rare.user_torque = user.torque;
        }
    }

    /// Notes that the engine has this share of elements in the force of the body.
    pub(crate) fn carry(&mut self, share: &Wrench) {
        let turns = share.torque != Vec3::ZERO;
        if turns || share.force != Vec3::ZERO {
            self.flags.insert(BodyFlags::CARRIES_SHARE);
            self.flags.set(BodyFlags::SHARES_TORQUE, turns);
        }
    }

    /// Force and torque of elements, if the body was given them in the tick with this number.
    #[inline(always)]
    pub(crate) fn share(&self, tick: u32) -> Option<Wrench> {
        let torque = if self.has(BodyFlags::SHARES_TORQUE) {
            self.rare.share_torque
        } else {
            Vec3::ZERO
        };
        (self.given == tick).then_some(Wrench {
            force: self.share_force,
            torque,
        })
    }

    /// Whether something other than the engine's step may have moved the body. `at` is its centre of mass now.
    fn was_displaced(&self, at: DVec3) -> bool {
        !self.has(BodyFlags::NOTED) || self.rare.now.0 != at
    }

    /// Whether something other than elements and the engine's step may have changed its energy since the last step. Outside
    /// forces are not considered. `at` is its centre of mass now.
    pub(crate) fn was_perturbed(&self, body: &Seen, at: DVec3) -> bool {
        let turns = self.has(BodyFlags::TURNS);
        let goes_on = !self.was_displaced(at)
            && self.rare.now.1 == body.velocity
            && (!turns || self.rare.turned == turning_mark(body));
        !goes_on || self.has(BodyFlags::DISTURBED)
    }

    /// Position and velocity of its centre of mass when they were last stored.
    pub(crate) fn place(&self) -> (DVec3, DVec3) {
        (self.rare.now.0, self.rare.now.1.as_dvec3())
    }
}
