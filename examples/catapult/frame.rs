//! The frame: wooden beams without colliders.

use super::arm::{HINGE, LENGTH, PAD};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Shape, floor};

/// The rigid body of the frame.
#[derive(Resource)]
pub struct Frame(pub Entity);

pub fn spawn(mut commands: Commands) {
    commands.spawn((
        floor(),
        RigidBody::Fixed,
        Collider::cuboid(20.0, 0.05, 20.0),
        Friction::coefficient(0.8),
    ));
    let mut frame = commands.spawn((
        RigidBody::Fixed,
        Transform::default(),
        Visibility::default(),
    ));
    frame.with_children(|parts| {
        let mut beam = |from: Vec3, to: Vec3, width: f32| {
            let along = to - from;
            let turned = Quat::from_rotation_arc(Vec3::X, along.normalize());
            parts.spawn((
                Transform::from_translation(0.5 * (from + to)).with_rotation(turned),
                Shape::Cuboid(Vec3::new(along.length() + width, width, width), Paint::Wood),
            ));
        };
        // `struck` is where the arm meets the beam, 0.62 of its length from the hinge. `ahead` is perpendicular to
        // the arm.
        let struck = HINGE + 0.62 * LENGTH * Vec3::new(PAD.sin(), PAD.cos(), 0.0);
        let ahead = Vec3::new(PAD.cos(), -PAD.sin(), 0.0);
        let top = struck + 0.13 * ahead;
        let foot = |x: f32, z: f32| Vec3::new(x, 0.08, z);
        for z in [-0.45, 0.45] {
            let side = Vec3::Z * z;
            beam(foot(-1.5, z), foot(1.3, z), 0.16);
            beam(Vec3::new(0.0, 0.08, z), HINGE + side, 0.16);
            beam(foot(1.2, z), top + side, 0.12);
            beam(foot(0.0, z), top + side, 0.12);
        }
        for at in [foot(-1.4, 0.0), foot(1.2, 0.0), top] {
            beam(at - 0.45 * Vec3::Z, at + 0.45 * Vec3::Z, 0.14);
        }
        // The pad on the beam, and the winch.
        parts.spawn((
            Transform::from_translation(top - 0.085 * ahead)
                .with_rotation(Quat::from_rotation_z(-PAD)),
            Shape::Cuboid(Vec3::new(0.06, 0.16, 0.4), Paint::Hemp),
        ));
        parts.spawn((
            Transform::from_xyz(-1.4, 0.22, 0.0)
                .with_rotation(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2)),
            Shape::Cylinder(0.09, 0.7, Paint::Iron),
        ));
    });
    let frame = frame.id();
    commands.insert_resource(Frame(frame));
}
