//! Does a body hang at mg/k below the rest length?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

#[test]
fn sag_is_weight_over_stiffness_at_any_stiffness() {
    for phase in [0.02, 0.1, 0.5, 1.0, 2.0, 3.2, 6.3, 10.0, 50.0_f64] {
        let mass = 2.0_f32;
        let k = (f64::from(mass) * (phase / f64::from(DT)).powi(2)) as f32;
        let c = (2.0 * (f64::from(k) * f64::from(mass)).sqrt()) as f32;
        let mut lab = Lab::new();
        let hook = lab.point(Vec3::ZERO);
        let weight = lab.body(mass, Vec3::NEG_Y);
        lab.spawn(
            SpringDamper::new(hook, weight)
                .with_stiffness(k)
                .with_damping(c)
                .with_rest_length(1.0),
        );
        lab.run(20.0);
        let sag = f64::from(mass) * GRAVITY / f64::from(k);
        let error = (-f64::from(lab.position(weight).y) - 1.0 - sag).abs();
        println!("static sag, ω·dt {phase}: sag {sag:.3e} m, error {error:.1e} m");
        assert!(
            error <= (5e-4 * sag).max(1e-6),
            "ω·dt {phase}: {error:e} of {sag:e}"
        );
    }
}
