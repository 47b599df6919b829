//! Does a body sleep only where it would really stay, and wake when it should?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A settled, sleeping weight on a damped spring. Returns hook, weight and element.
fn asleep(lab: &mut Lab) -> (Entity, Entity, Entity) {
    let hook = lab.point(Vec3::ZERO);
    let weight = lab.body(1.0, Vec3::NEG_Y);
    let element = lab.spawn(
        SpringDamper::new(hook, weight)
            .with_stiffness(100.0)
            .with_damping(15.0)
            .with_rest_length(0.9),
    );
    lab.run(6.0);
    assert!(lab.is_sleeping(weight), "a settled weight sleeps");
    let y = lab.position(weight).y;
    assert!(
        (y + 0.9 + 9.81 / 100.0).abs() < 5e-5,
        "and sleeps where it would stay: {y}"
    );
    (hook, weight, element)
}

#[test]
fn a_slow_swing_does_not_fall_asleep() {
    // 0.1 rad/s and at most 0.02 m/s. This is below the engine's own sleep threshold for more than half a second.
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X * 1.2);
    lab.spawn(
        Spring::new(hook, body)
            .with_stiffness(0.01)
            .with_rest_length(1.0),
    );
    for i in 1..=lab.ticks(70.0) {
        lab.tick();
        let t = i as f64 * f64::from(DT);
        let wanted = 1.0 + 0.2 * (0.1 * t).cos();
        let x = f64::from(lab.position(body).x);
        assert!(
            !lab.is_sleeping(body) && (x - wanted).abs() < 1e-4,
            "t {t}: {x} against {wanted}"
        );
    }
}

#[test]
fn without_the_plugins_care_the_engine_would_put_it_to_sleep() {
    // The test above proves something only if the engine alone would put this body to sleep.
    let mut lab = Lab::weightless();
    let body = lab.body(1.0, Vec3::ZERO);
    lab.get_mut::<Velocity>(body).linear = Vec3::X * 0.02;
    lab.run(5.0);
    assert!(lab.is_sleeping(body));
}

#[test]
fn a_settled_weight_sleeps_and_stays() {
    let mut lab = Lab::new();
    let (_, weight, _) = asleep(&mut lab);
    let at = lab.position(weight);
    lab.run(5.0);
    assert!(lab.is_sleeping(weight));
    assert_eq!(lab.position(weight), at);
}

#[test]
fn changing_an_element_wakes() {
    for change in 0..4 {
        let mut lab = Lab::new();
        let (hook, weight, element) = asleep(&mut lab);
        let before = lab.position(weight).y;
        match change {
            0 => lab.get_mut::<SpringDamper>(element).stiffness = 200.0,
            1 => lab.get_mut::<SpringDamper>(element).rest_length = Some(0.7),
            2 => {
                lab.app
                    .world_mut()
                    .entity_mut(element)
                    .insert(Anchors::new(Vec3::Y * 0.1, Vec3::ZERO));
            }
            _ => lab.get_mut::<Transform>(hook).translation.y = 0.1,
        }
        lab.run(0.1);
        assert!(!lab.is_sleeping(weight), "change {change}");
        assert!(
            (lab.position(weight).y - before).abs() > 1e-3,
            "change {change}"
        );
    }
}

#[test]
fn removing_an_element_wakes() {
    let mut lab = Lab::new();
    let (_, weight, element) = asleep(&mut lab);
    let before = lab.position(weight).y;
    lab.app.world_mut().despawn(element);
    lab.run(0.5);
    assert!(before - lab.position(weight).y > 1.0, "it falls");
}

#[test]
fn adding_an_element_wakes() {
    let mut lab = Lab::new();
    let (hook, weight, _) = asleep(&mut lab);
    let before = lab.position(weight).y;
    lab.spawn(
        Spring::new(hook, weight)
            .with_stiffness(100.0)
            .with_rest_length(0.5),
    );
    lab.run(0.2);
    assert!(lab.position(weight).y > before + 0.05);
}

