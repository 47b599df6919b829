//! A camera that follows the car: beside it while the script drives, behind it while a player drives.

use super::car::Chassis;
use super::driver::Pedals;
use bevy::prelude::*;

/// Camera position relative to the car while the script drives, m: ahead, up and to the right.
pub const EYE: Vec3 = Vec3::new(-5.4, 2.3, 4.9);
/// Camera position relative to the car while a player drives, m: ahead, up and to the right.
const BEHIND: Vec3 = Vec3::new(-8.5, 2.9, 0.0);
/// Rate at which the camera follows the car's heading, 1/s.
const FOLLOWS: f32 = 3.0;

pub fn follow(
    time: Res<Time<Virtual>>,
    pedals: Res<Pedals>,
    cars: Query<&Transform, (With<Chassis>, Without<Camera3d>)>,
    mut cameras: Query<&mut Transform, With<Camera3d>>,
    mut from: Local<Option<Vec3>>,
) {
    let Ok(car) = cars.single() else {
        return;
    };
    let side = if pedals.by_hand { BEHIND } else { EYE };
    // The camera stays level when the car pitches or rolls.
    let forward = (car.rotation * Vec3::X).with_y(0.0).normalize_or(Vec3::X);
    let right = forward.cross(Vec3::Y);
    let wanted = side.x * forward + side.y * Vec3::Y + side.z * right;
    let eased = from.map_or(wanted, |from| {
        from.lerp(wanted, 1.0 - (-FOLLOWS * time.delta_secs()).exp())
    });
    *from = Some(eased);
    // The target rises by half the height of a jump.
    let mut target = car.translation;
    target.y = 0.5 + 0.5 * (target.y - 0.55);
    for mut camera in &mut cameras {
        *camera = Transform::from_translation(target + eased).looking_at(target, Vec3::Y);
    }
}
