//! Turns the formula of the wire into triangles.

use super::wire::Wire;
use super::{Helix, HelixError};
use bevy::asset::RenderAssetUsages;
use bevy::math::{Vec2, Vec3, Vec4};
use bevy::mesh::{Indices, Mesh, MeshBuilder, PrimitiveTopology};
use std::f32::consts::TAU;

/// Builds the mesh of a [`Helix`], as Bevy's mesh builders do for its primitives.
///
/// The mesh has positions, normals, tangents and UVs. U goes from 0 to 1 along the wire, and V from 0 to 1 around it.
/// On the end caps, V is 2 greater at the rim and 4 in the middle. A repeating texture does not show this, but
/// [`RoundWireMaterial`](crate::RoundWireMaterial) uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HelixMeshBuilder {
    /// The coil.
    pub helix: Helix,
    /// Number of segments along the wire, per turn.
    pub along: u32,
    /// Number of segments around the wire, rounded up to a multiple of four, which makes length and radii exact. At most
    /// 1000.
    pub around: u32,
}

/// Most segments along a wire, whatever was asked for.
const MOST_RINGS: f32 = 100_000.0;
/// Most segments around a wire, a multiple of four.
const MOST_AROUND: u32 = 1000;

/// V coordinate on the end caps: `CAP_RIM` plus the share around the wire at the rim, `CAP_MIDDLE` in the middle.
const CAP_RIM: f32 = 2.0;
const CAP_MIDDLE: f32 = 4.0;

impl HelixMeshBuilder {
    /// 48 segments per turn and 32 around the wire.
    pub const fn new(helix: Helix) -> Self {
        Self {
            helix,
            along: 48,
            around: 32,
        }
    }

    /// Sets the number of segments per turn, and around the wire.
    pub const fn resolution(mut self, along: u32, around: u32) -> Self {
        self.along = along;
        self.around = around;
        self
    }

    /// Returns the mesh, or an error if the coil cannot be wound. Logs a warning if the coil is shorter than its solid
    /// length.
    pub fn try_build(&self) -> Result<Mesh, HelixError> {
        self.helix.check()?;
        if self.helix.length < 0.999 * self.helix.solid_length() {
            log::warn!(
                "Helix: length is {} m, but all turns touch at {} m already, so wire passes through wire",
                self.helix.length,
                self.helix.solid_length()
            );
        }
        Ok(self.triangles())
    }

    /// Returns the mesh of a coil that has been checked, without a warning about its length.
    pub(crate) fn triangles(&self) -> Mesh {
        let wire = Wire::new(&self.helix);
        let turns = self.helix.turns;
        let around = self.around.clamp(4, MOST_AROUND).next_multiple_of(4);
        let rings = (turns * self.along.max(3) as f32).ceil();
        let rings = rings.clamp(4.0, MOST_RINGS) as u32;
        let hand = self.helix.handedness.sign();
        let right = hand > 0.0;
        let mut out = Vertices::default();

        for ring in 0..=rings {
            let along = ring as f32 / rings as f32;
            let frame = wire.frame(along * turns);
            for step in 0..=around {
                let angle = step as f32 / around as f32;
                let point = wire.surface(&frame, TAU * angle);
                let tangent = frame.tangent.extend(hand);
                let uv = Vec2::new(along, angle);
                out.push(point.position, point.normal, tangent, uv);
            }
        }
        let row = around + 1;
        for ring in 0..rings {
            for step in 0..around {
                let a = ring * row + step;
                let b = a + row;
                out.face(right, [a, b, a + 1]);
                out.face(right, [b, b + 1, a + 1]);
            }
        }
        for (end, along, first) in [(-1.0, 0.0, 0), (1.0, 1.0, rings * row)] {
            let frame = wire.frame(along * turns);
            let normal = end * frame.tangent;
            let tangent = frame.outward.extend(1.0);
            let center = out.positions.len() as u32;
            let middle = Vec2::new(along, CAP_MIDDLE);
            out.push(wire.middle(&frame), normal, tangent, middle);
            for step in 0..=around {
                let position = out.positions[(first + step) as usize];
                let uv = Vec2::new(along, CAP_RIM + step as f32 / around as f32);
                out.push(position, normal, tangent, uv);
            }
            for step in 0..around {
                let a = center + 1 + step;
                out.face(right == (end < 0.0), [center, a, a + 1]);
            }
        }
        out.mesh()
    }
}

impl MeshBuilder for HelixMeshBuilder {
    /// Returns the mesh. If the coil cannot be wound, logs an error and returns an empty mesh.
    fn build(&self) -> Mesh {
        self.try_build().unwrap_or_else(|wrong| {
            log::error!("Helix: {wrong}; its mesh is empty");
            Vertices::default().mesh()
        })
    }
}

#[derive(Default)]
struct Vertices {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    tangents: Vec<Vec4>,
    uvs: Vec<Vec2>,
    indices: Vec<u32>,
}

impl Vertices {
    fn push(&mut self, position: Vec3, normal: Vec3, tangent: Vec4, uv: Vec2) {
        self.positions.push(position);
        self.normals.push(normal);
        self.tangents.push(tangent);
        self.uvs.push(uv);
    }

    fn face(&mut self, as_is: bool, [a, b, c]: [u32; 3]) {
        self.indices
            .extend(if as_is { [a, b, c] } else { [a, c, b] });
    }

    fn mesh(self) -> Mesh {
        Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::default(),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, self.normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, self.tangents)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, self.uvs)
        .with_inserted_indices(Indices::U32(self.indices))
    }
}
