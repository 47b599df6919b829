//! Extension handler of Bevy's glTF loader: reads this crate's extensions and puts their components on the loaded
//! scene.

use super::carry::{LoadedBody, LoadedCollider, LoadedJoint, Mesh, Shape};
use super::json::Told;
use super::physics::{self, NodePhysics, Shared, Source};
use super::{element, ends, filters};
use bevy::asset::LoadContext;
use bevy::gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler};
use bevy::gltf::{GltfLoaderSettings, gltf as bevy_gltf};
use bevy::math::Affine3A;
use bevy::mesh::MeshVertexAttribute;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::{Entity, EntityWorldMut, Mat4, Quat, Vec3, World};
use bevy::tasks::ConditionalSendFuture;
use gltf::mesh::Mode;
use gltf::scene::Transform;
use serde_json::Value;
use std::sync::Arc;

/// Greatest depth of nodes that is followed. Bevy's own loader recurses and cannot go deeper either.
const DEEPEST: usize = 512;

/// State of one load. For each load, Bevy clones an empty handler.
#[derive(Clone, Default)]
pub(super) struct Handler {
    file: Arc<File>,
    /// Geometry that colliders need, by index of the mesh.
    meshes: HashMap<usize, Mesh>,
    /// Entities of the scene that is being loaded, by index of the node.
    entities: HashMap<usize, Entity>,
}

/// Content of the file that does not depend on the scene.
#[derive(Default)]
struct File {
    path: String,
    nodes: Vec<Node>,
    shared: Option<Shared>,
    /// Indices of the meshes that colliders need.
    wanted: HashSet<usize>,
}

#[derive(Default)]
struct Node {
    place: String,
    transform: Affine3A,
    children: Vec<usize>,
    mesh: Option<usize>,
    deformed: bool,
    element: Option<Value>,
    physics: NodePhysics,
}

impl File {
    fn read(document: &gltf::Document, path: String) -> Self {
        let told = Told::default();
        let read = |node: gltf::Node| {
            let name = node.name().map(|name| format!(" '{name}'"));
            let place = format!("node {}{}", node.index(), name.unwrap_or_default());
            let physics = node.extension_value(physics::NAME);
            Node {
                transform: affine(&node),
                children: node.children().map(|child| child.index()).collect(),
                mesh: node.mesh().map(|mesh| mesh.index()),
                deformed: node.skin().is_some() || node.weights().is_some(),
                element: node.extension_value(element::NAME).cloned(),
                physics: physics
                    .map(|value| NodePhysics::read(value, &place, &told))
                    .unwrap_or_default(),
                place,
            }
        };
        let nodes: Vec<_> = document.nodes().map(read).collect();
        let shared = Shared::read(
            document.extension_value(physics::NAME),
            document.extension_value(physics::SHAPES),
            &told,
        );
        if shared.filters.len() > filters::MOST {
            let most = filters::MOST;
            told.tell(
                physics::NAME,
                format_args!("collisionFilters beyond the first {most} are taken as one"),
            );
        }
        let mut file = Self {
            path,
            nodes,
            shared: Some(shared),
            ..Default::default()
        };
        let mut wanted = HashSet::new();
        for node in &file.nodes {
            if let Some(collider) = &node.physics.collider
                && let Source::Mesh { node: source, .. } = collider.source
            {
                file.below(source, &mut |node, _| {
                    wanted.extend(node.mesh);
                    if node.deformed {
                        told.tell(&node.place, "its skin or weights do not deform colliders");
                    }
                });
            }
        }
        file.wanted = wanted;
        told.log(&file.path);
        file
    }

    /// Visits a node and its descendants, each with its transform in the space of the first node.
    fn below<'a>(&'a self, first: usize, visit: &mut impl FnMut(&'a Node, Affine3A)) {
        let mut open = vec![(first, Affine3A::IDENTITY, 0)];
        let mut seen = HashSet::new();
        while let Some((index, place, depth)) = open.pop() {
            let Some(node) = self.nodes.get(index) else {
                continue;
            };
            if depth > DEEPEST || !seen.insert(index) {
                continue;
            }
            visit(node, place);
            for &child in &node.children {
                if let Some(node) = self.nodes.get(child) {
                    open.push((child, place * node.transform, depth + 1));
                }
            }
        }
    }
}

