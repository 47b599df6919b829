//! Going back after elements and bodies have come, gone or changed.

use super::film::*;
use super::scenes::*;
use crate::harness::*;
use bevy::ecs::entity::{EntityHashMap, MapEntities};
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const BEFORE: usize = 200;
const AFTER: usize = 300;

/// The scene of a name after 200 ticks.
fn played(name: &str) -> Film {
    after(name, BEFORE)
}

/// Scenes in which springs are alone, in networks, and held by contacts or joints.
const NAMES: [&str; 5] = [
    "lone, plain",
    "chain, plain",
    "lattice, tolerance",
    "cloth, plain",
    "hinges, plain",
];

#[test]
fn elements_that_were_despawned_are_spawned_again_and_go_on() {
    for name in NAMES {
        let mut film = played(name);
        let then = Both::take(&film);
        let first = film.watch(AFTER);
        then.restore(&mut film);
        film.run(50);
        let world = film.lab.app.world_mut();
        let mut all = world.query::<(Entity, &SpringDamper, Option<&Anchors>)>();
        let gone: Vec<_> = all
            .iter(world)
            .step_by(3)
            .map(|(entity, element, anchors)| (entity, *element, anchors.copied()))
            .collect();
        assert!(!gone.is_empty());
        for (entity, ..) in &gone {
            world.despawn(*entity);
        }
        film.run(50);
        let mut then = then.clone();
        let mut new = EntityHashMap::default();
        for (entity, element, anchors) in gone {
            let again = film.lab.spawn((element, anchors.unwrap_or_default()));
            new.insert(entity, again);
            for known in &mut film.cast {
                if *known == entity {
                    *known = again;
                }
            }
        }
        then.springs.map_entities(&mut new);
        then.restore(&mut film);
        assert_same(name, &first, &film.watch(AFTER));
    }
}

#[test]
fn what_came_later_and_is_despawned_leaves_nothing() {
    for name in NAMES {
        let mut film = played(name);
        let then = Both::take(&film);
        let first = film.watch(AFTER);
        then.restore(&mut film);
        film.run(20);
        let more = film.lab.spawn((
            brick(1.0, Vec3::splat(0.1), Vec3::new(0.1, 4.0, 0.2)),
            Collider::ball(0.2),
        ));
        let body = film.cast[film.cast.len() / 2];
        let ends = film.lab.app.world().get::<RigidBody>(body);
        let end = if ends.is_some() {
            body
        } else {
            film.lab.point(Vec3::Y)
        };
        let spring = film
            .lab
            .spawn(SpringDamper::new(end, more).with_stiffness(300.0));
        film.run(80);
        for entity in [more, spring] {
            film.lab.app.world_mut().despawn(entity);
        }
        then.restore(&mut film);
        assert_same(name, &first, &film.watch(AFTER));
    }
}

#[test]
fn a_thread_that_broke_since_is_whole_again() {
    let mut film = played("lone, plain");
    let then = Both::take(&film);
    let first = film.watch(AFTER);
    then.restore(&mut film);
    let element = film.cast[2];
    film.insert(element, Breakable::at_force(0.01).disabling());
    film.run(30);
    let world = film.lab.app.world_mut();
    assert!(world.get::<Disabled>(element).is_some(), "it broke");
    world.entity_mut(element).remove::<(Disabled, Breakable)>();
    then.restore(&mut film);
    assert_same("broken", &first, &film.watch(AFTER));
}

/// Which of the bodies are disabled, by their components and in Rapier.
fn disabled(film: &mut Film) -> Vec<(Entity, bool, bool)> {
    let world = film.lab.app.world_mut();
    let mut sets = world.query::<&RapierRigidBodySet>();
    let set = sets.single(world).expect("one context");
    let of = |entity: &Entity| {
        let handle = world.get::<RapierRigidBodyHandle>(*entity)?.0;
        let is_off = !set.bodies.get(handle)?.is_enabled();
        let has = world.get::<RigidBodyDisabled>(*entity).is_some();
        Some((*entity, has, is_off))
    };
    film.cast.iter().filter_map(of).collect()
}

