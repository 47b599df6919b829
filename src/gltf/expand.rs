//! What a scene carries becomes Rapier's bodies, colliders and joints, once the scene stands at its place.

use super::carry::{LoadedBody, LoadedCollider, LoadedJoint};
use super::place::{above, place};
use super::{joints, mass};
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::prelude::{MassProperties as RapierMass, Pose, SharedShape};

/// Whether a scene has brought anything.
pub(super) fn any_loaded(
    loaded: Query<(), Or<(With<LoadedBody>, With<LoadedCollider>, With<LoadedJoint>)>>,
) -> bool {
    !loaded.is_empty()
}

/// Subdivisions of round shapes that are scaled unevenly, as Rapier has by default.
pub(super) const SUBDIVISIONS: u32 = 10;

/// Sizes of colliders (m) and their distances from the origin, beyond which Rapier's collision detection panics.
const LARGEST: f32 = 1e6;
const SMALLEST: f32 = 1e-5;

/// Gives all that scenes have brought to Rapier.
pub(super) fn expand(world: &mut World) {
    let mut weights = EntityHashMap::<RapierMass>::default();
    let colliders = take::<LoadedCollider>(world);
    for (entity, loaded) in &colliders {
        let body = owner(world, *entity);
        if let Some(weight) = add_collider(world, *entity, loaded, body)
            && let Some(body) = body
        {
            *weights.entry(body).or_default() += weight;
        }
    }
    let bodies = take::<LoadedBody>(world);
    let moving: EntityHashSet = bodies.iter().map(|(entity, _)| *entity).collect();
    for (entity, LoadedBody(motion)) in bodies {
        let Some(place) = place(world, entity) else {
            continue;
        };
        stand_free(world, entity, place, &moving);
        let weight = weights.get(&entity).copied().unwrap_or_default();
        let (properties, locked) = mass::mass(&motion, weight, place.scale);
        let mut body = world.entity_mut(entity);
        body.insert((
            if motion.kinematic {
                RigidBody::KinematicVelocityBased
            } else {
                RigidBody::Dynamic
            },
            AdditionalMassProperties::MassProperties(properties),
            Velocity {
                linear: place.rotation * motion.linear_velocity,
                angular: place.rotation * motion.angular_velocity,
            },
        ));
        if motion.gravity_factor != 1.0 {
            body.insert(GravityScale(motion.gravity_factor));
        }
        if !locked.is_empty() {
            body.insert(locked);
        }
    }
    for (entity, joint) in take::<LoadedJoint>(world) {
        joints::add(world, entity, &joint);
    }
}

/// All components of a kind, taken away from their entities.
fn take<C: Component>(world: &mut World) -> Vec<(Entity, C)> {
    let mut query = world.query_filtered::<Entity, With<C>>();
    let mut entities: Vec<_> = query.iter(world).collect();
    // As the scene has them, whatever else is in the world.
    entities.sort_unstable();
    let taken = entities.into_iter().filter_map(|entity| {
        let loaded = world.entity_mut(entity).take::<C>()?;
        Some((entity, loaded))
    });
    taken.collect()
}

/// The body that an entity is or stands below.
pub(super) fn owner(world: &World, entity: Entity) -> Option<Entity> {
    let mut up = std::iter::once(entity).chain(above(world, entity));
    up.find(|entity| {
        world.get::<LoadedBody>(*entity).is_some() || world.get::<RigidBody>(*entity).is_some()
    })
}

/// Puts a body where nothing above it moves or turns: bevy_rapier3d 0.36 writes wrong places into bodies below what is turned.
///
/// One below another of the file goes to where the uppermost of these hangs: to the file, each goes its own way. If what is
/// above is turned, an entity between them undoes that.
fn stand_free(world: &mut World, body: Entity, at: Transform, moving: &EntityHashSet) {
    let moving_above = above(world, body).filter(|entity| moving.contains(entity));
    let top = moving_above.last().unwrap_or(body);
    let Some(parent) = above(world, top).next() else {
        return;
    };
    let Some(place) = place(world, parent) else {
        return;
    };
    let turned = place.rotation.angle_between(Quat::IDENTITY) >= 1e-6;
    if place.scale.cmpeq(Vec3::ZERO).any() || !(turned || top != body) {
        return;
    }
    let undone = Transform::from_matrix(place.to_matrix().inverse());
    let level = world
        .spawn((undone, Visibility::default(), ChildOf(parent)))
        .id();
    world.entity_mut(body).insert((at, ChildOf(level)));
}

/// The collider of an entity, and what it weighs in its body's frame.
fn add_collider(
    world: &mut World,
    entity: Entity,
    loaded: &LoadedCollider,
    body: Option<Entity>,
) -> Option<RapierMass> {
    let place_of = &loaded.place;
    let here = place(world, entity)?;
    if here.scale == Vec3::ZERO {
        // The file's way to say that there is none.
        return None;
    }
    if here.scale.cmpeq(Vec3::ZERO).any() {
        log::warn!("{place_of}: is scaled flat, so it has no collider");
        return None;
    }
    let shape: SharedShape = match loaded.shape.build() {
        Ok(shape) => shape,
        Err(reason) => {
            log::warn!("{place_of}: its collider {reason}; left out");
            return None;
        }
    };
    let mut scaled = Collider::from(shape.clone());
    let mirrored = loaded.shape.is_symmetric() && here.scale.cmplt(Vec3::ZERO).any();
    let scale = if mirrored {
        here.scale.abs()
    } else {
        here.scale
    };
    scaled.set_scale(scale, SUBDIVISIONS);
    let extents = scaled.raw.compute_local_aabb().extents();
    let endless = matches!(scaled.as_typed_shape(), ColliderView::HalfSpace(_));
    let sound =
        extents.is_finite() && extents.max_element() < LARGEST && extents.max_element() > SMALLEST;
    let near = here.translation.abs().max_element() < LARGEST;
    if !((endless || sound) && near) {
        log::warn!("{place_of}: its collider is too large, too small or too far away; left out");
        return None;
    }
    let mut node = world.entity_mut(entity);
    node.insert(Collider::from(shape));
    if mirrored {
        // Rapier would take a ball for something else, and a mirrored shape is itself.
        node.insert(ColliderScale::Absolute(scale));
    }
    if let Some(material) = &loaded.material {
        node.insert((
            Friction {
                coefficient: material.friction,
                combine_rule: material.friction_rule,
            },
            Restitution {
                coefficient: material.restitution,
                combine_rule: material.restitution_rule,
            },
        ));
    }
    if let Some((memberships, filters)) = loaded.groups {
        node.insert(CollisionGroups::new(
            Group::from_bits_truncate(memberships),
            Group::from_bits_truncate(filters),
        ));
    }
    if loaded.trigger {
        node.insert((
            Sensor,
            ActiveEvents::COLLISION_EVENTS,
            ActiveCollisionTypes::all(),
        ));
    }
    let body = body?;
    // The body has all of the mass.
    node.insert(ColliderMassProperties::Density(0.0));
    if loaded.trigger {
        return None;
    }
    let on = place(world, body)?;
    let turned = on.rotation.inverse();
    let at = Pose::from_parts(
        turned * (here.translation - on.translation),
        turned * here.rotation,
    );
    Some(scaled.raw.mass_properties(mass::DENSITY).transform_by(&at))
}
