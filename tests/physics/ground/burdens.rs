//! Springs and ropes on bodies that carry something else, on a joint of the game or lying on them. At rest their force is the
//! weight of all that they carry, however strong their dampers are.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Force of the spring as a multiple of a weight, from its length alone.
fn carried(scene: &Stand, coil: &SceneSpring, weight: f64) -> f64 {
    let stretch = scene.length(coil) - f64::from(coil.rest_length);
    f64::from(coil.stiffness) * stretch.abs() / weight
}

/// A hook of 0.1 kg that carries a load of `ratio` times its mass on a ball joint, 0.3 m below it.
fn hook(ratio: f32, zeta: f32, companions: impl Bundle) -> (Stand, f64) {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    let (hook, load) = (0.1, 0.1 * ratio);
    let point = scene.lab.point(Vec3::Y * 5.0);
    let mass = ColliderMassProperties::Mass;
    let ball = (Collider::ball(0.04), mass(hook));
    let ball = scene.body(Transform::from_xyz(0.0, 4.0, 0.0), ball);
    let joint = SphericalJointBuilder::new().local_anchor2(Vec3::Y * 0.3);
    let below = (
        Collider::cuboid(0.1, 0.1, 0.1),
        mass(load),
        ImpulseJoint::new(ball, joint),
    );
    scene.body(Transform::from_xyz(0.0, 3.7, 0.0), below);
    let all = hook + load;
    let k = 200.0 * all * GRAVITY as f32;
    let c = 2.0 * zeta * (k * all).sqrt();
    let element = scene.coil([point, ball], [Vec3::ZERO; 2], [k, c], Some(1.0));
    let world = scene.lab.app.world_mut();
    world.entity_mut(element).insert(companions);
    (scene, f64::from(all) * GRAVITY)
}

#[test]
fn a_light_hook_carries_a_heavy_load_on_a_joint() {
    for ratio in [5.0, 150.0] {
        for zeta in [0.1, 0.3, 1.0] {
            let (both, weight) = hook(ratio, zeta, ());
            let (rope, _) = hook(ratio, zeta, SpringAction::Pull);
            let stop = SpringTravel::new(0.5, 2.0, 1e6);
            let (stop, _) = hook(ratio, zeta, stop);
            for (name, mut scene) in [
                ("spring", both),
                ("rope", rope),
                ("spring with stops", stop),
            ] {
                scene.lab.run(30.0);
                let share = carried(&scene, &scene.coils[0], weight);
                let (wander, awake) = (scene.wander(2.0), scene.awake());
                println!(
                    "load {ratio}:1 on a {name}, ζ {zeta}: {share:.5} of the weight, wanders {wander:.1e} m, {awake} awake"
                );
                assert!(
                    (share - 1.0).abs() < 2e-3,
                    "{name}, {ratio} {zeta}: {share}"
                );
                assert!(wander < 1e-4 && awake == 0, "{name}: {wander} {awake}");
            }
        }
    }
}

#[test]
fn a_light_tray_on_ropes_carries_a_heavy_box() {
    for (ratio, zeta) in [(20.0, 1.0), (50.0, 0.5), (50.0, 1.0)] {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
        let (tray, load) = (0.4_f32, 0.4 * ratio);
        let all = tray + load;
        let k = 50.0 * all * GRAVITY as f32;
        let c = zeta * (k * all).sqrt();
        let body = |half: Vec3, mass: f32| {
            let collider = Collider::cuboid(half.x, half.y, half.z);
            (collider, ColliderMassProperties::Mass(mass))
        };
        let plate = body(Vec3::new(0.5, 0.02, 0.5), tray);
        let plate = scene.body(Transform::from_xyz(0.0, 4.0, 0.0), plate);
        for (x, z) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
            let point = scene.lab.point(Vec3::new(x, 5.0, z));
            let anchors = [Vec3::ZERO, Vec3::new(x, 0.0, z)];
            let rope = scene.coil([point, plate], anchors, [k, c], Some(1.0));
            let world = scene.lab.app.world_mut();
            world.entity_mut(rope).insert(SpringAction::Pull);
        }
        let still = Damping {
            linear_damping: 0.3,
            angular_damping: 0.3,
        };
        let heavy = (body(Vec3::splat(0.2), load), still);
        scene.body(Transform::from_xyz(0.0, 4.22, 0.0), heavy);
        scene.lab.run(30.0);
        let weight = f64::from(all) * GRAVITY;
        let coils = scene.coils.iter();
        let share: f64 = coils.map(|coil| carried(&scene, coil, weight)).sum();
        println!("box {ratio}:1 on a tray, ζ {zeta}: {share:.5} of the weight");
        assert!((share - 1.0).abs() < 3e-3, "{ratio} {zeta}: {share}");
    }
}

#[test]
fn an_arm_on_a_hinge_rests_on_its_spring_however_strong_the_damper() {
    for strength in [0.1, 1.0, 3.0, 7.0] {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
        let wall = (RigidBody::Fixed, Transform::from_xyz(0.0, 2.0, 0.0));
        let wall = scene.lab.spawn(wall);
        let hinge = RevoluteJointBuilder::new(Vec3::Z).local_anchor2(Vec3::NEG_X * 0.5);
        let arm = (
            Collider::cuboid(0.5, 0.05, 0.05),
            ColliderMassProperties::Mass(1.0),
            ImpulseJoint::new(wall, hinge),
        );
        let arm = scene.body(Transform::from_xyz(0.5, 2.0, 0.0), arm);
        let point = scene.lab.point(Vec3::new(1.0, 7.0, 0.0));
        let k = 500.0_f32;
        let anchors = [Vec3::ZERO, Vec3::X * 0.5];
        scene.coil([point, arm], anchors, [k, strength * k.sqrt()], Some(5.0));
        scene.lab.run(30.0);
        // Half of its weight; its tip sags by a hundredth of its length only.
        let share = carried(&scene, &scene.coils[0], 0.5 * GRAVITY);
        let awake = scene.awake();
        println!("arm, damping {strength} √(k m): {share:.5} of the force, {awake} awake");
        assert!((share - 1.0).abs() < 5e-3, "{strength}: {share}");
        assert_eq!(awake, 0, "{strength}");
    }
}
