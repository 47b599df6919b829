//! How far ahead the engine has to see the contacts of what stiff springs push.

use super::lend;
use crate::scene::rows::{BodyFlags, BodyRow};
use bevy_rapier3d::rapier::dynamics::RigidBody as RapierBody;

/// ω·dt of a body's springs above which its contacts have to be seen a step ahead. What the engine finds too late it pushes
/// out of the ground, or stops at its surface, and either compresses a stiff spring. Pinned by `ground::feet` and
/// `ground::nets`.
const STIFF: f64 = 0.3;

/// How far ahead, in steps.
const AHEAD: f32 = 1.5;

/// Has the engine see contacts of a body ahead that can touch something and that stiff springs push, in steps of
/// `time` seconds; says whether they are stiff.
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
