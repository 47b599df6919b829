//! Computes what a body must be given so that the engine's step ends where the integrator's step ended.

use super::rows::{BodyFlags, BodyRow};
use super::step::Step;
use crate::backend::{Engine, Push, Seen, Wrench};
use crate::dynamics::body::{Body, Spin};
use crate::dynamics::delivery::{Delivery, Schedule, force_for, torque_for};
use crate::dynamics::points::{FreePoint, PointStep};
use crate::dynamics::single;
use bevy::math::{DVec3, Vec3};

/// How the engine will step one body.
#[derive(Clone, Copy)]
pub(crate) struct Terms {
    pub schedule: Schedule,
    /// Whether the body must be given a second substep for this schedule.
    pub second_substep: bool,
}

/// How the engine steps a body before its step, as far as the push depends on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Manner {
    /// Number of extra substeps for which the body asks.
    more: u32,
    /// Whether the engine applies gyroscopic forces to it.
    is_gyroscopic: bool,
    pub is_asleep: bool,
}

impl Manner {
    pub(crate) fn of(body: &Seen) -> Self {
        Self {
            more: body.more_substeps as u32,
            is_gyroscopic: body.is_gyroscopic,
            is_asleep: body.is_asleep,
        }
    }
}

/// What is given to a body that is moved but not turned.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Given {
    /// Velocity at the start of the step, m/s.
    pub velocity: Vec3,
    /// Force over the step, N.
    pub force: Vec3,
}

impl Given {
    /// Returns the push for the engine. `restless` says whether the body must be kept awake.
    #[inline(always)]
    pub(crate) fn push(&self, restless: bool, second_substep: bool) -> Push {
        Push {
            velocity: Some(self.velocity),
            spin: None,
            share: Wrench {
                force: self.force,
                torque: Vec3::ZERO,
            },
            second_substep,
            keep_awake: restless,
        }
    }
}

impl From<Push> for Given {
    #[inline(always)]
    fn from(push: Push) -> Self {
        Self {
            velocity: push.velocity.unwrap_or_default(),
            force: push.share.force,
        }
    }
}

/// Rounds to single precision. Numbers that are too large become the largest finite number.
fn finite(v: DVec3) -> Vec3 {
    Vec3::from(v.to_array().map(single))
}

impl Step {
    /// Returns the velocity at the start of the step and the constant acceleration over the step with which a body moves by
    /// `displacement` and ends with the velocity `reached`.
    #[inline(always)]
    fn straight(
        &self,
        velocity: DVec3,
        displacement: DVec3,
        reached: DVec3,
        schedule: &Schedule,
    ) -> (Vec3, DVec3) {
        let time = schedule.time;
        let wanted = schedule.reach(displacement - time * velocity, reached - velocity);
        let planned = schedule.capped(wanted, velocity, self.plan.fastest);
        let given = (velocity + planned.jump).as_vec3();
        // The engine stores velocities in single precision. The force corrects the rounding error.
        let rounding = velocity + planned.jump - given.as_dvec3();
        let rate = planned.rate + rounding * schedule.per_time;
        (given, rate)
    }

    /// The push of a body that is moved but not turned. `more` is the number of extra substeps for which the body asks.
    #[inline(always)]
    pub(crate) fn push_point(&self, more: usize, point: &FreePoint, moved: &PointStep) -> Push {
        let terms = self.terms(more);
        let (velocity, rate) =
            self.straight(point.velocity, moved.by, moved.velocity, &terms.schedule);
        Push {
            velocity: Some(velocity),
            spin: None,
            share: Wrench {
                force: (point.inverse_mass.recip() * (rate - point.acceleration)).as_vec3(),
                torque: Vec3::ZERO,
            },
            second_substep: terms.second_substep,
            keep_awake: false,
        }
    }

    /// The push that takes a body from `start` to `end` over the step.
    pub(crate) fn push(&self, manner: &Manner, start: &Body, end: &Body) -> Push {
        let terms = self.terms(manner.more as usize);
        let (velocity, linear) = self.straight(
            start.velocity,
            end.position - start.position,
            end.velocity,
            &terms.schedule,
        );
        let force = force_for(linear - start.acceleration, start.inverse_mass);
        let (mut spin, mut torque) = (None, DVec3::ZERO);
        if start.spin != Spin::Ignored {
            let inverse_inertia = start.inverse_inertia();
            let before = start.angular_velocity();
            let Delivery { mut jump, rate } = {
                let rule = self.plan.turn;
                terms
                    .schedule
                    .angular(start, manner.is_gyroscopic, end, rule)
            };
            torque = torque_for(rate, inverse_inertia) - start.torque;
            for axis in 0..3 {
                if start.rotation_locked[axis] {
                    (jump[axis], torque[axis]) = (0.0, 0.0);
                }
            }
            spin = Some((before + jump).as_vec3());
        }
        Push {
            velocity: Some(velocity),
            spin,
            share: Wrench {
                force: finite(force),
                torque: finite(torque),
            },
            second_substep: terms.second_substep,
            keep_awake: false,
        }
    }
}

impl BodyRow {
    /// The centre of mass of a body without locked axes, before a step.
    #[inline(always)]
    pub(crate) fn point(&self, seen: &Seen) -> FreePoint {
        let inverse_mass = f64::from(seen.inverse_mass);
        FreePoint {
            position: seen.center(),
            velocity: seen.velocity.as_dvec3(),
            acceleration: seen.gravity + inverse_mass * self.user_force.as_dvec3(),
            inverse_mass,
        }
    }

    /// Gives the body the push of its elements for the coming step. If force or torque is not finite, both are replaced by zero.
    #[inline(always)]
    pub(crate) fn give(&mut self, push: &Push, tick: u32, engine: &mut impl Engine) {
        let Wrench { force, torque } = push.share;
        let finite = force.is_finite() && torque.is_finite();
        let share = if finite {
            push.share
        } else {
            Wrench::default()
        };
        engine.give(self.id, &Push { share, ..*push }, &self.user());
        let turns = share.torque != Vec3::ZERO;
        if turns {
            self.rare.share_torque = share.torque;
        }
        self.share_force = share.force;
        self.given = tick;
        let flags = &mut self.flags;
        flags.insert(BodyFlags::FRESH | BodyFlags::CARRIES_SHARE);
        flags.set(BodyFlags::SHARES_TORQUE, turns);
        flags.set(BodyFlags::SECOND_SUBSTEP, push.second_substep);
    }
}
