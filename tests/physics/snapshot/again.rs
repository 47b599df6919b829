//! Going back to an earlier tick in the same app.

use super::film::*;
use super::scenes::*;
use crate::dice::in_turn;
use crate::harness::body;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Ticks until the snapshot, and ticks compared after it.
const BEFORE: usize = 200;
const AFTER: usize = 300;

/// Takes a snapshot after `before` ticks and asserts that two replays from it equal the first run.
fn go_back(name: &str, film: &mut Film, before: usize) {
    film.run(before);
    let then = Both::take(film);
    let at = film.tick;
    let first = film.watch(AFTER);
    assert!(film.is_sound(), "{name}");
    for _ in 0..2 {
        then.restore(film);
        film.tick = at;
        film.rewind();
        let second = film.watch(AFTER);
        assert_same(name, &first, &second);
    }
}

#[test]
fn what_sleeps_goes_on_sleeping_and_wakes_when_it_did() {
    for (name, plugin, scene) in sleepers() {
        for before in [150, 450, 640] {
            let mut film = scene(plugin);
            go_back(&format!("{name}, {before}"), &mut film, before);
        }
        let mut film = scene(plugin);
        film.run(450);
        assert!(film.asleep() > 0, "{name}");
    }
}

#[test]
fn a_scene_goes_back_to_its_first_ticks() {
    // The game itself has to spawn elements that break meanwhile again: see `changed`.
    let whole = |(name, ..): &(String, _, _)| !name.starts_with("breaking");
    for (name, plugin, scene) in in_turn(all()).into_iter().filter(whole) {
        for before in [1, 2, 3] {
            let mut film = scene(plugin);
            film.run(before);
            let then = Both::take(&film);
            let first = film.watch(40);
            then.restore(&mut film);
            film.tick = before;
            film.rewind();
            assert_same(&format!("{name}, {before}"), &first, &film.watch(40));
        }
    }
}

#[test]
fn a_scene_that_goes_back_has_the_same_future() {
    let mut failures = Vec::new();
    for (name, plugin, scene) in in_turn(all()) {
        let run = catch_unwind(AssertUnwindSafe(|| {
            let mut film = scene(plugin);
            go_back(&name, &mut film, BEFORE);
        }));
        if let Err(failure) = run {
            let text = failure.downcast_ref::<String>().cloned();
            failures.push(text.unwrap_or_else(|| name.clone()));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// The first step does not know that the wheel stands, so it does not know either which end is the load.
#[test]
fn a_sag_that_is_computed_once_more_is_so_after_going_back_too() {
    let mut film = Film::new(CoiloverPlugin::default());
    film.ground();
    let guided = LockedAxes::ROTATION_LOCKED
        | LockedAxes::TRANSLATION_LOCKED_X
        | LockedAxes::TRANSLATION_LOCKED_Z;
    let load = film.spawn((body(300.0, Vec3::Y * 0.8), guided));
    let wheel = film.solid(Vec3::Y * 0.3, Collider::ball(0.3), 20.0);
    let tuning = SpringTuning::sag(0.1, 0.3);
    let element = film.spawn((SpringDamper::new(load, wheel), tuning));
    film.run(1);
    let then = Both::take(&film);
    let known = *film.lab.get::<SpringDamper>(element);
    assert_eq!(known.rest_length, None, "not final yet");
    let first = film.watch(60);
    let rest = film.lab.get::<SpringDamper>(element).rest_length;
    film.insert(element, (known, tuning));
    then.restore(&mut film);
    assert_same("sag", &first, &film.watch(60));
    let again = film.lab.get::<SpringDamper>(element).rest_length;
    assert_eq!(again, rest);
}
