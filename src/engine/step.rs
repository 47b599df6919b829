//! What holds for every component of a context in this step, and what they all need.

use super::body::{Engine, is_movable, point_after, point_of, turning_of};
use super::ground::Ground;
use super::scene::{BodyRow, ElementRow, Held};
use super::timestep::Plan;
use crate::dynamics::delivery::Schedule;
use crate::dynamics::guide::Guide;
use crate::dynamics::tolerance::Accuracy;
use bevy::math::{DQuat, DVec3};
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::ColliderSet;
use std::sync::atomic::AtomicBool;

/// Share of the lag by which a body with another one on it is seen behind. With all of it, it would neither lose nor
/// win but for the engine's contacts, which at some frequencies win as much as the rest takes.
const LOADED: f64 = 0.85;

/// A context about to step.
pub(super) struct Step<'a> {
    pub plan: Plan,
    /// The substeps of a body that asks for no more iterations than others.
    pub schedule: Schedule,
    pub engine: Engine,
    pub joints: &'a RapierContextJoints,
    pub colliders: &'a ColliderSet,
    pub ground: &'a Ground,
    pub accuracy: Accuracy,
    /// There are multibodies at all.
    pub links: bool,
    /// Nothing but their own bodies and moved ends can have woken what sleeps.
    pub quiet: bool,
    /// Something was given to some body.
    pub delivered: AtomicBool,
}

/// How the engine will step one body.
pub(super) struct Terms {
    pub schedule: Schedule,
    /// A link of a multibody does not keep velocities that are set.
    pub takes_impulses: bool,
    /// It is given a second solver iteration for that.
    pub raised_iterations: bool,
}

/// Rotation and angular velocity of what holds an end that elements cannot turn.
pub(super) fn facing(held: &Held, time: f64, bodies: &RigidBodySet) -> (DQuat, DVec3) {
    let body = match held {
        Held::Body { handle, .. } => bodies.get(*handle),
        Held::Path { .. } => None,
    };
    body.map_or((DQuat::IDENTITY, DVec3::ZERO), |body| {
        turning_of(body, time)
    })
}

impl Step<'_> {
    /// A body as it may be moved; one that may not be any more makes the scene stale.
    pub(super) fn movable<'b>(
        &self,
        bodies: &'b RigidBodySet,
        handle: RigidBodyHandle,
        stale: &mut bool,
    ) -> Option<&'b RapierBody> {
        let body = bodies.get(handle).filter(|body| is_movable(body));
        *stale |= body.is_none();
        body
    }

    /// Where a point is that elements cannot move, and where it will be after the step.
    pub(super) fn path(&self, held: &Held, bodies: &RigidBodySet) -> (DVec3, DVec3) {
        match *held {
            Held::Path { from, to } => (from, to),
            Held::Body { handle, local, .. } => match bodies.get(handle) {
                Some(body) => (
                    point_of(body, local).0,
                    point_after(body, local, self.plan.time),
                ),
                None => (local, local),
            },
        }
    }

    /// Whether an end moves or turns, or is not where or as it was after the last step.
    pub(super) fn has_moved(&self, row: &ElementRow, bodies: &RigidBodySet) -> bool {
        if row.watched == [false; 2] && row.moves() == 2 {
            // Held by what elements move, and where it says.
            return false;
        }
        (0..2).any(|end| {
            let now = match row.held[end] {
                Held::Body { local, .. } if row.on[end].is_some() => local,
                ref held => {
                    let (from, to) = self.path(held, bodies);
                    if from != to || self.has_turned(row, end, bodies) {
                        return true;
                    }
                    to
                }
            };
            row.memory.places[end].is_some_and(|last| last != now)
        })
    }

    /// The same of how an end is turned that elements cannot turn, where its element has an axis of its.
    fn has_turned(&self, row: &ElementRow, end: usize, bodies: &RigidBodySet) -> bool {
        if row.companion.guide == Guide::Centres || row.memory.places[end].is_none() {
            return false;
        }
        let (rotation, turning) = facing(&row.held[end], self.plan.time, bodies);
        turning != DVec3::ZERO || rotation != row.memory.facings[end]
    }

    /// The engine's equal substeps of a body.
    fn substeps(&self, body: &RapierBody) -> Schedule {
        match body.additional_solver_iterations() {
            0 => self.schedule,
            more => self.plan.schedule(self.engine.iterations + more),
        }
    }

    /// A link of a multibody does not keep velocities that are set.
    fn takes_impulses(&self, handle: RigidBodyHandle) -> bool {
        !self.links
            || self
                .joints
                .multibody_joints
                .rigid_body_link(handle)
                .is_none()
    }

    /// How far the engine turns a body in this step, rad.
    pub(super) fn farthest_turn(&self, handle: RigidBodyHandle, body: &RapierBody) -> f64 {
        if body.is_fast_rotation_allowed() || !self.takes_impulses(handle) {
            f64::INFINITY
        } else {
            self.substeps(body).farthest_turn(self.engine.farthest_turn)
        }
    }

    /// How far behind its present place, in time, a body has to be looked at. Under a force alone the
    /// engine's n substeps run ahead by h²/(2n) of the acceleration; seen that much earlier, the motion is
    /// the integrator's own.
    pub(super) fn lag(&self, handle: RigidBodyHandle, body: &RapierBody) -> f64 {
        if self.takes_impulses(handle) {
            0.0
        } else {
            self.runs_ahead(body)
        }
    }

    /// The same of a body on which the force has to act evenly, because another one lies on it.
    pub(super) fn lag_of_held(&self, row: &BodyRow, body: &RapierBody) -> f64 {
        if row.support.is_moving() && row.mobility < 1.0 && self.takes_impulses(row.handle) {
            LOADED * self.runs_ahead(body)
        } else {
            0.0
        }
    }

    fn runs_ahead(&self, body: &RapierBody) -> f64 {
        let schedule = self.substeps(body);
        0.5 * schedule.substep
    }

    /// How the engine is to step a body.
    pub(super) fn terms(&self, handle: RigidBodyHandle, body: &RapierBody) -> Terms {
        // One substep has room for a force or an impulse, not for both.
        let raised_iterations = self.engine.iterations * self.plan.pipeline_steps as usize == 1
            && body.additional_solver_iterations() == 0;
        Terms {
            schedule: if raised_iterations {
                self.plan.schedule(self.engine.iterations + 1)
            } else {
                self.substeps(body)
            },
            takes_impulses: self.takes_impulses(handle),
            raised_iterations,
        }
    }
}
