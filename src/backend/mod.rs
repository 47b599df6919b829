//! What a physics engine must tell and be told; all else of the crate knows engines through this alone.
//!
//! An engine that has bodies which fly in equal substeps implements [`Sight`] and [`Engine`], and springs between free bodies
//! work. What contacts or joints hold is another matter, for there only the engine knows what acts: a backend that has such
//! things solves those components itself (`rapier::held`).

mod ends;
pub(crate) mod rapier;

pub(crate) use ends::{Finder, Found, Movable, Place};

use crate::dynamics::body::Body;
use crate::dynamics::delivery::{Schedule, TurnRule};
use bevy::math::{DQuat, DVec3, Quat, Vec3};

/// What an engine calls one of its bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct BodyId {
    pub index: u32,
    /// Tells it from others that had this index before.
    pub generation: u32,
}

impl BodyId {
    /// No body.
    pub(crate) const NONE: Self = Self {
        index: u32::MAX,
        generation: u32::MAX,
    };
}

/// What an engine calls one of its joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct JointId {
    pub index: u32,
    /// Tells it from others that had this index before.
    pub generation: u32,
}

/// A force (N) and a torque (N m) on a body, world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Wrench {
    pub force: Vec3,
    pub torque: Vec3,
}

/// How an engine is about to step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepPlan {
    /// Seconds in all; 0 where nothing will be stepped.
    pub time: f64,
    /// Steps of the engine in it, one after the other.
    pub calls: u32,
    /// Substeps of each of them, for a body that asks for no more.
    pub substeps: usize,
    /// Cap on speeds, m/s.
    pub fastest: f64,
    /// Cap on turning in all, rad; a body that may turn fast has none.
    pub farthest_turn: f64,
    /// How it turns a body.
    pub turn: TurnRule,
    /// Length of an ordinary thing, m: what counts as rest is that many times as fast.
    pub length_unit: f32,
}

impl StepPlan {
    /// The substeps of a body that the engine takes so many of in a step of its own.
    pub(crate) fn schedule(&self, substeps: usize) -> Schedule {
        let substeps = u32::try_from(substeps.max(1)).unwrap_or(u32::MAX);
        Schedule::new(self.time, substeps.saturating_mul(self.calls.max(1)))
    }
}

/// A body as an engine has it now. World frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// Origin of its frame, m.
    pub origin: Vec3,
    pub rotation: Quat,
    /// Centre of mass in its own frame, m.
    pub local_center: Vec3,
    /// Of the centre of mass, m/s.
    pub velocity: Vec3,
    /// rad/s.
    pub spin: Vec3,
    /// 1/kg, whatever is locked.
    pub inverse_mass: f32,
    /// By gravity where nothing is locked, m/s².
    pub gravity: DVec3,
    /// Substeps that it asks for beyond those of all.
    pub more_substeps: usize,
    /// Forces and impulses can move it.
    pub is_movable: bool,
    pub is_asleep: bool,
    /// It cannot move along some axis of the world.
    pub is_locked: bool,
    /// It has colliders.
    pub can_touch: bool,
    /// It may turn faster than others.
    pub turns_fast: bool,
    /// The engine counts in that a body spins about another axis than that of its momentum.
    pub is_gyroscopic: bool,
}

impl Seen {
    /// From its frame to the world.
    pub(crate) fn facing(&self) -> DQuat {
        self.rotation.as_dquat().normalize()
    }

    /// Centre of mass.
    #[inline(always)]
    pub(crate) fn center(&self) -> DVec3 {
        let origin = self.origin.as_dvec3();
        if self.local_center == Vec3::ZERO {
            origin
        } else {
            origin + self.facing() * self.local_center.as_dvec3()
        }
    }

    /// Position and velocity of a point fixed to it (`local` in its frame).
    pub(crate) fn point(&self, local: DVec3) -> (DVec3, DVec3) {
        let arm = self.facing() * (local - self.local_center.as_dvec3());
        let velocity = self.velocity.as_dvec3() + self.spin.as_dvec3().cross(arm);
        (self.center() + arm, velocity)
    }
}

/// What an engine is told of a body, so that it ends the step where the integrator did.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Push {
    /// Velocities at the start, if others than it has, m/s and rad/s.
    pub velocity: Option<Vec3>,
    pub spin: Option<Vec3>,
    /// By elements, over the step.
    pub share: Wrench,
    /// It is to take a second substep.
    pub second_substep: bool,
    /// It is not to fall asleep yet.
    pub keep_awake: bool,
}

/// What an engine tells of its bodies. A body that is gone is none.
pub(crate) trait Sight: Sync {
    /// How it is now.
    fn see(&self, body: BodyId) -> Option<Seen>;

    /// Whether it sleeps.
    fn is_asleep(&self, body: BodyId) -> bool;

    /// The integrator's view of it. `turns` is false where every element holds it at its centre of mass.
    fn body(&self, body: BodyId, user: &Wrench, turns: bool) -> Option<Body>;

    /// Where a point of a body that elements cannot move is now (`local` in the body's frame), and where it will be in
    /// `time` seconds.
    fn way(&self, body: BodyId, local: DVec3, time: f64) -> Option<[DVec3; 2]>;

    /// How a body that elements cannot turn is turned now, and its angular velocity over the coming `time` seconds.
    fn turning(&self, body: BodyId, time: f64) -> Option<(DQuat, DVec3)>;

    /// Its radius of gyration, in the bounds that count for whether it rests, m.
    fn size(&self, body: BodyId) -> f32;
}

/// The worlds of an engine, after a step.
pub(crate) trait Worlds: Sync {
    /// The bodies of one.
    type Sight: Sight;

    /// Those of the world that the ECS calls so.
    fn of(&self, context: bevy::prelude::Entity) -> Option<&Self::Sight>;
}

/// What an engine is told.
pub(crate) trait Engine: Sight {
    /// Has a body go where elements take it; `user` acts beside them.
    fn give(&mut self, body: BodyId, push: &Push, user: &Wrench);

    /// Has a body not fall asleep yet.
    fn keep_awake(&mut self, body: BodyId);

    /// Wakes a body.
    fn wake(&mut self, body: BodyId);
}
