//! Ends that contacts or joints hold: how much of a free body's motion is left to them.
//!
//! A step that believes an end free, when the ground holds it, makes a spring far too soft: it eases the
//! force for a motion that never comes. So after every step the velocity that the elements' load should
//! have given a free body is compared with what it got; the ratio along that load is the body's mobility,
//! by which its inverse mass is scaled in the next step. Bodies that touch nothing and have no joint are
//! free by definition, and are never measured.

use super::scene::BodyRow;
use super::step::Terms;
use super::touch::{created, support};
use crate::dynamics::body::{Body, Spin};
use crate::dynamics::delivery::force_for;
use bevy::math::{DVec3, Vec3};
use bevy_rapier3d::prelude::{ExternalForce, RapierContextJoints, RapierContextSimulation};
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodySet};
use bevy_rapier3d::rapier::geometry::ColliderSet;

/// Linear and angular velocity, or change of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Twist {
    pub linear: Vec3,
    pub angular: Vec3,
}

impl Twist {
    fn new(linear: DVec3, angular: DVec3) -> Self {
        Self {
            linear: linear.as_vec3(),
            angular: angular.as_vec3(),
        }
    }

    /// Of impulses, J.
    fn work(&self, given: &Self) -> f64 {
        let dot = |a: Vec3, b: Vec3| a.as_dvec3().dot(b.as_dvec3());
        dot(self.linear, given.linear) + dot(self.angular, given.angular)
    }
}

/// What a step was to do to a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expected {
    start: Twist,
    /// Where the delivery was to lead, if the body is free.
    ordered: Option<Twist>,
    /// What the same load does to a free body.
    free_change: Twist,
    /// The elements' impulse and angular impulse.
    given: Twist,
    /// What these do alone to a free body.
    own_change: Twist,
    time: f32,
    /// Substeps of a link of a multibody, whose velocity the engine shows one substep late.
    link: Option<u32>,
}

/// Share of the elements' load that must be left after outside forces for mobility to be measured.
const BALANCE: f64 = 0.02;

/// Least mobility along one direction: what is held more, is held as well by so little.
const STIFF: f64 = 1e-4;

/// Mobility above which a body counts as free.
const FREE: f64 = 0.999;

impl Expected {
    /// A free body that does not turn: from one velocity to another, given an impulse that changes it by
    /// its `own`, while outside forces change it by `pulled`.
    pub(super) fn straight(
        [from, to]: [DVec3; 2],
        own: DVec3,
        pulled: DVec3,
        given: DVec3,
        time: f64,
    ) -> Self {
        let straight = |v: DVec3| Twist::new(v, DVec3::ZERO);
        Self {
            start: straight(from),
            ordered: Some(straight(to)),
            free_change: straight(own + pulled),
            given: straight(given),
            own_change: straight(own),
            time: time as f32,
            link: None,
        }
    }

    /// `free` is the body at the start of the step with its full mass, `end` after it.
    pub(super) fn new(free: &Body, end: &Body, time: f64) -> Self {
        let inverse_inertia = free.inverse_inertia();
        let own = (
            free.inverse_mass * end.given.0,
            inverse_inertia * end.given.1,
        );
        Self {
            start: Twist::new(free.velocity, free.angular_velocity()),
            ordered: (end.mobility == 1.0)
                .then(|| Twist::new(end.velocity, end.angular_velocity())),
            free_change: Twist::new(
                own.0 + time * free.acceleration,
                own.1 + time * (inverse_inertia * free.torque),
            ),
            own_change: Twist::new(own.0, own.1),
            given: Twist::new(end.given.0, end.given.1),
            time: time as f32,
            link: None,
        }
    }

    /// The same of a link of a multibody.
    pub(super) fn of_link(mut self, terms: &Terms) -> Self {
        self.link = Some(terms.schedule.substeps).filter(|n| *n > 1);
        self
    }

    /// Velocities that a link really has, told from those that the engine shows: what it had at the
    /// start, and all of the change of which one substep is not shown yet.
    fn of_late(&self, shown: Twist) -> Option<Twist> {
        let n = self.link? as f32;
        let whole = |from: Vec3, to: Vec3| from + (to - from) * (n / (n - 1.0));
        Some(Twist {
            linear: whole(self.start.linear, shown.linear),
            angular: whole(self.start.angular, shown.angular),
        })
    }

