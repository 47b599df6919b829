//! Springs of a server arrive at clients, which draw them between their bodies.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use netcode::server::{Client, Hosted, hang};

const ANCHORS: Anchors = Anchors {
    a: Vec3::new(0.1, 0.0, 0.0),
    b: Vec3::new(0.0, 0.1, 0.0),
};

/// A server and two clients, the second of which loses a twentieth of all datagrams.
fn hosted() -> Hosted {
    let mut hosted = Hosted::new().expect("a server");
    hosted.join(0.0).expect("the first client");
    hosted.join(0.05).expect("the second client");
    hosted
}

/// Three weights on drawn springs.
fn scene(hosted: &mut Hosted) -> Vec<[Entity; 3]> {
    let spawn = |i: i32| {
        let world = hosted.server.world_mut();
        let all = hang(world, Vec3::new(2.0 * i as f32, 3.0, 0.0));
        world.entity_mut(all[2]).insert((ANCHORS, Coil::default()));
        all
    };
    (0..3).map(spawn).collect()
}

fn on_server<C: Component + Clone>(hosted: &Hosted, entity: Entity) -> C {
    let found = hosted.server.world().get::<C>(entity);
    found.expect("it is on the server").clone()
}

/// Asserts that a client has an element with the values of the server, and with its ends mapped.
fn arrived(hosted: &Hosted, client: &Client, all: [Entity; 3]) {
    let [hook, weight, element] = all;
    let mut expected: SpringDamper = on_server(hosted, element);
    expected.body_a = client.here(hook).expect("the hook is known");
    expected.body_b = client.here(weight).expect("the weight is known");
    assert_ne!(expected.body_a, hook, "ids that are the same show nothing");
    assert_eq!(client.get::<SpringDamper>(element), Some(&expected));
    assert_eq!(client.get::<Anchors>(element), Some(&ANCHORS));
    assert_eq!(
        client.get::<Coil>(element),
        Some(&on_server::<Coil>(hosted, element))
    );
}

/// Asserts that a client draws the coil from anchor to anchor of its own bodies.
fn drawn_between(client: &Client, [hook, weight, element]: [Entity; 3]) {
    let end = |entity, anchor| {
        let place: &GlobalTransform = client.get(entity).expect("it has a place");
        place.transform_point(anchor)
    };
    let (a, b) = (end(hook, ANCHORS.a), end(weight, ANCHORS.b));
    let (foot, top) = client.coil(element).expect("a coil is drawn");
    assert!(foot.distance(a) < 1e-4, "{foot} against {a}");
    assert!(top.distance(b) < 1e-4, "{top} against {b}");
}

#[test]
fn elements_arrive_with_their_ends_and_are_drawn_without_physics() {
    let mut hosted = hosted();
    let scene = scene(&mut hosted);
    hosted.run(60);
    let mut lengths = Vec::new();
    for _ in 0..120 {
        hosted.tick();
        for client in &hosted.clients {
            for all in &scene {
                arrived(&hosted, client, *all);
                drawn_between(client, *all);
            }
        }
        // Over a connection without loss, the client has the pose of the server.
        let [_, weight, element] = scene[0];
        let there: Transform = on_server(&hosted, weight);
        let here = hosted.clients[0].get::<Transform>(weight);
        let here = here.expect("the weight is known");
        assert_eq!(here.translation, there.translation);
        let (foot, top) = hosted.clients[0].coil(element).expect("a coil is drawn");
        lengths.push(foot.distance(top));
    }
    let longest = lengths.iter().copied().fold(0.0, f32::max);
    let shortest = lengths.iter().copied().fold(f32::MAX, f32::min);
    assert!(longest - shortest > 0.05, "it swings: {shortest} {longest}");
    for client in &mut hosted.clients {
        assert_eq!(client.drawn(), 3);
        let world = client.app.world_mut();
        assert!(!world.contains_resource::<TimestepMode>());
        // Each element has a readout, which nothing writes at a client.
        let mut readouts = world.query::<&SpringReadout>();
        assert_eq!(readouts.iter(world).count(), 3);
        let unwritten = SpringReadout::default();
        assert!(readouts.iter(world).all(|seen| *seen == unwritten));
    }
    let seen: SpringReadout = on_server(&hosted, scene[0][2]);
    assert_ne!(seen, SpringReadout::default());
    let lost = hosted.clients[1].relay.down;
    assert!(lost.lost > 0, "{lost:?}");
}

