//! A car on four wheels that is pushed down.

use super::{Endurance, GRAVITY, body, lab};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::collections::BTreeMap;

/// Radius of a wheel, m.
const RADIUS: f32 = 0.33;
/// Rest length of a coilover, m.
const REST: f32 = 0.5;
/// Half extents of the chassis, m.
const HALF: Vec3 = Vec3::new(1.6, 0.15, 0.6);
/// Mass of the chassis, kg.
const CHASSIS: f32 = 1200.0;
/// Mass of a wheel, kg.
const WHEEL: f32 = 20.0;
/// Stiffness in N/m and damping in N s/m of each coilover: 1.4 Hz, a third of critical.
const STIFFNESS: f32 = 23e3;
const DAMPING: f32 = 1750.0;

/// A chassis of 1 200 kg on four wheels that joints guide. Its sag has to be that of statics.
pub fn car() -> Endurance {
    let mut app = lab(GRAVITY);
    let world = app.world_mut();
    let road = Collider::cuboid(50.0, 1.0, 50.0);
    world.spawn((
        RigidBody::Fixed,
        road,
        CollisionGroups::new(Group::GROUP_1, Group::GROUP_2),
        Friction::new(1.0),
        Transform::from_xyz(0.0, -1.0, 0.0),
    ));
    let squares = HALF * HALF;
    let sums = Vec3::new(
        squares.y + squares.z,
        squares.z + squares.x,
        squares.x + squares.y,
    );
    let ball = 0.4 * WHEEL * RADIUS * RADIUS;
    let mut masses = vec![(CHASSIS, CHASSIS / 3.0 * sums)];
    masses.extend([(WHEEL, Vec3::splat(ball)); 4]);
    let chassis = world
        .spawn((
            body(Vec3::Y * (RADIUS + REST), masses[0]),
            Collider::cuboid(HALF.x, HALF.y, HALF.z),
            ColliderMassProperties::Density(0.0),
            CollisionGroups::new(Group::GROUP_2, Group::GROUP_1),
        ))
        .id();
    let (mut bodies, mut springs) = (vec![chassis], Vec::new());
    for (x, z) in [(1.3, 0.75), (1.3, -0.75), (-1.3, 0.75), (-1.3, -0.75)] {
        let corner = Vec3::new(x, 0.0, z);
        let free = JointAxesMask::LIN_X
            | JointAxesMask::LIN_Z
            | JointAxesMask::ANG_X
            | JointAxesMask::ANG_Y;
        let guide = GenericJointBuilder::new(free).local_anchor1(corner).build();
        let wheel = world
            .spawn((
                body(corner + Vec3::Y * RADIUS, masses[1]),
                Collider::ball(RADIUS),
                ColliderMassProperties::Density(0.0),
                CollisionGroups::new(Group::GROUP_2, Group::GROUP_1),
                Friction::new(1.0),
                ImpulseJoint::new(chassis, TypedJoint::GenericJoint(guide)),
            ))
            .id();
        let coilover = SpringDamper::new(chassis, wheel)
            .with_stiffness(STIFFNESS)
            .with_damping(DAMPING)
            .with_rest_length(REST);
        bodies.push(wheel);
        springs.push(
            world
                .spawn((coilover, Anchors::new(corner, Vec3::ZERO)))
                .id(),
        );
    }
    Endurance {
        title: "car",
        app,
        bodies,
        masses,
        springs,
        gravity: GRAVITY,
        period: 10.0,
        strike: |scene, strike| {
            let corner = strike % 4;
            let chassis = scene.bodies[0];
            scene.push(chassis, Vec3::NEG_Y * 0.8);
            if let Some(mut velocity) = scene.app.world_mut().get_mut::<Velocity>(chassis) {
                velocity.angular += Quat::from_rotation_y(corner as f32) * Vec3::X * 0.3;
            }
        },
        stands: |scene| {
            // Expected height: wheel radius and rest length less the sag under the chassis. The error is a share of the sag.
            let sag = CHASSIS * GRAVITY / (4.0 * STIFFNESS);
            let place = scene.place(scene.bodies[0]);
            let height = (place.y - (RADIUS + REST - sag)).abs() / sag;
            (f64::from(height), 0.03)
        },
        strikes: 0,
        // The contacts of the wheels dissipate energy as well. They may not give any, but Rapier lifts what has sunk into
        // the road a little.
        missing: None,
        surplus: 0.05,
        // With a third of critical at 1.4 Hz, a swing falls to a part in 10¹² in ten seconds. So this allows only for the
        // trembling of contacts.
        rests: 0.02,
        faults: BTreeMap::new(),
    }
}
