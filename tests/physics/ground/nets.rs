//! Nets of light balls joined by stiff springs, dropped on the ground.

use super::stand::*;
use crate::dice::in_turn;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A net of balls of 0.2 kg, `n` along each axis, with a spring between near neighbours. Its
/// lowest balls are 0.4 m above the ground.
fn net(plugin: CoiloverPlugin, n: [usize; 3], k: f32, zeta: f32) -> Stand {
    let mut scene = Stand::new(plugin, Engine::default());
    scene.ground();
    let (apart, radius, mass) = (0.3_f32, 0.05_f32, 0.2_f32);
    let mut balls = Vec::new();
    for x in 0..n[0] {
        for y in 0..n[1] {
            for z in 0..n[2] {
                let at = Vec3::new(
                    x as f32 * apart + 0.02 * y as f32,
                    0.4 + radius + y as f32 * apart,
                    z as f32 * apart,
                );
                balls.push(scene.body(
                    Transform::from_translation(at),
                    (Collider::ball(radius), ColliderMassProperties::Mass(mass)),
                ));
            }
        }
    }
    let c = 2.0 * zeta * (0.5 * mass * k).sqrt();
    for i in 0..balls.len() {
        for j in 0..i {
            let ends = [balls[i], balls[j]];
            if scene.distance(ends, [Vec3::ZERO; 2]) < 1.5 * apart {
                scene.coil(ends, [Vec3::ZERO; 2], [k, c], None);
            }
        }
    }
    scene
}

#[test]
fn nets_of_light_balls_win_nothing_when_they_land() {
    let base = |scene: &Stand| scene.bodies.len() as f64 * 0.2 * GRAVITY * 0.05;
    let sizes = [[2, 1, 1], [3, 1, 1], [3, 3, 3], [5, 5, 5]];
    let all = sizes
        .iter()
        .flat_map(|n| [2e3, 2e4, 1e5, 1e6, 1e7].map(|k| (*n, k)));
    for (n, k) in in_turn(all.filter(|(n, k)| n[0] < 5 || *k < 1e6).collect()) {
        let mut scene = net(CoiloverPlugin::default(), n, k, 0.0);
        scene.lab.tick();
        let base = base(&scene);
        let first = scene.energy() - base;
        let most = (scene.most(5.0) - base) / first;
        println!("net of {n:?}, {k} N/m: E × {most:.3}");
        assert!(most < 1.02, "{n:?} at {k} N/m: E × {most}");
    }
}

#[test]
fn in_every_way_of_stepping() {
    for (name, way) in ways() {
        for (n, k) in [([2, 1, 1], 2e4), ([3, 3, 3], 1e5)] {
            let mut scene = net(way, n, k, 0.02);
            scene.lab.tick();
            let base = scene.bodies.len() as f64 * 0.2 * GRAVITY * 0.05;
            let first = scene.energy() - base;
            let most = (scene.most(5.0) - base) / first;
            println!("net of {n:?}, {name} micro-steps: E × {most:.3}");
            assert!(most < 1.02, "{name} {n:?}: E × {most}");
        }
    }
}
