//! Computes the impulse and force with which the engine arrives at the integrator's state.
//!
//! With n substeps the engine does `v += (dt/n)·a; x += (dt/n)·v` n times. Under an impulse J at the start and a constant
//! acceleration a over the step this gives
//!
//! ```text
//! v' = v + J/m + dt·a        x' = x + dt·(v + J/m) + β dt²·a        β = (n + 1)/(2n)
//! ```
//!
//! If n > 1, these two conditions determine J and a. Rotation also depends on the engine's quaternion update and its
//! gyroscopic term. So its linear solution is refined: the backend's copy of the engine's rotation ([`TurnRule`]) is run,
//! and the remaining error is corrected.

use super::body::{Body, shortest, unwound};
use crate::functions::atan;
use bevy::math::{DMat3, DQuat, DVec3};

/// How the engine will step a body in a tick: the substeps of all its steps together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Schedule {
    /// Total time, s.
    pub time: f64,
    /// Number of equal substeps. Each is one velocity update and one position update.
    pub substeps: u32,
    /// Number of substeps in each of the engine's steps, at the start of which it computes the inertia in the world.
    pub substeps_each: u32,
    /// Duration of a substep, s.
    pub substep: f64,
    /// 1/`time`, 1/s.
    pub per_time: f64,
    /// β dt, s.
    reach: f64,
    /// 1/((1 − β) dt), 1/s.
    per_rest: f64,
}

/// A change of a linear or angular velocity: a jump at the start of the step, and a constant rate of change over the step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Delivery {
    pub jump: DVec3,
    pub rate: DVec3,
}

/// A body that the engine will rotate in a step.
pub(crate) struct Spinning<'a> {
    pub schedule: &'a Schedule,
    pub body: &'a Body,
    /// Whether the engine applies its gyroscopic term to the body.
    pub gyroscopic: bool,
}

/// Computes how an engine rotates a body, for its angular velocity at the start (rad/s) and a delivery. Returns rotation and
/// angular velocity after the step, including the engine's own rounding.
pub(crate) type TurnRule = fn(&Spinning, DVec3, &Delivery) -> (DQuat, DVec3);

impl Schedule {
    /// Schedule of `calls` steps of the engine with `substeps` substeps each, of `time` seconds in all.
    pub(crate) fn new(time: f64, substeps_each: u32, calls: u32) -> Self {
        let substeps = substeps_each.saturating_mul(calls);
        let n = f64::from(substeps);
        let beta = (n + 1.0) / (2.0 * n);
        let per_time = time.recip();
        Self {
            time,
            substeps,
            substeps_each,
            substep: time / n,
            per_time,
            reach: beta * time,
            per_rest: per_time / (1.0 - beta),
        }
    }

    /// Returns β dt (s) and 1/((1 − β) dt) (1/s), for more than one substep.
    #[inline]
    pub(crate) fn spread(&self) -> (f64, f64) {
        (self.reach, self.per_rest)
    }

    /// Returns jump and rate for a displacement beyond `time·velocity` and a change of velocity.
    pub(crate) fn reach(&self, displacement: DVec3, change: DVec3) -> Delivery {
        if self.substeps < 2 {
            // One substep has only one degree of freedom. It goes to the velocity, because a velocity error lasts.
            return Delivery {
                jump: DVec3::ZERO,
                rate: change * self.per_time,
            };
        }
        let jump = (displacement - self.reach * change) * self.per_rest;
        Delivery {
            jump,
            rate: (change - jump) * self.per_time,
        }
    }

    /// Adapts a delivery to the engine's cap on speeds. If the speed would exceed `cap` at either end of the step, its rate
    /// is reduced as far as needed. The displacement stays exact, and the velocity comes as near as possible.
    #[inline]
    pub(crate) fn capped(&self, delivery: Delivery, velocity: DVec3, cap: f64) -> Delivery {
        let first = velocity + delivery.jump + self.substep * delivery.rate;
        let last = velocity + delivery.jump + self.time * delivery.rate;
        if first.length_squared().max(last.length_squared()) <= cap * cap {
            return delivery;
        }
        self.eased(delivery, velocity, [first, last], cap)
    }

    #[cold]
    fn eased(
        &self,
        delivery: Delivery,
        velocity: DVec3,
        [first, last]: [DVec3; 2],
        cap: f64,
    ) -> Delivery {
        let mean = 0.5 * (first + last);
        let sway = last - mean;
        // With this share, both of |mean ± share · sway| are at most the cap.
        let (square, along) = (sway.length_squared(), mean.dot(sway).abs());
        let room = (cap * cap - mean.length_squared()).max(0.0);
        let share = room / (along + (along * along + square * room).sqrt()).max(f64::MIN_POSITIVE);
        let rate = share.min(1.0) * delivery.rate;
        let jump = mean - velocity - 0.5 * (self.substep + self.time) * rate;
        Delivery { jump, rate }
    }

