//! Two bodies joined by a spring at rest fall as free bodies do, and the spring keeps its length.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, DT, Finding, Paint, Shape, Stage, Track, tracks};

const GRAVITY: f32 = 9.81;
const SECONDS: f32 = 0.5;
const HEIGHT: f32 = 2.2;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "free_fall",
        setup: |app| {
            app.add_systems(Begin, setup);
        },
        seconds: SECONDS,
        again: 4.0,
        check,
        eye: Vec3::new(0.8, 1.9, 5.6),
        target: Vec3::new(0.0, 1.2, 0.0),
    })
}

#[derive(Component)]
struct Lone;

#[derive(Component)]
struct Joined;

fn setup(mut commands: Commands) {
    commands
        .spawn(stage::floor())
        .insert(Collider::cuboid(20.0, 0.05, 20.0));
    let ball = |x: f32, y: f32, paint| {
        (
            RigidBody::Dynamic,
            Collider::ball(0.16),
            ColliderMassProperties::Mass(1.0),
            Restitution::coefficient(0.6),
            Transform::from_xyz(x, y, 0.0),
            Shape::Ball(0.16, paint),
        )
    };
    commands.spawn((ball(-0.8, HEIGHT, Paint::Ivory), Lone));
    let a = commands
        .spawn((ball(0.0, HEIGHT, Paint::Blue), Joined))
        .id();
    let b = commands.spawn(ball(1.0, HEIGHT + 0.5, Paint::Blue)).id();
    commands.spawn((
        Spring::new(a, b).with_stiffness(400.0),
        Coil::new(0.09, 0.012, 11.0),
        Track::default(),
    ));
}

fn check(world: &mut World) -> Vec<Finding> {
    let mut height = |lone: bool| {
        let mut query = world.query::<(&Transform, Has<Lone>, Has<Joined>)>();
        let found = query
            .iter(world)
            .find(|(_, is_lone, is_joined)| if lone { *is_lone } else { *is_joined });
        found.map_or(f32::NAN, |(at, ..)| at.translation.y)
    };
    let (lone, joined) = (height(true), height(false));
    let track = tracks(world)[0];
    let length = 1.25_f32.sqrt();
    let t = track.0.len() as f32 * DT;
    let fallen = 0.5 * GRAVITY * t * t;
    vec![
        Finding::close("joined bodies fell", HEIGHT - joined, fallen, "m", 1e-5),
        // Without springs, Rapier is ahead of the parabola by part of a step.
        Finding::close("a lone one fell", HEIGHT - lone, fallen, "m", DT / SECONDS),
        Finding::small("change of length", track.error(|_| length), 2e-6, "m"),
    ]
}
