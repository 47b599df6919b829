//! Does the shader keep the wire round, in the picture and in the shadow?

use crate::canvas::*;
use bevy::light::CascadeShadowConfigBuilder;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use std::f32::consts::{FRAC_PI_2, TAU};

const RADIUS: f32 = 0.15;
const WIRE: f32 = 0.03;
const TURNS: f32 = 5.5;
const REST: f32 = 0.7;

/// Rise per turn of the active turns of a coil with closed ends, m.
fn pitch(length: f32) -> f32 {
    // One turn at each end lies flat. Over another half turn, the rise changes from that of the flat turn to that
    // of the active turns.
    (length - 2.0 * WIRE - 2.0 * WIRE * 2.5) / (TURNS - 2.5)
}

/// Thickness of the wire across its direction, from the height of a run where the wire passes in front of the
/// axis. Both in pixels.
fn across(runs: &mut [u32], length: f32, amplitude: f32) -> f32 {
    runs.sort_unstable();
    let middle = runs[runs.len() / 2] as f32;
    let slope = pitch(length) / (TAU * amplitude);
    middle / (1.0 + slope * slope).sqrt()
}

fn spring(world: &mut World, x: f32, length: f32) {
    let foot = Vec3::new(x, -0.8, 0.0);
    let (a, b) = ends(world, foot, foot + Vec3::Y * length);
    world.spawn((
        Spring::new(a, b).with_rest_length(REST),
        Coil::new(RADIUS, WIRE, TURNS)
            .with_ends(HelixEnds::Closed)
            .with_color(Color::srgb(1.0, 0.0, 0.0)),
    ));
}

#[test]
fn the_wire_is_as_thick_at_twice_the_length() {
    let mut widths = Vec::new();
    for stretch in [1.0, 2.0] {
        let length = stretch * REST;
        let Some(picture) = draw(|world| spring(world, 0.0, length)) else {
            return;
        };
        let mut runs = runs(&picture, 0.0, is_red);
        // Each flat turn at an end is one run. Each active turn is two runs: front and back.
        assert!(runs.len() >= 7, "{runs:?}");
        widths.push(across(&mut runs, length, RADIUS));
    }
    println!(
        "wire: {widths:?} px at 1x and 2x, drawn {} px",
        2.0 * WIRE / PIXEL
    );
    assert!((widths[0] - widths[1]).abs() <= 1.0, "{widths:?}");
    assert!((widths[0] - 2.0 * WIRE / PIXEL).abs() <= 1.0, "{widths:?}");
}

#[test]
fn its_shadow_is_as_thick_at_twice_the_length() {
    let mut widths = Vec::new();
    for stretch in [1.0, 2.0] {
        let length = stretch * REST;
        let Some(picture) = draw(|world| {
            spring(world, -0.5, length);
            // A white wall is behind the coil. A light throws the shadow onto it, one metre to the right.
            let wall = world
                .resource_mut::<Assets<Mesh>>()
                .add(Cuboid::new(4.0, 4.0, 0.1));
            let white = world
                .resource_mut::<Assets<StandardMaterial>>()
                .add(StandardMaterial {
                    base_color: Color::WHITE,
                    perceptual_roughness: 1.0,
                    ..default()
                });
            world.spawn((
                Mesh3d(wall),
                MeshMaterial3d(white),
                Transform::from_xyz(0.0, 0.0, -1.05),
            ));
            world.spawn((
                DirectionalLight {
                    illuminance: 6_000.0,
                    shadow_maps_enabled: true,
                    ..default()
                },
                Transform::default().looking_to(Vec3::new(1.0, 0.0, -1.0), Vec3::Y),
                CascadeShadowConfigBuilder {
                    num_cascades: 1,
                    minimum_distance: 0.1,
                    maximum_distance: 8.0,
                    ..default()
                }
                .build(),
            ));
        }) else {
            return;
        };
        // The wall is white. Where the coil shades it, only the ambient light remains.
        let dark = |pixel: [u8; 3]| pixel.into_iter().all(|c| c < 200);
        let mut runs = runs(&picture, 0.5, dark);
        assert!(runs.len() >= 5, "{runs:?}");
        // Seen from the light, the coil has its usual width. The wall stretches the shadow sideways.
        widths.push(across(&mut runs, length, RADIUS * 2.0_f32.sqrt()));
    }
    println!("shadow: {widths:?} px at 1x and 2x");
    assert!((widths[0] - widths[1]).abs() <= 1.0, "{widths:?}");
    assert!((widths[0] - 2.0 * WIRE / PIXEL).abs() <= 2.0, "{widths:?}");
}

#[test]
fn a_coil_that_is_scaled_to_no_length_is_a_ring_and_one_without_size_is_not_drawn() {
    let Some(picture) = draw(|world| {
        let helix = Helix::new(RADIUS, WIRE, TURNS, 1.0).with_ends(HelixEnds::Closed);
        let mesh = world.resource_mut::<Assets<Mesh>>().add(helix);
        let wire = RoundWireMaterial {
            base: StandardMaterial::from(Color::srgb(1.0, 0.0, 0.0)),
            extension: RoundWire { helix },
        };
        let wire = world.resource_mut::<Assets<RoundWireMaterial>>().add(wire);
        // Its axis points at the camera.
        let ahead = Transform::from_rotation(Quat::from_rotation_x(FRAC_PI_2));
        for scale in [Vec3::new(1.0, 0.0, 1.0), Vec3::Y, Vec3::ZERO] {
            world.spawn((
                Mesh3d(mesh.clone()),
                MeshMaterial3d(wire.clone()),
                ahead.with_scale(scale),
            ));
        }
    }) else {
        return;
    };
    let ring = extent(&picture, |pixel, _| is_red(pixel));
    let outer = RADIUS + WIRE;
    for (side, name) in [
        (-ring.low.x, "left"),
        (ring.high.x, "right"),
        (-ring.low.y, "low"),
        (ring.high.y, "high"),
    ] {
        assert!((side - outer).abs() < 2.0 * PIXEL, "{name}: {side} m");
    }
    let inside = extent(&picture, |pixel, p| {
        is_drawn(pixel) && p.length() < RADIUS - 1.5 * WIRE
    });
    assert_eq!(inside.count, 0, "a ring is hollow");
}
