//! The samples and tests of `KHR_physics_rigid_bodies`' own repository, as outside judge.
//!
//! They are not part of this repository: `COILOVER_GLTF_PHYSICS` names the folder with `samples/` and `tests/` of
//! github.com/eoineoineoin/glTF_Physics. Without it this says so and is skipped. With `-- --nocapture` it prints the
//! table of `docs/gltf.md`.

use crate::harness::*;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::Value;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// A file that plays.
struct Sample {
    stage: Stage,
    json: Value,
    /// By index of the node. Names are no help: files give one to several nodes.
    nodes: HashMap<usize, Entity>,
}

impl Sample {
    fn load(folder: &Path, file: &str) -> Self {
        let bytes = std::fs::read(folder.join(file)).expect(file);
        let text = if bytes.starts_with(b"glTF") {
            let length = u32::from_le_bytes([bytes[12], bytes[13], bytes[14], bytes[15]]) as usize;
            bytes[20..20 + length].to_vec()
        } else {
            bytes
        };
        let json = serde_json::from_slice(&text).expect(file);
        let mut stage = Stage::new(folder);
        stage.validate = false;
        let root = stage.load(file);
        let scene = stage.get::<Children>(root)[0];
        let mut sample = Self {
            stage,
            json,
            nodes: HashMap::new(),
        };
        let first = sample.json["scene"].as_u64().unwrap_or(0) as usize;
        let tops = sample.json["scenes"][first]["nodes"].clone();
        sample.find(scene, &tops);
        sample
    }

    /// Finds the entities of nodes below one, which Bevy spawns in the file's order.
    fn find(&mut self, parent: Entity, nodes: &Value) {
        let children = self.stage.app.world().get::<Children>(parent);
        let mut children: Vec<_> = children.into_iter().flatten().copied().collect();
        // What undoes a turning has no name, and a body of the file below it.
        let world = self.stage.app.world();
        let nameless = |child: &Entity| world.get::<Name>(*child).is_none();
        let deeper: Vec<_> = children
            .iter()
            .filter(|child| nameless(child))
            .filter_map(|child| world.get::<Children>(*child))
            .flatten()
            .copied()
            .collect();
        children.extend(deeper);
        for node in nodes.as_array().into_iter().flatten() {
            let node = node.as_u64().expect("an index") as usize;
            let name = self.name(node);
            let world = self.stage.app.world();
            let at = children.iter().position(|child| {
                // A mesh may have its object's name.
                world
                    .get::<Name>(*child)
                    .is_some_and(|n| n.as_str() == name)
                    && world.get::<Mesh3d>(*child).is_none()
            });
            let entity = children.remove(at.expect("a node for each"));
            self.nodes.insert(node, entity);
            let below = self.json["nodes"][node]["children"].clone();
            self.find(entity, &below);
        }
    }

    fn run(&mut self, seconds: f32) {
        run(&mut self.stage.app, seconds);
    }

    /// What the extension says of a node.
    fn physics(&self, node: usize) -> &Value {
        &self.json["nodes"][node]["extensions"]["KHR_physics_rigid_bodies"]
    }

    fn name(&self, node: usize) -> String {
        let name = self.json["nodes"][node]["name"].as_str();
        name.map_or_else(|| format!("GltfNode{node}"), ToOwned::to_owned)
    }

    fn place(&self, node: usize) -> Transform {
        self.stage.place(self.nodes[&node])
    }

    fn at(&self, node: usize) -> Vec3 {
        self.place(node).translation
    }

    /// Everything has its place, and as many bodies and joints are there as the file says.
    fn sound(&mut self) -> Result<(), String> {
        let world = self.stage.app.world_mut();
        let mut places = world.query::<&GlobalTransform>();
        if places
            .iter(world)
            .any(|place| !place.translation().is_finite())
        {
            return Err("something is nowhere".into());
        }
        let nodes = self.json["nodes"].as_array().map_or(0, Vec::len);
        let count = |key: &str| {
            (0..nodes)
                .filter(|i| self.physics(*i).get(key).is_some())
                .count()
        };
        let (motions, colliders) = (count("motion"), count("collider"));
        let mut bodies = self.stage.app.world_mut().query::<&RigidBody>();
        let moving = bodies
            .iter(self.stage.app.world())
            .filter(|body| **body != RigidBody::Fixed)
            .count();
        if moving != motions {
            return Err(format!("{moving} bodies for {motions} motions"));
        }
        let mut all = self
            .stage
            .app
            .world_mut()
            .query_filtered::<(), (With<Collider>, Without<Sensor>)>();
        let found = all.iter(self.stage.app.world()).count();
        if found != colliders {
            return Err(format!("{found} of {colliders} colliders"));
        }
        let faults = self.stage.faults();
        if !faults.is_empty() {
            return Err(faults.join("; "));
        }
        Ok(())
    }