fn affine(node: &gltf::Node) -> Affine3A {
    match node.transform() {
        Transform::Matrix { matrix } => Affine3A::from_mat4(Mat4::from_cols_array_2d(&matrix)),
        Transform::Decomposed {
            translation,
            rotation,
            scale,
        } => Affine3A::from_scale_rotation_translation(
            Vec3::from_array(scale),
            Quat::from_array(rotation),
            Vec3::from_array(translation),
        ),
    }
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
        if self.file.wanted.contains(&mesh.index()) {
            add_primitive(
                self.meshes.entry(mesh.index()).or_default(),
                primitive,
                buffers,
            );
        }
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

    /// Inserts into the entities of a scene the components that the file defines for their nodes.
    pub(super) fn fill(&self, entities: &HashMap<usize, Entity>, world: &mut World, told: &Told) {
        let file = &*self.file;
        let Some(shared) = &file.shared else { return };
        let groups = filters::groups(shared);
        let mut hulls = HashMap::default();
        for (index, node) in file.nodes.iter().enumerate() {
            let Some(&entity) = entities.get(&index) else {
                continue;
            };
            let mut entity = world.entity_mut(entity);
            if let Some(motion) = &node.physics.motion {
                entity.insert(LoadedBody {
                    motion: Arc::new(motion.clone()),
                    place: format!("{}: {}", file.path, node.place),
                });
            }
            if let Some(collider) = &node.physics.collider
                && let Some(shape) = self.shape(collider.source, shared, node, told, &mut hulls)
            {
                let material = collider.material.and_then(|index| {
                    let material = shared.materials.get(index).copied().flatten();
                    if material.is_none() {
                        let what = format_args!("physicsMaterial {index} is not in the file");
                        told.tell(&node.place, what);
                    }
                    material
                });
                let group = collider.filter.and_then(|index| {
                    let is_there = index < shared.filters.len();
                    if !is_there {
                        let what = format_args!("collisionFilter {index} is not in the file");
                        told.tell(&node.place, what);
                    }
                    is_there.then(|| groups[index])
                });
                let unfiltered = (groups.len() > 1).then(|| groups[groups.len() - 1]);
                entity.insert(LoadedCollider {
                    shape,
                    material,
                    groups: group.or(unfiltered),
                    trigger: collider.trigger,
                    place: format!("{}: {}", file.path, node.place),
                });
            }
            if let Some(joint) = &node.physics.joint {
                let connected = entities.get(&joint.connected);
                let kind = shared.joints.get(joint.kind).cloned().flatten();
                match (connected, kind) {
                    (Some(&connected), Some(kind)) => {
                        entity.insert(LoadedJoint {
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
            }
            if let Some(value) = &node.element {
                let find = |index: usize| entities.get(&index).copied();
                element::insert(value, &node.place, told, find, &mut entity);
                ends::mark(&mut entity);
            }
        }
    }

    /// Returns the geometry of a node's collider. `made` caches meshes by node.
    fn shape(
        &self,
        source: Source,
        shared: &Shared,
        node: &Node,
        told: &Told,
        made: &mut HashMap<usize, Arc<Mesh>>,
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
            Source::Mesh { node: of, hull } => {
                let mesh = made.entry(of).or_insert_with(|| Arc::new(self.mesh(of)));
                if mesh.vertices.is_empty() {
                    let what = format_args!("geometry: node {of} has no triangles; no collider");
                    told.tell(&node.place, what);
                    return None;
                }
                Some(Shape::Mesh {
                    mesh: mesh.clone(),
                    hull,
                })
            }
        }
    }

    /// Returns the triangles of a node and its descendants, in the space of that node.
    fn mesh(&self, node: usize) -> Mesh {
        let mut all = Mesh::default();
        self.file.below(node, &mut |node, place| {
            let Some(mesh) = node.mesh.and_then(|mesh| self.meshes.get(&mesh)) else {
                return;
            };
            let first = all.vertices.len() as u32;
            let moved = mesh.vertices.iter().map(|v| place.transform_point3(*v));
            all.vertices.extend(moved);
            let triangles = mesh.triangles.iter().map(|t| t.map(|i| i + first));
            all.triangles.extend(triangles);
        });
        all
    }
}

/// Adds the triangles of a primitive. Points, lines and triangles with indices out of range are left out.
fn add_primitive(mesh: &mut Mesh, primitive: &gltf::Primitive, buffers: &[Vec<u8>]) {
    let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
    let Some(positions) = reader.read_positions() else {
        return;
    };
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend(positions.map(Vec3::from_array));
    let count = mesh.vertices.len() as u32 - first;
    let order: Vec<u32> = match reader.read_indices() {
        Some(indices) => indices.into_u32().collect(),
        None => (0..count).collect(),
    };
    let corners: Vec<[u32; 3]> = match primitive.mode() {
        Mode::Triangles => order.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        Mode::TriangleStrip => order
            .windows(3)
            .enumerate()
            .map(|(i, t)| {
                if i % 2 == 0 {
                    [t[0], t[1], t[2]]
                } else {
                    [t[1], t[0], t[2]]
                }
            })
            .collect(),
        Mode::TriangleFan => order
            .windows(2)
            .skip(1)
            .map(|t| [order[0], t[0], t[1]])
            .collect(),
        _ => Vec::new(),
    };
    let right = corners
        .into_iter()
        .filter(|t| t.iter().all(|i| *i < count))
        .map(|t| t.map(|i| i + first));
    mesh.triangles.extend(right);
}
