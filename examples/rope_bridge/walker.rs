//! The walker: a character controller that moves as told and stays on the ground below it. It applies no force by
//! itself, so its weight is applied to the planks as a force at its feet.

use super::bridge::{EDGE, GRAVITY, GROUND, Plank, SIZE};
use bevy::prelude::*;
use bevy_rapier3d::control::CharacterLength;
use bevy_rapier3d::prelude::*;
use stage::{DT, Paint, Shape};
use std::f32::consts::PI;

/// Mass of the walker, kg.
pub const MASS: f32 = 75.0;
/// Radius of the capsule, m.
const RADIUS: f32 = 0.22;
/// Half the height of the capsule, m.
pub const HALF: f32 = 0.85;
/// Walking speed, m/s.
const SPEED: f32 = 1.3;
/// Falling speed where nothing is below the walker, m/s.
const FALL: f32 = 2.0;
/// Distance of each foot from the middle, forward and backward, m.
pub const FOOT: f32 = 0.12;
/// Length of a step, m.
const STEP: f32 = 0.7;
/// Duration of one way over the bridge, s.
pub const ROUND: f32 = 60.0;
/// Times (s) at which the walker sets out, with the destinations (m), on the way to the right.
const STOPS: [(f32, f32); 4] = [
    (0.0, -EDGE - 0.5),
    (2.0, 0.0),
    (22.0, QUARTER),
    (38.0, EDGE + 0.5),
];
pub const QUARTER: f32 = 0.5 * EDGE;

#[derive(Component, Default)]
pub struct Walker {
    /// Distance walked, m.
    walked: f32,
    /// Whether a player has taken over.
    by_hand: bool,
}

#[derive(Component)]
pub struct Leg(f32);

/// Returns the destination of the walker, there and back again, m.
fn goal(time: f32) -> f32 {
    let (there, t) = (((time / ROUND) as u32).is_multiple_of(2), time % ROUND);
    let last = STOPS.iter().rev().find(|stop| stop.0 <= t);
    last.map_or(0.0, |stop| if there { stop.1 } else { -stop.1 })
}

pub fn spawn(mut commands: Commands) {
    let body = (
        RigidBody::KinematicPositionBased,
        Collider::capsule_y(HALF - RADIUS, RADIUS),
        // No body collides with it: it would push with unlimited force.
        CollisionGroups::new(Group::GROUP_1, Group::NONE),
        KinematicCharacterController {
            filter_groups: Some(GROUND),
            offset: CharacterLength::Absolute(0.01),
            snap_to_ground: Some(CharacterLength::Absolute(0.25)),
            apply_impulse_to_dynamic_bodies: false,
            ..default()
        },
        Transform::from_xyz(STOPS[0].1, HALF + 0.02, 0.0),
        Visibility::default(),
        Walker::default(),
    );
    let at = |y, shape| (Transform::from_xyz(0.0, y, 0.0), shape);
    commands.spawn(body).with_children(|parts| {
        parts.spawn(at(0.2, Shape::Capsule(0.17, 0.32, Paint::Blue)));
        parts.spawn(at(0.68, Shape::Ball(0.13, Paint::Ivory)));
        for side in [-1.0, 1.0] {
            let hip = Transform::from_xyz(0.0, -0.08, 0.09 * side);
            parts
                .spawn((hip, Visibility::default(), Leg(side)))
                .with_child((
                    Transform::from_xyz(0.0, -0.38, 0.0),
                    Shape::Capsule(0.07, 0.62, Paint::Iron),
                ));
        }
    });
}

pub fn walk(
    time: Res<Time>,
    keys: Option<Res<ButtonInput<KeyCode>>>,
    mut walkers: Query<(&mut KinematicCharacterController, &mut Walker, &Transform)>,
) {
    let any = |all: [KeyCode; 2]| keys.as_ref().is_some_and(|keys| keys.any_pressed(all));
    let left = any([KeyCode::ArrowLeft, KeyCode::KeyA]);
    let right = any([KeyCode::ArrowRight, KeyCode::KeyD]);
    for (mut controller, mut walker, at) in &mut walkers {
        walker.by_hand |= left || right;
        let most = SPEED * DT;
        let step = if walker.by_hand {
            most * (f32::from(right) - f32::from(left))
        } else {
            (goal(time.elapsed_secs()) - at.translation.x).clamp(-most, most)
        };
        walker.walked += step.abs();
        controller.translation = Some(Vec3::new(step, -FALL * DT, 0.0));
    }
}

/// Applies half the weight at each foot, to the plank nearest to that foot.
pub fn tread(
    walkers: Query<&Transform, With<Walker>>,
    mut planks: Query<(&Transform, &mut ExternalForce), With<Plank>>,
) {
    for (_, mut force) in &mut planks {
        *force = ExternalForce::default();
    }
    for walker in &walkers {
        for foot in [-FOOT, FOOT] {
            let x = walker.translation.x + foot;
            if x.abs() > EDGE {
                continue;
            }
            let from = |at: &Transform| (at.translation.x - x).abs();
            let nearest = planks
                .iter_mut()
                .min_by(|a, b| from(a.0).total_cmp(&from(b.0)));
            if let Some((plank, mut force)) = nearest {
                let down = Vec3::NEG_Y * 0.5 * MASS * GRAVITY;
                let reach = 0.5 * SIZE.x;
                let along = (x - plank.translation.x).clamp(-reach, reach);
                let point = plank.transform_point(Vec3::new(along, 0.5 * SIZE.y, 0.0));
                *force += ExternalForce::at_point(down, point, plank.translation);
            }
        }
    }
}

/// Swings the legs with the distance walked.
pub fn swing_legs(walkers: Query<&Walker>, mut legs: Query<(&mut Transform, &Leg)>) {
    for walker in &walkers {
        for (mut leg, side) in &mut legs {
            let swing = 0.42 * side.0 * (PI * walker.walked / STEP).sin();
            leg.rotation = Quat::from_rotation_z(swing);
        }
    }
}
