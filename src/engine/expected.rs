//! What a step was to do to a body, to be held against what it did.

use super::held::Support;
use super::step::Terms;
use crate::dynamics::body::Body;
use bevy::math::{DVec3, Vec3};
use bevy_rapier3d::rapier::dynamics::RigidBody as RapierBody;

/// Share of the elements' load that must be left after outside forces for mobility to be measured.
const BALANCE: f64 = 0.02;

/// Linear and angular velocity, or change of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Twist {
    pub linear: Vec3,
    pub angular: Vec3,
}

/// Of a linear or an angular velocity.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    start: Vec3,
    /// What the load does to a free body.
    free_change: Vec3,
    /// The elements' impulse.
    given: Vec3,
}

/// What a step was to do to a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expected {
    linear: Part,
    time: f32,
    /// More of it stands elsewhere.
    pub is_whole: bool,
    /// It asks for the work that elements do on it.
    pub accounts: bool,
}

/// What else is expected of a body that turns, or that something holds; apart, since most need none.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Whole {
    angular: Part,
    /// The change of velocities that was ordered of a body taken for free.
    ordered: Option<Twist>,
    /// What the elements' impulse does alone to a free body.
    own_change: Twist,
    /// Substeps of a link of a multibody, whose velocity the engine shows one substep late.
    link: Option<u32>,
}

/// What is expected of a body, linear and angular.
pub(super) struct Orders {
    linear: Part,
    whole: Whole,
    pub time: f32,
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a.as_dvec3().dot(b.as_dvec3())
}

/// In terms of a free body's velocities before the engine's own damping.
fn undamped(velocity: Vec3, damping: f32, time: f32) -> Vec3 {
    velocity * (1.0 + time * damping)
}

impl Part {
    /// Whether it changed as was ordered: then nothing held it.
    fn was_met(&self, change: Vec3, ordered: Vec3) -> bool {
        let size = |v: Vec3| v.abs().max_element();
        let rounding = 1e-5 * (size(self.start) + size(self.start + ordered)) + 1e-6;
        size(change - ordered) <= 1e-3 * size(self.free_change) + rounding
    }
}

impl Expected {
    /// A free body that does not turn, given an impulse that changes its velocity by its `own`, while outside
    /// forces change it by `pulled`.
    pub(super) fn straight(
        start: DVec3,
        own: DVec3,
        pulled: DVec3,
        given: DVec3,
        accounts: bool,
        time: f64,
    ) -> Self {
        Self {
            linear: Part {
                start: start.as_vec3(),
                free_change: (own + pulled).as_vec3(),
                given: given.as_vec3(),
            },
            time: time as f32,
            is_whole: false,
            accounts,
        }
    }

    /// `free` is the body at the start of the step with its full mass, `end` after it.
    pub(super) fn new(free: &Body, end: &Body, terms: &Terms) -> (Self, Whole) {
        let time = terms.schedule.time;
        let inverse_inertia = free.inverse_inertia();
        let own = (
            free.inverse_mass * end.given.0,
            inverse_inertia * end.given.1,
        );
        let part = |start: DVec3, own: DVec3, pulled: DVec3, given: DVec3| Part {
            start: start.as_vec3(),
            free_change: (own + time * pulled).as_vec3(),
            given: given.as_vec3(),
        };
        let spin = free.angular_velocity();
        let pulled = inverse_inertia * free.torque;
        let ordered = Twist {
            linear: (end.velocity - free.velocity).as_vec3(),
            angular: (end.angular_velocity() - spin).as_vec3(),
        };
        let whole = Whole {
            angular: part(spin, own.1, pulled, end.given.1),
            ordered: (end.mobility == 1.0).then_some(ordered),
            own_change: Twist {
                linear: own.0.as_vec3(),
                angular: own.1.as_vec3(),
            },
            link: Some(terms.schedule.substeps).filter(|n| !terms.takes_impulses && *n > 1),
        };
        let expected = Self {
            linear: part(free.velocity, own.0, free.acceleration, end.given.0),
            time: time as f32,
            is_whole: true,
            accounts: true,
        };
        (expected, whole)
    }

    /// Whether a free body that does not turn went where it was to go.
    pub(super) fn was_met(&self, body: &RapierBody) -> bool {
        let Part {
            start, free_change, ..
        } = self.linear;
        let now = undamped(body.linvel(), body.linear_damping(), self.time);
        self.linear.was_met(now - start, free_change)
    }

