//! Snapshot scenes with springs on bodies that contacts and joints hold.

use super::film::*;
use super::scenes::coil;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Weights on well damped springs: in the air, in a network, and above a foot on the ground. At tick 600 one of each is pushed.
pub fn resting(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    film.ground();
    for i in 0..2 {
        let at = Vec3::new(0.0, 3.0, 3.0 * i as f32);
        let hook = film.point(at);
        let weight = film.brick(1.0, at - 0.5 * Vec3::Y);
        film.spawn(coil(hook, weight, 80.0, 18.0).with_rest_length(0.4));
        let second = film.brick(0.5, at - 1.0 * Vec3::Y);
        if i > 0 {
            film.spawn(coil(weight, second, 80.0, 10.0).with_rest_length(0.4));
        } else {
            film.spawn(coil(hook, second, 80.0, 12.0).with_rest_length(0.9));
        }
    }
    let foot = film.solid(
        Vec3::new(3.0, 0.1, 0.0),
        Collider::cuboid(0.2, 0.1, 0.2),
        2.0,
    );
    let load = film.solid(
        Vec3::new(3.0, 0.8, 0.0),
        Collider::cuboid(0.1, 0.1, 0.1),
        3.0,
    );
    let guide = GenericJointBuilder::new(JointAxesMask::LOCKED_PRISMATIC_AXES)
        .local_axis1(Vec3::Y)
        .local_axis2(Vec3::Y);
    film.insert(
        load,
        ImpulseJoint::new(foot, TypedJoint::GenericJoint(guide.build())),
    );
    film.spawn(coil(foot, load, 900.0, 60.0).with_rest_length(0.7));
    film.deed = |film| {
        if film.tick == 600 {
            for body in [2, 7, 12] {
                let body = film.cast[body];
                if let Some(mut velocity) = film.lab.app.world_mut().get_mut::<Velocity>(body) {
                    velocity.linear.y += 0.5;
                }
            }
        }
    };
    film
}

/// Loads on springs above feet that drop on the ground, bounce, come to rest and fall asleep.
pub fn feet(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    film.ground();
    for (i, stiffness) in [300.0, 4e3, 4e4].into_iter().enumerate() {
        let x = 2.0 * i as f32;
        let foot = film.solid(Vec3::new(x, 0.3, 0.0), Collider::cuboid(0.2, 0.1, 0.2), 2.0);
        let load = film.solid(Vec3::new(x, 1.0, 0.0), Collider::cuboid(0.1, 0.1, 0.1), 5.0);
        let guide = GenericJointBuilder::new(JointAxesMask::LOCKED_PRISMATIC_AXES)
            .local_axis1(Vec3::Y)
            .local_axis2(Vec3::Y);
        film.insert(
            load,
            ImpulseJoint::new(foot, TypedJoint::GenericJoint(guide.build())),
        );
        film.spawn(coil(foot, load, stiffness, 0.1 * stiffness.sqrt()).with_rest_length(0.7));
    }
    for x in [0.1, 0.0, -0.2] {
        film.solid(Vec3::new(6.0 + x, 1.0 + x, 0.0), Collider::ball(0.2), 1.0);
    }
    let [a, b] = [film.cast[10], film.cast[11]];
    film.spawn(coil(a, b, 200.0, 1.0));
    film
}

/// A ball that falls on a cloth of points.
pub fn cloth(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    const SIDE: usize = 7;
    let mut points = Vec::new();
    for i in 0..SIDE * SIDE {
        let (x, z) = (i % SIDE, i / SIDE);
        let at = 0.2 * Vec3::new(x as f32 - 3.0, 5.0, z as f32 - 3.0);
        let rim = x == 0 || z == 0 || x == SIDE - 1 || z == SIDE - 1;
        points.push(if rim {
            film.spawn((RigidBody::Fixed, Transform::from_translation(at)))
        } else {
            let point = film.solid(at, Collider::ball(0.06), 0.05);
            film.insert(
                point,
                (
                    LockedAxes::ROTATION_LOCKED,
                    CollisionGroups::new(Group::GROUP_1, Group::GROUP_2),
                ),
            );
            point
        });
    }
    for i in 0..SIDE * SIDE {
        for (fits, j) in [
            (i % SIDE + 1 < SIDE, i + 1),
            (i / SIDE + 1 < SIDE, i + SIDE),
        ] {
            if fits {
                film.spawn(coil(points[i], points[j], 900.0, 0.5).with_rest_length(0.18));
            }
        }
    }
    let ball = film.solid(Vec3::new(0.05, 3.0, 0.1), Collider::ball(0.3), 1.0);
    film.insert(ball, CollisionGroups::new(Group::GROUP_2, Group::ALL));
    film
}

