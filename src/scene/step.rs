//! Data that all components of a context share in a step, and questions about ends and bodies that depend on it.

use super::push::Terms;
use super::rows::{ElementFlags, ElementRow, Held};
use crate::backend::{BodyId, Seen, Sight, StepPlan};
use crate::dynamics::delivery::Schedule;
use crate::dynamics::guide::Guide;
use crate::dynamics::tolerance::Accuracy;
use crate::settings::CoiloverSettings;
use bevy::math::{DQuat, DVec3};
use std::sync::atomic::AtomicBool;

/// Distance between the end of the last path and the start of the next one up to which the path counts as continuous, as a share
/// of its largest coordinate, but of at least 1 m. Rounding to f32 in the engine causes such distances. Pinned by `carried`.
const LEAP: f64 = 1e-6;

/// A context before its step.
pub(crate) struct Step {
    pub plan: StepPlan,
    /// Substeps of a body that asks for no extra substeps.
    pub schedule: Schedule,
    pub accuracy: Accuracy,
    /// Greatest number of substeps in a step for components that the engine solves.
    pub most_substeps: u32,
    /// If the engine steps all bodies as finely as the one that asks for most: the number of extra substeps that all bodies get.
    pub alike: Option<usize>,
    /// Whether nothing has changed since the last step apart from bodies and moved ends, so that nothing else
    /// can have woken a sleeping component.
    pub quiet: bool,
    /// Number of the tick.
    pub tick: u32,
    /// Whether some body was given a push.
    pub delivered: AtomicBool,
}

/// Rotation now, and angular velocity over the step (rad/s), of the body at an end that elements cannot turn.
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

    /// State of a body that can be moved. If the body can no longer be moved, sets `stale`, so that the rows are made anew.
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

    /// Positions, now and after the step, of an end that elements cannot move.
    pub(crate) fn path(&self, held: &Held, sight: &impl Sight) -> [DVec3; 2] {
        match *held {
            Held::Path { from, to } => [from, to],
            Held::Body { body, local, .. } => {
                sight.way(body, local, self.plan.time).unwrap_or([local; 2])
            }
        }
    }

    /// Whether an end moves or turns in this step, or was moved or turned since the last step, or the element has other anchors or
    /// another axis. Motion of bodies that elements move does not count.
    pub(crate) fn has_moved(&self, row: &ElementRow, sight: &impl Sight) -> bool {
        if row.has(ElementFlags::REFITTED) && row.rare.leapt {
            return true;
        }
        if !row.is_any_watched() && row.moves() == 2 {
            // Elements move both ends, and its anchors are fixed points of the bodies.
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

    /// Whether the path of an end, which begins at `from`, begins elsewhere than the last step's path ended.
    pub(crate) fn has_leapt(row: &ElementRow, end: usize, from: DVec3) -> bool {
        row.rare.places[end].is_some_and(|last| {
            let size = last.abs().max(from.abs()).max_element().max(1.0);
            from.distance(last) > LEAP * size
        })
    }

    /// Whether an end that elements cannot turn turns in this step, or was turned since the last step.
    /// Counts only for an element with an axis.
    fn has_turned(&self, row: &ElementRow, end: usize, sight: &impl Sight) -> bool {
        if row.rare.guide == Guide::Centres || row.rare.places[end].is_none() {
            return false;
        }
        let (rotation, turning) = facing(&row.rare.held[end], self.plan.time, sight);
        turning != DVec3::ZERO || rotation != row.rare.facings()[end]
    }

    /// Substeps of a body that asks for `more` extra substeps.
    fn substeps(&self, more: usize) -> Schedule {
        match self.alike.unwrap_or(more) {
            0 => self.schedule,
            more => self.plan.schedule(self.plan.substeps + more),
        }
    }

    /// Greatest rotation of a body by the engine in this step, rad.
    pub(crate) fn farthest_turn(&self, seen: &Seen) -> f64 {
        if seen.turns_fast {
            f64::INFINITY
        } else {
            self.substeps(seen.more_substeps)
                .farthest_turn(self.plan.farthest_turn)
        }
    }

    /// How the engine must step a body that asks for `more` extra substeps.
    #[inline(always)]
    pub(crate) fn terms(&self, more: usize) -> Terms {
        // In a single substep, force and impulse have the same effect, so position and velocity cannot both be reached.
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
