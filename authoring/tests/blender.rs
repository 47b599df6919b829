//! Tests that a scene made in Blender with the add-on in `blender/` behaves in Bevy as the add-on's panel predicts.
//!
//! The add-on's own tests check `assets/blender_scene.glb` against the script that makes it.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::path::Path;

const G: f32 = 9.81;

fn scene() -> (Stage, Entity) {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
    let mut stage = Stage::new(&assets);
    let root = stage.load("blender_scene.glb");
    // Bodies and joints are spawned by the end of the frame in which the scene is spawned.
    run(&mut stage.app, 2.0 * DT);
    (stage, root)
}

/// Length of an element at each tick for some seconds, m. For a torsion element the angle, rad.
fn lengths(stage: &mut Stage, element: Entity, seconds: f32) -> Vec<f32> {
    (0..(seconds / DT).round() as usize)
        .map(|_| {
            run(&mut stage.app, DT);
            stage.get::<SpringReadout>(element).length
        })
        .collect()
}

/// Frequency, Hz, from the times of the first and the last rise through `middle`.
fn frequency(series: &[f32], middle: f32) -> f32 {
    let rises: Vec<f32> = series
        .windows(2)
        .enumerate()
        .filter(|(_, w)| w[0] < middle && w[1] >= middle)
        .map(|(i, w)| i as f32 + (middle - w[0]) / (w[1] - w[0]))
        .collect();
    let (first, last) = (rises[0], rises[rises.len() - 1]);
    (rises.len() - 1) as f32 / ((last - first) * DT)
}

#[test]
fn every_element_of_the_blender_scene_arrives_and_can_act() {
    let (mut stage, _) = scene();
    assert_eq!(stage.count::<SpringReadout>(), 4 + 2 * 13 + 5);
    assert_eq!(stage.faults(), Vec::<String>::new());
    run(&mut stage.app, 1.0);
    assert_eq!(stage.faults(), Vec::<String>::new());
}

#[test]
fn a_spring_from_blender_swings_at_the_frequency_and_about_the_sag_that_its_panel_shows() {
    let (mut stage, root) = scene();
    let spring = stage.node(root, "Spring Beam Load spring");
    let series = lengths(&mut stage, spring, 8.0);
    // 4 kg on 400 N/m with a rest length of 0.9 m.
    let (wanted, sag) = (
        (400.0_f32 / 4.0).sqrt() / std::f32::consts::TAU,
        4.0 * G / 400.0,
    );
    let found = frequency(&series, 0.9 + sag);
    assert!(
        (found / wanted - 1.0).abs() < 2e-3,
        "{found} Hz, not {wanted}"
    );
    let (low, high) = series
        .iter()
        .fold((f32::MAX, f32::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
    assert!(
        (0.5 * (low + high) - 0.9 - sag).abs() < 2e-3,
        "between {low} and {high}"
    );
}

#[test]
fn a_damped_spring_from_blender_comes_to_rest_at_its_sag() {
    let (mut stage, root) = scene();
    let pair = stage.node(root, "SpringDamper Beam Load springDamper");
    let series = lengths(&mut stage, pair, 10.0);
    let rest = series[series.len() - 1];
    assert!((rest - 0.9 - 4.0 * G / 400.0).abs() < 1e-3, "{rest}");
}

#[test]
fn a_damper_from_blender_lets_its_load_sink_at_weight_over_damping() {
    let (mut stage, root) = scene();
    let damper = stage.node(root, "Damper Beam Load damper");
    let series = lengths(&mut stage, damper, 3.0);
    let (from, to) = (series[60], series[179]);
    let speed = (to - from) / (119.0 * DT);
    assert!(
        (speed / (4.0 * G / 200.0) - 1.0).abs() < 5e-3,
        "{speed} m/s"
    );
}

#[test]
fn a_torsion_spring_from_blender_swings_about_where_moment_and_weight_are_equal() {
    let (mut stage, root) = scene();
    let spring = stage.node(root, "TorsionSpring Beam Lever torsionSpring");
    let series = lengths(&mut stage, spring, 8.0);
    let (low, high) = series
        .iter()
        .fold((f32::MAX, f32::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
    // Energy balance from rest at level to the lowest angle a: the spring stores k a²/2, which is the work of the
    // weight, m g (L/2) sin a. Solved for a by Newton's method.
    let given = |a: f32| 2.0 * G * 0.35 * a.sin() - 12.5 * a * a;
    let mut lowest = 0.5;
    for _ in 0..40 {
        lowest -= given(lowest) / (2.0 * G * 0.35 * lowest.cos() - 25.0 * lowest);
    }
    let reach = high.abs().max(low.abs());
    assert!(
        (reach / lowest - 1.0).abs() < 0.02,
        "{low} to {high} rad, not {lowest}"
    );
    assert!(
        high.abs().min(low.abs()) < 0.02,
        "it starts level: {low} to {high} rad"
    );
}

#[test]
fn the_car_from_blender_stands_on_its_four_coilovers_where_it_stood_in_blender() {
    let (mut stage, root) = scene();
    let chassis = stage.node(root, "Chassis");
    let start = stage.place(chassis);
    let mut lowest = f32::MAX;
    for _ in 0..240 {
        run(&mut stage.app, DT);
        lowest = lowest.min(stage.place(chassis).translation.y);
    }
    let end = stage.place(chassis);
    assert!(
        (end.translation - start.translation).length() < 0.02,
        "{start:?} {end:?}"
    );
    assert!(
        start.translation.y - lowest < 0.02,
        "it does not fall first: {lowest}"
    );
    assert!((end.rotation * Vec3::Y).y > 0.9995, "{end:?}");
    for name in ["Front Left", "Front Right", "Rear Left", "Rear Right"] {
        let wheel = stage.place(stage.node(root, &format!("Wheel {name}")));
        assert!(
            (wheel.translation.y - 0.34).abs() < 0.01,
            "{name} {wheel:?}"
        );
        let knuckle = stage.place(stage.node(root, &format!("Knuckle {name}")));
        assert!((knuckle.rotation * Vec3::Y).y > 0.999, "{name} {knuckle:?}");
    }
}

#[test]
fn the_bridge_from_blender_hangs_by_its_ropes_and_bears_a_weight() {
    let (mut stage, root) = scene();
    let height = |stage: &Stage, i: u32| {
        stage
            .place(stage.node(root, &format!("Plank {i:02}")))
            .translation
            .y
    };
    run(&mut stage.app, 4.0);
    let empty = height(&stage, 6);
    assert!(
        empty < 0.87 && empty > 0.3,
        "it sags, and does not fall: {empty}"
    );
    assert!(empty < height(&stage, 1) && empty < height(&stage, 12));
    let above = stage.place(stage.node(root, "Plank 06")).translation + 0.3 * Vec3::Y;
    stage.app.world_mut().spawn((
        RigidBody::Dynamic,
        Collider::cuboid(0.15, 0.15, 0.15),
        ColliderMassProperties::Mass(40.0),
        Transform::from_translation(above),
    ));
    run(&mut stage.app, 4.0);
    let laden = height(&stage, 6);
    assert!(laden < empty - 0.005 && laden > 0.2, "{empty} {laden}");
}
