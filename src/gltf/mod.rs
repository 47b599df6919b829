//! Springs, bodies and joints from glTF files.
//!
//! [`handler`] takes part in Bevy's loader: [`physics`] and [`element`] (with [`companions`] and [`looks`]) read the JSON
//! through [`json`], which tells what is wrong. Elements go into the scene as components; what Rapier is to have is carried
//! by the components of [`carry`], and [`expand`] gives it to Rapier once the scene stands in the world: [`shapes`],
//! [`mass`], [`filters`], [`joints`], and [`soft`] for what gives in a joint. [`export`] is the way back; [`left_out`] tells
//! what does not go with it.

mod carry;
mod companions;
mod element;
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
mod handler;
mod joints;
mod json;
mod left_out;
#[cfg(feature = "visual")]
mod looks;
mod mass;
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
/// `KHR_physics_rigid_bodies` and `KHR_implicit_shapes`, as `docs/gltf.md` says.
///
/// It is part of [`CoiloverPlugins`](crate::CoiloverPlugins). Beside [`CoiloverPlugin`](crate::CoiloverPlugin) alone, add
/// it before files are loaded.
///
/// In a scene that is spawned, springs are there at once, and bodies, colliders and joints by the end of the frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct CoiloverGltfPlugin;

impl Plugin for CoiloverGltfPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<GltfExtensionHandlers>();
        let handlers = app.world().resource::<GltfExtensionHandlers>().0.clone();
        handlers
            .write_blocking()
            .push(Box::new(handler::Handler::default()));
        // A scene with a type that is not registered does not spawn.
        crate::plugin::register_elements(app);
        app.register_type::<crate::SpringReadout>()
            .register_type::<Disabled>()
            .register_type::<carry::LoadedBody>()
            .register_type::<carry::LoadedCollider>()
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
