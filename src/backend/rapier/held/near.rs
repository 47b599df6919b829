//! Predicts whether a free component of stiff springs may collide with something in the coming step.
//!
//! The engine detects a contact only during the step in which it begins. A stiff spring whose force was computed before that
//! step reacts to the impact one step late, which adds energy. So the crate looks for coming contacts before the step.

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

/// Distance below which two shapes count as touching, m.
const NEAR: f32 = 0.005;

/// Assumed greatest speed of other bodies in the search for near colliders, m/s.
const OTHERS: f32 = 30.0;

/// Greatest number of steps for which one search is valid. It is limited because bodies gain speed meanwhile.
const MOST: u8 = 8;

/// Share of the free distance that is used to compute the number of steps without contact.
const TRUSTED: f32 = 0.7;

/// The bodies and colliders of a context.
pub(crate) struct Outlook<'a> {
    pub broad: &'a DefaultBroadPhase,
    pub bodies: &'a RigidBodySet,
    pub colliders: &'a ColliderSet,
    /// Duration of the step, s.
    pub time: f32,
}

/// A collider that a component may hit, and the speed of its body, m/s.
struct Other<'a> {
    collider: &'a Collider,
    speed: f32,
}

impl Outlook<'_> {
    /// Returns whether a component may hit a body outside it in the coming step, and if not, for how many further steps no new
    /// search is needed. `rows` are the bodies of the component, `pushes` the speed that springs can add to each, m/s; `is_own`
    /// says whether a body belongs to the component.
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

    /// Bounding box of all colliders of the bodies, and the greatest speed of a body, m/s.
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

    /// Whether a body of the component may hit `other` in the coming step.
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

/// Upper bound on the speed of any point of a body, m/s.
pub(crate) fn speed_of(body: &RapierBody) -> f32 {
    let reach = body.mass_properties().max_extent();
    body.linvel().length() + reach * body.angvel().length()
}
