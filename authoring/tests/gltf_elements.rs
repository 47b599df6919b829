//! Tests that springs from glTF files keep every number, and that docs/gltf.md and its schema agree with the loader.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use serde_json::{Value, json};

const SCHEMA: &str = include_str!("../../docs/gltf.schema.json");
const PAGE: &str = include_str!("../../docs/gltf.md");

pub fn schema() -> jsonschema::Validator {
    let schema = serde_json::from_str(SCHEMA).expect("JSON");
    jsonschema::validator_for(&schema).expect("a schema")
}

pub fn hook() -> Value {
    json!({ "name": "Hook", "translation": [0, 2, 0] })
}

pub fn weight() -> Value {
    json!({ "name": "Weight", "extensions": { "KHR_physics_rigid_bodies": { "motion": {
        "mass": 2, "inertiaDiagonal": [0.1, 0.1, 0.1] } } } })
}

pub fn element(extension: Value) -> Value {
    json!({ "name": "Element", "extensions": { "BEVY_coilover": extension } })
}

/// A glTF file with a hook, a weight of 2 kg two metres below it, and an element.
pub fn rig(extension: &Value) -> String {
    gltf(
        json!([hook(), weight(), element(extension.clone())]),
        json!({}),
    )
}

#[test]
fn every_element_arrives_with_its_numbers() {
    let folder = Folder::new("kinds");
    let kinds = [
        (
            "spring",
            json!({ "a": 0, "b": 1, "stiffness": 12.5, "restLength": 0.5 }),
        ),
        ("damper", json!({ "a": 0, "b": 1, "damping": 0.25 })),
        (
            "springDamper",
            json!({ "a": 0, "b": 1, "stiffness": 12.5, "damping": 0.25, "restLength": 0.5 }),
        ),
        (
            "torsionSpring",
            json!({ "a": 0, "b": 1, "axis": [0, 0, 2], "stiffness": 12.5, "restAngle": 7 }),
        ),
        (
            "torsionDamper",
            json!({ "a": 0, "b": 1, "axis": [0, 0, 2], "damping": 0.25 }),
        ),
        (
            "torsionSpringDamper",
            json!({ "a": 0, "b": 1, "axis": [0, 0, 2], "stiffness": 12.5, "damping": 0.25, "restAngle": 7 }),
        ),
    ];
    let mut stage = Stage::new(&folder.0);
    for (kind, fields) in kinds {
        let extension = json!({ kind: fields });
        assert!(schema().is_valid(&extension), "{extension}");
        folder.write(&format!("{kind}.gltf"), rig(&extension));
        let root = stage.load(&format!("{kind}.gltf"));
        let [a, b, e] = ["Hook", "Weight", "Element"].map(|name| stage.node(root, name));
        let (k, c, length) = (12.5, 0.25, 0.5);
        let axis = Vec3::Z * 2.0;
        let entity = stage.app.world().entity(e);
        let right = match kind {
            "spring" => {
                entity.get() == Some(&Spring::new(a, b).with_stiffness(k).with_rest_length(length))
            }
            "damper" => entity.get() == Some(&Damper::new(a, b).with_damping(c)),
            "springDamper" => {
                entity.get()
                    == Some(
                        &SpringDamper::new(a, b)
                            .with_stiffness(k)
                            .with_damping(c)
                            .with_rest_length(length),
                    )
            }
            "torsionSpring" => {
                entity.get()
                    == Some(
                        &TorsionSpring::new(a, b, axis)
                            .with_stiffness(k)
                            .with_rest_angle(7.0),
                    )
            }
            "torsionDamper" => {
                entity.get() == Some(&TorsionDamper::new(a, b, axis).with_damping(c))
            }
            _ => {
                entity.get()
                    == Some(
                        &TorsionSpringDamper::new(a, b, axis)
                            .with_stiffness(k)
                            .with_damping(c)
                            .with_rest_angle(7.0),
                    )
            }
        };
        assert!(right, "{kind}");
    }
}

#[test]
fn what_is_worked_out_once_is_worked_out() {
    let folder = Folder::new("tuned");
    folder.write(
        "a.gltf",
        rig(&json!({
            "springDamper": { "a": 0, "b": 1 },
            "springTuning": { "Frequency": { "frequency": 2, "dampingRatio": 0.25 } },
            "holdPose": { "load": "B" },
        })),
    );
    let mut stage = Stage::new(&folder.0);
    let root = stage.load("a.gltf");
    let element = stage.node(root, "Element");
    run(&mut stage.app, 1.0);
    let pair = *stage.get::<SpringDamper>(element);
    let wanted = SpringTuning::frequency(2.0, 0.25).coefficients(2.0, 9.81);
    assert!((pair.stiffness / wanted.0 - 1.0).abs() < 1e-3, "{pair:?}");
    assert!((pair.damping / wanted.1 - 1.0).abs() < 1e-3, "{pair:?}");
    let weight = stage.node(root, "Weight");
    assert!(
        stage.place(weight).translation.y.abs() < 1e-3,
        "it rests where it was"
    );
}

#[test]
fn the_page_and_the_schema_agree_and_the_example_swings() {
    let text = PAGE
        .split("```json")
        .nth(1)
        .and_then(|rest| rest.split("```").next());
    let file: Value = serde_json::from_str(text.expect("an example")).expect("JSON");
    let extension = &file["nodes"][2]["extensions"]["BEVY_coilover"];
    let wrong: Vec<_> = schema()
        .iter_errors(extension)
        .map(|e| e.to_string())
        .collect();
    assert!(wrong.is_empty(), "{wrong:?}");
    let folder = Folder::new("page");
    folder.write("page.gltf", file.to_string());
    let mut stage = Stage::new(&folder.0);
    let root = stage.load("page.gltf");
    run(&mut stage.app, 5.0);
    assert!(stage.faults().is_empty(), "{:?}", stage.faults());
    // Hook at 2 m with its anchor 0.1 m above it; 1200 N/m, rest length 0.5 m, preload 10 N, 2 kg.
    let sag = (2.0 * 9.81 - 10.0) / 1200.0;
    let lamp = stage.node(root, "Lamp");
    let y = stage.place(lamp).translation.y;
    assert!((y - (2.1 - 0.5 - sag)).abs() < 1e-3, "{y}");
}

#[test]
fn the_schema_refuses_what_makes_no_sense() {
    let schema = schema();
    for wrong in [
        json!({}),
        json!({ "spring": { "a": 0 } }),
        json!({ "spring": { "a": 0, "b": 1 }, "damper": { "a": 0, "b": 1 } }),
        json!({ "spring": { "a": 0, "b": 1, "stiffness": -1 } }),
        json!({ "spring": { "a": 0, "b": 1, "damping": 1 } }),
        json!({ "spring": { "a": 0, "b": 1 }, "preloads": 3 }),
        json!({ "spring": { "a": 0, "b": 1 }, "springAction": "Sometimes" }),
        json!({ "spring": { "a": 0, "b": 1 }, "springTuning": { "Frequency": { "frequency": 0 } } }),
        json!({ "torsionSpring": { "a": 0, "b": 1 } }),
        json!({ "torsionSpring": { "a": 0, "b": 1, "axis": [0, 0, 0] } }),
        json!({ "spring": { "a": 0, "b": 1 }, "springAxis": { "World": [0, 1, 0], "BodyA": [0, 1, 0] } }),
    ] {
        assert!(!schema.is_valid(&wrong), "{wrong}");
    }
}
