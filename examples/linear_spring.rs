//! The simplest spring: it carries a body above a plane. It acts only vertically, so the body can drift sideways
//! freely.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, DT, Finding, Paint, PictureAt, Shape, Stage, Track, tracks};

const STIFFNESS: f32 = 20.0;
const MASS: f32 = 1.0;
const REST: f32 = 1.2;
const GRAVITY: f32 = 9.81;
/// Length minus rest length at the start, m.
const STRETCH: f32 = -0.1;
/// Position along x at the start, m.
const START: f32 = -1.9;
/// Horizontal velocity of the body, m/s.
const DRIFT: f32 = 0.65;
/// Height of the shoe's top above the plane, m.
const SHOE: f32 = 0.06;
/// Half the edge of the body, m.
const HALF: f32 = 0.16;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "linear_spring",
        setup: |app| {
            app.insert_resource(PictureAt(5.1))
                .add_systems(Begin, (stage::fresh::<Drift>, setup))
                .add_systems(FixedUpdate, follow.before(PhysicsSet::SyncBackend))
                .add_systems(FixedUpdate, trace.after(CoiloverSystems::Readout));
        },
        seconds: 7.6,
        again: 7.6,
        check,
        eye: Vec3::new(0.5, 1.75, 5.9),
        target: Vec3::new(-0.1, 0.7, 0.0),
    })
}

/// Largest difference from a steady drift, m.
#[derive(Resource, Default)]
struct Drift(f32);

#[derive(Component)]
struct Body;

/// The part that the spring stands on.
#[derive(Component)]
struct Shoe;

fn setup(mut commands: Commands) {
    commands.spawn(stage::floor());
    // The shoe has no rigid body and glides below the body, so that the coil is drawn upright.
    let shoe = commands
        .spawn((
            Transform::from_xyz(START, 0.5 * SHOE, 0.0),
            Shape::Cuboid(Vec3::new(0.42, SHOE, 0.3), Paint::Iron),
            Shoe,
        ))
        .id();
    let body = commands
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::Mass(MASS),
            Velocity::linear(Vec3::X * DRIFT),
            Transform::from_xyz(START, SHOE + REST + STRETCH + HALF, 0.0),
            Shape::Cuboid(Vec3::splat(2.0 * HALF), Paint::Blue),
            Body,
        ))
        .id();
    commands.spawn((
        Spring::new(shoe, body)
            .with_stiffness(STIFFNESS)
            .with_rest_length(REST),
        SpringAxis::World(Vec3::Y),
        Anchors::new(Vec3::Y * 0.5 * SHOE, Vec3::NEG_Y * HALF),
        Coil::new(0.11, 0.014, 9.0),
        Track::default(),
    ));
}

/// Keeps the shoe below the body. This does not affect the spring's force.
fn follow(
    mut shoes: Query<&mut Transform, With<Shoe>>,
    bodies: Query<&Transform, (With<Body>, Without<Shoe>)>,
) {
    for (mut shoe, body) in shoes.iter_mut().zip(&bodies) {
        shoe.translation.x = body.translation.x;
    }
}

/// Spawns a mark twenty times a second, and records the largest error of the drift.
fn trace(
    time: Res<Time>,
    mut drift: ResMut<Drift>,
    bodies: Query<&Transform, With<Body>>,
    mut commands: Commands,
) {
    let tick = stage::tick(&time);
    for body in &bodies {
        let steady = START + DRIFT * DT * tick as f32;
        drift.0 = drift.0.max((body.translation.x - steady).abs());
        if tick.is_multiple_of(3) {
            let behind = Transform::from_translation(body.translation.with_z(-HALF - 0.05));
            commands.spawn((behind, Shape::Ball(0.022, Paint::Ivory)));
        }
    }
}

fn check(world: &mut World) -> Vec<Finding> {
    let drift = world.resource::<Drift>().0;
    // m ÿ = −k (y − rest) − m g from rest at y = rest + stretch.
    let (middle, omega) = (REST - MASS * GRAVITY / STIFFNESS, (STIFFNESS / MASS).sqrt());
    let track = tracks(world)[0];
    let swing = REST + STRETCH - middle;
    let error = track.error(|t| middle + swing * (omega * t).cos());
    vec![
        Finding::small("largest error of the height", error, 2e-4, "m"),
        Finding::small("largest error of the drift", drift, 5e-4, "m"),
        Finding::close(
            "frequency",
            track.frequency(middle),
            omega / std::f32::consts::TAU,
            "Hz",
            5e-4,
        ),
    ]
}
