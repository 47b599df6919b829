//! Writes bodies, colliders, joints and elements of a world as a glTF file.

use super::ends::{ends, written_ends};
use super::export_element::element;
use super::export_filters::Filters;
use super::export_physics::{Geometry, Parts, material, motion, own_scale};
use super::left_out::LeftOut;
use super::number::{Fields, numbers, vector};
use super::place::{above, place};
use crate::MouseSpring;
use base64::Engine as _;
use bevy::ecs::entity::{EntityHashMap, EntityHashSet, EntityIndexSet};
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::{Value, json};

/// A glTF file, made by [`export_gltf`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExportedGltf {
    /// Text of the `.gltf` file, with its buffers embedded.
    pub text: String,
    /// What could not be written, or reads back as something else. Each sentence names the entity, and the component
    /// where one is concerned.
    pub left_out: Vec<String>,
}

/// Writes `roots` and their descendants in their present state as a glTF file. Bodies, colliders and joints of Rapier
/// become `KHR_physics_rigid_bodies`, and elements become `BEVY_coilover`. Nodes are written for these and for the
/// entities that they need. Meshes for rendering are not written.
///
/// Numbers of elements, shapes and materials read back as the same `f32`, and those of places, velocities and joints up to
/// rounding. Each root gets its transform in the world; a root below another root stays there. Physics need not have run a
/// step. `docs/gltf.md` lists what the format cannot hold, and [`ExportedGltf::left_out`] lists what was lost of this world.
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
    let mut asked: Vec<_> = roots.into_iter().collect();
    let mut seen = EntityHashSet::default();
    asked.retain(|root| world.get_entity(*root).is_ok() && seen.insert(*root));
    let below = below(world, &asked);
    let kept = kept(world, &asked, &below);
    // Each node is in the file once: a root below another root is written there.
    let stands_alone = |root: &Entity| !above(world, *root).any(|above| seen.contains(&above));
    let roots: Vec<_> = asked.into_iter().filter(stands_alone).collect();
    let mut writer = Writer {
        world,
        index: EntityHashMap::default(),
        order: Vec::new(),
        nodes: Vec::new(),
        shared: Parts::default(),
        left_out: LeftOut::default(),
    };
    for root in &roots {
        writer.number(*root, &kept);
    }
    tell_beside(world, &below, &mut writer.left_out);
    for entity in below.iter().filter(|entity| !kept.contains(*entity)) {
        writer.left_out.tell_unwritten(world.entity(*entity));
    }
    writer.write(&roots)
}

/// Returns the roots and all their descendants.
fn below(world: &World, roots: &[Entity]) -> EntityIndexSet {
    let mut below = EntityIndexSet::new();
    let mut open = roots.to_vec();
    while let Some(entity) = open.pop() {
        if below.insert(entity) {
            open.extend(world.get::<Children>(entity).into_iter().flatten());
        }
    }
    below
}

/// Tells of what acts on entities below the roots and is itself not below them.
fn tell_beside(world: &World, below: &EntityIndexSet, left_out: &mut LeftOut) {
    let acts_on_them = |here: &EntityRef| {
        let pulled = here.get::<MouseSpring>().map(|mouse| mouse.body);
        let ends = written_ends(*here, world).into_iter().flatten();
        ends.chain(pulled).any(|end| below.contains(&end))
    };
    // This finds disabled entities too, as a query would not.
    let others = world
        .iter_entities()
        .filter(|here| !below.contains(&here.id()));
    for here in others.filter(acts_on_them) {
        let what = "acts on what is exported, but is below none of the roots; not written";
        left_out.tell(here, what);
    }
}

/// Returns the entities to write: the roots, bodies, colliders and elements `below` them, the ends of those elements,
/// and all ancestors of these up to the roots.
fn kept(world: &World, roots: &[Entity], below: &EntityIndexSet) -> EntityHashSet {
    let mut kept = EntityHashSet::default();
    let mut keep = |mut entity: Entity| {
        while below.contains(&entity) && kept.insert(entity) {
            match world.get::<ChildOf>(entity) {
                Some(parent) => entity = parent.parent(),
                None => break,
            }
        }
    };
    roots.iter().copied().for_each(&mut keep);
    for entity in below.iter() {
        let here = world.entity(*entity);
        let ends = written_ends(here, world);
        if here.contains::<RigidBody>() || here.contains::<Collider>() || ends.is_some() {
            keep(*entity);
        }
        ends.into_iter().flatten().for_each(&mut keep);
    }
    kept
}

/// State of writing one file, node by node.
pub(super) struct Writer<'w> {
    pub(super) world: &'w World,
    /// Index of the node of each entity.
    pub(super) index: EntityHashMap<usize>,
    order: Vec<Entity>,
    pub(super) nodes: Vec<Value>,
    pub(super) shared: Parts,
    pub(super) left_out: LeftOut,
}

