//! Parameters that people think in.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f32::consts::TAU;

#[test]
fn a_frequency_becomes_stiffness_and_damping_once_and_stays() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let body = lab.body(3.0, Vec3::Y * 4.0);
    let element = lab.spawn((
        SpringDamper::new(hook, body).with_rest_length(1.0),
        SpringTuning::frequency(2.0, 0.25),
    ));
    lab.tick();
    let pair = *lab.get::<SpringDamper>(element);
    let omega = TAU * 2.0;
    assert!(
        (pair.stiffness - 3.0 * omega * omega).abs() < 1e-2,
        "{pair:?}"
    );
    assert!(
        (pair.damping - 2.0 * 0.25 * 3.0 * omega).abs() < 1e-3,
        "{pair:?}"
    );
    assert!(lab.app.world().get::<SpringTuning>(element).is_none());
    // From the first step on.
    assert!((lab.readout(element).omega_dt - omega * DT).abs() < 1e-4);
    // A heavier body does not make it another spring.
    lab.app
        .world_mut()
        .entity_mut(body)
        .insert(AdditionalMassProperties::Mass(30.0));
    lab.run(1.0);
    assert_eq!(*lab.get::<SpringDamper>(element), pair);
}

#[test]
fn a_sag_is_the_sag() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let body = lab.body(3.0, Vec3::Y * 4.0);
    let element = lab.spawn((
        SpringDamper::new(hook, body).with_rest_length(1.0),
        SpringTuning::sag(0.12, 1.0),
    ));
    lab.run(4.0);
    let length = lab.readout(element).length;
    assert!((length - 1.12).abs() < 1e-4, "{length}");
}

#[test]
fn two_free_bodies_are_tuned_by_their_effective_mass() {
    let mut lab = Lab::weightless();
    let a = lab.body(2.0, Vec3::ZERO);
    let b = lab.body(6.0, Vec3::X);
    let element = lab.spawn((Spring::new(a, b), SpringTuning::frequency(1.0, 0.0)));
    lab.tick();
    let stiffness = lab.get::<Spring>(element).stiffness;
    assert!((stiffness - 1.5 * TAU * TAU).abs() < 1e-3, "{stiffness}");
}

#[test]
fn wire_and_coil_give_the_stiffness_of_the_handbook() {
    // 12 mm wire, 100 mm coil, 6 turns of steel.
    let stiffness = bevy_coilover::wire_stiffness(0.012, 0.1, 6.0, 79.3e9);
    assert!((stiffness - 34_257.6).abs() < 1.0, "{stiffness}");
}
