//! Elements that differ in nothing but when they were spawned, after one of them has come again with another entity.

use super::film::*;
use super::scenes::*;
use bevy::ecs::entity::{EntityHashMap, MapEntities};
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// Three weights in a row. Two springs alike are between the last two, and have `companions`.
fn row(companions: [SpringAction; 2]) -> (Film, [Entity; 2]) {
    let mut film = Film::new(CoiloverPlugin::default().with_tolerance(1e-4));
    let hook = film.point(Vec3::Y * 3.0);
    let weights = [0.5, 1.0, 1.7].map(|x| film.brick(0.5, Vec3::new(x, 3.0, 0.1 * x)));
    film.spawn(coil(hook, weights[0], 300.0, 0.2));
    film.spawn(coil(weights[0], weights[1], 250.0, 0.1));
    let twins = companions.map(|action| {
        let twin = coil(weights[1], weights[2], 90.0, 0.05).with_rest_length(0.6);
        film.spawn((twin, action))
    });
    (film, twins)
}

/// Another spring far away, for which all rows are made anew.
fn spawn_another(film: &mut Film) {
    let body = film.lab.body(1.0, Vec3::new(9.0, 0.0, 0.0));
    let hook = film.lab.point(Vec3::new(9.0, 1.0, 0.0));
    film.lab.spawn(coil(hook, body, 100.0, 1.0));
}

/// Runs on for 20 ticks, spawns another spring and runs on.
fn go_on(film: &mut Film) -> Vec<Vec<u32>> {
    let mut seen = film.watch(20);
    spawn_another(film);
    seen.extend(film.watch(200));
    seen
}

#[test]
fn a_spring_that_came_again_after_its_twin_goes_on_as_the_first_of_both() {
    use SpringAction::{Both as PushAndPull, Pull, Push};
    for companions in [[PushAndPull; 2], [Pull, Push]] {
        let (mut first, _) = row(companions);
        first.run(200);
        let (mut film, [twin, other]) = row(companions);
        film.run(200);
        let mut saved = Both::take(&film);
        let seen = go_on(&mut first);
        film.run(10);
        let element = *film.lab.get::<SpringDamper>(twin);
        let world = film.lab.app.world_mut();
        world.despawn(twin);
        // The new entity comes after the twin's if the old one came before it, and the other way round.
        let again = loop {
            let entity = world.spawn_empty().id();
            if (entity < other) != (twin < other) {
                break entity;
            }
        };
        film.insert(again, (element, companions[0]));
        for known in film.cast.iter_mut().filter(|known| **known == twin) {
            *known = again;
        }
        let mut names = EntityHashMap::from_iter([(twin, again)]);
        saved.springs.map_entities(&mut names);
        saved.restore(&mut film);
        film.tick = 200;
        assert_same(&format!("{companions:?}"), &seen, &go_on(&mut film));
    }
}
