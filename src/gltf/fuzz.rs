//! Tests with files that are wrong in random ways: nothing panics or hangs, and no NaN reaches the engine.
//!
//! `COILOVER_FUZZ_SECONDS=60 cargo test --workspace --lib fuzz` runs for a minute; without the variable it takes a
//! few seconds. `COILOVER_FUZZ_SEED` sets another seed.

use super::handler::Handler;
use super::json::Told;
use crate::CoiloverPlugin;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_rapier3d::prelude::*;
use serde_json::{Map, Value, json};
use std::time::{Duration, Instant};

/// Random numbers from a seed, equal on all systems (Marsaglia's xorshift).
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % sides.max(1)
    }

    fn pick<T: Clone>(&mut self, of: &[T]) -> T {
        of[self.roll(of.len())].clone()
    }

    /// Returns a random JSON value.
    fn anything(&mut self, depth: usize) -> Value {
        match self.roll(if depth > 3 { 8 } else { 10 }) {
            0 => Value::Null,
            1 => json!(self.roll(2) == 0),
            2 => json!(self.pick(&[0.0, -0.0, 1.0, -1.0, 0.5, 3.0])),
            3 => json!(self.pick(&[1e-45, 1e-30, -1e30, 3.4e38, 1e39, -1e300, 1e308])),
            4 => json!(self.pick(&[-1, 0, 1, 2, 3, 7, i64::MAX, i64::MIN])),
            5 => json!(u64::MAX),
            6 => json!(self.pick(&["", "Pull", "pull", "BodyA", "é", "box", "linear", "\u{0}"])),
            7 => json!([
                self.roll(3),
                self.pick(&[0.0, 1.0, -2.0]),
                self.pick(&[0.0, 1.0, 1e38])
            ]),
            8 => {
                let length = self.roll(5);
                (0..length).map(|_| self.anything(depth + 1)).collect()
            }
            _ => {
                let mut map = Map::new();
                for _ in 0..self.roll(3) {
                    let key = self.pick(&["a", "b", "shape", "node", "min", "Table", "x"]);
                    map.insert(key.into(), self.anything(depth + 1));
                }
                Value::Object(map)
            }
        }
    }

    /// Changes the content of one extension at random. The extension's own key stays.
    fn spoil_one(&mut self, extensions: &mut Value) {
        if let Some(map) = extensions.as_object_mut() {
            let which = self.roll(map.len());
            if let Some(inner) = map.values_mut().nth(which) {
                self.spoil(inner);
            }
        }
    }

    /// Changes a random value inside a JSON value.
    fn spoil(&mut self, value: &mut Value) {
        let stop = self.roll(4) == 0;
        match value {
            Value::Object(map) if !map.is_empty() && !stop => {
                let key = self.roll(map.len());
                let key = map.keys().nth(key).cloned().unwrap_or_default();
                if self.roll(12) == 0 {
                    map.remove(&key);
                } else if let Some(inner) = map.get_mut(&key) {
                    self.spoil(inner);
                }
            }
            Value::Array(list) if !list.is_empty() && !stop => {
                let at = self.roll(list.len());
                if self.roll(12) == 0 {
                    list.remove(at);
                } else {
                    self.spoil(&mut list[at]);
                }
            }
            leaf => *leaf = self.anything(0),
        }
    }
}

