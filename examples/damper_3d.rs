//! A damper between two free bodies above a plane: their relative velocity decays.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, Shape, Stage, Track, tracks};

const DAMPING: f32 = 1.5;
const MASSES: [f32; 2] = [1.0, 2.0];
const SPEED: f32 = 1.2;
const LENGTH: f32 = 0.8;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "damper_3d",
        setup: |app| {
            app.add_systems(Begin, setup);
        },
        seconds: 2.0,
        again: 4.0,
        check,
        eye: Vec3::new(0.1, 1.8, 3.8),
        target: Vec3::new(-0.6, 0.75, 0.0),
    })
}

fn setup(mut commands: Commands) {
    commands.spawn(stage::floor());
    let mut ball = |mass: f32, at: Vec3, speed: f32, paint| {
        let radius = 0.18 * mass.cbrt();
        commands
            .spawn((
                RigidBody::Dynamic,
                AdditionalMassProperties::Mass(mass),
                GravityScale(0.0),
                Velocity::linear(Vec3::X * speed),
                Transform::from_translation(at),
                Shape::Ball(radius, paint),
            ))
            .id()
    };
    let a = ball(MASSES[0], Vec3::new(-0.4, 0.8, 0.0), -SPEED, Paint::Blue);
    let b = ball(MASSES[1], Vec3::new(0.4, 0.8, 0.0), 0.0, Paint::Ivory);
    commands.spawn((
        Damper::new(a, b).with_damping(DAMPING),
        Telescope::new(0.06, 0.028).with_stroke(0.5),
        Track::default(),
    ));
}

fn check(world: &mut World) -> Vec<Finding> {
    let reduced = MASSES[0] * MASSES[1] / (MASSES[0] + MASSES[1]);
    let rate = DAMPING / reduced;
    let track = tracks(world)[0];
    let error = track.error(|t| LENGTH + SPEED / rate * (1.0 - (-rate * t).exp()));
    let half = track.0.iter().find(|(_, r)| r.rate < 0.5 * SPEED);
    let half = half.map_or(f32::NAN, |(t, _)| *t);
    vec![
        Finding::small("largest error of the length", error, 1e-4, "m"),
        // Exact to one tick: that in which the speed falls below half.
        Finding::close(
            "half the speed is gone after",
            half,
            2.0_f32.ln() / rate,
            "s",
            0.06,
        ),
    ]
}
