//! Reads springs, bodies and joints from glTF files, and writes them.
//!
//! [`handler`] is called by Bevy's loader. [`nodes`] holds the nodes of a file, and [`geometry`] the triangles of its
//! colliders. [`physics`] and [`element`] (with [`companions`] and [`looks`]) read the JSON through [`json`], which
//! reports errors. Elements go into the scene as components; [`ends`] lists their ends. The components of [`carry`] hold
//! what is meant for Rapier, and [`expand`] passes it on once the scene is in the world, with [`place`], [`shapes`],
//! [`mass`], [`filters`], [`joints`], and [`soft`] for soft limits and drives of joints. [`export`] writes files;
//! [`left_out`] collects what a file cannot hold.

mod carry;
mod companions;
mod element;
mod ends;
mod expand;
mod export;
mod export_element;
mod export_filters;
mod export_joints;
mod export_mass;
mod export_physics;
mod filters;
#[cfg(test)]
mod fuzz;
mod geometry;
mod handler;
mod joints;
mod json;
#[cfg(test)]
mod large;
mod left_out;
#[cfg(feature = "visual")]
mod looks;
mod mass;
mod nodes;
mod number;
mod physics;
mod physics_joint;
mod place;
mod shapes;
mod soft;

pub use export::{ExportedGltf, export_gltf};

use bevy::ecs::entity_disabling::Disabled;
use bevy::gltf::extensions::GltfExtensionHandlers;
use bevy::prelude::*;
use bevy::transform::TransformSystems;

/// Reads springs, bodies, colliders and joints from glTF files: the extensions `BEVY_coilover`,
/// `KHR_physics_rigid_bodies` and `KHR_implicit_shapes`, as `docs/gltf.md` describes.
///
/// It is part of [`CoiloverPlugins`](crate::CoiloverPlugins). If you use only
/// [`CoiloverPlugin`](crate::CoiloverPlugin), add this plugin too, before any file is loaded.
///
/// When a scene is spawned, its springs exist at once. Its bodies, colliders and joints exist by the end of the
/// frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct CoiloverGltfPlugin;

impl Plugin for CoiloverGltfPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<GltfExtensionHandlers>();
        let handlers = app.world().resource::<GltfExtensionHandlers>().0.clone();
        handlers
            .write_blocking()
            .push(Box::new(handler::Handler::default()));
        // A scene that contains an unregistered type does not spawn.
        crate::plugin::register_elements(app);
        app.register_type::<crate::SpringReadout>()
            .register_type::<Disabled>()
            .register_type::<carry::LoadedBody>()
            .register_type::<carry::LoadedCollider>()
            .register_type::<carry::LoadedEnd>()
            .register_type::<carry::LoadedJoint>();
        #[cfg(feature = "visual")]
        app.register_type::<crate::Coil>()
            .register_type::<crate::Telescope>()
            .register_type::<crate::ShowSpringGizmos>();
        app.add_systems(
            PostUpdate,
            expand::expand
                .run_if(expand::any_loaded)
                .after(TransformSystems::Propagate),
        );
    }
}
