//! Cubic springs, F = k x³, on rails. A larger amplitude gives a shorter period: T = 7.4163 √(m/k)/A.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, PictureAt, Shape, Stage, Track, larger, tracks};
use std::f32::consts::TAU;

/// Stiffness, N/m³.
const STIFFNESS: f32 = 60.0;
const MASS: f32 = 1.0;
const REST: f32 = 1.5;
/// Amplitude of each body, m.
const AMPLITUDES: [f32; 3] = [0.9, 0.6, 0.3];
/// Edge of a body, m.
const SIZE: f32 = 0.3;
/// Position along x of the wall that holds the springs, m.
const WALL: f32 = -1.7;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "nonlinear_spring",
        setup: |app| {
            app.insert_resource(PictureAt(10.1))
                .add_systems(Begin, setup);
        },
        seconds: 16.0,
        again: f32::INFINITY,
        check,
        eye: Vec3::new(1.3, 2.2, 5.4),
        target: Vec3::new(-0.05, 0.95, 0.0),
    })
}

fn setup(mut commands: Commands) {
    commands.spawn(stage::floor());
    let wall = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_xyz(WALL - 0.1, 1.0, 0.0),
            Shape::Cuboid(Vec3::new(0.2, 2.0, 0.6), Paint::Iron),
        ))
        .id();
    let far = 1.75;
    commands.spawn((
        Transform::from_xyz(far, 1.0, 0.0),
        Shape::Cuboid(Vec3::new(0.06, 2.0, 0.3), Paint::Iron),
    ));
    for (i, amplitude) in AMPLITUDES.into_iter().enumerate() {
        let y = 1.65 - 0.65 * i as f32;
        // The rail through coil and body is visual only. The locked axes guide the body.
        commands.spawn((
            Transform::from_xyz(0.5 * (WALL + far), y, 0.0)
                .with_rotation(Quat::from_rotation_z(TAU / 4.0)),
            Shape::Cylinder(0.025, far - WALL, Paint::Ivory),
        ));
        let body = commands
            .spawn((
                RigidBody::Dynamic,
                AdditionalMassProperties::Mass(MASS),
                GravityScale(0.0),
                LockedAxes::ROTATION_LOCKED
                    | LockedAxes::TRANSLATION_LOCKED_Y
                    | LockedAxes::TRANSLATION_LOCKED_Z,
                Transform::from_xyz(WALL + REST + amplitude + 0.5 * SIZE, y, 0.0),
                Shape::Cuboid(Vec3::splat(SIZE), Paint::Blue),
            ))
            .id();
        commands.spawn((
            Spring::new(wall, body)
                .with_stiffness(STIFFNESS)
                .with_rest_length(REST),
            SpringLaw::Cubic,
            Anchors::new(Vec3::new(0.1, y - 1.0, 0.0), Vec3::NEG_X * 0.5 * SIZE),
            Coil::new(0.1, 0.016, 12.0),
            Track::default(),
        ));
    }
}

fn check(world: &mut World) -> Vec<Finding> {
    let mut out = Vec::new();
    for (amplitude, track) in AMPLITUDES.into_iter().zip(tracks(world)) {
        let theory = 7.416_299 * (MASS / STIFFNESS).sqrt() / amplitude;
        let measured = 1.0 / track.frequency(REST);
        let name = format!("period at {amplitude} m");
        out.push(Finding::close(&name, measured, theory, "s", 1.5e-3));
        let reach = track.0.iter().map(|(_, r)| r.length - REST);
        let reach = reach.fold(0.0, larger);
        out.push(Finding::close("  swings to", reach, amplitude, "m", 1e-3));
        let wrong = track.0.iter().map(|(_, r)| {
            let stretch = r.length - REST;
            (r.spring_force - STIFFNESS * stretch.powi(3)).abs()
        });
        let wrong = wrong.fold(0.0, larger);
        out.push(Finding::small("  force beside the law", wrong, 1e-3, "N"));
    }
    out
}
