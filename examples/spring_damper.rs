//! A soft spring and a damper side by side, 7 N/m and 2 N s/m: a body of 1 kg comes to rest.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, Shape, Stage, Track, Upright, tracks};

const STIFFNESS: f32 = 7.0;
const DAMPING: f32 = 2.0;
const MASS: f32 = 1.0;
const REST: f32 = 0.8;
const GRAVITY: f32 = 9.81;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "spring_damper",
        setup: |app| {
            app.add_systems(Begin, setup);
        },
        seconds: 8.0,
        again: 11.0,
        check,
        eye: Vec3::new(1.4, 2.3, 6.0),
        target: Vec3::new(0.0, 1.75, 0.0),
    })
}

fn setup(mut commands: Commands) {
    commands.spawn(stage::floor());
    let beam = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_xyz(0.0, 3.2, 0.0),
            Shape::Cuboid(Vec3::new(1.0, 0.1, 0.5), Paint::Iron),
        ))
        .id();
    let body = commands
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::Mass(MASS),
            Transform::from_xyz(0.0, 3.15 - REST - 0.2, 0.0),
            Shape::Cuboid(Vec3::splat(0.4), Paint::Blue),
            Upright(0.05),
        ))
        .id();
    commands.spawn((
        SpringDamper::new(beam, body)
            .with_stiffness(STIFFNESS)
            .with_damping(DAMPING)
            .with_rest_length(REST),
        Anchors::new(Vec3::NEG_Y * 0.05, Vec3::Y * 0.2),
        Coil::new(0.16, 0.018, 10.0),
        Track::default(),
    ));
}

fn check(world: &mut World) -> Vec<Finding> {
    // Released under gravity at the rest length.
    let sag = MASS * GRAVITY / STIFFNESS;
    let decay = DAMPING / (2.0 * MASS);
    let turn = (STIFFNESS / MASS - decay * decay).sqrt();
    let track = tracks(world)[0];
    let error = track.error(|t| {
        let swing = (turn * t).cos() + decay / turn * (turn * t).sin();
        REST + sag * (1.0 - (-decay * t).exp() * swing)
    });
    vec![
        Finding::small("largest error of the length", error, 5e-4, "m"),
        Finding::close("at rest", track.last().length, REST + sag, "m", 1e-3),
    ]
}
