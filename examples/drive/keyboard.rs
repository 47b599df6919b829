//! Input from keyboard and gamepad. The first input takes control of the car from the script.

use super::car::Chassis;
use super::driver::Pedals;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Again, DT};

/// Rate at which keys turn the front wheels, rad/s.
const TURN: f32 = 1.4;
/// Greatest angle of the front wheels, rad.
const LOCK: f32 = 0.5;
/// Greatest lateral acceleration that is steered for, m/s²: what the tyres hold.
const ACROSS: f32 = 9.0;
/// Wheelbase, m.
const BASE: f32 = 2.6;
/// Speed below which the down key drives backwards instead of braking, m/s.
const SLOW: f32 = 1.0;
/// Deflection of a stick or a trigger below which it counts as released.
const DEAD: f32 = 0.1;

/// Returns throttle, steering and brake as asked for, or `None` without input. Gamepads work only where Bevy is built
/// with its feature `bevy_gilrs`. These examples leave it out, because it needs a system library.
fn asked(keys: Option<&ButtonInput<KeyCode>>, pads: &Query<&Gamepad>) -> Option<(f32, f32, bool)> {
    let down = |any: &[KeyCode]| keys.is_some_and(|keys| keys.any_pressed(any.iter().copied()));
    let amount = |any: &[KeyCode]| f32::from(u8::from(down(any)));
    let mut gas =
        amount(&[KeyCode::ArrowUp, KeyCode::KeyW]) - amount(&[KeyCode::ArrowDown, KeyCode::KeyS]);
    let mut left = amount(&[KeyCode::ArrowLeft, KeyCode::KeyA])
        - amount(&[KeyCode::ArrowRight, KeyCode::KeyD]);
    let mut brake = down(&[KeyCode::Space]);
    for pad in pads {
        let pressed = |button| pad.get(button).unwrap_or(0.0);
        gas += pressed(GamepadButton::RightTrigger2) - pressed(GamepadButton::LeftTrigger2);
        left -= pad.get(GamepadAxis::LeftStickX).unwrap_or(0.0);
        brake |= pressed(GamepadButton::South) > DEAD;
    }
    let touched = brake || gas.abs() > DEAD || left.abs() > DEAD;
    touched.then_some((gas.clamp(-1.0, 1.0), left.clamp(-1.0, 1.0), brake))
}

pub fn read(
    keys: Option<Res<ButtonInput<KeyCode>>>,
    pads: Query<&Gamepad>,
    time: Res<Time>,
    mut again: Option<ResMut<Again>>,
    mut pedals: ResMut<Pedals>,
    cars: Query<(&Transform, &Velocity), With<Chassis>>,
) {
    let asked = asked(keys.as_deref(), &pads);
    pedals.by_hand |= asked.is_some();
    let Ok((at, velocity)) = cars.single() else {
        return;
    };
    if !pedals.by_hand {
        return;
    }
    if let Some(again) = &mut again {
        again.leave_time(time.elapsed_secs());
    }
    let (gas, left, brake) = asked.unwrap_or_default();
    let speed = velocity.linear.dot(at.rotation * Vec3::X);
    let against = gas < 0.0 && speed > SLOW || gas > 0.0 && speed < -SLOW;
    pedals.throttle = if against || brake { 0.0 } else { gas };
    pedals.brake = match (brake, against) {
        (true, _) => 1.0,
        (_, true) => gas.abs(),
        // Without input, the car rolls to a stop.
        _ if gas == 0.0 => 0.06,
        _ => 0.0,
    };
    let most = LOCK.min(BASE * ACROSS / speed.powi(2).max(1.0));
    let step = (left * most - pedals.steer).clamp(-TURN * DT, TURN * DT);
    pedals.steer += step;
}
