//! A client draws each kind of element as its server would, whenever it joined.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_replicon::prelude::*;
use netcode::server::{Client, Hosted};
use std::f32::consts::TAU;

/// An element of each kind, each with components that draw it.
struct Kinds {
    ends: [Entity; 2],
    spring: Entity,
    damper: Entity,
    pair: Entity,
    wheel: [Entity; 2],
    wound: [Entity; 3],
}

impl Kinds {
    fn all(&self) -> [Entity; 6] {
        let [one, two, three] = self.wound;
        [self.spring, self.damper, self.pair, one, two, three]
    }
}

/// A telescope whose lengths do not depend on the pose in which it was first drawn.
fn telescope() -> Telescope {
    Telescope {
        tube_length: Some(0.5),
        rod_length: Some(0.6),
        ..default()
    }
}

fn spawn(world: &mut World) -> Kinds {
    let hook = world.spawn((Transform::from_xyz(0.0, 3.0, 0.0), Replicated));
    let hook = hook.id();
    let weight = (
        RigidBody::Dynamic,
        AdditionalMassProperties::Mass(1.0),
        Transform::from_xyz(0.3, 2.0, 0.0),
        Replicated,
    );
    let weight = world.spawn(weight).id();
    let spring = Spring::new(hook, weight).with_stiffness(60.0);
    let spring = (spring, Coil::default(), Replicated);
    let damper = Damper::new(hook, weight).with_damping(0.2);
    let damper = (damper, telescope(), Replicated);
    let pair = SpringDamper::new(hook, weight).with_stiffness(20.0);
    let pair = (pair, Coil::default(), telescope(), Replicated);
    let frame = (RigidBody::Fixed, Transform::default(), Replicated);
    let frame = world.spawn(frame).id();
    let wheel = (
        RigidBody::Dynamic,
        Collider::ball(0.3),
        GravityScale(0.0),
        Velocity::angular(Vec3::Z * TAU),
        Transform::default(),
        Replicated,
    );
    let wheel = world.spawn(wheel).id();
    let strip = TorsionCoil {
        radius: 0.2,
        arbor_radius: 0.02,
        width: 0.05,
        thickness: 0.005,
        fitted: false,
        ..default()
    };
    let turning = TorsionSpring::new(frame, wheel, Vec3::Z).with_stiffness(1e-4);
    let damping = TorsionDamper::new(frame, wheel, Vec3::Z).with_damping(1e-5);
    let both = TorsionSpringDamper::new(frame, wheel, Vec3::Z)
        .with_stiffness(1e-4)
        .with_damping(1e-5);
    Kinds {
        ends: [hook, weight],
        spring: world.spawn(spring).id(),
        damper: world.spawn(damper).id(),
        pair: world.spawn(pair).id(),
        wheel: [frame, wheel],
        wound: [
            world.spawn((turning, strip, Replicated)).id(),
            world.spawn((damping, strip, Replicated)).id(),
            world.spawn((both, strip, Replicated)).id(),
        ],
    }
}

/// Drawn parts of an element: number of vertices and transform of each.
fn parts(world: &World, element: Entity) -> Vec<(usize, GlobalTransform)> {
    let children = world.get::<Children>(element).expect("it is drawn");
    let meshes = world.resource::<Assets<Mesh>>();
    let parts = children.iter().filter_map(|part| {
        let mesh = meshes.get(world.get::<Mesh3d>(part)?)?;
        Some((mesh.count_vertices(), *world.get(part)?))
    });
    parts.collect()
}

fn ends_are_mapped(client: &Client, kinds: &Kinds) {
    let here = |ends: [Entity; 2]| ends.map(|end| client.here(end).expect("the end is known"));
    let (line, turn) = (here(kinds.ends), here(kinds.wheel));
    let seen = client.get::<Spring>(kinds.spring).expect("a spring");
    assert_eq!([seen.body_a, seen.body_b], line);
    let seen = client.get::<Damper>(kinds.damper).expect("a damper");
    assert_eq!([seen.body_a, seen.body_b], line);
    let seen = client.get::<SpringDamper>(kinds.pair).expect("both");
    assert_eq!([seen.body_a, seen.body_b], line);
    let seen = client.get::<TorsionSpring>(kinds.wound[0]);
    let seen = seen.expect("a torsion spring");
    assert_eq!([seen.body_a, seen.body_b], turn);
    let seen = client.get::<TorsionDamper>(kinds.wound[1]);
    let seen = seen.expect("a torsion damper");
    assert_eq!([seen.body_a, seen.body_b], turn);
    let seen = client.get::<TorsionSpringDamper>(kinds.wound[2]);
    let seen = seen.expect("a torsion spring and damper");
    assert_eq!([seen.body_a, seen.body_b], turn);
}

fn drawn_alike(hosted: &Hosted, client: &Client, kinds: &Kinds) {
    for element in kinds.all() {
        let there = parts(hosted.server.world(), element);
        assert!(!there.is_empty(), "nothing of {element} is drawn");
        let called = client.here(element).expect("it is known");
        let here = parts(client.app.world(), called);
        assert_eq!(here.len(), there.len(), "{element}");
        for (i, (here, there)) in here.into_iter().zip(there).enumerate() {
            assert_eq!(here.0, there.0, "vertices of part {i} of {element}");
            let apart = here.1.to_matrix().abs_diff_eq(there.1.to_matrix(), 1e-5);
            assert!(apart, "part {i} of {element}: {:?} {:?}", here.1, there.1);
        }
    }
}

#[test]
fn clients_draw_each_kind_as_the_server_would() {
    let mut hosted = Hosted::that_draws().expect("a server");
    hosted.join(0.0).expect("a client");
    let kinds = spawn(hosted.server.world_mut());
    hosted.run(2);
    for _ in 0..100 {
        hosted.tick();
        ends_are_mapped(&hosted.clients[0], &kinds);
        drawn_alike(&hosted, &hosted.clients[0], &kinds);
    }
    // The wheel is past a full turn, which a client cannot tell from the pose when it joins.
    let world = hosted.server.world();
    let turned = world.get::<SpringReadout>(kinds.wound[2]);
    assert!(turned.expect("a torsion element").length > TAU);
    hosted.join(0.0).expect("a second client");
    hosted.run(2);
    for _ in 0..20 {
        hosted.tick();
        ends_are_mapped(&hosted.clients[1], &kinds);
        drawn_alike(&hosted, &hosted.clients[1], &kinds);
    }
}