    /// With what else is expected of the body, which has such an inverse mass.
    pub(super) fn orders(&self, whole: &Whole, inverse_mass: f32) -> Orders {
        let whole = if self.is_whole {
            *whole
        } else {
            let straight = |linear: Vec3| Twist {
                linear,
                angular: Vec3::ZERO,
            };
            Whole {
                ordered: Some(straight(self.linear.free_change)),
                own_change: straight(inverse_mass * self.linear.given),
                ..Whole::default()
            }
        };
        Orders {
            linear: self.linear,
            whole,
            time: self.time,
        }
    }
}

impl Orders {
    /// Linear velocity at the start of the step.
    pub(super) fn start(&self) -> Vec3 {
        self.linear.start
    }

    /// What the load does to a free body.
    pub(super) fn free_change(&self) -> Vec3 {
        self.linear.free_change
    }

    /// Velocities that a link really has, told from those that the engine shows: what it had at the
    /// start, and all of the change of which one substep is not shown yet.
    pub(super) fn of_late(&self, shown: Twist) -> Option<Twist> {
        let n = self.whole.link? as f32;
        let whole = |from: Vec3, to: Vec3| from + (to - from) * (n / (n - 1.0));
        Some(Twist {
            linear: whole(self.linear.start, shown.linear),
            angular: whole(self.whole.angular.start, shown.angular),
        })
    }

    /// What the load did, in terms of a free body's velocities before the engine's own damping.
    pub(super) fn change(&self, now: &Twist, body: &RapierBody) -> Twist {
        let linear = undamped(now.linear, body.linear_damping(), self.time);
        let angular = undamped(now.angular, body.angular_damping(), self.time);
        Twist {
            linear: linear - self.linear.start,
            angular: angular - self.whole.angular.start,
        }
    }

    /// Mean velocities over the step.
    pub(super) fn mean(&self, now: Twist) -> Twist {
        Twist {
            linear: 0.5 * (self.linear.start + now.linear),
            angular: 0.5 * (self.whole.angular.start + now.angular),
        }
    }

    /// Work of the elements' impulses at mean velocities, J.
    pub(super) fn work(&self, mean: &Twist) -> f64 {
        dot(mean.linear, self.linear.given) + dot(mean.angular, self.whole.angular.given)
    }

    /// Whether the body went where it was to go: then nothing held it.
    pub(super) fn was_met(&self, change: &Twist) -> bool {
        let angular = &self.whole.angular;
        self.whole.ordered.is_some_and(|ordered| {
            self.linear.was_met(change.linear, ordered.linear)
                && (angular.given == Vec3::ZERO || angular.was_met(change.angular, ordered.angular))
        })
    }

    /// The direction in which a contact answered the load, and the share of the free motion that it left
    /// there; none if the load was too small to tell.
    pub(super) fn missing(&self, change: &Twist) -> Option<(DVec3, f64)> {
        let free = self.linear.free_change.as_dvec3();
        let missing = free - change.linear.as_dvec3();
        let direction = missing.try_normalize()?;
        let along = free.dot(direction);
        let tells = along > 0.05 * free.length() && along > 0.0;
        tells.then(|| (direction, (1.0 - missing.length() / along).clamp(0.0, 1.0)))
    }

    /// Share of the free motion along the elements' load that was left; none if the load was too small
    /// to tell.
    pub(super) fn share(&self, change: &Twist, support: Support) -> Option<f64> {
        let (linear, angular) = (&self.linear, &self.whole.angular);
        let own = &self.whole.own_change;
        let length = |v: Vec3| v.as_dvec3().length();
        let along = |v: Vec3, w: Vec3| dot(v, linear.given) + dot(w, angular.given);
        let free = along(linear.free_change, angular.free_change);
        let scale = length(linear.given) * length(linear.free_change)
            + length(angular.given) * length(angular.free_change);
        // Where elements and weight balance, what is left is the noise of the engine's joints.
        let noise = match support {
            Support::Joint => BALANCE * along(own.linear, own.angular),
            _ => 0.0,
        };
        let tells = free.abs() > (0.05 * scale).max(noise);
        (tells && scale > 0.0)
            .then(|| (along(change.linear, change.angular) / free).clamp(0.0, 1.0))
    }
}
