//! What holds for every component of a context in this step, and what they all need.

use super::body::{Engine, Terms, is_movable, point_after, point_of, turning_of};
use super::rows::{ElementRow, Held};
use super::timestep::Plan;
use crate::dynamics::delivery::Schedule;
use crate::dynamics::guide::Guide;
use crate::dynamics::tolerance::Accuracy;
use bevy::math::{DQuat, DVec3};
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodyHandle, RigidBodySet};
use std::sync::atomic::AtomicBool;

/// A context about to step.
pub(super) struct Step {
    pub plan: Plan,
    /// The substeps of a body that asks for no more iterations than others.
    pub schedule: Schedule,
    pub engine: Engine,
    pub accuracy: Accuracy,
    /// Most substeps of a step for what the engine solves.
    pub most_substeps: u32,
    /// There are multibodies: then the engine steps all bodies as finely as the one that asks for most.
    pub alike: Option<usize>,
    /// Nothing but their own bodies and moved ends can have woken what sleeps.
    pub quiet: bool,
    /// Something was given to some body.
    pub delivered: AtomicBool,
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

impl Step {
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

    /// Whether an end that elements cannot turn turns, or is not turned as after the last step, where its element has an
    /// axis of its own.
    fn has_turned(&self, row: &ElementRow, end: usize, bodies: &RigidBodySet) -> bool {
        if row.companion.guide == Guide::Centres || row.memory.places[end].is_none() {
            return false;
        }
        let (rotation, turning) = facing(&row.held[end], self.plan.time, bodies);
        turning != DVec3::ZERO || rotation != row.memory.facings[end]
    }

    /// The engine's equal substeps of a body.
    fn substeps(&self, body: &RapierBody) -> Schedule {
        let more = self.alike.unwrap_or(body.additional_solver_iterations());
        match more {
            0 => self.schedule,
            more => self.plan.schedule(self.engine.iterations + more),
        }
    }

    /// How far the engine turns a body in this step, rad.
    pub(super) fn farthest_turn(&self, body: &RapierBody) -> f64 {
        if body.is_fast_rotation_allowed() {
            f64::INFINITY
        } else {
            self.substeps(body).farthest_turn(self.engine.farthest_turn)
        }
    }

    /// How the engine is to step a body.
    pub(super) fn terms(&self, body: &RapierBody) -> Terms {
        // One substep has room for a force or an impulse, not for both.
        let raised_iterations = self.engine.iterations * self.plan.pipeline_steps as usize == 1
            && body.additional_solver_iterations() == 0
            && self.alike.is_none();
        Terms {
            schedule: if raised_iterations {
                self.plan.schedule(self.engine.iterations + 1)
            } else {
                self.substeps(body)
            },
            raised_iterations,
        }
    }
}
