//! Tests with files whose colliders ask for more geometry than there is memory, or for more visits of nodes than there is
//! time.

use super::carry::{LoadedCollider, Mesh, Shape};
use super::geometry::MOST;
use super::handler::Handler;
use super::json::Told;
use bevy::platform::collections::HashMap;
use bevy::prelude::{Entity, Vec3, World};
use serde_json::{Value, json};
use std::sync::Arc;

/// Returns a node with a collider that consists of a node.
fn with_collider(mut node: Value, of: usize) -> Value {
    let collider = json!({ "collider": { "geometry": { "node": of } } });
    node["extensions"] = json!({ "KHR_physics_rigid_bodies": collider });
    node
}

/// Returns the position attribute of a primitive that has `count` points, all at the origin.
fn points(count: usize) -> Value {
    let origin = [0.0; 3];
    json!({
        "bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3", "min": origin, "max": origin,
    })
}

/// Loads nodes and the mesh 0, whose primitives all have the same positions. Returns the geometry of each node that
/// got a collider, and what was reported.
fn load(
    nodes: &[Value],
    positions: &Value,
    primitives: usize,
) -> (Vec<(usize, Arc<Mesh>)>, Vec<String>) {
    let length = 12 * positions["count"].as_u64().map_or(0, |n| n.min(100_000));
    let primitive = json!({ "attributes": { "POSITION": 0 } });
    let file = json!({
        "asset": { "version": "2.0" },
        "nodes": nodes,
        "meshes": [{ "primitives": vec![primitive; primitives] }],
        "accessors": [positions],
        "bufferViews": [{ "buffer": 0, "byteLength": length }],
        "buffers": [{ "byteLength": length }],
    });
    let gltf = gltf::Gltf::from_slice(file.to_string().as_bytes()).expect("it is glTF");
    let buffers = [vec![0_u8; length as usize]];
    let mut handler =
        Handler::of(&gltf.document, "test".into()).with_meshes(&gltf.document, &buffers);
    let mut world = World::new();
    let mut entities = HashMap::<usize, Entity>::default();
    for node in gltf.document.nodes() {
        entities.insert(node.index(), world.spawn_empty().id());
    }
    let told = Told::default();
    handler.fill(&entities, &mut world, &told);
    let shape = |index: usize| {
        let loaded = world.get::<LoadedCollider>(entities[&index])?;
        match &loaded.shape {
            Shape::Mesh { mesh, .. } => Some((index, mesh.clone())),
            Shape::Implicit(_) => None,
        }
    };
    ((0..nodes.len()).filter_map(shape).collect(), told.lines())
}

#[test]
fn a_collider_has_the_triangles_of_the_nodes_below_in_its_own_space() {
    let nodes = [
        with_collider(json!({ "children": [1], "translation": [9, 9, 9] }), 0),
        json!({ "children": [2], "mesh": 0, "translation": [1, 0, 0] }),
        json!({ "mesh": 0, "translation": [0, 2, 0] }),
    ];
    let (made, told) = load(&nodes, &points(3), 1);
    assert_eq!(told, Vec::<String>::new());
    let [(0, mesh)] = &made[..] else {
        panic!("{made:?}");
    };
    let wanted = [[Vec3::new(1.0, 0.0, 0.0); 3], [Vec3::new(1.0, 2.0, 0.0); 3]];
    assert_eq!(mesh.vertices, wanted.concat());
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
}

#[test]
fn a_collider_that_does_not_fit_is_left_out_before_it_is_copied() {
    const COUNT: usize = 20_000;
    let child = json!({ "mesh": 0 });
    let mut nodes = vec![child.clone(); COUNT + 1];
    let children: Vec<usize> = (1..=COUNT).collect();
    nodes[0] = with_collider(json!({ "name": "Hill", "children": children }), 0);
    nodes[7] = with_collider(child, 7);
    let (made, told) = load(&nodes, &points(COUNT), 1);
    // What fits is made, though a collider before it does not.
    let made: Vec<usize> = made.iter().map(|(node, _)| *node).collect();
    assert_eq!(made, [7]);
    let [line] = &told[..] else {
        panic!("{told:?}");
    };
    assert!(
        line.starts_with("node 0 'Hill': geometry: node 0 exceeds"),
        "{line}"
    );
    assert!(
        line.contains(&MOST.to_string()) && line.ends_with("no collider"),
        "{line}"
    );
}

