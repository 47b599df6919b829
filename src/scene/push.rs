//! What a body has to be given to end the step where the integrator did.

use super::rows::{BodyRow, Share};
use super::step::Step;
use crate::backend::{Engine, Push, Seen, Wrench};
use crate::dynamics::body::{Body, Spin};
use crate::dynamics::delivery::{Delivery, Schedule, force_for, torque_for};
use crate::dynamics::points::{Flight, FreePoint};
use crate::dynamics::single;
use bevy::math::{DVec3, Vec3};
use std::sync::atomic::Ordering;

/// How the engine will step one body.
#[derive(Clone, Copy)]
pub(crate) struct Terms {
    pub schedule: Schedule,
    /// It is given a second substep for that.
    pub second_substep: bool,
}

/// In single precision, and finite whatever it was.
fn finite(v: DVec3) -> Vec3 {
    Vec3::from(v.to_array().map(single))
}

impl Step {
    /// The velocity that a body is given for the start of the step, and the acceleration that it must have over
    /// it, to move so far and reach such a velocity.
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
        // The engine's velocity is rounded; the force makes up for it.
        let rounding = velocity + planned.jump - given.as_dvec3();
        let rate = planned.rate + rounding * schedule.per_time;
        (given, rate)
    }

    /// What takes a body on that is moved and not turned.
    #[inline(always)]
    pub(crate) fn push_point(&self, seen: &Seen, point: &FreePoint, flight: &Flight) -> Push {
        let terms = self.terms(seen);
        let (velocity, rate) = self.straight(
            point.velocity,
            flight.moved,
            flight.velocity,
            &terms.schedule,
        );
        Push {
            velocity: Some(velocity),
            spin: None,
            share: Wrench {
                force: ((rate - point.acceleration) / point.inverse_mass).as_vec3(),
                torque: Vec3::ZERO,
            },
            second_substep: terms.second_substep,
        }
    }

    /// What takes a body from its start to its end.
    pub(crate) fn push(&self, seen: &Seen, start: &Body, end: &Body) -> Push {
        let terms = self.terms(seen);
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
            let Delivery { jump, rate } = terms.schedule.angular(start, seen.is_gyroscopic, end);
            spin = Some((before + jump).as_vec3());
            torque = torque_for(rate, inverse_inertia) - start.torque;
            for axis in 0..3 {
                if start.rotation_locked[axis] {
                    torque[axis] = 0.0;
                }
            }
        }
        Push {
            velocity: Some(velocity),
            spin,
            share: Wrench {
                force: finite(force),
                torque: finite(torque),
            },
            second_substep: terms.second_substep,
        }
    }
}

impl Step {
    /// Gives a body what takes it on. `restless`: it has to be kept awake.
    #[inline(always)]
    pub(crate) fn deliver(
        &self,
        row: &mut BodyRow,
        push: &Push,
        restless: bool,
        engine: &mut impl Engine,
    ) {
        if restless {
            engine.keep_awake(row.id);
        }
        self.delivered.store(true, Ordering::Relaxed);
        row.give(push, engine);
    }
}

impl BodyRow {
    /// The centre of mass of a body that nothing locks, before a step.
    #[inline(always)]
    pub(crate) fn point(&self, seen: &Seen) -> FreePoint {
        let inverse_mass = f64::from(seen.inverse_mass);
        FreePoint {
            position: seen.center(),
            velocity: seen.velocity.as_dvec3(),
            acceleration: seen.gravity + inverse_mass * self.user.force.as_dvec3(),
            inverse_mass,
        }
    }

    /// Gives the body what elements push it with over the coming step, if their force and torque are numbers.
    #[inline(always)]
    pub(crate) fn give(&mut self, push: &Push, engine: &mut impl Engine) {
        self.is_fresh = true;
        self.carries_share = true;
        let Wrench { force, torque } = push.share;
        let finite = force.is_finite() && torque.is_finite();
        let share = if finite {
            push.share
        } else {
            Wrench::default()
        };
        engine.give(self.id, &Push { share, ..*push }, &self.user);
        let turns = share.torque != Vec3::ZERO;
        if turns {
            self.torque = share.torque;
        }
        self.share = Some(Share {
            force: share.force,
            turns,
            second_substep: push.second_substep,
        });
    }

    /// Takes out what it was given.
    pub(crate) fn take_share(&mut self) -> Option<(Wrench, bool)> {
        let share = self.share.take()?;
        let torque = if share.turns { self.torque } else { Vec3::ZERO };
        let elements = Wrench {
            force: share.force,
            torque,
        };
        Some((elements, share.second_substep))
    }
}
