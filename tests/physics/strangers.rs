//! Does the motion of an element depend only on the bodies that it is connected to?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

#[test]
fn a_spring_that_turns_its_body_leaves_the_bodies_next_to_it_in_memory_alone() {
    let motion = |turned: bool| {
        let mut lab = Lab::weightless();
        let wall = lab.spawn((RigidBody::Fixed, Transform::from_xyz(50.0, 0.0, 0.0)));
        let before = lab.body(1.0, Vec3::X * 40.0);
        let moments = Vec3::new(0.1, 0.2, 0.3);
        let pair = [0.0, 1.3].map(|x| lab.spawn(brick(1.0, moments, Vec3::X * x)));
        let after = lab.body(1.0, Vec3::X * 60.0);
        for body in pair {
            lab.get_mut::<Velocity>(body).angular = Vec3::new(0.1, 5.0, 0.1);
        }
        lab.spawn(Spring::new(pair[0], pair[1]).with_stiffness(40.0));
        for stranger in [before, after] {
            let off = if turned { Vec3::Y } else { Vec3::ZERO };
            let spring = Spring::new(wall, stranger).with_stiffness(10.0);
            lab.spawn((spring, Anchors::new(Vec3::ZERO, off)));
        }
        lab.run(2.0);
        let torques = pair.map(|body| lab.get::<SpringLoad>(body).elements.torque);
        assert_eq!(torques, [Vec3::ZERO; 2], "a central spring turns nothing");
        pair.map(|body| (lab.position(body), lab.get::<Velocity>(body).angular))
    };
    assert_eq!(motion(false), motion(true));
}

#[test]
fn a_spring_that_nobody_reads_out_stands_on_the_ground_as_one_that_is_read() {
    let motion = |is_read: bool| {
        let mut lab = Lab::new();
        let ground = Collider::cuboid(5.0, 0.5, 5.0);
        lab.spawn((
            RigidBody::Fixed,
            ground,
            Transform::from_xyz(0.0, -0.5, 0.0),
        ));
        let ball = lab.body(1.0, Vec3::Y * 0.6);
        let round = (Collider::ball(0.1), ColliderMassProperties::Mass(0.0));
        lab.app.world_mut().entity_mut(ball).insert(round);
        let roof = lab.body(5.0, Vec3::Y * 1.6);
        let spring = SpringDamper::new(roof, ball)
            .with_stiffness(5000.0)
            .with_damping(5.0)
            .with_rest_length(1.0);
        let spring = lab.spawn(spring);
        if !is_read {
            let mut spring = lab.app.world_mut().entity_mut(spring);
            spring.remove::<SpringReadout>();
        }
        let ticks = 0..180;
        ticks
            .map(|_| {
                lab.tick();
                lab.position(roof)
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(motion(true), motion(false));
}
