//! Which shapes of wheels stand still by themselves on which roads. Rapier alone, without a spring.

use super::rolling::{Ground, ground};
use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f32::consts::FRAC_PI_2;

const RADIUS: f32 = 0.34;

/// How far a wheel of 150 kg rolls by itself in 4 s from rest, m, and its speed then, m/s.
fn rolls(road: Ground, wheel: Collider) -> [f32; 2] {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    ground(&mut scene, road);
    let start = Vec3::new(0.13, RADIUS, 0.07);
    let turned = Quat::from_rotation_z(0.3) * Quat::from_rotation_x(FRAC_PI_2 + 1e-5);
    let wheel = scene.body(
        Transform::from_translation(start).with_rotation(turned),
        (wheel, ColliderMassProperties::Mass(150.0)),
    );
    scene.lab.run(4.0);
    let way = scene.lab.position(wheel) - start;
    let velocity = scene.lab.velocity(wheel);
    [way, velocity].map(|v| v.xz().length())
}

#[test]
fn a_ball_stands_on_every_road_and_a_cylinder_on_a_half_space() {
    use Ground::*;
    for road in [HalfSpace, Cuboid, Flags, Trimesh, HeightField] {
        let ball = rolls(road, Collider::ball(RADIUS));
        let cylinder = rolls(road, Collider::cylinder(0.1, RADIUS));
        println!("{road:?}: rolled, m, and m/s: ball {ball:.4?}, cylinder {cylinder:.4?}");
        assert!(ball[0] < 1e-4 && ball[1] < 1e-3, "{road:?}: {ball:?}");
        if road == HalfSpace {
            assert!(cylinder[0] < 1e-3 && cylinder[1] < 1e-3, "{cylinder:?}");
        }
    }
}
