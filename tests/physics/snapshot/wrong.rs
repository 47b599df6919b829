//! Restoring a snapshot that does not fit returns an error and changes nothing.

use super::film::*;
use super::scenes::*;
use crate::harness::{Engine, Lab};
use bevy::ecs::entity::{EntityHashMap, MapEntities};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A car on the road after 60 ticks. It has every kind of state that springs keep in Rapier.
fn played() -> Film {
    after("car, plain", 60)
}

fn springs(film: &mut Film, snapshot: &CoiloverSnapshot) -> Result<(), SnapshotError> {
    snapshot.restore(film.lab.app.world_mut())
}

fn engine(film: &mut Film, snapshot: &RapierSnapshot) -> Result<(), SnapshotError> {
    snapshot.restore(film.lab.app.world_mut())
}

fn element(film: &mut Film) -> Entity {
    let world = film.lab.app.world_mut();
    let mut elements = world.query_filtered::<Entity, With<SpringDamper>>();
    elements.iter(world).next().expect("an element")
}

#[test]
fn a_world_without_the_plugin_takes_nothing() {
    let film = played();
    let then = Both::take(&film);
    let mut world = World::new();
    assert_eq!(
        then.springs.restore(&mut world),
        Err(SnapshotError::NoPlugin)
    );
    assert_eq!(
        then.engine.restore(&mut world),
        Err(SnapshotError::NoPlugin)
    );
    let none = CoiloverSnapshot::take(&world);
    assert_eq!(none.entities().count(), 0);
}

#[test]
fn an_element_or_a_body_that_is_gone_is_named() {
    let mut film = played();
    let then = Both::take(&film);
    let element = element(&mut film);
    film.lab.app.world_mut().despawn(element);
    assert_eq!(
        springs(&mut film, &then.springs),
        Err(SnapshotError::NoElement(element))
    );
    film.run(5);
    assert_eq!(
        springs(&mut film, &then.springs),
        Err(SnapshotError::NoElement(element))
    );
    let chassis = film.cast[1];
    film.lab.app.world_mut().despawn(chassis);
    assert_eq!(
        engine(&mut film, &then.engine),
        Err(SnapshotError::NoBody(chassis))
    );
    film.run(5);
    assert_eq!(
        engine(&mut film, &then.engine),
        Err(SnapshotError::NoBody(chassis))
    );
}

#[test]
fn a_body_that_came_later_has_to_go_first() {
    let mut film = played();
    let then = Both::take(&film);
    let more = film.lab.body(1.0, Vec3::Y * 9.0);
    film.run(1);
    assert_eq!(
        engine(&mut film, &then.engine),
        Err(SnapshotError::Unknown(more))
    );
    film.lab.app.world_mut().despawn(more);
    assert_eq!(engine(&mut film, &then.engine), Ok(()));
}

#[test]
fn two_names_for_one_are_told() {
    let mut film = played();
    let mut then = Both::take(&film);
    let [a, b] = [film.cast[1], film.cast[2]];
    let mut both = EntityHashMap::default();
    both.insert(a, b);
    then.springs.map_entities(&mut both);
    then.engine.map_entities(&mut both);
    assert_eq!(
        springs(&mut film, &then.springs),
        Err(SnapshotError::Twice(b))
    );
    let told = engine(&mut film, &then.engine);
    assert!(matches!(
        told,
        Err(SnapshotError::Twice(_) | SnapshotError::OtherHandle(_))
    ));
}

#[test]
fn what_does_not_fit_leaves_the_scene_as_it_was() {
    let (mut film, mut same) = (played(), played());
    let then = Both::take(&film);
    film.run(40);
    same.run(40);
    // Without an element and after a hop, the joints of the snapshot no longer fit.
    let hop = |film: &mut Film| {
        let chassis = film.cast[1];
        let world = film.lab.app.world_mut();
        let mut elements = world.query_filtered::<Entity, With<SpringDamper>>();
        let element = elements.iter(world).next().expect("an element");
        world.despawn(element);
        film.lab.get_mut::<Velocity>(chassis).linear.y += 1.0;
        film.run(5);
    };
    hop(&mut film);
    hop(&mut same);
    assert!(springs(&mut film, &then.springs).is_err());
    let mut wrong = then.clone();
    let mut names: EntityHashMap<Entity> = EntityHashMap::default();
    names.insert(film.cast[1], film.cast[0]);
    wrong.engine.map_entities(&mut names);
    assert!(engine(&mut film, &wrong.engine).is_err());
    assert_same("car", &same.watch(100), &film.watch(100));
}

#[test]
fn springs_alone_do_not_fit_a_rapier_that_has_gone_on() {
    let mut film = played();
    let then = Both::take(&film);
    let element = element(&mut film);
    let damper = film.lab.get::<SpringDamper>(element).damping;
    // This changes the joints that springs have in Rapier.
    film.lab.get_mut::<SpringDamper>(element).damping = 0.0;
    let more = film
        .lab
        .spawn(SpringDamper::new(film.cast[1], film.cast[2]).with_stiffness(10.0));
    film.run(5);
    assert_eq!(
        springs(&mut film, &then.springs),
        Err(SnapshotError::OtherEngine)
    );
    film.lab.app.world_mut().despawn(more);
    film.lab.get_mut::<SpringDamper>(element).damping = damper;
    assert_eq!(engine(&mut film, &then.engine), Ok(()));
    assert_eq!(springs(&mut film, &then.springs), Ok(()));
}