impl Writer<'_> {
    /// Assigns node indices to an entity and to its kept descendants.
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
        let colliders = order.iter().map(|entity| self.world.entity(*entity));
        let colliders = colliders.filter(|here| here.contains::<Collider>());
        self.shared.filters = Filters::of(colliders.map(groups));
        for entity in &order {
            let node = self.node(*entity, roots.contains(entity));
            self.nodes.push(node);
        }
        self.nodes.append(&mut self.shared.more_nodes);
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
            .with("collisionFilters", list(shared.filters.values()))
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
            left_out: self.left_out.sentences(),
        }
    }

    fn node(&mut self, entity: Entity, is_root: bool) -> Value {
        let here = self.world.entity(entity);
        let mut node = Fields::default();
        if let Some(name) = here.get::<Name>() {
            node.add("name", name.as_str().into());
        }
        // A root with a parent outside the file gets its transform in the world.
        let moved = is_root && here.contains::<ChildOf>();
        let place = if moved {
            place(self.world, entity)
        } else {
            here.get::<Transform>().copied()
        };
        let mut place = place.unwrap_or_default();
        if !place.is_finite() {
            self.left_out
                .tell(here, "its Transform is not finite; left out");
            place = Transform::default();
        }
        if place.translation != Vec3::ZERO {
            node.add("translation", vector(place.translation));
        }
        if place.rotation != Quat::IDENTITY {
            node.add("rotation", numbers(place.rotation.to_array()));
        }
        if place.scale != Vec3::ONE {
            node.add("scale", vector(place.scale));
        }
        let (physics, below) = self.physics(here);
        let children = here.get::<Children>().into_iter().flatten();
        let children = children.filter_map(|child| self.index.get(child).copied());
        let children: Vec<_> = children.chain(below).collect();
        if !children.is_empty() {
            node.add("children", json!(children));
        }
        let mut extensions = Fields::default();
        if !physics.is_empty() {
            extensions.add(super::physics::NAME, physics.value());
        }
        let index = |end: Entity| self.index.get(&end).copied();
        if let Some(element) = element(here, self.world, index, &mut self.left_out) {
            extensions.add(super::element::NAME, element);
        }
        if here.contains::<Disabled>() && ends(here).is_none() {
            let what = "Disabled is written of elements only";
            self.left_out.tell(here, what);
        }
        self.tell_part_of_another(here);
        self.left_out.tell_unwritten(here);
        if !extensions.is_empty() {
            node.add("extensions", extensions.value());
        }
        node.value()
    }

    /// Tells of a fixed body below a moving one: a file has no fixed bodies, only colliders that belong to no motion.
    fn tell_part_of_another(&mut self, here: EntityRef) {
        let moves = |entity: Entity| {
            let kind = self.world.get::<RigidBody>(entity);
            self.index.contains_key(&entity) && kind.is_some_and(|kind| *kind != RigidBody::Fixed)
        };
        let is_fixed = here.get() == Some(&RigidBody::Fixed);
        if is_fixed && above(self.world, here.id()).any(moves) {
            let what = "RigidBody::Fixed below a moving body comes back as a part of that body";
            self.left_out.tell(here, what);
        }
    }

    /// Returns motion and collider of an entity. If the collider has a scale of its own, it goes on a child node with
    /// that scale, and the index of that node is returned.
    fn physics(&mut self, here: EntityRef) -> (Fields, Option<usize>) {
        let mut physics = Fields::default();
        if let Some(motion) = motion(here, self.world, &mut self.left_out) {
            physics.add("motion", motion);
        }
        let Some((key, collider, symmetric)) = self.collider(here) else {
            return (physics, None);
        };
        let Some(scale) = own_scale(here, self.world, symmetric) else {
            physics.add(key, collider);
            return (physics, None);
        };
        let collider = Fields::default().with(key, collider).value();
        let extensions = Fields::default().with(super::physics::NAME, collider);
        let node = Fields::default()
            .with("scale", vector(scale))
            .with("extensions", extensions.value());
        (physics, Some(self.add_node(node.value())))
    }

    /// Returns the key of a collider (`collider` or `trigger`), its value, and whether its shape equals its mirror
    /// image.
    fn collider(&mut self, here: EntityRef) -> Option<(&'static str, Value, bool)> {
        let geometry = match self.shared.geometry(here.get::<Collider>()?) {
            Ok(geometry) => geometry,
            Err(what) => {
                self.left_out
                    .tell(here, format_args!("its collider {what}"));
                return None;
            }
        };
        if let ColliderView::TriMesh(mesh) = here.get::<Collider>()?.as_unscaled_typed_shape()
            && !mesh.raw.flags().is_empty()
        {
            self.left_out.tell(here, "TriMeshFlags are not written");
        }
        let symmetric = matches!(geometry, Geometry::Shape(_));
        let geometry = match geometry {
            Geometry::Shape(shape) => json!({ "shape": shape }),
            Geometry::Mesh { mesh, hull } => {
                let node = match self.shared.mesh_nodes.get(mesh) {
                    Some(node) => *node,
                    // The mesh goes on a separate node outside the scene, so that it is not drawn.
                    None => {
                        let node = self.add_node(json!({ "mesh": mesh }));
                        self.shared.mesh_nodes.push(node);
                        node
                    }
                };
                json!({ "node": node, "convexHull": hull })
            }
        };
        let mut fields = Fields::default().with("geometry", geometry);
        if let Some(filter) = self.shared.filters.index(groups(here)) {
            fields.add("collisionFilter", json!(filter));
        }
        if here.contains::<Sensor>() {
            return Some(("trigger", fields.value(), symmetric));
        }
        if let Some(material) = material(here) {
            fields.add("physicsMaterial", json!(self.shared.material(material)));
        }
        Some(("collider", fields.value(), symmetric))
    }

    /// Adds a node that belongs to no entity and returns its index. These nodes come after the nodes of all entities.
    fn add_node(&mut self, node: Value) -> usize {
        self.shared.more_nodes.push(node);
        self.index.len() + self.shared.more_nodes.len() - 1
    }
}

/// Returns the groups of a collider. In Rapier, a collider without `CollisionGroups` is in all groups and touches
/// all.
fn groups(collider: EntityRef) -> CollisionGroups {
    let groups = collider.get::<CollisionGroups>();
    groups.copied().unwrap_or_default()
}
