//! For how many steps a search for near colliders is believed.

use super::{Outlook, is_clear};
use crate::backend::rapier::body::id;
use crate::scene::rows::{BodyRow, Searched};
use bevy::math::Vec3;
use bevy::prelude::Entity;
use bevy_rapier3d::rapier::dynamics::{IntegrationParameters, RigidBodyBuilder, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{ColliderBuilder, ColliderSet, DefaultBroadPhase};

const TIME: f32 = 1.0 / 60.0;
const RADIUS: f32 = 0.1;

/// Number of steps that a ball at rest takes after one search, while another ball, `apart` metres away, flies towards it at `speed`
/// m/s. None if they may meet in the coming step.
fn steps_taken(apart: f32, speed: f32) -> Option<u8> {
    let mut bodies = RigidBodySet::new();
    let mut colliders = ColliderSet::new();
    let mut broad = DefaultBroadPhase::new();
    let mut ball = |at: Vec3, velocity: Vec3| {
        let body = RigidBodyBuilder::dynamic().translation(at).linvel(velocity);
        let body = bodies.insert(body);
        let shape = ColliderBuilder::ball(RADIUS);
        let shape = colliders.insert_with_parent(shape, body, &mut bodies);
        let bounds = colliders[shape].compute_aabb();
        broad.set_aabb(&IntegrationParameters::default(), shape, bounds);
        body
    };
    let own = ball(Vec3::ZERO, Vec3::ZERO);
    ball((apart + 2.0 * RADIUS) * Vec3::X, speed * Vec3::NEG_X);
    let mut row = BodyRow::new(Entity::PLACEHOLDER, id(own), Entity::PLACEHOLDER);
    let outlook = Outlook {
        broad: &broad,
        bodies: &bodies,
        colliders: &colliders,
        time: TIME,
    };
    let clear = outlook.look(&[&row], &[0.0], |handle| handle == own)?;
    row.rare.searched = Searched {
        at: bodies[own].center_of_mass(),
        way: clear.way,
    };
    let without_search = if is_clear(&row, &bodies[own], TIME) {
        clear.steps
    } else {
        0
    };
    Some(1 + without_search)
}

#[test]
fn what_flies_in_is_searched_for_again_before_it_arrives() {
    for speed in [2.0, 5.0, 10.0, 20.0, 29.0] {
        for apart in [0.3, 0.6, 1.2, 2.4, 3.6, 4.1] {
            let Some(steps) = steps_taken(apart, speed) else {
                continue;
            };
            let flown = f32::from(steps) * speed * TIME;
            assert!(flown < apart, "{speed} m/s, {apart} m: {steps} steps");
        }
    }
}

#[test]
fn what_falls_from_rest_is_searched_for_again_before_it_arrives() {
    let apart = 0.2;
    let steps = steps_taken(apart, 0.0).expect("it is still far away");
    let seconds = f32::from(steps) * TIME;
    let fallen = 0.5 * 9.81 * seconds * seconds;
    assert!(fallen < apart, "{steps} steps, {fallen} m");
}
