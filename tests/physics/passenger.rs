//! Does a load that lies on a sprung platform swing with it?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const PLATFORM: f32 = 10.0;
const LOAD: f32 = 2.0;

/// Releases a platform at `lift` above its rest position. Returns ω·dt and the heights of its first four swings as
/// fractions of `lift`.
fn swings(stiffness: f32, lift: f32, loaded: bool) -> (f32, Vec<f32>) {
    let mut lab = Lab::new();
    let mass = PLATFORM + if loaded { LOAD } else { 0.0 };
    let rest = -mass * GRAVITY as f32 / stiffness;
    let platform = lab.spawn((
        RigidBody::Dynamic,
        Transform::from_xyz(0.0, rest + lift, 0.0),
        Collider::cuboid(0.5, 0.1, 0.5),
        ColliderMassProperties::Mass(PLATFORM),
        LockedAxes::ROTATION_LOCKED
            | LockedAxes::TRANSLATION_LOCKED_X
            | LockedAxes::TRANSLATION_LOCKED_Z,
        Velocity::default(),
    ));
    if loaded {
        lab.spawn((
            RigidBody::Dynamic,
            Transform::from_xyz(0.0, rest + lift + 0.3, 0.0),
            Collider::cuboid(0.2, 0.2, 0.2),
            ColliderMassProperties::Mass(LOAD),
        ));
    }
    let hook = lab.point(Vec3::Y * 2.0);
    lab.spawn(
        Spring::new(hook, platform)
            .with_stiffness(stiffness)
            .with_rest_length(2.0),
    );
    let omega = (stiffness / mass).sqrt();
    let period = std::f64::consts::TAU / f64::from(omega);
    let mut swings = Vec::new();
    let mut time = 0.0;
    for swing in 1..=4 {
        let mut highest = f32::MIN;
        while time < f64::from(swing) * period {
            lab.tick();
            time += lab.dt();
            highest = highest.max(lab.position(platform).y - rest);
        }
        swings.push(highest / lift);
    }
    (omega * DT, swings)
}

#[test]
fn a_load_on_a_sprung_platform_swings_with_it() {
    for (stiffness, lift) in [
        (500.0, 0.03),
        (2000.0, 0.02),
        (3000.0, 0.01),
        (8000.0, 0.005),
    ] {
        let (_, bare) = swings(stiffness, lift, false);
        let (phase, loaded) = swings(stiffness, lift, true);
        println!(
            "ω·dt {phase:.2}: heights of the swings without a load {bare:.3?}, with one {loaded:.3?}"
        );
        // The top of a swing can lie between two ticks.
        assert!(bare.iter().all(|height| (0.97..1.001).contains(height)));
        for (n, height) in (1..).zip(&loaded) {
            // A force that is constant over the step would add a damping ratio of ω·dt/16 in the engine's four substeps. The
            // bound allows ω·dt/35.
            let least = (-std::f32::consts::TAU * n as f32 * phase / 35.0).exp();
            assert!(
                (least..1.001).contains(height),
                "ω·dt {phase}, swing {n}: {height} of the first, at least {least}"
            );
        }
    }
}
