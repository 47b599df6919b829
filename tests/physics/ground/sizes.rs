//! Loads of any mass and size at rest on the ground.

use super::scenes::*;
use super::stand::*;
use crate::harness::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f32::consts::TAU;

/// A load with a natural frequency in Hz over a foot of a tenth of its mass, `size` across.
fn footed(load: f32, size: f32, frequency: f32) -> Footed {
    let (omega, half) = (TAU * frequency, 0.5 * size);
    Footed {
        load,
        foot: 0.1 * load,
        collider: Collider::cuboid(half, half, half),
        reach: half,
        law: [load * omega * omega, 2.0 * 0.3 * load * omega],
        // Room for a sag of 6 cm however small the foot is.
        rest: size + 0.1,
        drop: 0.0,
        ..Footed::foot()
    }
}

#[test]
fn from_a_gram_to_ten_tonnes_and_from_millimetres_to_half_a_kilometre_it_stands_still() {
    for frequency in [2.0, 10.0] {
        for load in [1e-3, 0.1, 10.0, 1e3, 1e4] {
            for size in [0.005, 0.05, 0.5, 5.0, 50.0, 500.0] {
                let setup = footed(load, size, frequency);
                let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
                scene.ground();
                let placed = setup.put(&mut scene);
                scene.lab.run(15.0);
                let (sag, wanted) = (setup.sag_now(&scene), setup.sag());
                let awake = scene.awake();
                // Resolution of an f32 at the height of the load, m.
                let ulp = f64::from(scene.lab.position(placed.above).y * f32::EPSILON);
                let wander = scene.wander(2.0);
                println!(
                    "{load} kg, {size} m, {frequency} Hz: sag × {:.5} (a place is known to {:.1e} of it), wanders {wander:.1e} m, {awake} awake",
                    sag / wanted,
                    ulp / wanted
                );
                assert!(
                    (sag - wanted).abs() < 0.01 * wanted + 2.0 * ulp,
                    "{load} kg, {size} m, {frequency} Hz: {}",
                    sag / wanted
                );
                assert_eq!(awake, 0, "{load} kg, {size} m, {frequency} Hz: it sleeps");
            }
        }
    }
}
