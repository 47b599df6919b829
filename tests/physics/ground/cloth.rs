//! Heavy balls that fall on a wide cloth of light points.

use super::stand::*;
use crate::dice::span;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const SIDE: usize = 30;
const PITCH: f32 = 0.1;

#[test]
fn heavy_balls_on_a_wide_cloth_win_nothing() {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    let middle = 0.5 * (SIDE - 1) as f32;
    let mut points = Vec::new();
    for i in 0..SIDE * SIDE {
        let (x, z) = (i % SIDE, i / SIDE);
        let at = PITCH * Vec3::new(x as f32 - middle, 0.0, z as f32 - middle) + Vec3::Y * 3.0;
        let rim = x == 0 || z == 0 || x == SIDE - 1 || z == SIDE - 1;
        points.push(if rim {
            scene
                .lab
                .spawn((RigidBody::Fixed, Transform::from_translation(at)))
        } else {
            scene.body(
                Transform::from_translation(at),
                (
                    Collider::ball(0.04),
                    ColliderMassProperties::Mass(0.05),
                    CollisionGroups::new(Group::GROUP_1, Group::GROUP_2),
                    LockedAxes::ROTATION_LOCKED,
                ),
            )
        });
    }
    for i in 0..points.len() {
        let (x, z) = (i % SIDE, i / SIDE);
        for (fits, j) in [(x + 1 < SIDE, i + 1), (z + 1 < SIDE, i + SIDE)] {
            if fits {
                let ends = [points[i], points[j]];
                scene.coil(ends, [Vec3::ZERO; 2], [3e3, 1.0], Some(0.8 * PITCH));
            }
        }
    }
    for (x, z, radius, mass) in [
        (-0.5, 0.2, 0.3, 5.0),
        (0.5, -0.3, 0.25, 3.0),
        (0.3, 0.6, 0.2, 2.0),
    ] {
        scene.body(
            Transform::from_xyz(x, 4.5, z),
            (
                Collider::ball(radius),
                ColliderMassProperties::Mass(mass),
                CollisionGroups::new(Group::GROUP_2, Group::ALL),
            ),
        );
    }
    scene.lab.tick();
    let first = scene.energy();
    let seconds = span(15.0);
    let most = scene.most(seconds);
    println!(
        "cloth of 30 × 30 with three balls: E {:+.2} J of {first:.0} J at most, {:.2} m/s after {seconds} s",
        most - first,
        scene.speed()
    );
    assert!(
        most < first + 0.02 * 10.0 * GRAVITY * 1.5,
        "{}",
        most - first
    );
}
