//! What a game does to bodies and elements beside the physics is neither lost nor misread: impulses, forces, moved bodies, locks.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A floor whose top is at y = 0.
fn floor(lab: &mut Lab) {
    lab.spawn((
        RigidBody::Fixed,
        Collider::cuboid(200.0, 1.0, 200.0),
        Transform::from_xyz(0.0, -1.0, 0.0),
    ));
}

#[test]
fn what_jumps_off_the_ground_keeps_its_spring_alive() {
    // A pogo stick: 50 kg on a foot of 5 kg that lies on the floor.
    let mut lab = Lab::new();
    floor(&mut lab);
    let foot = lab.spawn((body(5.0, Vec3::new(0.0, 0.2, 0.0)), Collider::ball(0.2)));
    let top = lab.body(50.0, Vec3::new(0.0, 1.1, 0.0));
    let spring = lab.spawn(
        SpringDamper::new(foot, top)
            .with_stiffness(5000.0)
            .with_damping(0.0)
            .with_rest_length(1.0),
    );
    lab.app
        .world_mut()
        .entity_mut(foot)
        .insert(LockedAxes::ROTATION_LOCKED);
    lab.run(1.0);
    lab.app.world_mut().entity_mut(top).insert(ExternalImpulse {
        impulse: Vec3::Y * 200.0,
        ..default()
    });
    // In flight the spring swings at √(k/m) with the effective mass m = 50·5/55 kg.
    let mut lengths = [f32::INFINITY, 0.0_f32];
    for i in 0..lab.ticks(0.7) {
        lab.tick();
        if i > 6 {
            let now = lab.readout(spring).length;
            lengths = [lengths[0].min(now), lengths[1].max(now)];
        }
    }
    println!(
        "after the jump the spring swings from {:.3} to {:.3} m",
        lengths[0], lengths[1]
    );
    assert!(lengths[1] - lengths[0] > 0.1, "{lengths:?}");
}

#[test]
fn a_users_force_that_turns_round_on_the_ground_acts_wherever_that_is() {
    let slide = |x: f32| {
        let mut lab = Lab::new();
        floor(&mut lab);
        let mut bodies = Vec::new();
        for i in 0..2 {
            let puck = (
                body(1.0, Vec3::new(x + i as f32, 0.2, 0.0)),
                Collider::ball(0.2),
                Friction::new(0.0),
                LockedAxes::ROTATION_LOCKED,
            );
            bodies.push(lab.spawn(puck));
        }
        let spring = lab.spawn(
            SpringDamper::new(bodies[0], bodies[1])
                .with_stiffness(200.0)
                .with_damping(1.0)
                .with_rest_length(1.0),
        );
        lab.run(0.5);
        let push = |lab: &mut Lab, x: f32| {
            lab.app
                .world_mut()
                .entity_mut(bodies[0])
                .insert(ExternalForce {
                    force: Vec3::X * x,
                    ..default()
                });
        };
        push(&mut lab, 20.0);
        lab.run(0.5);
        push(&mut lab, -20.0);
        let mut lengths = [f32::INFINITY, 0.0_f32];
        for _ in 0..lab.ticks(1.0) {
            lab.tick();
            let now = lab.readout(spring).length;
            lengths = [lengths[0].min(now), lengths[1].max(now)];
        }
        let momentum: f32 = bodies
            .iter()
            .map(|body| lab.get::<Velocity>(*body).linear.x)
            .sum();
        (momentum, lengths[1] - lengths[0])
    };
    // Momentum of both bodies: 20 N for half a second, then −20 N for one. Half of the force acts on the spring. It swings about
    // −5 cm for half a second, and then about +5 cm from 12.5 cm off. c/m = 1/s takes a seventh of that in half a period.
    for x in [0.0, 50.0, -50.0] {
        let (momentum, swing) = slide(x);
        println!(
            "pushed to and fro at x = {x} m: {momentum:.3} of -10 N s, the spring swings over {swing:.3} m"
        );
        assert!((momentum + 10.0).abs() < 0.2, "{x}: {momentum}");
        assert!((0.22..0.24).contains(&swing), "{x}: {swing}");
    }
}

