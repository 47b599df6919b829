//! The material that keeps a stretched coil's wire round.

use super::helix::{Helix, HelixEnds};
use bevy::asset::io::embedded::EmbeddedAssetRegistry;
use bevy::asset::{Asset, Assets};
use bevy::math::Vec4;
use bevy::pbr::{ExtendedMaterial, MaterialExtension, MaterialPlugin, PbrPlugin, StandardMaterial};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{AsBindGroup, ShaderType};
use bevy::shader::ShaderRef;
use std::path::{Path, PathBuf};

/// A [`StandardMaterial`] for meshes of [`Helix`] that rebuilds the wire on the graphics card. The coil can be scaled
/// along its axis, and its wire stays round, in the picture and in shadows.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_coilover::{Helix, RoundWire, RoundWireMaterial};
/// # fn setup(
/// #     mut commands: Commands,
/// #     mut meshes: ResMut<Assets<Mesh>>,
/// #     mut materials: ResMut<Assets<RoundWireMaterial>>,
/// # ) {
/// let helix = Helix::new(0.5, 0.06, 6.0, 1.0);
/// commands.spawn((
///     Mesh3d(meshes.add(helix)),
///     MeshMaterial3d(materials.add(RoundWireMaterial {
///         base: StandardMaterial::from(Color::srgb(0.8, 0.1, 0.1)),
///         extension: RoundWire { helix },
///     })),
///     Transform::from_scale(Vec3::new(1.0, 2.0, 1.0)),
/// ));
/// # }
/// ```
pub type RoundWireMaterial = ExtendedMaterial<StandardMaterial, RoundWire>;

/// The extension of [`RoundWireMaterial`]: the coil on whose mesh the material is put. It must be the same [`Helix`].
#[derive(Asset, AsBindGroup, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[reflect(Default, Debug, PartialEq, Clone)]
#[uniform(100, RoundWireUniform)]
pub struct RoundWire {
    /// The coil, with the length at which its model is not scaled.
    pub helix: Helix,
}

/// [`RoundWire`] as the shader reads it.
#[derive(ShaderType, Clone, Copy, Debug)]
struct RoundWireUniform {
    shape: Vec4,
    style: Vec4,
}

impl From<&RoundWire> for RoundWireUniform {
    fn from(RoundWire { helix }: &RoundWire) -> Self {
        let hand = helix.handedness.sign();
        let ends = match helix.ends {
            HelixEnds::Open => 0.0,
            HelixEnds::Closed => 1.0,
            HelixEnds::ClosedGround => 2.0,
        };
        Self {
            shape: Vec4::new(helix.radius, helix.wire_radius, helix.turns, helix.length),
            style: Vec4::new(hand, ends, 0.0, 0.0),
        }
    }
}

/// Path of the embedded shader, which is found wherever the binary runs, and its source.
const SHADER: (&str, &str) = crate::compat::ROUND_WIRE;

fn shader() -> ShaderRef {
    ShaderRef::Path(format!("embedded://{}", SHADER.0).into())
}

impl MaterialExtension for RoundWire {
    fn vertex_shader() -> ShaderRef {
        shader()
    }

    fn prepass_vertex_shader() -> ShaderRef {
        shader()
    }

    fn deferred_vertex_shader() -> ShaderRef {
        shader()
    }
}

/// Adds as much of the material as the app can draw; nothing if the app has no assets.
pub(super) fn add(app: &mut App) {
    let Some(embedded) = app.world().get_resource::<EmbeddedAssetRegistry>() else {
        return;
    };
    embedded.insert_asset(
        PathBuf::from(SHADER.0),
        Path::new(SHADER.0),
        SHADER.1.as_bytes(),
    );
    if app.is_plugin_added::<PbrPlugin>() && app.get_sub_app(RenderApp).is_some() {
        app.add_plugins(MaterialPlugin::<RoundWireMaterial>::default());
    } else if !app.world().contains_resource::<Assets<RoundWireMaterial>>() {
        app.init_asset::<RoundWireMaterial>();
    }
}
