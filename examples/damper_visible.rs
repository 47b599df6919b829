//! A damper drawn as two cylinders that slide into each other: a weight sinks at a steady speed.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, Shape, Stage, Track, Upright, tracks};

const DAMPING: f32 = 60.0;
const MASS: f32 = 2.0;
const GRAVITY: f32 = 9.81;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "damper_visible",
        setup: |app| {
            app.add_systems(Begin, setup);
        },
        seconds: 1.4,
        again: 3.0,
        check,
        eye: Vec3::new(1.0, 1.5, 3.6),
        target: Vec3::new(0.0, 1.0, 0.0),
    })
}

fn setup(mut commands: Commands) {
    commands.spawn(stage::floor());
    let beam = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_xyz(0.0, 1.9, 0.0),
            Shape::Cuboid(Vec3::new(0.8, 0.1, 0.4), Paint::Iron),
        ))
        .id();
    let weight = commands
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::Mass(MASS),
            Transform::from_xyz(0.0, 1.0, 0.0),
            Shape::Cuboid(Vec3::splat(0.3), Paint::Blue),
            Upright(0.05),
        ))
        .id();
    commands.spawn((
        Damper::new(beam, weight).with_damping(DAMPING),
        Anchors::new(Vec3::NEG_Y * 0.05, Vec3::Y * 0.15),
        Telescope {
            // Long enough for 0.7 m at the start, short enough for the length at the end.
            tube_length: Some(0.62),
            rod_length: Some(0.62),
            ..Telescope::new(0.075, 0.035)
        },
        Track::default(),
    ));
}

fn check(world: &mut World) -> Vec<Finding> {
    let theory = MASS * GRAVITY / DAMPING;
    let last = tracks(world)[0].last();
    vec![
        Finding::close("steady speed", last.rate, theory, "m/s", 1e-3),
        Finding::close("force", last.damper_force, MASS * GRAVITY, "N", 1e-3),
    ]
}
