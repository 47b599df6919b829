//! Ropes, which only pull, and buffers, which only push.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

#[test]
fn a_bungee_is_a_free_fall_while_slack_and_loses_nothing_when_it_goes_taut() {
    let mut lab = Lab::new();
    let bridge = lab.point(Vec3::ZERO);
    let jumper = lab.body(70.0, Vec3::NEG_Y * 0.5);
    let rope = Spring::new(bridge, jumper)
        .with_stiffness(150.0)
        .with_rest_length(10.0);
    lab.spawn((rope, SpringAction::Pull));
    let energy = |lab: &Lab| {
        let (y, v) = (
            f64::from(lab.position(jumper).y),
            f64::from(lab.velocity(jumper).y),
        );
        let stretch = (-y - 10.0).max(0.0);
        70.0 * (GRAVITY * y + 0.5 * v * v) + 75.0 * stretch * stretch
    };
    // Energy is measured from the place where the jumper hangs at rest.
    let sag = 70.0 * GRAVITY / 150.0;
    let lowest = -70.0 * GRAVITY * (10.0 + sag) + 75.0 * sag * sag;
    let first = energy(&lab) - lowest;
    let (mut bounces, mut rising, mut worst, mut worst_fall) = (0, false, 0.0_f64, 0.0_f64);
    let mut last: Option<(f64, f64)> = None;
    for tick in 0.. {
        if bounces == 20 {
            break;
        }
        assert!(tick < 60_000, "{bounces} bounces only");
        lab.tick();
        let (y, v) = (
            f64::from(lab.position(jumper).y),
            f64::from(lab.velocity(jumper).y),
        );
        worst = worst.max(((energy(&lab) - lowest) / first - 1.0).abs());
        if let Some((before_y, before_v)) = last
            && before_y > -9.8
            && y > -9.8
        {
            let dt = lab.dt();
            let fallen = before_y + dt * before_v - 0.5 * GRAVITY * dt * dt;
            worst_fall = worst_fall.max((y - fallen).abs());
        }
        last = Some((y, v));
        bounces += usize::from(rising && v < 0.0);
        rising = v > 0.0;
    }
    println!(
        "bungee: energy within {worst:.1e} over {bounces} bounces (bar 5e-5); free flight of a step within \
         {worst_fall:.1e} m"
    );
    assert!(worst <= 5e-5, "{worst}");
    assert!(worst_fall < 5e-6, "{worst_fall}");
}

#[test]
fn a_buffer_pushes_and_lets_go() {
    let mut lab = Lab::weightless();
    let wall = lab.point(Vec3::ZERO);
    let cart = lab.moving(
        body(2.0, Vec3::X * 1.5),
        Velocity::linear(Vec3::NEG_X * 2.0),
    );
    let buffer = Spring::new(wall, cart)
        .with_stiffness(5000.0)
        .with_rest_length(1.0);
    lab.spawn((buffer, SpringAction::Push));
    lab.run(2.0);
    let speed = lab.velocity(cart).x;
    println!("buffer: a cart comes in at 2 m/s and leaves at {speed:.5} m/s");
    assert!((speed - 2.0).abs() < 2e-3, "{speed}");
}

/// A strut that only pushes, far beyond its limit at first. As it lets its cart go, its damper takes the excess before it brakes.
#[test]
fn a_strut_with_a_limit_and_a_damper_gives_a_cart_all_of_its_push() {
    let (stiffness, damping, most) = (1e4_f64, 300.0_f64, 50.0_f64);
    // Reference: ẍ = −clamp(k x + c ẋ, −50 N, 0) in steps of 10 µs.
    let (mut x, mut v) = (-0.2_f64, 0.0_f64);
    for _ in 0..50_000 {
        if x < 0.0 {
            v -= 1e-5 * (stiffness * x + damping * v).clamp(-most, 0.0);
        }
        x += 1e-5 * v;
    }
    for count in [1, 2] {
        let mut lab = Lab::weightless();
        let wall = lab.point(Vec3::ZERO);
        let cart = lab.body(1.0, Vec3::X * 0.8);
        let share = |whole: f64| (whole / f64::from(count)) as f32;
        for _ in 0..count {
            let strut = SpringDamper::new(wall, cart)
                .with_stiffness(share(stiffness))
                .with_damping(share(damping))
                .with_rest_length(1.0);
            lab.spawn((strut, SpringAction::Push, MaxForce(share(most))));
        }
        lab.run(0.5);
        let speed = f64::from(lab.velocity(cart).x);
        println!("{count} struts with a limit: a cart leaves at {speed:.3} m/s, by theory {v:.3}");
        // In the step that crosses the limit, c·dt/m is 5.
        assert!((speed / v - 1.0).abs() < 0.05, "{count}: {speed} of {v}");
    }
}

