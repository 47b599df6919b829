//! Turns the components that a loaded scene carries into Rapier's bodies, colliders and joints. Runs in `PostUpdate`,
//! when the scene has its place in the world.

use super::carry::{LoadedBody, LoadedCollider, LoadedEnd, LoadedJoint};
use super::place::{NOWHERE, above, place};
use super::{joints, mass};
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::prelude::{MassProperties as RapierMass, Pose, SharedShape};

/// Run condition: whether a scene has brought components that wait to be expanded.
pub(super) fn any_loaded(
    loaded: Query<
        (),
        Or<(
            With<LoadedBody>,
            With<LoadedCollider>,
            With<LoadedEnd>,
            With<LoadedJoint>,
        )>,
    >,
) -> bool {
    !loaded.is_empty()
}

/// Number of subdivisions with which Rapier approximates round shapes that are scaled unevenly. This is Rapier's
/// default.
pub(super) const SUBDIVISIONS: u32 = 10;

/// Limits of a collider's size and of its distance from the origin, m. Beyond them, Rapier's collision detection
/// panics.
const LARGEST: f32 = 1e6;
const SMALLEST: f32 = 1e-5;

/// Expands everything that scenes have brought: colliders first, then bodies, whose mass needs the colliders, then fixed
/// bodies where elements need them, then joints.
pub(super) fn expand(world: &mut World) {
    let mut weights = EntityHashMap::<RapierMass>::default();
    let colliders = take(world, |loaded: &LoadedCollider| loaded.node);
    for (entity, loaded) in &colliders {
        let body = owner(world, *entity);
        if let Some(weight) = add_collider(world, *entity, loaded, body)
            && let Some(body) = body
        {
            *weights.entry(body).or_default() += weight;
        }
    }
    let bodies = take(world, |loaded: &LoadedBody| loaded.node);
    let moving: EntityHashSet = bodies.iter().map(|(entity, _)| *entity).collect();
    for (entity, loaded) in bodies {
        let weight = weights.get(&entity).copied().unwrap_or_default();
        add_body(world, entity, &loaded, weight, &moving);
    }
    for (entity, _) in take(world, |loaded: &LoadedEnd| loaded.node) {
        if owner(world, entity).is_none() && place(world, entity).is_some() {
            anchor(world, entity);
        }
    }
    for (entity, joint) in take(world, |loaded: &LoadedJoint| loaded.node) {
        joints::add(world, entity, &joint);
    }
}

