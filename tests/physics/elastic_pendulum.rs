//! Does a weight on a spring follow the elastic pendulum of the reference solution (DOP853, tolerance 1e-12)?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

const SOFT: (&str, f32, f32) = (include_str!("../data/pendulum_k50.csv"), 50.0, 0.0);
const DAMPED: (&str, f32, f32) = (include_str!("../data/pendulum_k500_c5.csv"), 500.0, 5.0);
const STIFF: (&str, f32, f32) = (include_str!("../data/pendulum_k50000_c100.csv"), 5e4, 100.0);

/// Largest position error over 10 s, m.
fn error((file, stiffness, damping): (&str, f32, f32), plugin: CoiloverPlugin) -> f64 {
    let mut lab = Lab::with(plugin, Engine::default());
    let pivot = lab.point(Vec3::ZERO);
    let weight = lab.body(1.0, Vec3::X);
    lab.spawn(
        SpringDamper::new(pivot, weight)
            .with_stiffness(stiffness)
            .with_damping(damping)
            .with_rest_length(1.0),
    );
    let mut worst = 0.0_f64;
    for row in reference(file).iter().step_by(4).skip(1) {
        lab.tick();
        let p = lab.position(weight).as_dvec3();
        worst = worst.max((p - bevy::math::DVec3::new(row[1], row[2], 0.0)).length());
    }
    worst
}

fn check(name: &str, case: (&str, f32, f32), plugin: CoiloverPlugin, bar: f64) -> f64 {
    let e = error(case, plugin);
    println!(
        "elastic pendulum, {name}: {:.4} mm (bar {} mm)",
        e * 1e3,
        bar * 1e3
    );
    assert!(e <= bar, "{name}: {e:.3e} m, bar {bar:e} m");
    e
}

fn plugin(microsteps: u32) -> CoiloverPlugin {
    CoiloverPlugin::default().with_microsteps(microsteps)
}

#[test]
fn soft_pendulum_swings_as_the_reference() {
    // The engine's single precision sets the limit, so more micro-steps win nothing.
    check("k 50, 1 micro-step", SOFT, plugin(1), 2e-5);
    check("k 50, 4 micro-steps", SOFT, plugin(4), 3e-5);
    check("k 50, 16 micro-steps", SOFT, plugin(16), 2e-5);
    check(
        "k 50, extrapolated",
        SOFT,
        plugin(1).with_extrapolation(),
        2e-5,
    );
}

#[test]
fn damped_pendulum_swings_as_the_reference() {
    check("k 500 c 5, 1 micro-step", DAMPED, plugin(1), 2e-4);
    check("k 500 c 5, 16 micro-steps", DAMPED, plugin(16), 4e-5);
    check(
        "k 500 c 5, extrapolated",
        DAMPED,
        plugin(1).with_extrapolation(),
        2e-5,
    );
}

#[test]
fn stiff_pendulum_swings_as_the_reference_and_closer_extrapolated() {
    check("k 50000 c 100, 1 micro-step", STIFF, plugin(1), 2e-3);
    check("k 50000 c 100, 16 micro-steps", STIFF, plugin(16), 1e-5);
    check(
        "k 50000 c 100, extrapolated",
        STIFF,
        plugin(1).with_extrapolation(),
        1e-4,
    );
}
