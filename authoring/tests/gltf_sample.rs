//! A simulated glTF file whose nodes are looked up by index.

use crate::harness::*;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::Value;
use std::collections::HashMap;
use std::path::Path;

/// A loaded and simulated glTF file.
pub struct Sample {
    pub stage: Stage,
    pub json: Value,
    /// Entities by node index. Names do not identify nodes: several nodes of a file may share a name.
    pub nodes: HashMap<usize, Entity>,
}

impl Sample {
    pub fn load(folder: &Path, file: &str) -> Self {
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

    /// Finds the entities of the nodes below an entity. Bevy spawns them in the order of the file.
    pub fn find(&mut self, parent: Entity, nodes: &Value) {
        let children = self.stage.app.world().get::<Children>(parent);
        let mut children: Vec<_> = children.into_iter().flatten().copied().collect();
        // The loader may put a nameless entity, which undoes the parent's transform, between a node and a body below it.
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
                // A mesh entity may have the same name as its object.
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

    pub fn run(&mut self, seconds: f32) {
        run(&mut self.stage.app, seconds);
    }

    /// The physics extension of a node.
    pub fn physics(&self, node: usize) -> &Value {
        &self.json["nodes"][node]["extensions"]["KHR_physics_rigid_bodies"]
    }

    pub fn name(&self, node: usize) -> String {
        let name = self.json["nodes"][node]["name"].as_str();
        name.map_or_else(|| format!("GltfNode{node}"), ToOwned::to_owned)
    }

    pub fn place(&self, node: usize) -> Transform {
        self.stage.place(self.nodes[&node])
    }

    pub fn at(&self, node: usize) -> Vec3 {
        self.place(node).translation
    }

    /// Checks that all positions are finite, that there are as many moving bodies and colliders as in the file, and that no
    /// spring has a fault.
    pub fn sound(&mut self) -> Result<(), String> {
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

    /// Checks that rigid limits hold within a tolerance (m or rad), by the specification's metrics.
    pub fn limits_hold(&self, tolerance: f32) -> Result<(), String> {
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

/// Distance (m) or angle (rad) of a joint that a limit bounds, from the appendix of the specification.
pub fn metric(limit: &Value, a: &Transform, b: &Transform) -> f32 {
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
