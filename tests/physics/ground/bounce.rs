//! Pairs of bodies on a spring that take off and land again and again.

use super::stand::*;
use crate::dice::in_turn;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Two balls of 1 kg on a spring, tilted by `lean` rad, above the ground. `phase` is ω·dt of the pair.
fn pair(plugin: CoiloverPlugin, phase: f32, zeta: f32, lean: f32, bounce: f32) -> Stand {
    let mut scene = Stand::new(plugin, Engine::default());
    scene.ground();
    let effective = 0.5_f32;
    let omega = phase / DT;
    let law = [effective * omega * omega, 2.0 * zeta * effective * omega];
    let middle = Vec3::Y * 1.5;
    let arm = 0.4 * (Quat::from_rotation_z(lean) * Vec3::Y);
    let ends = [arm, -arm].map(|arm| {
        scene.body(
            Transform::from_translation(middle + arm),
            (
                Collider::ball(0.1),
                ColliderMassProperties::Mass(1.0),
                Restitution {
                    coefficient: bounce,
                    combine_rule: CoefficientCombineRule::Max,
                },
                Friction::new(0.5),
            ),
        )
    });
    scene.coil(ends, [Vec3::ZERO; 2], law, None);
    scene
}

#[test]
fn a_pair_that_bounces_for_long_wins_nothing() {
    // Energy with both balls on the ground.
    let base = 2.0 * 0.1 * GRAVITY;
    let mut all = Vec::new();
    for (name, way) in ways() {
        for bounce in [0.0, 0.9] {
            for lean in [0.0, 0.5] {
                for phase in [0.2, 0.5, 1.0, 3.0] {
                    all.extend([0.0, 0.05].map(|zeta| (name, way, bounce, lean, phase, zeta)));
                }
            }
        }
    }
    for (name, way, bounce, lean, phase, zeta) in in_turn(all) {
        let mut scene = pair(way, phase, zeta, lean, bounce);
        scene.lab.tick();
        let first = scene.energy() - base;
        let most = (scene.most(8.0) - base) / first;
        let last = (scene.energy() - base) / first;
        let case =
            format!("{name} micro-steps, bounce {bounce}, lean {lean}, ω·dt {phase}, ζ {zeta}");
        println!("pair, {case}: E × {most:.3}, {last:.2} at the end");
        assert!(most < 1.02, "{case}: E × {most}");
    }
}

#[test]
fn a_hopper_that_is_heavy_above_wins_nothing() {
    for phase in [0.5, 1.0, 2.0, 6.0] {
        for zeta in [0.0, 0.02] {
            let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
            scene.ground();
            let setup = super::scenes::Footed {
                law: {
                    let (mass, omega) = (10.0 * 300.0 / 310.0, phase / DT);
                    [mass * omega * omega, 2.0 * zeta * mass * omega]
                },
                rest: 2.0,
                drop: 1.0,
                ..super::scenes::Footed::foot()
            };
            setup.put(&mut scene);
            scene.lab.tick();
            let first = scene.energy() - setup.floor();
            let mut landings = 0;
            let (mut most, mut flies) = (f64::NEG_INFINITY, true);
            for _ in 0..scene.lab.ticks(20.0) {
                scene.lab.tick();
                most = most.max(scene.energy());
                let high = scene.lab.position(scene.bodies[1]).y > setup.reach + 0.02;
                landings += usize::from(flies && !high);
                flies = high;
            }
            let most = (most - setup.floor()) / first;
            let last = (scene.energy() - setup.floor()) / first;
            println!(
                "hopper, ω·dt {phase}, ζ {zeta}: E × {most:.4}, at the end {last:.3}, {landings} landings"
            );
            assert!(most < 1.02, "ω·dt {phase} ζ {zeta}: E × {most}");
        }
    }
}

/// A ball of 1 kg on a spring of 1 N/m (ω·dt of 0.017), its lowest point `gap` metres above the ground. It moves with `velocity`, and
/// nothing weighs.
fn soft(gap: f32, velocity: Vec3) -> (Stand, Entity, Entity) {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::weightless());
    scene.ground();
    let radius = 0.1;
    let ball = scene.body(
        Transform::from_xyz(0.0, radius + gap, 0.0),
        (
            Collider::ball(radius),
            ColliderMassProperties::Mass(1.0),
            Velocity::linear(velocity),
        ),
    );
    let hook = scene.lab.point(Vec3::Y * 3.0);
    let element = scene.coil([hook, ball], [Vec3::ZERO; 2], [1.0, 0.0], None);
    (scene, ball, element)
}

#[test]
fn rapier_solves_a_soft_spring_from_the_step_in_which_its_ball_lands() {
    // 1 cm per step: the ball is 1.5 cm high one step before the one in which it lands.
    let (mut scene, ball, element) = soft(0.095, 0.6 * Vec3::NEG_Y);
    for tick in 1..=20 {
        let before = scene.lab.readout(element).method;
        scene.lab.tick();
        let method = scene.lab.readout(element).method;
        if scene.lab.velocity(ball).y > -0.3 {
            println!("the ball lands in tick {tick}, after {before:?}: {method:?}");
            assert_eq!(before, SpringMethod::ClosedForm, "it was free before");
            assert_eq!(method, SpringMethod::Engine);
            return;
        }
    }
    panic!("it never landed");
}

#[test]
fn a_ball_that_passes_the_ground_slowly_stays_free() {
    // Rapier knows of a contact up to 2 cm ahead.
    let (mut scene, ball, element) = soft(0.015, 0.1 * Vec3::X);
    for tick in 1..=30 {
        scene.lab.tick();
        let method = scene.lab.readout(element).method;
        // Before its first step, the engine's own search decides.
        assert!(
            tick == 1 || method == SpringMethod::ClosedForm,
            "tick {tick}: {method:?}"
        );
    }
    let gap = scene.lab.position(ball).y - 0.1;
    assert!((0.01..0.02).contains(&gap), "{gap}");
}

#[test]
fn what_a_spring_along_an_axis_drives_into_the_ground_is_held_before_it_lands() {
    for axis in [SpringAxis::World(Vec3::NEG_Y), SpringAxis::BodyA(Vec3::X)] {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::weightless());
        scene.ground();
        // Its x-axis points down.
        let facing = Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2);
        let hook = Transform::from_xyz(0.8, 0.8, 0.0).with_rotation(facing);
        let hook = scene.lab.spawn((RigidBody::Fixed, hook));
        let ball = scene.body(
            Transform::from_xyz(0.0, 0.2, 0.0),
            (Collider::ball(0.1), ColliderMassProperties::Mass(1.0)),
        );
        // At ω·dt = 1 and compressed by 0.4 m along the axis, it moves the free ball by 0.4 m · (1 − cos 1) = 0.18 m in a step;
        // the ground is 0.1 m below. The straight line between the ends has the rest length.
        let element = scene.coil([hook, ball], [Vec3::ZERO; 2], [3600.0, 0.0], Some(1.0));
        scene.lab.app.world_mut().entity_mut(element).insert(axis);
        scene.lab.tick();
        let method = scene.lab.readout(element).method;
        println!("{axis:?}: {method:?}");
        assert_eq!(method, SpringMethod::Engine, "{axis:?}");
    }
}
