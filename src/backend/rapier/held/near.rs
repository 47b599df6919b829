//! What a component may run into within the coming step.
//!
//! The engine finds a contact only within the step in which it begins. A stiff spring whose force has been worked out
//! before that does not answer the blow until the next step, and its energy is won from nothing. So a component of stiff
//! springs that is free looks ahead.

use crate::backend::rapier::body::handle;
use crate::compat;
use crate::scene::rows::BodyRow;
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::query::DefaultQueryDispatcher;
use bevy_rapier3d::parry::shape::Cuboid;
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{Collider, ColliderSet, DefaultBroadPhase};
use bevy_rapier3d::rapier::math::Pose;
use bevy_rapier3d::rapier::pipeline::QueryFilter;

/// Nearer than this counts as touching, m.
const NEAR: f32 = 0.005;

/// Speed of other bodies for which there is no need to look again at once, m/s.
const OTHERS: f32 = 30.0;

/// Most steps for which one look is good: meanwhile bodies gain speed.
const MOST: u8 = 8;

/// Share of the free way that is trusted.
const TRUSTED: f32 = 0.7;

/// Where all that can touch something stands.
pub(crate) struct Outlook<'a> {
    pub broad: &'a DefaultBroadPhase,
    pub bodies: &'a RigidBodySet,
    pub colliders: &'a ColliderSet,
    /// Seconds.
    pub time: f32,
}

/// A body that may be met, and its speed.
struct Other<'a> {
    collider: &'a Collider,
    speed: f32,
}

impl Outlook<'_> {
    /// Whether bodies may meet something that is not of their own component, and if not for how many steps more there is
    /// no need to look.
    pub(crate) fn look(
        &self,
        rows: &[&BodyRow],
        pushes: &[f32],
        is_own: impl Fn(RigidBodyHandle) -> bool,
    ) -> (bool, u8) {
        let Some((bounds, fastest)) = self.bounds(rows, pushes) else {
            return (false, MOST);
        };
        let way = f32::from(MOST) * (fastest + OTHERS) * self.time;
        let region = bounds.loosened(NEAR + way);
        let all = self.broad.as_query_pipeline(
            &DefaultQueryDispatcher,
            self.bodies,
            self.colliders,
            QueryFilter::new().exclude_sensors(),
        );
        let (shape, place) = (
            Cuboid::new(bounds.half_extents()),
            Pose::from_translation(bounds.center()),
        );
        let mut clear = MOST;
        for (_, collider) in all.intersect_aabb_conservative(region) {
            let parent = collider.parent();
            if parent.is_some_and(&is_own) {
                continue;
            }
            let body = parent.and_then(|parent| self.bodies.get(parent));
            let other = Other {
                collider,
                speed: body.map_or(0.0, speed_of),
            };
            let apart = compat::distance([&place, collider.position()], [&shape, collider.shape()]);
            let free = (apart - NEAR).max(0.0);
            let step = (fastest + other.speed) * self.time;
            let steps = (TRUSTED * free / step.max(f32::MIN_POSITIVE)).min(f32::from(MOST));
            if steps < 1.0 && self.meets(rows, pushes, &other) {
                return (true, 0);
            }
            clear = clear.min(steps as u8);
        }
        (false, clear)
    }

    /// Bounds of all colliders of some bodies, and the greatest speed of a body.
    fn bounds(&self, rows: &[&BodyRow], pushes: &[f32]) -> Option<(Aabb, f32)> {
        let mut bounds: Option<Aabb> = None;
        let mut fastest = 0.0_f32;
        for (row, push) in rows.iter().zip(pushes) {
            let Some(body) = self.bodies.get(handle(row.id)) else {
                continue;
            };
            fastest = fastest.max(speed_of(body) + push);
            for own in self.of(body) {
                let own = own.compute_aabb();
                bounds = Some(bounds.map_or(own, |bounds| bounds.merged(&own)));
            }
        }
        Some((bounds?, fastest))
    }

    fn of<'b>(&'b self, body: &'b RapierBody) -> impl Iterator<Item = &'b Collider> + 'b {
        let colliders = body.colliders().iter();
        colliders.filter_map(|own| self.colliders.get(*own))
    }

    /// Whether some body may meet another in the coming step.
    fn meets(&self, rows: &[&BodyRow], pushes: &[f32], other: &Other) -> bool {
        let bodies = rows.iter().zip(pushes);
        let mut bodies =
            bodies.filter_map(|(row, push)| Some((self.bodies.get(handle(row.id))?, push)));
        bodies.any(|(body, push)| {
            let way = NEAR + 2.0 * (speed_of(body) + push + other.speed) * self.time;
            let theirs = other.collider.compute_aabb().loosened(way);
            self.of(body).any(|own| {
                let groups = own
                    .collision_groups()
                    .test(other.collider.collision_groups());
                groups && own.compute_aabb().intersects(&theirs) && {
                    let (a, b) = (own, other.collider);
                    compat::distance([a.position(), b.position()], [a.shape(), b.shape()]) < way
                }
            })
        })
    }
}

/// Speed of a body's fastest point.
pub(crate) fn speed_of(body: &RapierBody) -> f32 {
    let reach = body.mass_properties().max_extent();
    body.linvel().length() + reach * body.angvel().length()
}
