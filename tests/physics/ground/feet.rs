//! A stiff foot under a heavy body, dropped: it gains no energy and comes to rest.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// 300 kg over a box foot of 10 kg, guided vertically, dropped from half a metre.
fn foot(plugin: CoiloverPlugin, phase: f32, zeta: f32) -> Stand {
    let mut scene = Stand::new(plugin, Engine::default());
    scene.ground();
    let (foot, load) = (10.0_f32, 300.0_f32);
    let effective = foot * load / (foot + load);
    let omega = phase / DT;
    let (k, c) = (effective * omega * omega, 2.0 * zeta * effective * omega);
    let above = scene.body(
        Transform::from_xyz(0.0, 1.2, 0.0),
        (
            AdditionalMassProperties::Mass(load),
            LockedAxes::ROTATION_LOCKED,
        ),
    );
    let guide = GenericJointBuilder::new(
        JointAxesMask::LIN_X | JointAxesMask::LIN_Z | JointAxesMask::ANG_AXES,
    );
    let below = scene.body(
        Transform::from_xyz(0.0, 0.6, 0.0),
        (
            Collider::cuboid(0.1, 0.1, 0.1),
            ColliderMassProperties::Mass(foot),
            LockedAxes::ROTATION_LOCKED,
            ImpulseJoint::new(above, TypedJoint::GenericJoint(guide.build())),
        ),
    );
    scene.coil([above, below], [Vec3::ZERO; 2], [k, c], None);
    scene
}

#[test]
fn a_dropped_foot_wins_nothing_however_stiff() {
    let base = (10.0 * 0.1 + 300.0 * 0.7) * GRAVITY;
    for (name, way) in ways() {
        for zeta in [0.05, 0.3, 1.0] {
            let mut line = String::new();
            for phase in [1.0, 2.0, 3.0, 6.0] {
                let mut scene = foot(way, phase, zeta);
                scene.lab.tick();
                let first = scene.energy() - base;
                let most = (scene.most(10.0) - base) / first;
                line += &format!(" {most:.3}");
                assert!(most < 1.02, "{name}, ω·dt {phase} ζ {zeta}: E × {most}");
            }
            println!("foot, {name} micro-steps, ζ {zeta}, ω·dt 1, 2, 3, 6: E ×{line}");
        }
    }
}

#[test]
fn without_damping_it_wins_nothing_either() {
    let base = (10.0 * 0.1 + 300.0 * 0.7) * GRAVITY;
    for phase in [1.0, 2.0, 3.0, 6.0, 12.0] {
        let mut scene = foot(CoiloverPlugin::default(), phase, 0.0);
        scene.lab.tick();
        let first = scene.energy() - base;
        let most = (scene.most(20.0) - base) / first;
        println!("foot without damping, ω·dt {phase}: E × {most:.3}");
        assert!(most < 1.02, "ω·dt {phase}: E × {most}");
    }
}

#[test]
fn it_comes_to_rest_at_the_right_height_and_sleeps() {
    for phase in [1.0, 3.0, 6.0] {
        let mut scene = foot(CoiloverPlugin::default(), phase, 0.3);
        scene.lab.run(40.0);
        let coil = scene.coils[0];
        let sag = f64::from(coil.rest_length) - scene.length(&coil);
        let wanted = 300.0 * GRAVITY / f64::from(coil.stiffness);
        let (wander, awake) = (scene.wander(5.0), scene.awake());
        println!(
            "foot at rest, ω·dt {phase}: sag {:.5} of theory, wanders {wander:.1e} m, {awake} awake",
            sag / wanted
        );
        assert!(
            (sag - wanted).abs() < 1e-3 * wanted + 1e-6,
            "{sag} {wanted}"
        );
        assert!(wander < 1e-4 && awake == 0, "{wander} {awake}");
    }
}

/// A table of 0.1 kg on four feet of 5 g, each on a prismatic joint and a spring.
#[test]
fn a_small_table_on_slider_feet_stands_still() {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    scene.ground();
    let top = scene.body(
        Transform::from_xyz(0.0, 0.07, 0.0),
        (
            Collider::cuboid(0.025, 0.005, 0.025),
            ColliderMassProperties::Mass(0.1),
        ),
    );
    for (x, z) in [(-0.02, -0.02), (0.02, -0.02), (-0.02, 0.02), (0.02, 0.02)] {
        let guide = PrismaticJointBuilder::new(Vec3::Y).local_anchor1(Vec3::new(x, 0.0, z));
        let foot = scene.body(
            Transform::from_xyz(x, 0.02, z),
            (
                Collider::ball(0.004),
                ColliderMassProperties::Mass(0.005),
                ImpulseJoint::new(top, guide),
            ),
        );
        let omega = (100.0_f32 / 0.025).sqrt();
        let c = 2.0 * 0.1 * 0.025 * omega;
        let anchors = [Vec3::new(x, 0.0, z), Vec3::ZERO];
        scene.coil([top, foot], anchors, [100.0, c], None);
    }
    scene.lab.tick();
    let first = scene.energy();
    let most = scene.most(10.0);
    let wander = scene.wander(2.0);
    println!("table: {first:.4} J, at most {most:.4} J, wanders {wander:.1e} m");
    assert!(most < 1.02 * first, "{first} {most}");
    assert!(wander < 1e-4, "{wander} m");
}
