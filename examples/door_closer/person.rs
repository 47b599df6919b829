//! The person who goes through the doors: a figure without a rigid body, and the force of its hand.

use super::doors::{Door, HANDLE};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Shape};
use std::f32::consts::PI;

/// Length of a step, m.
const STEP: f32 = 0.7;
/// Height of the figure's middle above the ground, m.
const HALF: f32 = 0.85;
/// Way of the person: time (s), position to the right and to the front (m).
const WAY: [[f32; 3]; 8] = [
    [0.0, -1.05, 2.6],
    [0.3, -1.05, 2.6],
    [5.2, -1.05, -2.2],
    [6.2, -0.6, -2.6],
    [8.2, 0.6, -2.6],
    [9.2, 1.05, -2.2],
    [14.0, 1.05, 2.6],
    [24.0, 1.05, 2.6],
];
/// When the hand pushes each door, from and to (s), and its force (N).
pub const PUSHES: [([f32; 2], f32); 2] = [([2.2, 3.2], 22.5), ([10.7, 12.0], 18.5)];

#[derive(Component, Default)]
pub struct Person {
    /// Distance walked, m.
    walked: f32,
}

#[derive(Component)]
pub struct Limb(f32);

pub fn spawn(mut commands: Commands) {
    let figure = (
        Transform::from_xyz(WAY[0][1], HALF, WAY[0][2]),
        Visibility::default(),
        Person::default(),
    );
    let at = |x, y, shape| (Transform::from_xyz(x, y, 0.0), shape);
    commands.spawn(figure).with_children(|parts| {
        parts.spawn(at(0.0, 0.2, Shape::Capsule(0.17, 0.32, Paint::Sand)));
        parts.spawn(at(0.0, 0.68, Shape::Ball(0.13, Paint::Ivory)));
        for side in [-1.0, 1.0] {
            let hip = Transform::from_xyz(0.09 * side, -0.08, 0.0);
            parts
                .spawn((hip, Visibility::default(), Limb(side)))
                .with_child(at(0.0, -0.38, Shape::Capsule(0.07, 0.62, Paint::Iron)));
            let shoulder = Transform::from_xyz(0.23 * side, 0.42, 0.0);
            parts
                .spawn((shoulder, Visibility::default(), Limb(-side)))
                .with_child(at(0.0, -0.25, Shape::Capsule(0.05, 0.4, Paint::Sand)));
        }
    });
}

/// Moves the person along its way. Legs and arms swing with the distance walked.
pub fn walk(
    time: Res<Time>,
    mut people: Query<(&mut Transform, &mut Person)>,
    mut limbs: Query<(&mut Transform, &Limb), Without<Person>>,
) {
    let now = time.elapsed_secs();
    for (mut at, mut person) in &mut people {
        let Some(leg) = WAY.windows(2).find(|w| now < w[1][0]) else {
            continue;
        };
        let [[from, x, z], [to, next_x, next_z]] = [leg[0], leg[1]];
        let share = (now - from) / (to - from);
        let place = Vec3::new(x, HALF, z).lerp(Vec3::new(next_x, HALF, next_z), share);
        let step = place - at.translation;
        person.walked += step.length();
        at.translation = place;
        if step.length() > 1e-4 {
            // The person turns gradually into its direction.
            let ahead = Quat::from_rotation_arc(Vec3::NEG_Z, step.normalize());
            at.rotation = at.rotation.slerp(ahead, 0.12);
        }
        for (mut limb, side) in &mut limbs {
            let swing = 0.42 * side.0 * (PI * person.walked / STEP).sin();
            limb.rotation = Quat::from_rotation_x(swing);
        }
    }
}

/// Applies the hand's force. It is perpendicular to the door, so its moment is the same at any angle.
pub fn push(time: Res<Time>, mut doors: Query<(&Transform, &Door, &mut ExternalForce)>) {
    let now = time.elapsed_secs();
    for (door, Door(side), mut force) in &mut doors {
        let ([from, to], newtons) = PUSHES[usize::from(*side > 0.0)];
        let pushes = now > from && now <= to;
        let next = if pushes {
            let ahead = door.rotation * Vec3::Z * *side;
            let handle = door.transform_point(Vec3::new(-HANDLE * side, 1.0, 0.0));
            let middle = door.transform_point(super::doors::middle(*side));
            ExternalForce::at_point(newtons * ahead, handle, middle)
        } else {
            ExternalForce::default()
        };
        // Writing the component wakes a sleeping body, so write only changes.
        if *force != next {
            *force = next;
        }
    }
}
