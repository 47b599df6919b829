//! Springs on links of Rapier's multibodies.

use super::stand::Stand;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f64::consts::PI;

/// An arm of 0.8 kg along X, a multibody link on a hinge about Z at its end. Its centre is 0.275 m from the hinge.
fn arm(scene: &mut Stand, post: Entity) -> Entity {
    let hinge = RevoluteJointBuilder::new(Vec3::Z).local_anchor2(Vec3::NEG_X * 0.275);
    let mass = MassProperties {
        mass: 0.8,
        principal_inertia: Vec3::new(1e-4, 0.02, 0.02),
        ..default()
    };
    scene.body(
        Transform::from_xyz(0.275, 0.0, 0.0),
        (
            AdditionalMassProperties::MassProperties(mass),
            MultibodyJoint::new(post, TypedJoint::from(hinge)),
        ),
    )
}

fn post(scene: &mut Stand) -> Entity {
    scene.lab.spawn((RigidBody::Fixed, Transform::default()))
}

/// Holds the arm by a stiff spring from the post in the direction `up`, and compares its force with that of statics.
fn holds(name: &str, up: Vec3, companion: impl Bundle) {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    let post = post(&mut scene);
    let arm = arm(&mut scene, post);
    let at = Vec3::X * 0.1;
    let ends = [at + up, at - Vec3::X * 0.275];
    let element = scene.coil([post, arm], ends, [200e3, 500.0], None);
    let mut entity = scene.lab.app.world_mut().entity_mut(element);
    entity.insert(companion);
    scene.lab.run(10.0);
    let force = f64::from(scene.lab.readout(element).force());
    let lever = 0.1 * f64::from(up.normalize().y);
    let wanted = 0.8 * GRAVITY * 0.275 / lever;
    println!("{name}: {force} N of {wanted}");
    assert!(
        (force / wanted - 1.0).abs() < 0.02,
        "{name}: {force} N of {wanted}"
    );
}

#[test]
fn a_spring_holds_a_link_in_any_direction() {
    for up in [Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::new(-0.5, 1.0, 0.3)] {
        holds("from end to end", 0.2 * up, ());
    }
    holds(
        "along the world",
        0.2 * Vec3::Y,
        SpringAxis::World(Vec3::NEG_Y),
    );
    holds(
        "along the post",
        0.2 * Vec3::Y,
        SpringAxis::BodyA(Vec3::NEG_Y),
    );
}

#[test]
fn a_ball_that_hangs_on_a_heavy_link_keeps_time_and_energy() {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    let post = post(&mut scene);
    let slider = PrismaticJointBuilder::new(Vec3::X);
    let mass = MassProperties {
        mass: 5e3,
        principal_inertia: Vec3::splat(5e3),
        ..default()
    };
    let heavy = scene.body(
        Transform::IDENTITY,
        (
            AdditionalMassProperties::MassProperties(mass),
            MultibodyJoint::new(post, TypedJoint::from(slider)),
        ),
    );
    let ball = AdditionalMassProperties::Mass(1.0);
    let ball = scene.body(
        Transform::from_xyz(0.0, -0.5, 0.0),
        (ball, LockedAxes::ROTATION_LOCKED),
    );
    let omega = 15.0_f64;
    let k = (omega * omega) as f32;
    scene.coil([heavy, ball], [Vec3::ZERO; 2], [k, 0.0], Some(0.5));
    let middle = -0.5 - GRAVITY / (omega * omega);
    scene.lab.tick();
    let (first, height) = (scene.energy(), |scene: &Stand| {
        f64::from(scene.lab.position(ball).y)
    });
    let (mut before, mut count, mut off) = (height(&scene), 0, 0.0);
    let (mut most, mut least) = (f64::NEG_INFINITY, f64::INFINITY);
    for tick in 2..=scene.lab.ticks(10.0) {
        scene.lab.tick();
        let now = height(&scene);
        if (before - middle).signum() != (now - middle).signum() {
            let share = (middle - before) / (now - before);
            let time = (tick as f64 - 1.0 + share) / 60.0;
            count += 1;
            off = (f64::from(count) - 0.5) * PI / omega / time - 1.0;
        }
        before = now;
        most = most.max(scene.energy());
        least = least.min(scene.energy());
    }
    let scale = 0.5 * f64::from(k) * (GRAVITY / (omega * omega)).powi(2);
    let [won, lost] = [most - first, first - least].map(|energy| energy / scale);
    println!("frequency {off:.1e}, won {won:.3}, lost {lost:.3} of {scale} J");
    assert!(off.abs() < 2e-3, "{off}");
    assert!(won < 0.05 && lost < 0.05, "won {won}, lost {lost}");
}

#[test]
fn along_an_axis_of_the_world_a_link_and_a_body_that_moves_are_told_that_nothing_acts() {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    let post = post(&mut scene);
    let arm = arm(&mut scene, post);
    let ball = AdditionalMassProperties::Mass(1.0);
    let ball = scene.body(Transform::from_xyz(0.5, -1.0, 0.0), ball);
    let element = scene.coil([arm, ball], [Vec3::ZERO; 2], [100.0, 1.0], Some(0.5));
    let axis = SpringAxis::World(Vec3::Y);
    scene.lab.app.world_mut().entity_mut(element).insert(axis);
    scene.lab.run(0.5);
    let fault = scene.lab.get::<SpringFault>(element);
    assert_eq!(fault.field, "SpringAxis::World");
    assert!(fault.reason.contains("ImpulseJoint"), "{fault}");
    let fallen = 0.5 * GRAVITY * 0.25;
    let height = f64::from(scene.lab.position(ball).y) + 1.0;
    assert!(
        (height + fallen).abs() < 0.1 * fallen,
        "{height}: it falls freely"
    );
    // Along another axis it acts.
    let axis = SpringAxis::BodyA(Vec3::Y);
    scene.lab.app.world_mut().entity_mut(element).insert(axis);
    scene.lab.run(0.1);
    assert!(scene.lab.app.world().get::<SpringFault>(element).is_none());
    assert!(scene.lab.readout(element).force() != 0.0);
    // Along the world axis again it does not act.
    let axis = SpringAxis::World(Vec3::Y);
    scene.lab.app.world_mut().entity_mut(element).insert(axis);
    scene.lab.tick();
    let speed = scene.lab.velocity(ball).y;
    scene.lab.run(0.1);
    let gained = f64::from(scene.lab.velocity(ball).y - speed);
    assert!((gained + 0.1 * GRAVITY).abs() < 0.01, "{gained} m/s");
}
