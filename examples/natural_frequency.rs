//! Four bodies on springs from soft to stiff, each oscillating at its own natural frequency.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, Shape, Stage, Track, Upright, tracks};
use std::f32::consts::TAU;

const STIFFNESS: [f32; 4] = [40.0, 160.0, 640.0, 2_560.0];
const MASS: f32 = 2.0;
const REST: f32 = 0.9;
const GRAVITY: f32 = 9.81;
/// Height of the beam's underside, m.
const BEAM: f32 = 2.3;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "natural_frequency",
        setup: |app| {
            app.add_systems(Begin, setup);
        },
        seconds: 10.0,
        again: f32::INFINITY,
        check,
        eye: Vec3::new(0.9, 1.9, 5.4),
        target: Vec3::new(0.0, 1.25, 0.0),
    })
}

/// Returns the length of a spring that holds its body at rest, m.
fn rest(stiffness: f32) -> f32 {
    REST + MASS * GRAVITY / stiffness
}

fn setup(mut commands: Commands) {
    commands.spawn(stage::floor());
    let beam = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_xyz(0.0, BEAM + 0.05, 0.0),
            Shape::Cuboid(Vec3::new(3.0, 0.1, 0.4), Paint::Iron),
        ))
        .id();
    for (i, stiffness) in STIFFNESS.into_iter().enumerate() {
        let x = 0.7 * (i as f32 - 1.5);
        // Released 5 cm above the position at rest.
        let length = rest(stiffness) - 0.05;
        let body = commands
            .spawn((
                RigidBody::Dynamic,
                AdditionalMassProperties::Mass(MASS),
                Transform::from_xyz(x, BEAM - length - 0.15, 0.0),
                Shape::Cuboid(Vec3::splat(0.3), Paint::Blue),
                Upright(0.05),
            ))
            .id();
        // The stiffness grows with the fourth power of the wire's thickness.
        let wire = 0.009 * (stiffness / STIFFNESS[0]).powf(0.25);
        commands.spawn((
            Spring::new(beam, body)
                .with_stiffness(stiffness)
                .with_rest_length(REST),
            Anchors::new(Vec3::new(x, -0.05, 0.0), Vec3::Y * 0.15),
            Coil::new(0.1, wire, 9.0),
            Track::default(),
        ));
    }
}

fn check(world: &mut World) -> Vec<Finding> {
    STIFFNESS
        .into_iter()
        .zip(tracks(world))
        .map(|(stiffness, track)| {
            let theory = (stiffness / MASS).sqrt() / TAU;
            let measured = track.frequency(rest(stiffness));
            Finding::close(&format!("{stiffness} N/m"), measured, theory, "Hz", 1e-3)
        })
        .collect()
}
