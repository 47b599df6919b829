//! A box that a spring pulls against a wall.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

#[test]
fn a_box_held_against_a_wall_does_not_tremble() {
    for k in [500.0_f32, 5e3, 5e4] {
        for (name, way) in ways() {
            let mut scene = Stand::new(way, Engine::default());
            scene.ground();
            scene.lab.spawn((
                RigidBody::Fixed,
                Collider::cuboid(0.1, 1.0, 1.0),
                Transform::from_xyz(1.0, 1.0, 0.0),
            ));
            let crate_ = scene.body(
                Transform::from_xyz(0.6, 0.25, 0.0),
                (
                    Collider::cuboid(0.25, 0.25, 0.25),
                    ColliderMassProperties::Mass(5.0),
                ),
            );
            // A hand inside the wall, which holds the box at its middle.
            let hand = scene.lab.spawn((
                RigidBody::KinematicPositionBased,
                Transform::from_xyz(1.0, 0.4, 0.0),
            ));
            let c = 0.2 * (k * 5.0).sqrt();
            scene.coil([hand, crate_], [Vec3::ZERO; 2], [k, c], Some(0.0));
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
