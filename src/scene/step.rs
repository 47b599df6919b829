//! What holds for every component of a context in this step, and what they all need.

use super::push::Terms;
use super::rows::{ElementRow, Held};
use crate::backend::{BodyId, Seen, Sight, StepPlan};
use crate::dynamics::delivery::Schedule;
use crate::dynamics::guide::Guide;
use crate::dynamics::tolerance::Accuracy;
use crate::settings::CoiloverSettings;
use bevy::math::{DQuat, DVec3};
use std::sync::atomic::AtomicBool;

/// Distance that a path may begin apart from where the last one ended and still go on from there, as a share of its coordinates
/// and of a metre at least: so much may come of the engine's f32. Pinned by `carried`.
const LEAP: f64 = 1e-6;

/// A context about to step.
pub(crate) struct Step {
    pub plan: StepPlan,
    /// The substeps of a body that asks for no more than others.
    pub schedule: Schedule,
    pub accuracy: Accuracy,
    /// Most substeps of a step for what the engine solves.
    pub most_substeps: u32,
    /// All bodies are stepped as finely as the one that asks for most, which asks for so many substeps more.
    pub alike: Option<usize>,
    /// Nothing but their own bodies and moved ends can have woken what sleeps.
    pub quiet: bool,
    /// Its number, counted on from tick to tick.
    pub tick: u32,
    /// Something was given to some body.
    pub delivered: AtomicBool,
}

/// Rotation and angular velocity of what holds an end that elements cannot turn.
pub(crate) fn facing(held: &Held, time: f64, sight: &impl Sight) -> (DQuat, DVec3) {
    let turning = match held {
        Held::Body { body, .. } => sight.turning(*body, time),
        Held::Path { .. } => None,
    };
    turning.unwrap_or((DQuat::IDENTITY, DVec3::ZERO))
}

impl Step {
    pub(crate) fn new(plan: StepPlan, settings: &CoiloverSettings, quiet: bool, tick: u32) -> Self {
        Self {
            plan,
            schedule: plan.schedule(plan.substeps),
            accuracy: settings.accuracy(),
            most_substeps: settings.max_substeps.max(1),
            alike: None,
            quiet,
            tick,
            delivered: AtomicBool::new(false),
        }
    }

    /// A body as it may be moved; one that may not be any more makes the scene stale.
    #[inline(always)]
    pub(crate) fn movable(
        &self,
        sight: &impl Sight,
        body: BodyId,
        stale: &mut bool,
    ) -> Option<Seen> {
        let seen = sight.see(body).filter(|seen| seen.is_movable);
        *stale |= seen.is_none();
        seen
    }

    /// Where a point is that elements cannot move, and where it will be after the step.
    pub(crate) fn path(&self, held: &Held, sight: &impl Sight) -> [DVec3; 2] {
        match *held {
            Held::Path { from, to } => [from, to],
            Held::Body { body, local, .. } => {
                sight.way(body, local, self.plan.time).unwrap_or([local; 2])
            }
        }
    }

    /// Whether an end moves or turns, or is not where or as it was after the last step.
    pub(crate) fn has_moved(&self, row: &ElementRow, sight: &impl Sight) -> bool {
        if !row.is_any_watched() && row.moves() == 2 {
            // Held by what elements move, and where it says.
            return false;
        }
        (0..2).any(|end| {
            let now = match row.rare.held[end] {
                Held::Body { local, .. } if row.movable(end).is_some() => local,
                ref held => {
                    let [from, to] = self.path(held, sight);
                    if from != to || self.has_turned(row, end, sight) {
                        return true;
                    }
                    to
                }
            };
            row.rare.places[end].is_some_and(|last| last != now)
        })
    }

    /// Whether an end that goes along a path from here begins elsewhere than the last step's path ended.
    pub(crate) fn has_leapt(row: &ElementRow, end: usize, from: DVec3) -> bool {
        row.rare.places[end].is_some_and(|last| {
            let size = last.abs().max(from.abs()).max_element().max(1.0);
            from.distance(last) > LEAP * size
        })
    }

    /// Whether an end that elements cannot turn turns, or is not turned as after the last step, where its element has an
    /// axis of its own.
    fn has_turned(&self, row: &ElementRow, end: usize, sight: &impl Sight) -> bool {
        if row.rare.guide == Guide::Centres || row.rare.places[end].is_none() {
            return false;
        }
        let (rotation, turning) = facing(&row.rare.held[end], self.plan.time, sight);
        turning != DVec3::ZERO || rotation != row.rare.facings[end]
    }

    /// The engine's equal substeps of a body that asks for so many more than others.
    fn substeps(&self, more: usize) -> Schedule {
        match self.alike.unwrap_or(more) {
            0 => self.schedule,
            more => self.plan.schedule(self.plan.substeps + more),
        }
    }

    /// How far the engine turns a body in this step, rad.
    pub(crate) fn farthest_turn(&self, seen: &Seen) -> f64 {
        if seen.turns_fast {
            f64::INFINITY
        } else {
            self.substeps(seen.more_substeps)
                .farthest_turn(self.plan.farthest_turn)
        }
    }

    /// How the engine is to step a body that asks for so many substeps more than others.
    #[inline(always)]
    pub(crate) fn terms(&self, more: usize) -> Terms {
        // One substep has room for a force or an impulse, not for both.
        let second_substep =
            self.plan.substeps * self.plan.calls as usize == 1 && more == 0 && self.alike.is_none();
        Terms {
            schedule: if second_substep {
                self.plan.schedule(self.plan.substeps + 1)
            } else {
                self.substeps(more)
            },
            second_substep,
        }
    }
}
