//! A camera that follows: beside the car while the script drives, behind it for who drives by hand.

use super::car::Chassis;
use super::driver::Pedals;
use bevy::prelude::*;

/// From the car, m: ahead, up and to the right.
pub const EYE: Vec3 = Vec3::new(-5.4, 2.3, 4.9);
const BEHIND: Vec3 = Vec3::new(-8.5, 2.9, 0.0);
/// How fast it turns after the car, 1/s.
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
    // It stays level, however the car jumps about.
    let forward = (car.rotation * Vec3::X).with_y(0.0).normalize_or(Vec3::X);
    let right = forward.cross(Vec3::Y);
    let wanted = side.x * forward + side.y * Vec3::Y + side.z * right;
    let eased = from.map_or(wanted, |from| {
        from.lerp(wanted, 1.0 - (-FOLLOWS * time.delta_secs()).exp())
    });
    *from = Some(eased);
    // Half of the height of a jump.
    let mut target = car.translation;
    target.y = 0.5 + 0.5 * (target.y - 0.55);
    for mut camera in &mut cameras {
        *camera = Transform::from_translation(target + eased).looking_at(target, Vec3::Y);
    }
}
