//! The course, along x: a washboard, waves, kerbs, the washboard again, a field to turn on, a jump, and a slope.
//!
//! What is not level is a row of convex pieces under a function of x. A mesh of triangles will not do: on its inner edges,
//! Rapier's contacts stop a car and throw it.

use crate::stage::{Paint, Shape};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f32::consts::{PI, TAU};

/// What the road collides with is the car, and the car with the road.
pub const ROAD: CollisionGroups = CollisionGroups::new(Group::GROUP_1, Group::GROUP_2);
/// Of the road, m.
const WIDTH: f32 = 9.0;
/// Where the road ends, m.
const END: f32 = 640.0;
/// Length of a convex piece, and how far it goes down, m.
const PIECE: f32 = 0.2;
const DEPTH: f32 = -1.0;
/// Of the washboard, m: from crest to crest, half the height from trough to crest, and the whole.
pub const WASH: f32 = 2.0;
pub const WASH_HEIGHT: f32 = 0.012;
const WASH_LENGTH: f32 = 40.0;
/// Where things begin, m.
pub const SLOW_WASH: f32 = 30.0;
pub const WAVES: f32 = 80.0;
pub const KERBS: f32 = 135.0;
pub const FAST_WASH: f32 = 250.0;
pub const JUMP: f32 = 440.0;
pub const SLOPE: f32 = 560.0;
/// Of the waves, m: their length, height and number on each side.
const WAVE: f32 = 8.0;
const WAVE_HEIGHT: f32 = 0.16;
const WAVE_COUNT: f32 = 5.0;
/// Of the kerbs above the road, m.
const KERB: f32 = 0.09;
/// Of the jump, m.
const JUMP_LENGTH: f32 = 14.0;
pub const JUMP_HEIGHT: f32 = 1.4;
/// Of the slope: its length, m, and how steep it is.
pub const SLOPE_LENGTH: f32 = 24.0;
pub const STEEP: f32 = 0.2;
/// Of the top and of what leads to it, m.
const EASE: f32 = 6.0;

fn washboard(x: f32) -> f32 {
    WASH_HEIGHT * (1.0 - (TAU * x / WASH).cos())
}

fn wave(x: f32) -> f32 {
    0.5 * WAVE_HEIGHT * (1.0 - (TAU * x / WAVE).cos())
}

fn jump(x: f32) -> f32 {
    JUMP_HEIGHT * (x / JUMP_LENGTH).powi(2)
}

/// Up and down again, with round ends.
fn slope(x: f32) -> f32 {
    let bend = |x: f32| {
        let s = (x / EASE).clamp(0.0, 1.0);
        STEEP * EASE * (0.5 * s - (PI * s).sin() / (2.0 * PI)) + STEEP * (x - EASE).max(0.0)
    };
    let side = |x| bend(x) - bend(x - SLOPE_LENGTH);
    side(x) - side(x - SLOPE_LENGTH - EASE)
}

pub fn spawn(mut commands: Commands) {
    let size = Vec3::new(900.0, 1.0, 240.0);
    commands.spawn((
        Collider::cuboid(0.5 * size.x, 0.5 * size.y, 0.5 * size.z),
        Friction::coefficient(0.0),
        ROAD,
        Transform::from_xyz(0.5 * END, -0.5 * size.y, 0.0),
        Shape::Cuboid(size, Paint::Grass),
    ));
    // Paint and asphalt are looks alone.
    let road = Vec3::new(END + 60.0, 0.02, WIDTH + 3.0);
    let middle = 0.5 * END - 10.0;
    commands.spawn((
        Transform::from_xyz(middle, -0.006, 0.0),
        Shape::Cuboid(road, Paint::Asphalt),
    ));
    for side in [-1.0, 1.0] {
        commands.spawn((
            Transform::from_xyz(middle, -0.001, side * (0.5 * WIDTH + 0.7)),
            Shape::Cuboid(Vec3::new(road.x, 0.02, 0.14), Paint::Ivory),
        ));
    }
    for i in 0..110 {
        commands.spawn((
            Transform::from_xyz(6.0 * i as f32 - 20.0, -0.001, 0.0),
            Shape::Cuboid(Vec3::new(3.0, 0.02, 0.12), Paint::Ivory),
        ));
    }
    let whole = (0.0, WIDTH);
    let lane = 0.5 * WIDTH;
    for from in [SLOW_WASH, FAST_WASH] {
        strip_of(
            &mut commands,
            from,
            whole,
            WASH_LENGTH,
            washboard,
            Paint::Sand,
        );
    }
    let length = WAVE_COUNT * WAVE;
    for (from, z) in [(WAVES, -0.5 * lane), (WAVES + 0.5 * WAVE, 0.5 * lane)] {
        strip_of(&mut commands, from, (z, lane), length, wave, Paint::Sand);
    }
    strip_of(
        &mut commands,
        JUMP,
        (0.0, 6.0),
        JUMP_LENGTH,
        jump,
        Paint::Sand,
    );
    let length = 2.0 * (SLOPE_LENGTH + EASE);
    strip_of(&mut commands, SLOPE, whole, length, slope, Paint::Sand);
    kerbs(&mut commands);
}

/// Something not level, along the road.
fn strip_of(
    commands: &mut Commands,
    from: f32,
    (z, width): (f32, f32),
    length: f32,
    height: fn(f32) -> f32,
    paint: Paint,
) {
    let pieces = (length / PIECE).round().max(1.0);
    let step = length / pieces;
    let half = 0.5 * width;
    let piece = |i: u32| {
        let [x, next] = [i, i + 1].map(|i| i as f32 * step);
        let corners = [
            (x, height(x)),
            (next, height(next)),
            (x, DEPTH),
            (next, DEPTH),
        ]
        .map(|(x, y)| [-half, half].map(|z| Vec3::new(x, y, z)));
        let hull = Collider::convex_hull(corners.as_flattened())?;
        Some((Vec3::ZERO, Quat::IDENTITY, hull))
    };
    let hulls: Option<Vec<_>> = (0..pieces as u32).map(piece).collect();
    let Some(hulls) = hulls else {
        error!("the course at {from} m has no surface");
        return;
    };
    let collider = Collider::compound(hulls);
    commands.spawn((
        collider,
        Friction::coefficient(0.0),
        ROAD,
        Transform::from_xyz(from, 0.0, z),
        Shape::Strip(height, length, width, paint),
    ));
}

/// First below the right wheels, then below the left ones.
fn kerbs(commands: &mut Commands) {
    for (from, z) in [(KERBS, 1.1), (KERBS + 16.0, -1.1)] {
        for i in 0..10 {
            let size = Vec3::new(1.0, 2.0 * KERB, 1.4);
            let paint = if i % 2 == 0 { Paint::Red } else { Paint::Ivory };
            commands.spawn((
                Transform::from_xyz(from + 0.5 + i as f32, 0.0, z),
                Shape::Cuboid(size, paint),
            ));
        }
        commands.spawn((
            Collider::cuboid(5.0, KERB, 0.7),
            Friction::coefficient(0.0),
            ROAD,
            Transform::from_xyz(from + 5.0, 0.0, z),
        ));
    }
}
