//! The ball that falls on it.

use super::BALL;
use super::lattice::Point;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Shape};

/// kg and m
pub const WEIGHT: f32 = 3.0;
pub const RADIUS: f32 = 0.14;
/// From where it falls: from the middle of the jelly, m. Beside the middle, so that it does not stay.
const FROM: Vec3 = Vec3::new(0.1, 1.1, 0.07);

#[derive(Component)]
pub struct Ball;

pub fn drop_it(
    time: Res<Time>,
    points: Query<&Transform, With<Point>>,
    balls: Query<(), With<Ball>>,
    mut commands: Commands,
) {
    if time.elapsed_secs() < BALL || !balls.is_empty() {
        return;
    }
    let middle = points.iter().map(|at| at.translation).sum::<Vec3>() / points.iter().len() as f32;
    commands.spawn((
        RigidBody::Dynamic,
        Collider::ball(RADIUS),
        ColliderMassProperties::Mass(WEIGHT),
        Friction::coefficient(0.5),
        // A floor takes some of what rolls.
        Damping {
            linear_damping: 0.0,
            angular_damping: 1.0,
        },
        Velocity::default(),
        Transform::from_translation(middle + FROM),
        Shape::Ball(RADIUS, Paint::Blue),
        Ball,
    ));
}
