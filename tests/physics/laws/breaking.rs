//! Breakable springs break at their force or length, and send an event.

use crate::harness::*;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

#[derive(Resource, Default)]
struct Broken(Vec<SpringBroke>);

fn rope(limit: Breakable) -> (Lab, Entity, Entity) {
    let mut lab = Lab::new();
    lab.app
        .init_resource::<Broken>()
        .add_observer(|broke: On<SpringBroke>, mut all: ResMut<Broken>| all.0.push(*broke));
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::NEG_Y);
    let spring = Spring::new(hook, body)
        .with_stiffness(100.0)
        .with_rest_length(1.0);
    let element = lab.spawn((spring, limit));
    (lab, body, element)
}

#[test]
fn at_its_force_it_breaks_once_and_the_body_falls() {
    // Released at rest length, the body swings up to a force of 2 m g, which is 19.6 N.
    let (mut lab, body, element) = rope(Breakable::at_force(15.0));
    lab.run(2.0);
    let broken = &lab.app.world().resource::<Broken>().0;
    assert_eq!(broken.len(), 1, "{broken:?}");
    assert_eq!(broken[0].entity, element);
    assert!(
        broken[0].force > 15.0 && broken[0].force < 17.0,
        "{broken:?}"
    );
    assert!((broken[0].length - 1.0 - broken[0].force / 100.0).abs() < 1e-5);
    assert!(lab.app.world().get_entity(element).is_err());
    assert!(lab.position(body).y < -5.0);
}

#[test]
fn at_its_length_it_is_disabled_and_can_be_mended() {
    let (mut lab, body, element) = rope(Breakable::at_length(1.15).disabling());
    lab.run(0.5);
    assert_eq!(lab.app.world().resource::<Broken>().0.len(), 1);
    assert!(lab.app.world().get::<Disabled>(element).is_some());
    let speed = lab.velocity(body).y;
    lab.run(0.1);
    assert!((lab.velocity(body).y - speed + 0.1 * GRAVITY as f32).abs() < 1e-3);
    lab.app
        .world_mut()
        .entity_mut(element)
        .remove::<(Disabled, Breakable)>();
    let before = lab.velocity(body).y;
    lab.run(0.1);
    assert!(lab.velocity(body).y > before, "it pulls again");
}

#[test]
fn of_a_limit_on_both_the_one_that_is_reached_counts() {
    let reached = [
        Breakable::at_force(1e6).with_length(1.15),
        Breakable::at_length(9.0).with_force(15.0),
    ];
    for breakable in reached {
        let (mut lab, _, element) = rope(breakable);
        lab.run(2.0);
        assert!(lab.app.world().get_entity(element).is_err());
    }
    let (mut lab, _, element) = rope(Breakable::at_force(1e6).with_length(9.0));
    lab.run(2.0);
    assert!(lab.app.world().get_entity(element).is_ok());
}

#[test]
fn a_stronger_one_holds() {
    let (mut lab, _, element) = rope(Breakable::at_force(21.0));
    lab.run(5.0);
    assert!(lab.app.world().resource::<Broken>().0.is_empty());
    assert!(lab.app.world().get::<Breakable>(element).is_some());
}

#[test]
fn mended_while_the_engine_rests_it_does_not_break_by_what_it_showed_before() {
    let (mut lab, _, element) = rope(Breakable::at_length(1.15).disabling());
    lab.run(0.5);
    assert_eq!(lab.app.world().resource::<Broken>().0.len(), 1);
    lab.set_stepping(false);
    lab.app.world_mut().entity_mut(element).remove::<Disabled>();
    lab.run(0.1);
    assert_eq!(lab.app.world().resource::<Broken>().0.len(), 1);
    assert!(lab.app.world().get::<Disabled>(element).is_none());
}

#[test]
fn twisted_too_far_either_way_a_torsion_spring_breaks() {
    for turn in [1.5_f32, -1.5] {
        let mut lab = Lab::weightless();
        let post = lab.spawn((RigidBody::Fixed, Transform::default()));
        let arm = lab.spawn(brick(1.0, Vec3::ONE, Vec3::ZERO));
        lab.get_mut::<Velocity>(arm).angular = Vec3::Z * turn;
        let spring = TorsionSpring::new(post, arm, Vec3::Z).with_stiffness(0.1);
        let element = lab.spawn((spring, Breakable::at_length(1.0)));
        lab.run(0.5);
        let world = lab.app.world();
        assert!(world.get_entity(element).is_ok(), "{turn}: it holds");
        lab.run(0.5);
        let world = lab.app.world();
        assert!(world.get_entity(element).is_err(), "{turn}: it breaks");
    }
}

#[test]
fn with_a_negative_limit_it_is_inert_and_does_not_break() {
    let (mut lab, body, element) = rope(Breakable::at_force(15.0));
    lab.run(0.1);
    lab.get_mut::<Breakable>(element).force = -15.0;
    let speed = lab.velocity(body).y;
    lab.run(0.1);
    assert!(lab.app.world().resource::<Broken>().0.is_empty());
    assert_eq!(lab.get::<SpringFault>(element).field, "Breakable::force");
    let fallen = lab.velocity(body).y - speed + 0.1 * GRAVITY as f32;
    assert!(fallen.abs() < 1e-3, "it falls freely");
    // Mended, it acts again.
    lab.get_mut::<Breakable>(element).force = 1e3;
    lab.run(0.5);
    assert!(lab.app.world().get::<SpringFault>(element).is_none());
    assert!(lab.readout(element).force() != 0.0);
}
