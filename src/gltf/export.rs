//! Out again: bodies, colliders, joints and elements of a world as a glTF file.

use super::export_element::element;
use super::export_physics::{Geometry, Parts, filter, joint, material, motion};
use super::mass::steady;
use super::number::{Fields, numbers, vector};
use crate::element::*;
use base64::Engine as _;
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::{Value, json};

/// A glTF file, made by [`export_gltf`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExportedGltf {
    /// The file's text: a `.gltf` with its buffers inside.
    pub text: String,
    /// What could not be written, one sentence each, with the entity.
    pub left_out: Vec<String>,
}

/// Writes what stands on and below `roots` as a glTF file, as it is now: bodies, colliders and joints of Rapier as
/// `KHR_physics_rigid_bodies`, elements as `BEVY_coilover`, with the nodes that they stand on. What is drawn is not
/// written.
///
/// Numbers read back as the same numbers of single precision. Each root's place is that in the world. `docs/gltf.md` says
/// what the format cannot hold; [`ExportedGltf::left_out`] says it of this world.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_coilover::export_gltf;
/// # fn save(world: &World, car: Entity) -> std::io::Result<()> {
/// let exported = export_gltf(world, [car]);
/// for reason in &exported.left_out {
///     warn!("{reason}");
/// }
/// std::fs::write("car.gltf", exported.text)
/// # }
/// ```
pub fn export_gltf(world: &World, roots: impl IntoIterator<Item = Entity>) -> ExportedGltf {
    let mut roots: Vec<_> = roots.into_iter().collect();
    let mut seen = EntityHashSet::default();
    roots.retain(|root| world.get_entity(*root).is_ok() && seen.insert(*root));
    let kept = kept(world, &roots);
    let mut writer = Writer {
        world,
        index: EntityHashMap::default(),
        order: Vec::new(),
        nodes: Vec::new(),
        shared: Parts::default(),
        left_out: Vec::new(),
    };
    for root in &roots {
        writer.number(*root, &kept);
    }
    writer.write(&roots)
}

/// What there is to write: entities that say something, ends, and all that they stand below.
fn kept(world: &World, roots: &[Entity]) -> EntityHashSet {
    let mut below = Vec::new();
    let mut seen = EntityHashSet::default();
    let mut open = roots.to_vec();
    while let Some(entity) = open.pop() {
        if seen.insert(entity) {
            below.push(entity);
            open.extend(world.get::<Children>(entity).into_iter().flatten());
        }
    }
    let mut kept = EntityHashSet::from_iter(roots.iter().copied());
    let mut keep = |mut entity: Entity| {
        while seen.contains(&entity) && kept.insert(entity) {
            match world.get::<ChildOf>(entity) {
                Some(parent) => entity = parent.parent(),
                None => break,
            }
        }
    };
    for entity in below {
        let here = world.entity(entity);
        let ends = ends(here);
        if here.contains::<RigidBody>() || here.contains::<Collider>() || ends.is_some() {
            keep(entity);
        }
        ends.into_iter().flatten().for_each(&mut keep);
    }
    kept
}

/// The ends of an element.
fn ends(entity: EntityRef) -> Option<[Entity; 2]> {
    macro_rules! ends {
        ($($element:ty),*) => {
            $(if let Some(element) = entity.get::<$element>() {
                return Some([element.body_a, element.body_b]);
            })*
        };
    }
    ends!(
        Spring,
        Damper,
        SpringDamper,
        TorsionSpring,
        TorsionDamper,
        TorsionSpringDamper
    );
    None
}

struct Writer<'w> {
    world: &'w World,
    index: EntityHashMap<usize>,
    order: Vec<Entity>,
    nodes: Vec<Value>,
    shared: Parts,
    left_out: Vec<String>,
}