    /// What the load did, in terms of a free body's velocities before the engine's own damping.
    fn change(&self, now: &Twist, body: &RapierBody) -> Twist {
        let undamped = |v: Vec3, damping: f32| v * (1.0 + self.time * damping);
        Twist {
            linear: undamped(now.linear, body.linear_damping()) - self.start.linear,
            angular: undamped(now.angular, body.angular_damping()) - self.start.angular,
        }
    }

    /// Mean velocities over the step.
    fn mean(&self, now: Twist) -> Twist {
        Twist {
            linear: 0.5 * (self.start.linear + now.linear),
            angular: 0.5 * (self.start.angular + now.angular),
        }
    }

    /// Whether the body went where it was to go: then nothing held it.
    fn was_met(&self, change: &Twist) -> bool {
        let Some(ordered) = self.ordered else {
            return false;
        };
        let size = |v: Vec3| v.abs().max_element();
        let close = |change: Vec3, start: Vec3, ordered: Vec3, free: Vec3| {
            let rounding = 1e-5 * (size(start) + size(ordered)) + 1e-6;
            size(change - (ordered - start)) <= 1e-3 * size(free) + rounding
        };
        close(
            change.linear,
            self.start.linear,
            ordered.linear,
            self.free_change.linear,
        ) && (self.given.angular == Vec3::ZERO
            || close(
                change.angular,
                self.start.angular,
                ordered.angular,
                self.free_change.angular,
            ))
    }

    /// The direction in which a contact answered the load, and the share of the free motion that it left
    /// there; none if the load was too small to tell.
    fn missing(&self, change: &Twist) -> Option<(DVec3, f64)> {
        let free = self.free_change.linear.as_dvec3();
        let missing = free - change.linear.as_dvec3();
        let direction = missing.try_normalize()?;
        let along = free.dot(direction);
        let tells = along > 0.05 * free.length() && along > 0.0;
        tells.then(|| (direction, (1.0 - missing.length() / along).clamp(0.0, 1.0)))
    }

    /// Share of the free motion along the elements' load that was left; none if the load was too small
    /// to tell.
    fn share(&self, change: &Twist, support: Support) -> Option<f64> {
        let dot = |a: Vec3, b: Vec3| a.as_dvec3().dot(b.as_dvec3());
        let length = |v: Vec3| v.as_dvec3().length();
        let given = &self.given;
        let along =
            |twist: &Twist| dot(twist.linear, given.linear) + dot(twist.angular, given.angular);
        let free = along(&self.free_change);
        let scale = length(given.linear) * length(self.free_change.linear)
            + length(given.angular) * length(self.free_change.angular);
        // Where elements and weight balance, what is left is the noise of the engine's joints.
        let noise = match support {
            Support::Joint => BALANCE * along(&self.own_change),
            _ => 0.0,
        };
        let tells = free.abs() > (0.05 * scale).max(noise);
        (tells && scale > 0.0).then(|| (along(change) / free).clamp(0.0, 1.0))
    }
}

/// What keeps a body from moving freely.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Support {
    /// Not known yet.
    #[default]
    Unknown,
    /// Nothing.
    None,
    /// A joint: it holds both ways.
    Joint,
    /// Joints to fixed ground before the first step, which leave this share of a free body's motion.
    Tied(f64),
    /// Contacts, which push this way and hold only against the opposite; all of them with fixed bodies or
    /// not.
    Contact { push: DVec3, on_fixed: bool },
}

impl Support {
    /// Contacts, some of them with a body that can move.
    pub(super) fn is_moving(&self) -> bool {
        matches!(
            self,
            Self::Contact {
                on_fixed: false,
                ..
            }
        )
    }
}

/// What is known of a Rapier context after its step.
pub(super) struct Context<'a> {
    pub simulation: &'a RapierContextSimulation,
    pub joints: &'a RapierContextJoints,
    pub colliders: &'a ColliderSet,
    pub bodies: &'a RigidBodySet,
}

/// Centre of mass.
pub(super) fn center_of(body: &RapierBody) -> DVec3 {
    let pose = body.position();
    let mut center = pose.translation.as_dvec3();
    let local = body.local_center_of_mass();
    if local != Vec3::ZERO {
        center += pose.rotation.as_dquat().normalize() * local.as_dvec3();
    }
    center
}