#[test]
fn what_stands_on_the_ground_swings_the_same_at_any_height_when_gravity_changes() {
    // A weight of 1 kg on a spring of 400 N/m on a block of 20 kg starts 0.15 m above its rest. Gravity is halved after a second.
    let swing = |height: f32| {
        let mut lab = Lab::new();
        let up = |y: f32| Transform::from_xyz(0.0, height + y, 0.0);
        lab.spawn((
            RigidBody::Fixed,
            Collider::cuboid(50.0, 1.0, 50.0),
            up(-1.0),
        ));
        let block = lab.spawn((
            RigidBody::Dynamic,
            Collider::cuboid(0.5, 0.5, 0.5),
            ColliderMassProperties::Mass(20.0),
            up(0.5),
        ));
        let weight = lab.body(1.0, up(2.0 - 9.81 / 400.0 + 0.15).translation);
        lab.app
            .world_mut()
            .entity_mut(weight)
            .insert(LockedAxes::ROTATION_LOCKED | LockedAxes::TRANSLATION_LOCKED_X);
        lab.spawn(
            Spring::new(block, weight)
                .with_stiffness(400.0)
                .with_rest_length(1.5),
        );
        lab.run(1.0);
        lab.app
            .world_mut()
            .entity_mut(weight)
            .insert(GravityScale(0.5));
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for _ in 0..lab.ticks(1.0) {
            lab.tick();
            let y = lab.position(weight).y;
            range = [range[0].min(y), range[1].max(y)];
        }
        range[1] - range[0]
    };
    let swings = [0.0, -20.0, 50.0].map(swing);
    println!("gravity halved at heights 0, -20, 50 m: swings over {swings:.3?} m");
    for swing in swings {
        assert!((swing / swings[0] - 1.0).abs() < 0.02, "{swings:?}");
    }
    assert!(swings[0] > 0.25, "{swings:?}");
}

#[test]
fn a_lift_of_several_substeps_throws_nothing_into_the_air() {
    // bevy_rapier moves the lift by its whole way in the first substep. The load is pushed in that substep only.
    for (substeps, stiffness) in [(1, 20.0), (3, 0.0), (3, 400.0), (4, 20.0)] {
        let engine = Engine {
            substeps,
            ..default()
        };
        let mut lab = Lab::with(CoiloverPlugin::default(), engine);
        let lift = lab.spawn((
            RigidBody::KinematicPositionBased,
            Collider::cuboid(50.0, 0.5, 50.0),
            Transform::from_xyz(0.0, -0.5, 0.0),
        ));
        let boxes = [0.0, 3.0].map(|x| {
            lab.spawn((
                RigidBody::Dynamic,
                Collider::cuboid(0.5, 0.5, 0.5),
                ColliderMassProperties::Mass(20.0),
                Transform::from_xyz(x, 0.5, 0.0),
            ))
        });
        lab.spawn(
            Spring::new(boxes[0], boxes[1])
                .with_stiffness(stiffness)
                .with_rest_length(3.0),
        );
        for i in 1..=lab.ticks(3.0) {
            lab.get_mut::<Transform>(lift).translation.y = -0.5 + 0.5 * i as f32 * DT;
            lab.tick();
        }
        for body in boxes {
            // Even without springs the boxes hop by some centimetres with several substeps.
            let above = lab.position(body).y - 2.0;
            assert!(
                above.abs() < 0.4,
                "{substeps} substeps, {stiffness}: {above} m"
            );
        }
    }
}

#[test]
fn a_torsion_dampers_rate_and_moment_are_shown() {
    let mut lab = Lab::weightless();
    let wall = lab.spawn((RigidBody::Fixed, Transform::default()));
    let wheel = lab.moving(
        brick(1.0, Vec3::splat(20.0), Vec3::X),
        Velocity::angular(Vec3::Z * 3.0),
    );
    let damper = lab.spawn(TorsionDamper::new(wall, wheel, Vec3::Z).with_damping(0.4));
    lab.run(0.1);
    let seen = lab.readout(damper);
    let spin = lab.get::<Velocity>(wheel).angular.z;
    assert!((seen.rate - spin).abs() < 1e-4, "{} {spin}", seen.rate);
    assert!((seen.damper_force - 0.4 * spin).abs() < 1e-4);
    assert!((seen.dissipated_power - 0.4 * spin * spin).abs() < 1e-3);
}

#[test]
fn strong_torsion_dampers_brake_no_more_where_axes_are_locked_or_the_holder_turns() {
    // I = 0.2 kg m², k = 500 N m/rad, c = 6.5 N m s/rad: ζ = 0.33. The wheel starts at rest angle
    // with a spin relative to the hub.
    let (inertia, k, c) = (0.2_f64, 500.0, 6.5);
    let free = |relative: f64, t: f64| {
        let gamma = c / (2.0 * inertia);
        let omega = (k / inertia - gamma * gamma).sqrt();
        relative / omega * (-gamma * t).exp() * (omega * t).sin()
    };
    for (locked, spin, holder) in [(true, 1.0, 0.0), (false, 0.0, 2.0), (true, 0.0, 2.0)] {
        let mut lab = Lab::weightless();
        let hub = lab.moving(
            (RigidBody::KinematicVelocityBased, Transform::default()),
            Velocity::angular(Vec3::Z * holder),
        );
        let wheel = lab.moving(
            brick(1.0, Vec3::splat(inertia as f32), Vec3::X),
            Velocity::angular(Vec3::Z * spin),
        );
        if locked {
            lab.app
                .world_mut()
                .entity_mut(wheel)
                .insert(LockedAxes::ROTATION_LOCKED_X);
        }
        let element = lab.spawn(
            TorsionSpringDamper::new(hub, wheel, Vec3::Z)
                .with_stiffness(k as f32)
                .with_damping(c as f32)
                .with_rest_angle(0.0),
        );
        for i in 1..=12 {
            lab.tick();
            let wanted = free(f64::from(spin - holder), i as f64 * lab.dt());
            let twist = f64::from(lab.readout(element).length);
            assert!(
                (twist - wanted).abs() < 5e-4,
                "locked {locked}, holder {holder}, tick {i}: {twist} of {wanted} rad"
            );
        }
    }
}

