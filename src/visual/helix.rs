//! The mesh of a coil: a round tube along a helix about +Y, from the origin to `length`.

use bevy::asset::RenderAssetUsages;
use bevy::math::{FloatExt, Vec2, Vec3};
use bevy::mesh::{Indices, Mesh, PrimitiveTopology};
use std::f32::consts::TAU;

/// Segments of the tube per turn, and around the wire.
const ALONG: f32 = 28.0;
const AROUND: u32 = 12;
/// Turns at each end that lie flat, wire on wire.
const DEAD: f32 = 1.0;

/// The centre line of the wire.
struct Winding {
    radius: f32,
    wire_radius: f32,
    turns: f32,
    length: f32,
}

impl Winding {
    /// Height at a turn: flat coils at the ends, steady pitch between.
    fn height(&self, turn: f32) -> f32 {
        let (low, high) = (self.wire_radius, self.length - self.wire_radius);
        // Dead coils touch each other, and never take more than a quarter of the length each.
        let dead = DEAD.min(self.turns / 4.0);
        let rise = (2.0 * self.wire_radius * dead).min(0.25 * (high - low));
        let active = self.turns - 2.0 * dead;
        if turn < dead {
            low + rise * turn / dead
        } else if turn > self.turns - dead {
            high - rise * (self.turns - turn) / dead
        } else {
            (low + rise).lerp(high - rise, (turn - dead) / active)
        }
    }

    fn center(&self, turn: f32) -> Vec3 {
        let (sin, cos) = (TAU * turn).sin_cos();
        Vec3::new(self.radius * cos, self.height(turn), self.radius * sin)
    }

    /// Along the wire; by central difference, which rounds the corners of the pitch.
    fn tangent(&self, turn: f32) -> Vec3 {
        let step = 0.5 / ALONG;
        let (a, b) = ((turn - step).max(0.0), (turn + step).min(self.turns));
        (self.center(b) - self.center(a)).normalize_or(Vec3::Z)
    }
}

