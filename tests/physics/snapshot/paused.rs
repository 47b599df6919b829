//! Going back while the game is paused, or between two steps of an interpolated game.

use super::film::*;
use super::scenes::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::time::Duration;

/// A player opens the menu, which pauses the game, and loads a saved game there.
#[test]
fn a_saved_game_that_is_loaded_in_a_pause_is_seen_at_once() {
    let mut film = after("lone, plain", 100);
    let saved = Both::take(&film);
    let then = film.bits();
    let first = film.watch(200);
    film.lab.set_stepping(false);
    film.run(2);
    saved.restore(&mut film);
    assert_same("at once", std::slice::from_ref(&then), &[film.bits()]);
    film.run(3);
    assert_same("in the pause", &[then], &[film.bits()]);
    film.lab.set_stepping(true);
    assert_same("after it", &first, &film.watch(200));
}

/// A game with 240 pictures and 60 steps a second.
#[test]
fn a_body_that_is_drawn_between_two_steps_is_drawn_there_again() {
    let mut film = after("lone, plain", 1);
    let app = &mut film.lab.app;
    app.insert_resource(TimestepMode::Interpolated {
        dt: 1.0 / 60.0,
        time_scale: 1.0,
        substeps: 1,
    });
    let frame = Duration::from_secs_f64(1.0 / 240.0);
    app.insert_resource(Time::<Fixed>::from_duration(frame));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    for entity in film.cast.clone() {
        if film.lab.app.world().get::<RigidBody>(entity).is_some() {
            film.insert(entity, TransformInterpolation::default());
        }
    }
    film.run(101);
    let saved = Both::take(&film);
    let then = film.bits();
    let first = film.watch(60);
    saved.restore(&mut film);
    assert_same("at once", &[then], &[film.bits()]);
    assert_same("later", &first, &film.watch(60));
}

/// A spring across a slope that is given an upright axis in a pause is shorter at once. Its ledger tells the work of that.
#[test]
fn an_axis_that_was_given_in_a_pause_counts_once_more_after_going_back() {
    let mut film = Film::new(CoiloverPlugin::default());
    let hook = film.point(Vec3::Y * 2.0);
    let weight = film.brick(1.0, Vec3::X);
    let spring = film.spawn(coil(hook, weight, 200.0, 5.0).with_rest_length(1.0));
    film.run(20);
    film.lab.set_stepping(false);
    film.insert(spring, SpringAxis::World(Vec3::NEG_Y));
    film.run(2);
    let saved = Both::take(&film);
    film.lab.set_stepping(true);
    let first = film.watch(60);
    saved.restore(&mut film);
    assert_same("axis", &first, &film.watch(60));
}

/// A network without gravity at rest. In the first step after going back, the engine's fixed body leaps a little.
#[test]
fn bodies_fall_asleep_at_the_same_tick_though_an_end_leaps_at_once_after_going_back() {
    let mut film = Film::new(CoiloverPlugin::default());
    let world = film.lab.app.world_mut();
    for mut engine in world.query::<&mut RapierConfiguration>().iter_mut(world) {
        engine.gravity = Vec3::ZERO;
    }
    let wall = film.spawn((RigidBody::Fixed, Transform::default()));
    let a = film.brick(1.0, Vec3::X);
    let b = film.brick(1.0, Vec3::X * 2.0);
    film.spawn(coil(wall, a, 1e-3, 0.0).with_rest_length(1.0));
    film.spawn(coil(a, b, 1e-3, 0.0).with_rest_length(1.0));
    film.deed = |film| {
        if film.tick == 39 {
            let wall = film.cast[0];
            film.lab.get_mut::<Transform>(wall).translation.x += 1e-4;
        }
    };
    film.run(39);
    let saved = Both::take(&film);
    let first = film.watch(300);
    assert!(film.asleep() == 2, "they sleep");
    saved.restore(&mut film);
    film.tick = 39;
    film.lab.get_mut::<Transform>(wall).translation = Vec3::ZERO;
    assert_same("leap", &first, &film.watch(300));
}

/// Bodies in the engine that belong to no entity.
fn hidden_bodies(film: &mut Film) -> usize {
    let world = film.lab.app.world_mut();
    let mut sets = world.query::<&RapierRigidBodySet>();
    let hidden = |set: &RapierRigidBodySet| set.bodies.len() - set.entity2body().len();
    sets.iter(world).map(hidden).sum()
}

/// A box on the ground, on a spring to a point, for which the engine has a hidden body. Rapier removes the joint with the box.
#[test]
fn what_a_spring_has_in_the_engine_when_its_body_is_despawned_in_a_pause_goes_after_going_back() {
    let mut film = Film::new(CoiloverPlugin::default());
    film.ground();
    let load = film.solid(Vec3::Y * 0.1, Collider::cuboid(0.1, 0.1, 0.1), 2.0);
    let hook = film.point(Vec3::Y);
    let spring = film.spawn(coil(hook, load, 10.0, 1.0).with_rest_length(0.9));
    film.run(30);
    assert_eq!(film.lab.readout(spring).method, SpringMethod::Engine);
    film.lab.set_stepping(false);
    film.lab.app.world_mut().despawn(load);
    film.run(2);
    assert_eq!(hidden_bodies(&mut film), 1, "the engine stands still");
    let saved = Both::take(&film);
    film.run(1);
    saved.restore(&mut film);
    film.lab.set_stepping(true);
    film.run(2);
    assert_eq!(hidden_bodies(&mut film), 0);
}