#[test]
fn a_ball_that_is_put_on_the_other_side_of_its_hook_is_not_shot_away() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let ball = lab.body(1.0, Vec3::X);
    lab.spawn((
        SpringDamper::new(hook, ball)
            .with_stiffness(100.0)
            .with_rest_length(1.0),
        DampingLaw::sided(1.0, 2.0),
    ));
    lab.run(0.5);
    lab.get_mut::<Transform>(ball).translation = -Vec3::X;
    lab.run(0.5);
    let speed = lab.get::<Velocity>(ball).linear.length();
    assert!(speed < 1e-4, "{speed} m/s");
}

#[test]
fn turns_between_a_wall_and_a_crank_are_counted() {
    let mut lab = Lab::weightless();
    let wall = lab.spawn((RigidBody::Fixed, Transform::default()));
    let crank = lab.moving(
        (
            RigidBody::KinematicVelocityBased,
            Transform::from_xyz(1.0, 0.0, 0.0),
        ),
        Velocity::angular(Vec3::Z),
    );
    let element = lab.spawn(
        TorsionSpring::new(wall, crank, Vec3::Z)
            .with_stiffness(1.0)
            .with_rest_angle(0.0),
    );
    lab.run(10.0);
    let seen = lab.readout(element);
    assert!((seen.length - 10.0).abs() < 0.02, "{}", seen.length);
    assert!((seen.work - 50.0).abs() < 0.5, "{}", seen.work);
}

#[test]
fn a_spring_that_is_hooked_to_another_wheel_is_not_wound_any_more() {
    let mut lab = Lab::weightless();
    let wall = lab.spawn((RigidBody::Fixed, Transform::default()));
    let wheels = [1.0, 2.0].map(|x| lab.spawn(brick(1.0, Vec3::splat(0.2), Vec3::X * x)));
    lab.get_mut::<Velocity>(wheels[0]).angular = Vec3::Z * 20.0;
    let element = lab.spawn(
        TorsionSpring::new(wall, wheels[0], Vec3::Z)
            .with_stiffness(0.01)
            .with_rest_angle(0.0),
    );
    lab.run(1.0);
    assert!(lab.readout(element).length > 12.0);
    lab.get_mut::<TorsionSpring>(element).body_b = wheels[1];
    lab.run(0.5);
    assert!(lab.readout(element).length.abs() < 1e-3);
    assert!(lab.get::<Velocity>(wheels[1]).angular.length() < 1e-3);
}

#[test]
fn a_rest_length_that_is_found_anew_is_no_work() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let ball = lab.body(1.0, Vec3::X);
    let spring = lab.spawn(
        Spring::new(hook, ball)
            .with_stiffness(1000.0)
            .with_rest_length(1.0),
    );
    lab.run(0.2);
    lab.get_mut::<Spring>(spring).rest_length = None;
    lab.run(0.2);
    let seen = lab.readout(spring);
    assert!(seen.work.abs() < 1e-3, "{} J", seen.work);
}

#[test]
fn a_hook_that_is_put_elsewhere_has_done_work() {
    // The hook jumps by half a metre, with a lone spring and with two in a row.
    for springs in [1, 2] {
        let mut lab = Lab::weightless();
        let hook = lab.spawn((RigidBody::Fixed, Transform::default()));
        let mut last = hook;
        let mut first = None;
        for i in 1..=springs {
            let next = lab.body(1e4, Vec3::X * i as f32);
            let spring = Spring::new(last, next)
                .with_stiffness(100.0)
                .with_rest_length(1.0);
            let spring = lab.spawn(spring);
            first.get_or_insert(spring);
            last = next;
        }
        lab.run(0.2);
        lab.get_mut::<Transform>(hook).translation.x = -0.5;
        lab.run(0.2);
        let seen = first.map(|spring| lab.readout(spring).work);
        assert!(
            seen.is_some_and(|work| (work - 12.5).abs() < 0.01),
            "{springs}: {seen:?}"
        );
    }
}

#[test]
fn a_ball_on_a_faulty_spring_falls_although_its_neighbour_hangs_on_a_rope() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::ZERO);
    let [upper, lower] = [-1.0, -2.0].map(|y| lab.body(1.0, Vec3::Y * y));
    lab.spawn((
        SpringDamper::new(hook, upper)
            .with_stiffness(500.0)
            .with_rest_length(1.0),
        SpringAction::Pull,
    ));
    lab.spawn((
        Spring::new(upper, lower).with_rest_length(1.0),
        CustomSpringLaw::new(|_: f64| f64::NAN),
    ));
    lab.run(1.0);
    let fallen = -2.0 - lab.position(lower).y;
    assert!((fallen - 4.905).abs() < 0.1, "{fallen} m");
}