impl Writer<'_> {
    /// Gives indices to an entity and what is kept below it.
    fn number(&mut self, root: Entity, kept: &EntityHashSet) {
        let mut open = vec![root];
        while let Some(entity) = open.pop() {
            if !kept.contains(&entity) || self.index.contains_key(&entity) {
                continue;
            }
            self.index.insert(entity, self.order.len());
            self.order.push(entity);
            let children = self.world.get::<Children>(entity);
            let children: Vec<_> = children.into_iter().flatten().copied().collect();
            open.extend(children.into_iter().rev());
        }
    }

    fn write(mut self, roots: &[Entity]) -> ExportedGltf {
        let order = std::mem::take(&mut self.order);
        for entity in &order {
            let node = self.node(*entity, roots.contains(entity));
            self.nodes.push(node);
        }
        self.joints(&order);
        let nodes: Vec<_> = roots.iter().map(|root| self.index[root]).collect();
        let mut extensions = Fields::default();
        let shared = self.shared;
        if !shared.shapes.is_empty() {
            extensions.add(super::physics::SHAPES, json!({ "shapes": shared.shapes }));
        }
        let list = |list: Vec<Value>| {
            if list.is_empty() {
                Value::Null
            } else {
                list.into()
            }
        };
        let physics = Fields::default()
            .with("physicsMaterials", list(shared.materials))
            .with("collisionFilters", list(shared.filters))
            .with("physicsJoints", list(shared.joints));
        if !physics.is_empty() {
            extensions.add(super::physics::NAME, physics.value());
        }
        let buffers = if shared.buffer.is_empty() {
            Value::Null
        } else {
            let text = base64::engine::general_purpose::STANDARD.encode(&shared.buffer);
            json!([{
                "byteLength": shared.buffer.len(),
                "uri": format!("data:application/octet-stream;base64,{text}"),
            }])
        };
        let file = Fields::default()
            .with(
                "asset",
                json!({ "version": "2.0", "generator": "bevy_coilover" }),
            )
            .with(
                "extensionsUsed",
                json!([
                    super::element::NAME,
                    super::physics::NAME,
                    super::physics::SHAPES
                ]),
            )
            .with("scene", json!(0))
            .with("scenes", json!([{ "nodes": nodes }]))
            .with("nodes", list(self.nodes))
            .with("meshes", list(shared.meshes))
            .with("accessors", list(shared.accessors))
            .with("bufferViews", list(shared.views))
            .with("buffers", buffers)
            .with(
                "extensions",
                if extensions.is_empty() {
                    Value::Null
                } else {
                    extensions.value()
                },
            );
        ExportedGltf {
            text: file.value().to_string(),
            left_out: self.left_out,
        }
    }

    fn node(&mut self, entity: Entity, is_root: bool) -> Value {
        let here = self.world.entity(entity);
        let mut node = Fields::default();
        if let Some(name) = here.get::<Name>() {
            node.add("name", name.as_str().into());
        }
        let global = here.get::<GlobalTransform>().filter(|_| {
            // A root that stands below something else is where it is in the world.
            is_root && here.contains::<ChildOf>()
        });
        let place = global
            .map(GlobalTransform::compute_transform)
            .or(here.get::<Transform>().copied())
            .unwrap_or_default();
        if place.translation != Vec3::ZERO {
            node.add("translation", vector(place.translation));
        }
        if place.rotation != Quat::IDENTITY {
            node.add("rotation", numbers(place.rotation.to_array()));
        }
        if place.scale != Vec3::ONE {
            node.add("scale", vector(place.scale));
        }
        let children = here.get::<Children>().into_iter().flatten();
        let children: Vec<_> = children
            .filter_map(|child| self.index.get(child).copied())
            .collect();
        if !children.is_empty() {
            node.add("children", json!(children));
        }
        let mut extensions = Fields::default();
        let physics = self.physics(entity);
        if !physics.is_empty() {
            extensions.add(super::physics::NAME, physics.value());
        }
        let index = |end: Entity| self.index.get(&end).copied();
        if let Some(element) = element(here, index, &mut self.left_out) {
            extensions.add(super::element::NAME, element);
        }
        if !extensions.is_empty() {
            node.add("extensions", extensions.value());
        }
        node.value()
    }

    /// Motion and collider of an entity.
    fn physics(&mut self, entity: Entity) -> Fields {
        let here = self.world.entity(entity);
        let mut physics = Fields::default();
        if let Some(motion) = motion(here, self.world, &mut self.left_out) {
            physics.add("motion", motion);
        }
        let Some(collider) = here.get::<Collider>() else {
            return physics;
        };
        let geometry = match self.shared.geometry(collider) {
            Ok(Geometry::Shape(shape)) => json!({ "shape": shape }),
            Ok(Geometry::Mesh { mesh, hull }) => {
                // A node of its own, outside the scene, so that nothing more is drawn.
                let node = self.index.len() + self.shared.mesh_nodes.len();
                self.shared.mesh_nodes.push(json!({ "mesh": mesh }));
                json!({ "node": node, "convexHull": hull })
            }
            Err(what) => {
                self.left_out.push(format!("{entity}: its collider {what}"));
                return physics;
            }
        };
        let mut fields = Fields::default().with("geometry", geometry);
        if let Some(groups) = here.get::<CollisionGroups>() {
            fields.add("collisionFilter", json!(self.shared.filter(filter(groups))));
        }
        if here.contains::<Sensor>() {
            physics.add("trigger", fields.value());
            return physics;
        }
        if let Some(material) = material(here) {
            fields.add("physicsMaterial", json!(self.shared.material(material)));
        }
        physics.add("collider", fields.value());
        physics
    }

    /// Joints, each as two nodes below its bodies; after all others, so that their indices are known.
    fn joints(&mut self, order: &[Entity]) {
        let meshes = std::mem::take(&mut self.shared.mesh_nodes);
        self.nodes.extend(meshes);
        for entity in self.joint_entities(order) {
            let Some(ImpulseJoint { parent, data }) = self.world.get(entity) else {
                continue;
            };
            let owner = super::expand::owner(self.world, entity);
            let bodies = [Some(*parent), owner];
            let [Some(a), Some(b)] = bodies.map(|body| self.index.get(&body?).copied()) else {
                let what = format!("{entity}: a body of its joint is not among what is exported");
                self.left_out.push(what);
                continue;
            };
            let raw = data.as_ref().raw;
            let kind = joint(&raw, entity, &mut self.left_out);
            let kind = self.shared.joint(kind);
            let mut frame =
                |body: usize, entity: Option<Entity>, frame: (Vec3, Quat), extensions: Value| {
                    let scale = entity
                        .and_then(|entity| self.world.get::<GlobalTransform>(entity))
                        .map_or(Vec3::ONE, |place| steady(place.compute_transform().scale));
                    let node = Fields::default()
                        .with("translation", vector(frame.0 / scale))
                        .with("rotation", numbers(frame.1.to_array()))
                        .with("extensions", extensions);
                    let index = self.nodes.len();
                    self.nodes.push(node.value());
                    let body = &mut self.nodes[body];
                    let mut children = body["children"].as_array().cloned().unwrap_or_default();
                    children.push(json!(index));
                    body["children"] = children.into();
                    index
                };
            let frames = [raw.local_frame1, raw.local_frame2].map(|f| (f.translation, f.rotation));
            let other = frame(b, owner, frames[1], Value::Null);
            let joint = json!({ "joint": {
                "connectedNode": other, "joint": kind, "enableCollision": raw.contacts_enabled,
            } });
            frame(
                a,
                Some(*parent),
                frames[0],
                json!({ super::physics::NAME: joint }),
            );
        }
    }

    /// What holds a joint: anything on or below what is exported.
    fn joint_entities(&self, order: &[Entity]) -> Vec<Entity> {
        let mut found = Vec::new();
        let mut seen = EntityHashSet::default();
        let mut open: Vec<_> = order.iter().rev().copied().collect();
        while let Some(entity) = open.pop() {
            if !seen.insert(entity) {
                continue;
            }
            if self.world.get::<ImpulseJoint>(entity).is_some() {
                found.push(entity);
            }
            open.extend(self.world.get::<Children>(entity).into_iter().flatten());
        }
        found
    }
}
