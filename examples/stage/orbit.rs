//! A camera that orbits its target.

use super::{Stage, hand::Hand};
use bevy::input::mouse::{MouseScrollUnit, MouseWheel};
use bevy::prelude::*;

/// Rotation per pixel of mouse movement, rad.
const TURN: f32 = 0.005;
/// Factor on the distance for one notch of the wheel.
const NOTCH: f32 = 0.9;
/// Pixels of one notch, for wheels that report pixels.
const PIXELS: f32 = 60.0;

/// Target, distance and direction of the camera.
#[derive(Resource)]
struct Orbit {
    target: Vec3,
    distance: f32,
    yaw: f32,
    pitch: f32,
    /// Derived from the stage's own distance, m.
    nearest: f32,
    farthest: f32,
}

pub fn add(app: &mut App, stage: &Stage) {
    let away = stage.eye - stage.target;
    let distance = away.length();
    app.insert_resource(Orbit {
        target: stage.target,
        distance,
        yaw: away.x.atan2(away.z),
        pitch: (away.y / distance).asin(),
        nearest: 0.1 * distance,
        farthest: 3.0 * distance,
    })
    .add_systems(Update, turn.after(super::hand::grab));
}

fn turn(
    mut orbit: ResMut<Orbit>,
    hand: Res<Hand>,
    buttons: Res<ButtonInput<MouseButton>>,
    mut moves: MessageReader<CursorMoved>,
    mut wheel: MessageReader<MouseWheel>,
    mut cameras: Query<&mut Transform, With<Camera3d>>,
) {
    let left = buttons.pressed(MouseButton::Left) && hand.is_empty();
    let moved: Vec2 = moves.read().filter_map(|moved| moved.delta).sum();
    let drag = if left || buttons.pressed(MouseButton::Right) {
        moved
    } else {
        Vec2::ZERO
    };
    let notches = |turned: &MouseWheel| match turned.unit {
        MouseScrollUnit::Line => turned.y,
        MouseScrollUnit::Pixel => turned.y / PIXELS,
    };
    let notches: f32 = wheel.read().map(notches).sum();
    if drag == Vec2::ZERO && notches == 0.0 {
        return;
    }
    orbit.yaw -= TURN * drag.x;
    // Not below the floor, not past the vertical.
    orbit.pitch = (orbit.pitch + TURN * drag.y).clamp(0.02, 1.5);
    orbit.distance = (orbit.distance * NOTCH.powf(notches)).clamp(orbit.nearest, orbit.farthest);
    let side = Quat::from_euler(EulerRot::YXZ, orbit.yaw, -orbit.pitch, 0.0);
    let eye = orbit.target + side * Vec3::Z * orbit.distance;
    for mut camera in &mut cameras {
        *camera = Transform::from_translation(eye).looking_at(orbit.target, Vec3::Y);
    }
}
