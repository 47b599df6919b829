//! A box that a spring pulls against a wall, or lets go before one.

use super::scenes::box_at_wall;
use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

#[test]
fn a_box_held_against_a_wall_does_not_tremble() {
    for k in [500.0_f32, 5e3, 5e4] {
        for (name, way) in ways() {
            let mut scene = Stand::new(way, Engine::default());
            scene.ground();
            // The hand is inside the wall, 0.15 m above the centre of the box.
            box_at_wall(&mut scene, k, 0.4);
            scene.lab.run(10.0);
            let (wander, speed) = (scene.wander(10.0), scene.speed());
            println!("wall, {k} N/m, {name} micro-steps: wanders {wander:.1e} m, {speed:.1e} m/s");
            assert!(
                wander < 1e-4 && speed < 1e-4,
                "{k} {name}: {wander} {speed}"
            );
        }
    }
}

/// The rest length of a spring between a hand inside a wall and a box before it suddenly becomes zero. Returns the
/// greatest energy that lasts for two ticks, over the energy at the release.
fn let_go(phase: f32, gap: f32, zeta: f32) -> f64 {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::weightless());
    scene.lab.spawn((
        RigidBody::Fixed,
        Collider::cuboid(0.1, 1.0, 1.0),
        Transform::from_xyz(1.0, 1.0, 0.0),
    ));
    let mass = 5.0;
    let load = scene.body(
        Transform::from_xyz(0.65 - gap, 0.25, 0.0),
        (
            Collider::cuboid(0.25, 0.25, 0.25),
            ColliderMassProperties::Mass(mass),
        ),
    );
    let hand = scene.lab.spawn((
        RigidBody::KinematicPositionBased,
        Transform::from_xyz(1.0, 0.25, 0.0),
    ));
    let omega = phase / DT;
    let law = [mass * omega * omega, 2.0 * zeta * mass * omega];
    let spring = scene.coil([hand, load], [Vec3::ZERO; 2], law, None);
    scene.lab.run(1.0);
    scene.lab.get_mut::<SpringDamper>(spring).rest_length = Some(0.0);
    scene.coils[0].rest_length = 0.0;
    let first = scene.energy();
    // A body that continuous collision detection has stopped keeps its speed until the next step. Only energy that is
    // still there after that step counts as a gain.
    let mut before = first;
    let mut most = 0.0_f64;
    for _ in 0..scene.lab.ticks(4.0) {
        scene.lab.tick();
        let energy = scene.energy();
        most = most.max(energy.min(before));
        before = energy;
    }
    most / first
}

#[test]
fn a_stretched_spring_that_is_let_go_before_a_wall_wins_nothing() {
    let mut worst = 0.0_f64;
    for phase in [0.2, 0.33, 0.5, 1.0, 1.67, 3.0] {
        for zeta in [0.05, 0.3] {
            // Not 2 cm: that is Rapier's prediction distance, from which even a constant force of
            // that size sends a body through the wall.
            let most =
                [0.005, 0.01, 0.03, 0.05, 0.1, 0.2, 0.4, 0.8].map(|gap| let_go(phase, gap, zeta));
            println!("let go before a wall, ω·dt {phase}, ζ {zeta}: E × {most:.3?}");
            worst = most.into_iter().fold(worst, f64::max);
        }
    }
    assert!(worst < 1.02, "{worst}");
}
