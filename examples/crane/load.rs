//! The moving parts: trolley, cables, hook block, slings and crate, and the programme that drives them.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Rope, Shape};

pub const GRAVITY: f32 = 9.81;
/// Height of the jib above the ground, m.
pub const JIB: f32 = 7.6;
/// Distance from the middle to the places where the crate is set down, m.
pub const REACH: f32 = 3.0;
/// Mass of the hook block, kg.
pub const HOOK: f32 = 120.0;
/// Mass of the crate, kg.
pub const CRATE: f32 = 900.0;
/// Size of the crate, m.
pub const SIZE: Vec3 = Vec3::new(1.5, 1.1, 1.2);
/// Height of the cables' ends above the hook, m.
pub const BLOCK: f32 = 0.5;
/// Height of the hook above the crate, m.
pub const SLING: f32 = 1.1;
/// Half the distance between the two cables, m.
const FALLS: f32 = 0.16;
/// Axial stiffness of a cable, N: stiffness times length.
const CABLE: f32 = 1.2e6;
/// Stiffness of a sling, N/m.
const STRAP: f32 = 2e5;
/// Linear and angular damping by the air, 1/s.
pub const AIR: f32 = 0.2;
/// Rest length of the cables with the crate down and the slings slack, and with the crate up, m.
pub const LENGTHS: [f32; 2] = [LEVEL - SLING - BLOCK + SLACK, 2.2];
/// Height of the jib above the top of a crate on the ground, m.
const LEVEL: f32 = JIB - SIZE.y;
/// Extra cable length that makes the slings slack, m.
const SLACK: f32 = 0.2;
/// Duration of one way, s.
pub const ROUND: f32 = 40.0;
/// Time span in which the crate is lifted, s.
pub const LIFT: [f32; 2] = [3.0, 8.5];
/// Time span in which the crate is carried, s.
pub const CARRY: [f32; 2] = [11.0, 17.0];
/// Time span in which the crate is set down, s.
pub const SET: [f32; 2] = [30.5, 36.0];

/// The trolley, which runs along the jib. It has no rigid body, because only its motor moves it.
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

/// Rises from 0 to 1 between two times, smoothly at both ends.
fn gently(t: f32, [from, to]: [f32; 2]) -> f32 {
    EaseFunction::SmootherStep.sample_clamped((t - from) / (to - from))
}

/// Returns the position of the trolley, there and back again, m.
pub fn place(time: f32) -> f32 {
    let there = ((time / ROUND) as u32).is_multiple_of(2);
    let x = REACH * (2.0 * gently(time % ROUND, CARRY) - 1.0);
    if there { x } else { -x }
}

/// Returns the rest length of the cables, m.
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

/// Spawns the hook block: two sheaves, and the hook below them.
fn hook(commands: &mut Commands) -> Entity {
    let across = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let sheave = |z| {
        let at = Transform::from_xyz(0.0, 0.0, z).with_rotation(across);
        (at, Shape::Cylinder(0.2, 0.1, Paint::Iron))
    };
    let body = (
        RigidBody::Dynamic,
        AdditionalMassProperties::Mass(HOOK),
        // The two cables hold it upright.
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

/// Spawns the crate: boards, and a frame around them.
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

/// Returns the stiffness (N/m) and the rest length (m) of a cable.
fn cable(time: f32) -> (f32, f32) {
    let length = length(time);
    (CABLE / length, length)
}

/// Changes the cables' rest length with the winch, and moves the trolley.
pub fn drive(
    time: Res<Time>,
    mut trolleys: Query<&mut Transform, With<Trolley>>,
    mut cables: Query<&mut SpringDamper, With<Cable>>,
) {
    let now = time.elapsed_secs();
    for mut trolley in &mut trolleys {
        let x = place(now);
        // Writing the component wakes sleeping bodies, so write only changes.
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