/// Takes in what the engine's step did to a body.
pub(super) fn observe(row: &mut BodyRow, body: &RapierBody, context: &Context) {
    let Some(expected) = row.expected.take() else {
        return;
    };
    let shown = Twist {
        linear: body.linvel(),
        angular: body.angvel(),
    };
    row.link = expected.of_late(shown);
    let change = expected.change(&row.link.unwrap_or(shown), body);
    let mean = expected.mean(shown);
    // The engine's substeps do not move it by its mean velocity. Seen behind, it has moved by so much less.
    let behind = row.lag as f32 * (shown.linear - expected.start.linear);
    let moved = ((center_of(body) - row.now.0).as_vec3() - behind) / expected.time;
    row.given_work = expected.given.work(&Twist {
        linear: moved,
        ..mean
    });
    row.contact_work = 0.0;
    let known = row.partner.take();
    if expected.was_met(&change) {
        row.support = Support::None;
        row.mobility = 1.0;
        return;
    }
    (row.support, row.partner) = support(row.handle, body, context);
    let by_contact = (change.linear - expected.free_change.linear).as_dvec3();
    let moved = [mean.linear.as_dvec3(), by_contact];
    row.contact_work = created(row, known, body, moved, context.bodies);
    if row.support == Support::None {
        row.mobility = 1.0;
    } else if let (Support::Contact { .. }, false) = (row.support, row.turns) {
        if let Some((direction, share)) = expected.missing(&change) {
            row.held = Some(direction);
            row.mobility = if share > FREE { 1.0 } else { share };
        }
    } else if let Some(share) = expected.share(&change, row.support) {
        row.held = None;
        row.mobility = if share > FREE { 1.0 } else { share };
    }
}

/// Mobility of a body in the coming step, given the force of its elements as it stands.
pub(super) fn mobility(row: &BodyRow, support: Support, free: &Body, force: DVec3) -> f64 {
    match support {
        Support::None | Support::Unknown => 1.0,
        Support::Joint => row.mobility,
        Support::Tied(share) => share,
        Support::Contact { push, .. } => {
            let weight = force_for(free.acceleration, free.inverse_mass);
            if (force + weight).dot(push) >= 0.0 {
                // It is being lifted off, and a contact does not pull.
                1.0
            } else if row.support == Support::Unknown {
                0.0
            } else {
                row.mobility
            }
        }
    }
}

/// The body as the integrator is to see it: with so much of its mobility left, along one direction if that
/// is all that contacts hold.
pub(super) fn held(free: &Body, mobility: f64, direction: Option<DVec3>) -> Body {
    let mut body = *free;
    let alike = free.moves_alike() && free.spin == Spin::Still;
    if let Some(direction) = direction.filter(|_| alike && mobility < 1.0) {
        body.mobility = mobility.max(STIFF);
        body.held = Some(direction);
        body.acceleration = body.left(free.acceleration);
    } else if mobility < 1.0 {
        if let Spin::Free { .. } = body.spin {
            body.spin = Spin::Locked {
                velocity: free.angular_velocity(),
            };
        }
        body.inverse_mass *= mobility;
        body.acceleration *= mobility;
        body.mobility = mobility;
        body.note_turn();
    }
    body
}

/// Delivery to a body whose motion is not ours to order: the elements' mean force. An impulse at the
/// start holds the first of n substeps still, whatever the constraints leave of mass and direction. Joints
/// answer weight and the user's force as well, so these are held still with it; a contact would be left.
pub(super) fn deliver(
    body: &mut RapierBody,
    free: &Body,
    given: (DVec3, DVec3),
    support: Support,
    terms: &Terms,
) -> ExternalForce {
    let time = terms.schedule.time;
    let n = f64::from(terms.schedule.substeps);
    let outside = match support {
        Support::Contact { .. } => (DVec3::ZERO, DVec3::ZERO),
        _ => (force_for(free.acceleration, free.inverse_mass), free.torque),
    };
    let mut force = (given.0 / time, given.1 / time);
    if support.is_moving() && terms.takes_impulses {
        // Against a partner that moves, the force has to act evenly: each jerk would reach it.
        body.set_linvel(free.velocity.as_vec3(), false);
        if free.spin != Spin::Still {
            body.set_angvel(free.angular_velocity().as_vec3(), false);
        }
    } else if terms.takes_impulses && terms.schedule.substeps > 1 {
        let back = 1.0 / (n - 1.0);
        let total = (force.0 + outside.0, force.1 + outside.1);
        let linvel = free.velocity - back * time * (free.inverse_mass * total.0);
        body.set_linvel(linvel.as_vec3(), false);
        if free.spin != Spin::Still {
            let angvel = free.angular_velocity() - back * time * (free.inverse_inertia() * total.1);
            body.set_angvel(angvel.as_vec3(), false);
        }
        force = (force.0 + back * total.0, force.1 + back * total.1);
    }
    ExternalForce {
        force: force.0.as_vec3(),
        torque: force.1.as_vec3(),
    }
}
