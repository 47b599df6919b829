//! What a loaded scene carries into the world: Rapier's components cannot be in a scene, since they do not reflect, and
//! they depend on where the scene is placed.

use super::physics::{Implicit, JointKind, Material, Motion};
use bevy::prelude::*;
use std::sync::Arc;

/// A body that is to be.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(opaque, Component, Clone, Debug)]
#[type_path = "bevy_coilover"]
pub(crate) struct LoadedBody(pub(super) Arc<Motion>);

/// Triangles of a collider.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub(super) vertices: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Geometry of a collider, in its node's space.
#[derive(Clone, Debug)]
pub(super) enum Shape {
    Implicit(Implicit),
    Mesh { mesh: Arc<Mesh>, hull: bool },
}

/// A collider that is to be.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(opaque, Component, Clone, Debug)]
#[type_path = "bevy_coilover"]
pub(crate) struct LoadedCollider {
    pub(super) shape: Shape,
    pub(super) material: Option<Material>,
    /// Memberships and filters, as bits.
    pub(super) groups: Option<(u32, u32)>,
    pub(super) trigger: bool,
    /// File and node, for messages.
    pub(super) place: String,
}

/// A joint that is to be, from its own node to another.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(opaque, Component, Clone, Debug)]
#[type_path = "bevy_coilover"]
pub(crate) struct LoadedJoint {
    #[entities]
    pub(super) connected: Entity,
    pub(super) kind: Arc<JointKind>,
    pub(super) collide: bool,
    /// File and node, for messages.
    pub(super) place: String,
}
