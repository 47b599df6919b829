//! Settings of Rapier bodies that the crate changes temporarily: solver iterations and contact prediction.

use crate::scene::rows::Raised;
use bevy_rapier3d::rapier::dynamics::RigidBody;

/// Sets the additional solver iterations of a body to `iterations`, or to the user's number if that is greater.
pub(crate) fn raise(raised: &mut Raised, body: &mut RigidBody, iterations: usize) {
    let now = body.additional_solver_iterations();
    let ours = raised.order_substeps(now, iterations);
    if ours != now {
        body.set_additional_solver_iterations(ours);
    }
}

/// Sets the contact prediction distance of a body to `way` (m), or to the user's distance if that is greater.
pub(crate) fn look_ahead(raised: &mut Raised, body: &mut RigidBody, way: f32) {
    let now = body.soft_ccd_prediction();
    let ours = raised.order_prediction(now, way);
    if ours != now {
        body.set_soft_ccd_prediction(ours);
    }
}

/// Whether a body has the settings that `raised` records, and not those that the crate set later (`meanwhile`).
pub(crate) fn fits(raised: &Raised, body: &RigidBody, meanwhile: Raised) -> bool {
    let iterations = body.additional_solver_iterations();
    raised.fits(iterations, body.soft_ccd_prediction(), meanwhile)
}

/// Restores the user's settings.
pub(crate) fn give_back(raised: &mut Raised, body: &mut RigidBody) {
    raise(raised, body, 0);
    look_ahead(raised, body, 0.0);
}
