//! Do bodies fall correctly beside sprung bodies, and with a spring and damper that exert no force?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// Error of the engine, m: with substeps of size h, it falls g t h/2 too far, plus rounding.
fn engine_error(t: f64, iterations: usize) -> f64 {
    0.5 * GRAVITY * t * f64::from(DT) / iterations as f64
}

#[test]
fn a_body_beside_a_sprung_one_falls_as_the_engine_lets_it() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::ZERO);
    let sprung = lab.body(1.0, Vec3::NEG_Y);
    let falling = lab.body(1.0, Vec3::X);
    lab.spawn(Spring::new(hook, sprung).with_stiffness(50.0));
    for i in 1..=60 {
        lab.tick();
        let t = f64::from(i) * f64::from(DT);
        let fallen = -f64::from(lab.position(falling).y);
        let error = fallen - 0.5 * GRAVITY * t * t;
        assert!(
            (error - engine_error(t, 4)).abs() < 1e-5,
            "t {t}: {error:e}"
        );
    }
}

#[test]
fn a_body_with_a_slack_spring_and_damper_falls_exactly() {
    // Both ends fall alike, so the spring and the damper exert no force. The crate's own integrator moves bodies
    // with elements. Its only error in free fall is the rounding of f32.
    let mut lab = Lab::new();
    let a = lab.body(1.0, Vec3::ZERO);
    let b = lab.body(3.0, Vec3::X);
    lab.spawn(
        SpringDamper::new(a, b)
            .with_stiffness(100.0)
            .with_damping(5.0),
    );
    for i in 1..=60 {
        lab.tick();
        let t = f64::from(i) * f64::from(DT);
        for body in [a, b] {
            let error = -f64::from(lab.position(body).y) - 0.5 * GRAVITY * t * t;
            assert!(error.abs() < 1e-5, "t {t}: {error:e}");
        }
    }
    let dx = lab.position(b).x - lab.position(a).x;
    assert!((dx - 1.0).abs() < 1e-6);
}
