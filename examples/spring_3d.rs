//! A spring between two free bodies above a plane: they oscillate about their common centre of mass.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, Shape, Stage, Track, tracks};
use std::f32::consts::TAU;

const STIFFNESS: f32 = 60.0;
const MASSES: [f32; 2] = [1.0, 2.0];
const REST: f32 = 1.0;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "spring_3d",
        setup: |app| {
            app.add_systems(Begin, setup);
        },
        seconds: 6.2,
        again: f32::INFINITY,
        check,
        eye: Vec3::new(0.6, 1.9, 4.2),
        target: Vec3::new(0.0, 0.9, 0.0),
    })
}

fn setup(mut commands: Commands) {
    commands.spawn(stage::floor());
    let mut ball = |mass: f32, at: Vec3, paint| {
        let radius = 0.18 * mass.cbrt();
        commands
            .spawn((
                RigidBody::Dynamic,
                AdditionalMassProperties::Mass(mass),
                GravityScale(0.0),
                Velocity::default(),
                Transform::from_translation(at),
                Shape::Ball(radius, paint),
            ))
            .id()
    };
    // Released 0.35 m too far apart.
    let a = ball(MASSES[0], Vec3::new(-0.75, 0.8, 0.0), Paint::Blue);
    let b = ball(MASSES[1], Vec3::new(0.6, 0.8, 0.0), Paint::Ivory);
    commands.spawn((
        Spring::new(a, b)
            .with_stiffness(STIFFNESS)
            .with_rest_length(REST),
        Coil::new(0.11, 0.014, 10.0),
        Track::default(),
    ));
}

fn check(world: &mut World) -> Vec<Finding> {
    let reduced = MASSES[0] * MASSES[1] / (MASSES[0] + MASSES[1]);
    let theory = (STIFFNESS / reduced).sqrt() / TAU;
    let measured = tracks(world)[0].frequency(REST);
    let momentum: Vec3 = world
        .query::<(&AdditionalMassProperties, &Velocity)>()
        .iter(world)
        .map(|(mass, velocity)| match mass {
            AdditionalMassProperties::Mass(mass) => *mass * velocity.linear,
            AdditionalMassProperties::MassProperties(all) => all.mass * velocity.linear,
        })
        .sum();
    vec![
        Finding::close("frequency of the pair", measured, theory, "Hz", 1e-4),
        Finding::small("momentum won or lost", momentum.length(), 1e-4, "kg m/s"),
    ]
}
