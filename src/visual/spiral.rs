//! Mesh of the strip of a spiral spring: about the Y axis, with its outer end on the X axis.

use super::torsion_coil::TorsionCoil;
use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, Mesh, PrimitiveTopology};
use bevy::prelude::*;
use std::f32::consts::TAU;

/// Number of segments per turn.
const SEGMENTS: f32 = 40.0;
/// Number of turns that are left, however far the spring is unwound; half of them if it has fewer than twice as many.
const LEAST_TURNS: f32 = 0.25;

/// Number of twist steps in a full turn: meshes are made for whole degrees.
const STEPS: f32 = 360.0;

/// Twist from rest in whole steps, positive if it winds the spring up. Further twist than can be drawn is the same step, so that a
/// wheel which turns on needs no more meshes.
pub(super) fn step(coil: &TorsionCoil, twist: f32) -> i32 {
    let turns = drawn(coil, coil.turns + twist / TAU);
    ((turns - coil.turns) * STEPS).round() as i32
}

/// The number of turns that is drawn for a number of turns.
fn drawn(coil: &TorsionCoil, turns: f32) -> f32 {
    let least = LEAST_TURNS.min(0.5 * coil.turns);
    turns.clamp(least, 2.0 * coil.turns + 1.0)
}

/// The angle of the strip from end to end, rad.
fn angle(coil: &TorsionCoil, step: i32) -> f32 {
    TAU * drawn(coil, coil.turns + step as f32 / STEPS)
}

/// 1 if the strip goes outwards by the right-hand rule about the axis, else −1.
pub(super) fn hand(coil: &TorsionCoil) -> f32 {
    coil.handedness.sign()
}

/// Mesh of the strip at a twist step.
pub(super) fn mesh(coil: &TorsionCoil, step: i32) -> Mesh {
    let hand = hand(coil);
    let whole = angle(coil, step);
    let count = ((whole / TAU * SEGMENTS).ceil() as u32).max(1);
    let room = coil.radius - coil.arbor_radius;
    let mut strip = Strip::default();
    for i in 0..=count {
        // Share of the way from the inner end to the outer end.
        let share = i as f32 / count as f32;
        let radius = coil.arbor_radius + room * share;
        let turned = -hand * whole * (1.0 - share);
        let (sine, cosine) = turned.sin_cos();
        // A positive rotation about Y goes from X towards −Z.
        let outward = Vec3::new(cosine, 0.0, -sine);
        let round = Vec3::new(-sine, 0.0, -cosine);
        // Across the strip, which goes outwards more than around where it has few turns.
        let across = (whole * radius * outward - hand * room * round).normalize();
        strip.ring(radius * outward, across, coil);
        if i > 0 {
            strip.sides();
        }
    }
    strip.caps(hand);
    strip.mesh()
}

/// Number of corners of the rectangular section. Each corner starts a face: outer side, top, inner side, bottom.
const SIDES: usize = 4;
const VERTICES: u32 = 2 * SIDES as u32;

#[derive(Default)]
struct Strip {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    indices: Vec<u32>,
}

impl Strip {
    /// Adds the section at one place of the strip. `outward` is across the strip, away from the axis.
    fn ring(&mut self, middle: Vec3, outward: Vec3, coil: &TorsionCoil) {
        let (thick, wide) = (0.5 * coil.thickness * outward, 0.5 * coil.width * Vec3::Y);
        let corners = [
            middle + thick - wide,
            middle + thick + wide,
            middle - thick + wide,
            middle - thick - wide,
        ];
        let normals = [outward, Vec3::Y, -outward, Vec3::NEG_Y];
        for (side, normal) in normals.into_iter().enumerate() {
            for corner in [corners[side], corners[(side + 1) % SIDES]] {
                self.positions.push(corner);
                self.normals.push(normal);
                self.uvs.push(Vec2::ZERO);
            }
        }
    }

    /// Adds the faces between the last two sections.
    fn sides(&mut self) {
        let here = self.positions.len() as u32 - VERTICES;
        let before = here - VERTICES;
        for side in (0..VERTICES).step_by(2) {
            let corners = [
                before + side,
                before + side + 1,
                here + side + 1,
                here + side,
            ];
            self.face(corners);
        }
    }

    /// Adds the faces that close both ends.
    fn caps(&mut self, hand: f32) {
        let last = self.positions.len() as u32 - VERTICES;
        for (ring, end) in [(0, -1.0), (last, 1.0)] {
            let first = self.positions.len() as u32;
            let outward = self.normals[ring as usize];
            let normal = end * hand * Vec3::Y.cross(outward);
            for side in (0..VERTICES).step_by(2) {
                self.positions.push(self.positions[(ring + side) as usize]);
                self.normals.push(normal);
                self.uvs.push(Vec2::ZERO);
            }
            self.face([first, first + 1, first + 2, first + 3]);
        }
    }

    /// Adds two triangles that face the same way as the normal.
    fn face(&mut self, [a, b, c, d]: [u32; 4]) {
        let at = |i: u32| self.positions[i as usize];
        let faced = (at(b) - at(a)).cross(at(c) - at(a));
        let corners = if faced.dot(self.normals[a as usize]) >= 0.0 {
            [a, b, c, a, c, d]
        } else {
            [a, c, b, a, d, c]
        };
        self.indices.extend(corners);
    }

