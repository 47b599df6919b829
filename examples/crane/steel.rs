//! The static parts: ground, mast, and a jib made of bars.

use super::load::{JIB, REACH};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Shape};

/// Position of the mast along x, m.
const MAST: f32 = -5.6;
/// Half the width of mast and jib, m.
const HALF: f32 = 0.4;
/// Positions of the jib's ends along x, m.
const ENDS: [f32; 2] = [-8.8, REACH + 1.0];
/// Height of the mast's top, m.
const TOP: f32 = JIB + 2.4;

pub fn spawn(mut commands: Commands) {
    let ground = Vec3::new(160.0, 0.1, 160.0);
    commands.spawn((
        RigidBody::Fixed,
        Collider::cuboid(0.5 * ground.x, 0.5 * ground.y, 0.5 * ground.z),
        Transform::from_xyz(0.0, -0.5 * ground.y, 0.0),
        Shape::Cuboid(ground, Paint::Floor),
    ));
    mast(&mut commands);
    jib(&mut commands);
    // Pads where the crate is set down.
    for x in [-REACH, REACH] {
        let pad = Shape::Cuboid(Vec3::new(2.6, 0.02, 2.2), Paint::Asphalt);
        // The pad is above the floor by an invisible height.
        commands.spawn((Transform::from_xyz(x, -0.005, 0.0), pad));
    }
}

/// Spawns a square bar between two points.
fn bar(commands: &mut Commands, from: Vec3, to: Vec3, width: f32, paint: Paint) {
    let along = to - from;
    let at = Transform::from_translation(0.5 * (from + to))
        .with_rotation(Quat::from_rotation_arc(Vec3::Y, along.normalize()));
    let size = Vec3::new(width, along.length(), width);
    commands.spawn((at, Shape::Cuboid(size, paint)));
}

fn mast(commands: &mut Commands) {
    let paint = Paint::Ivory;
    let foot = Shape::Cuboid(Vec3::new(2.4, 0.4, 2.4), Paint::Sand);
    commands.spawn((Transform::from_xyz(MAST, 0.2, 0.0), foot));
    let corner = |side: usize, y: f32| {
        let (x, z) = [(-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF)][side % 4];
        Vec3::new(MAST + x, y, z)
    };
    let floors = 9;
    let height = |i: usize| 0.4 + (JIB - 0.4) * i as f32 / floors as f32;
    for side in 0..4 {
        bar(commands, corner(side, 0.4), corner(side, JIB), 0.11, paint);
        for i in 0..floors {
            let ends = [corner(side, height(i)), corner(side + 1, height(i + 1))];
            bar(commands, ends[0], ends[1], 0.05, paint);
            let ends = [corner(side, height(i + 1)), corner(side + 1, height(i + 1))];
            bar(commands, ends[0], ends[1], 0.05, paint);
        }
        let top = Vec3::new(MAST, TOP, 0.0);
        bar(commands, corner(side, JIB), top, 0.09, paint);
    }
    // The driver's cab, with windows to the front and to the side.
    let cab = Vec3::new(MAST + 0.95, JIB - 0.75, 0.75);
    for (at, size, paint) in [
        (Vec3::ZERO, Vec3::new(0.9, 1.0, 0.9), Paint::Red),
        (
            Vec3::new(0.1, 0.15, 0.0),
            Vec3::new(0.74, 0.5, 0.94),
            Paint::Iron,
        ),
        (
            Vec3::new(0.3, 0.1, 0.0),
            Vec3::new(0.34, 0.6, 0.8),
            Paint::Iron,
        ),
    ] {
        commands.spawn((
            Transform::from_translation(cab + at),
            Shape::Cuboid(size, paint),
        ));
    }
}

fn jib(commands: &mut Commands) {
    let paint = Paint::Ivory;
    let [from, to] = ENDS;
    let (low, high) = (JIB + 0.1, JIB + 0.85);
    for z in [-HALF, HALF] {
        let ends = [from, to].map(|x| Vec3::new(x, low, z));
        bar(commands, ends[0], ends[1], 0.11, paint);
    }
    let inner = MAST + HALF;
    let ends = [inner, to].map(|x| Vec3::new(x, high, 0.0));
    bar(commands, ends[0], ends[1], 0.1, paint);
    let bays = 13;
    let at = |i: f32| inner + (to - inner) * i / bays as f32;
    for i in 0..bays {
        let i = i as f32;
        for z in [-HALF, HALF] {
            let middle = Vec3::new(at(i + 0.5), high, 0.0);
            for x in [at(i), at(i + 1.0)] {
                bar(commands, Vec3::new(x, low, z), middle, 0.05, paint);
            }
        }
        let across = [-HALF, HALF].map(|z| Vec3::new(at(i), low, z));
        bar(commands, across[0], across[1], 0.05, paint);
    }
    // Stays, and the counterweight.
    let top = Vec3::new(MAST, TOP, 0.0);
    for x in [at(6.0), at(11.0)] {
        bar(commands, top, Vec3::new(x, high, 0.0), 0.045, Paint::Iron);
    }
    for z in [-HALF, HALF] {
        let end = Vec3::new(from + 0.7, low, z);
        bar(commands, top, end, 0.045, Paint::Iron);
    }
    commands.spawn((
        Transform::from_xyz(from + 0.7, low - 0.5, 0.0),
        Shape::Cuboid(Vec3::new(1.3, 1.2, 1.1), Paint::Sand),
    ));
}
