//! Tests springs from Skein, which puts components on Blender's objects. The test reads Skein's JSON format as Skein 0.6
//! does: it reads each component by reflection from the extras of a node.

use crate::harness::*;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectCommandExt};
use bevy::gltf::GltfExtras;
use bevy::prelude::*;
use bevy::reflect::serde::ReflectDeserializer;
use bevy_coilover::prelude::*;
use serde::de::DeserializeSeed;
use serde_json::{Value, json};

/// A file as Skein exports it. `on_node` makes the node that holds some components.
fn scene(on_node: impl Fn(Value) -> Value) -> Value {
    let with = |name: &str, at: [f32; 3], components: Value| {
        let mut node = on_node(components);
        node["name"] = json!(name);
        node["translation"] = json!(at);
        node
    };
    let body = json!([
        { "bevy_rapier3d::dynamics::rigid_body::RigidBody": "Dynamic" },
        { "bevy_rapier3d::dynamics::rigid_body::AdditionalMassProperties": { "Mass": 1.0 } },
    ]);
    // The ends of a default element.
    let nobody = Entity::PLACEHOLDER.to_bits();
    let spring = json!([
        { "bevy_coilover::SpringDamper": {
            "body_a": nobody, "body_b": nobody, "stiffness": 100.0, "damping": 2.0, "rest_length": 1.5,
        } },
        { "bevy_coilover::EndNames": { "a": "Hook", "b": "Weight" } },
        { "bevy_coilover::MaxForce": 500.0 },
        { "bevy_coilover::SpringAction": "Pull" },
    ]);
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "name": "Scene", "nodes": [0, 1, 2] }],
        "nodes": [
            with("Hook", [0.0, 2.0, 0.0], json!([])),
            with("Weight", [0.0, 0.0, 0.0], body),
            with("Spring", [0.0, 0.0, 0.0], spring),
        ],
    })
}

/// Inserts the components from a node's extras, as Skein's plugin does.
fn read_extras(
    added: On<Add, GltfExtras>,
    extras: Query<&GltfExtras>,
    registry: Res<AppTypeRegistry>,
    mut commands: Commands,
) {
    let value = &extras.get(added.entity).expect("just added").value;
    let value: Value = serde_json::from_str(value).expect("JSON");
    for component in value["skein"].as_array().into_iter().flatten() {
        let registry = registry.read();
        let read = ReflectDeserializer::new(&registry).deserialize(component);
        let read = read.unwrap_or_else(|error| panic!("{component}: {error}"));
        commands.entity(added.entity).insert_reflect(read);
    }
}

#[test]
fn springs_in_extras() {
    let folder = Folder::new("skein");
    let scene = scene(|components| json!({ "extras": { "skein": components } }));
    folder.write("a.gltf", scene.to_string());
    let mut stage = Stage::new(&folder.0);
    stage.app.add_observer(read_extras);
    let root = stage.load("a.gltf");
    run(&mut stage.app, 3.0 * DT);
    let [a, b, element] = ["Hook", "Weight", "Spring"].map(|name| stage.node(root, name));
    let pair = *stage.get::<SpringDamper>(element);
    assert_eq!([pair.body_a, pair.body_b], [a, b]);
    assert_eq!(
        (pair.stiffness, pair.damping, pair.rest_length),
        (100.0, 2.0, Some(1.5))
    );
    assert_eq!(*stage.get::<MaxForce>(element), MaxForce(500.0));
    assert_eq!(*stage.get::<SpringAction>(element), SpringAction::Pull);
    assert!(stage.faults().is_empty(), "{:?}", stage.faults());
    assert!(stage.get::<SpringReadout>(element).force() > 1.0);
}
