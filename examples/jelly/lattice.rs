//! The points of the jelly and the springs between them.

use super::skin::skin;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Shape};
use std::f32::consts::FRAC_PI_4;

/// Number of points along an edge.
pub const SIDE: usize = 4;
/// Distance between neighbouring points, m.
pub const PITCH: f32 = 0.15;
/// Radius of the ball collider of a point, m.
pub const RADIUS: f32 = 0.05;
/// Mass of a point, kg.
pub const MASS: f32 = 0.25;
/// Stiffness of the springs along the edges of a cell, across its faces, and through its middle, N/m.
const STIFFNESS: [f32; 3] = [400.0, 200.0, 200.0];
/// Damping over stiffness, s.
const DAMPING: f32 = 0.014;
/// Height of the jelly's middle above the ground at the start, m.
const DROP: f32 = 0.75;

/// Group of the points. They collide with the ground and the ball, not with each other.
const POINTS: Group = Group::GROUP_1;

/// Entities of the points, in the order of [`index`].
#[derive(Resource)]
pub struct Jelly(pub Vec<Entity>);

#[derive(Component)]
pub struct Point;

/// On a spring: indices of its two points.
#[derive(Component, Clone, Copy)]
pub struct Link(pub [usize; 2]);

pub fn index([x, y, z]: [usize; 3]) -> usize {
    (z * SIDE + y) * SIDE + x
}

/// Returns the position of a point relative to the middle of the lattice, m.
pub fn place([x, y, z]: [usize; 3]) -> Vec3 {
    PITCH * (Vec3::new(x as f32, y as f32, z as f32) - 0.5 * (SIDE - 1) as f32)
}

pub fn all() -> impl Iterator<Item = [usize; 3]> {
    let n = SIDE;
    (0..n).flat_map(move |z| (0..n).flat_map(move |y| (0..n).map(move |x| [x, y, z])))
}

/// Returns each pair of points that a spring links, with the spring's stiffness (N/m) and rest length (m).
pub fn links() -> Vec<([usize; 2], f32, f32)> {
    let mut links = Vec::new();
    for a in all() {
        for b in all() {
            let steps = [0, 1, 2].map(|i| a[i].abs_diff(b[i]));
            let [a, b] = [(index(a), a), (index(b), b)];
            if a.0 < b.0 && steps.into_iter().all(|step| step < 2) {
                let kind = steps.into_iter().sum::<usize>() - 1;
                let length = place(a.1).distance(place(b.1));
                links.push(([a.0, b.0], STIFFNESS[kind], length));
            }
        }
    }
    links
}

pub fn spawn(mut commands: Commands) {
    ground(&mut commands);
    // The cube stands on an edge, slightly tilted.
    let turned = Quat::from_euler(EulerRot::YXZ, 0.5, -0.25, 0.8 * FRAC_PI_4);
    let points: Vec<Entity> = all()
        .map(|at| {
            let place = Vec3::Y * DROP + turned * place(at);
            let mut point = commands.spawn((
                RigidBody::Dynamic,
                AdditionalMassProperties::Mass(MASS),
                LockedAxes::ROTATION_LOCKED,
                Velocity::default(),
                ExternalForce::default(),
                Transform::from_translation(place),
                Shape::Ball(0.012, Paint::Ivory),
                Point,
            ));
            if at.iter().any(|i| *i == 0 || *i == SIDE - 1) {
                point.insert((
                    Collider::ball(RADIUS),
                    ColliderMassProperties::Density(0.0),
                    Friction::coefficient(0.8),
                    CollisionGroups::new(POINTS, !POINTS),
                ));
            }
            point.id()
        })
        .collect();
    for (ends, stiffness, length) in links() {
        commands.spawn((
            SpringDamper::new(points[ends[0]], points[ends[1]])
                .with_stiffness(stiffness)
                .with_damping(DAMPING * stiffness)
                .with_rest_length(length),
            Link(ends),
        ));
    }
    commands.spawn(skin(&points));
    commands.insert_resource(Jelly(points));
}

/// Spawns a tray with a rim, so that nothing rolls off.
fn ground(commands: &mut Commands) {
    let (half, rim) = (Vec3::new(1.1, 0.05, 0.9), 0.06);
    commands.spawn((
        RigidBody::Fixed,
        Collider::cuboid(half.x, half.y, half.z),
        Friction::coefficient(0.8),
        Transform::from_xyz(0.0, -half.y, 0.0),
        Shape::Cuboid(2.0 * half, Paint::Ivory),
    ));
    for side in [-1.0, 1.0] {
        for (at, size) in [
            (Vec3::X * side * (half.x - rim), Vec3::new(rim, rim, half.z)),
            (Vec3::Z * side * (half.z - rim), Vec3::new(half.x, rim, rim)),
        ] {
            commands.spawn((
                RigidBody::Fixed,
                Collider::cuboid(size.x, size.y, size.z),
                Transform::from_translation(at + Vec3::Y * rim),
                Shape::Cuboid(2.0 * size, Paint::Wood),
            ));
        }
    }
    commands.spawn((
        Transform::from_xyz(0.0, -0.15, 0.0),
        Shape::Cuboid(Vec3::new(40.0, 0.1, 40.0), Paint::Floor),
    ));
}
