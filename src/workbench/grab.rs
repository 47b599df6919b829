//! Pulls bodies with the mouse. A key and the pointer pick a body, and a [`MouseSpring`] pulls it.

use super::CoiloverWorkbench;
use super::pointer::Pointer;
use crate::MouseSpring;
use crate::input::named_ends::and_above;
use bevy::prelude::*;
use bevy_rapier3d::prelude::{QueryFilter, ReadRapierContext, RigidBody};

/// Greatest distance from the pointer to the origin of a body, pixels, at which a body without colliders is picked.
const NEAR: f32 = 20.0;

/// State of the pull: the body that is held, if any.
#[derive(Resource, Default, Debug)]
pub(super) struct Hand {
    grip: Option<Grip>,
    /// Entity of the [`MouseSpring`] that pulls the body.
    spring: Option<Entity>,
}

/// Point at which a body is held.
#[derive(Clone, Copy, Debug)]
struct Grip {
    body: Entity,
    /// Held point, in the body's frame, m.
    point: Vec3,
    /// Distance of the held point from the origin of the pointer's ray when it was picked, m.
    distance: f32,
    /// Point of the world on the pointer's ray at that distance, m.
    target: Vec3,
}

impl Hand {
    /// Returns the held point and its target, in the world.
    pub fn line(&self, globals: &Query<&GlobalTransform>) -> Option<[Vec3; 2]> {
        let grip = self.grip?;
        let body = globals.get(grip.body).ok()?;
        Some([body.transform_point(grip.point), grip.target])
    }
}

/// Run condition: whether a body is held, or its spring is not despawned yet.
pub(super) fn holds(hand: Res<Hand>) -> bool {
    hand.grip.is_some() || hand.spring.is_some()
}

/// Picks the body under the pointer, follows the pointer, and lets go.
pub(super) fn grab(
    mut hand: ResMut<Hand>,
    pointer: Pointer,
    settings: Res<CoiloverWorkbench>,
    contexts: ReadRapierContext<()>,
    bodies: Query<(Entity, &RigidBody, &GlobalTransform)>,
    parents: Query<&ChildOf>,
) {
    let ray = pointer.at().and_then(|at| pointer.ray(at));
    let (Some(ray), true, true) = (ray, settings.open, pointer.is_down()) else {
        hand.grip = None;
        return;
    };
    if let Some(at) = pointer
        .put_down()
        .filter(|_| pointer.is_with(settings.grab))
    {
        let found =
            touched(ray, &contexts, &bodies, &parents).or_else(|| near(at, ray, &pointer, &bodies));
        hand.grip = found.and_then(|(body, distance)| {
            let (_, _, frame) = bodies.get(body).ok()?;
            let target = ray.get_point(distance);
            let point = frame.affine().inverse().transform_point3(target);
            let grip = Grip {
                body,
                point,
                distance,
                target,
            };
            (point.is_finite() && target.is_finite()).then_some(grip)
        });
    }
    if let Some(grip) = &mut hand.grip {
        let target = ray.get_point(grip.distance);
        if target.is_finite() {
            grip.target = target;
        }
    }
}

/// Returns the first dynamic body that a ray hits, and the distance along the ray, m. Other bodies and sensors are
/// ignored.
fn touched(
    ray: Ray3d,
    contexts: &ReadRapierContext<()>,
    bodies: &Query<(Entity, &RigidBody, &GlobalTransform)>,
    parents: &Query<&ChildOf>,
) -> Option<(Entity, f32)> {
    let is_dynamic = |entity: &Entity| {
        let body = bodies.get(*entity);
        body.is_ok_and(|(_, body, _)| *body == RigidBody::Dynamic)
    };
    let cast = |parts: (_, _, _, _)| {
        let (simulation, colliders, joints, rigidbody_set) = parts;
        let context = bevy_rapier3d::prelude::RapierContext {
            simulation,
            colliders,
            joints,
            rigidbody_set,
        };
        let filter = QueryFilter::only_dynamic().exclude_sensors();
        let (origin, along) = (ray.origin, *ray.direction);
        let (collider, distance) = context.cast_ray(origin, along, f32::MAX, true, filter)?;
        let body = and_above(collider, parents).find(is_dynamic)?;
        Some((body, distance))
    };
    contexts
        .rapier_context
        .iter()
        .filter_map(cast)
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Returns the dynamic body whose origin is nearest to the pointer on the screen, and its distance along the ray, m.
/// This finds bodies without colliders.
fn near(
    at: Vec2,
    ray: Ray3d,
    pointer: &Pointer,
    bodies: &Query<(Entity, &RigidBody, &GlobalTransform)>,
) -> Option<(Entity, f32)> {
    let distance = |(entity, body, frame): (Entity, &RigidBody, &GlobalTransform)| {
        let origin = frame.translation();
        let apart = pointer.project(origin)?.distance(at);
        let taken = *body == RigidBody::Dynamic && apart <= NEAR;
        taken.then(|| (entity, apart, (origin - ray.origin).dot(*ray.direction)))
    };
    let nearest = bodies
        .iter()
        .filter_map(distance)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map(|(entity, _, distance)| (entity, distance))
}

/// Keeps a spring between pointer and body as long as a body is held. Runs in the tick, so that the engine notices
/// when the spring is spawned and despawned.
pub(super) fn pull(
    mut hand: ResMut<Hand>,
    bodies: Query<(), With<RigidBody>>,
    mut springs: Query<&mut MouseSpring>,
    mut commands: Commands,
) {
    let held = hand.grip.filter(|grip| bodies.contains(grip.body));
    let Some(grip) = held else {
        hand.grip = None;
        if let Some(spring) = hand.spring.take() {
            commands.entity(spring).try_despawn();
        }
        return;
    };
    let new = MouseSpring::new(grip.body, grip.point, grip.target);
    match hand.spring.and_then(|spring| springs.get_mut(spring).ok()) {
        Some(mut spring) => {
            spring.set_if_neq(new);
        }
        None => hand.spring = Some(commands.spawn((Name::new("Hand"), new)).id()),
    }
}
