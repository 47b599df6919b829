//! Components that a loaded scene carries into the world in place of Rapier's components. Rapier's components cannot
//! be in a scene: they do not implement `Reflect`, and they depend on where the scene is placed.
//!
//! Each has the index of its node in the file. Entities of a spawned scene are in no particular order, and in another one
//! when the scene is spawned again.

use super::physics::{Implicit, JointKind, Material, Motion};
use bevy::prelude::*;
use std::sync::Arc;

/// Marks a node that becomes a rigid body.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(opaque, Component, Clone, Debug)]
#[type_path = "bevy_coilover"]
pub(crate) struct LoadedBody {
    /// Index of the node in the file.
    pub(super) node: usize,
    pub(super) motion: Arc<Motion>,
    /// File and node, for log messages.
    pub(super) place: String,
}

/// Marks a node where an element ends that acts in the frame of a body. If the node belongs to no body, it gets a fixed
/// one.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(opaque, Component, Clone, Debug)]
#[type_path = "bevy_coilover"]
pub(crate) struct LoadedEnd {
    /// Index of the node in the file.
    pub(super) node: usize,
}

/// Triangle mesh of a collider.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub(super) vertices: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Geometry of a collider, in the space of its node.
#[derive(Clone, Debug)]
pub(super) enum Shape {
    Implicit(Implicit),
    Mesh { mesh: Arc<Mesh>, hull: bool },
}

/// Marks a node that gets a collider.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(opaque, Component, Clone, Debug)]
#[type_path = "bevy_coilover"]
pub(crate) struct LoadedCollider {
    /// Index of the node in the file.
    pub(super) node: usize,
    pub(super) shape: Shape,
    pub(super) material: Option<Material>,
    /// Memberships and filters of the `CollisionGroups`, as bits. `None` if the file has no filters.
    pub(super) groups: Option<(u32, u32)>,
    pub(super) trigger: bool,
    /// File and node, for log messages.
    pub(super) place: String,
}

/// Marks a node that a joint connects to another node.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(opaque, Component, Clone, Debug)]
#[type_path = "bevy_coilover"]
pub(crate) struct LoadedJoint {
    /// Index of the node in the file.
    pub(super) node: usize,
    #[entities]
    pub(super) connected: Entity,
    pub(super) kind: Arc<JointKind>,
    pub(super) collide: bool,
    /// File and node, for log messages.
    pub(super) place: String,
}
