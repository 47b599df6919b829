//! A coilover as on a car: a spring with real wire data, a damper, eyes, a bump rubber and spring seats.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, Shape, Stage, Track, Upright, tracks};

const MASS: f32 = 350.0;
const DAMPING: f32 = 2_500.0;
const REST: f32 = 0.62;
const GRAVITY: f32 = 9.81;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "coilover_visible",
        setup: |app| {
            app.add_systems(Begin, setup);
        },
        seconds: 4.0,
        again: 7.0,
        check,
        eye: Vec3::new(0.45, 0.85, 1.3),
        target: Vec3::new(0.0, 0.47, 0.0),
    })
}

/// Wire of 13 mm, coil of 115 mm, six active turns, spring steel.
fn wound() -> WoundCoil {
    match Coil::from_wire(0.013, 0.115, 6.0, 79.3e9) {
        Ok(wound) => wound,
        Err(wrong) => unreachable!("{wrong}"),
    }
}

fn setup(mut commands: Commands) {
    commands.spawn(stage::floor());
    let foot = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_xyz(0.0, 0.1, 0.0),
            Shape::Cuboid(Vec3::new(0.3, 0.2, 0.3), Paint::Iron),
        ))
        .id();
    let car = commands
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::Mass(MASS),
            LockedAxes::ROTATION_LOCKED
                | LockedAxes::TRANSLATION_LOCKED_X
                | LockedAxes::TRANSLATION_LOCKED_Z,
            Transform::from_xyz(0.0, 0.24 + REST + 0.1, 0.0),
            Shape::Cuboid(Vec3::new(0.5, 0.12, 0.4), Paint::Blue),
            Upright(0.01),
        ))
        .id();
    let wound = wound();
    // The rod's end is on the car, the tube's end below.
    commands.spawn(coilover(foot, car)).insert((
        SpringDamper::new(foot, car)
            .with_stiffness(wound.stiffness)
            .with_damping(DAMPING)
            .with_rest_length(REST),
        Anchors::new(Vec3::Y * 0.14, Vec3::NEG_Y * 0.1),
        wound.coil,
        Telescope {
            tube_length: Some(0.3),
            ..Telescope::new(0.034, 0.012)
                .with_stroke(0.26)
                .with_fittings()
        },
        Track::default(),
    ));
}

fn check(world: &mut World) -> Vec<Finding> {
    let stiffness = wound().stiffness;
    let sag = REST - tracks(world)[0].last().length;
    // The formula, written out with the same values.
    let theory = 79.3e9 * 0.013_f32.powi(4) / (8.0 * 0.115_f32.powi(3) * 6.0);
    vec![
        Finding::close("stiffness of the wire", stiffness, theory, "N/m", 1e-4),
        Finding::close("sag", sag, MASS * GRAVITY / theory, "m", 1e-3),
    ]
}
