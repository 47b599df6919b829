//! Builds a stage in Avian.

use super::stage::{Freedom, Joint, Motion, Part, Shape, Stage};
use crate::method::Method;
use crate::rig::avian::spring;
use avian3d::prelude::*;
use bevy::prelude::*;

/// Whether Avian has all joint types of a stage. It has no joint that leaves one translation and all rotations free.
pub fn has(stage: &Stage) -> bool {
    !stage
        .joints
        .iter()
        .any(|joint| matches!(joint.freedom, Freedom::Guide))
}

/// Spawns bodies, joints and springs.
pub fn fill(world: &mut World, stage: &Stage, method: Method) -> Vec<Entity> {
    let bodies: Vec<Entity> = stage.parts.iter().map(|p| spawn(world, p)).collect();
    for joint in &stage.joints {
        join(world, joint, joint.ends.map(|end| bodies[end]));
    }
    for link in &stage.links {
        let inverse = link.ends.map(|end| stage.parts[end].inverse_mass());
        let ends = link.ends.map(|end| bodies[end]);
        spring(world, link, ends, inverse[0] + inverse[1], method);
    }
    bodies
}

fn spawn(world: &mut World, part: &Part) -> Entity {
    let body = match part.motion {
        Motion::Fixed => RigidBody::Static,
        Motion::Kinematic => RigidBody::Kinematic,
        Motion::Dynamic => RigidBody::Dynamic,
    };
    let mut entity = world.spawn((body, part.at));
    if part.motion == Motion::Dynamic {
        let mut locked = LockedAxes::new();
        if part.upright {
            locked = locked.lock_rotation_x().lock_rotation_y().lock_rotation_z();
        }
        if part.planar {
            locked = locked.lock_translation_z();
        }
        entity.insert((
            Mass(part.mass),
            AngularInertia::new(part.inertia()),
            LinearVelocity(part.velocity),
            AngularVelocity(part.spin),
            locked,
            SleepingDisabled,
        ));
    }
    if let Some(shape) = part.shape {
        let [member, collides] = part.groups;
        entity.insert((
            collider(shape),
            Friction::new(part.friction),
            CollisionLayers::from_bits(member, collides),
        ));
    }
    entity.id()
}

fn collider(shape: Shape) -> Collider {
    match shape {
        Shape::HalfSpace => Collider::half_space(Vec3::Y),
        Shape::Ball(radius) => Collider::sphere(radius),
        Shape::Cuboid(half) => Collider::cuboid(2.0 * half.x, 2.0 * half.y, 2.0 * half.z),
        Shape::Capsule(half, radius) => Collider::capsule(radius, 2.0 * half),
    }
}

fn join(world: &mut World, joint: &Joint, [a, b]: [Entity; 2]) {
    let [at_a, at_b] = joint.anchors;
    match joint.freedom {
        Freedom::Spherical => {
            let joint = SphericalJoint::new(a, b);
            world.spawn(joint.with_local_anchor1(at_a).with_local_anchor2(at_b));
        }
        Freedom::Revolute => {
            let joint = RevoluteJoint::new(a, b).with_hinge_axis(Vec3::Z);
            world.spawn(joint.with_local_anchor1(at_a).with_local_anchor2(at_b));
        }
        Freedom::Slider => {
            let joint = PrismaticJoint::new(a, b).with_slider_axis(Vec3::Y);
            world.spawn(joint.with_local_anchor1(at_a).with_local_anchor2(at_b));
        }
        // Avian has no such joint: `has` leaves these stages out.
        Freedom::Guide => {}
    }
}
