//! The interface between the crate and a physics engine. The rest of the crate uses engines only through it.
//!
//! An engine that moves bodies in equal substeps implements [`Sight`] and [`Engine`]; then springs between free bodies work.
//! Only the engine knows the forces of contacts and joints. So a backend whose engine has them must itself solve the components
//! that they hold (`rapier::held`).

mod ends;
pub(crate) mod rapier;

pub(crate) use ends::{Allowance, Finder, Found, Movable, Place, Stance};

use crate::dynamics::body::Body;
use crate::dynamics::delivery::{Schedule, TurnRule};
use bevy::math::{DQuat, DVec3, Quat, Vec3};

/// Handle of a body in the engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct BodyId {
    pub index: u32,
    /// Distinguishes the body from earlier bodies with the same index.
    pub generation: u32,
}

impl BodyId {
    /// No body.
    pub(crate) const NONE: Self = Self {
        index: u32::MAX,
        generation: u32::MAX,
    };
}

/// Handle of a joint in the engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct JointId {
    pub index: u32,
    /// Distinguishes the joint from earlier joints with the same index.
    pub generation: u32,
}

/// A force (N) and a torque (N m) on a body, in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Wrench {
    pub force: Vec3,
    pub torque: Vec3,
}

/// How the engine will step in this tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepPlan {
    /// Total time of the tick, s; 0 if the engine does not step.
    pub time: f64,
    /// Number of engine steps in that time.
    pub calls: u32,
    /// Number of substeps per engine step, for a body that asks for no extra substeps.
    pub substeps: usize,
    /// Greatest speed that the engine allows, m/s.
    pub fastest: f64,
    /// Greatest rotation of a body in the whole tick, rad. It does not apply to bodies that may turn fast.
    pub farthest_turn: f64,
    /// How the engine integrates rotation.
    pub turn: TurnRule,
    /// Typical size of an object, m. The speed below which a body counts as resting is proportional to it.
    pub length_unit: f32,
}

impl StepPlan {
    /// Schedule of a body that has `substeps` substeps in each engine step.
    pub(crate) fn schedule(&self, substeps: usize) -> Schedule {
        let substeps = u32::try_from(substeps.max(1)).unwrap_or(u32::MAX);
        Schedule::new(self.time, substeps, self.calls.max(1))
    }
}

/// Distance up to which an end counts as at the centre of mass of its body, m: the rounding of f32 in a body of a metre. An
/// element at a greater distance turns the body. Pinned by `anchoring`.
pub(crate) const SAME_PLACE: f64 = 1e-7;

/// State of a body in the engine now. World frame unless a field says otherwise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// Origin of the body's frame, m.
    pub origin: Vec3,
    pub rotation: Quat,
    /// Centre of mass in the body's frame, m.
    pub local_center: Vec3,
    /// Velocity of the centre of mass, m/s.
    pub velocity: Vec3,
    /// Angular velocity, rad/s.
    pub spin: Vec3,
    /// Inverse mass, 1/kg; locked axes are not taken into account.
    pub inverse_mass: f32,
    /// Acceleration by gravity, m/s²; locked axes are not taken into account.
    pub gravity: DVec3,
    /// Number of substeps that the body asks for beyond those of all bodies.
    pub more_substeps: usize,
    /// Whether forces and impulses can move the body.
    pub is_movable: bool,
    pub is_asleep: bool,
    /// Whether its translation is locked along some world axis.
    pub is_locked: bool,
    /// Whether it has colliders.
    pub can_touch: bool,
    /// Whether the engine's cap on rotation does not apply to it.
    pub turns_fast: bool,
    /// Whether the engine applies gyroscopic forces to it.
    pub is_gyroscopic: bool,
}

impl Seen {
    /// Rotation from the body's frame to the world.
    pub(crate) fn facing(&self) -> DQuat {
        self.rotation.as_dquat().normalize()
    }

    /// Centre of mass in the world, m.
    #[inline(always)]
    pub(crate) fn center(&self) -> DVec3 {
        let origin = self.origin.as_dvec3();
        if self.local_center == Vec3::ZERO {
            origin
        } else {
            origin + self.facing() * self.local_center.as_dvec3()
        }
    }

    /// Whether its centre of mass is no longer at `center`, in the body's frame. An engine may not tell: a collider that is
    /// disabled or moved also moves the centre.
    #[inline(always)]
    pub(crate) fn has_shifted(&self, center: Vec3) -> bool {
        !self.local_center.abs_diff_eq(center, SAME_PLACE as f32)
    }

    /// Position and velocity of a point fixed to the body. `local` is the point in the body's frame.
    pub(crate) fn point(&self, local: DVec3) -> (DVec3, DVec3) {
        let arm = self.facing() * (local - self.local_center.as_dvec3());
        let velocity = self.velocity.as_dvec3() + self.spin.as_dvec3().cross(arm);
        (self.center() + arm, velocity)
    }
}

/// What the engine must be given for a body so that its step ends where the integrator's step ended.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Push {
    /// New velocity at the start of the step, m/s; none to keep the present one.
    pub velocity: Option<Vec3>,
    /// New angular velocity at the start of the step, rad/s; none to keep the present one.
    pub spin: Option<Vec3>,
    /// Force and torque of the elements, constant over the step.
    pub share: Wrench,
    /// Whether the body needs a second substep.
    pub second_substep: bool,
    /// Whether the body must not fall asleep yet.
    pub keep_awake: bool,
}

/// Read access to the bodies of an engine. Methods that return an `Option` return `None` for a body that no longer exists.
pub(crate) trait Sight: Sync {
    /// State of a body now.
    fn see(&self, body: BodyId) -> Option<Seen>;

    /// Whether a body is asleep.
    fn is_asleep(&self, body: BodyId) -> bool;

    /// The body as the integrator sees it. `turns` is false if every element holds the body at its centre of mass.
    fn body(&self, body: BodyId, user: &Wrench, turns: bool) -> Option<Body>;

    /// Position now, and position in `time` seconds, of a point on a body that elements cannot move. `local` is the point in
    /// the body's frame.
    fn way(&self, body: BodyId, local: DVec3, time: f64) -> Option<[DVec3; 2]>;

    /// Rotation now, and angular velocity over the coming `time` seconds (rad/s), of a body that elements cannot turn.
    fn turning(&self, body: BodyId, time: f64) -> Option<(DQuat, DVec3)>;

    /// Radius of gyration of a body, m, clamped to the range that the test for rest uses.
    fn size(&self, body: BodyId) -> f32;
}

/// The worlds of an engine after a step.
pub(crate) trait Worlds: Sync {
    /// Read access to the bodies of one world.
    type Sight: Sight;

    /// The bodies of the world whose entity in the ECS is `context`.
    fn of(&self, context: bevy::prelude::Entity) -> Option<&Self::Sight>;
}

/// Write access to the bodies of an engine.
pub(crate) trait Engine: Sight {
    /// Gives a body the velocities and forces in `push`. `user` is the user's force and torque, which acts as well.
    fn give(&mut self, body: BodyId, push: &Push, user: &Wrench);

    /// Resets the sleep timer of a body.
    fn keep_awake(&mut self, body: BodyId);

    /// Wakes a body.
    fn wake(&mut self, body: BodyId);
}
