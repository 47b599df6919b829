//! The impulse and force that make the engine arrive where the integrator did.
//!
//! With n substeps the engine does `v += (dt/n)·a; x += (dt/n)·v` n times, so under an impulse at the
//! start and a constant acceleration a over the step
//!
//! ```text
//! v' = v + J/m + dt·a        x' = x + dt·(v + J/m) + β dt²·a        β = (n + 1)/(2n)
//! ```
//!
//! Two unknowns meet two conditions wherever n > 1. Rotation is the same with the engine's own
//! quaternion update and gyroscopic term in between, so there the linear answer is refined by running
//! the engine's rotation, which its backend tells ([`TurnRule`]), and correcting what is missed.

use super::body::{Body, shortest, unwound};
use crate::functions::atan;
use bevy::math::{DMat3, DQuat, DVec3};

/// How the engine will step: all substeps of one call together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Schedule {
    /// Seconds in all.
    pub time: f64,
    /// Equal substeps, each one velocity and one position update.
    pub substeps: u32,
    /// Seconds of each of them.
    pub substep: f64,
    /// Inverse of all seconds, 1/s.
    pub per_time: f64,
    /// β dt, s.
    reach: f64,
    /// 1/((1 − β) dt), 1/s.
    per_rest: f64,
}

/// A jump at the start and a constant rate of change over the step, of a linear or angular velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Delivery {
    pub jump: DVec3,
    pub rate: DVec3,
}

/// A body about to be turned over a step.
pub(crate) struct Spinning<'a> {
    pub schedule: &'a Schedule,
    pub body: &'a Body,
    /// The engine counts in that it spins about another axis than that of its momentum.
    pub gyroscopic: bool,
}

/// What an engine makes of a body that spins so, with such a delivery: rotation and angular velocity after the step, to the
/// engine's own rounding.
pub(crate) type TurnRule = fn(&Spinning, DVec3, &Delivery) -> (DQuat, DVec3);

impl Schedule {
    pub(crate) fn new(time: f64, substeps: u32) -> Self {
        let n = f64::from(substeps);
        let beta = (n + 1.0) / (2.0 * n);
        let per_time = time.recip();
        Self {
            time,
            substeps,
            substep: time / n,
            per_time,
            reach: beta * time,
            per_rest: per_time / (1.0 - beta),
        }
    }

    /// β dt (s) and 1/((1 − β) dt) (1/s), of more than one substep.
    #[inline]
    pub(crate) fn spread(&self) -> (f64, f64) {
        (self.reach, self.per_rest)
    }

    /// Jump and rate for a wanted displacement beyond `time·velocity` and a wanted change of velocity.
    pub(crate) fn reach(&self, displacement: DVec3, change: DVec3) -> Delivery {
        if self.substeps < 2 {
            // One substep has one degree of freedom; the velocity is the one that lasts.
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

    /// The engine caps speeds. Where a delivery would exceed that at either end of the step, it moves more
    /// steadily, by as much as it takes: the displacement stays right, the velocity comes as near as it can.
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
        // Both of |mean ± share · sway| reach the cap at most.
        let (square, along) = (sway.length_squared(), mean.dot(sway).abs());
        let room = (cap * cap - mean.length_squared()).max(0.0);
        let share = room / (along + (along * along + square * room).sqrt()).max(f64::MIN_POSITIVE);
        let rate = share.min(1.0) * delivery.rate;
        let jump = mean - velocity - 0.5 * (self.substep + self.time) * rate;
        Delivery { jump, rate }
    }

    /// Angular part: from the start's rotation and angular velocity to where `end` now is, in an engine that turns bodies by
    /// `rule`.
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
        // With the weight that a velocity has which is missed.
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
        let eased = self.capped(direct, spin, CAUTION * cap);
        if eased == direct {
            let delivery = refined(direct, 1.0, &|angle, change| self.reach(angle, change));
            if self.capped(delivery, spin, cap) == delivery {
                return delivery;
            }
        }
        // Where it arrives counts; the velocity is what it then is.
        refined(eased, 0.0, &|angle, _| Delivery {
            jump: angle * self.per_time,
            rate: DVec3::ZERO,
        })
    }

    /// How far a body is turned, and by how much its angular velocity changes, by what an engine that counts in the gyroscopic
    /// term adds of itself: that goes evenly from what it is in the first substep to what it is in the last.
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

    /// What the substeps' turns must sum up to for them to come to this rotation: turns do not commute (W. Magnus, 1954, to
    /// second order), and each goes along the tangent.
    fn summed(&self, turned: DVec3, spin: DVec3, delivery: &Delivery) -> DVec3 {
        let square = f64::from(self.substeps).powi(-2);
        let tangent = turned.length_squared() * square / 12.0;
        let order = self.time.powi(3) * (1.0 - square) / 12.0;
        let order = order * delivery.rate.cross(spin + delivery.jump);
        turned * (1.0 + tangent) - order
    }

    /// How far the engine turns a body that its cap lets turn so far: it goes along tangents.
    pub(crate) fn farthest_turn(&self, cap: f64) -> f64 {
        let halves = 2.0 * f64::from(self.substeps);
        halves * atan(cap / halves)
    }
}

/// How often the first guess is made better by what an engine's rule comes to in closed form, which costs far less than to run it.
const FORESEEN: usize = 2;

/// Most rounds of correction, each of which leaves a thirtieth of what was missed.
const ROUNDS: usize = 6;

/// Share of the cap on turning that is planned with: where it is put right, it may come to a little more.
const CAUTION: f64 = 0.995;

/// What may be missed before the last correction, rad.
const MISSED: f64 = 3e-7;

/// The rotation vector of a small rotation; of larger ones too little, by θ⁵/213.
fn small_angle(rotation: DQuat) -> DVec3 {
    let half = shortest(rotation).xyz();
    2.0 * half * (1.0 + half.length_squared() / 6.0)
}

/// The force or torque with which an inverse mass or inertia gives an acceleration; nothing along
/// locked axes.
pub(crate) fn force_for(acceleration: DVec3, inverse_mass: DVec3) -> DVec3 {
    DVec3::select(
        inverse_mass.cmpgt(DVec3::ZERO),
        acceleration / inverse_mass,
        DVec3::ZERO,
    )
}

/// See [`force_for`]: a locked axis has an empty row and column.
pub(crate) fn torque_for(acceleration: DVec3, mut inverse_inertia: DMat3) -> DVec3 {
    let mut free = DVec3::ONE;
    for axis in 0..3 {
        if inverse_inertia.col(axis)[axis] == 0.0 {
            inverse_inertia.col_mut(axis)[axis] = 1.0;
            free[axis] = 0.0;
        }
    }
    let torque = inverse_inertia.inverse() * (acceleration * free) * free;
    if torque.is_finite() {
        torque
    } else {
        DVec3::ZERO
    }
}