#[test]
fn moving_one_body_wakes_the_other() {
    let mut lab = Lab::weightless();
    let a = lab.body(1.0, Vec3::ZERO);
    let b = lab.body(1.0, Vec3::X);
    lab.spawn(
        SpringDamper::new(a, b)
            .with_stiffness(50.0)
            .with_damping(5.0)
            .with_rest_length(1.0),
    );
    lab.run(3.0);
    assert!(lab.is_sleeping(a) && lab.is_sleeping(b));
    lab.get_mut::<Transform>(a).translation.x = -0.5;
    lab.run(0.2);
    assert!(!lab.is_sleeping(b));
    assert!(
        lab.position(b).x < 0.95,
        "it is pulled along: {}",
        lab.position(b).x
    );
    // The pair keeps its centre of mass: neither body was treated as fixed for a tick.
    let center = 0.5 * (lab.position(a).x + lab.position(b).x);
    assert!((center - 0.25).abs() < 1e-5, "{center}");
}

#[test]
fn a_long_pendulum_on_a_stiff_spring_does_not_fall_asleep_at_its_turning_point() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::ZERO);
    let (k, length) = (1e5_f32, 10.0_f32);
    let bob = lab.body(1.0, Vec3::new(0.002, -length - 9.81 / k, 0.0));
    lab.spawn(
        Spring::new(hook, bob)
            .with_stiffness(k)
            .with_rest_length(length),
    );
    let mut least = 0.0_f32;
    for _ in 0..lab.ticks(30.0) {
        lab.tick();
        assert!(!lab.is_sleeping(bob));
        least = least.min(lab.position(bob).x);
    }
    assert!(least < -1.9e-3, "it swings: {least}");
}

#[test]
fn a_pair_that_drifts_far_from_the_origin_does_not_fall_asleep() {
    for (at, k, speed) in [(10.0, 1e6, 0.003), (100.0, 1e4, 0.003), (1000.0, 1e4, 0.03)] {
        let mut lab = Lab::weightless();
        let pair = [0.0, 1.0].map(|x| lab.body(1.0, Vec3::X * (at + x)));
        for body in pair {
            lab.get_mut::<Velocity>(body).linear = Vec3::Y * speed;
        }
        lab.spawn(
            Spring::new(pair[0], pair[1])
                .with_stiffness(k)
                .with_rest_length(1.0),
        );
        lab.run(20.0);
        let y = lab.position(pair[0]).y;
        assert!((y / (20.0 * speed) - 1.0).abs() < 1e-2, "at {at} m: {y}");
    }
}

#[test]
fn moving_what_holds_it_or_where_it_is_held_wakes() {
    for change in 0..4 {
        let mut lab = Lab::new();
        let hook = lab.spawn((RigidBody::Fixed, Transform::default()));
        let weight = lab.spawn((
            RigidBody::Dynamic,
            Collider::ball(0.1),
            ColliderMassProperties::Mass(1.0),
            Transform::from_xyz(0.0, -1.0, 0.0),
            Velocity::default(),
            Sleeping::default(),
        ));
        let lug = lab.spawn(Transform::default());
        let eye = lab.spawn((Transform::default(), ChildOf(weight)));
        let a = if change == 1 { lug } else { hook };
        let b = if change == 2 { eye } else { weight };
        lab.spawn(
            SpringDamper::new(a, b)
                .with_stiffness(100.0)
                .with_damping(15.0)
                .with_rest_length(0.9),
        );
        lab.run(10.0);
        assert!(lab.is_sleeping(weight), "change {change}");
        let before = lab.position(weight).y;
        match change {
            0 => lab.get_mut::<Transform>(hook).translation.y = 0.3,
            1 => lab.get_mut::<Transform>(lug).translation.y = 0.3,
            2 => lab.get_mut::<Transform>(eye).translation.y = 0.05,
            _ => {
                lab.app
                    .world_mut()
                    .entity_mut(weight)
                    .insert(ColliderMassProperties::Mass(3.0));
            }
        }
        lab.run(0.5);
        let moved = (lab.position(weight).y - before).abs();
        assert!(moved > 0.02, "change {change}: {moved}");
    }
}
