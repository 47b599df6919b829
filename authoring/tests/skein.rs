//! Can Skein, which puts components on Blender's objects, put a spring there? With its own plugin and its own formats.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_skein::SkeinPlugin;
use serde_json::{Value, json};

/// A file as Skein exports it: components in `extras` up to Bevy 0.18's format, in an extension since.
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
    let spring = json!([
        { "bevy_coilover::SpringDamper": {
            "body_a": 0, "body_b": 0, "stiffness": 100.0, "damping": 2.0, "rest_length": { "Some": 1.5 },
        } },
        { "bevy_coilover::EndNames": { "a": "Hook", "b": "Weight" } },
        { "bevy_coilover::MaxForce": 500.0 },
        { "bevy_coilover::SpringAction": "Pull" },
    ]);
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["BEVY_skein"],
        "scene": 0,
        "scenes": [{ "name": "Scene", "nodes": [0, 1, 2] }],
        "nodes": [
            with("Hook", [0.0, 2.0, 0.0], json!([])),
            with("Weight", [0.0, 0.0, 0.0], body),
            with("Spring", [0.0, 0.0, 0.0], spring),
        ],
    })
}

fn check(scene: Value) {
    let folder = std::env::temp_dir().join(format!("coilover_skein_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join(format!("{:?}.gltf", std::thread::current().id()));
    std::fs::write(&file, scene.to_string()).expect("writes");
    let mut app = app_with_files(&folder);
    app.add_plugins((CoiloverPlugin::default(), SkeinPlugin::default()));
    prime(&mut app);
    let server = app.world().resource::<AssetServer>().clone();
    let handle = server.load(GltfAssetLabel::Scene(0).from_asset(file.clone()));
    app.world_mut().spawn(WorldAssetRoot(handle));
    let element = until(&mut app, "the scene", |app| {
        let mut found = app.world_mut().query_filtered::<Entity, With<SpringDamper>>();
        found.single(app.world()).ok()
    });
    run(&mut app, 0.2);
    let (a, b) = (named(&mut app, "Hook"), named(&mut app, "Weight"));
    let world = app.world();
    let pair = world.get::<SpringDamper>(element).expect("a pair");
    assert_eq!([pair.body_a, pair.body_b], [a, b]);
    assert_eq!((pair.stiffness, pair.damping, pair.rest_length), (100.0, 2.0, Some(1.5)));
    assert_eq!(world.get::<MaxForce>(element), Some(&MaxForce(500.0)));
    assert_eq!(world.get::<SpringAction>(element), Some(&SpringAction::Pull));
    assert!(world.get::<SpringFault>(element).is_none());
    assert!(world.get::<SpringReadout>(element).is_some_and(|seen| seen.force() > 1.0));
    std::fs::remove_file(file).expect("ours");
}

#[test]
fn springs_in_extras() {
    check(scene(|components| json!({ "extras": { "skein": components } })));
}

#[test]
fn springs_in_skeins_extension() {
    check(scene(
        |components| json!({ "extensions": { "BEVY_skein": { "components": components } } }),
    ));
}
