//! What bodies stand on before the engine has ever looked.

use super::held::Support;
use super::touch::contact;
use bevy::math::DVec3;
use bevy_rapier3d::parry;
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{ColliderHandle, ColliderSet};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What cannot be moved, to see what bodies stand on that the engine has not stepped yet: it finds
/// contacts only within its step, and a stiff spring must know before the first.
#[derive(Default)]
pub(super) struct Ground {
    solids: OnceLock<Vec<(ColliderHandle, Aabb)>>,
    /// Looks taken in this tick.
    looks: AtomicUsize,
}

/// Looks in a tick after which further new bodies count as free for one step: a scene of thousands that
/// appears at once must not stall.
const LOOKS: usize = 1_000_000;

impl Ground {
    /// Which way a body is pushed by the ground that it touches.
    pub(super) fn under(
        &self,
        body: &RapierBody,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
    ) -> Support {
        let mut push = DVec3::ZERO;
        for own in body.colliders().iter().filter_map(|c| colliders.get(*c)) {
            let solids = self.solids.get_or_init(|| solids(bodies, colliders));
            let before = self.looks.fetch_add(solids.len(), Ordering::Relaxed);
            if before + solids.len() > LOOKS {
                return Support::None;
            }
            let bounds = own.compute_aabb().loosened(TOUCH);
            for (handle, solid) in solids {
                if !bounds.intersects(solid) || !own.is_enabled() || own.is_sensor() {
                    continue;
                }
                let Some(other) = colliders.get(*handle) else {
                    continue;
                };
                if !own.collision_groups().test(other.collision_groups()) {
                    continue;
                }
                let contact = parry::query::contact(
                    own.position(),
                    own.shape(),
                    other.position(),
                    other.shape(),
                    TOUCH,
                );
                if let Ok(Some(contact)) = contact {
                    push += contact.normal2.as_dvec3();
                }
            }
        }
        contact(push, true)
    }
}

/// Colliders of fixed and kinematic bodies, and of none.
fn solids(bodies: &RigidBodySet, colliders: &ColliderSet) -> Vec<(ColliderHandle, Aabb)> {
    colliders
        .iter()
        .filter(|(_, collider)| {
            let parent = collider.parent().and_then(|parent| bodies.get(parent));
            collider.is_enabled()
                && !collider.is_sensor()
                && !parent.is_some_and(RapierBody::is_dynamic)
        })
        .map(|(handle, collider)| (handle, collider.compute_aabb()))
        .collect()
}

/// Nearer than this counts as touching before the first step, m.
const TOUCH: f32 = 0.005;