    /// Returns the delivery that takes rotation and angular velocity from `start` to `end`, in an engine that rotates bodies
    /// by `rule`.
    pub(crate) fn angular(
        &self,
        start: &Body,
        gyroscopic: bool,
        end: &Body,
        rule: TurnRule,
    ) -> Delivery {
        let spin = start.angular_velocity();
        let wanted = end.angular_velocity();
        let spinning = Spinning {
            schedule: self,
            body: start,
            gyroscopic,
        };
        // `weight` is 1 if errors of the angular velocity are corrected too, and 0 if not.
        let refined =
            |mut delivery: Delivery, weight: f64, correct: &dyn Fn(DVec3, DVec3) -> Delivery| {
                for _ in 0..ROUNDS {
                    let (rotation, velocity) = rule(&spinning, spin, &delivery);
                    let angle = small_angle(end.rotation * rotation.inverse());
                    let change = weight * (wanted - velocity);
                    let correction = correct(angle, change);
                    delivery.jump += correction.jump;
                    delivery.rate += correction.rate;
                    if angle.length() + self.time * change.length() < MISSED {
                        break;
                    }
                }
                delivery
            };
        let cap = start.farthest_turn * self.per_time;
        let expected = 0.5 * self.time * (spin + wanted);
        let turned = unwound(end.rotation * start.rotation.inverse(), expected);
        let mut direct = self.reach(turned - self.time * spin, wanted - spin);
        for _ in 0..FORESEEN {
            let summed = self.summed(turned, spin, &direct);
            let own = if gyroscopic {
                self.gyroscopic([start, end], [spin, wanted], &direct)
            } else {
                [DVec3::ZERO; 2]
            };
            direct = self.reach(summed - self.time * spin - own[0], wanted - spin - own[1]);
        }
        let eased = self.capped(direct, spin, cap);
        if eased == direct {
            let delivery = refined(direct, 1.0, &|angle, change| self.reach(angle, change));
            if self.capped(delivery, spin, cap) == delivery {
                return delivery;
            }
        }
        // With the cap, only the rotation is corrected. The velocity is what results. The corrections may have added a little
        // speed.
        let corrected = refined(eased, 0.0, &|angle, _| Delivery {
            jump: angle * self.per_time,
            rate: DVec3::ZERO,
        });
        self.capped(corrected, spin, cap)
    }

    /// Returns the rotation (rad) and the change of angular velocity (rad/s) that the engine's gyroscopic term adds. The
    /// term is assumed to change linearly from the first substep to the last.
    fn gyroscopic(
        &self,
        [start, end]: [&Body; 2],
        [spin, wanted]: [DVec3; 2],
        delivery: &Delivery,
    ) -> [DVec3; 2] {
        let first = spin + delivery.jump + self.substep * delivery.rate;
        let (first, last) = (start.precession(first), end.precession(wanted));
        let share = (1.0 + f64::from(self.substeps).recip()) / 6.0;
        let way = self.reach * first + share * self.time * (last - first);
        [self.time * way, 0.5 * self.time * (first + last)]
    }

    /// Returns the sum that the rotation vectors of the substeps must have, so that together they give the rotation `turned`.
    /// Rotations do not commute (W. Magnus, 1954, to second order), and the engine rotates along tangents.
    fn summed(&self, turned: DVec3, spin: DVec3, delivery: &Delivery) -> DVec3 {
        let square = f64::from(self.substeps).powi(-2);
        let tangent = turned.length_squared() * square / 12.0;
        let order = self.time.powi(3) * (1.0 - square) / 12.0;
        let order = order * delivery.rate.cross(spin + delivery.jump);
        turned * (1.0 + tangent) - order
    }

    /// Greatest rotation by the engine in the step, if its cap on angular velocity allows `cap` (rad). It is less than
    /// `cap`, because the engine rotates along tangents.
    pub(crate) fn farthest_turn(&self, cap: f64) -> f64 {
        let halves = 2.0 * f64::from(self.substeps);
        halves * atan(cap / halves)
    }
}

/// Number of times that the first guess is improved by a closed-form approximation of the engine's rule. This costs far less
/// than to run the rule. Pinned by
/// `dynamics::tests::engine_substeps_reach_the_state_that_was_ordered`.
const FORESEEN: usize = 2;

/// Greatest number of corrections. Each leaves a thirtieth of the error. Pinned by
/// `dynamics::tests::engine_substeps_reach_the_state_that_was_ordered`.
const ROUNDS: usize = 6;

/// Error before a correction below which no further correction follows, rad. Pinned by
/// `dynamics::tests::engine_substeps_reach_the_state_that_was_ordered`.
const MISSED: f64 = 3e-7;

/// Rotation vector of a small rotation. For an angle θ it is too short by θ⁵/213.
fn small_angle(rotation: DQuat) -> DVec3 {
    let half = shortest(rotation).xyz();
    2.0 * half * (1.0 + half.length_squared() / 6.0)
}

/// Force or torque that gives an acceleration, for an inverse mass or inertia along each axis; zero along locked axes.
pub(crate) fn force_for(acceleration: DVec3, inverse_mass: DVec3) -> DVec3 {
    DVec3::select(
        inverse_mass.cmpgt(DVec3::ZERO),
        acceleration / inverse_mass,
        DVec3::ZERO,
    )
}

/// Inertia of a body with one on the diagonal of each locked axis, and a vector that is one along free axes and zero along locked
/// ones. A locked axis has an empty row and column in the inverse inertia.
pub(super) fn free_inertia(mut inverse_inertia: DMat3) -> (DMat3, DVec3) {
    let mut free = DVec3::ONE;
    for axis in 0..3 {
        if inverse_inertia.col(axis)[axis] == 0.0 {
            inverse_inertia.col_mut(axis)[axis] = 1.0;
            free[axis] = 0.0;
        }
    }
    (inverse_inertia.inverse(), free)
}

/// Torque that gives an angular acceleration; zero about locked axes.
pub(crate) fn torque_for(acceleration: DVec3, inverse_inertia: DMat3) -> DVec3 {
    let (inertia, free) = free_inertia(inverse_inertia);
    let torque = inertia * (acceleration * free) * free;
    if torque.is_finite() {
        torque
    } else {
        DVec3::ZERO
    }
}
