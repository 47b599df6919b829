//! Ends that contacts or joints hold: how much of a free body's motion is left to them.
//!
//! A step that believes an end free, when the ground holds it, makes a spring far too soft: it eases the
//! force for a motion that never comes. So after every step the velocity that the elements' load should
//! have given a free body is compared with what it got; the ratio along that load is the body's mobility,
//! by which its inverse mass is scaled in the next step. Bodies that touch nothing and have no joint are
//! free by definition, and are never measured.

use super::body::Push;
use super::expected::Twist;
use super::scene::BodyRow;
use super::step::Terms;
use super::touch::{created, is_touched, support};
use crate::dynamics::body::{Body, Spin};
use crate::dynamics::delivery::force_for;
use bevy::math::{DVec3, Vec3};
use bevy_rapier3d::prelude::{RapierContextJoints, RapierContextSimulation};
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodySet};
use bevy_rapier3d::rapier::geometry::ColliderSet;

/// Least mobility along one direction: what is held more, is held as well by so little.
const STIFF: f64 = 1e-4;

/// Mobility above which a body counts as free.
const FREE: f64 = 0.999;

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
    row.is_alone = !(expected.is_whole || expected.accounts) && expected.was_met(body);
    if row.is_alone {
        row.support = Support::None;
        if !row.untouched {
            row.let_go();
        }
        return;
    }
    row.untouched = false;
    if !expected.is_whole {
        row.lag = 0.0;
    }
    let inverse_mass = body.mass_properties().local_mprops.inv_mass;
    let orders = expected.orders(&row.whole, inverse_mass);
    let shown = Twist {
        linear: body.linvel(),
        angular: body.angvel(),
    };
    row.link = orders.of_late(shown);
    let change = orders.change(&row.link.unwrap_or(shown), body);
    let mean = orders.mean(shown);
    // The engine's substeps do not move it by its mean velocity. Seen behind, it has moved by so much less.
    let behind = row.lag as f32 * (shown.linear - orders.start());
    let moved = ((center_of(body) - row.now.0).as_vec3() - behind) / orders.time;
    row.given_work = orders.work(&Twist {
        linear: moved,
        ..mean
    });
    row.contact_work = 0.0;
    row.was_pushed = false;
    let known = row.partner.take();
    if orders.was_met(&change) {
        row.support = Support::None;
        row.mobility = 1.0;
        return;
    }
    (row.support, row.partner) = support(row.handle, body, context);
    let by_contact = (change.linear - orders.free_change()).as_dvec3();
    let moved = [mean.linear.as_dvec3(), by_contact];
    row.contact_work = created(row, known, body, moved, context.bodies);
    if row.support == Support::None {
        row.mobility = 1.0;
        // Something has pushed it in an earlier substep than the last.
        row.was_pushed = is_touched(body, context);
    } else if let (Support::Contact { .. }, false) = (row.support, row.turns) {
        if let Some((direction, share)) = orders.missing(&change) {
            row.held = Some(direction);
            row.mobility = if share > FREE { 1.0 } else { share };
        }
    } else if let Some(share) = orders.share(&change, row.support) {
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
pub(super) fn push(free: &Body, given: (DVec3, DVec3), support: Support, terms: &Terms) -> Push {
    let time = terms.schedule.time;
    let n = f64::from(terms.schedule.substeps);
    let outside = match support {
        Support::Contact { .. } => (DVec3::ZERO, DVec3::ZERO),
        _ => (force_for(free.acceleration, free.inverse_mass), free.torque),
    };
    let mut force = (given.0 / time, given.1 / time);
    let turns = free.spin != Spin::Still;
    let (mut linvel, mut angvel) = (None, None);
    if support.is_moving() && terms.takes_impulses {
        // Against a partner that moves, the force has to act evenly: each jerk would reach it.
        linvel = Some(free.velocity);
        angvel = turns.then(|| free.angular_velocity());
    } else if terms.takes_impulses && terms.schedule.substeps > 1 {
        let back = 1.0 / (n - 1.0);
        let total = (force.0 + outside.0, force.1 + outside.1);
        linvel = Some(free.velocity - back * time * (free.inverse_mass * total.0));
        angvel = turns
            .then(|| free.angular_velocity() - back * time * (free.inverse_inertia() * total.1));
        force = (force.0 + back * total.0, force.1 + back * total.1);
    }
    Push {
        linvel: linvel.map(|v| v.as_vec3()),
        angvel: angvel.map(|w| w.as_vec3()),
        share: [force.0.as_vec3(), force.1.as_vec3()],
        raised_iterations: terms.raised_iterations,
    }
}
