//! Draws elements: coils and telescopes between the ends, and spirals of torsion elements.
//!
//! [`parts`] spawns and removes the drawn children of an element with [`made`]. Every frame [`place`] finds where the
//! ends are, with the rotation about the line between them from [`heading`] and the level of detail from [`views`].
//! [`lay`] then places the parts as [`layout`] says. [`helix`] is the mesh of a coil. [`round_wire`] is the material
//! that keeps its wire round when it is stretched. [`shapes`] keeps one mesh and one material for all equal springs.
//! [`twist`] does all of this for the [`spiral`] of a torsion element. [`bodies`] tells in whose frame an axis is.

mod bodies;
mod coil;
mod coilover;
mod fitting;
mod gizmos;
mod heading;
mod helix;
mod lay;
mod layout;
mod made;
mod parts;
mod place;
mod round_wire;
mod shapes;
mod skin;
mod spiral;
mod telescope;
mod torsion_coil;
mod twist;
mod views;

pub use coil::{Coil, WoundCoil};
pub use coilover::{Coilover, coilover};
pub use gizmos::{ShowSpringGizmos, SpringGizmos};
pub use helix::{Handedness, Helix, HelixEnds, HelixError, HelixMeshBuilder};
pub use round_wire::{RoundWire, RoundWireMaterial};
pub use skin::SpringSkin;
pub use telescope::Telescope;
pub use torsion_coil::TorsionCoil;

use crate::plugin::CoiloverSystems;
use bevy::asset::{AssetEventSystems, AssetServer, Assets};
use bevy::camera::visibility::VisibilitySystems;
use bevy::mesh::Mesh;
use bevy::pbr::StandardMaterial;
use bevy::prelude::*;

/// Draws [`Coil`] and [`Telescope`] between the ends of their element, [`TorsionCoil`] on the axis of its element, and
/// [`SpringGizmos`].
///
/// Add it after `DefaultPlugins`. It needs Bevy's assets, meshes and PBR materials. If they are missing, it logs an
/// error once and draws nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct CoiloverVisualPlugin;

/// Marks an app in which looks are drawn.
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct IsDrawn;

/// System set that updates what is drawn. It runs in `PostUpdate` after transform propagation.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CoiloverVisualSystems;

impl Plugin for CoiloverVisualPlugin {
    fn build(&self, app: &mut App) {
        round_wire::add(app);
        gizmos::add(app, CoiloverVisualSystems);
        app.register_type::<Coil>()
            .register_type::<Telescope>()
            .register_type::<SpringSkin>()
            .register_type::<TorsionCoil>()
            .register_type::<ShowSpringGizmos>()
            .register_type::<SpringGizmos>()
            .register_type::<Helix>()
            .register_type::<RoundWire>()
            .register_type::<made::Made>()
            .init_resource::<shapes::Shapes>()
            .init_resource::<twist::Spirals>()
            .insert_resource(IsDrawn)
            .add_systems(PreStartup, say_what_is_missing)
            .configure_sets(
                PostUpdate,
                CoiloverVisualSystems
                    // Only after this, the ends are where they will be drawn, interpolation included.
                    .after(TransformSystems::Propagate)
                    // If physics runs in the same schedule, elements may break there.
                    .after(CoiloverSystems::Readout)
                    .after(VisibilitySystems::UpdateFrusta)
                    .before(VisibilitySystems::VisibilityPropagate)
                    .before(VisibilitySystems::CalculateBounds)
                    // Otherwise a mesh that is new in a frame, such as that of a spiral that turns, is not drawn in it.
                    .before(AssetEventSystems)
                    .run_if(can_draw),
            )
            .add_systems(
                PostUpdate,
                (
                    parts::drop_loaded,
                    parts::take_skins,
                    parts::hide_disabled,
                    parts::build,
                    lay::recall,
                    place::place,
                    lay::lay,
                    lay::carry,
                )
                    .chain()
                    .in_set(CoiloverVisualSystems),
            )
            .add_systems(
                PostUpdate,
                (twist::wind, twist::turn, twist::lay)
                    .chain()
                    .in_set(CoiloverVisualSystems),
            )
            .add_systems(
                PostUpdate,
                parts::hand_on_layers.in_set(CoiloverVisualSystems),
            );
    }
}

fn can_draw(
    meshes: Option<Res<Assets<Mesh>>>,
    materials: Option<Res<Assets<StandardMaterial>>>,
    wires: Option<Res<Assets<RoundWireMaterial>>>,
) -> bool {
    meshes.is_some() && materials.is_some() && wires.is_some()
}

fn say_what_is_missing(
    meshes: Option<Res<Assets<Mesh>>>,
    materials: Option<Res<Assets<StandardMaterial>>>,
    wires: Option<Res<Assets<RoundWireMaterial>>>,
    server: Option<Res<AssetServer>>,
) {
    let missing = match (meshes, materials, wires) {
        (Some(_), Some(_), Some(_)) => return,
        (None, None, _) => "mesh and material assets",
        (None, _, _) => "mesh assets",
        (_, None, _) => "StandardMaterial assets",
        _ if server.is_some() => "AssetPlugin that was added before it",
        _ => "AssetPlugin",
    };
    log::error!(
        "bevy_coilover: CoiloverVisualPlugin finds no {missing}, so nothing is drawn; add DefaultPlugins \
         (or AssetPlugin, MeshPlugin and PbrPlugin) before it, or use CoiloverPlugin alone"
    );
}