    /// Whether rigid limits hold, by the specification's own metrics.
    fn limits_hold(&self, tolerance: f32) -> Result<(), String> {
        let nodes = self.json["nodes"].as_array().map_or(0, Vec::len);
        let kinds = &self.json["extensions"]["KHR_physics_rigid_bodies"]["physicsJoints"];
        for node in 0..nodes {
            let joint = &self.physics(node)["joint"];
            let (Some(other), Some(kind)) =
                (joint["connectedNode"].as_u64(), joint["joint"].as_u64())
            else {
                continue;
            };
            let (a, b) = (self.place(node), self.place(other as usize));
            for limit in kinds[kind as usize]["limits"]
                .as_array()
                .into_iter()
                .flatten()
            {
                if limit.get("stiffness").is_some() {
                    continue;
                }
                let x = metric(limit, &a, &b);
                let min = limit["min"].as_f64().map_or(f32::MIN, |x| x as f32);
                let max = limit["max"].as_f64().map_or(f32::MAX, |x| x as f32);
                if !(min - tolerance..=max + tolerance).contains(&x) {
                    return Err(format!(
                        "joint of node {node}: {x} is outside {min}..{max} ({limit})"
                    ));
                }
            }
        }
        Ok(())
    }
}

/// The specification's appendix: how far a joint is along a limit.
fn metric(limit: &Value, a: &Transform, b: &Transform) -> f32 {
    let axes = |key: &str| -> Vec<usize> {
        let list = limit[key].as_array();
        list.into_iter()
            .flatten()
            .filter_map(Value::as_u64)
            .map(|i| i as usize)
            .collect()
    };
    let linear = axes("linearAxes");
    let apart = b.translation - a.translation;
    let axis = |of: &Transform, i: usize| of.rotation * Vec3::AXES[i];
    match linear[..] {
        [i] => return axis(a, i).dot(apart),
        [i, j] => return apart.reject_from(axis(a, 3 - i - j)).length(),
        [_, _, _] => return apart.length(),
        _ => {}
    }
    let between = a.rotation.inverse() * b.rotation;
    match axes("angularAxes")[..] {
        [i] => {
            let angle = 2.0 * Vec3::new(between.x, between.y, between.z)[i].atan2(between.w);
            (angle + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU) - std::f32::consts::PI
        }
        [i, j] => axis(a, 3 - i - j).angle_between(axis(b, 3 - i - j)),
        _ => 2.0 * between.w.abs().min(1.0).acos(),
    }
}

