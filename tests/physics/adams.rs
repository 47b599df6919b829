//! Project Chrono's validation of its translational spring-damper against MSC Adams.
//!
//! Chrono's own test requires an RMS position error of 1e-4 m. Chrono meets it with a step of 1e-5 s.

use crate::harness::*;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

struct Case {
    file: &'static str,
    ground: Vec3,
    center: Vec3,
    anchor: Vec3,
    rest_length: f32,
    stiffness: f32,
    damping: f32,
    /// Quadratic coefficient of the spring law, N/m².
    quadratic: f32,
}

const CASE_01: Case = Case {
    file: include_str!("../data/tsda_case01.csv"),
    ground: Vec3::ZERO,
    center: Vec3::ZERO,
    anchor: Vec3::ZERO,
    rest_length: 0.0,
    stiffness: 10.0,
    damping: 0.5,
    quadratic: 0.0,
};

/// Case 3 with only the linear part of its law.
const CASE_03: Case = Case {
    file: include_str!("../data/tsda_case03_linear.csv"),
    ground: Vec3::new(1.0, 2.0, 3.0),
    center: Vec3::new(-1.0, 4.0, 3.0),
    anchor: Vec3::new(2.0, 0.0, 0.0),
    rest_length: 2.0,
    stiffness: 50.0,
    damping: 5.0,
    quadratic: 0.0,
};

/// Case 3 with its quadratic law.
const CASE_03_QUADRATIC: Case = Case {
    file: include_str!("../data/tsda_case03.csv"),
    quadratic: 10.0,
    ..CASE_03
};

/// RMS position error over 5 s, m, and largest orientation error, rad.
fn errors(case: &Case, plugin: CoiloverPlugin) -> (f64, f64) {
    let gravity = Vec3::NEG_Z * 9.80665;
    let mut lab = Lab::with(
        plugin,
        Engine {
            gravity,
            ..default()
        },
    );
    let ground = lab.point(case.ground);
    let body = lab.spawn(brick(1.0, Vec3::new(0.04, 0.1, 0.1), case.center));
    let element = lab.spawn((
        SpringDamper::new(ground, body)
            .with_stiffness(case.stiffness)
            .with_damping(case.damping)
            .with_rest_length(case.rest_length),
        Anchors::new(Vec3::ZERO, case.anchor),
    ));
    if case.quadratic > 0.0 {
        let law = SpringLaw::polynomial(case.stiffness, case.quadratic, 0.0);
        lab.app.world_mut().entity_mut(element).insert(law);
    }
    let rows = reference(case.file);
    let (mut square, mut count, mut turned) = (0.0, 0.0, 0.0_f64);
    for row in rows.iter().step_by(4).skip(1) {
        lab.tick();
        let at = lab.get::<Transform>(body);
        let wanted = DVec3::new(row[1], row[2], row[3]);
        square += (at.translation.as_dvec3() - wanted).length_squared();
        count += 1.0;
        let rotation = bevy::math::DQuat::from_xyzw(row[5], row[6], row[7], row[4]);
        let apart = (rotation.inverse() * at.rotation.as_dquat()).xyz().length();
        turned = turned.max(2.0 * apart.min(1.0).asin());
    }
    ((square / count).sqrt(), turned)
}

/// `bars` are the greatest position error, m, and orientation error, rad, with 1, 4 and 16 micro-steps.
fn check(name: &str, case: &Case, bars: [(f64, f64); 3]) {
    for (n, (bar, most_turned)) in [1, 4, 16].into_iter().zip(bars) {
        let (rms, turned) = errors(case, CoiloverPlugin::default().with_microsteps(n));
        println!(
            "{name}, ×{n}: RMS {rms:.1e} m (bar {bar:e}), orientation within {turned:.1e} rad"
        );
        assert!(rms <= bar, "{name} ×{n}: {rms:e} m");
        assert!(turned <= most_turned, "{name} ×{n}: {turned:e} rad");
    }
}

#[test]
fn case_1_zero_length_and_zero_rest_length() {
    // Nothing turns, and a lone element is exact.
    check("Chrono case 1", &CASE_01, [(1e-6, 0.0); 3]);
}

/// The turning is of second order: the error falls with the square of the number of micro-steps.
const TURNING: [(f64, f64); 3] = [(8e-3, 0.3), (5e-4, 2e-2), (3e-5, 1.2e-3)];

#[test]
fn case_3_off_centre_anchor_with_the_linear_law() {
    check("Chrono case 3, linear", &CASE_03, TURNING);
}

#[test]
fn case_3_with_its_quadratic_law() {
    check("Chrono case 3", &CASE_03_QUADRATIC, TURNING);
}
