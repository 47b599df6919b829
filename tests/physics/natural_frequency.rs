//! Does a body hung on a spring keep the frequency √(k/m)/2π and its amplitude?

use crate::fit::{Sine, frequency};
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

#[test]
fn frequency_and_amplitude_hold_from_soft_to_barely_resolved() {
    for phase in [0.02, 0.05, 0.1, 0.3, 1.0, 1.7, 2.5_f64] {
        let mass = 2.0;
        let k = (f64::from(mass) * (phase / f64::from(DT)).powi(2)) as f32;
        let omega = (f64::from(k) / f64::from(mass)).sqrt();
        let mut lab = Lab::new();
        let hook = lab.point(Vec3::ZERO);
        let weight = lab.body(mass, Vec3::NEG_Y);
        lab.spawn(
            Spring::new(hook, weight)
                .with_stiffness(k)
                .with_rest_length(0.9),
        );
        let samples: Vec<(f64, f64)> = (1..=600)
            .map(|i| {
                lab.tick();
                (
                    f64::from(i) * f64::from(DT),
                    f64::from(lab.position(weight).y),
                )
            })
            .collect();
        let error = (frequency(&samples, omega) / omega - 1.0).abs();
        // The first half holds about one period of the slowest oscillation.
        let (first, last) = samples.split_at(300);
        let kept = Sine::fit(last, omega).amplitude() / Sine::fit(first, omega).amplitude();
        let lost = 2.0 * (1.0 - kept);
        println!(
            "natural frequency, ω·dt {phase}: relative error {error:.1e}, amplitude lost over 10 s {lost:.1e}"
        );
        assert!(error <= 1e-6, "ω·dt {phase}: {error:e}");
        assert!(lost.abs() <= 1e-4, "ω·dt {phase}: lost {lost:e}");
    }
}
