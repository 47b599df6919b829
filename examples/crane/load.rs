//! What hangs: trolley, cables, hook block, slings and crate; and the programme that drives them.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Rope, Shape};

pub const GRAVITY: f32 = 9.81;
/// Of the jib above the ground, and of the places where the crate is set down from the middle, m.
pub const JIB: f32 = 7.6;
pub const REACH: f32 = 3.0;
/// Of the hook block and the crate, kg.
pub const HOOK: f32 = 120.0;
pub const CRATE: f32 = 900.0;
/// Of the crate, m.
pub const SIZE: Vec3 = Vec3::new(1.5, 1.1, 1.2);
/// Of the hook below the cables' ends, and above the crate, m.
pub const BLOCK: f32 = 0.5;
pub const SLING: f32 = 1.1;
/// Half the distance of the two cables, m.
const FALLS: f32 = 0.16;
/// Force at which a cable would be twice as long, N: its stiffness is this over its length.
const CABLE: f32 = 1.2e6;
/// Of a sling, N/m.
const STRAP: f32 = 2e5;
/// What air takes of every speed, 1/s.
pub const AIR: f32 = 0.2;
/// Length of the cables without force, m: down, with the slings slack, and up.
pub const LENGTHS: [f32; 2] = [LEVEL - SLING - BLOCK + SLACK, 2.2];
/// From the jib down to the top of a crate on the ground, m.
const LEVEL: f32 = JIB - SIZE.y;
const SLACK: f32 = 0.2;
/// Seconds of one way.
pub const ROUND: f32 = 40.0;
/// When it is lifted, carried and set down, s.
pub const LIFT: [f32; 2] = [3.0, 8.5];
pub const CARRY: [f32; 2] = [11.0, 17.0];
pub const SET: [f32; 2] = [30.5, 36.0];

/// It runs along the jib; no body, for nothing moves it but its motor.
#[derive(Component)]
pub struct Trolley;

#[derive(Component)]
pub struct Hook;

#[derive(Component)]
pub struct Crate;

/// An element from the trolley to the hook.
#[derive(Component)]
pub struct Cable;

/// An element from the hook to a corner of the crate.
#[derive(Component)]
pub struct Sling;

/// From 0 to 1 between two moments, gently at both ends.
fn gently(t: f32, [from, to]: [f32; 2]) -> f32 {
    EaseFunction::SmootherStep.sample_clamped((t - from) / (to - from))
}

/// Where the trolley is: there and back again.
pub fn place(time: f32) -> f32 {
    let there = ((time / ROUND) as u32).is_multiple_of(2);
    let x = REACH * (2.0 * gently(time % ROUND, CARRY) - 1.0);
    if there { x } else { -x }
}

/// How long the cables are without force.
pub fn length(time: f32) -> f32 {
    let up = gently(time % ROUND, LIFT) - gently(time % ROUND, SET);
    LENGTHS[0] + (LENGTHS[1] - LENGTHS[0]) * up
}

pub fn spawn(mut commands: Commands) {
    let trolley = commands
        .spawn((
            Transform::from_xyz(place(0.0), JIB, 0.0),
            Shape::Cuboid(Vec3::new(0.9, 0.14, 0.9), Paint::Red),
            Trolley,
        ))
        .id();
    let hook = hook(&mut commands);
    let load = crate_(&mut commands);
    for z in [-FALLS, FALLS] {
        let (stiffness, length) = cable(0.0);
        commands.spawn((
            SpringDamper::new(trolley, hook)
                .with_stiffness(stiffness)
                .with_damping(0.2 * (stiffness * 0.5 * (HOOK + CRATE)).sqrt())
                .with_rest_length(length),
            SpringAction::Pull,
            Anchors::new(Vec3::Z * z, Vec3::Z * z),
            Rope {
                radius: 0.025,
                length: 3.5,
                paint: Paint::Iron,
            },
            Cable,
        ));
    }
    for x in [-0.5, 0.5] {
        for z in [-0.5, 0.5] {
            let corner = Vec3::new(x, 0.5, z) * SIZE;
            let length = Vec3::new(corner.x, SLING, corner.z).length();
            commands.spawn((
                SpringDamper::new(hook, load)
                    .with_stiffness(STRAP)
                    .with_damping(0.2 * (STRAP * HOOK).sqrt())
                    .with_rest_length(length),
                SpringAction::Pull,
                Anchors::new(Vec3::NEG_Y * BLOCK, corner),
                Rope {
                    radius: 0.03,
                    length,
                    paint: Paint::Hemp,
                },
                Sling,
            ));
        }
    }
}