#[test]
fn bodies_that_were_disabled_are_disabled_again_and_the_others_are_not() {
    let mut film = played("disabled, plain");
    let (then, at) = (Both::take(&film), film.tick);
    let were = disabled(&mut film);
    let count = were.iter().filter(|(_, has, is_off)| *has && *is_off);
    assert_eq!(count.count(), 2);
    let first = film.watch(AFTER);
    assert!(disabled(&mut film) != were, "the game changed them");
    for _ in 0..2 {
        then.restore(&mut film);
        film.tick = at;
        assert_eq!(disabled(&mut film), were);
        assert_same("disabled", &first, &film.watch(AFTER));
    }
}

#[test]
fn components_that_are_only_written_anew_change_nothing() {
    for name in [
        "feet, plain",
        "lattice, plain",
        "laws, plain",
        "lone, tolerance",
    ] {
        let mut film = played(name);
        film.run(300);
        let then = Both::take(&film);
        let first = film.watch(AFTER);
        let world = film.lab.app.world_mut();
        let mut elements = world.query::<(&mut SpringDamper, Option<&mut Anchors>)>();
        for (mut element, anchors) in elements.iter_mut(world) {
            element.set_changed();
            if let Some(mut anchors) = anchors {
                anchors.set_changed();
            }
        }
        let mut beside = world.query::<(Option<&mut Preload>, Option<&mut SpringAction>)>();
        for (preload, action) in beside.iter_mut(world) {
            if let Some(mut preload) = preload {
                preload.set_changed();
            }
            if let Some(mut action) = action {
                action.set_changed();
            }
        }
        let mut velocities = world.query::<&mut Velocity>();
        for mut velocity in velocities.iter_mut(world) {
            velocity.set_changed();
        }
        then.restore(&mut film);
        assert_same(name, &first, &film.watch(AFTER));
    }
}

#[test]
fn a_number_that_was_changed_just_before_the_snapshot_acts_after_it() {
    let mut film = played("feet, plain");
    film.run(300);
    let world = film.lab.app.world_mut();
    let mut elements = world.query::<&mut SpringDamper>();
    for mut element in elements.iter_mut(world) {
        element.stiffness *= 1.5;
    }
    let then = Both::take(&film);
    let first = film.watch(AFTER);
    then.restore(&mut film);
    assert_same("changed", &first, &film.watch(AFTER));
}

#[test]
fn a_snapshot_serves_many_times_and_from_every_tick() {
    let mut film = played("feet, plain");
    let takes: Vec<_> = (0..40)
        .map(|_| {
            film.run(8);
            (Both::take(&film), film.bits())
        })
        .collect();
    for (i, (then, _)) in takes.iter().enumerate().rev() {
        then.restore(&mut film);
        for (_, later) in &takes[i + 1..(i + 3).min(takes.len())] {
            film.run(8);
            assert_same("feet", std::slice::from_ref(later), &[film.bits()]);
        }
    }
}

#[test]
fn a_companion_that_came_and_went_since_does_not_wake_what_sleeps() {
    let (mut film, [_, weight, spring]) = hung();
    let then = Both::take(&film);
    let first = film.watch(AFTER);
    then.restore(&mut film);
    film.insert(spring, MaxForce(1e9));
    film.run(10);
    assert!(!film.lab.is_sleeping(weight), "it wakes it once");
    film.lab
        .app
        .world_mut()
        .entity_mut(spring)
        .remove::<MaxForce>();
    then.restore(&mut film);
    assert_same("hung", &first, &film.watch(AFTER));
}

#[test]
fn a_number_that_was_changed_in_a_pause_acts_after_it_as_if_there_had_been_no_going_back() {
    for name in ["lone, plain", "feet, plain"] {
        let mut film = played(name);
        film.lab.set_stepping(false);
        let world = film.lab.app.world_mut();
        let mut elements = world.query::<&mut SpringDamper>();
        for mut element in elements.iter_mut(world) {
            element.stiffness *= 1.5;
        }
        film.run(2);
        let then = Both::take(&film);
        film.lab.set_stepping(true);
        let first = film.watch(AFTER);
        then.restore(&mut film);
        assert_same(name, &first, &film.watch(AFTER));
    }
}

/// Hangs a weight on a spring from a hook. Returns hook, weight and spring.
fn hang(film: &mut Film) -> [Entity; 3] {
    let hook = film.spawn(Transform::default());
    let weight = film.spawn(body(1.0, Vec3::NEG_Y));
    let spring = film.spawn(
        SpringDamper::new(hook, weight)
            .with_stiffness(200.0)
            .with_damping(25.0)
            .with_rest_length(1.0),
    );
    [hook, weight, spring]
}