/// A coil of round wire with capped ends; its section is perpendicular to the wire.
pub(super) fn mesh(radius: f32, wire_radius: f32, turns: f32, length: f32) -> Mesh {
    let winding = Winding {
        radius,
        wire_radius,
        turns,
        length: length.max(4.0 * wire_radius),
    };
    let rings = (turns * ALONG).ceil().max(2.0) as u32;
    let mut positions = Vec::new();
    let mut normals = Vec::new();
    let mut uvs = Vec::new();
    let mut indices = Vec::new();

    for ring in 0..=rings {
        let along = ring as f32 / rings as f32;
        let turn = along * turns;
        let (center, tangent) = (winding.center(turn), winding.tangent(turn));
        // Outward from the axis, made perpendicular to the wire.
        let outward = Vec3::new(center.x, 0.0, center.z);
        let outward = outward
            .reject_from_normalized(tangent)
            .normalize_or(Vec3::X);
        let side = tangent.cross(outward);
        for step in 0..=AROUND {
            let around = step as f32 / AROUND as f32;
            let (sin, cos) = (TAU * around).sin_cos();
            let normal = cos * outward + sin * side;
            positions.push(center + wire_radius * normal);
            normals.push(normal);
            uvs.push(Vec2::new(along, around));
        }
    }
    let row = AROUND + 1;
    for ring in 0..rings {
        for step in 0..AROUND {
            let a = ring * row + step;
            let b = a + row;
            indices.extend([a, a + 1, b, a + 1, b + 1, b]);
        }
    }
    for (turn, first, flip) in [(0.0, 0, true), (turns, rings * row, false)] {
        let tangent = winding.tangent(turn);
        let normal = if flip { -tangent } else { tangent };
        let center = positions.len() as u32;
        positions.push(winding.center(turn));
        normals.push(normal);
        uvs.push(Vec2::splat(0.5));
        for step in 0..=AROUND {
            positions.push(positions[(first + step) as usize]);
            normals.push(normal);
            uvs.push(Vec2::splat(0.5));
        }
        for step in 0..AROUND {
            let (a, b) = (center + 1 + step, center + 2 + step);
            indices.extend(if flip { [center, b, a] } else { [center, a, b] });
        }
    }
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_indices(Indices::U32(indices))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Vec3Swizzles;
    use bevy::mesh::VertexAttributeValues;

    fn vectors(mesh: &Mesh, attribute: bevy::mesh::MeshVertexAttribute) -> Vec<Vec3> {
        match mesh.attribute(attribute) {
            Some(VertexAttributeValues::Float32x3(v)) => v.iter().map(|p| Vec3::from(*p)).collect(),
            _ => panic!("three floats a vertex"),
        }
    }

    #[test]
    fn a_coil_reaches_from_end_to_end_and_no_further() {
        for (radius, wire, turns, length) in [
            (0.13, 0.016, 8.0, 1.0),
            (1.0, 0.3, 3.5, 4.0),
            (0.5, 0.01, 1.0, 0.2),
        ] {
            let mesh = mesh(radius, wire, turns, length);
            let positions = vectors(&mesh, Mesh::ATTRIBUTE_POSITION);
            let low = positions.iter().map(|p| p.y).fold(f32::MAX, f32::min);
            let high = positions.iter().map(|p| p.y).fold(f32::MIN, f32::max);
            let wide = positions
                .iter()
                .map(|p| p.xz().length())
                .fold(0.0, f32::max);
            assert!(
                low.abs() < 0.02 * wire && (high - length).abs() < 0.02 * wire,
                "{low} {high}"
            );
            assert!((wide - radius - wire).abs() < 1e-3 * radius, "{wide}");
        }
    }

    #[test]
    fn faces_turn_outward_and_normals_have_unit_length() {
        let mesh = mesh(0.13, 0.016, 8.0, 1.0);
        let positions = vectors(&mesh, Mesh::ATTRIBUTE_POSITION);
        let normals = vectors(&mesh, Mesh::ATTRIBUTE_NORMAL);
        assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
        let Some(Indices::U32(indices)) = mesh.indices() else {
            panic!("32-bit indices")
        };
        for t in indices.chunks(3) {
            let [a, b, c] = [0, 1, 2].map(|i| positions[t[i] as usize]);
            let face = (b - a).cross(c - a);
            let mean: Vec3 = [0, 1, 2].map(|i| normals[t[i] as usize]).iter().sum();
            assert!(face.dot(mean) > 0.0, "{t:?}");
        }
    }

    #[test]
    fn volume_is_that_of_the_wire() {
        let (radius, wire, turns, length) = (0.13, 0.016, 8.0, 1.0);
        let mesh = mesh(radius, wire, turns, length);
        let positions = vectors(&mesh, Mesh::ATTRIBUTE_POSITION);
        let Some(Indices::U32(indices)) = mesh.indices() else {
            panic!("32-bit indices")
        };
        let volume: f32 = indices
            .chunks(3)
            .map(|t| {
                let [a, b, c] = [0, 1, 2].map(|i| positions[t[i] as usize]);
                a.cross(b).dot(c) / 6.0
            })
            .sum();
        let winding = Winding {
            radius,
            wire_radius: wire,
            turns,
            length,
        };
        let steps = 4000;
        let wire_length: f32 = (0..steps)
            .map(|i| {
                let at = |i: i32| winding.center(turns * i as f32 / steps as f32);
                at(i).distance(at(i + 1))
            })
            .sum();
        // A polygon of twelve sides has 0.955 of the circle's area.
        let section = 0.5 * AROUND as f32 * (TAU / AROUND as f32).sin() * wire * wire;
        assert!(
            (volume / (section * wire_length) - 1.0).abs() < 0.02,
            "{volume}"
        );
    }
}
