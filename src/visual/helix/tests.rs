//! Tests that the mesh is a closed tube of round wire, with the length and the radii that were asked for.

use super::*;
use bevy::math::{Vec3Swizzles, Vec4Swizzles};
use bevy::mesh::{Indices, MeshVertexAttribute, VertexAttributeValues};
use std::collections::{HashMap, HashSet};
use std::f32::consts::TAU;

fn vectors(mesh: &Mesh, attribute: MeshVertexAttribute) -> Vec<Vec3> {
    match mesh.attribute(attribute) {
        Some(VertexAttributeValues::Float32x3(v)) => v.iter().map(|p| Vec3::from(*p)).collect(),
        _ => panic!("three floats a vertex"),
    }
}

fn tangents(mesh: &Mesh) -> Vec<Vec4> {
    match mesh.attribute(Mesh::ATTRIBUTE_TANGENT) {
        Some(VertexAttributeValues::Float32x4(v)) => v.iter().map(|p| Vec4::from(*p)).collect(),
        _ => panic!("four floats a vertex"),
    }
}

fn triangles(mesh: &Mesh) -> Vec<[usize; 3]> {
    let Some(Indices::U32(indices)) = mesh.indices() else {
        panic!("32-bit indices")
    };
    let corner = |t: &[u32], i: usize| t[i] as usize;
    indices
        .chunks(3)
        .map(|t| [corner(t, 0), corner(t, 1), corner(t, 2)])
        .collect()
}

fn volume(mesh: &Mesh) -> f64 {
    let positions = vectors(mesh, Mesh::ATTRIBUTE_POSITION);
    let signed = |t: [usize; 3]| {
        let [a, b, c] = t.map(|i| positions[i].as_dvec3());
        a.cross(b).dot(c) / 6.0
    };
    triangles(mesh).into_iter().map(signed).sum()
}

fn all_kinds() -> impl Iterator<Item = Helix> {
    let sizes = [
        (0.13, 0.016, 8.0, 1.0),
        (1.0, 0.3, 3.5, 4.0),
        (0.5, 0.01, 1.0, 0.2),
        (0.2, 0.02, 5.25, 0.5),
    ];
    sizes.into_iter().flat_map(|(radius, wire, turns, length)| {
        let helix = Helix::new(radius, wire, turns, length);
        [HelixEnds::Open, HelixEnds::Closed, HelixEnds::ClosedGround]
            .into_iter()
            .flat_map(move |ends| {
                [Handedness::Right, Handedness::Left]
                    .map(|hand| helix.with_ends(ends).with_handedness(hand))
            })
    })
}

#[test]
fn length_and_radii_are_exact() {
    for helix in all_kinds() {
        let mesh = helix.mesh().build();
        let positions = vectors(&mesh, Mesh::ATTRIBUTE_POSITION);
        let low = positions.iter().map(|p| p.y).fold(f32::MAX, f32::min);
        let high = positions.iter().map(|p| p.y).fold(f32::MIN, f32::max);
        let wide = positions.iter().map(|p| p.xz().length());
        let (least, most) = wide.fold((f32::MAX, 0.0_f32), |(a, b), w| (a.min(w), b.max(w)));
        let close = |a: f32, b: f32| (a - b).abs() < 2e-5 * helix.length;
        assert!(
            close(low, 0.0) && close(high, helix.length),
            "{helix:?}: {low} to {high}"
        );
        assert!(
            close(most, helix.radius + helix.wire_radius),
            "{helix:?}: {most}"
        );
        assert!(
            close(least, helix.radius - helix.wire_radius),
            "{helix:?}: {least}"
        );
    }
}

/// Merges vertices at the same place: rings begin and end on a seam, and caps have normals of their own.
fn welded(mesh: &Mesh) -> (usize, Vec<[usize; 3]>) {
    let positions = vectors(mesh, Mesh::ATTRIBUTE_POSITION);
    let mut known: HashMap<[i64; 3], usize> = HashMap::new();
    let mut same = Vec::new();
    for p in &positions {
        let key = [p.x, p.y, p.z].map(|x| (f64::from(x) * 1e6).round() as i64);
        // Rounding may put equal positions into neighbouring cells.
        let near =
            (-1..=1).flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| [x, y, z])));
        let found = near
            .map(|d| [key[0] + d[0], key[1] + d[1], key[2] + d[2]])
            .find_map(|k| known.get(&k).copied());
        let next = known.len();
        same.push(found.unwrap_or_else(|| *known.entry(key).or_insert(next)));
    }
    let faces = triangles(mesh).into_iter().map(|t| t.map(|i| same[i]));
    (known.len(), faces.collect())
}

