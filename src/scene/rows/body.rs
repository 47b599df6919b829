//! What is kept of a body from step to step.

use super::flags::BodyFlags;
use super::marks::turning_mark;
use super::raised::Raised;
use crate::backend::{BodyId, Seen, Wrench};
use bevy::math::{DVec3, Quat, Vec3};
use bevy::prelude::Entity;

/// A body at rest: for how long, and where it has been so.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Rest {
    pub position: Vec3,
    pub rotation: Quat,
    pub seconds: f32,
    /// How fast it has gone away from there, m/s.
    pub rate: f32,
}

/// One movable body that elements act on: what every step needs, in one line of memory. Thousands of rows do not fit into the
/// processor's cache, and what is not read need not come.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct BodyRow {
    pub entity: Entity,
    pub id: BodyId,
    pub flags: BodyFlags,
    /// Number of the tick in which it was given its share.
    pub given: u32,
    /// The user's force, N,
    pub user_force: Vec3,
    /// and that of elements over the coming step.
    pub share_force: Vec3,
    /// For so many steps nothing can come near its component. It stands here and not there so that components that are found anew
    /// do not forget it.
    pub clear: u8,
    pub rare: Box<RareBody>,
}

/// What not every step needs of a body.
#[derive(Clone, Debug)]
pub(crate) struct RareBody {
    /// The world of the engine in which it is.
    pub context: Entity,
    /// Index of its component,
    pub group: u32,
    /// and its own within that.
    pub slot: u32,
    /// Its place among the bodies of its component: see [`crate::backend::Movable::rank`].
    pub rank: u64,
    /// Which elements act on it, as a hash; a change wakes it.
    pub signature: u64,
    /// Since when and where it has been at rest, if it is.
    pub rest: Rest,
    /// For so long it still counts as held, s.
    pub lingers: f32,
    /// The user's torque, N m,
    pub user_torque: Vec3,
    /// and that of elements.
    pub share_torque: Vec3,
    /// What it has been lent besides forces.
    pub raised: Raised,
    /// Of all its elements, N/m.
    pub stiffness: f64,
    /// The engine's substep in the last step, s.
    pub substep: f64,
    /// Centre of mass after the last step that was noted, and its velocity.
    pub now: (DVec3, Vec3),
    /// Acceleration by everything but elements in the last step, as a hash.
    pub pulled: u64,
    /// Rotation and angular velocity after the last step that was noted, of a body that elements turn, as a hash.
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
                rest: Rest::default(),
                lingers: 0.0,
                user_torque: Vec3::ZERO,
                share_torque: Vec3::ZERO,
                raised: Raised::default(),
                stiffness: 0.0,
                substep: 0.0,
                now: (DVec3::ZERO, Vec3::ZERO),
                pulled: 0,
                turned: 0,
            }),
        }
    }

    pub(crate) fn has(&self, flags: BodyFlags) -> bool {
        self.flags.contains(flags)
    }

    /// Notes whether it has colliders; says whether that is new.
    #[inline(always)]
    pub(crate) fn notice_colliders(&mut self, can_touch: bool) -> bool {
        let new = self.has(BodyFlags::CAN_TOUCH) != can_touch;
        self.flags.set(BodyFlags::CAN_TOUCH, can_touch);
        new
    }

    /// Force and torque of the user's.
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

    /// What it was given in a tick, if it was.
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

    /// Whether something else than the engine's step has moved it, now that its centre of mass is here.
    pub(crate) fn was_displaced(&self, at: DVec3) -> bool {
        !self.has(BodyFlags::NOTED) || self.rare.now.0 != at
    }

    /// Whether something else than elements and the engine's step can have changed its energy since the last step,
    /// now that its centre of mass is here; but for what acts on it.
    pub(crate) fn was_perturbed(&self, body: &Seen, at: DVec3) -> bool {
        let turns = self.has(BodyFlags::TURNS);
        let goes_on = !self.was_displaced(at)
            && self.rare.now.1 == body.velocity
            && (!turns || self.rare.turned == turning_mark(body));
        !goes_on || self.has(BodyFlags::DISTURBED)
    }

    /// Position and velocity of its centre of mass after the last step that was noted.
    pub(crate) fn place(&self) -> (DVec3, DVec3) {
        (self.rare.now.0, self.rare.now.1.as_dvec3())
    }
}