/// Chains of ropes, buffers and stops that fall on the ground.
pub fn ropes(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    film.ground();
    for row in 0..3 {
        let z = 1.0 * row as f32;
        let mut last = film.point(Vec3::new(0.0, 1.2, z));
        for i in 1..=8 {
            let next = film.solid(Vec3::new(0.2 * i as f32, 1.2, z), Collider::ball(0.05), 0.1);
            let link = film.spawn(coil(last, next, 2e3, 0.5).with_rest_length(0.2));
            match row {
                0 => film.insert(link, SpringAction::Pull),
                1 => film.insert(link, SpringTravel::new(0.15, 0.22, 2e3)),
                _ => film.insert(link, (SpringAction::Push, Preload(-1.0))),
            }
            last = next;
        }
    }
    film
}

/// Doors and a lamp on hinges, with springs, dampers and torsion bars.
pub fn hinges(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    for i in 0..3 {
        let at = Vec3::X * (3.0 * i as f32);
        let frame = film.spawn((RigidBody::Fixed, Transform::from_translation(at)));
        let arm = film.brick(2.0, at + Vec3::X * 0.5);
        let hinge = RevoluteJointBuilder::new(Vec3::Z).local_anchor2(Vec3::NEG_X * 0.5);
        film.insert(arm, ImpulseJoint::new(frame, hinge));
        let hook = film.point(at + Vec3::new(0.8, 1.0, 0.0));
        film.spawn((
            coil(hook, arm, 80.0, 0.4).with_rest_length(0.9),
            Anchors::new(Vec3::ZERO, Vec3::X * 0.4),
        ));
        if i > 0 {
            film.spawn(TorsionSpringDamper::new(frame, arm, Vec3::Z).with_stiffness(5.0));
        }
        if i > 1 {
            film.spawn((
                Damper::new(frame, arm).with_damping(3.0),
                Anchors::new(Vec3::Y * 0.5, Vec3::X * 0.3),
            ));
        }
    }
    film
}

/// A chain of multibody links with a spring from its root to its end, beside a free pendulum.
pub fn multibody(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    let root = film.spawn((RigidBody::Fixed, Transform::default()));
    let mut last = root;
    for i in 0..3 {
        let link = film.brick(1.0, Vec3::X * (i as f32 + 0.5));
        let before = if i == 0 { Vec3::ZERO } else { Vec3::X * 0.5 };
        let joint = RevoluteJointBuilder::new(Vec3::Z)
            .local_anchor1(before)
            .local_anchor2(Vec3::NEG_X * 0.5)
            .build();
        film.insert(
            link,
            MultibodyJoint::new(last, TypedJoint::RevoluteJoint(joint)),
        );
        last = link;
    }
    film.spawn((
        coil(root, last, 60.0, 0.3),
        Anchors::new(Vec3::Y, Vec3::ZERO),
    ));
    let hook = film.point(Vec3::Z * 3.0);
    let weight = film.brick(1.0, Vec3::new(1.0, 0.0, 3.0));
    film.spawn(coil(hook, weight, 90.0, 0.1));
    film
}

/// A rolling car with an arm on a hinge behind it.
pub fn car(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    film.ground();
    let (radius, rest) = (0.33, 0.5);
    let speed = Velocity::linear(Vec3::X * 8.0);
    let chassis = film.solid(
        Vec3::Y * (radius + rest),
        Collider::cuboid(1.6, 0.15, 0.6),
        1200.0,
    );
    let groups = |own, other| CollisionGroups::new(own, other);
    film.insert(chassis, (speed, groups(Group::GROUP_2, Group::GROUP_1)));
    let ground = film.cast[0];
    film.insert(ground, groups(Group::GROUP_1, Group::GROUP_2));
    for (x, z) in [(1.3, 0.75), (1.3, -0.75), (-1.3, 0.75), (-1.3, -0.75)] {
        let corner = Vec3::new(x, 0.0, z);
        let guide = GenericJointBuilder::new(
            JointAxesMask::LIN_X
                | JointAxesMask::LIN_Z
                | JointAxesMask::ANG_X
                | JointAxesMask::ANG_Y,
        )
        .local_anchor1(corner);
        let wheel = film.solid(corner + Vec3::Y * radius, Collider::ball(radius), 20.0);
        film.insert(
            wheel,
            (
                groups(Group::GROUP_2, Group::GROUP_1),
                Velocity {
                    angular: Vec3::NEG_Z * 8.0 / radius,
                    ..speed
                },
                ImpulseJoint::new(chassis, TypedJoint::GenericJoint(guide.build())),
            ),
        );
        film.spawn((
            coil(chassis, wheel, 30e3, 2e3).with_rest_length(rest),
            Anchors::new(corner, Vec3::ZERO),
        ));
    }
    let arm = film.brick(30.0, Vec3::new(-2.1, radius + rest, 0.0));
    let hinge = RevoluteJointBuilder::new(Vec3::Z)
        .local_anchor1(Vec3::NEG_X * 1.6)
        .local_anchor2(Vec3::X * 0.5);
    film.insert(arm, (speed, ImpulseJoint::new(chassis, hinge)));
    film.spawn((
        coil(chassis, arm, 4e3, 50.0),
        Anchors::new(Vec3::new(-1.6, 0.5, 0.0), Vec3::ZERO),
    ));
    // A step in the road, which the car meets after the snapshot.
    let step = (
        RigidBody::Fixed,
        Collider::cuboid(0.5, 0.04, 2.0),
        Transform::from_xyz(40.0, 0.0, 0.0),
    );
    film.spawn((step, groups(Group::GROUP_1, Group::GROUP_2)));
    film
}