/// A weight that hangs from a hook and sleeps.
fn hung() -> (Film, [Entity; 3]) {
    let mut film = Film::new(CoiloverPlugin::default());
    let [hook, weight, spring] = hang(&mut film);
    film.run(720);
    assert!(film.lab.is_sleeping(weight));
    (film, [hook, weight, spring])
}

#[test]
fn a_number_that_differs_from_the_snapshot_wakes_the_weight_even_beside_a_new_element() {
    let (mut film, [hook, weight, spring]) = hung();
    let then = Both::take(&film);
    film.lab.get_mut::<SpringDamper>(spring).stiffness = 100.0;
    let other = film.lab.body(1.0, Vec3::new(9.0, -1.0, 0.0));
    let far = film.lab.point(Vec3::X * 9.0);
    film.lab.spawn(Spring::new(far, other).with_stiffness(50.0));
    let before = film.lab.position(weight).y;
    let springs = then.springs.clone().without_engine();
    springs
        .restore(film.lab.app.world_mut())
        .expect("the springs' side fits");
    film.run(300);
    let sank = before - film.lab.position(weight).y;
    assert!((sank - 9.81 / 200.0).abs() < 1e-3, "{sank} below {hook}");
}

#[test]
fn a_weight_without_a_spring_in_the_saved_state_falls_freely_when_that_is_loaded() {
    let mut film = Film::new(CoiloverPlugin::default());
    let saved = CoiloverSnapshot::take(film.lab.app.world());
    let [_, weight, spring] = hang(&mut film);
    film.run(120);
    let world = film.lab.app.world_mut();
    world.despawn(spring);
    let saved = saved.without_engine();
    saved.restore(world).expect("it fits");
    let before = film.lab.velocity(weight).y;
    film.run(30);
    let gained = film.lab.velocity(weight).y - before;
    assert!((gained + 9.81 * 0.5).abs() < 0.2, "{gained} m/s");
}

/// The ends are the game's: what goes back are the forces in the engine, which nothing would take from a body without elements.
#[test]
fn a_body_whose_element_went_elsewhere_falls_freely_after_going_back() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::ZERO);
    let [first, second] = [-1.0, 1.0].map(|x| lab.body(1.0, Vec3::new(x, -1.0, 0.0)));
    let spring = lab.spawn(Spring::new(hook, first).with_stiffness(50.0));
    lab.run(0.2);
    let world = lab.app.world();
    let then = (RapierSnapshot::take(world), CoiloverSnapshot::take(world));
    lab.get_mut::<Spring>(spring).body_b = second;
    lab.run(0.2);
    let world = lab.app.world_mut();
    then.0.restore(world).expect("the engine goes back");
    then.1.restore(world).expect("the springs go back");
    let before = lab.velocity(first);
    lab.run(0.5);
    let gained = lab.velocity(first) - before;
    let free = Vec3::NEG_Y * 9.81 * 0.5;
    println!("gained {gained} m/s, in free fall {free}");
    assert!((gained - free).length() < 1e-3, "{gained}");
}

/// The present element holds a body that the snapshot's did not, and that was disabled when the element came to hold it.
#[test]
fn a_body_that_is_held_only_since_the_snapshot_keeps_no_force_of_a_spring_that_is_gone() {
    let mut film = Film::new(CoiloverPlugin::default());
    let [a, b, c] = [0.0, 1.0, 2.0].map(|x| film.spawn(body(1.0, Vec3::X * x)));
    let pull = Spring::new(a, b).with_stiffness(50.0).with_rest_length(0.5);
    let element = film.spawn(pull);
    film.run(1);
    let then = Both::take(&film);
    film.lab.get_mut::<Spring>(element).body_b = c;
    let world = film.lab.app.world_mut();
    world.entity_mut(c).insert(RigidBodyDisabled);
    film.run(1);
    then.restore(&mut film);
    film.run(1);
    assert!(film.lab.get::<SpringLoad>(c).elements.force.x < -1.0);
    film.lab.app.world_mut().despawn(element);
    film.run(3);
    let handle = film.lab.get::<RapierRigidBodyHandle>(c).0;
    let world = film.lab.app.world_mut();
    let mut sets = world.query::<&RapierRigidBodySet>();
    let set = sets.single(world).expect("one context");
    assert_eq!(set.bodies[handle].user_force(), Vec3::ZERO);
}
