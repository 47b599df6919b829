//! Extension handler of Bevy's glTF loader: reads this crate's extensions and puts their components on the loaded
//! scene.

use super::carry::{LoadedBody, LoadedCollider, LoadedEnd, LoadedJoint, Shape};
use super::geometry::Geometry;
use super::json::Told;
use super::nodes::{File, Node};
use super::physics::{self, Shared, Source};
use super::{element, ends};
use bevy::asset::LoadContext;
use bevy::ecs::entity::EntityHashSet;
use bevy::gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler};
use bevy::gltf::{GltfLoaderSettings, gltf as bevy_gltf};
use bevy::mesh::MeshVertexAttribute;
use bevy::platform::collections::HashMap;
use bevy::prelude::{Entity, EntityWorldMut, World};
use bevy::tasks::ConditionalSendFuture;
use std::sync::Arc;

/// State of one load. For each load, Bevy clones an empty handler.
#[derive(Clone, Default)]
pub(super) struct Handler {
    file: Arc<File>,
    /// Geometry that colliders need.
    geometry: Geometry,
    /// Entities of the scene that is being loaded, by index of the node.
    entities: HashMap<usize, Entity>,
}

impl GltfExtensionHandler for Handler {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(self.clone())
    }

    fn on_root(
        &mut self,
        load_context: &mut LoadContext<'_>,
        gltf: &bevy_gltf::Gltf,
        _settings: &GltfLoaderSettings,
    ) {
        let concerns_us = |node: gltf::Node| {
            node.extension_value(physics::NAME).is_some()
                || node.extension_value(element::NAME).is_some()
        };
        if gltf.document.nodes().any(concerns_us) {
            self.file = Arc::new(File::read(&gltf.document, load_context.path().to_string()));
        }
    }

    fn on_gltf_primitive(
        &mut self,
        _load_context: &mut LoadContext<'_>,
        _document: &bevy_gltf::Gltf,
        mesh: &gltf::Mesh,
        primitive: &gltf::Primitive,
        buffers: &[Vec<u8>],
        _attributes: &HashMap<Box<str>, MeshVertexAttribute>,
        _on_skinned: bool,
        _on_others: bool,
        _own_mesh: &mut Option<bevy::prelude::Mesh>,
    ) -> impl ConditionalSendFuture<Output = ()> {
        self.take(mesh, primitive, buffers);
        async {}
    }

    fn on_gltf_node(
        &mut self,
        _load_context: &mut LoadContext<'_>,
        node: &gltf::Node,
        entity: &mut EntityWorldMut,
    ) {
        if !self.file.nodes.is_empty() {
            self.entities.insert(node.index(), entity.id());
        }
    }

    fn on_scene_completed(
        &mut self,
        _load_context: &mut LoadContext<'_>,
        _scene: &gltf::Scene,
        _root: Entity,
        world: &mut World,
    ) {
        let entities = std::mem::take(&mut self.entities);
        let told = Told::default();
        self.fill(&entities, world, &told);
        told.log(&self.file.path);
    }
}

impl Handler {
    /// Returns a handler that has read a file.
    #[cfg(test)]
    pub(super) fn of(document: &gltf::Document, path: String) -> Self {
        Self {
            file: Arc::new(File::read(document, path)),
            ..Default::default()
        }
    }

    /// Returns the handler when it has read all meshes, as Bevy's loader lets it do before the scenes.
    #[cfg(test)]
    pub(super) fn with_meshes(mut self, document: &gltf::Document, buffers: &[Vec<u8>]) -> Self {
        for mesh in document.meshes() {
            for primitive in mesh.primitives() {
                self.take(&mesh, &primitive, buffers);
            }
        }
        self
    }

    /// Reads a primitive if colliders need its mesh.
    fn take(&mut self, mesh: &gltf::Mesh, primitive: &gltf::Primitive, buffers: &[Vec<u8>]) {
        if self.file.wanted.contains(&mesh.index()) {
            self.geometry.add(mesh.index(), primitive, buffers);
        }
    }

