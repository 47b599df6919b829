//! Objects that an element adds to Rapier: its joints, and hidden bodies that stand for ends without an enabled rigid body.

use super::write::Engine;
use crate::backend::BodyId;
use crate::backend::rapier::body::{handle, id};
use crate::compat;
use crate::scene::held::Inside;
use crate::scene::rows::Held;
use bevy::math::Vec3;
use bevy_rapier3d::rapier::dynamics::RigidBodyBuilder;
use bevy_rapier3d::rapier::math::Pose;

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

/// Returns the engine's body at an end. For an end without a rigid body it makes or moves a hidden kinematic body. That body has
/// a velocity and no target, because the engine reaches a target in the first of several steps. A disabled body also needs one:
/// the engine takes its joints for joints with the origin of the world. `time` is the duration of all engine steps of the tick, s.
pub(crate) fn holder(
    inside: &mut Inside,
    end: usize,
    held: &Held,
    engine: &mut Engine,
    time: f64,
) -> BodyId {
    let (place, velocity) = match *held {
        Held::Body { body, .. } => match engine.bodies.get(handle(body)) {
            Some(disabled) if !disabled.is_enabled() => (*disabled.position(), Vec3::ZERO),
            _ => return body,
        },
        Held::Path { from, to } => (
            Pose::from_translation(from.as_vec3()),
            ((to - from) / time).as_vec3(),
        ),
    };
    let known = inside.hidden[end].filter(|body| engine.bodies.contains(handle(*body)));
    let body = known.unwrap_or_else(|| {
        let body = RigidBodyBuilder::kinematic_velocity_based().pose(place);
        id(engine.bodies.insert(body))
    });
    inside.hidden[end] = Some(body);
    if let Some(body) = engine.bodies.get_mut(handle(body)) {
        if *body.position() != place {
            body.set_position(place, true);
        }
        if body.linvel() != velocity {
            body.set_linvel(velocity, true);
        }
    }
    body
}