#[test]
fn the_tube_is_watertight_and_has_no_handle() {
    for helix in all_kinds() {
        let mesh = helix.mesh().resolution(24, 12).build();
        let (vertices, faces) = welded(&mesh);
        let mut edges: HashMap<(usize, usize), (u32, u32)> = HashMap::new();
        for [a, b, c] in &faces {
            for (from, to) in [(*a, *b), (*b, *c), (*c, *a)] {
                assert_ne!(from, to, "{helix:?}: a triangle without area");
                let way = edges.entry((from.min(to), from.max(to))).or_default();
                *(if from < to { &mut way.0 } else { &mut way.1 }) += 1;
            }
        }
        assert!(
            edges.values().all(|ways| *ways == (1, 1)),
            "{helix:?}: an edge is not shared by exactly two triangles, once each way"
        );
        let euler = vertices as i64 - edges.len() as i64 + faces.len() as i64;
        assert_eq!(euler, 2, "{helix:?}");
        let used: HashSet<usize> = faces.iter().flatten().copied().collect();
        assert_eq!(used.len(), vertices, "{helix:?}: vertices without a face");
    }
}

#[test]
fn the_volume_is_that_of_the_wire() {
    for helix in all_kinds().filter(|h| h.ends != HelixEnds::ClosedGround) {
        let share = volume(&helix.mesh().build()) / f64::from(helix.wire_volume());
        assert!((share - 1.0).abs() < 0.01, "{helix:?}: {share} of the wire");
    }
    // Half a turn at each end is ground off, from half of the section to nothing.
    let ground = Helix::new(0.13, 0.016, 8.0, 1.0);
    let share = volume(&ground.mesh().build()) / f64::from(ground.wire_volume());
    assert!((0.95..0.99).contains(&share), "{share}");
}

#[test]
fn the_wires_length_is_that_of_its_middle() {
    for helix in all_kinds() {
        let wire = Wire::new(&helix);
        let steps = 20_000;
        let at = |i: i32| {
            wire.frame(helix.turns * i as f32 / steps as f32)
                .center
                .as_dvec3()
        };
        let measured: f64 = (0..steps).map(|i| at(i).distance(at(i + 1))).sum();
        let told = f64::from(helix.wire_length());
        assert!(
            (measured / told - 1.0).abs() < 1e-3,
            "{helix:?}: {measured}, told {told}"
        );
    }
}

#[test]
fn faces_and_normals_turn_outward_and_tangents_follow_the_wire() {
    for helix in all_kinds() {
        let mesh = helix.mesh().build();
        let positions = vectors(&mesh, Mesh::ATTRIBUTE_POSITION);
        let normals = vectors(&mesh, Mesh::ATTRIBUTE_NORMAL);
        let tangents = tangents(&mesh);
        for (normal, tangent) in normals.iter().zip(&tangents) {
            assert!((normal.length() - 1.0).abs() < 1e-4);
            assert!((tangent.xyz().length() - 1.0).abs() < 1e-4 && tangent.w.abs() == 1.0);
        }
        assert!(volume(&mesh) > 0.0, "{helix:?}: inside out");
        for t in triangles(&mesh) {
            let [a, b, c] = t.map(|i| positions[i]);
            let face = (b - a).cross(c - a);
            let mean: Vec3 = t.iter().map(|i| normals[*i]).sum();
            assert!(face.dot(mean) > 0.0, "{helix:?} {t:?}");
        }
    }
}

/// This is the same formula as in the shader, tested over all stretches that the shader will see.
#[test]
fn the_section_stays_a_circle_at_any_stretch() {
    for helix in all_kinds().filter(|h| h.ends != HelixEnds::ClosedGround) {
        for stretch in [0.5, 0.7, 1.0, 1.5, 2.0, 3.0] {
            let stretched = Helix {
                length: stretch * helix.length,
                ..helix
            };
            let wire = Wire::new(&stretched);
            for i in 0..=200 {
                let turn = helix.turns * i as f32 / 200.0;
                let frame = wire.frame(turn);
                // Direction of the wire by finite differences: the section is perpendicular to it.
                let step = 1e-3;
                let (before, after) = (wire.frame(turn - step), wire.frame(turn + step));
                let along = (after.center - before.center).normalize();
                if i > 0 && i < 200 {
                    assert!(along.dot(frame.tangent) > 0.9999, "{stretched:?} at {turn}");
                }
                for step in 0..16 {
                    let point = wire.surface(&frame, TAU * step as f32 / 16.0);
                    let from_middle = point.position - frame.center;
                    let error = from_middle.length() / helix.wire_radius - 1.0;
                    assert!(error.abs() < 0.01, "{stretched:?} at {turn}: {error}");
                    assert!(from_middle.dot(frame.tangent).abs() < 0.01 * helix.wire_radius);
                }
            }
        }
    }
}

