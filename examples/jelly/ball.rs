//! The ball that falls on the jelly.

use super::BALL;
use super::lattice::Point;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Shape};

/// Mass of the ball, kg.
pub const WEIGHT: f32 = 3.0;
/// Radius of the ball, m.
pub const RADIUS: f32 = 0.14;
/// Start of the ball relative to the middle of the jelly, m. It is off-centre, so that the ball does not stay on top.
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
        // Stands for the rolling resistance of the floor.
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
