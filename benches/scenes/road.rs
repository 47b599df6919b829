//! Cars on a road, held by contacts and joints.

use super::Link;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const RADIUS: f32 = 0.3;
const REST: f32 = 0.5;

/// Spawns `count` cars of five bodies on four springs, which roll or stand.
pub fn cars(world: &mut World, count: u32, link: Link, speed: f32) {
    let mut configurations = world.query::<&mut RapierConfiguration>();
    for mut configuration in configurations.iter_mut(world) {
        configuration.gravity = Vec3::NEG_Y * 9.81;
    }
    if let Some(plane) = Collider::halfspace(Vec3::Y) {
        world.spawn((plane, Transform::default()));
    }
    for i in 0..count {
        let at = Vec3::new((i % 30) as f32 * 6.0, 0.0, (i / 30) as f32 * 4.0);
        car(world, at, link, speed);
    }
}

fn car(world: &mut World, at: Vec3, link: Link, speed: f32) {
    let velocity = Velocity::linear(Vec3::X * speed);
    // At ride height.
    let height = RADIUS + REST - 1200.0 * 9.81 / 4.0 / 40e3;
    let chassis = world.spawn((
        RigidBody::Dynamic,
        Transform::from_translation(at + Vec3::Y * height),
        Collider::cuboid(1.6, 0.1, 0.6),
        ColliderMassProperties::Mass(1200.0),
        velocity,
    ));
    let chassis = chassis.id();
    for (x, z) in [(1.3, 0.75), (1.3, -0.75), (-1.3, 0.75), (-1.3, -0.75)] {
        let corner = Vec3::new(x, 0.0, z);
        let mut locks = JointAxesMask::LIN_X
            | JointAxesMask::LIN_Z
            | JointAxesMask::ANG_X
            | JointAxesMask::ANG_Y;
        if speed == 0.0 {
            locks |= JointAxesMask::ANG_Z;
        }
        let guide = GenericJointBuilder::new(locks).local_anchor1(corner);
        let wheel = world.spawn((
            RigidBody::Dynamic,
            Transform::from_translation(at + corner + Vec3::Y * RADIUS),
            Collider::ball(RADIUS),
            ColliderMassProperties::Mass(20.0),
            Friction::new(1.0),
            Velocity {
                angular: Vec3::NEG_Z * speed / RADIUS,
                ..velocity
            },
            ImpulseJoint::new(chassis, TypedJoint::GenericJoint(guide.build())),
        ));
        let wheel = wheel.id();
        let (stiffness, damping) = (40e3, 3e3);
        if let Link::Ours = link {
            world.spawn((
                SpringDamper::new(chassis, wheel)
                    .with_stiffness(stiffness)
                    .with_damping(damping)
                    .with_rest_length(REST),
                Anchors::new(corner, Vec3::ZERO),
            ));
        } else {
            let spring = SpringJointBuilder::new(REST, stiffness, damping).local_anchor1(corner);
            world.spawn((ImpulseJoint::new(chassis, spring), ChildOf(wheel)));
        }
    }
}
