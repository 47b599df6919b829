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

/// Distance below which two shapes count as touching, m. It is more than what Rapier's contacts leave open at rest, and so little
/// that a body that passes by stays free. Pinned by `ground::bounce`.
pub(crate) const NEAR: f32 = 0.005;

/// Factor by which a way is counted at the speed of now: bodies may gain speed within the step. Pinned by `ground::bounce`.
const SAFE: f32 = 2.0;

/// Distance within which a body may meet something that comes nearer at `speed` (m/s) for `time` seconds, m.
pub(super) fn way_of(speed: f32, time: f32) -> f32 {
    NEAR + SAFE * speed * time
}

/// Assumed greatest speed of other bodies in the search for near colliders, m/s. What is faster may arrive between two searches. A
/// greater speed only costs time, because a larger region is searched: 4 m at 60 steps a second. Pinned by `near::tests`.
const OTHERS: f32 = 30.0;

/// Greatest number of steps for which one search is valid. It is limited because bodies gain speed meanwhile: one that falls from
/// rest moves by 11 cm in that time, at 60 steps a second. Fewer steps only cost time. Pinned by `near::tests`.
const MOST: u8 = 8;

/// Share of the free distance that is used to compute the number of steps without contact. The rest is for what bodies gain in
/// speed meanwhile. Above 1, bodies meet before the next search; a smaller share only costs time. Pinned by `near::tests`.
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
    /// Returns how long no body of a component can hit a body outside it; `None` if one may do so in the coming step. `rows` are
    /// the bodies of the component, `pushes` the speed that springs can add to each, m/s; `is_own` says whether a body belongs to
    /// the component.
    pub(crate) fn look(
        &self,
        rows: &[&BodyRow],
        pushes: &[f32],
        is_own: impl Fn(RigidBodyHandle) -> bool,
    ) -> Option<Clear> {
        let most = f32::from(MOST);
        let Some((bounds, fastest)) = self.bounds(rows, pushes) else {
            return Some(Clear {
                steps: MOST,
                way: f32::INFINITY,
            });
        };
        // The step of the search itself comes first.
        let way = (most + 1.0) * (fastest + OTHERS) * self.time;
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
        let mut clear = Clear {
            steps: MOST,
            way: most * fastest * self.time,
        };
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
            let free = (apart - collider.contact_skin() - NEAR).max(0.0);
            let step = (fastest + other.speed) * self.time;
            let steps = (TRUSTED * free / step.max(f32::MIN_POSITIVE)).min(most);
            if steps < 1.0 && self.meets(rows, pushes, &other) {
                return None;
            }
            let way = TRUSTED * free - most * other.speed * self.time;
            clear = Clear {
                steps: clear.steps.min(steps as u8),
                way: clear.way.min(way),
            };
        }
        Some(clear)
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
                let skin = own.contact_skin();
                let own = own.shape().compute_aabb(&place(own, body)).loosened(skin);
                bounds = Some(bounds.map_or(own, |bounds| bounds.merged(&own)));
            }
        }
        Some((bounds?, fastest))
    }

    fn of<'b>(&'b self, body: &'b RapierBody) -> impl Iterator<Item = &'b Collider> + 'b {
        let colliders = body.colliders().iter();
        let colliders = colliders.filter_map(|own| self.colliders.get(*own));
        colliders.filter(|own| is_solid(own))
    }

    /// Whether a body of the component may hit `other` in the coming step.
    fn meets(&self, rows: &[&BodyRow], pushes: &[f32], other: &Other) -> bool {
        let bodies = rows.iter().zip(pushes);
        let mut bodies =
            bodies.filter_map(|(row, push)| Some((self.bodies.get(handle(row.id))?, push)));
        bodies.any(|(body, push)| {
            let way = way_of(speed_of(body) + push + other.speed, self.time);
            let theirs = other.collider.compute_aabb().loosened(way);
            self.of(body).any(|own| {
                let (a, b) = (own, other.collider);
                let (at, way) = (place(a, body), way + skins(a, b));
                let theirs = theirs.loosened(skins(a, b));
                may_press(a, b) && a.shape().compute_aabb(&at).intersects(&theirs) && {
                    compat::distance([&at, b.position()], [a.shape(), b.shape()]) < way
                }
            })
        })
    }
}

/// How long no body of a component can hit anything outside it.
pub(crate) struct Clear {
    /// Number of further steps without search.
    pub steps: u8,
    /// Distance that each of its bodies may move, m.
    pub way: f32,
}

/// Whether a body that was found clear still is in the coming step of `time` seconds: it may have been put elsewhere or got
/// an impulse meanwhile.
pub(crate) fn is_clear(row: &BodyRow, body: &RapierBody, time: f32) -> bool {
    let moved = body.center_of_mass().distance(row.rare.searched.at);
    moved + speed_of(body) * time <= row.rare.searched.way
}

/// Where a collider of a body is now. The engine moves the colliders of a body that was put elsewhere only in its step.
pub(crate) fn place(collider: &Collider, body: &RapierBody) -> Pose {
    let local = collider.position_wrt_parent();
    local.map_or(*collider.position(), |local| *body.position() * local)
}

/// Whether a collider can press on others.
pub(crate) fn is_solid(collider: &Collider) -> bool {
    collider.is_enabled() && !collider.is_sensor()
}

/// Whether contacts between two colliders press.
pub(crate) fn may_press(a: &Collider, b: &Collider) -> bool {
    is_solid(a)
        && is_solid(b)
        && a.collision_groups().test(b.collision_groups())
        && a.solver_groups().test(b.solver_groups())
}

/// Distance at which two colliders begin to press, m.
pub(crate) fn skins(a: &Collider, b: &Collider) -> f32 {
    a.contact_skin() + b.contact_skin()
}

/// Upper bound on the speed of any point of a body, m/s.
pub(crate) fn speed_of(body: &RapierBody) -> f32 {
    let reach = body.mass_properties().max_extent();
    body.linvel().length() + reach * body.angvel().length()
}

#[cfg(test)]
mod tests;
