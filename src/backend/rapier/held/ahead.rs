//! Sets how far ahead Rapier looks for contacts of bodies on stiff springs, before the step.

use super::lend;
use crate::scene::rows::{BodyFlags, BodyRow};
use bevy_rapier3d::rapier::dynamics::RigidBody as RapierBody;

/// ω·dt of a body's springs above which its contacts must be found a step ahead. If the engine finds a contact too late, it
/// pushes the body out of the ground or stops it at the surface. Both compress a stiff spring. Pinned by `ground::feet` and
/// `ground::nets`.
const STIFF: f64 = 0.3;

/// Prediction distance, in steps of the body's present motion. Pinned by
/// `ground::bounce::a_pair_that_bounces_for_long_wins_nothing`.
const AHEAD: f32 = 1.5;

/// Makes Rapier look ahead for contacts of a body if it has colliders and stiff springs. `time` is the duration of an engine
/// step, s. Returns whether the body has both.
pub(crate) fn look_ahead(row: &mut BodyRow, body: &mut RapierBody, time: f64) -> bool {
    let inverse_mass = f64::from(body.mass_properties().local_mprops.inv_mass);
    let stiff = row.has(BodyFlags::CAN_TOUCH)
        && row.rare.stiffness * inverse_mass * time * time > STIFF * STIFF;
    let way = if stiff {
        AHEAD * time as f32 * body.linvel().length()
    } else {
        0.0
    };
    lend::look_ahead(&mut row.rare.raised, body, way);
    stiff
}
