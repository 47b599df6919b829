//! Turns the `BEVY_coilover` extension of a node into components.

use super::companions;
use super::json::{Object, Told};
use crate::element::*;
use bevy::prelude::*;
use serde_json::Value;

/// Name of the glTF extension.
pub(super) const NAME: &str = "BEVY_coilover";

/// JSON keys of the elements, each with its allowed fields.
pub(super) const KINDS: [(&str, &[&str]); 6] = [
    ("spring", &["a", "b", "stiffness", "restLength"]),
    ("damper", &["a", "b", "damping"]),
    (
        "springDamper",
        &["a", "b", "stiffness", "damping", "restLength"],
    ),
    (
        "torsionSpring",
        &["a", "b", "axis", "stiffness", "restAngle"],
    ),
    ("torsionDamper", &["a", "b", "axis", "damping"]),
    (
        "torsionSpringDamper",
        &["a", "b", "axis", "stiffness", "damping", "restAngle"],
    ),
];

/// Inserts the element that an extension describes into an entity. `find` returns the entity of a node of this scene.
///
/// Errors in the file are reported to `told`. A missing end stays [`Entity::PLACEHOLDER`], so that the element gets a
/// fault.
pub(super) fn insert(
    value: &Value,
    place: &str,
    told: &Told,
    find: impl Fn(usize) -> Option<Entity>,
    entity: &mut EntityWorldMut,
) {
    let Some(object) = Object::new(value, format!("{place}: {NAME}"), told) else {
        return;
    };
    let mut kinds = KINDS.into_iter().filter(|(key, _)| object.has(key));
    let (Some((key, fields)), None) = (kinds.next(), kinds.next()) else {
        let names = KINDS.map(|(key, _)| key).join(", ");
        told.tell(
            object.place(),
            format_args!("must have exactly one of {names}; the element is left out"),
        );
        return;
    };
    let Some(element) = object.object(key) else {
        return;
    };
    element.only(fields);
    let end = |key: &str| {
        let Some(index) = element.index(key) else {
            if !element.has(key) {
                element.tell(key, "is missing, so the element cannot act");
            }
            return Entity::PLACEHOLDER;
        };
        find(index).unwrap_or_else(|| {
            element.tell(
                key,
                format_args!("is node {index}, which this scene has not"),
            );
            Entity::PLACEHOLDER
        })
    };
    let (body_a, body_b) = (end("a"), end("b"));
    let axis = || {
        element.vector("axis").unwrap_or_else(|| {
            if !element.has("axis") {
                element.tell("axis", "is missing, so the element cannot act");
            }
            Vec3::ZERO
        })
    };
    let stiffness = element.number("stiffness").unwrap_or(1.0);
    let damping = element.number("damping").unwrap_or(1.0);
    let rest_length = element.number("restLength");
    let rest_angle = element.number("restAngle");
    match key {
        "spring" => entity.insert(Spring {
            body_a,
            body_b,
            rest_length,
            stiffness,
        }),
        "damper" => entity.insert(Damper {
            body_a,
            body_b,
            damping,
        }),
        "springDamper" => entity.insert(SpringDamper {
            body_a,
            body_b,
            rest_length,
            stiffness,
            damping,
        }),
        "torsionSpring" => entity.insert(TorsionSpring {
            body_a,
            body_b,
            axis: axis(),
            rest_angle,
            stiffness,
        }),
        "torsionDamper" => entity.insert(TorsionDamper {
            body_a,
            body_b,
            axis: axis(),
            damping,
        }),
        _ => entity.insert(TorsionSpringDamper {
            body_a,
            body_b,
            axis: axis(),
            rest_angle,
            stiffness,
            damping,
        }),
    };
    companions::insert(&object, key, entity);
}
