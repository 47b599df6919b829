//! Actuators that press against an obstacle or lift a load: springs whose rest length is driven.

use super::scenes::*;
use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f32::consts::TAU;

/// Mechanical energy, stored energy and dissipated heat minus the work put in, J. This sum is constant.
fn balance(scene: &Stand, elements: &[Entity]) -> f64 {
    let of = |element: &Entity| {
        let seen = scene.lab.readout(*element);
        f64::from(seen.stored_energy) + f64::from(seen.dissipated_energy) - f64::from(seen.work)
    };
    scene.energy() - scene.stored() + elements.iter().map(of).sum::<f64>()
}

fn drive(scene: &mut Stand, element: Entity, rest: f32) {
    scene.lab.get_mut::<SpringDamper>(element).rest_length = Some(rest);
}

/// Drives the rest length of the first element for a time in s. Returns the greatest change of the balance and the sum of
/// the work in and out, J.
fn driven(
    scene: &mut Stand,
    elements: &[Entity],
    seconds: f64,
    rest: impl Fn(f32) -> f32,
    mut each: impl FnMut(&Stand),
) -> (f64, f64) {
    let first = balance(scene, elements);
    let (mut off, mut turnover) = (0.0_f64, 0.0);
    let dt = scene.lab.dt() as f32;
    for i in 1..=scene.lab.ticks(seconds) {
        let work = scene.lab.readout(elements[0]).work;
        drive(scene, elements[0], rest(i as f32 * dt));
        scene.lab.tick();
        turnover += f64::from((scene.lab.readout(elements[0]).work - work).abs());
        off = off.max((balance(scene, elements) - first).abs());
        each(scene);
    }
    (off, turnover)
}

/// An actuator at the origin that presses a box of 5 kg along x against a slab. A stiff spring behind the slab measures
/// the force. Returns the actuator and that spring.
fn press(scene: &mut Stand, law: [f32; 2]) -> [Entity; 2] {
    let rail = LockedAxes::ROTATION_LOCKED
        | LockedAxes::TRANSLATION_LOCKED_Y
        | LockedAxes::TRANSLATION_LOCKED_Z;
    let bodies = [(1.0, 0.1), (1.15, 0.05)].map(|(x, half)| {
        scene.body(
            Transform::from_xyz(x, 0.0, 0.0),
            (
                Collider::cuboid(half, 0.1, 0.1),
                ColliderMassProperties::Mass(5.0),
                rail,
            ),
        )
    });
    let posts = [0.0, 1.65].map(|x| {
        scene
            .lab
            .spawn((RigidBody::Fixed, Transform::from_xyz(x, 0.0, 0.0)))
    });
    [
        scene.coil([posts[0], bodies[0]], [Vec3::ZERO; 2], law, Some(1.05)),
        scene.coil(
            [posts[1], bodies[1]],
            [Vec3::ZERO; 2],
            [1e5, 200.0],
            Some(0.5),
        ),
    ]
}

#[test]
fn what_an_actuator_says_is_what_the_wall_feels() {
    let mut wrong = Vec::new();
    for law in [[5e3, 50.0], [5e3, 0.0], [5e4, 500.0]] {
        for hertz in [0.25, 2.0] {
            let mut scene = Stand::new(CoiloverPlugin::default(), Engine::weightless());
            let elements = press(&mut scene, law);
            scene.lab.run(2.0);
            let stroke = 150.0 / law[0];
            let (mut apart, mut range) = (0.0_f32, [f32::INFINITY, f32::NEG_INFINITY]);
            // The drive changes once a tick. The boxes need some milliseconds to follow each step.
            let step = 150.0 * TAU * hertz * DT;
            let (off, work) = driven(
                &mut scene,
                &elements,
                4.0,
                |t| 1.05 + stroke * (TAU * hertz * t).sin(),
                |scene| {
                    let [says, feels] = elements.map(|e| scene.lab.readout(e).force());
                    apart = apart.max((says - feels).abs() - step);
                    range = [range[0].min(-says), range[1].max(-says)];
                },
            );
            let apart = apart / range[1];
            let off = off / work;
            let name = format!("{law:?} at {hertz} Hz");
            println!(
                "{name}: presses with {:.0} to {:.0} N, {apart:.4} of it further apart from what the wall feels than a step of the drive; {work:.2} J moved, {off:.4} of it off",
                range[0], range[1]
            );
            if apart > 0.02 || off > 0.05 {
                wrong.push(name);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn after_a_jump_of_the_drive_nothing_trembles() {
    let mut wrong = Vec::new();
    for law in [[5e3, 50.0], [5e4, 500.0]] {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::weightless());
        let elements = press(&mut scene, law);
        scene.lab.run(2.0);
        for jump in [1.15, 1.02, 1.05] {
            let work = |scene: &Stand| f64::from(scene.lab.readout(elements[0]).work);
            let (before, told) = (scene.energy(), work(&scene));
            drive(&mut scene, elements[0], jump);
            scene.coils[0].rest_length = jump;
            let after = scene.energy();
            let most = scene.most(4.0) / after;
            let told = (work(&scene) - told) / (after - before);
            let mut speed = 0.0_f64;
            for _ in 0..120 {
                scene.lab.tick();
                speed = speed.max(scene.speed());
            }
            let [says, feels] = elements.map(|e| scene.lab.readout(e).force());
            let apart = ((says - feels) / says).abs();
            let name = format!("{law:?} to {jump} m");
            println!(
                "{name}: {:.2} J put in, told as × {told:.4}, E × {most:.4}; then {says:.1} N, {apart:.1e} of it apart, {speed:.1e} m/s",
                after - before
            );
            if most > 1.02 || (told - 1.0).abs() > 0.02 || apart > 1e-3 || speed > 1e-4 {
                wrong.push(name);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_jack_that_lifts_a_load_off_its_foot_does_the_work_that_arrives() {
    let mut wrong = Vec::new();
    for (name, setup) in [
        ("quarter car", Footed::quarter_car()),
        (
            "foot",
            Footed {
                drop: 0.0,
                ..Footed::foot()
            },
        ),
    ] {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
        scene.ground();
        let placed = setup.put(&mut scene);
        let elements = [placed.element];
        scene.lab.run(15.0);
        let (off, work) = driven(
            &mut scene,
            &elements,
            4.0,
            |t| setup.rest + 0.1 * (TAU * 0.5 * t).sin(),
            |_| {},
        );
        let (jump_off, jump_work) =
            driven(&mut scene, &elements, 10.0, |_| setup.rest + 0.1, |_| {});
        let sag = setup.sag_now(&scene) + 0.1;
        scene.lab.run(10.0);
        let (wander, awake) = (scene.wander(2.0), scene.awake());
        println!(
            "{name}: {work:.1} J moved, {:.4} of it off; jump {jump_work:.1} J, {:.4} of it off; sag × {:.5}, wanders {wander:.1e} m, {awake} awake",
            off / work,
            jump_off / jump_work,
            sag / setup.sag()
        );
        let sag = (sag / setup.sag() - 1.0).abs();
        if off > 0.05 * work
            || jump_off > 0.05 * jump_work
            || sag > 0.01
            || wander > 1e-4
            || awake > 0
        {
            wrong.push(name);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}
