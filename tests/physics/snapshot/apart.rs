//! Restoring into another app, where every entity has another id.

use super::film::*;
use super::scenes::*;
use crate::dice::in_turn;
use bevy::ecs::entity::{EntityHashMap, MapEntities};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};

const BEFORE: usize = 200;
const AFTER: usize = 300;

/// A scene in an app of its own with other entity ids, one tick old.
fn elsewhere(scene: Play, plugin: CoiloverPlugin) -> Film {
    STRANGERS.set(7);
    let mut film = scene(plugin);
    STRANGERS.set(0);
    film.run(1);
    film
}

fn names(from: &Film, to: &Film) -> EntityHashMap<Entity> {
    let pairs = from.cast.iter().copied().zip(to.cast.iter().copied());
    pairs.collect()
}

fn go_on_elsewhere(name: &str, plugin: CoiloverPlugin, scene: Play) {
    let mut film = scene(plugin);
    film.run(BEFORE);
    let (mut then, props) = (Both::take(&film), Props::take(&film));
    let mut other = elsewhere(scene, plugin);
    let mut names = names(&film, &other);
    assert!(names.iter().all(|(a, b)| a != b), "{name}");
    then.engine.map_entities(&mut names);
    then.springs.map_entities(&mut names);
    props.restore(&mut other, &names);
    then.restore(&mut other);
    other.tick = film.tick;
    let (first, second) = (film.watch(AFTER), other.watch(AFTER));
    assert_same(name, &first, &second);
}

#[test]
fn a_scene_goes_on_in_another_app_as_in_its_own() {
    let mut failures = Vec::new();
    for (name, plugin, scene) in in_turn(all()) {
        let run = catch_unwind(AssertUnwindSafe(|| go_on_elsewhere(&name, plugin, scene)));
        if let Err(failure) = run {
            let text = failure.downcast_ref::<String>().cloned();
            failures.push(text.unwrap_or_else(|| name.clone()));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Only the transforms and the springs' side of the snapshot are restored. The scene then stays
/// finite and leaves no extra joints.
#[test]
fn without_rapiers_side_a_scene_goes_on_nearly_as_it_did() {
    let mut film = after("hinges, plain", BEFORE);
    let then = CoiloverSnapshot::take(film.lab.app.world());
    let bodies: Vec<_> = film
        .cast
        .iter()
        .map(|e| film.lab.app.world().get::<Transform>(*e).copied())
        .collect();
    film.run(20);
    for (entity, place) in film.cast.clone().into_iter().zip(bodies) {
        if let (Some(place), Some(mut now)) = (place, film.lab.app.world_mut().get_mut(entity)) {
            *now = place;
        }
    }
    let world = film.lab.app.world_mut();
    let engine = then.restore(world);
    let without = then.without_engine().restore(world);
    println!("{engine:?}, {without:?}");
    assert_eq!(without, Ok(()));
    film.run(AFTER);
    assert!(film.is_sound());
    // The springs make their joints anew and remove the earlier ones.
    let joints = |film: &mut Film| {
        let world = film.lab.app.world_mut();
        let mut sets = world.query::<&RapierContextJoints>();
        let joints = sets.single(world).expect("one context");
        joints.impulse_joints.len()
    };
    let mut plain = after("hinges, plain", BEFORE + AFTER);
    assert_eq!(joints(&mut film), joints(&mut plain));
}