    fn mesh(self) -> Mesh {
        Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::default(),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, self.positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, self.normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, self.uvs)
        .with_inserted_indices(Indices::U32(self.indices))
    }
}

#[cfg(test)]
mod tests {
    use super::super::helix::Handedness;
    use super::*;
    use bevy::mesh::VertexAttributeValues;

    fn positions(mesh: &Mesh) -> Vec<Vec3> {
        match mesh.attribute(Mesh::ATTRIBUTE_POSITION) {
            Some(VertexAttributeValues::Float32x3(all)) => {
                all.iter().copied().map(Vec3::from).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The middle of the strip at its inner and at its outer end.
    fn ends(mesh: &Mesh) -> [Vec3; 2] {
        let all = positions(mesh);
        let rings = all.len() - 2 * SIDES;
        let middle = |ring: &[Vec3]| ring.iter().sum::<Vec3>() / ring.len() as f32;
        let size = VERTICES as usize;
        [middle(&all[..size]), middle(&all[rings - size..rings])]
    }

    #[test]
    fn the_outer_end_stays_on_x_and_the_inner_one_goes_back_by_the_twist() {
        for handedness in [Handedness::Right, Handedness::Left] {
            let coil = TorsionCoil::new(0.2, 3.0).with_handedness(handedness);
            let [rest, outer] = ends(&mesh(&coil, 0));
            assert!(outer.distance(0.2 * Vec3::X) < 1e-6, "{outer}");
            assert!((rest.length() - coil.arbor_radius).abs() < 1e-6);
            let [wound, outer] = ends(&mesh(&coil, 90));
            assert!(outer.distance(0.2 * Vec3::X) < 1e-6, "{outer}");
            let back = Quat::from_rotation_y(-hand(&coil) * TAU / 4.0) * rest;
            assert!(wound.distance(back) < 1e-6, "{wound} is not {back}");
        }
    }

    #[test]
    fn all_faces_look_outwards_whichever_way_it_is_wound() {
        for handedness in [Handedness::Right, Handedness::Left] {
            let coil = TorsionCoil::new(0.2, 3.0).with_handedness(handedness);
            let mesh = mesh(&coil, 17);
            // A closed surface with outward faces has a positive volume: here, that of the strip.
            let volume = volume(&mesh);
            let mean = 0.5 * (coil.radius + coil.arbor_radius);
            let length = TAU * (coil.turns + 17.0 / 360.0) * mean;
            let wanted = length * coil.width * coil.thickness;
            assert!((volume / wanted - 1.0).abs() < 0.01, "{volume} {wanted}");
        }
    }

    /// Volume inside the faces. It is positive if they look outwards.
    fn volume(mesh: &Mesh) -> f32 {
        let all = positions(mesh);
        let Some(Indices::U32(indices)) = mesh.indices() else {
            panic!("indices");
        };
        let pyramids = indices.chunks(3).map(|t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| all[i as usize]);
            a.dot(b.cross(c)) / 6.0
        });
        pyramids.sum()
    }

    #[test]
    fn a_strip_of_less_than_a_quarter_turn_is_as_thick_as_it_should_be_and_meets_both_ends() {
        for (turns, handedness) in [0.001, 0.02, 0.1, 0.2, 0.25]
            .into_iter()
            .flat_map(|turns| [(turns, Handedness::Right), (turns, Handedness::Left)])
        {
            let coil = TorsionCoil::new(0.2, turns).with_handedness(handedness);
            assert_eq!(coil.check(), Ok(()));
            let at_rest = mesh(&coil, 0);
            let [inner, outer] = ends(&at_rest);
            assert!(outer.distance(0.2 * Vec3::X) < 1e-6, "{turns}: {outer}");
            let start = Quat::from_rotation_y(-hand(&coil) * TAU * turns) * Vec3::X;
            let wanted = coil.arbor_radius * start;
            assert!(inner.distance(wanted) < 1e-6, "{turns}: {inner}, {wanted}");

            let room = coil.radius - coil.arbor_radius;
            let steps = (0..1000).map(|i| {
                let radius = coil.arbor_radius + room * (i as f32 + 0.5) / 1000.0;
                room.hypot(TAU * turns * radius) / 1000.0
            });
            let wanted = steps.sum::<f32>() * coil.width * coil.thickness;
            let share = volume(&at_rest) / wanted;
            assert!((share - 1.0).abs() < 0.05, "{turns}: {share}");
        }
    }

    #[test]
    fn the_inner_end_of_a_short_strip_stays_while_it_is_wound_and_unwound_a_little() {
        let coil = TorsionCoil::new(0.2, 0.2);
        let [rest, _] = ends(&mesh(&coil, 0));
        for step in [-30, 30] {
            let [inner, outer] = ends(&mesh(&coil, step));
            assert!(outer.distance(0.2 * Vec3::X) < 1e-6, "{outer}");
            let twist = TAU * step as f32 / STEPS;
            let back = Quat::from_rotation_y(-hand(&coil) * twist) * rest;
            assert!(inner.distance(back) < 1e-6, "{inner} is not {back}");
        }
    }

    #[test]
    fn unwound_beyond_its_turns_a_piece_of_it_is_left() {
        let coil = TorsionCoil::new(0.2, 1.0);
        for step in [-300, -1_000_000, 1_000_000] {
            let mesh = mesh(&coil, step);
            assert!(positions(&mesh).iter().all(|p| p.is_finite()));
            assert!(mesh.count_vertices() < 2_000);
        }
    }
}
