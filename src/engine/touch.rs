//! What touches a body: which contacts push it, and which moving body pushes most.

use super::body::read;
use super::held::{Context, Support};
use super::jointed;
use super::scene::BodyRow;
use super::step::Step;
use crate::dynamics::body::Body;
use bevy::math::DVec3;
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle};

/// The body that pushes most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Partner {
    handle: RigidBodyHandle,
    /// Its velocity, at the place of the body that it pushes, before the step.
    before: Option<DVec3>,
}

impl Partner {
    /// Notes how it moves before the step.
    pub(super) fn note(&mut self, pushed: &RapierBody, bodies: &RigidBodySet) {
        self.before = bodies
            .get(self.handle)
            .map(|partner| velocity_at(partner, pushed));
    }
}

/// Joints, or contacts that pushed in the last step, and what pushed most.
pub(super) fn support(
    handle: RigidBodyHandle,
    body: &RapierBody,
    context: &Context,
) -> (Support, Option<Partner>) {
    let Context {
        simulation,
        joints,
        colliders,
        bodies,
    } = context;
    let mut attached = joints.impulse_joints.attached_enabled_joints(handle);
    if joints.multibody_joints.rigid_body_link(handle).is_some() || attached.next().is_some() {
        return (Support::Joint, None);
    }
    let (mut push, mut on_fixed) = (DVec3::ZERO, true);
    let parent = |collider: ColliderHandle| colliders.get(collider).and_then(Collider::parent);
    let is_fixed = |collider: ColliderHandle| {
        parent(collider).is_none_or(|body| bodies.get(body).is_some_and(RapierBody::is_fixed))
    };
    let (mut most, mut partner) = (0.0, None);
    for collider in body.colliders() {
        for pair in simulation.narrow_phase.contact_pairs_with(*collider) {
            // Normals point from the first collider to the second.
            let (sign, other) = if pair.collider1 == *collider {
                (-1.0, pair.collider2)
            } else {
                (1.0, pair.collider1)
            };
            let impulse = pair.total_impulse().as_dvec3();
            push += sign * impulse;
            on_fixed &= impulse == DVec3::ZERO || is_fixed(other);
            if impulse.length_squared() > most {
                most = impulse.length_squared();
                partner = parent(other).map(|handle| Partner {
                    handle,
                    before: None,
                });
            }
        }
    }
    (contact(push, on_fixed), partner)
}

/// Whether anything touches it, pushing or not.
pub(super) fn is_touched(body: &RapierBody, context: &Context) -> bool {
    body.colliders().iter().any(|collider| {
        let mut pairs = context
            .simulation
            .narrow_phase
            .contact_pairs_with(*collider);
        pairs.any(|pair| pair.has_any_active_contact())
    })
}

impl Step<'_> {
    /// What is known of a body that the engine has not stepped yet.
    pub(super) fn first_support(
        &self,
        row: &BodyRow,
        body: &RapierBody,
        load: (DVec3, DVec3),
        set: &RigidBodySet,
    ) -> Support {
        let free = read(body, self.engine.gravity, &row.user, true);
        match jointed::share(row.handle, &free, load, set, self.joints) {
            Some(share) => Support::Tied(share),
            None => self.ground.under(body, set, self.colliders),
        }
    }
}

pub(super) fn contact(push: DVec3, on_fixed: bool) -> Support {
    push.try_normalize()
        .map_or(Support::None, |push| Support::Contact { push, on_fixed })
}

/// Work that a contact with a moving body seems to have created: its impulse times the speed with which the
/// bodies part, by which it can take energy only. `mean` is the mean velocity of the body over the step, and
/// `change` what the contact added to it.
pub(super) fn created(
    row: &BodyRow,
    known: Option<Partner>,
    body: &RapierBody,
    [mean, change]: [DVec3; 2],
    bodies: &RigidBodySet,
) -> f64 {
    let (
        Support::Contact {
            push,
            on_fixed: false,
        },
        Some(Partner { handle, .. }),
    ) = (row.support, row.partner)
    else {
        return 0.0;
    };
    let Some(partner) = bodies.get(handle) else {
        return 0.0;
    };
    let after = velocity_at(partner, body);
    let before = known.filter(|known| known.handle == handle);
    let before = before.and_then(|known| known.before).unwrap_or(after);
    let apart = mean - 0.5 * (before + after);
    (f64::from(body.mass()) * change.dot(push) * apart.dot(push)).max(0.0)
}

/// Velocity of a body at the place of another.
fn velocity_at(body: &RapierBody, place: &RapierBody) -> DVec3 {
    let arm = place.position().translation - body.position().translation;
    (body.linvel() + body.angvel().cross(arm)).as_dvec3()
}

/// The moving bodies that push a component.
#[derive(Clone, Debug, Default)]
pub(super) struct Partners {
    list: Vec<Share>,
    /// Of all of them, J.
    pub motion: f64,
}

#[derive(Clone, Copy, Debug)]
struct Share {
    handle: RigidBodyHandle,
    mass: f64,
    /// So many bodies of the component feel it.
    among: f64,
}

impl Partners {
    pub(super) fn find<'a>(
        &mut self,
        rows: impl Iterator<Item = &'a BodyRow>,
        bodies: &RigidBodySet,
    ) {
        self.list.clear();
        self.motion = 0.0;
        for handle in rows.filter_map(|row| Some(row.partner?.handle)) {
            if let Some(share) = self.list.iter_mut().find(|s| s.handle == handle) {
                share.among += 1.0;
            } else if let Some(body) = bodies.get(handle).filter(|body| body.is_dynamic()) {
                let mass = f64::from(body.mass());
                self.motion += 0.5 * mass * body.linvel().as_dvec3().length_squared();
                self.list.push(Share {
                    handle,
                    mass,
                    among: 1.0,
                });
            }
        }
    }

    /// A body that another one holds gives way with it: the mobility that this leaves at least, if all that
    /// it holds are alike.
    pub(super) fn least_mobility(&self, row: &BodyRow, own: &Body) -> f64 {
        let Some(partner) = row.partner else {
            return 0.0;
        };
        let share = self.list.iter().find(|s| s.handle == partner.handle);
        share.map_or(0.0, |share| {
            let mass = own.mass().max_element();
            mass / (mass + share.mass / share.among)
        })
    }
}