#[test]
fn closed_ends_keep_their_pitch_while_the_rest_stretches() {
    let helix = Helix::new(0.13, 0.016, 8.0, 0.6).with_ends(HelixEnds::Closed);
    let climb = |length: f32, from: f32, to: f32| {
        let wire = Wire::new(&Helix { length, ..helix });
        wire.frame(to).center.y - wire.frame(from).center.y
    };
    for length in [0.4, 0.6, 1.2, 1.8] {
        assert!((climb(length, 0.0, 1.0) - 0.032).abs() < 1e-5);
        assert!((climb(length, 7.0, 8.0) - 0.032).abs() < 1e-5);
    }
    assert!((climb(1.2, 3.0, 5.0) - climb(0.6, 3.0, 5.0)) > 0.15);
}

#[test]
fn no_valid_coil_has_a_point_that_is_not_a_number() {
    // Random, but the same in every run.
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = |low: f32, high: f32| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        // Uniform in the logarithm.
        let share = (state >> 40) as f32 / (1_u64 << 24) as f32;
        low * (high / low).powf(share)
    };
    for i in 0..400 {
        let radius = random(1e-3, 1e3);
        let helix = Helix {
            radius,
            wire_radius: radius * random(1e-3, 0.999),
            turns: random(0.05, 60.0),
            length: radius * random(1e-4, 1e3),
            ends: [HelixEnds::Open, HelixEnds::Closed, HelixEnds::ClosedGround][i % 3],
            handedness: [Handedness::Right, Handedness::Left][i % 2],
        };
        assert_eq!(helix.check(), Ok(()));
        let mesh = HelixMeshBuilder::new(helix).resolution(12, 8).triangles();
        for attribute in [Mesh::ATTRIBUTE_POSITION, Mesh::ATTRIBUTE_NORMAL] {
            let sound = vectors(&mesh, attribute).iter().all(|p| p.is_finite());
            assert!(sound, "{helix:?}");
        }
        let normals = vectors(&mesh, Mesh::ATTRIBUTE_NORMAL);
        assert!(
            normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3),
            "{helix:?}"
        );
        assert!(tangents(&mesh).iter().all(|t| t.is_finite()), "{helix:?}");
        assert!(helix.wire_length().is_finite(), "{helix:?}");
        let reach = vectors(&mesh, Mesh::ATTRIBUTE_POSITION)
            .iter()
            .map(|p| p.xz().length())
            .fold(0.0, f32::max);
        assert!(
            reach < 1.001 * (helix.radius + helix.wire_radius),
            "{helix:?}: {reach}"
        );
    }
}

#[test]
fn an_impossible_coil_is_an_error_that_names_the_field() {
    let good = Helix::default();
    let told = |helix: Helix| {
        let wrong = helix.mesh().try_build().expect_err("impossible");
        assert!(helix.mesh().build().count_vertices() == 0);
        wrong.to_string()
    };
    assert!(
        told(Helix {
            radius: 0.0,
            ..good
        })
        .contains("radius is 0")
    );
    assert!(
        told(Helix {
            wire_radius: 0.5,
            ..good
        })
        .contains("less than the coil's radius of 0.5 m")
    );
    assert!(
        told(Helix {
            turns: -1.0,
            ..good
        })
        .contains("turns is -1")
    );
    assert!(told(Helix { turns: 1e6, ..good }).contains("at most 1000"));
    assert!(
        told(Helix {
            length: f32::NAN,
            ..good
        })
        .contains("length is NaN")
    );
    assert!(
        told(Helix {
            wire_radius: f32::INFINITY,
            ..good
        })
        .contains("wire_radius is inf")
    );
}

#[test]
fn the_solid_length_is_where_the_turns_touch() {
    for ends in [HelixEnds::Open, HelixEnds::Closed, HelixEnds::ClosedGround] {
        let helix = Helix::new(0.13, 0.016, 8.0, 1.0).with_ends(ends);
        let solid = helix.solid_length();
        let wire = Wire::new(&Helix {
            length: solid,
            ..helix
        });
        let rise = wire.frame(4.5).center.y - wire.frame(3.5).center.y;
        assert!((rise - 0.032).abs() < 0.01 * 0.032, "{ends:?}: {rise}");
    }
}

#[test]
fn any_resolution_gives_a_mesh() {
    let helix = Helix::new(0.5, 0.06, 1.0, 1.0);
    let vertices = |along, around| {
        let mesh = helix.mesh().resolution(along, around).build();
        mesh.count_vertices()
    };
    assert_eq!(vertices(0, u32::MAX), vertices(3, 1000));
    assert_eq!(vertices(0, 0), vertices(3, 4));
}
