//! Builds a stage in Rapier.

use super::stage::{Freedom, Joint, Motion, Part, Shape, Stage};
use crate::method::Method;
use crate::rig::rapier::spring;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// Spawns bodies, joints and springs.
pub fn fill(world: &mut World, stage: &Stage, method: Method) -> Vec<Entity> {
    let bodies: Vec<Entity> = stage.parts.iter().map(|p| spawn(world, p)).collect();
    for joint in &stage.joints {
        let [a, b] = joint.ends.map(|end| bodies[end]);
        let joint = ImpulseJoint::new(a, typed(joint));
        world.entity_mut(b).insert(joint);
    }
    for link in &stage.links {
        spring(world, link, link.ends.map(|end| bodies[end]), method);
    }
    bodies
}

fn spawn(world: &mut World, part: &Part) -> Entity {
    let body = match part.motion {
        Motion::Fixed => RigidBody::Fixed,
        Motion::Kinematic => RigidBody::KinematicPositionBased,
        Motion::Dynamic => RigidBody::Dynamic,
    };
    let moving = Velocity {
        linear: part.velocity,
        angular: part.spin,
    };
    let mut entity = world.spawn((body, part.at, moving));
    if part.motion == Motion::Dynamic {
        let mut locked = LockedAxes::empty();
        locked.set(LockedAxes::ROTATION_LOCKED, part.upright);
        locked.set(LockedAxes::TRANSLATION_LOCKED_Z, part.planar);
        // A sleeping body takes no computing time, so the measured time would mean nothing.
        entity.insert((Sleeping::disabled(), locked));
    }
    if let Some(collider) = part.shape.and_then(collider) {
        let groups = part.groups.map(Group::from_bits_truncate);
        entity.insert((
            collider,
            ColliderMassProperties::Mass(part.mass),
            Friction::new(part.friction),
            CollisionGroups::new(groups[0], groups[1]),
        ));
    } else if part.motion == Motion::Dynamic {
        let weight = MassProperties {
            mass: part.mass,
            principal_inertia: part.inertia(),
            ..default()
        };
        entity.insert(AdditionalMassProperties::MassProperties(weight));
    }
    entity.id()
}

fn collider(shape: Shape) -> Option<Collider> {
    match shape {
        Shape::HalfSpace => Collider::halfspace(Vec3::Y),
        Shape::Ball(radius) => Some(Collider::ball(radius)),
        Shape::Cuboid(half) => Some(Collider::cuboid(half.x, half.y, half.z)),
        Shape::Capsule(half, radius) => Some(Collider::capsule_y(half, radius)),
    }
}

fn typed(joint: &Joint) -> TypedJoint {
    let [a, b] = joint.anchors;
    let across = JointAxesMask::LIN_X | JointAxesMask::LIN_Z;
    let locked = match joint.freedom {
        Freedom::Spherical => JointAxesMask::LOCKED_SPHERICAL_AXES,
        Freedom::Revolute => {
            let hinge = RevoluteJointBuilder::new(Vec3::Z);
            return hinge.local_anchor1(a).local_anchor2(b).build().into();
        }
        Freedom::Slider => across | JointAxesMask::ANG_AXES,
        Freedom::Guide => across,
    };
    let generic = GenericJointBuilder::new(locked);
    let generic = generic.local_anchor1(a).local_anchor2(b);
    TypedJoint::GenericJoint(generic.build())
}