/// Returns a valid file that uses most of what the extensions offer.
fn scene() -> Value {
    let element = |kind: &str, more: Value| {
        let mut extension = json!({
            "anchors": { "a": [0.1, 0, 0], "b": [0, 0.2, 0] },
            "preload": 2, "maxForce": 900,
            "breakable": { "force": 1e6, "then": "Disable" },
            "springTravel": { "minLength": 0.1, "maxLength": 3, "stopStiffness": 500, "stopDamping": 3 },
            "springAction": "Pull",
        });
        extension[kind] = more;
        extension
    };
    let ends = |more: Value| {
        let mut all = json!({ "a": 0, "b": 1, "stiffness": 120, "damping": 4 });
        if let (Some(all), Some(more)) = (all.as_object_mut(), more.as_object()) {
            all.extend(more.clone());
        }
        all
    };
    let mut law = element("springDamper", ends(json!({ "restLength": 0.5 })));
    law["springLaw"] = json!({ "Table": { "points": [[-1, -50], [0, 0], [1, 80]] } });
    law["dampingLaw"] = json!({ "BlowOff": { "damping": 5, "knee": 0.3, "beyond": 1 } });
    law["springAxis"] = json!({ "BodyA": [0, 1, 0] });
    law["coil"] = json!({ "radius": 0.1, "turns": 9, "ends": "Open", "color": [0.6, 0, 0] });
    law["telescope"] = json!({ "tubeRadius": 0.05, "stroke": 0.4 });
    let mut tuned = element("spring", json!({ "a": 0, "b": 1 }));
    tuned["springTuning"] = json!({ "Frequency": { "frequency": 2, "dampingRatio": 0.3 } });
    tuned["springLaw"] =
        json!({ "Polynomial": { "pull": { "linear": 3 }, "push": { "cubic": 2 } } });
    tuned["holdPose"] = json!({ "load": "B", "share": 0.5 });
    tuned["disabled"] = json!(false);
    let twist = element(
        "torsionSpringDamper",
        ends(json!({ "axis": [0, 1, 0], "restAngle": 0.3 })),
    );
    let physics = |value: Value| json!({ "extensions": { "KHR_physics_rigid_bodies": value } });
    let body = |shape: usize| {
        physics(json!({
            "motion": {
                "mass": 2, "inertiaDiagonal": [0.1, 0.2, 0.3], "inertiaOrientation": [0, 0, 0, 1],
                "centerOfMass": [0, 0.1, 0], "linearVelocity": [0, 1, 0], "gravityFactor": 0.5,
            },
            "collider": { "geometry": { "shape": shape }, "physicsMaterial": 0, "collisionFilter": 0 },
        }))
    };
    let mut nodes = vec![body(0), body(1)];
    nodes[1]["translation"] = json!([0.0, 1.5, 0.0]);
    nodes.push(physics(
        json!({ "joint": { "connectedNode": 1, "joint": 0 } }),
    ));
    nodes.push(physics(
        json!({ "trigger": { "geometry": { "shape": 2 } } }),
    ));
    nodes.push(physics(
        json!({ "collider": { "geometry": { "node": 0, "convexHull": true } } }),
    ));
    for extension in [law, tuned, twist] {
        nodes.push(json!({ "extensions": { "BEVY_coilover": extension } }));
    }
    nodes[0]["children"] = json!([2]);
    nodes[2]["scale"] = json!([1.0, -1.0, 2.0]);
    json!({
        "asset": { "version": "2.0" },
        "nodes": nodes,
        "extensions": {
            "KHR_implicit_shapes": { "shapes": [
                { "type": "box", "box": { "size": [1, 1, 1] } },
                { "type": "sphere", "sphere": { "radius": 0.4 } },
                { "type": "capsule", "capsule": { "height": 1, "radiusTop": 0.2, "radiusBottom": 0.3 } },
            ] },
            "KHR_physics_rigid_bodies": {
                "physicsMaterials": [{ "staticFriction": 0.4, "dynamicFriction": 0.4, "frictionCombine": "minimum" }],
                "collisionFilters": [{ "collisionSystems": ["a"], "notCollideWithSystems": ["a"] }],
                "physicsJoints": [{
                    "limits": [
                        { "linearAxes": [0, 1, 2], "min": 0, "max": 0, "stiffness": 300, "damping": 3 },
                        { "linearAxes": [0], "min": -1, "max": 1, "stiffness": 300 },
                        { "angularAxes": [1], "min": -0.5, "max": 0.5 },
                        { "angularAxes": [0, 2], "max": 0.3 },
                    ],
                    "drives": [
                        { "type": "linear", "mode": "force", "axis": 1, "stiffness": 50, "damping": 2,
                          "positionTarget": 0.3, "velocityTarget": 0.1, "maxForce": 30 },
                        { "type": "angular", "mode": "acceleration", "axis": 0, "stiffness": 20,
                          "positionTarget": 0.3 },
                    ],
                }],
            },
        },
    })
}

