//! Is the work of ends that the game moves the force times the way along the element, where the engine solves it?

use super::stand::Stand;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A heavy box on the ground, and a kinematic body at the end of a spring to the box. Returns scene, kinematic body and spring.
fn led(at: Vec3, beside: impl Bundle) -> (Stand, Entity, Entity) {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    scene.ground();
    let load = scene.body(
        Transform::from_xyz(0.0, 0.5, 0.0),
        (
            Collider::cuboid(0.5, 0.5, 0.5),
            ColliderMassProperties::Mass(1000.0),
            Friction::new(2.0),
        ),
    );
    let hand = RigidBody::KinematicPositionBased;
    let hand = scene.lab.spawn((hand, Transform::from_translation(at)));
    let spring = Spring::new(hand, load)
        .with_stiffness(20.0)
        .with_rest_length(0.2);
    let spring = scene.lab.spawn((spring, beside));
    scene.lab.run(0.5);
    assert_eq!(scene.lab.readout(spring).method, SpringMethod::Engine);
    (scene, hand, spring)
}

fn balance(scene: &Stand, spring: Entity) -> f64 {
    let seen = scene.lab.readout(spring);
    f64::from(seen.stored_energy) - f64::from(seen.work)
}

/// It circles above the box once a second, so it moves by a tenth of the length in each step, across the spring.
#[test]
fn a_hand_that_circles_about_a_load_does_no_work_on_the_spring() {
    let middle = Vec3::Y * 0.5;
    let place = |angle: f32| middle + Vec3::new(angle.sin(), angle.cos(), 0.0);
    let (mut scene, hand, spring) = led(place(0.0), ());
    let first = balance(&scene, spring);
    for i in 1..=60 {
        // There and back, above the ground.
        let angle = (std::f32::consts::TAU * i as f32 / 60.0).sin();
        scene.lab.get_mut::<Transform>(hand).translation = place(angle);
        scene.lab.tick();
        let off = balance(&scene, spring) - first;
        // The spring pulls with 16 N.
        assert!(off.abs() < 0.02, "{off} J after {i} steps");
    }
}

/// It leaves the box, past it at a distance of one metre.
#[test]
fn a_hand_that_passes_a_load_does_the_work_that_the_spring_stores() {
    let (mut scene, hand, spring) = led(Vec3::new(-2.0, 1.5, 0.0), ());
    let first = balance(&scene, spring);
    for i in 1..=60 {
        let x = -2.0 + 4.0 * i as f32 / 60.0;
        scene.lab.get_mut::<Transform>(hand).translation.x = x;
        scene.lab.tick();
        let off = balance(&scene, spring) - first;
        assert!(off.abs() < 0.1, "{off} J at {x} m");
    }
}

/// A slider whose axis is that of the hand. The hand turns, and so the load leaves the axis: that is no work of the spring, but
/// along the axis it is shorter.
#[test]
fn a_hand_that_turns_the_axis_of_a_slider_does_the_work_that_the_spring_stores() {
    let axis = SpringAxis::BodyA(Vec3::NEG_Y);
    let (mut scene, hand, spring) = led(Vec3::Y * 2.0, axis);
    let first = balance(&scene, spring);
    for i in 1..=60 {
        let angle = 0.8 * (std::f32::consts::PI * i as f32 / 60.0).sin();
        scene.lab.get_mut::<Transform>(hand).rotation = Quat::from_rotation_z(angle);
        scene.lab.tick();
        let off = balance(&scene, spring) - first;
        assert!(off.abs() < 0.1, "{off} J at {angle} rad");
    }
}