#[test]
fn springs_alone_do_not_fit_a_rapier_that_solves_their_bodies_more_finely_now() {
    let mut film = played();
    let then = Both::take(&film);
    let expected = film.watch(60);
    let element = element(&mut film);
    let stiffness = film.lab.get::<SpringDamper>(element).stiffness;
    // The joints stay the same, but get more solver iterations.
    film.lab.get_mut::<SpringDamper>(element).stiffness = 1e3 * stiffness;
    film.run(5);
    assert_eq!(
        springs(&mut film, &then.springs),
        Err(SnapshotError::OtherEngine)
    );
    film.lab.get_mut::<SpringDamper>(element).stiffness = stiffness;
    assert_eq!(engine(&mut film, &then.engine), Ok(()));
    assert_eq!(springs(&mut film, &then.springs), Ok(()));
    assert_same("car", &expected, &film.watch(60));
}

#[test]
fn springs_alone_do_not_fit_a_rapier_that_solves_other_bodies_more_finely_now() {
    let mut film = Film::new(CoiloverPlugin::default());
    let frame = film.spawn((RigidBody::Fixed, Transform::default()));
    let arm = film.brick(1.0, Vec3::X * 0.5);
    let hinge = RevoluteJointBuilder::new(Vec3::Z).local_anchor2(Vec3::NEG_X * 0.5);
    film.insert(arm, ImpulseJoint::new(frame, hinge));
    film.run(5);
    let then = Both::take(&film);
    film.spawn(TorsionSpringDamper::new(frame, arm, Vec3::Z).with_stiffness(1e5));
    film.run(5);
    assert_eq!(
        springs(&mut film, &then.springs),
        Err(SnapshotError::OtherEngine)
    );
}

/// A box on the ground below a point, on a spring to it, and `more` bodies without elements far away.
fn below_a_point(more: usize) -> Film {
    let mut film = Film::new(CoiloverPlugin::default());
    film.ground();
    let load = film.solid(Vec3::Y * 0.1, Collider::cuboid(0.1, 0.1, 0.1), 2.0);
    let hook = film.point(Vec3::Y);
    film.spawn(coil(hook, load, 10.0, 1.0).with_rest_length(0.9));
    for i in 0..more {
        film.brick(1.0, Vec3::X * (i as f32 + 10.0));
    }
    film.run(30);
    film
}

/// Rapier has a hidden body for the point. In the other world the handle of that body is the brick's.
#[test]
fn a_body_of_the_game_is_not_taken_for_one_that_stands_for_a_point() {
    let (film, mut other) = (below_a_point(0), below_a_point(1));
    let spring = film.cast[3];
    assert_eq!(film.lab.readout(spring).method, SpringMethod::Engine);
    let mut then = CoiloverSnapshot::take(film.lab.app.world());
    let pairs = film.cast.iter().copied().zip(other.cast.iter().copied());
    let mut names: EntityHashMap<Entity> = pairs.collect();
    then.map_entities(&mut names);
    assert_eq!(springs(&mut other, &then), Err(SnapshotError::OtherEngine));
    assert_eq!(springs(&mut other, &then.without_engine()), Ok(()));
}

/// A box on the ground on a taut rope to a point. `strangers` are entities that the app has before Rapier's context.
fn on_a_rope(strangers: usize) -> Film {
    let mut lab = Lab::without_plugin(Engine::default());
    for _ in 0..strangers {
        lab.spawn(());
    }
    lab.app.add_plugins(CoiloverPlugin::default());
    lab.prime();
    let mut film = Film {
        lab,
        cast: Vec::new(),
        tick: 0,
        deed: |_| {},
    };
    film.ground();
    let load = film.solid(Vec3::Y * 0.1, Collider::cuboid(0.1, 0.1, 0.1), 2.0);
    let hook = film.point(Vec3::Y);
    let rope = coil(hook, load, 10.0, 1.0).with_rest_length(0.5);
    film.spawn((rope, SpringAction::Pull));
    film.run(30);
    film
}

fn context(film: &mut Film) -> Entity {
    let world = film.lab.app.world_mut();
    let mut contexts = world.query_filtered::<Entity, With<RapierContextSimulation>>();
    contexts.single(world).expect("one context")
}

#[test]
fn sweeps_count_too_where_the_context_is_another_entity() {
    let (mut film, mut other) = (on_a_rope(0), on_a_rope(5));
    let here = context(&mut other);
    assert_ne!(context(&mut film), here);
    let mut then = CoiloverSnapshot::take(film.lab.app.world());
    let pairs = film.cast.iter().copied().zip(other.cast.iter().copied());
    let mut names: EntityHashMap<Entity> = pairs.collect();
    then.map_entities(&mut names);
    let order = |film: &mut Film, sweeps: usize| {
        let mut engine = film.lab.get_mut::<RapierContextSimulation>(here);
        let number = &mut engine.integration_parameters.num_internal_pgs_iterations;
        std::mem::replace(number, sweeps)
    };
    let ours = order(&mut other, 3);
    assert!(ours > 3, "a rope takes more than {ours}");
    assert_eq!(springs(&mut other, &then), Err(SnapshotError::OtherEngine));
    order(&mut other, ours);
    assert_eq!(springs(&mut other, &then), Ok(()));
}

#[test]
fn what_is_not_put_back_makes_another_future() {
    // Otherwise no comparison of these tests would depend on the state that springs keep.
    for name in [
        "torsion, plain",
        "feet, plain",
        "lattice, tolerance",
        "rods, plain",
    ] {
        let mut film = after(name, 200);
        let then = Both::take(&film);
        let first = film.watch(100);
        engine(&mut film, &then.engine).expect("Rapier's side fits");
        let second = film.watch(100);
        assert!(first != second, "{name}");
    }
}