    /// Inserts into the entities of a scene the components that the file defines for their nodes.
    pub(super) fn fill(
        &mut self,
        entities: &HashMap<usize, Entity>,
        world: &mut World,
        told: &Told,
    ) {
        let file = self.file.clone();
        let Some(shared) = &file.shared else { return };
        let mut framed = EntityHashSet::default();
        for (index, node) in file.nodes.iter().enumerate() {
            let Some(&entity) = entities.get(&index) else {
                continue;
            };
            let mut entity = world.entity_mut(entity);
            if let Some(motion) = &node.physics.motion {
                entity.insert(LoadedBody {
                    node: index,
                    motion: Arc::new(motion.clone()),
                    place: format!("{}: {}", file.path, node.place),
                });
            }
            if let Some(collider) = self.collider(&file, shared, index, told) {
                entity.insert(collider);
            }
            if let Some(joint) = joint(&file, shared, index, entities, told) {
                entity.insert(joint);
            }
            if let Some(value) = &node.element {
                let find = |index: usize| entities.get(&index).copied();
                element::insert(value, &node.place, told, find, &mut entity);
                framed.extend(ends::framed_ends(entity.as_readonly()));
            }
        }
        // An end that this scene has not is none of its nodes.
        for node in 0..file.nodes.len() {
            if let Some(end) = entities.get(&node).filter(|end| framed.contains(*end)) {
                world.entity_mut(*end).insert(LoadedEnd { node });
            }
        }
    }

    /// Returns the collider of a node.
    fn collider(
        &mut self,
        file: &File,
        shared: &Shared,
        index: usize,
        told: &Told,
    ) -> Option<LoadedCollider> {
        let node = &file.nodes[index];
        let collider = node.physics.collider.as_ref()?;
        let shape = self.shape(collider.source, file, shared, node, told)?;
        let material = collider.material.and_then(|index| {
            let material = shared.materials.get(index).copied().flatten();
            if material.is_none() {
                let what = format_args!("physicsMaterial {index} is not in the file");
                told.tell(&node.place, what);
            }
            material
        });
        let groups = &file.groups;
        let group = collider.filter.and_then(|index| {
            let is_there = index < shared.filters.len();
            if !is_there {
                let what = format_args!("collisionFilter {index} is not in the file");
                told.tell(&node.place, what);
            }
            is_there.then(|| groups[index])
        });
        let unfiltered = (groups.len() > 1).then(|| groups[groups.len() - 1]);
        Some(LoadedCollider {
            node: index,
            shape,
            material,
            groups: group.or(unfiltered),
            trigger: collider.trigger,
            place: format!("{}: {}", file.path, node.place),
        })
    }

    /// Returns the geometry of a node's collider.
    fn shape(
        &mut self,
        source: Source,
        file: &File,
        shared: &Shared,
        node: &Node,
        told: &Told,
    ) -> Option<Shape> {
        match source {
            Source::Shape(index) => {
                let shape = shared.shapes.get(index).copied().flatten();
                if shape.is_none() {
                    let what = format_args!("shape {index} is not in the file; no collider");
                    told.tell(&node.place, what);
                }
                shape.map(Shape::Implicit)
            }
            Source::Mesh { node: of, hull } => match self.geometry.collider(file, of) {
                Ok(mesh) => Some(Shape::Mesh { mesh, hull }),
                Err(reason) => {
                    let what = format_args!("geometry: node {of} {reason}; no collider");
                    told.tell(&node.place, what);
                    None
                }
            },
        }
    }
}

/// Returns the joint of a node.
fn joint(
    file: &File,
    shared: &Shared,
    index: usize,
    entities: &HashMap<usize, Entity>,
    told: &Told,
) -> Option<LoadedJoint> {
    let node = &file.nodes[index];
    let joint = node.physics.joint.as_ref()?;
    let connected = entities.get(&joint.connected);
    let kind = shared.joints.get(joint.kind).cloned().flatten();
    match (connected, kind) {
        (Some(&connected), Some(kind)) => {
            return Some(LoadedJoint {
                node: index,
                connected,
                kind: Arc::new(kind),
                collide: joint.collide,
                place: format!("{}: {}", file.path, node.place),
            });
        }
        (None, _) => told.tell(
            &node.place,
            format_args!(
                "joint.connectedNode is node {}, which this scene has not; left out",
                joint.connected
            ),
        ),
        _ => told.tell(
            &node.place,
            format_args!("joint.joint {} is not in the file; left out", joint.kind),
        ),
    }
    None
}
