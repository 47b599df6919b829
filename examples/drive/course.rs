//! The course along x: a washboard, waves, kerbs, the washboard again, a field to turn on, a jump, and a slope.
//!
//! Everything that is not level is made of few convex solids: nearly buried cylinders, and prisms with their feet
//! underground. Rapier stops a fast body in front of every edge it comes near, even at an inner edge of a smooth
//! road. A triangle mesh or a row of small pieces would stop or throw this car.

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Shape};
use std::f32::consts::TAU;

/// The road collides only with the car, and the car only with the road.
pub const ROAD: CollisionGroups = CollisionGroups::new(Group::GROUP_1, Group::GROUP_2);
/// Width of the road, m.
const WIDTH: f32 = 9.0;
/// Position of the road's end, m.
const END: f32 = 640.0;
/// Distance from crest to crest of the washboard, m.
const WASH: f32 = 2.0;
/// Height of the washboard, m.
const WASH_HEIGHT: f32 = 0.02;
/// Length of the whole washboard, m.
const WASH_LENGTH: f32 = 40.0;
/// Start of each part along x, m.
pub const SLOW_WASH: f32 = 30.0;
pub const WAVES: f32 = 80.0;
pub const KERBS: f32 = 135.0;
pub const FAST_WASH: f32 = 250.0;
pub const JUMP: f32 = 440.0;
pub const SLOPE: f32 = 560.0;
/// Length of one wave, m.
const WAVE: f32 = 8.0;
/// Height of the waves, m.
const WAVE_HEIGHT: f32 = 0.16;
/// Number of waves on each side of the road.
const WAVE_COUNT: f32 = 5.0;
/// Height of the kerbs above the road, m.
const KERB: f32 = 0.09;
/// Gradients of the two parts of the jump.
const RISES: [f32; 2] = [0.08, 0.16];
/// Distances from the start of the jump at which its two parts end, m.
const ENDS: [f32; 2] = [6.0, 13.5];
/// Gradient of the slope above its foot.
pub const STEEP: f32 = 0.2;
/// Gradient of the slope's foot, and the height at which the foot ends, m.
const FOOT: [f32; 2] = [0.1, 0.3];
/// Height of the slope's top, m.
const TOP: f32 = 4.5;
/// Length of the whole slope along x, m.
const SLOPE_LENGTH: f32 = 54.0;
/// Height of the underground ends of all prisms, m.
const DEPTH: f32 = -1.0;

/// Returns the height of a row of equal arcs, m.
fn arcs(x: f32, length: f32, height: f32) -> f32 {
    let radius = radius(length, height);
    let from_crest = x.rem_euclid(length) - 0.5 * length;
    height - radius + (radius.powi(2) - from_crest.powi(2)).sqrt()
}

fn radius(length: f32, height: f32) -> f32 {
    (0.25 * length.powi(2) + height.powi(2)) / (2.0 * height)
}

pub fn washboard(x: f32) -> f32 {
    arcs(x, WASH, WASH_HEIGHT)
}

fn wave(x: f32) -> f32 {
    arcs(x, WAVE, WAVE_HEIGHT)
}

fn jump(x: f32) -> f32 {
    if x < ENDS[0] {
        RISES[0] * x
    } else {
        RISES[0] * ENDS[0] + RISES[1] * (x - ENDS[0])
    }
}

/// Returns the height of the slope, which goes up and down again, m.
fn slope(x: f32) -> f32 {
    let from_end = x.min(SLOPE_LENGTH - x);
    let above = FOOT[1] + STEEP * (from_end - FOOT[1] / FOOT[0]);
    above.min(TOP).max((FOOT[0] * from_end).min(FOOT[1]))
}

pub fn spawn(mut commands: Commands) {
    let size = Vec3::new(1_600.0, 1.0, 1_200.0);
    commands.spawn((
        Collider::cuboid(0.5 * size.x, 0.5 * size.y, 0.5 * size.z),
        Friction::coefficient(0.0),
        ROAD,
        Transform::from_xyz(0.5 * END, -0.5 * size.y, 0.0),
        Shape::Cuboid(size, Paint::Grass),
    ));
    // Paint and asphalt are visual only.
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
        strip(&mut commands, from, whole, WASH_LENGTH, washboard);
        row(&mut commands, from, whole, WASH_LENGTH, (WASH, WASH_HEIGHT));
    }
    let length = WAVE_COUNT * WAVE;
    for (from, z) in [(WAVES, -0.5 * lane), (WAVES + 0.5 * WAVE, 0.5 * lane)] {
        strip(&mut commands, from, (z, lane), length, wave);
        row(&mut commands, from, (z, lane), length, (WAVE, WAVE_HEIGHT));
    }
    strip(&mut commands, JUMP, (0.0, 6.0), ENDS[1], jump);
    for (rise, end) in RISES.into_iter().zip(ENDS) {
        let foot = end - (jump(end) - DEPTH) / rise;
        let corners = [(foot, DEPTH), (end, jump(end)), (end, DEPTH)];
        solid(&mut commands, JUMP, 6.0, &corners);
    }
    strip(&mut commands, SLOPE, whole, SLOPE_LENGTH, slope);
    // `foot` is where the foot of the slope ends, `top` where the slope reaches its top.
    let foot = FOOT[1] / FOOT[0];
    let top = foot + (TOP - FOOT[1]) / STEEP;
    for (rise, at, height) in [(FOOT[0], foot, FOOT[1]), (STEEP, top, TOP)] {
        let begin = at - (height - DEPTH) / rise;
        let corners = [
            (begin, DEPTH),
            (at, height),
            (SLOPE_LENGTH - at, height),
            (SLOPE_LENGTH - begin, DEPTH),
        ];
        solid(&mut commands, SLOPE, WIDTH, &corners);
    }
    kerbs(&mut commands);
}

/// Spawns the visible surface of a part that is not level.
fn strip(
    commands: &mut Commands,
    from: f32,
    (z, width): (f32, f32),
    length: f32,
    height: fn(f32) -> f32,
) {
    commands.spawn((
        Transform::from_xyz(from, 0.0, z),
        Shape::Strip(height, length, width, Paint::Sand),
    ));
}

/// Spawns a row of arcs, as nearly buried cylinders.
fn row(
    commands: &mut Commands,
    from: f32,
    (z, width): (f32, f32),
    whole: f32,
    (length, height): (f32, f32),
) {
    let radius = radius(length, height);
    for i in 0..(whole / length).round() as u32 {
        let x = from + (i as f32 + 0.5) * length;
        commands.spawn((
            Collider::cylinder(0.5 * width, radius),
            Friction::coefficient(0.0),
            ROAD,
            Transform::from_xyz(x, height - radius, z)
                .with_rotation(Quat::from_rotation_x(TAU / 4.0)),
        ));
    }
}

/// Spawns a prism across the road from a convex outline in x and y. Its feet are deep in the ground, so a wheel meets
/// planes and never the edge where they begin.
fn solid(commands: &mut Commands, from: f32, width: f32, outline: &[(f32, f32)]) {
    let half = 0.5 * width;
    let sides = |(x, y): &(f32, f32)| [-half, half].map(|z| Vec3::new(*x, *y, z));
    let points: Vec<Vec3> = outline.iter().flat_map(sides).collect();
    let Some(collider) = Collider::convex_hull(&points) else {
        error!("the course at {from} m has no surface");
        return;
    };
    commands.spawn((
        collider,
        Friction::coefficient(0.0),
        ROAD,
        Transform::from_xyz(from, 0.0, 0.0),
    ));
}

/// Spawns the kerbs, first below the right wheels, then below the left ones.
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