/// Two sheaves, and the hook below them.
fn hook(commands: &mut Commands) -> Entity {
    let across = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let sheave = |z| {
        let at = Transform::from_xyz(0.0, 0.0, z).with_rotation(across);
        (at, Shape::Cylinder(0.2, 0.1, Paint::Iron))
    };
    let body = (
        RigidBody::Dynamic,
        AdditionalMassProperties::Mass(HOOK),
        // Held upright by the two cables.
        LockedAxes::ROTATION_LOCKED,
        air(),
        Velocity::default(),
        Transform::from_xyz(place(0.0), JIB - length(0.0) - 0.003, 0.0),
        Visibility::default(),
        Hook,
        children![
            sheave(-FALLS),
            sheave(FALLS),
            (
                Transform::from_xyz(0.0, -0.12, 0.0),
                Shape::Cuboid(Vec3::new(0.26, 0.26, 0.2), Paint::Red),
            ),
            (
                Transform::from_xyz(0.0, -0.36, 0.0),
                Shape::Cylinder(0.045, 0.3, Paint::Iron),
            ),
            (
                Transform::from_xyz(0.0, -BLOCK, 0.0).with_rotation(across),
                Shape::Capsule(0.07, 0.12, Paint::Iron),
            ),
        ],
    );
    commands.spawn(body).id()
}

/// Boards, and a frame about them.
fn crate_(commands: &mut Commands) -> Entity {
    let body = (
        RigidBody::Dynamic,
        Collider::cuboid(0.5 * SIZE.x, 0.5 * SIZE.y, 0.5 * SIZE.z),
        ColliderMassProperties::Mass(CRATE),
        air(),
        Velocity::default(),
        Transform::from_xyz(place(0.0), 0.5 * SIZE.y, 0.0),
        Shape::Cuboid(SIZE - 0.06, Paint::Wood),
        Crate,
    );
    let mut load = commands.spawn(body);
    load.with_children(|parts| {
        let mut beam = |at: Vec3, size: Vec3| {
            parts.spawn((
                Transform::from_translation(at),
                Shape::Cuboid(size, Paint::Sand),
            ));
        };
        let (half, width) = (0.5 * SIZE - 0.05, 0.1);
        for a in [-1.0, 1.0] {
            for b in [-1.0, 1.0] {
                beam(half * Vec3::new(0.0, a, b), Vec3::new(SIZE.x, width, width));
                beam(half * Vec3::new(a, 0.0, b), Vec3::new(width, SIZE.y, width));
                beam(half * Vec3::new(a, b, 0.0), Vec3::new(width, width, SIZE.z));
            }
        }
    });
    load.id()
}

fn air() -> Damping {
    Damping {
        linear_damping: AIR,
        angular_damping: AIR,
    }
}

/// Stiffness of a cable, and its length without force.
fn cable(time: f32) -> (f32, f32) {
    let length = length(time);
    (CABLE / length, length)
}

/// The winch takes cable in and lets it out, and the motor moves the trolley.
pub fn drive(
    time: Res<Time>,
    mut trolleys: Query<&mut Transform, With<Trolley>>,
    mut cables: Query<&mut SpringDamper, With<Cable>>,
) {
    let now = time.elapsed_secs();
    for mut trolley in &mut trolleys {
        let x = place(now);
        // What is written wakes what sleeps.
        if trolley.translation.x != x {
            trolley.translation.x = x;
        }
    }
    for mut element in &mut cables {
        let (stiffness, length) = cable(now);
        if element.rest_length != Some(length) {
            element.stiffness = stiffness;
            element.rest_length = Some(length);
        }
    }
}