/// Two springs whose rest length the game drives: one presses a box against a wall, the other lifts a weight.
pub fn actuator(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    let rail = LockedAxes::ROTATION_LOCKED
        | LockedAxes::TRANSLATION_LOCKED_Y
        | LockedAxes::TRANSLATION_LOCKED_Z;
    let hand = film.spawn((RigidBody::Fixed, Transform::default()));
    let load = film.solid(Vec3::X, Collider::cuboid(0.1, 0.1, 0.1), 5.0);
    film.insert(load, rail);
    let press = film.spawn(coil(hand, load, 4e3, 60.0).with_rest_length(1.0));
    film.spawn((
        RigidBody::Fixed,
        Collider::cuboid(0.1, 1.0, 1.0),
        Transform::from_xyz(1.25, 0.0, 0.0),
    ));
    let crane = film.point(Vec3::new(4.0, 3.0, 0.0));
    let weight = film.brick(2.0, Vec3::new(4.0, 2.0, 0.0));
    let rope = film.spawn((
        coil(crane, weight, 300.0, 5.0).with_rest_length(1.0),
        SpringAction::Pull,
    ));
    assert_eq!([press, rope], [film.cast[2], film.cast[6]]);
    film.deed = |film| {
        let t = film.tick as f32 * DT;
        let [press, rope] = [film.cast[2], film.cast[6]];
        film.lab.get_mut::<SpringDamper>(press).rest_length = Some(1.0 + 0.2 * (3.0 * t).sin());
        film.lab.get_mut::<SpringDamper>(rope).rest_length = Some(1.0 + 0.3 * (2.0 * t).sin());
    };
    film
}

/// A board on four threads, one of which breaks before the snapshot.
pub fn breaking(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    film.ground();
    let board = film.solid(Vec3::Y * 1.5, Collider::cuboid(0.5, 0.05, 0.5), 4.0);
    for (i, most) in [15.0, 1e3, 1e3, 1e3].into_iter().enumerate() {
        let corner = 0.5 * Vec3::new([1.0, 1.0, -1.0, -1.0][i], 0.0, [1.0, -1.0, 1.0, -1.0][i]);
        let hook = film.point(corner + Vec3::Y * 2.5);
        film.spawn((
            coil(hook, board, 200.0, 1.0).with_rest_length(0.9),
            Anchors::new(Vec3::ZERO, corner),
            Breakable::at_force(most),
        ));
    }
    film
}

/// Weights and a box on the ground, each on a spring from a hook. The game disables one of each before the snapshot and enables
/// it later, and disables another weight only later.
pub fn disabled(plugin: CoiloverPlugin) -> Film {
    let mut film = Film::new(plugin);
    film.ground();
    for x in [0.0, 3.0] {
        let hook = film.point(Vec3::new(x, 2.0, 0.0));
        let weight = film.brick(1.0, Vec3::new(x + 1.0, 2.0, 0.3));
        film.spawn(coil(hook, weight, 30.0, 0.1));
    }
    let hook = film.point(Vec3::new(6.0, 1.0, 0.0));
    let block = Collider::cuboid(0.2, 0.2, 0.2);
    let block = film.solid(Vec3::new(6.0, 0.2, 0.3), block, 2.0);
    film.spawn(coil(hook, block, 40.0, 0.5).with_rest_length(0.5));
    film.deed = |film| {
        let [first, second, block] = [film.cast[2], film.cast[5], film.cast[8]];
        match film.tick {
            100 => {
                film.insert(first, RigidBodyDisabled);
                film.insert(block, RigidBodyDisabled);
            }
            230 => {
                for body in [first, block] {
                    let world = film.lab.app.world_mut();
                    world.entity_mut(body).remove::<RigidBodyDisabled>();
                }
            }
            300 => film.insert(second, RigidBodyDisabled),
            _ => {}
        }
    };
    film
}
