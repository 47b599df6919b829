//! The drawn children of an element: spawned when its looks appear or change, gone with them.

use super::coil::Coil;
use super::helix;
use super::telescope::Telescope;
use crate::element::{Spring, SpringDamper};
use bevy::asset::{Assets, Handle};
use bevy::color::{Color, ColorToPacked, LinearRgba};
use bevy::mesh::{Mesh, Mesh3d};
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

/// Which part of an element a drawn child is.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    Coil {
        /// Length of the mesh, m.
        length: f32,
    },
    Tube,
    Rod,
    /// Plates between which the coil sits.
    SeatA,
    SeatB,
}

/// One mesh and one material per shape and paint, so that equal springs are drawn in one batch.
#[derive(Resource, Default)]
pub(super) struct Shapes {
    coils: HashMap<[u32; 4], Handle<Mesh>>,
    cylinder: Option<Handle<Mesh>>,
    paints: HashMap<([u8; 4], u8), Handle<StandardMaterial>>,
}

/// How a surface takes light.
#[derive(Clone, Copy)]
enum Finish {
    Enamel,
    Steel,
}

impl Shapes {
    fn paint(
        &mut self,
        color: Color,
        finish: Finish,
        materials: &mut Assets<StandardMaterial>,
    ) -> Handle<StandardMaterial> {
        let key = (LinearRgba::from(color).to_u8_array(), finish as u8);
        let material = match finish {
            Finish::Enamel => StandardMaterial {
                base_color: color,
                metallic: 0.1,
                perceptual_roughness: 0.35,
                reflectance: 0.6,
                ..default()
            },
            Finish::Steel => StandardMaterial {
                base_color: color,
                metallic: 0.55,
                perceptual_roughness: 0.28,
                reflectance: 0.7,
                ..default()
            },
        };
        self.paints
            .entry(key)
            .or_insert_with(|| materials.add(material))
            .clone()
    }

    fn cylinder(&mut self, meshes: &mut Assets<Mesh>) -> Handle<Mesh> {
        self.cylinder
            .get_or_insert_with(|| {
                meshes.add(Cylinder::new(1.0, 1.0).mesh().resolution(40).build())
            })
            .clone()
    }
}

/// Removes the parts of an element that a test picks.
fn clear(
    element: Entity,
    children: &Query<&Children>,
    parts: &Query<&Part>,
    commands: &mut Commands,
    pick: impl Fn(&Part) -> bool,
) {
    for child in children.get(element).map(|c| &**c).unwrap_or_default() {
        if parts.get(*child).is_ok_and(&pick) {
            commands.entity(*child).despawn();
        }
    }
}

fn is_coil(part: &Part) -> bool {
    matches!(part, Part::Coil { .. } | Part::SeatA | Part::SeatB)
}

fn is_telescope(part: &Part) -> bool {
    matches!(part, Part::Tube | Part::Rod)
}

/// Spawns, renews and removes coils with their seats.
pub(super) fn build_coils(
    changed: Query<(Entity, &Coil, Option<&Spring>, Option<&SpringDamper>), Changed<Coil>>,
    mut removed: RemovedComponents<Coil>,
    children: Query<&Children>,
    parts: Query<&Part>,
    mut shapes: ResMut<Shapes>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for element in removed.read() {
        clear(element, &children, &parts, &mut commands, is_coil);
    }
    for (element, coil, spring, pair) in &changed {
        clear(element, &children, &parts, &mut commands, is_coil);
        if !coil.is_sound() {
            log::warn!(
                "{element}: Coil cannot be wound: radius {} m, wire radius {} m, {} turns; it needs \
                 0 < wire_radius < radius and 0 < turns ≤ 1000",
                coil.radius,
                coil.wire_radius,
                coil.turns
            );
            continue;
        }
        // Wound at its rest length, where the wire is to look round; a guess until that is known.
        let rest = spring
            .and_then(|s| s.rest_length)
            .or_else(|| pair.and_then(|p| p.rest_length));
        let length = rest.filter(|l| *l > 0.0).unwrap_or(7.0 * coil.radius);
        let key = [coil.radius, coil.wire_radius, coil.turns, length].map(f32::to_bits);
        let mesh = shapes
            .coils
            .entry(key)
            .or_insert_with(|| {
                meshes.add(helix::mesh(
                    coil.radius,
                    coil.wire_radius,
                    coil.turns,
                    length,
                ))
            })
            .clone();
        let enamel = shapes.paint(coil.color, Finish::Enamel, &mut materials);
        let steel = shapes.paint(STEEL, Finish::Steel, &mut materials);
        let disc = shapes.cylinder(&mut meshes);
        for (part, mesh, material) in [
            (Part::Coil { length }, mesh, enamel),
            (Part::SeatA, disc.clone(), steel.clone()),
            (Part::SeatB, disc, steel),
        ] {
            spawn(element, part, mesh, material, &mut commands);
        }
    }
}

const STEEL: Color = Color::srgb(0.78, 0.79, 0.82);

/// Spawns, renews and removes tubes and rods.
pub(super) fn build_telescopes(
    changed: Query<(Entity, &Telescope), Changed<Telescope>>,
    mut removed: RemovedComponents<Telescope>,
    children: Query<&Children>,
    parts: Query<&Part>,
    mut shapes: ResMut<Shapes>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for element in removed.read() {
        clear(element, &children, &parts, &mut commands, is_telescope);
    }
    for (element, telescope) in &changed {
        clear(element, &children, &parts, &mut commands, is_telescope);
        if !telescope.is_sound() {
            log::warn!("{element}: Telescope cannot be drawn: its radii must be positive");
            continue;
        }
        let cylinder = shapes.cylinder(&mut meshes);
        let enamel = shapes.paint(telescope.color, Finish::Enamel, &mut materials);
        let steel = shapes.paint(STEEL, Finish::Steel, &mut materials);
        spawn(element, Part::Tube, cylinder.clone(), enamel, &mut commands);
        spawn(element, Part::Rod, cylinder, steel, &mut commands);
    }
}

fn spawn(
    element: Entity,
    part: Part,
    mesh: Handle<Mesh>,
    material: Handle<StandardMaterial>,
    commands: &mut Commands,
) {
    commands.spawn((
        part,
        Mesh3d(mesh),
        MeshMaterial3d(material),
        ChildOf(element),
    ));
}