#[test]
fn colliders_that_consist_of_the_same_node_share_the_limit() {
    const POINTS: usize = 30_000;
    // Each point is a vertex and a corner. The first collider counts its node too.
    let fit = (MOST - 1) / (2 * POINTS);
    let nodes = vec![with_collider(json!({ "mesh": 0 }), 0); fit + 5];
    let (made, told) = load(&nodes, &points(POINTS), 1);
    assert_eq!((made.len(), told.len()), (fit, 5), "{told:?}");
    assert!(made.iter().all(|(_, mesh)| Arc::ptr_eq(mesh, &made[0].1)));
}

#[test]
fn ten_thousand_colliders_that_consist_of_one_node_load() {
    const COUNT: usize = 10_000;
    let mut nodes = vec![with_collider(json!({}), 0); COUNT];
    let children: Vec<usize> = (1..COUNT).collect();
    nodes[0]["children"] = json!(children);
    nodes[COUNT - 1]["mesh"] = json!(0);
    let (made, told) = load(&nodes, &points(3), 1);
    assert_eq!((made.len(), told), (COUNT, Vec::new()));
}

#[test]
fn colliders_in_a_chain_share_the_limit_by_the_nodes_that_are_visited() {
    const LINKS: usize = 400;
    const LEAVES: usize = 30_000;
    // Every link has all leaves below itself: 12 million visits for 400 colliders of one triangle.
    let link = |index: usize| with_collider(json!({ "children": [index + 1] }), index);
    let mut nodes: Vec<Value> = (0..LINKS).map(link).collect();
    let leaves: Vec<usize> = (LINKS..LINKS + LEAVES).collect();
    nodes[LINKS - 1]["children"] = json!(leaves);
    nodes.resize(LINKS + LEAVES, json!({}));
    nodes[LINKS]["mesh"] = json!(0);
    let (made, told) = load(&nodes, &points(3), 1);
    assert!(
        made.len() > LINKS / 2 && made.len() < LINKS,
        "{}",
        made.len()
    );
    assert!(told.iter().all(|line| line.contains("exceeds")), "{told:?}");
}

#[test]
fn meshes_that_do_not_fit_are_not_read() {
    let nodes = [with_collider(json!({ "mesh": 0 }), 0)];
    // Primitives that share their vertices, and a list of zeros that is nowhere in the file.
    let mut zeros = points(1_000_000_000_000);
    zeros["sparse"] = json!({
        "count": 1, "indices": { "bufferView": 0, "componentType": 5125 }, "values": { "bufferView": 0 },
    });
    if let Some(zeros) = zeros.as_object_mut() {
        zeros.remove("bufferView");
    }
    for (positions, primitives) in [(points(100_000), 60), (zeros, 1)] {
        let (made, told) = load(&nodes, &positions, primitives);
        assert_eq!(made.len(), 0);
        assert!(told.len() == 1 && told[0].contains("exceeds"), "{told:?}");
    }
}

#[test]
fn positions_that_are_no_vectors_of_floats_are_left_out() {
    let nodes = [with_collider(json!({ "mesh": 0 }), 0)];
    for (key, value) in [("type", json!("VEC2")), ("componentType", json!(5121))] {
        let mut positions = points(3);
        positions[key] = value;
        let (made, told) = load(&nodes, &positions, 1);
        assert_eq!(made.len(), 0);
        assert!(
            told.len() == 1 && told[0].contains("no triangles"),
            "{told:?}"
        );
    }
}
