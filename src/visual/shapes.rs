//! Meshes and materials: one for each shape and paint, so that equal springs are drawn in one batch.

use super::coil::Coil;
use super::helix::{Handedness, Helix, HelixEnds, HelixMeshBuilder};
use super::round_wire::{RoundWire, RoundWireMaterial};
use super::views::FINE_ENOUGH;
use bevy::asset::{Assets, Handle};
use bevy::color::{Color, LinearRgba};
use bevy::mesh::{Mesh, MeshBuilder, Meshable};
use bevy::pbr::StandardMaterial;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use std::sync::Arc;

/// Number of segments per turn and around the wire, from near to far.
const DETAIL: [(u32, u32); FINE_ENOUGH.len() + 1] = [(44, 20), (28, 12), (18, 8), (12, 4)];
/// Number of shapes and paints that are kept before the first search for unused ones.
const KEPT: usize = 64;

/// The meshes of one coil, from near to far.
pub(super) type CoilMeshes = Arc<[Handle<Mesh>; DETAIL.len()]>;

/// Everything about a coil except its length and paint.
type CoilKey = ([u32; 3], HelixEnds, Handedness);
/// A linear colour as bits. Colours brighter than white are not clamped.
type Packed = [u32; 4];

/// How a surface reflects light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Finish {
    /// Paint on metal.
    Enamel,
    /// Ground or plated metal.
    Steel,
    Rubber,
}

impl Finish {
    fn material(self, color: Color) -> StandardMaterial {
        let (metallic, perceptual_roughness, reflectance) = match self {
            Self::Enamel => (0.15, 0.33, 0.6),
            Self::Steel => (0.6, 0.27, 0.7),
            Self::Rubber => (0.0, 0.85, 0.3),
        };
        StandardMaterial {
            base_color: color,
            metallic,
            perceptual_roughness,
            reflectance,
            alpha_mode: if color.alpha() < 1.0 {
                AlphaMode::Blend
            } else {
                AlphaMode::Opaque
            },
            ..default()
        }
    }
}

/// The meshes and materials that have been made so far.
#[derive(Resource)]
pub(super) struct Shapes {
    coils: HashMap<CoilKey, CoilMeshes>,
    wires: HashMap<(CoilKey, Packed), Handle<RoundWireMaterial>>,
    paints: HashMap<(Packed, Finish), Handle<StandardMaterial>>,
    cylinder: Option<Handle<Mesh>>,
    eye: Option<Handle<Mesh>>,
    /// Number of entries at which the next search for unused ones starts.
    room: usize,
}

impl Default for Shapes {
    fn default() -> Self {
        Self {
            coils: HashMap::default(),
            wires: HashMap::default(),
            paints: HashMap::default(),
            cylinder: None,
            eye: None,
            room: KEPT,
        }
    }
}

fn key(coil: &Coil) -> CoilKey {
    let sizes = [coil.radius, coil.wire_radius, coil.turns].map(f32::to_bits);
    (sizes, coil.ends, coil.handedness)
}

fn packed(color: Color) -> Packed {
    LinearRgba::from(color).to_f32_array().map(f32::to_bits)
}

/// The coil of the mesh: one metre high, so that the scale along its axis is the drawn length.
fn unit(coil: &Coil) -> Helix {
    coil.helix(1.0)
}

pub(super) fn is_used<A: Asset>(handle: &Handle<A>) -> bool {
    match handle {
        Handle::Strong(strong) => Arc::strong_count(strong) > 1,
        Handle::Uuid(..) => true,
    }
}

impl Shapes {
    pub fn coil(&mut self, coil: &Coil, meshes: &mut Assets<Mesh>) -> CoilMeshes {
        self.forget_unused();
        self.coils
            .entry(key(coil))
            .or_insert_with(|| {
                Arc::new(DETAIL.map(|(along, around)| {
                    let builder = HelixMeshBuilder::new(unit(coil)).resolution(along, around);
                    meshes.add(builder.triangles())
                }))
            })
            .clone()
    }

    pub fn wire(
        &mut self,
        coil: &Coil,
        materials: &mut Assets<RoundWireMaterial>,
    ) -> Handle<RoundWireMaterial> {
        self.wires
            .entry((key(coil), packed(coil.color)))
            .or_insert_with(|| {
                materials.add(RoundWireMaterial {
                    base: Finish::Enamel.material(coil.color),
                    extension: RoundWire { helix: unit(coil) },
                })
            })
            .clone()
    }

    pub fn paint(
        &mut self,
        color: Color,
        finish: Finish,
        materials: &mut Assets<StandardMaterial>,
    ) -> Handle<StandardMaterial> {
        self.forget_unused();
        self.paints
            .entry((packed(color), finish))
            .or_insert_with(|| materials.add(finish.material(color)))
            .clone()
    }

    /// Cylinder of height 1 m about its middle, with a radius of 1 m.
    pub fn cylinder(&mut self, meshes: &mut Assets<Mesh>) -> Handle<Mesh> {
        self.cylinder
            .get_or_insert_with(|| {
                meshes.add(Cylinder::new(1.0, 1.0).mesh().resolution(40).build())
            })
            .clone()
    }

    /// Ring about the X axis with an outer radius of 1 m.
    pub fn eye(&mut self, meshes: &mut Assets<Mesh>) -> Handle<Mesh> {
        self.eye
            .get_or_insert_with(|| {
                let ring = Torus::new(0.4, 1.0).mesh().build();
                meshes.add(ring.rotated_by(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)))
            })
            .clone()
    }

    /// Removes unused entries when there are many, because a game that changes shapes or paints all the time must not
    /// fill the memory.
    fn forget_unused(&mut self) {
        if self.coils.len() + self.wires.len() + self.paints.len() < self.room {
            return;
        }
        self.coils
            .retain(|_, meshes| Arc::strong_count(meshes) > 1 || meshes.iter().any(is_used));
        self.wires.retain(|_, material| is_used(material));
        self.paints.retain(|_, material| is_used(material));
        self.room = KEPT.max(2 * (self.coils.len() + self.wires.len() + self.paints.len()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paints_are_as_bright_and_as_clear_as_asked_and_old_ones_go() {
        let (mut shapes, mut materials) = (Shapes::default(), Assets::default());
        let mut paint = |color| shapes.paint(color, Finish::Enamel, &mut materials);
        let glowing = paint(Color::linear_rgb(10.0, 2.0, 2.0));
        assert_ne!(glowing, paint(Color::linear_rgb(1.0, 1.0, 1.0)));
        let clear = paint(Color::srgba(1.0, 0.0, 0.0, 0.3));
        for step in 0..1000 {
            paint(Color::srgb(step as f32 / 1000.0, 0.0, 0.0));
        }
        let mode = |paint| materials.get(paint).map(|material| material.alpha_mode);
        assert_eq!(mode(&clear), Some(AlphaMode::Blend));
        assert_eq!(mode(&glowing), Some(AlphaMode::Opaque));
        assert!(shapes.paints.len() <= KEPT + 2, "{}", shapes.paints.len());
    }
}
