//! What bodies are lent in Rapier besides forces.

use crate::scene::rows::Raised;
use bevy_rapier3d::rapier::dynamics::RigidBody;

/// Has Rapier solve a body in so many iterations more than its own, or as many as its user asks for.
pub(crate) fn raise(raised: &mut Raised, body: &mut RigidBody, iterations: usize) {
    let now = body.additional_solver_iterations();
    let ours = raised.order_substeps(now, iterations);
    if ours != now {
        body.set_additional_solver_iterations(ours);
    }
}

/// Has Rapier see its contacts so far ahead, m.
pub(crate) fn look_ahead(raised: &mut Raised, body: &mut RigidBody, way: f32) {
    let now = body.soft_ccd_prediction();
    let ours = raised.order_prediction(now, way);
    if ours != now {
        body.set_soft_ccd_prediction(ours);
    }
}

/// Whether this is what the body had been lent when it was as it is now; `meanwhile` it was lent that.
pub(crate) fn fits(raised: &Raised, body: &RigidBody, meanwhile: Raised) -> bool {
    let iterations = body.additional_solver_iterations();
    raised.fits(iterations, body.soft_ccd_prediction(), meanwhile)
}

/// Gives back what the user had ordered.
pub(crate) fn give_back(raised: &mut Raised, body: &mut RigidBody) {
    raise(raised, body, 0);
    look_ahead(raised, body, 0.0);
}