#[test]
fn who_joins_late_sees_all() {
    let mut hosted = hosted();
    let scene = scene(&mut hosted);
    hosted.run(120);
    hosted.join(0.05).expect("a third client");
    hosted.run(60);
    for all in &scene {
        arrived(&hosted, &hosted.clients[2], *all);
        drawn_between(&hosted.clients[2], *all);
    }
}

#[test]
fn what_changes_on_the_server_arrives() {
    let mut hosted = hosted();
    let scene = scene(&mut hosted);
    hosted.run(60);
    let [_, _, element] = scene[1];
    let mut changed = hosted.server.world_mut().entity_mut(element);
    let mut spring = changed.get_mut::<SpringDamper>().expect("an element");
    (spring.stiffness, spring.rest_length) = (333.0, Some(0.7));
    changed.get_mut::<Coil>().expect("a coil").turns = 11.0;
    // Renet sends lost messages again after 0.3 s.
    hosted.run(120);
    for client in &hosted.clients {
        arrived(&hosted, client, scene[1]);
        let seen = client.get::<SpringDamper>(element).expect("an element");
        assert_eq!((seen.stiffness, seen.rest_length), (333.0, Some(0.7)));
        assert_eq!(client.get::<Coil>(element).expect("a coil").turns, 11.0);
    }
    hosted
        .server
        .world_mut()
        .entity_mut(element)
        .remove::<Coil>();
    hosted.run(120);
    for client in &mut hosted.clients {
        assert_eq!(client.drawn(), 2);
        assert!(client.get::<SpringDamper>(element).is_some());
    }
}

#[test]
fn a_despawned_end_and_a_despawned_element_leave_nothing() {
    let mut hosted = hosted();
    // Meshes that were drawn once are kept for the next coil, so a first scene makes them.
    let before = scene(&mut hosted);
    hosted.run(60);
    clear(&mut hosted, before);
    let before: Vec<_> = hosted.clients.iter().map(all_of).collect();
    let scene = scene(&mut hosted);
    hosted.run(120);
    // The end is despawned first. The element has a fault until the game despawns it.
    let [_, weight, element] = scene[0];
    hosted.server.world_mut().despawn(weight);
    hosted.run(120);
    assert!(hosted.server.world().get::<SpringFault>(element).is_some());
    for client in &hosted.clients {
        assert!(client.here(weight).is_none());
        assert!(client.get::<SpringDamper>(element).is_some());
        assert!(client.coil(element).is_some());
        drawn_between(client, scene[1]);
    }
    clear(&mut hosted, scene);
    for (client, before) in hosted.clients.iter().zip(before) {
        assert_eq!(all_of(client), before);
    }
}

#[test]
fn who_joins_when_an_end_is_gone_sees_the_others() {
    let mut hosted = hosted();
    let scene = scene(&mut hosted);
    hosted.run(60);
    let [_, weight, element] = scene[0];
    hosted.server.world_mut().despawn(weight);
    hosted.run(60);
    hosted.join(0.0).expect("a third client");
    hosted.run(60);
    let late = &hosted.clients[2];
    drawn_between(late, scene[1]);
    assert!(late.get::<SpringDamper>(element).is_some());
    assert_eq!(late.coil(element), None);
    // Replicon spawns an empty entity for an end that it knows of but never receives.
    let stand_in = late.here(weight).expect("an entity in its place");
    assert!(late.get::<Transform>(weight).is_none());
    clear(&mut hosted, scene);
    let world = hosted.clients[2].app.world_mut();
    assert_eq!(world.query::<&SpringDamper>().iter(world).count(), 0);
    // The client never learns that this entity is gone, so a game should despawn the element with its end.
    assert!(world.get_entity(stand_in).is_ok());
}

/// Despawns all entities of a scene, some of which may be gone.
fn clear(hosted: &mut Hosted, scene: Vec<[Entity; 3]>) {
    for [hook, weight, element] in scene {
        let world = hosted.server.world_mut();
        let _ = (world.despawn(element), world.despawn(hook));
        let _ = world.try_despawn(weight);
    }
    hosted.run(120);
    for client in &mut hosted.clients {
        assert_eq!(client.drawn(), 0);
    }
}

/// Number of entities and of meshes of a client.
fn all_of(client: &Client) -> (usize, usize) {
    let world = client.app.world();
    let meshes = world.resource::<Assets<Mesh>>().len();
    (world.iter_entities().count(), meshes)
}
