//! Draws a rope of three strands along an element.

use super::look::Paint;
use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, Mesh, PrimitiveTopology};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use std::collections::HashMap;
use std::f32::consts::TAU;

/// Draws an element as a rope with this radius and unstretched length, m.
#[derive(Component, Clone, Copy)]
pub struct Rope {
    pub radius: f32,
    pub length: f32,
    pub paint: Paint,
}

/// Length of rope for one turn of a strand, in radii.
const LAY: f32 = 7.0;
const AROUND: u32 = 12;
/// Number of rings in a turn of the strands.
const RINGS: f32 = 10.0;

/// Adds meshes to new ropes. Ropes of the same size share a mesh, ropes of the same paint a material.
pub fn show(
    ropes: Query<(Entity, &Rope), Added<Rope>>,
    mut kept: Local<HashMap<[i32; 2], Handle<Mesh>>>,
    mut paints: Local<HashMap<Paint, Handle<StandardMaterial>>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (entity, rope) in &ropes {
        // The radius to a tenth of a millimetre, the length to a centimetre.
        let size = [rope.radius * 1e4, rope.length * 1e2].map(|size| size.round() as i32);
        let mesh = kept
            .entry(size)
            .or_insert_with(|| meshes.add(laid(rope.radius, rope.length)));
        let material = paints
            .entry(rope.paint)
            .or_insert_with(|| materials.add(rope.paint.material()));
        commands.entity(entity).with_child((
            SpringSkin {
                length: rope.length,
            },
            Mesh3d(mesh.clone()),
            MeshMaterial3d(material.clone()),
        ));
    }
}

/// Returns the mesh of three twisted strands, from the origin upwards.
fn laid(radius: f32, length: f32) -> Mesh {
    let turns = (length / (LAY * radius)).round().max(1.0);
    let rings = (RINGS * turns) as u32;
    let at = |ring: f32, around: f32| {
        let along = ring / rings as f32;
        let angle = TAU * around / AROUND as f32;
        // Deep between two strands, and round on each strand.
        let strand = (1.5 * (angle - TAU * turns * along)).cos().abs();
        let out = radius * (0.72 + 0.28 * strand.sqrt());
        Vec3::new(out * angle.cos(), length * along, out * angle.sin())
    };
    let (mut points, mut normals, mut indices) = (vec![], vec![], vec![]);
    for ring in 0..=rings {
        for around in 0..AROUND {
            let (r, a) = (ring as f32, around as f32);
            let across = at(r, a + 0.5) - at(r, a - 0.5);
            let along = at(r + 0.5, a) - at(r - 0.5, a);
            points.push(at(r, a));
            normals.push(along.cross(across).normalize());
            if ring < rings {
                let next = (around + 1) % AROUND;
                let [a, b] = [around, next].map(|k| ring * AROUND + k);
                let [c, d] = [a + AROUND, b + AROUND];
                indices.extend([a, c, b, b, c, d]);
            }
        }
    }
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, points)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
    .with_inserted_indices(Indices::U32(indices))
}
