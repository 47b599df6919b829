//! What one sees: coils and telescopes between the ends.
//!
//! [`parts`] spawns and removes the drawn children of an element, [`place`] lays them between the ends
//! every frame, [`helix`] and [`telescope`] say what they look like.

mod coil;
mod helix;
mod parts;
mod place;
mod telescope;

pub use coil::Coil;
pub use telescope::Telescope;

use crate::element::{Anchors, SpringDamper};
use bevy::asset::Assets;
use bevy::camera::visibility::VisibilitySystems;
use bevy::mesh::Mesh;
use bevy::pbr::StandardMaterial;
use bevy::prelude::*;

/// Draws [`Coil`] and [`Telescope`] between the ends of their element.
///
/// Needs Bevy's assets, meshes and PBR materials (`DefaultPlugins`); where they are missing it says so
/// once and draws nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct CoiloverVisualPlugin;

/// Updates of what is drawn, in `PostUpdate` after transform propagation.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CoiloverVisualSystems;

impl Plugin for CoiloverVisualPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Coil>()
            .register_type::<Telescope>()
            .init_resource::<parts::Shapes>()
            .add_systems(PreStartup, say_what_is_missing)
            .configure_sets(
                PostUpdate,
                CoiloverVisualSystems
                    // The ends are where they will be drawn only after this; interpolation included.
                    .after(TransformSystems::Propagate)
                    .before(VisibilitySystems::CheckVisibility)
                    .run_if(resource_exists::<Assets<Mesh>>)
                    .run_if(resource_exists::<Assets<StandardMaterial>>),
            )
            .add_systems(
                PostUpdate,
                (parts::build_coils, parts::build_telescopes, place::place)
                    .chain()
                    .in_set(CoiloverVisualSystems),
            );
    }
}

fn say_what_is_missing(
    meshes: Option<Res<Assets<Mesh>>>,
    materials: Option<Res<Assets<StandardMaterial>>>,
) {
    let missing = match (meshes, materials) {
        (Some(_), Some(_)) => return,
        (None, None) => "mesh and material assets",
        (None, _) => "mesh assets",
        (_, None) => "StandardMaterial assets",
    };
    log::error!(
        "bevy_coilover: CoiloverVisualPlugin finds no {missing}, so nothing is drawn; add DefaultPlugins \
         (or AssetPlugin, MeshPlugin and PbrPlugin), or use CoiloverPlugin alone"
    );
}

/// A coil spring around a telescoping damper between two ends: physics and looks.
///
/// A [`SpringDamper`] of 1000 N/m and 60 N s/m whose rest length is the length at the first step, with
/// [`Coil`], [`Telescope`] and centred [`Anchors`]; give your own values by inserting those components
/// after it.
pub fn coilover(body_a: Entity, body_b: Entity) -> impl Bundle {
    (
        SpringDamper::new(body_a, body_b)
            .with_stiffness(1000.0)
            .with_damping(60.0),
        Anchors::default(),
        Coil::default(),
        Telescope::default(),
    )
}
