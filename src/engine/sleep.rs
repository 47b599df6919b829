//! A body may sleep only where it would really stay.
//!
//! Rapier puts a body to sleep after half a second below a speed that a slow spring never exceeds, and
//! a body at its turning point is slow too. So bodies of a component that is not at rest have their
//! timers set back, and one that is disturbed is woken as a whole.

use super::forces::SpringLoad;
use crate::dynamics::body::Body;
use bevy_rapier3d::rapier::dynamics::RigidBody as RapierBody;

/// Speed (m/s, rad/s; times the engine's length unit) that counts as rest, for the present velocity
/// and for the velocity that the present acceleration would lead to within the element's period.
const REST: f32 = 2e-4;

/// Rounding of a position that is not motion, in units of its last place: a stiff spring answers each
/// of them with a speed of ω times that.
const ROUNDING: f32 = 4.0;

/// Slowest natural frequency (rad/s) that is waited for.
const SLOWEST: f32 = 0.05;

/// Judges by measured acceleration, so that contacts and joints count. `omega` is the natural
/// frequency of the stiffest element on the body.
pub(super) fn is_restless(
    load: &SpringLoad,
    body: &RapierBody,
    omega: f32,
    time: f32,
    length_unit: f32,
) -> bool {
    let (linear, angular) = (body.linvel(), body.angvel());
    let Some((linear_before, angular_before)) = load.before else {
        return true;
    };
    let reach = 1.0 / (time * omega.max(SLOWEST));
    let place = body.position().translation.abs().max_element();
    let noise = ROUNDING * f32::EPSILON * omega;
    let still = |now: f32, change: f32, limit: f32| {
        now * now + (change * reach) * (change * reach) < limit * limit
    };
    !(still(
        linear.length(),
        (linear - linear_before).length(),
        REST * length_unit + noise * place,
    ) && still(
        angular.length(),
        (angular - angular_before).length(),
        REST + noise,
    ))
}

/// Whether a step would set a sleeping body moving: an acceleration that within a second is not rest.
pub(super) fn is_set_moving(start: &Body, end: &Body, time: f64, length_unit: f32) -> bool {
    let rest = f64::from(REST) * time;
    (end.velocity - start.velocity).length() > rest * f64::from(length_unit)
        || (end.angular_velocity() - start.angular_velocity()).length() > rest
}

/// Sets the engine's sleep timer back.
pub(super) fn keep_awake(body: &mut RapierBody) {
    body.activation_mut().time_since_can_sleep = 0.0;
}
