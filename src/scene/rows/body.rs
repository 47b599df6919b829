//! What is kept of a body from step to step.

use crate::backend::{BodyId, Seen, Wrench};
use crate::scene::rows::marks::turning_mark;
use crate::scene::rows::raised::Raised;
use bevy::math::{DVec3, Quat, Vec3};
use bevy::prelude::Entity;

/// What a body is given over a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Share {
    pub force: Vec3,
    /// A torque too, which stands elsewhere.
    pub turns: bool,
    /// With a second substep, which has to be given back.
    pub second_substep: bool,
}

/// A body at rest: for how long, and where it has been so.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Rest {
    pub position: Vec3,
    pub rotation: Quat,
    pub seconds: f32,
    /// How fast it has gone away from there, m/s.
    pub rate: f32,
    /// It has been so for long enough.
    pub is_long: bool,
}

/// One movable body that elements act on. What every step needs stands first, and all of a body in one row, so that it comes from
/// memory at once: see [`ElementRow`].
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct BodyRow {
    pub entity: Entity,
    pub id: BodyId,
    /// Some element holds it off its centre of mass.
    pub turns: bool,
    /// Its mass, its elements or the user's share changed since the last step.
    pub disturbed: bool,
    /// It has been at rest since some time.
    pub rests: bool,
    /// Its only element goes through the step without an assembly.
    pub is_alone: bool,
    /// [`Self::now`] is of the last step; nobody asks for that of a body that is alone.
    pub is_noted: bool,
    /// It was stepped and has not been looked at since.
    pub is_fresh: bool,
    /// The engine has not stepped it yet.
    pub is_new: bool,
    /// It has colliders.
    pub can_touch: bool,
    /// A joint holds it,
    pub jointed: bool,
    /// something touches it,
    pub touched: bool,
    /// and pushes it,
    pub pressed: bool,
    /// so that it may go on creeping: see `scene::sleep`;
    pub creeps: bool,
    /// or did so a moment ago: it counts as held for so long still, s.
    pub lingers: f32,
    /// For so many steps nothing can come near its component. It stands here and not there so that components that are found anew
    /// do not forget it.
    pub clear: u8,
    pub user: Wrench,
    /// What we give it over the coming step; `None` where it is not stepped by us.
    pub share: Option<Share>,
    /// The engine still has a share of ours, which it should not have while it solves the elements itself.
    pub carries_share: bool,
    pub context: Entity,
    /// Centre of mass after the last step that was noted, and its velocity.
    pub now: (DVec3, Vec3),
    /// Since when and where it has been at rest, if it is.
    pub rest: Rest,
    /// The torque of its share.
    pub torque: Vec3,
    /// What it has been given besides forces.
    pub raised: Raised,
    /// Of all its elements, N/m.
    pub stiffness: f64,
    /// The engine's substep then, s.
    pub substep: f64,
    /// Index of its component,
    pub group: u32,
    /// and its own within that.
    pub slot: usize,
    /// Its place among the bodies of its component: see `scene::renew::Wanted::rank`.
    pub rank: u64,
    /// How many elements act on it.
    pub elements: u32,
    /// Which ones, as a hash; a change wakes it.
    pub signature: u64,
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
            context,
            turns: false,
            rank: 0,
            elements: 0,
            signature: 0,
            disturbed: true,
            group: u32::MAX,
            slot: 0,
            is_new: true,
            can_touch: true,
            jointed: false,
            touched: false,
            pressed: false,
            creeps: false,
            lingers: 0.0,
            clear: 0,
            user: Wrench::default(),
            share: None,
            carries_share: false,
            rests: false,
            is_alone: false,
            is_noted: true,
            is_fresh: false,
            rest: Rest::default(),
            torque: Vec3::ZERO,
            raised: Raised::default(),
            stiffness: 0.0,
            substep: 0.0,
            now: (DVec3::ZERO, Vec3::ZERO),
            turned: 0,
            pulled: 0,
        }
    }

    /// Whether something else than the engine's step has moved it, now that its centre of mass is here.
    pub(crate) fn was_displaced(&self, at: DVec3) -> bool {
        !self.is_noted || self.now.0 != at
    }

    /// Whether something else than elements and the engine's step can have changed its energy since the last step,
    /// now that its centre of mass is here; but for what acts on it.
    pub(crate) fn was_perturbed(&self, body: &Seen, at: DVec3) -> bool {
        let goes_on = !self.was_displaced(at)
            && self.now.1 == body.velocity
            && (!self.turns || self.turned == turning_mark(body));
        !goes_on || self.disturbed
    }

    /// Position and velocity of its centre of mass after the last step that was noted.
    pub(crate) fn place(&self) -> (DVec3, DVec3) {
        (self.now.0, self.now.1.as_dvec3())
    }
}
