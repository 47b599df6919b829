//! Objects that an element adds to Rapier: its joints, and hidden bodies that stand for ends without a rigid body.

use super::write::Engine;
use crate::backend::BodyId;
use crate::backend::rapier::body::{handle, id};
use crate::compat;
use crate::scene::held::Inside;
use crate::scene::rows::Held;
use bevy_rapier3d::rapier::dynamics::RigidBodyBuilder;

/// Removes the joints and hidden bodies of an element from the engine.
pub(crate) fn remove(inside: &mut Inside, engine: &mut Engine) {
    inside.joints.remove(&mut engine.joints.impulse_joints);
    for body in inside.hidden.iter_mut().filter_map(Option::take) {
        compat::remove(
            handle(body),
            engine.bodies,
            engine.islands,
            engine.colliders,
            engine.joints,
        );
    }
    inside.active = false;
}

/// Returns the engine's body at an end. For an end without a rigid body it makes or moves a hidden kinematic body.
pub(crate) fn holder(inside: &mut Inside, end: usize, held: &Held, engine: &mut Engine) -> BodyId {
    let (from, to) = match *held {
        Held::Body { body, .. } => return body,
        Held::Path { from, to } => (from.as_vec3(), to.as_vec3()),
    };
    let known = inside.hidden[end].filter(|body| engine.bodies.contains(handle(*body)));
    let body = known.unwrap_or_else(|| {
        let body = RigidBodyBuilder::kinematic_position_based().translation(from);
        id(engine.bodies.insert(body))
    });
    inside.hidden[end] = Some(body);
    if let Some(body) = engine.bodies.get_mut(handle(body)) {
        if body.translation() != from {
            body.set_translation(from, true);
        }
        if to != from {
            body.set_next_kinematic_translation(to);
        }
    }
    body
}
