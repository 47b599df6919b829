//! Does a weight that swings on two springs side by side stay within the tolerance with the number of micro-steps that
//! `recommend` returns? (On one spring it needs fewer.)

use crate::harness::*;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

const CASES: [(&str, f32, f32); 3] = [
    (include_str!("../data/pendulum_k50.csv"), 50.0, 0.0),
    (include_str!("../data/pendulum_k500_c5.csv"), 500.0, 5.0),
    (include_str!("../data/pendulum_k50000_c100.csv"), 5e4, 100.0),
];

/// Largest position error over 10 s of a weight on so many springs side by side, m.
fn error(
    springs: usize,
    (file, stiffness, damping): (&str, f32, f32),
    hertz: usize,
    microsteps: u32,
) -> f64 {
    let engine = Engine {
        dt: 1.0 / hertz as f32,
        ..default()
    };
    let plugin = CoiloverPlugin::default().with_microsteps(microsteps);
    let mut lab = Lab::with(plugin, engine);
    let pivot = lab.point(Vec3::ZERO);
    let weight = lab.body(1.0, Vec3::X);
    for _ in 0..springs {
        let share = springs as f32;
        lab.spawn(
            SpringDamper::new(pivot, weight)
                .with_stiffness(stiffness / share)
                .with_damping(damping / share)
                .with_rest_length(1.0),
        );
    }
    let mut worst = 0.0_f64;
    for row in reference(file).iter().step_by(240 / hertz).skip(1) {
        lab.tick();
        let p = lab.position(weight).as_dvec3();
        worst = worst.max(p.distance(DVec3::new(row[1], row[2], 0.0)));
    }
    worst
}

#[test]
fn recommended_microsteps_keep_the_tolerance_and_half_as_many_do_not_keep_a_tenth() {
    for case in CASES {
        for hertz in [30, 60, 120] {
            for tolerance in [1e-3, 1e-4, 1e-5] {
                let n = recommend(case.1, case.2, 1.0, 1.0 / hertz as f32, tolerance);
                let allowed = 10.0 * f64::from(tolerance);
                let got = error(2, case, hertz, n);
                assert!(
                    got <= 1.2 * allowed,
                    "k {} at {hertz} Hz, {n} micro-steps: {got:.1e} m of {allowed:e}",
                    case.1
                );
                if n >= 4 {
                    let half = error(2, case, hertz, n / 2);
                    assert!(half > 0.1 * allowed, "{n} are far too many: {half:e} m");
                }
            }
        }
    }
}

#[test]
fn a_lone_spring_needs_one_micro_step_for_a_fifth_of_a_millimetre_in_ten_seconds() {
    for case in &CASES[..2] {
        let got = error(1, *case, 60, 1);
        assert!(got < 2e-4, "k {}: {got:.1e} m", case.1);
    }
}