#[test]
fn a_slack_rope_with_a_damper_neither_brakes_nor_pushes() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.moving(body(1.0, Vec3::X), Velocity::linear(Vec3::X));
    let rope = SpringDamper::new(hook, body)
        .with_stiffness(100.0)
        .with_damping(50.0)
        .with_rest_length(2.0);
    let rope = lab.spawn((rope, SpringAction::Pull));
    lab.run(0.9);
    assert!((lab.velocity(body).x - 1.0).abs() < 1e-6);
    assert!((lab.position(body).x - 1.9).abs() < 1e-4);
    let mut least = f32::MAX;
    for _ in 0..lab.ticks(3.0) {
        lab.tick();
        least = least.min(lab.readout(rope).force());
    }
    assert!(least >= 0.0, "the rope pushed with {least} N");
    assert!(lab.velocity(body).x.abs() < 1.0);
}

#[test]
fn a_slack_rope_and_an_untouched_stop_do_not_brake_a_load_on_its_rail() {
    for stop in [false, true] {
        let mut lab = Lab::weightless();
        let rail = lab.spawn((RigidBody::Fixed, Transform::default()));
        let load = lab.moving(body(10.0, Vec3::X), Velocity::linear(Vec3::X * 5.0));
        let joint = ImpulseJoint::new(rail, PrismaticJointBuilder::new(Vec3::X));
        lab.app.world_mut().entity_mut(load).insert(joint);
        // Within damping · speed / stiffness, a quarter of a metre, spring and damper together would pull.
        let element = if stop {
            let travel = SpringTravel::new(0.0, 2.0, 1e4).with_stop_damping(500.0);
            lab.spawn((
                Spring::new(rail, load)
                    .with_stiffness(0.0)
                    .with_rest_length(1.0),
                travel,
            ))
        } else {
            let rope = SpringDamper::new(rail, load)
                .with_stiffness(1e4)
                .with_damping(500.0)
                .with_rest_length(2.0);
            lab.spawn((rope, SpringAction::Pull))
        };
        while lab.position(load).x + 5.0 * DT < 2.0 {
            lab.tick();
            let speed = lab.velocity(load).x;
            assert!((speed - 5.0).abs() < 1e-3, "stop {stop}: {speed} m/s of 5");
        }
        assert_eq!(lab.readout(element).method, SpringMethod::Engine);
        lab.run(0.5);
        let speed = lab.velocity(load).x;
        assert!(speed < 0.0, "it stops the load: {speed} m/s");
    }
}

#[test]
fn a_slack_rope_with_a_limit_does_not_brake_a_cart_on_its_rail() {
    let mut lab = Lab::weightless();
    let rail = lab.spawn((RigidBody::Fixed, Transform::default()));
    let cart = lab.moving(body(1.0, Vec3::X), Velocity::linear(Vec3::X));
    let joint = ImpulseJoint::new(rail, PrismaticJointBuilder::new(Vec3::X));
    lab.app.world_mut().entity_mut(cart).insert(joint);
    // Within damping · speed / stiffness, half a metre before it is taut, spring and damper together would pull.
    let rope = SpringDamper::new(rail, cart)
        .with_damping(50.0)
        .with_rest_length(2.0);
    let [pull, push] = [100.0, 10.0].map(|linear| Polynomial::new(linear, 0.0, 0.0));
    let law = SpringLaw::sided(pull, push);
    let rope = lab.spawn((rope, law, SpringAction::Pull, MaxForce(500.0)));
    lab.run(0.9);
    assert_eq!(lab.readout(rope).method, SpringMethod::Engine);
    let speed = lab.velocity(cart).x;
    assert!((speed - 1.0).abs() < 1e-3, "{speed} m/s of 1");
    let mut least = f32::MAX;
    for _ in 0..lab.ticks(3.0) {
        lab.tick();
        least = least.min(lab.readout(rope).force());
    }
    assert!(least >= 0.0, "the rope pushed with {least} N");
    let speed = lab.velocity(cart).x;
    assert!(speed.abs() < 0.5, "taut, it brakes: {speed} m/s");
}