fn lab() -> App {
    let mut app = App::new();
    let tick = Duration::from_millis(16);
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .insert_resource(TimestepMode::Fixed {
            dt: 0.016,
            substeps: 1,
        })
        .insert_resource(Time::<Fixed>::from_duration(tick))
        .insert_resource(TimeUpdateStrategy::ManualDuration(tick))
        .add_plugins(RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule())
        .add_plugins(CoiloverPlugin::default());
    app.finish();
    app.cleanup();
    app.update();
    app
}

/// Loads the nodes of a file into the world as Bevy's loader would, and runs three frames. Returns what was reported,
/// or `None` if the file is not glTF.
fn play(app: &mut App, file: &Value) -> Option<Vec<String>> {
    let text = file.to_string();
    // A file that is not valid glTF is refused by Bevy's loader before this crate sees it.
    let gltf = gltf::Gltf::from_slice(text.as_bytes()).ok()?;
    let told = Told::default();
    let mut handler = Handler::of(&gltf.document, "fuzz".into());
    let world = app.world_mut();
    let mut entities = HashMap::default();
    let root = world.spawn(Transform::default()).id();
    for node in gltf.document.nodes() {
        let (t, r, s) = node.transform().decomposed();
        let place = Transform {
            translation: Vec3::from_array(t),
            rotation: Quat::from_array(r),
            scale: Vec3::from_array(s),
        };
        entities.insert(node.index(), world.spawn((place, ChildOf(root))).id());
    }
    for node in gltf.document.nodes() {
        for child in node.children() {
            if child.index() > node.index() {
                let pair = [entities[&child.index()], entities[&node.index()]];
                world.entity_mut(pair[0]).insert(ChildOf(pair[1]));
            }
        }
    }
    handler.fill(&entities, world, &told);
    super::expand::expand(world);
    for _ in 0..3 {
        app.update();
    }
    let world = app.world_mut();
    let mut bodies = world.query_filtered::<&Transform, With<RigidBody>>();
    for place in bodies.iter(world) {
        assert!(place.is_finite(), "{place:?} after {text}");
    }
    world.despawn(root);
    app.update();
    Some(told.lines())
}

#[test]
fn a_right_file_is_told_nothing() {
    let told = play(&mut lab(), &scene()).expect("it is glTF");
    // Node 4 refers to a mesh that this file does not have.
    let others: Vec<_> = told
        .iter()
        .filter(|line| !line.contains("no triangles"))
        .collect();
    assert!(others.is_empty(), "{others:?}");
}

#[test]
fn spoilt_files_harm_nobody() {
    let number = |name| std::env::var(name).ok()?.parse::<u64>().ok();
    let seconds = number("COILOVER_FUZZ_SECONDS").unwrap_or(4);
    let mut dice = Dice(number("COILOVER_FUZZ_SEED").unwrap_or(0x5EED).max(1));
    let mut app = lab();
    let started = Instant::now();
    let (mut played, mut refused) = (0, 0);
    while started.elapsed() < Duration::from_secs(seconds) {
        let mut file = scene();
        for _ in 0..=dice.roll(6) {
            let node = dice.roll(file["nodes"].as_array().map_or(0, Vec::len));
            dice.spoil_one(&mut file["nodes"][node]["extensions"]);
            dice.spoil_one(&mut file["extensions"]);
            let scales = [[1e30, 1.0, 1.0], [0.0, 0.0, 0.0], [-1.0, 1.0, 1e-30]];
            if dice.roll(8) == 0 {
                file["nodes"][node]["scale"] = json!(dice.pick(&scales));
            }
        }
        let now = Instant::now();
        match play(&mut app, &file) {
            Some(_) => played += 1,
            None => refused += 1,
        }
        assert!(now.elapsed() < Duration::from_secs(20), "hangs at {file}");
    }
    println!("{played} files played, {refused} are no glTF");
    assert!(played > 0);
}