/// Makes a node a moving body. `weight` is that of its colliders, and `moving` has all bodies that move.
fn add_body(
    world: &mut World,
    entity: Entity,
    loaded: &LoadedBody,
    weight: RapierMass,
    moving: &EntityHashSet,
) {
    let motion = &*loaded.motion;
    let Some(place) = place(world, entity) else {
        log::warn!("{}: {NOWHERE}; it has no body", loaded.place);
        return;
    };
    stand_free(world, entity, place, moving);
    let (properties, locked) = mass::mass(motion, weight, place.scale);
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

/// Removes all components of a type from their entities and returns them, in the order of their nodes in the file.
/// `node` returns the index of the node.
fn take<C: Component>(world: &mut World, node: impl Fn(&C) -> usize) -> Vec<(Entity, C)> {
    let mut query = world.query::<(Entity, &C)>();
    let found = query.iter(world);
    let mut entities: Vec<_> = found
        .map(|(entity, loaded)| (node(loaded), entity))
        .collect();
    // Rapier's results depend on the order in which bodies are inserted. So it is the same each time a file is loaded.
    // Two scenes that are spawned in the same frame have nodes with the same index.
    entities.sort_unstable();
    let taken = entities.into_iter().filter_map(|(_, entity)| {
        let loaded = world.entity_mut(entity).take::<C>()?;
        Some((entity, loaded))
    });
    taken.collect()
}

/// Returns the body that an entity belongs to: the entity itself or its nearest ancestor that is a body.
pub(super) fn owner(world: &World, entity: Entity) -> Option<Entity> {
    let mut up = std::iter::once(entity).chain(above(world, entity));
    up.find(|entity| {
        world.get::<LoadedBody>(*entity).is_some() || world.get::<RigidBody>(*entity).is_some()
    })
}

/// Returns the node that stands for the body of a node that belongs to none: the node itself or its nearest ancestor
/// with a collider, else the node. A collider without a motion is a static body.
pub(super) fn still_body(world: &World, node: Entity) -> Entity {
    let mut up = std::iter::once(node).chain(above(world, node));
    let found = up.find(|entity| world.get::<Collider>(*entity).is_some());
    found.unwrap_or(node)
}

/// Makes a fixed body for a node that belongs to no body, and returns it.
pub(super) fn anchor(world: &mut World, node: Entity) -> Entity {
    let body = still_body(world, node);
    if let Some(place) = place(world, body) {
        stand_free(world, body, place, &EntityHashSet::default());
    }
    world.entity_mut(body).insert(RigidBody::Fixed);
    body
}

/// Least length of the vector part of a quaternion that counts as a rotation. It is the sine of half the angle, so this is
/// 2e-5 rad, or 0.02 mm at a distance of 1 m. Rounding errors in single precision are a hundred times smaller.
const TURNED: f32 = 1e-5;

/// Moves a body to a place in the hierarchy where no ancestor moves, rotates or scales it, because bevy_rapier3d 0.36
/// writes wrong transforms into bodies below rotated entities, and places the colliders of a body's descendants without
/// the scale that is above the body.
///
/// In the file, nested bodies move independently. So a body below other bodies of the file moves up to the parent of
/// the topmost of them. New entities in between undo the transform of that parent.
fn stand_free(world: &mut World, body: Entity, at: Transform, moving: &EntityHashSet) {
    let moving_above = above(world, body).filter(|entity| moving.contains(entity));
    let top = moving_above.last().unwrap_or(body);
    let Some(parent) = above(world, top).next() else {
        return;
    };
    let Some(place) = place(world, parent) else {
        return;
    };
    let turned = place.rotation.xyz().length() >= TURNED;
    let scale = mass::steady(place.scale);
    if !turned && scale == Vec3::ONE && top == body {
        return;
    }
    let mut level = parent;
    let back = place.rotation.inverse();
    // The scale goes first, on an entity of its own: one `Transform` cannot undo an uneven scale and a rotation.
    for undone in [
        Transform::from_scale(scale.recip()),
        Transform::from_rotation(back).with_translation(back * -place.translation),
    ] {
        if undone != Transform::IDENTITY {
            let between = (undone, Visibility::default(), ChildOf(level));
            level = world.spawn(between).id();
        }
    }
    world.entity_mut(body).insert((at, ChildOf(level)));
}

/// Adds the collider of an entity. Returns its mass properties at [`mass::DENSITY`], in the frame of its body.
fn add_collider(
    world: &mut World,
    entity: Entity,
    loaded: &LoadedCollider,
    body: Option<Entity>,
) -> Option<RapierMass> {
    let place_of = &loaded.place;
    let Some(here) = place(world, entity) else {
        // Where the scale is zero on all axes, this is what the file means: it disables the collider.
        log::warn!("{place_of}: {NOWHERE}; it has no collider");
        return None;
    };
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
        // With a negative scale, Rapier would turn a ball into another shape. These shapes equal their mirror images,
        // so the sign is dropped.
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
    // The mass is set on the body, so the collider has none.
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

#[cfg(test)]
mod tests {
    use super::super::carry::Shape;
    use super::super::json::Told;
    use super::super::physics::{Implicit, NodePhysics};
    use super::*;
    use serde_json::json;
    use std::cell::RefCell;
    use std::sync::Arc;

    thread_local! {
        /// Messages of this thread, while they are wanted.
        static MESSAGES: RefCell<Option<Vec<String>>> = const { RefCell::new(None) };
    }

    struct Collector;

    impl log::Log for Collector {
        fn enabled(&self, _metadata: &log::Metadata) -> bool {
            true
        }

        fn log(&self, record: &log::Record) {
            MESSAGES.with_borrow_mut(|messages| {
                if let Some(messages) = messages {
                    messages.push(record.args().to_string());
                }
            });
        }

        fn flush(&self) {}
    }

    #[test]
    fn a_body_and_a_collider_that_are_scaled_to_zero_are_told_of_by_name() {
        let _ = log::set_logger(&Collector);
        log::set_max_level(log::LevelFilter::Warn);
        let place = "a.gltf: node 1 'Crate'";
        for scale in [Vec3::ZERO, Vec3::new(1.0, 0.0, 1.0)] {
            let physics = NodePhysics::read(&json!({ "motion": {} }), place, &Told::default());
            let body = LoadedBody {
                node: 0,
                motion: Arc::new(physics.motion.expect("a motion")),
                place: place.to_owned(),
            };
            let collider = LoadedCollider {
                node: 0,
                shape: Shape::Implicit(Implicit::Sphere { radius: 0.5 }),
                material: None,
                groups: None,
                trigger: false,
                place: place.to_owned(),
            };
            let mut world = World::new();
            let parent = world.spawn(Transform::from_scale(scale)).id();
            let node = (Transform::default(), body, collider, ChildOf(parent));
            let node = world.spawn(node).id();
            MESSAGES.set(Some(Vec::new()));
            expand(&mut world);
            let told = MESSAGES.take().unwrap_or_default();
            assert_eq!(told.len(), 2, "{scale}: {told:?}");
            for (line, lacks) in told.iter().zip(["no collider", "no body"]) {
                assert!(line.starts_with(place) && line.ends_with(lacks), "{line}");
            }
            let node = world.entity(node);
            assert!(!node.contains::<RigidBody>() && !node.contains::<Collider>());
        }
    }
}