/// Runs a file and says whether what its page expects has come true.
fn judge(folder: &Path, file: &str) -> Result<String, String> {
    let mut sample = Sample::load(folder, file);
    let stem = Path::new(file)
        .file_stem()
        .map(|s| s.to_string_lossy().into_owned())
        .unwrap_or_default();
    let (group, number) = stem.rsplit_once('_').unwrap_or((&stem, ""));
    let check = |right: bool, what: String| if right { Ok(what) } else { Err(what) };
    match (group, number) {
        ("RigidBodies_ColliderTypeMatrix", _) => {
            sample.run(4.0);
            sample.sound()?;
            let moving = (0..3)
                .find(|i| sample.physics(*i).get("motion").is_some())
                .unwrap_or(1);
            let before = sample.at(moving).y;
            sample.run(1.0);
            let y = sample.at(moving).y;
            // Boxes stand half a metre deeper than the page says, and hulls have their origin below.
            let rests = (y - before).abs() < 0.02 && y > -0.51;
            check(rests, format!("the body rests at {y:.2} m"))
        }
        ("RigidBodies_CollisionFilter", "00" | "01") => {
            sample.run(4.0);
            sample.sound()?;
            let y = [0, 1].map(|node| sample.at(node).y);
            check(
                y[0] > 0.9 && y[1] < -5.0,
                format!("one stays at {:.2} m, one falls to {:.1} m", y[0], y[1]),
            )
        }
        ("RigidBodies_CollisionFilter", _) => {
            sample.run(4.0);
            sample.sound()?;
            let y = [0, 3].map(|node| sample.at(node).y);
            // The lower box of each carries it or not; what passes is caught by the upper one.
            check(
                (y[0] - y[1]).abs() > 0.5,
                format!("they rest at {:.2} m and {:.2} m", y[0], y[1]),
            )
        }
        ("RigidBodies_Joint", "09") => {
            // Damping 1/s: it comes nearer by the factor e in each second.
            sample.run(8.0);
            sample.sound()?;
            sample.limits_hold(0.02)?;
            let entity = sample.nodes[&3];
            let speed = sample.stage.get::<Velocity>(entity).angular.x;
            check(
                (speed - std::f32::consts::FRAC_PI_2).abs() < 0.02,
                format!("it turns with {speed:.3} rad/s"),
            )
        }
        ("RigidBodies_Joint", "10") => {
            sample.run(6.0);
            sample.sound()?;
            sample.limits_hold(0.02)?;
            let y = sample.at(3).y;
            check(
                (y - (2.0 - 9.81 / 100.0)).abs() < 0.03,
                format!("it rests at {y:.3} m"),
            )
        }
        ("RigidBodies_Joint", _) => {
            for _ in 0..8 {
                sample.run(0.5);
                sample.sound()?;
                sample.limits_hold(0.02)?;
            }
            Ok("limits hold within 2 cm and 0.02 rad".into())
        }
        ("RigidBodies_Materials", "00" | "01") => {
            let mut peaks = [0.0_f32; 2];
            let mut met = [false; 2];
            for _ in 0..(4.0 / DT) as usize {
                sample.stage.app.update();
                for i in 0..2 {
                    let y = sample.at(i).y;
                    met[i] |= y < 1.05;
                    peaks[i] = if met[i] { peaks[i].max(y) } else { 0.0 };
                }
            }
            sample.sound()?;
            check(
                met == [true; 2] && peaks[1] > peaks[0] + 0.5,
                format!("they jump to {:.2} m and {:.2} m", peaks[0], peaks[1]),
            )
        }
        ("RigidBodies_Materials", _) => {
            let before = [0, 1].map(|i| sample.at(i));
            sample.run(1.0);
            sample.sound()?;
            let slid = [0, 1].map(|i| sample.at(i).distance(before[i]));
            check(
                slid[0] > 1.0 && slid[1] < 0.1,
                format!("they slide {:.2} m and {:.3} m", slid[0], slid[1]),
            )
        }
        ("RigidBodies_MotionProperties", number) => {
            let node = usize::from(matches!(number, "03" | "04" | "05" | "07"));
            let before = sample.place(node);
            let others = [0, 2, 1, 3].map(|i| {
                if number == "06" {
                    sample.at(i)
                } else {
                    Vec3::ZERO
                }
            });
            sample.run(1.0);
            sample.sound()?;
            let after = sample.place(node);
            let moved = after.translation - before.translation;
            let turned = after.rotation.angle_between(before.rotation);
            // A world step of 1/60 s, and the frame that the scene takes to spawn.
            let near = |v: Vec3, to: Vec3| v.distance(to) < 0.04;
            match number {
                "00" => check(
                    moved.length() < 1e-4,
                    format!("it moves {:.1e} m", moved.length()),
                ),
                "01" | "03" => check(near(moved, Vec3::X), format!("it moves {moved:.3}")),
                "02" | "04" => check(
                    (turned - 1.0).abs() < 0.04,
                    format!("it turns {turned:.3} rad"),
                ),
                "05" => check(
                    moved.length() < 1e-4,
                    format!("it moves {:.1e} m", moved.length()),
                ),
                "06" => {
                    let now = [0, 2, 1, 3].map(|i| sample.at(i));
                    let heavy = (now[3] - others[3]).x;
                    let light = (now[1] - others[1]).x;
                    check(
                        heavy > light + 0.5,
                        format!("struck by 100 kg it goes {heavy:.2} m, by 1 kg {light:.2} m"),
                    )
                }
                _ => check(turned < 1e-3, format!("it turns {turned:.1e} rad")),
            }
        }
        _ => {
            sample.run(5.0);
            sample.sound()?;
            sample.limits_hold(0.08)?;
            Ok("loads, runs 5 s, limits hold".into())
        }
    }
}

fn files(folder: &Path, under: &str, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder.join(under))
        .into_iter()
        .flatten()
        .flatten()
    {
        let name = format!("{under}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            files(folder, &name, found);
        } else if name.ends_with(".gltf") || name.ends_with(".glb") {
            found.push(name);
        }
    }
}

#[test]
fn samples_of_the_extensions_repository() {
    let Some(folder) = std::env::var_os("COILOVER_GLTF_PHYSICS").map(PathBuf::from) else {
        println!("skipped: COILOVER_GLTF_PHYSICS does not name a folder with the samples");
        return;
    };
    let mut all = Vec::new();
    files(&folder, "samples", &mut all);
    files(&folder, "tests", &mut all);
    all.sort();
    assert!(
        all.len() > 50,
        "{} files in {}",
        all.len(),
        folder.display()
    );
    let only = std::env::var("COILOVER_ONLY").unwrap_or_default();
    let mut wrong = Vec::new();
    for file in all.iter().filter(|file| file.contains(&only)) {
        let told = std::panic::catch_unwind(|| judge(&folder, file))
            .unwrap_or_else(|_| Err("it panics".into()));
        match &told {
            Ok(what) => println!("| {file} | holds | {what} |"),
            Err(what) => println!("| {file} | **fails** | {what} |"),
        }
        if told.is_err() {
            wrong.push(file);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
