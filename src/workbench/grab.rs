//! Bodies pulled with the mouse: a key and the pointer pick one, and a [`MouseSpring`] pulls it.

use super::CoiloverWorkbench;
use super::pointer::Pointer;
use crate::MouseSpring;
use bevy::prelude::*;
use bevy_rapier3d::prelude::{QueryFilter, ReadRapierContext, RigidBody};

/// Pixels between the pointer and the origin of a body without colliders that is still taken.
const NEAR: f32 = 20.0;

/// What the pointer has hold of.
#[derive(Resource, Default, Debug)]
pub(super) struct Hand {
    grip: Option<Grip>,
    /// The [`MouseSpring`] that pulls it.
    spring: Option<Entity>,
}

/// Where a body is held.
#[derive(Clone, Copy, Debug)]
struct Grip {
    body: Entity,
    /// In the body's frame.
    point: Vec3,
    /// From the eye, m.
    distance: f32,
    /// Where the pointer is at that distance.
    target: Vec3,
}

impl Hand {
    /// From the point that is held to where it is pulled.
    pub fn line(&self, globals: &Query<&GlobalTransform>) -> Option<[Vec3; 2]> {
        let grip = self.grip?;
        let body = globals.get(grip.body).ok()?;
        Some([body.transform_point(grip.point), grip.target])
    }
}

/// Whether it has hold of something, or has not let go of it yet.
pub(super) fn holds(hand: Res<Hand>) -> bool {
    hand.grip.is_some() || hand.spring.is_some()
}

/// Takes the body below the pointer, follows it, and lets go.
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

/// The first dynamic body that a ray meets, and how far along. What cannot be pulled is looked through.
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
        let mut up = std::iter::once(collider).chain(parents.iter_ancestors(collider));
        Some((up.find(is_dynamic)?, distance))
    };
    contexts
        .rapier_context
        .iter()
        .filter_map(cast)
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The dynamic body whose origin is nearest to the pointer, and how far away: it may have no collider.
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

/// Keeps the spring between pointer and body, as long as both are there. In the tick, so that the engine hears of what is
/// spawned and despawned.
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
