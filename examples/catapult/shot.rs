//! The ball, and the wall of boxes that it hits.

use super::LOAD;
use super::arm::{Arm, LENGTH};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Shape};

/// Mass of the ball, kg.
pub const WEIGHT: f32 = 2.0;
/// Radius of the ball, m.
pub const RADIUS: f32 = 0.12;
/// Position of the wall along x, m.
pub const WALL: f32 = 8.0;
/// Edge of a box, m.
const BOX: f32 = 0.5;
/// Mass of a box, kg.
const BOX_MASS: f32 = 3.0;

#[derive(Component)]
pub struct Ball;

#[derive(Component)]
pub struct Brick;

pub fn load(
    time: Res<Time>,
    arms: Query<&Transform, With<Arm>>,
    balls: Query<(), With<Ball>>,
    mut commands: Commands,
) {
    let Ok(arm) = arms.single() else { return };
    if time.elapsed_secs() < LOAD || !balls.is_empty() {
        return;
    }
    commands.spawn((
        // Without `Ccd`: it moves 0.15 m in a tick, and the boxes are 0.5 m thick. With `Ccd`, Rapier can stop it for most of a
        // tick where it leaves the cup.
        RigidBody::Dynamic,
        Collider::ball(RADIUS),
        ColliderMassProperties::Mass(WEIGHT),
        Friction::coefficient(0.4),
        Velocity::default(),
        Transform::from_translation(arm.transform_point(Vec3::new(RADIUS + 0.02, LENGTH, 0.0))),
        Shape::Ball(RADIUS, Paint::Iron),
        Ball,
    ));
}

/// Spawns a wall of boxes, three high.
pub fn spawn_wall(mut commands: Commands) {
    for level in 0..3 {
        for z in -1..=1 {
            let at = Vec3::new(WALL, BOX * (level as f32 + 0.5), 1.02 * BOX * z as f32);
            let paint = if (level + z) % 2 == 0 {
                Paint::Red
            } else {
                Paint::Ivory
            };
            commands.spawn((
                RigidBody::Dynamic,
                Collider::cuboid(0.5 * BOX, 0.5 * BOX, 0.5 * BOX),
                ColliderMassProperties::Mass(BOX_MASS),
                Friction::coefficient(0.6),
                Velocity::default(),
                Transform::from_translation(at),
                Shape::Cuboid(Vec3::splat(BOX), paint),
                Brick,
            ));
        }
    }
}
