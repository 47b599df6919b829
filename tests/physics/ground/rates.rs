//! Scenes on the ground at other step lengths and numbers of substeps, with fixed and with varying frame times.

use super::scenes::*;
use super::stand::*;
use crate::compat::begin;
use crate::harness::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::time::Duration;

fn engines() -> Vec<(f32, usize)> {
    let rates = [30.0, 60.0, 144.0];
    let all = rates.map(|rate| [1, 2, 4].map(|substeps| (rate, substeps)));
    all.into_iter().flatten().collect()
}

fn stand(rate: f32, substeps: usize) -> Stand {
    let engine = Engine {
        dt: 1.0 / rate,
        substeps,
        ..default()
    };
    let mut scene = Stand::new(CoiloverPlugin::default(), engine);
    scene.ground();
    scene
}

#[test]
fn at_any_rate_and_in_any_substeps_a_load_rests_where_statics_say() {
    for (name, setup) in [
        ("quarter car", Footed::quarter_car()),
        ("foot", Footed::foot()),
    ] {
        for (rate, substeps) in engines() {
            let mut scene = stand(rate, substeps);
            setup.put(&mut scene);
            scene.lab.tick();
            let first = scene.energy() - setup.floor();
            let most = (scene.most(15.0) - setup.floor()) / first;
            let sag = setup.sag_now(&scene) / setup.sag();
            let (wander, awake) = (scene.wander(3.0), scene.awake());
            println!(
                "{name}, {rate} Hz × {substeps}: E × {most:.4}, sag × {sag:.5}, wanders {wander:.1e} m, {awake} awake"
            );
            assert!(most < 1.02, "{name} {rate} {substeps}: E × {most}");
            assert!((sag - 1.0).abs() < 0.01, "{name} {rate} {substeps}: {sag}");
            assert!(wander < 1e-4 && awake == 0, "{name} {rate} {substeps}");
        }
    }
}

#[test]
fn at_any_rate_a_box_at_a_wall_does_not_tremble() {
    let mut wrong = Vec::new();
    for (rate, substeps) in engines() {
        for k in [500.0, 5e3, 5e4] {
            let mut scene = stand(rate, substeps);
            box_at_wall(&mut scene, k, 0.25);
            scene.lab.run(10.0);
            let (wander, speed) = (scene.wander(5.0), scene.speed());
            println!(
                "wall, {k} N/m, {rate} Hz × {substeps}: wanders {wander:.1e} m, {speed:.1e} m/s"
            );
            if wander > 1e-4 || speed > 1e-4 {
                wrong.push((rate, substeps, k));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// A lab that updates once per frame, in a given timestep mode.
fn frames(mode: TimestepMode) -> Stand {
    let mut app = App::new();
    let rapier = RapierPhysicsPlugin::<NoUserData>::default()
        .with_custom_initialization(begin(default(), Engine::default().gravity));
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .insert_resource(mode)
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO))
        .add_plugins((rapier, CoiloverPlugin::new(PostUpdate)));
    let mut lab = Lab { app };
    lab.prime();
    let mut scene = Stand {
        lab,
        bodies: Vec::new(),
        coils: Vec::new(),
        gravity: GRAVITY,
    };
    scene.ground();
    scene
}

/// Runs for `seconds` with the given frame times in turn. Returns the greatest energy, J.
fn run(scene: &mut Stand, times: &[f32], seconds: f32) -> f64 {
    let (mut t, mut most) = (0.0, f64::NEG_INFINITY);
    for time in times.iter().cycle() {
        let frame = Duration::from_secs_f32(*time);
        scene
            .lab
            .app
            .insert_resource(TimeUpdateStrategy::ManualDuration(frame));
        scene.lab.tick();
        most = most.max(scene.energy());
        t += time;
        if t > seconds {
            break;
        }
    }
    most
}

/// Frame times in s, for 30 to 144 frames a second.
const UNSTEADY: [f32; 6] = [
    1.0 / 30.0,
    1.0 / 144.0,
    1.0 / 144.0,
    1.0 / 60.0,
    1.0 / 144.0,
    1.0 / 40.0,
];

#[test]
fn frames_of_unequal_length_change_nothing_of_it() {
    let modes = [1, 2].map(|substeps| {
        [
            (
                format!("variable × {substeps}"),
                TimestepMode::Variable {
                    max_dt: 1.0 / 20.0,
                    time_scale: 1.0,
                    substeps,
                },
            ),
            (
                format!("interpolated × {substeps}"),
                TimestepMode::Interpolated {
                    dt: 1.0 / 60.0,
                    time_scale: 1.0,
                    substeps,
                },
            ),
        ]
    });
    for (way, mode) in modes.into_iter().flatten() {
        for times in [&UNSTEADY[..], &UNSTEADY[..2]] {
            for (name, setup) in [
                ("quarter car", Footed::quarter_car()),
                ("foot", Footed::foot()),
            ] {
                let mut scene = frames(mode);
                setup.put(&mut scene);
                run(&mut scene, times, 1e-3);
                let first = scene.energy() - setup.floor();
                let most = (run(&mut scene, times, 15.0) - setup.floor()) / first;
                let sag = setup.sag_now(&scene) / setup.sag();
                let awake = scene.awake();
                println!(
                    "{name}, {way}, {} kinds of frame: E × {most:.4}, sag × {sag:.5}, {awake} awake",
                    times.len()
                );
                assert!(most < 1.02, "{name} {way}: E × {most}");
                assert!((sag - 1.0).abs() < 0.01, "{name} {way}: {sag}");
                assert_eq!(awake, 0, "{name} {way}: it sleeps");
            }
        }
    }
}
